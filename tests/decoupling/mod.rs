//! Equality rows are recombined and contact rows cleared of them inside; the host meets its own rows everywhere.

use crate::support::hand_over;
use decks::{Body, Csr, Cube, Deck, Glue, Moduli};
use feti_contact::error::Kind;
use feti_contact::solver::{Outcome, Problem, Report, RowKind};

/// Springs at the ground, one unknown each, of these stiffnesses under these loads.
fn springs(stiffness: &[f64], load: &[f64]) -> Deck {
    let body = |(k, f): (&f64, &f64)| Body {
        stiffness: Csr::from_dense(1, &[*k]),
        null_space: None,
        load: vec![*f],
        coordinates: vec![[0.0; 3]],
        node: vec![1],
        direction: vec![1],
    };
    Deck::new("springs", stiffness.iter().zip(load).map(body).collect())
}

/// Neighbours joined in a chain.
fn chain(stiffness: &[f64], load: &[f64]) -> Deck {
    let mut deck = springs(stiffness, load);
    (1..stiffness.len()).for_each(|i| deck.equalities.push(&[(i - 1, 1.0), (i, -1.0)], 0.0));
    deck
}

/// A cube of 3 x 3 x 3 subdomains with this contrast in its stiffness.
fn checkerboard(glue: Glue, contrast: f64) -> Deck {
    let moduli = Moduli::Checkerboard(contrast);
    Cube { subdomains: [3; 3], glue, moduli, pressure: 0.003 * contrast, ..Cube::default() }.build()
}

fn solved(problem: &mut Problem) -> Report {
    let report = problem.solve().unwrap();
    assert_eq!(report.outcome, Outcome::Solved, "{report:?}");
    report
}

/// u, lambda, mu.
fn answer(problem: &Problem) -> [Vec<f64>; 3] {
    let bodies = 0..problem.sizes().bodies;
    let u = bodies.flat_map(|p| problem.displacement(p).unwrap().to_vec()).collect();
    let [lambda, mu] =
        [RowKind::Inequality, RowKind::Equality].map(|k| problem.multipliers(k).unwrap().to_vec());
    [u, lambda, mu]
}

fn assert_near(found: &[f64], expected: &[f64], tolerance: f64, what: &str) {
    assert_eq!(found.len(), expected.len(), "{what}");
    let size = expected.iter().fold(0.0f64, |size, v| size.max(v.abs()));
    let error = found.iter().zip(expected).fold(0.0f64, |error, (a, b)| error.max((a - b).abs()));
    assert!(error <= tolerance * size, "{what}: {error:e} of {size:e}");
}

/// Four springs in a chain pushed by 10 against a wall at 1/2, which the softest meets: u = 1/2, every glue row carries
/// what the springs behind it do not take, and the wall takes the rest.
#[test]
fn forces_of_a_chain_of_soft_and_stiff_springs_are_those_by_hand() {
    let (k, f) = ([1.0, 4.0, 1000.0, 2.0], [1.0, 2.0, 3000.0, 4.0]);
    let mut deck = chain(&k, &f);
    deck.contact.push(&[(0, 3.0)], 1.5);
    let mut problem = hand_over::problem(&deck).unwrap();
    solved(&mut problem);
    let [u, lambda, mu] = answer(&problem);
    assert_near(&u, &[0.5; 4], 1e-9, "u");
    let left: Vec<f64> = k.iter().zip(f).map(|(k, f)| f - 0.5 * k).collect();
    assert_near(&lambda, &[left.iter().sum::<f64>() / 3.0], 1e-9, "lambda");
    assert_near(&mu, &[-(left[1] + left[2] + left[3]), -(left[2] + left[3]), -left[3]], 1e-9, "mu");
    // the wall moved: no new factorisation, and so does the glue: u_0 - u_1 = 0.1
    problem.set_rhs(RowKind::Inequality, 0, &[1.2]).unwrap();
    problem.set_rhs(RowKind::Equality, 0, &[0.1]).unwrap();
    assert_eq!(solved(&mut problem).work.factorisations, 4);
    assert_near(&answer(&problem)[0], &[0.4, 0.3, 0.3, 0.3], 1e-9, "moved");
    // far away it is not met: 1007 u = 3007
    problem.set_rhs(RowKind::Inequality, 0, &[1e3]).unwrap();
    problem.set_rhs(RowKind::Equality, 0, &[0.0]).unwrap();
    solved(&mut problem);
    let [u, lambda, _] = answer(&problem);
    assert_near(&u, &[3007.0 / 1007.0; 4], 1e-9, "free");
    assert_eq!(lambda, [0.0]);
}

