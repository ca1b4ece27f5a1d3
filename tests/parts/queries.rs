//! What the host asks about a body of several components, and what it changes.

use decks::{masonry, Deck};
use feti_contact::error::Kind;
use feti_contact::solver::{Modes, Outcome, Problem, RowKind, RowsInput, SparseInput, Storage};

use crate::support::hand_over;

/// Separate bodies, and the same bodies in one matrix.
fn both(deck: &Deck) -> [Problem; 2] {
    [hand_over::problem(deck).unwrap(), hand_over::problem(&deck.one_k()).unwrap()]
}

#[test]
fn validation_calls_answer_part_by_part() {
    let deck = masonry::tower(4);
    let [mut apart, mut whole] = both(&deck);
    let (n, m) = (deck.dofs(), deck.contact.len() + deck.equalities.len());
    let (mut separate, mut y) = (vec![0.0; n], vec![0.0; n]);
    for step in 0..96 {
        let x: Vec<f64> = (0..n).map(|i| (((7 + step) * i % 11) as f64 - 5.0) / 8.0).collect();
        for p in 0..deck.bodies.len() {
            let range = deck.offset(p)..deck.offset(p + 1);
            apart.kplus(p, &x[range.clone()], &mut separate[range]).unwrap();
        }
        whole.kplus(0, &x, &mut y).unwrap();
        assert_eq!(y, separate, "{step}");
    }
    let held: Vec<usize> = (0..deck.bodies.len())
        .flat_map(|p| apart.fixing_dofs(p).unwrap().into_iter().map(move |i| (p, i)).collect::<Vec<_>>())
        .map(|(p, i)| deck.offset(p) + i)
        .collect();
    assert_eq!(whole.fixing_dofs(0).unwrap(), held);
    let lambda: Vec<f64> = (0..m).map(|i| 1.0 + i as f64 / 16.0).collect();
    let [mut fx, mut d] = [[vec![0.0; m], vec![0.0; m]], [vec![0.0; m], vec![0.0; m]]];
    for (k, problem) in [&mut apart, &mut whole].into_iter().enumerate() {
        problem.dual_apply(&lambda, &mut fx[k]).unwrap();
        problem.dual_rhs(&mut d[k]).unwrap();
    }
    assert_eq!((&fx[0], &d[0]), (&fx[1], &d[1]));
    let modes: usize = deck.bodies.iter().map(|body| body.modes().len()).sum();
    let (r, basis) = whole.null_space(0).map(|(r, basis)| (r, basis.into_owned())).unwrap();
    assert_eq!((r, basis.len()), (modes, modes * n));
    // u = K+ (f - B'lambda) + R alpha
    assert_eq!(whole.solve().unwrap().outcome, Outcome::Solved);
    let (u, alpha) = (whole.displacement(0).unwrap().to_vec(), whole.amplitudes(0).unwrap().to_vec());
    let mut forces = vec![0.0; n];
    whole.reaction(None, 0, &mut forces).unwrap();
    let total: Vec<f64> = deck.load().iter().zip(&forces).map(|(f, r)| f + r).collect();
    whole.kplus(0, &total, &mut y).unwrap();
    (0..r).for_each(|j| (0..n).for_each(|i| y[i] += alpha[j] * basis[j * n + i]));
    let size = u.iter().fold(0.0, |m: f64, v| m.max(v.abs()));
    assert!(u.iter().zip(&y).all(|(u, y)| (u - y).abs() < 1e-11 * size));
    let facts = whole.body_facts(0).unwrap();
    assert_eq!((facts.components, facts.factors.unwrap().null_space), (Some(deck.bodies.len()), modes));
}

#[test]
fn too_few_vectors_on_one_part_are_refused_with_an_unknown_of_this_part() {
    let deck = masonry::apart(3);
    let mut whole = deck.one_k();
    let second = deck.offset(1)..deck.offset(2);
    let modes = whole.bodies[0].null_space.as_mut().unwrap();
    second.clone().for_each(|i| modes[0][i] = 0.0);
    let error = hand_over::problem(&whole).unwrap().solve().unwrap_err();
    assert_eq!((error.kind, error.place.body), (Kind::NullSpace, Some(0)));
    assert!(error.place.dof.is_some_and(|dof| second.contains(&dof)), "{error}");
}

/// An entry that joins two parts, or leaves one in two, in the same pattern: the factors are those of the new parts.
#[test]
fn new_values_may_join_parts_and_divide_them() {
    let k = |joined: f64| [2.0, -joined, 2.0, -joined, 2.0, -joined, 2.0];
    let (ptr, col) = ([0, 1, 3, 5, 7], [0, 0, 1, 1, 2, 2, 3]);
    let mut problem = Problem::new();
    problem.add_body(4).unwrap();
    problem.set_load(0, &[1.0, 0.0, 0.0, 2.0]).unwrap();
    for joined in [1.0, 0.0, 1.0, 0.5, 0.0] {
        let val = k(joined);
        problem
            .set_stiffness(0, SparseInput { ptr: &ptr, col: &col, val: &val, storage: Storage::Lower })
            .unwrap();
        assert_eq!(problem.solve().unwrap().outcome, Outcome::Solved);
        let u = problem.displacement(0).unwrap();
        let next = |i: usize| if i < 3 { u[i + 1] } else { 0.0 } + if i > 0 { u[i - 1] } else { 0.0 };
        let f = |i: usize| 2.0 * u[i] - joined * next(i);
        assert!((0..4).all(|i| (f(i) - [1.0, 0.0, 0.0, 2.0][i]).abs() < 1e-14), "{joined}: {u:?}");
    }
}

