//! New contact rows: factors stay, and so do the dual operators of bodies whose rows are those that were there.

use decks::{Blocks, Deck, Rows};
use feti_contact::solver::{Problem, RowKind};

use crate::reuse::{answer, spent, touches};
use crate::support::hand_over;

fn deck() -> Deck {
    Blocks { elements: 8, young: 1.0 }.build()
}

/// The deck with these of its contact rows, in this order.
fn with_rows(deck: &Deck, rows: impl Iterator<Item = usize>) -> Deck {
    let mut contact = Rows::none(deck.dofs());
    for row in rows {
        let entries: Vec<_> = deck.contact.matrix.row(row).collect();
        contact.push(&entries, deck.contact.rhs[row]);
    }
    Deck { contact, ..deck.clone() }
}

fn replace_rows(problem: &mut Problem, deck: &Deck) {
    problem.clear_rows(RowKind::Inequality);
    hand_over::add_rows(problem, RowKind::Inequality, &deck.contact).unwrap();
}

#[test]
fn the_same_rows_again_cost_nothing() {
    let deck = deck();
    let mut problem = hand_over::problem(&deck).unwrap();
    let (mut before, all) = ([0; 4], touches(&deck));
    spent(&mut problem, &mut before);
    let first = answer(&problem);
    replace_rows(&mut problem, &deck);
    assert_eq!(spent(&mut problem, &mut before), [0, 0, 0, all]);
    assert!(answer(&problem) == first, "bits differ");
}

#[test]
fn new_rows_are_assembled_without_a_factorisation() {
    let deck = deck();
    let m = deck.contact.len();
    let mut problem = hand_over::problem(&with_rows(&deck, 0..m / 2)).unwrap();
    let mut before = [0; 4];
    spent(&mut problem, &mut before);
    replace_rows(&mut problem, &deck);
    assert_eq!(spent(&mut problem, &mut before), [0, 0, 2 * m, 0]);
}

/// Rows of it and of its neighbour have other scales then; the third body has none of them.
#[test]
fn a_new_matrix_of_one_body_leaves_the_columns_of_bodies_it_shares_no_row_with() {
    let stack = decks::Stack {
        bodies: 3,
        in_plane: vec![4, 3],
        layers: vec![1],
        flat: true,
        ..decks::Stack::default()
    };
    let deck = stack.build();
    let mut problem = hand_over::problem(&deck).unwrap();
    let mut before = [0; 4];
    let first = spent(&mut problem, &mut before);
    let mut other = deck.bodies[0].clone();
    other.stiffness.val.iter_mut().for_each(|v| *v *= 1.1);
    hand_over::set_body(&mut problem, 0, &other).unwrap();
    let second = spent(&mut problem, &mut before);
    assert_eq!(second[..2], [0, 1]);
    assert!(second[3] > 0 && second[2] + second[3] == first[2], "{first:?} {second:?}");
}

/// Bits of u, lambda and mu.
fn bits(problem: &mut Problem) -> Vec<u64> {
    spent(problem, &mut [0; 4]);
    answer(problem).concat().into_iter().map(f64::to_bits).collect()
}

/// A column of F that was computed alone, or beside other rows, differs by rounding.
#[test]
fn rows_that_come_and_go_leave_the_bits_of_a_new_problem() {
    for elements in [6, 8, 11, 14] {
        let deck = Blocks { elements, young: 1.0 }.build();
        let m = deck.contact.len();
        let mut problem = hand_over::problem(&deck).unwrap();
        let state = problem.save_state().unwrap();
        let first = bits(&mut problem);
        let parts: [(&str, Vec<usize>); 5] = [
            ("a few go", (0..m).filter(|i| i % 17 != 3).collect()),
            ("some come back", (0..m).filter(|i| i % 34 != 3).collect()),
            ("half go", (0..m).step_by(2).collect()),
            ("all, turned", (0..m).rev().collect()),
            ("one goes", (1..m).collect()),
        ];
        for (name, part) in parts {
            let part = with_rows(&deck, part.into_iter());
            replace_rows(&mut problem, &part);
            let fresh = bits(&mut hand_over::problem(&part).unwrap());
            assert!(bits(&mut problem) == fresh, "{m} rows: {name}");
        }
        problem.restore_state(state).unwrap();
        assert!(bits(&mut problem) == first, "{m} rows: state restored");
    }
}