/// Springs 1 and 1e6 glued, pushed by 2e6 against a layer of stiffness 3e6 at u = 0: u = 2e6 / (4e6 + 1).
#[test]
fn a_spring_in_a_contact_row_on_the_soft_side_is_that_of_the_host() {
    let mut deck = chain(&[1.0, 1e6], &[0.0, 2e6]);
    deck.contact.push_compliant(&[(0, 1.0)], 0.0, 1.0 / 3e6);
    let mut problem = hand_over::problem(&deck).unwrap();
    solved(&mut problem);
    let u = 2e6 / (4e6 + 1.0);
    let [found, lambda, mu] = answer(&problem);
    assert_near(&found, &[u; 2], 1e-9, "u");
    assert_near(&lambda, &[3e6 * u], 1e-9, "lambda");
    assert_near(&mu, &[-(3e6 + 1.0) * u], 1e-9, "mu");
}

/// The copy of a glued node that the host puts its contact row on is its own business.
#[test]
fn contact_on_any_copy_of_a_node_takes_the_same_steps_to_the_same_forces() {
    let on = |dof: usize| {
        let mut deck = chain(&[1.0, 1e5, 10.0], &[1.0, 7e4, 0.0]);
        deck.contact.push(&[(dof, 1.0)], 0.1);
        let mut problem = hand_over::problem(&deck).unwrap();
        let report = solved(&mut problem);
        (report.counts.products, answer(&problem))
    };
    let (products, [u, lambda, _]) = on(0);
    for dof in [1, 2] {
        let (others, [v, forces, _]) = on(dof);
        assert_eq!(others, products);
        assert_near(&v, &u, 1e-9, "u");
        assert_near(&forces, &lambda, 1e-9, "lambda");
    }
}

/// u_0 <= 1, u_0 = u_1 = u_2, u_2 >= 2.
#[test]
fn rows_that_contradict_each_other_through_glue_are_named_with_the_glue() {
    let mut deck = chain(&[1.0, 100.0, 1e4], &[0.0; 3]);
    deck.contact.push(&[(0, 2.0)], 2.0);
    deck.contact.push(&[(2, -1.0)], -2.0);
    deck.contact.push(&[(1, 1.0)], 5.0);
    let mut problem = hand_over::problem(&deck).unwrap();
    assert_eq!(problem.solve().unwrap_err().kind, Kind::GapsContradict);
    let weights = |kind| problem.findings().unwrap().rows(kind).collect::<Vec<_>>();
    let (contact, glue) = (weights(RowKind::Inequality), weights(RowKind::Equality));
    assert_eq!(contact.iter().map(|(row, _)| *row).collect::<Vec<_>>(), [0, 1]);
    assert_eq!(glue.iter().map(|(row, _)| *row).collect::<Vec<_>>(), [0, 1]);
    let found: Vec<f64> = contact.iter().chain(&glue).map(|(_, w)| *w).collect();
    assert_near(&found, &[0.5, 1.0, -1.0, -1.0], 1e-7, "weights");
}

