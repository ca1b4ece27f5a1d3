//! Rigid motions of coordinates as soft ones: K resists or drives them.

use decks::{Body, Deck};
use feti_contact::error::Kind;
use feti_contact::solver::{Modes, Origin, Problem, RowKind, SparseInput, Storage};

use crate::soft::driven::{closed, narrow, with_drive};
use crate::soft::{
    add_diagonal, column, difference, given, oracle, rounded, solved, with_springs, Solved, ELEMENTS,
};
use crate::support::hand_over;

/// The deck with the coordinates of its unknowns, moved by up to `moved`, and nothing else about its motions.
fn placed(deck: &Deck, soft: bool, moved: f64) -> Problem {
    let mut problem = hand_over::without_null_spaces(deck).unwrap();
    for (p, body) in deck.bodies.iter().enumerate() {
        let modes = if soft { Modes::Soft } else { Modes::Candidates };
        problem.set_coordinate_modes(p, modes).unwrap();
        give_places(&mut problem, p, body, moved);
    }
    problem
}

fn give_places(problem: &mut Problem, p: usize, body: &Body, moved: f64) {
    let shaken = |i: usize, x: f64| x + moved * (7.0 * i as f64 + x).sin();
    let places: Vec<f64> = (0..body.dofs())
        .flat_map(|i| [0, 1].map(|k| shaken(2 * body.node[i] as usize + k, body.coordinates[i][k])))
        .collect();
    problem.set_coordinates(p, 2, &body.node, &body.direction, &places, 2).unwrap();
}

/// Against the dense answer on the closed rows.
fn errors(deck: &Deck, found: &Solved) -> (f64, f64) {
    let truth = oracle::solve(deck, &closed(&found.lambda)).unwrap();
    (difference(&found.lambda, &truth.lambda), difference(&found.u, &truth.u))
}

/// Coordinates of a position that is not quite that of K, as in a Newton loop that lags by a step.
#[test]
fn weak_springs_and_rounding_under_soft_coordinates_give_the_forces_of_the_dense_answer() {
    let mut failed = Vec::new();
    for decade in -12..=-4 {
        for (moved, digits) in [(0.0, 17), (1e-3, 17), (1e-3, 10)] {
            let deck = rounded(with_springs(column(3), 10f64.powi(decade)), digits);
            let what = format!("springs 1e{decade}, {digits} digits, moved by {moved:e}");
            let mut problem = placed(&deck, true, moved);
            match solved(&mut problem) {
                Err(error) => failed.push(format!("{what}: {error}")),
                Ok(found) => {
                    let (forces, u) = errors(&deck, &found);
                    if !(forces <= 1e-8 && u <= 1e-8) {
                        failed.push(format!("{what}: forces {forces:.1e} u {u:.1e}"));
                    }
                }
            }
            assert_eq!(problem.body_facts(0).unwrap().origin, Origin::Coordinates);
        }
    }
    assert!(failed.is_empty(), "{}", failed.join("\n"));
}

/// Pressed blocks: taken for candidates the motions are none of K, which is then indefinite.
#[test]
fn driven_bodies_have_their_answer_with_soft_coordinates_and_none_with_candidates() {
    for drive in [1e-9, 1e-7, 1e-5, 1e-3] {
        let deck = with_drive(narrow(2), drive);
        let found = solved(&mut placed(&deck, true, 1e-3)).unwrap();
        let (forces, u) = errors(&deck, &found);
        assert!(forces <= 1e-8 && u <= 1e-8, "drive {drive:e}: forces {forces:.1e} u {u:.1e}");
        let error = placed(&deck, false, 0.0).solve().err().unwrap();
        assert!(matches!(error.kind, Kind::Indefinite | Kind::NullSpace), "drive {drive:e}: {error}");
    }
}

/// Supports of 1 to 1e30 times K at a node or two, beside the rows, and springs of 1e-7.
#[test]
fn supports_may_hold_some_soft_motions_or_all() {
    for (support, nodes) in
        [1.0, 1e3, 1e20, 1e30].into_iter().flat_map(|support| [(support, 1), (support, 2)])
    {
        let mut deck = with_springs(column(2), 1e-7);
        let largest = deck.bodies[0].stiffness.diagonal().into_iter().fold(0.0, f64::max);
        let first = 2 * (ELEMENTS[0] + 1);
        for dof in (0..nodes).flat_map(|node| [first + 8 * node, first + 8 * node + 1]) {
            add_diagonal(&mut deck.bodies[0], dof, support * largest);
        }
        let mut problem = placed(&deck, true, 0.0);
        let (forces, u) = errors(&deck, &solved(&mut problem).unwrap());
        assert!(forces <= 1e-8 && u <= 1e-8, "support {support:e}: forces {forces:.1e} u {u:.1e}");
        // one support leaves the rotation about it, and two as stiff as K resist it by less than a tenth
        let soft: &[usize] = if nodes == 1 || support == 1.0 { &[0, 1] } else { &[1] };
        assert_eq!(problem.findings().unwrap().soft, soft, "support {support:e} at {nodes} nodes");
    }
}