#[test]
fn candidates_and_soft_motions_of_the_whole_model_are_those_of_every_part() {
    let deck = masonry::tower(5);
    let whole = deck.one_k();
    let (n, modes) = (deck.dofs(), whole.bodies[0].modes().concat());
    let mut right = hand_over::problem(&whole).unwrap();
    right.solve().unwrap();
    let right = right.multipliers(RowKind::Inequality).unwrap().to_vec();
    for kind in [Modes::Candidates, Modes::Soft] {
        let mut problem = hand_over::without_null_spaces(&whole).unwrap();
        problem.set_null_space(0, n, modes.len() / n, &modes, n, kind).unwrap();
        assert_eq!(problem.solve().unwrap().outcome, Outcome::Solved, "{kind:?}");
        let found = problem.multipliers(RowKind::Inequality).unwrap();
        let largest = right.iter().fold(0.0, |m: f64, v| m.max(v.abs()));
        assert!(found.iter().zip(&right).all(|(a, b)| (a - b).abs() < 1e-11 * largest), "{kind:?}");
    }
}

/// A heavy part and one of 1e-6 of its forces: a wrong force on the light one does not pass.
#[test]
fn a_light_part_is_judged_as_alone() {
    let mut deck = masonry::apart(2);
    let light = 1;
    deck.bodies[light].load.iter_mut().for_each(|f| *f *= 1e-9);
    let mut problem = hand_over::problem(&deck.one_k()).unwrap();
    assert_eq!(problem.solve().unwrap().outcome, Outcome::Solved);
    let (u, lambda) = (
        problem.displacements().unwrap().to_vec(),
        problem.multipliers(RowKind::Inequality).unwrap().to_vec(),
    );
    let mu = problem.multipliers(RowKind::Equality).unwrap().to_vec();
    assert!(problem.check(&u, &lambda, &mu).unwrap().worst() <= 1.0);
    let (first, mut lie) = (deck.offset(light), lambda);
    let on_light = |i: &usize| deck.contact.matrix.row(*i).any(|(j, _)| j >= first);
    (0..lie.len()).filter(on_light).for_each(|i| lie[i] *= 1.0 + 1e-4);
    assert!(problem.check(&u, &lie, &mu).unwrap().worst() > 1.0);
}

/// One K of a held chain under a load of 3, and of two unknowns, a spring between them, that nothing holds.
#[test]
fn a_load_on_a_part_is_nothing_if_it_is_rounding_of_that_of_the_whole_matrix() {
    let (ptr, col) = ([0, 1, 3, 4, 6], [0, 0, 1, 2, 2, 3]);
    let val = [2.0, -1.0, 1.0, 1.0, -1.0, 1.0];
    let solved = |unit: f64, load: f64| {
        let mut problem = Problem::new();
        problem.add_body(4).unwrap();
        let val = val.map(|v| unit * v);
        let input = SparseInput { ptr: &ptr, col: &col, val: &val, storage: Storage::Lower };
        problem.set_stiffness(0, input).unwrap();
        problem.set_load(0, &[0.0, 3.0 * unit, load * unit, 0.0]).unwrap();
        let ended = problem.solve().map(|report| report.outcome).map_err(|error| error.kind);
        (problem, ended)
    };
    for unit in [1e-30, 1.0, 1e30] {
        for noise in [1e-40, -1e-20, 2e-15] {
            let (mut problem, ended) = solved(unit, noise);
            assert_eq!(ended, Ok(Outcome::Solved), "{noise:e}");
            let mut u = problem.displacements().unwrap().to_vec();
            assert!((u[0] - 3.0).abs() + (u[1] - 6.0).abs() < 1e-13, "{u:?}");
            assert!(problem.check(&u, &[], &[]).unwrap().worst() <= 1.0, "{noise:e}");
            u[3] += 1e-9;
            assert!(problem.check(&u, &[], &[]).unwrap().worst() > 1.0, "{noise:e}: strained");
        }
        for load in [1e-12, 1e-6, 1.0] {
            assert_eq!(solved(unit, load).1, Err(Kind::LoadNotHeld), "{load:e}");
        }
    }
}

