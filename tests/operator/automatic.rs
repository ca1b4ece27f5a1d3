//! Option `dual_operator` = `automatic`: a body whose K+ is a function is applied matrix-free until its products have cost as much as F_p.

use std::sync::atomic::Ordering;

use decks::rubbing::{push, with_friction};
use decks::{Blocks, Deck};
use feti_contact::solver::{Problem, Report, RowKind};

use super::host::{Form, Host};
use super::{answer, assert_same, cube, extra_row, hosts_of, problem_of, solved};
use crate::support::hand_over;

/// As the library supposes: columns in a block that cost as much as one alone.
const ALONE: usize = 4;

/// Two flat blocks, 121 rows between them.
fn flat() -> Deck {
    Blocks { elements: 10, ..Blocks::default() }.layered(1)
}

/// Columns of K+ since the last count.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Columns {
    alone: usize,
    together: usize,
}

impl Columns {
    fn cost(self) -> usize {
        ALONE * self.alone + self.together
    }
}

fn counted(host: &Host) -> Columns {
    let [all, alone] =
        [&host.book.columns_of_kplus, &host.book.columns_alone].map(|n| n.swap(0, Ordering::Relaxed));
    Columns { alone, together: all - alone }
}

fn problem(deck: &Deck, hosts: &[Host], form: &str, threads: i64) -> Problem {
    let mut problem = problem_of(deck);
    problem.set_str("dual_operator", form).unwrap();
    problem.set_i64("threads", threads).unwrap();
    problem.set_f64("tolerance", 1e-12).unwrap();
    hosts.iter().enumerate().for_each(|(p, host)| host.give(&mut problem, p, threads > 1));
    problem
}

fn with_load(problem: &mut Problem, deck: &Deck, factor: f64) -> Report {
    for (p, body) in deck.bodies.iter().enumerate() {
        let load: Vec<f64> = body.load.iter().map(|f| factor * f).collect();
        problem.set_load(p, &load).unwrap();
    }
    solved(problem)
}

#[test]
fn a_solve_spends_no_more_than_twice_the_better_and_what_the_rule_says() {
    for deck in [cube(), flat(), Blocks { elements: 6, ..Blocks::default() }.build()] {
        let hosts = hosts_of(&deck, Form::Held);
        let [explicit, implicit, automatic] = ["explicit", "implicit", "automatic"].map(|form| {
            let mut problem = problem(&deck, &hosts, form, 1);
            problem.set_str("finish", "none").unwrap();
            let report = solved(&mut problem);
            (hosts.iter().map(counted).collect::<Vec<_>>(), report)
        });
        let mut open = 0;
        for p in 0..hosts.len() {
            let [explicit, implicit, automatic] = [&explicit, &implicit, &automatic].map(|of| of.0[p]);
            let (rows, products) = (explicit.together - implicit.together, implicit.alone - explicit.alone);
            let before = if rows > 32 { rows.div_ceil(ALONE) - 1 } else { 0 };
            let what = format!("{}, body {p}: {rows} rows, {products} products", deck.name);
            if products > before {
                assert_eq!(automatic.together, explicit.together, "{what}");
                assert_eq!(automatic.alone, explicit.alone + before, "{what}");
            } else {
                open += 1;
                assert_eq!(automatic.together, implicit.together, "{what}");
            }
            assert!(automatic.cost() <= 2 * explicit.cost().min(implicit.cost()), "{what}");
        }
        assert_eq!(automatic.1.implicit_operators, open, "{}", deck.name);
    }
}

#[test]
fn answers_are_those_of_assembled_operators_with_the_same_bits_on_any_threads() {
    let friction = {
        let blocks = Blocks { elements: 4, ..Blocks::default() }.build();
        let pressed = decks::rubbing::pressed(&blocks);
        let mut deck = with_friction(blocks, 0.3);
        push(&mut deck, 1, [0.1 * pressed, 0.0]);
        deck
    };
    for deck in [cube(), flat(), friction] {
        let hosts = hosts_of(&deck, Form::Regularised);
        let solve_steps = |form: &str, threads: i64| {
            let mut problem = problem(&deck, &hosts, form, threads);
            problem.set_str("start", "previous").unwrap();
            [1.0, 1.2, 0.9].map(|factor| {
                with_load(&mut problem, &deck, factor);
                answer(&problem)
            })
        };
        let expected = solve_steps("explicit", 1);
        let found = solve_steps("automatic", 1);
        for (found, expected) in found.iter().zip(&expected) {
            assert_same(found, expected, 1e-10, &deck.name);
        }
        for threads in [2, 3] {
            assert!(
                solve_steps("automatic", threads) == found,
                "{}: other bits on {threads} threads",
                deck.name
            );
        }
    }
}

#[test]
fn a_second_load_with_the_same_stiffness_assembles_what_the_first_has_used() {
    let deck = flat();
    let (hosts, rows) = (hosts_of(&deck, Form::Held), deck.contact.len());
    let mut problem = problem(&deck, &hosts, "automatic", 1);
    assert_eq!(with_load(&mut problem, &deck, 1.0).implicit_operators, 2);
    let first: Vec<Columns> = hosts.iter().map(counted).collect();
    let report = with_load(&mut problem, &deck, 1.1);
    assert_eq!((report.explicit_operators, report.work.columns_computed), (2, 2 * rows));
    for (host, first) in hosts.iter().zip(first) {
        let second = counted(host);
        assert!(second.together == rows && second.alone < first.alone, "{second:?} after {first:?}");
    }
    with_load(&mut problem, &deck, 1.2);
    assert!(hosts.iter().all(|host| counted(host).together == 0));
    // a row more is a column more
    hand_over::add_rows(&mut problem, RowKind::Inequality, &extra_row(&deck)).unwrap();
    let report = with_load(&mut problem, &deck, 1.0);
    assert_eq!((report.explicit_operators, report.work.columns_computed), (2, 2 * rows + 1));
    hosts.iter().for_each(|host| _ = counted(host));
    // with the next K it is assembled at once
    hosts.iter().enumerate().for_each(|(p, host)| host.give(&mut problem, p, false));
    problem.setup().unwrap();
    assert!(hosts.iter().all(|host| counted(host).together > rows));
}

#[test]
fn with_a_stiffness_for_every_solve_nothing_is_assembled_that_one_solve_does_not_pay() {
    let deck = flat();
    let hosts = hosts_of(&deck, Form::Held);
    let mut problem = problem(&deck, &hosts, "automatic", 1);
    for factor in [1.0, 1.1, 1.2] {
        hosts.iter().enumerate().for_each(|(p, host)| host.give(&mut problem, p, false));
        let report = with_load(&mut problem, &deck, factor);
        assert_eq!((report.explicit_operators, report.work.columns_computed), (0, 0));
    }
    // the option still holds at once
    problem.set_str("dual_operator", "explicit").unwrap();
    assert_eq!(with_load(&mut problem, &deck, 1.0).explicit_operators, 2);
}
