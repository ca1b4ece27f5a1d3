//! New contact rows: factors stay, and so do the columns of rows that were there.

use decks::{Blocks, Deck, Rows};
use feti_contact::solver::{Problem, RowKind};

use crate::{answer, assert_near, hand_over, spent, touches};

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
fn the_same_rows_again_cost_nothing_in_any_order() {
    let deck = deck();
    let mut problem = hand_over::problem(&deck).unwrap();
    let (mut before, all) = ([0; 4], touches(&deck));
    spent(&mut problem, &mut before);
    let first = answer(&problem);
    replace_rows(&mut problem, &deck);
    assert_eq!(spent(&mut problem, &mut before), [0, 0, 0, all]);
    assert!(answer(&problem) == first, "bits differ");
    let turned = with_rows(&deck, (0..deck.contact.len()).rev());
    replace_rows(&mut problem, &turned);
    assert_eq!(spent(&mut problem, &mut before), [0, 0, 0, all]);
    let [u, lambda, _] = answer(&problem);
    assert_near(&u, &first[0], 1e-9, "u");
    assert_near(&lambda.into_iter().rev().collect::<Vec<_>>(), &first[1], 1e-8, "lambda");
}

#[test]
fn few_new_rows_cost_their_own_columns_and_give_the_answer_of_a_new_problem() {
    let deck = deck();
    let m = deck.contact.len();
    let known = |row: &usize| ![5, 40].contains(row);
    let mut problem = hand_over::problem(&with_rows(&deck, (0..m).filter(known))).unwrap();
    let mut before = [0; 4];
    assert_eq!(spent(&mut problem, &mut before), [2, 2, 2 * (m - 2), 0]);
    replace_rows(&mut problem, &deck); // the new rows among the others
    assert_eq!(spent(&mut problem, &mut before), [0, 0, 4, 2 * (m - 2)]);
    let mut fresh = hand_over::problem(&deck).unwrap();
    spent(&mut fresh, &mut [0; 4]);
    for (found, expected) in answer(&problem).iter().zip(answer(&fresh)) {
        assert_near(found, &expected, 1e-9, "answer");
    }
    let x: Vec<f64> = (0..m).map(|i| (i as f64).cos()).collect();
    let (mut found, mut expected) = (vec![0.0; m], vec![0.0; m]);
    problem.dual_apply(&x, &mut found).unwrap();
    fresh.dual_apply(&x, &mut expected).unwrap();
    assert_near(&found, &expected, 1e-12, "F x");
}

#[test]
fn rows_that_go_leave_the_columns_of_the_others() {
    let deck = deck();
    let m = deck.contact.len();
    let mut problem = hand_over::problem(&deck).unwrap();
    let mut before = [0; 4];
    spent(&mut problem, &mut before);
    replace_rows(&mut problem, &with_rows(&deck, (0..m).filter(|i| i % 7 != 3)));
    let left = (0..m).filter(|i| i % 7 != 3).count();
    assert_eq!(spent(&mut problem, &mut before), [0, 0, 0, 2 * left]);
}

#[test]
fn many_new_rows_are_assembled_without_a_factorisation() {
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