/// Springs of 1e-16 and of 1 under the same loads in one K: by its flexibility the soft part has all the load, and yet the other's is
/// not held.
#[test]
fn a_soft_part_does_not_make_the_load_of_another_nothing() {
    let mut problem = Problem::new();
    problem.add_body(3).unwrap();
    let (ptr, col, val) = ([0, 1, 2, 4], [0, 1, 1, 2], [1e-16, 1.0, -1.0, 1.0]);
    problem
        .set_stiffness(0, SparseInput { ptr: &ptr, col: &col, val: &val, storage: Storage::Lower })
        .unwrap();
    problem.set_load(0, &[1.0, 1e-3, 0.0]).unwrap();
    assert_eq!(problem.solve().unwrap_err().kind, Kind::LoadNotHeld);
    problem.set_load(0, &[1.0, 1e-3, -1e-3]).unwrap();
    assert_eq!(problem.solve().unwrap().outcome, Outcome::Solved);
}

/// A chain given by elements and cut, and two springs in one matrix or as two bodies, joined by rows.
#[test]
fn parts_beside_a_body_that_is_cut_are_judged_as_separate_bodies() {
    let solve = |apart: bool| {
        let mut problem = Problem::new();
        problem.set_i64("pieces", 3).unwrap();
        let chain = problem.add_body(12).unwrap();
        let ptr: Vec<usize> = (0..12).map(|e| 2 * e).chain([23]).collect();
        let dof: Vec<i64> = (0..11).flat_map(|e| [e, e + 1]).chain([0]).collect();
        problem.set_mesh(chain, &ptr, &dof).unwrap();
        (0..11).for_each(|e| problem.add_element(chain, e, 2, &[1.0, -1.0, -1.0, 1.0], 2).unwrap());
        problem.add_element(chain, 11, 1, &[4.0], 1).unwrap();
        problem.set_load(chain, &[0.125; 12]).unwrap();
        let springs = if apart { vec![vec![2.0], vec![5e-6]] } else { vec![vec![2.0, 5e-6]] };
        for k in &springs {
            let body = problem.add_body(k.len()).unwrap();
            let (ptr, col): (Vec<usize>, Vec<i64>) = ((0..=k.len()).collect(), (0..k.len() as i64).collect());
            let input = SparseInput { ptr: &ptr, col: &col, val: k, storage: Storage::Lower };
            problem.set_stiffness(body, input).unwrap();
        }
        let rows = RowsInput {
            ptr: &[0, 2, 4],
            body: None,
            dof: &[11, 12, 5, 13],
            val: &[1.0, -1.0, 1.0, -1.0],
            rhs: Some(&[0.5, 0.25]),
        };
        problem.add_rows(RowKind::Inequality, rows).unwrap();
        let report = problem.solve().unwrap();
        assert_eq!(report.outcome, Outcome::Solved);
        assert!(problem.body_facts(chain).unwrap().pieces > 1);
        let (u, lambda) = (
            problem.displacements().unwrap().to_vec(),
            problem.multipliers(RowKind::Inequality).unwrap().to_vec(),
        );
        let mut lie = lambda.clone();
        lie[1] *= 1.0 + 1e-5;
        assert!(problem.check(&u, &lambda, &[]).unwrap().passed());
        assert!(!problem.check(&u, &lie, &[]).unwrap().passed(), "the light spring, apart: {apart}");
        (u, lambda)
    };
    assert_eq!(solve(true), solve(false));
}

/// A file has the matrix of the host, a restored state its loads.
#[test]
fn files_states_and_starts_do_not_see_the_parts() {
    let deck = masonry::tower(4);
    let mut problem = hand_over::problem(&deck.one_k()).unwrap();
    let first = problem.solve().unwrap();
    let lambda = problem.multipliers(RowKind::Inequality).unwrap().to_vec();
    let state = problem.save_state().unwrap();
    let load: Vec<f64> = deck.load().iter().map(|f| 2.0 * f).collect();
    problem.set_load(0, &load).unwrap();
    problem.solve().unwrap();
    problem.restore_state(state).unwrap();
    assert_eq!(problem.multipliers(RowKind::Inequality).unwrap(), lambda);
    problem.set_str("start", "previous").unwrap();
    let again = problem.solve().unwrap();
    assert!(again.counts.products <= first.counts.products);
    assert_eq!(problem.sizes().bodies, 1);
}

/// Bodies that share a number, one of several components.
#[test]
fn glue_joins_a_part_of_a_body() {
    let mut problem = Problem::new();
    for k in [vec![1.0, 2.0], vec![3.0]] {
        let body = problem.add_body(k.len()).unwrap();
        let (ptr, col): (Vec<usize>, Vec<i64>) = ((0..=k.len()).collect(), (0..k.len() as i64).collect());
        let input = SparseInput { ptr: &ptr, col: &col, val: &k, storage: Storage::Lower };
        problem.set_stiffness(body, input).unwrap();
        problem.set_load(body, &vec![10.0; k.len()]).unwrap();
    }
    problem.set_i64("glue", 1).unwrap();
    problem.set_numbering(0, &[7, 8]).unwrap();
    problem.set_numbering(1, &[8]).unwrap();
    problem.solve().unwrap();
    let u = problem.displacements().unwrap();
    assert!(u.iter().zip([10.0, 4.0, 4.0]).all(|(u, right)| (u - right).abs() < 1e-13), "{u:?}");
}