/// `B K+ B'` and `B K+ f - c` from the K+ and the rows of the host.
#[test]
fn the_dual_operator_and_right_hand_side_are_those_of_the_rows_of_the_host() {
    let mut deck = checkerboard(Glue::NonRedundant, 1e4);
    deck.contact.compliance[1] = 0.1;
    deck.contact.rhs.iter_mut().for_each(|c| *c += 0.01);
    let mut problem = hand_over::problem(&deck).unwrap();
    let m = deck.contact.len() + deck.equalities.len();
    let x: Vec<f64> = (0..m).map(|i| (1.0 + i as f64).sin()).collect();
    let (mut applied, mut rhs) = (vec![0.0; m], vec![0.0; m]);
    problem.dual_apply(&x, &mut applied).unwrap();
    problem.dual_rhs(&mut rhs).unwrap();
    let mut force = deck.contact.matrix.transpose_times(&x[..deck.contact.len()]);
    let glue = deck.equalities.matrix.transpose_times(&x[deck.contact.len()..]);
    force.iter_mut().zip(glue).for_each(|(a, b)| *a += b);
    let mut along = |force: &[f64]| {
        let mut u = vec![0.0; force.len()];
        for (p, body) in deck.bodies.iter().enumerate() {
            let range = deck.offset(p)..deck.offset(p) + body.dofs();
            problem.kplus(p, &force[range.clone()], &mut u[range]).unwrap();
        }
        [deck.contact.matrix.times(&u), deck.equalities.matrix.times(&u)].concat()
    };
    let mut expected = along(&force);
    expected[1] += 0.1 * x[1];
    assert_near(&applied, &expected, 1e-11, "F");
    let gaps = deck.contact.rhs.iter().chain(&deck.equalities.rhs);
    let expected: Vec<f64> = along(&deck.load()).iter().zip(gaps).map(|(d, c)| d - c).collect();
    assert_near(&rhs, &expected, 1e-11, "d");
}

/// All kinds of glue describe the same body; only chains and orthonormal glue are decoupled throughout.
#[test]
fn glue_of_any_kind_gives_the_same_displacements_and_contact_forces() {
    let of = |glue| {
        let mut problem = hand_over::problem(&checkerboard(glue, 1e3)).unwrap();
        solved(&mut problem);
        answer(&problem)
    };
    let [u, lambda, _] = of(Glue::NonRedundant);
    assert!(lambda.iter().any(|l| *l > 0.0) && lambda.contains(&0.0), "{lambda:?}");
    for glue in [Glue::Orthonormal, Glue::Redundant] {
        let [v, forces, _] = of(glue);
        assert_near(&v, &u, 1e-7, "u");
        assert_near(&forces, &lambda, 1e-7, "lambda");
    }
}

/// Contact rows that weighed as the soft copies they are on would cost ten times as many.
#[test]
fn a_stiffness_jump_of_a_million_costs_no_more_products_than_none() {
    let products = |contrast| {
        let mut problem = hand_over::problem(&checkerboard(Glue::NonRedundant, contrast)).unwrap();
        problem.set_str("preconditioner", "lumped").unwrap();
        solved(&mut problem).counts.products
    };
    let (uniform, jump) = (products(1.0), products(1e6));
    assert!(2 * jump <= 3 * uniform, "{uniform} and {jump}");
}

/// The forces of an answer, handed back, are that answer.
#[test]
fn a_start_from_the_answer_is_an_answer_at_once() {
    let deck = checkerboard(Glue::NonRedundant, 1e4);
    let mut problem = hand_over::problem(&deck).unwrap();
    let cold = solved(&mut problem).counts.products;
    let [u, lambda, mu] = answer(&problem);
    problem.start_from(RowKind::Inequality, &lambda).unwrap();
    problem.start_from(RowKind::Equality, &mu).unwrap();
    let warm = solved(&mut problem).counts.products;
    assert!(warm <= 3 && cold > 10, "{warm} instead of {cold}");
    assert_near(&answer(&problem)[0], &u, 1e-8, "u");
    let state = problem.save_state().unwrap();
    problem.set_str("start", "previous").unwrap();
    problem.restore_state(state).unwrap();
    assert!(solved(&mut problem).counts.products <= 3);
}