/// Blocks on supports all along their lower edge, declared soft because the host does not know which of them float: motions that
/// K resists like any other have no column.
#[test]
fn motions_of_clamped_bodies_declared_soft_cost_no_column() {
    for support in [0.3, 1.0, 1e3] {
        let mut deck = with_springs(column(3), 1e-7);
        let largest = deck.bodies[0].stiffness.diagonal().into_iter().fold(0.0, f64::max);
        (0..2 * (ELEMENTS[0] + 1)).for_each(|dof| add_diagonal(&mut deck.bodies[0], dof, support * largest));
        let [mut soft, mut plain] = [true, false].map(|soft| placed(&deck, soft, 0.0));
        let (forces, u) = errors(&deck, &solved(&mut soft).unwrap());
        assert!(forces <= 1e-8 && u <= 1e-8, "support {support:e}: forces {forces:.1e} u {u:.1e}");
        plain.setup().unwrap();
        for body in 0..3 {
            let motions = |problem: &Problem| problem.body_facts(body).unwrap().factors.unwrap().null_space;
            let expected = if body == 0 { 0 } else { 3 };
            assert_eq!(motions(&soft), expected, "support {support:e}, body {body}");
            assert!(body > 0 || motions(&plain) == 0);
        }
    }
}

/// Two blocks as one body of two parts: each keeps motions of its own.
#[test]
fn each_part_of_a_body_has_soft_motions_of_its_own() {
    let deck = with_springs(column(2), 1e-7);
    let [one, n] = [deck.bodies[0].dofs(), deck.dofs()];
    let mut whole = Problem::new();
    let body = whole.add_body(n).unwrap();
    let (mut ptr, mut col, mut val, mut load) = (vec![0], Vec::new(), Vec::new(), Vec::new());
    let (mut node, mut direction, mut places) = (Vec::new(), Vec::new(), Vec::new());
    for (p, part) in deck.bodies.iter().enumerate() {
        for i in 0..part.dofs() {
            for (j, v) in part.stiffness.row(i) {
                col.push((deck.offset(p) + j) as i64);
                val.push(v);
            }
            ptr.push(col.len());
            node.push((deck.offset(p) + i) as i32 / 2);
            direction.push(part.direction[i]);
            places.extend_from_slice(&part.coordinates[i][..2]);
        }
        load.extend_from_slice(&part.load);
    }
    let input = SparseInput { ptr: &ptr, col: &col, val: &val, storage: Storage::Full };
    whole.set_stiffness(body, input).unwrap();
    whole.set_load(body, &load).unwrap();
    whole.set_coordinates(body, 2, &node, &direction, &places, 2).unwrap();
    whole.set_coordinate_modes(body, Modes::Soft).unwrap();
    hand_over::add_rows(&mut whole, RowKind::Inequality, &deck.contact).unwrap();
    hand_over::add_rows(&mut whole, RowKind::Equality, &deck.equalities).unwrap();
    let (forces, u) = errors(&deck, &solved(&mut whole).unwrap());
    assert!(forces <= 1e-8 && u <= 1e-8, "forces {forces:.1e} u {u:.1e}");
    let (dimension, motions) = whole.null_space(body).unwrap();
    let moved = |motion: &[f64]| [&motion[..one], &motion[one..]].map(|part| part.iter().any(|v| *v != 0.0));
    assert_eq!(dimension, 6);
    assert!(motions.chunks_exact(n).all(|motion| moved(motion).iter().filter(|moved| **moved).count() == 1));
}

#[test]
fn motions_that_nothing_resists_are_the_null_space_also_as_soft_coordinates() {
    let deck = column(3);
    let exact = solved(&mut given(&deck, Modes::Exact)).unwrap();
    let found = solved(&mut placed(&deck, true, 0.0)).unwrap();
    assert!(difference(&found.lambda, &exact.lambda) <= 1e-12 && difference(&found.u, &exact.u) <= 1e-12);
    assert_eq!(found.products, exact.products);
}

/// What is said of the coordinates holds for those that come later, goes behind a null space that is given, and makes K+ anew.
#[test]
fn the_word_of_soft_coordinates_holds_until_it_is_taken_back() {
    let deck = with_drive(narrow(1), 1e-5);
    let mut problem = placed(&deck, true, 1e-3);
    let one = solved(&mut problem).unwrap();
    give_places(&mut problem, 0, &deck.bodies[0], 2e-3);
    let other = solved(&mut problem).unwrap();
    assert!(difference(&other.lambda, &one.lambda) <= 1e-8);
    problem.set_coordinate_modes(0, Modes::Candidates).unwrap();
    assert!(problem.solve().is_err());
    let motions = deck.bodies[0].modes();
    problem
        .set_null_space(0, deck.dofs(), motions.len(), &motions.concat(), deck.dofs(), Modes::Soft)
        .unwrap();
    assert!(difference(&solved(&mut problem).unwrap().lambda, &one.lambda) <= 1e-8);
}

#[test]
fn a_problem_file_keeps_the_word_of_soft_coordinates() {
    let deck = with_drive(narrow(2), 1e-4);
    let mut problem = placed(&deck, true, 1e-3);
    let bytes =
        |problem: &mut Problem| solved(problem).unwrap().u.iter().map(|u| u.to_bits()).collect::<Vec<_>>();
    let path = std::env::temp_dir().join(format!("soft_coordinates_{}.feti", std::process::id()));
    problem.write_file(&path).unwrap();
    let mut read = Problem::new();
    let found = read.read_file(&path);
    std::fs::remove_file(&path).unwrap();
    found.unwrap();
    assert!(bytes(&mut read) == bytes(&mut problem));
}
