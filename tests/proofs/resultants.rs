//! A free block under a thermal load, f = K u: it is in balance but for what rounding leaves.

use decks::varied::rounded_to;
use decks::{Block, Body, Deck};
use feti_contact::error::Kind;
use feti_contact::solver::{Outcome, Problem};

use crate::support::hand_over;

/// 4 x 3 quads, one corner at `offset` along both axes; the load is the thermal one with so many digits, and `pull` times its
/// size on top, along x.
fn block(offset: f64, digits: usize, pull: f64) -> Body {
    let block = Block {
        dimension: 2,
        elements: [4, 3, 1],
        size: [1.0, 0.7, 1.0],
        origin: [offset, offset, 0.0],
        ..Block::default()
    };
    let mut body = block.floating().body;
    let stretch = |i: usize| 1e-3 * (body.coordinates[i][body.direction[i] as usize - 1] - offset).powi(2);
    let u: Vec<f64> = (0..body.dofs()).map(stretch).collect();
    body.load = body.stiffness.times(&u).iter().map(|f| rounded_to(*f, digits)).collect();
    let diagonal = body.stiffness.diagonal();
    let size = |f: &[f64]| f.iter().zip(&diagonal).map(|(f, d)| f * f / d).sum::<f64>().sqrt();
    let along: Vec<f64> = body.direction.iter().map(|d| if *d == 1 { 1.0 } else { 0.0 }).collect();
    let pushed: Vec<f64> = along.iter().zip(&diagonal).map(|(v, d)| v * d).collect();
    let by = pull * size(&body.load) / size(&pushed);
    body.load.iter_mut().zip(&pushed).for_each(|(f, p)| *f += by * p);
    body
}

fn problem(body: Body) -> Problem {
    hand_over::problem(&Deck::new("a free block", vec![body])).unwrap()
}

#[test]
fn a_thermal_load_of_twelve_digits_or_far_from_the_origin_is_solved_and_its_resultant_is_told() {
    for (offset, digits) in [(0.0, 17), (0.0, 12), (1000.0, 17), (1000.0, 12)] {
        let mut problem = problem(block(offset, digits, 0.0));
        let report = problem.solve().unwrap_or_else(|error| panic!("{offset} {digits}: {error}"));
        assert_eq!(report.outcome, Outcome::Solved, "{offset} {digits}");
        let told = problem.findings().unwrap().unheld;
        assert!(told <= 1e-10, "{told:e}");
        if digits == 12 {
            assert!(told > 1e-16, "{told:e}");
        }
    }
}

#[test]
fn up_to_1e_10_of_the_load_is_solved_up_to_1e_7_is_marginal_and_more_is_named() {
    for (pull, ends) in [
        (3e-11, Some(Outcome::Solved)),
        (3e-10, Some(Outcome::Marginal)),
        (5e-8, Some(Outcome::Marginal)),
        (3e-7, None),
        (1e-3, None),
    ] {
        let mut problem = problem(block(0.0, 17, pull));
        let found = problem.solve();
        match ends {
            Some(outcome) => {
                let report = found
                    .unwrap_or_else(|error| panic!("{pull:e} of the load should be {outcome:?}: {error}"));
                assert_eq!(report.outcome, outcome, "{pull:e}");
                let told = problem.findings().unwrap().unheld;
                assert!((told / pull - 1.0).abs() < 0.01, "{told:e} of {pull:e}");
                let u = problem.displacements().unwrap();
                assert!(u.iter().all(|u| u.is_finite() && u.abs() < 1e-2), "{pull:e}");
            }
            None => {
                let error = found.unwrap_err();
                assert_eq!(error.kind, Kind::LoadNotHeld, "{pull:e}");
                let told = error.place.value.unwrap();
                assert!((told / pull - 1.0).abs() < 0.01, "{told:e} of {pull:e}");
                assert!(error.to_string().contains(&format!("|resultant| / |load| = {told:.1e}")), "{error}");
            }
        }
    }
}

/// Beside a body whose load is 1e9 times as large and held: shares are of the load of the block that is free.
#[test]
fn a_small_body_that_nothing_holds_is_named_beside_one_with_a_large_load() {
    use crate::proofs::{body, deck, springs};
    let held = body(springs(2, &[(0, 1, 1.0)], &[(0, 1.0)]), vec![], vec![0.0, 1e9]);
    let free = body(springs(2, &[(0, 1, 1.0)], &[]), vec![vec![1.0, 1.0]], vec![1.0, -0.5]);
    // a row that the load opens
    let deck = deck(vec![held, free], &[(&[(1, 1.0), (2, -1.0)], 1e10)], &[]);
    let error = hand_over::problem(&deck).unwrap().solve().unwrap_err();
    assert_eq!((error.kind, error.place.body), (Kind::LoadNotHeld, Some(1)), "{error}");
}

/// A free pair of springs whose load is in balance but for 1e-12 of it, beside a wall a million deformations away.
#[test]
fn what_rounding_leaves_of_a_load_drives_no_body_to_a_wall_far_away() {
    use crate::proofs::{body, deck, springs};
    for unit in [1.0, 1e-9, 1e11] {
        let stiffness = springs(3, &[(0, 1, unit), (1, 2, unit)], &[]);
        let load = vec![-unit, 0.0, unit * (1.0 + 1e-12)];
        let deck = deck(vec![body(stiffness, vec![vec![1.0; 3]], load)], &[(&[(2, 1.0)], 1e6)], &[]);
        let mut problem = hand_over::problem(&deck).unwrap();
        let report = problem.solve().unwrap();
        assert_eq!((report.outcome, report.active), (Outcome::Solved, 0), "{unit:e}");
        let told = report.unheld;
        assert!(told > 1e-13 && told < 1e-12, "{told:e}");
        let u = problem.displacements().unwrap();
        assert!(u.iter().zip([-1.0, 0.0, 1.0]).all(|(u, right)| (u - right).abs() < 1e-9), "{u:?}");
    }
}
