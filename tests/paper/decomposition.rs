//! (11), the secondary decomposition: a body cut into subdomains by the host, joined again by rows H u = 0 with free
//! multipliers; redundant rows are accepted.

use crate::cases::METHODS;
use crate::hand_over;
use decks::{Cube, Deck, Glue};
use feti_contact::solver::{Outcome, Problem, RowKind};

/// The same mesh as one body and as 2 x 2 x 2 subdomains.
fn cube(subdomains: usize, glue: Glue) -> Deck {
    Cube { subdomains: [subdomains; 3], elements: 4 / subdomains, glue, ..Cube::default() }.build()
}

fn solved(deck: &Deck, method: &str) -> Problem {
    let mut problem = hand_over::problem(deck).unwrap();
    problem.set_str("method", method).unwrap();
    if method != "proportioning" {
        problem.set_f64("gamma", 10.0).unwrap();
        problem.set_f64("tolerance", 1e-7).unwrap();
        problem.set_f64("certificate_tolerance", 1e-4).unwrap();
    }
    let report = problem.solve().unwrap();
    println!(
        "{} {method} outer {} steps {} products {}",
        deck.name, report.outer, report.steps, report.dual_applications
    );
    assert_eq!(report.outcome, Outcome::Solved, "{} {method}: {:?}", deck.name, report.certificate);
    problem
}

fn forces(problem: &Problem) -> Vec<f64> {
    let mut forces = problem.multipliers(RowKind::Inequality).unwrap().to_vec();
    forces.sort_by(f64::total_cmp);
    forces
}

#[test]
fn a_body_in_subdomains_has_the_forces_and_the_energy_of_the_whole_one() {
    let whole = solved(&cube(1, Glue::NonRedundant), "proportioning");
    let known = forces(&whole);
    let largest = known[known.len() - 1];
    for glue in [Glue::NonRedundant, Glue::Orthonormal, Glue::Redundant] {
        let deck = cube(2, glue.clone());
        assert!(!deck.equalities.is_empty());
        for method in ["proportioning", METHODS[0], METHODS[1], METHODS[2]] {
            let cut = solved(&deck, method);
            let bound = if method == "proportioning" { 1e-7 } else { 2e-4 };
            let found = forces(&cut);
            assert_eq!(found.len(), known.len());
            let error = found.iter().zip(&known).fold(0.0, |s: f64, (a, b)| s.max((a - b).abs()));
            assert!(error <= bound * largest, "{glue:?} {method}: forces differ by {:.1e}", error / largest);
            let energies = [&whole, &cut].map(|p| p.report().unwrap().energy);
            assert!((energies[0] - energies[1]).abs() <= bound * energies[0].abs(), "{glue:?} {method}");
            let free = cut.multipliers(RowKind::Equality).unwrap();
            assert!(free.iter().any(|mu| *mu < 0.0) && free.iter().any(|mu| *mu > 0.0), "mu is free");
        }
    }
}
