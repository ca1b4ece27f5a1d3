//! The forms in which a host hands over matrices and null spaces.

use decks::{Body, Deck};
use feti_contact::solver::{Modes, Problem, SparseInput, Storage};

use crate::invariance::answer::{decks, Answer};
use crate::support::hand_over;

/// The part of K a storage keeps.
fn kept(storage: Storage, i: usize, j: usize) -> bool {
    match storage {
        Storage::Full => true,
        Storage::Lower => j <= i,
        Storage::Upper => j >= i,
    }
}

fn set_sparse(problem: &mut Problem, p: usize, body: &Body, storage: Storage) {
    let (mut ptr, mut col, mut val) = (vec![0], vec![], vec![]);
    for i in 0..body.dofs() {
        let entries: Vec<_> = body.stiffness.row(i).filter(|(j, _)| kept(storage, i, *j)).collect();
        for (j, v) in entries.iter().rev() {
            col.push(*j as i64);
            val.push(*v);
        }
        ptr.push(col.len());
    }
    problem.set_stiffness(p, SparseInput { ptr: &ptr, col: &col, val: &val, storage }).unwrap();
}

/// Column-major with three rows of padding that must not be read.
fn set_dense(problem: &mut Problem, p: usize, body: &Body, storage: Storage) {
    let n = body.dofs();
    let mut k = vec![f64::NAN; (n + 3) * n];
    for j in 0..n {
        for i in (0..n).filter(|&i| kept(storage, i, j)) {
            k[i + j * (n + 3)] = body.stiffness.get(i, j);
        }
    }
    problem.set_stiffness_dense(p, n, &k, n + 3, storage).unwrap();
}

type Form = fn(&mut Problem, usize, &Body, Storage);

fn answer(deck: &Deck, form: Form, storage: Storage) -> Answer {
    let mut problem = hand_over::problem(deck).unwrap();
    deck.bodies.iter().enumerate().for_each(|(p, body)| form(&mut problem, p, body, storage));
    Answer::from(&mut problem, &deck.name)
}

const STORAGES: [Storage; 3] = [Storage::Full, Storage::Lower, Storage::Upper];

#[test]
fn any_triangle_and_any_order_of_entries_gives_the_same_bits() {
    for deck in decks() {
        let expected = Answer::of(&deck);
        for storage in STORAGES {
            answer(&deck, set_sparse, storage).assert_same(&expected, &format!("{} {storage:?}", deck.name));
        }
    }
}

#[test]
fn a_dense_matrix_gives_the_answer_of_a_sparse_one() {
    for deck in decks() {
        let expected = Answer::of(&deck);
        for storage in STORAGES {
            let found = answer(&deck, set_dense, storage);
            found.assert_near(&expected, 1e-9, &format!("{} {storage:?}", deck.name));
        }
    }
}

#[test]
fn another_basis_of_the_null_space_gives_the_same_answer() {
    for deck in decks() {
        let expected = Answer::of(&deck);
        let mut problem = hand_over::problem(&deck).unwrap();
        for (p, body) in deck.bodies.iter().enumerate() {
            let (n, modes) = (body.dofs(), body.modes());
            let mixed = |k: usize| -> Vec<f64> {
                let weight = |l: usize| if l == k { 3.0 } else { 0.5 / (1 + l + 2 * k) as f64 };
                (0..n).map(|i| modes.iter().enumerate().map(|(l, mode)| weight(l) * mode[i]).sum()).collect()
            };
            let basis: Vec<f64> = (0..modes.len()).rev().flat_map(mixed).collect();
            problem.set_null_space(p, n, modes.len(), &basis, n, Modes::Exact).unwrap();
        }
        Answer::from(&mut problem, &deck.name).assert_near(&expected, 1e-9, &deck.name);
    }
}

/// Coordinates instead of null spaces, positions times `length`.
fn from_coordinates(deck: &Deck, length: f64) -> Answer {
    let mut problem = hand_over::without_null_spaces(deck).unwrap();
    for (p, body) in deck.bodies.iter().enumerate() {
        let xyz: Vec<f64> = body.coordinates.iter().flatten().map(|x| x * length).collect();
        problem.set_coordinates(p, 3, &body.node, &body.direction, &xyz, 3).unwrap();
    }
    Answer::from(&mut problem, &deck.name)
}

#[test]
fn coordinates_in_any_unit_give_the_answer_of_exact_null_spaces() {
    for deck in decks() {
        let expected = Answer::of(&deck);
        let metres = from_coordinates(&deck, 1.0);
        metres.assert_near(&expected, 1e-9, &deck.name);
        for exponent in [10, -10] {
            let found = from_coordinates(&deck, 2f64.powi(exponent));
            found.assert_same(&metres, &format!("{}, 2^{exponent}", deck.name));
        }
        from_coordinates(&deck, 1000.0).assert_near(&expected, 1e-9, &deck.name);
    }
}
