//! Negative stiffness at the top corners of blocks that stand on three nodes each: the tilt of a pressed block.

use decks::dense::{eigenvalues, solve};
use decks::Deck;
use feti_contact::error::Kind;
use feti_contact::solver::{Modes, Problem, RowKind, RowsInput, Storage};

use crate::soft::{
    add_diagonal, assert_same_bits_for_any_threads, column_on, difference, given, oracle, solved, ELEMENTS,
};
use crate::support::hand_over;

pub fn narrow(blocks: usize) -> Deck {
    column_on(blocks, 3..=5, 1e-3)
}

/// Unknowns along x of the top corners, over all unknowns.
fn driven(deck: &Deck) -> Vec<usize> {
    let [nx, ny, _] = ELEMENTS;
    let corners = [ny * (nx + 1), ny * (nx + 1) + nx];
    (0..deck.bodies.len()).flat_map(|p| corners.map(|node| deck.offset(p) + 2 * node)).collect()
}

pub fn with_drive(mut deck: Deck, drive: f64) -> Deck {
    for dof in driven(&deck) {
        let p = (0..deck.bodies.len()).rfind(|&p| deck.offset(p) <= dof).unwrap();
        let own = dof - deck.offset(p);
        add_diagonal(&mut deck.bodies[p], own, -drive);
    }
    deck
}

/// The drive at which K is singular on the unknowns that these rows leave free.
fn critical(deck: &Deck, closed: &[usize]) -> f64 {
    let n = deck.dofs();
    let mut rows: Vec<Vec<(usize, f64)>> =
        closed.iter().map(|&i| deck.contact.matrix.row(i).collect()).collect();
    rows.extend((0..deck.equalities.len()).map(|i| deck.equalities.matrix.row(i).collect()));
    let size = n + rows.len();
    let mut a = vec![0.0; size * size];
    for (p, body) in deck.bodies.iter().enumerate() {
        let first = deck.offset(p);
        for i in 0..body.dofs() {
            body.stiffness.row(i).for_each(|(j, v)| a[(first + i) * size + first + j] = v);
        }
    }
    for (k, row) in rows.iter().enumerate() {
        for &(j, v) in row {
            (a[(n + k) * size + j], a[j * size + n + k]) = (v, v);
        }
    }
    let dofs = driven(deck);
    let mut moved = Vec::new();
    for &dof in &dofs {
        let mut b = vec![0.0; size];
        b[dof] = 1.0;
        let x = solve(a.clone(), b).unwrap();
        moved.extend(dofs.iter().map(|&j| x[j]));
    }
    1.0 / eigenvalues(moved, dofs.len()).into_iter().fold(0.0, f64::max)
}

pub fn closed(lambda: &[f64]) -> Vec<usize> {
    (0..lambda.len()).filter(|&i| lambda[i] > 0.0).collect()
}

#[test]
fn driven_motions_give_the_forces_of_the_dense_answer() {
    let mut failed = Vec::new();
    for blocks in [1, 2, 3] {
        let deck = narrow(blocks);
        let plain = solved(&mut hand_over::problem(&deck).unwrap()).unwrap();
        let most = critical(&deck, &closed(&plain.lambda));
        for rho in [0.007, 0.03, 0.3, 0.9] {
            let deck = with_drive(deck.clone(), rho * most);
            let found = match solved(&mut given(&deck, Modes::Soft)) {
                Ok(found) => found,
                Err(error) => {
                    failed.push(format!("rho {rho}, {blocks} blocks: {error}"));
                    continue;
                }
            };
            let truth = oracle::solve(&deck, &closed(&found.lambda)).unwrap();
            let (forces, u) = (difference(&found.lambda, &truth.lambda), difference(&found.u, &truth.u));
            let line =
                format!(
                "rho {rho}, {blocks} blocks: forces {forces:.1e} u {u:.1e} products {} of {}, drive {:.1e}",
                found.products, plain.products, rho * most
            );
            let few = rho > 0.03 || found.products <= 2 * plain.products;
            if !(forces <= 1e-8 && u <= 1e-8 && few) {
                failed.push(line);
            }
        }
    }
    assert!(failed.is_empty(), "{}", failed.join("\n"));
}

/// Drives at the feet, which rows hold: K held at one unknown for each motion given is indefinite all the same.
#[test]
fn further_unknowns_are_held_where_those_of_the_motions_leave_a_driven_body_indefinite() {
    for share in [0.2, 0.3, 0.4, 0.5, 0.6, 0.7, 0.8, 0.9] {
        let mut deck = narrow(1);
        let diagonal = deck.bodies[0].stiffness.diagonal();
        for dof in [3, 4, 5].map(|node| 2 * node + 1) {
            add_diagonal(&mut deck.bodies[0], dof, -share * diagonal[dof]);
        }
        let mut problem = given(&deck, Modes::Soft);
        let found = solved(&mut problem).unwrap();
        let truth = oracle::solve(&deck, &closed(&found.lambda)).unwrap();
        let motions = problem.body_facts(0).unwrap().factors.unwrap().null_space;
        let (forces, u) = (difference(&found.lambda, &truth.lambda), difference(&found.u, &truth.u));
        assert!(motions > 3 && forces <= 1e-11 && u <= 1e-11);
    }
}

