//! Decks of up to 5000 unknowns.

use decks::{Blocks, Cube, Deck, Glue, Membrane, Moduli, Stack};
use feti_contact::solver::Outcome;

use crate::support::hand_over;

fn assert_solved(deck: &Deck) {
    assert!(deck.dofs() <= 5000, "{}: {} dofs", deck.name, deck.dofs());
    let report = hand_over::problem(deck).unwrap().solve().unwrap_or_else(|e| panic!("{}: {e}", deck.name));
    assert_eq!(report.outcome, Outcome::Solved, "{}: {report:?}", deck.name);
    assert!(report.certificate.passed(), "{}: {:?}", deck.name, report.certificate);
    assert!(report.active > 0, "{}: no row is closed", deck.name);
}

#[test]
fn membranes_are_solved() {
    for membrane in [Membrane::p1_p3(), Membrane::p1_p1(), Membrane::p1_p3_galerkin()] {
        assert_solved(&membrane.build());
        assert_solved(&Membrane { cells: 40, ..membrane }.build());
    }
}

#[test]
fn two_blocks_on_matching_grids_are_solved() {
    for elements in [2, 4, 6, 8] {
        assert_solved(&Blocks { elements, young: 210_000.0 }.build());
    }
}

#[test]
fn stacks_on_non_matching_grids_are_solved() {
    assert_solved(&Stack::default().build());
    assert_solved(&Stack { hold: true, ..Stack::default() }.build());
    assert_solved(&Stack { flat: true, ..Stack::default() }.build());
    assert_solved(&Stack { noise: 0.1, repeated: 5, ..Stack::default() }.build());
    assert_solved(&Stack { in_plane: vec![8, 7], layers: vec![4], ..Stack::default() }.build());
    let moduli = vec![1.0, 1e-3, 10.0];
    assert_solved(&Stack { bodies: 5, in_plane: vec![6, 5, 4], moduli, ..Stack::default() }.build());
}

#[test]
fn cubes_of_subdomains_are_solved() {
    let plane = Cube { dimension: 2, subdomains: [4, 4, 1], elements: 8, ..Cube::default() };
    for glue in [Glue::NonRedundant, Glue::Orthonormal, Glue::Redundant] {
        assert_solved(&Cube { glue, ..Cube::default() }.build());
        assert_solved(&Cube { glue, glue_clamped: true, all_closed: true, ..plane.clone() }.build());
    }
    for moduli in [Moduli::Checkerboard(1e3), Moduli::Layers(1e-4)] {
        assert_solved(&Cube { moduli: moduli.clone(), elements: 3, ..Cube::default() }.build());
        assert_solved(&Cube { moduli, waves: 0.3, noise: 0.1, pressure: 1.0, ..plane.clone() }.build());
    }
}

#[test]
fn automatic_means_lumped_where_products_are_dear_and_none_elsewhere() {
    let applications = |deck: &Deck, preconditioner: &str| {
        let mut problem = hand_over::problem(deck).unwrap();
        problem.set_str("preconditioner", preconditioner).unwrap();
        let report = problem.solve().unwrap();
        (report.counts.preconditioned, report.counts.products)
    };
    let glued = Cube { elements: 4, ..Cube::default() }.build();
    assert!(applications(&glued, "automatic").0 > 0);
    assert_eq!(applications(&glued, "automatic"), applications(&glued, "lumped"));
    let two = Blocks { elements: 6, young: 1.0 }.build();
    assert_eq!(applications(&two, "automatic").0, 0);
}