/// One block alone drives itself, the one in the middle by the last unknowns.
#[test]
fn an_answer_that_is_no_minimum_is_refused_with_its_motion() {
    for blocks in [1, 2, 3] {
        let deck = narrow(blocks);
        let plain = solved(&mut hand_over::problem(&deck).unwrap()).unwrap();
        let most = critical(&deck, &closed(&plain.lambda));
        for rho in [1.1, 2.1] {
            let mut problem = given(&with_drive(deck.clone(), rho * most), Modes::Soft);
            let error = solved(&mut problem).err().expect("no minimum");
            assert_eq!(error.kind, Kind::Indefinite, "{error}");
            let body = error.place.body.unwrap();
            let v = problem.escaping_motion(body).unwrap();
            // a tilt of the block about its foot moves its top aside
            let top = driven(&deck)[2 * body] - deck.offset(body);
            assert!(v[top].abs() > 0.2 && (v[top] / v[top + 2] - 1.0).abs() < 10.0, "{}", v[top]);
        }
    }
}

/// A column on its ridge between two stops, of which the second is farther: the ridge is an equilibrium.
#[test]
fn from_an_equilibrium_that_is_no_minimum_a_driven_body_moves_to_the_farther_stop() {
    for (near, far) in [(0.5, 2.0), (1.0, f64::INFINITY)] {
        let mut problem = Problem::new();
        problem.add_body(1).unwrap();
        problem.set_null_space(0, 1, 1, &[1.0], 1, Modes::Soft).unwrap();
        problem.set_stiffness_dense(0, 1, &[-3.0], 1, Storage::Full).unwrap();
        let rows = RowsInput {
            ptr: &[0, 1, 2],
            body: None,
            dof: &[0, 0],
            val: &[1.0, -1.0],
            rhs: Some(&[near, far]),
        };
        problem.add_rows(RowKind::Inequality, rows).unwrap();
        match solved(&mut problem) {
            Ok(found) => assert_eq!((found.u, found.lambda), (vec![-far], vec![0.0, 3.0 * far])),
            Err(error) => assert!(far.is_infinite() && error.kind == Kind::Indefinite, "{error}"),
        }
    }
}

#[test]
fn a_driven_motion_that_nothing_resists_is_no_minimum() {
    let mut deck = narrow(1);
    deck.equalities = decks::Rows::none(deck.dofs());
    deck.bodies[0].load[2 * ELEMENTS[1] * (ELEMENTS[0] + 1)] = 0.0;
    let error = solved(&mut given(&with_drive(deck, 1e-6), Modes::Soft)).err().expect("no minimum");
    assert_eq!((error.kind, error.place.body), (Kind::Indefinite, Some(0)));
}

#[test]
fn the_answer_with_driven_motions_is_the_same_for_any_number_of_threads() {
    assert_same_bits_for_any_threads(&with_drive(narrow(3), 1e-4));
}

/// Faces that are too large for dense factors: the rounds go on by themselves.
#[test]
fn driven_motions_need_no_dense_factors() {
    let deck = narrow(2);
    let plain = solved(&mut hand_over::problem(&deck).unwrap()).unwrap();
    let most = critical(&deck, &closed(&plain.lambda));
    let without = |rho: f64| {
        let mut problem = given(&with_drive(deck.clone(), rho * most), Modes::Soft);
        problem.set_i64("direct_limit", 0).unwrap();
        solved(&mut problem)
    };
    for rho in [0.03, 0.3, 0.5] {
        let found = without(rho).unwrap();
        let truth = oracle::solve(&with_drive(deck.clone(), rho * most), &closed(&found.lambda)).unwrap();
        let error = difference(&found.lambda, &truth.lambda);
        // certified to 1e-8 of the forces on a body; an error of a grows by 1 / (1 - rho)
        assert!(error <= 1e-8 / (1.0 - rho), "rho {rho}: {error:.1e}");
    }
    let error = without(1.3).err().expect("no minimum");
    assert_eq!(error.kind, Kind::Indefinite, "{error}");
}

/// A push aside that neither rows nor K hold: no answer, by one name or the other.
#[test]
fn a_load_along_a_driven_motion_that_nothing_resists_has_no_answer() {
    let mut deck = narrow(1);
    deck.equalities = decks::Rows::none(deck.dofs());
    let error = solved(&mut given(&with_drive(deck, 1e-6), Modes::Soft)).err().expect("no minimum");
    assert!(matches!(error.kind, Kind::Indefinite | Kind::LoadNotHeld), "{error}");
}
