//! The answer does not depend on what a problem was before: other loads, gaps, rows or matrices and their answers, nor on having been
//! a file.

use decks::hard;
use decks::random::Random;
use decks::varied;
use decks::yardstick::Answer;
use decks::{Deck, Rows};
use feti_contact::solver::{Outcome, Problem, RowKind};

use crate::battery::hard::yardstick;
use crate::battery::seeds;
use crate::battery::varied::{answer, CONDITION};
use crate::support::hand_over;

const LINES: usize = 60;
/// Number of problems of the ordinary run, one for this many of the others.
const SHARE: u64 = 2;

/// A problem that has been through two to five other states, and is now that of the deck.
fn lived(deck: &Deck, random: &mut Random, story: &mut Vec<String>) -> Problem {
    let mut problem = hand_over::problem(deck).unwrap();
    if random.chance(0.7) {
        problem.set_str("start", "previous").unwrap();
        story.push("previous".to_string());
    }
    let rounds = 2 + random.below(4);
    for round in 0..rounds {
        let how = random.below(7);
        let state = (how == 5).then(|| problem.save_state().unwrap());
        change(&mut problem, deck, how, random, story);
        let ended =
            problem.solve().map_or_else(|error| format!("{:?}", error.kind), |r| format!("{:?}", r.outcome));
        story.push(ended);
        match state {
            Some(state) => problem.restore_state(state).unwrap(),
            None => restore(&mut problem, deck, how),
        }
        if round + 1 < rounds && random.chance(0.3) {
            let _ = problem.solve();
            story.push("solved".to_string());
        }
    }
    problem
}

/// Something else than the deck has.
fn change(problem: &mut Problem, deck: &Deck, how: usize, random: &mut Random, story: &mut Vec<String>) {
    let factor = [0.0, 0.5, 1.0, 1.5, 1e-3, 1e3, -1.0][random.below(7)];
    match how {
        0 | 5 => {
            story.push(format!("loads {factor:e}"));
            for (p, body) in deck.bodies.iter().enumerate() {
                let load: Vec<f64> = body.load.iter().map(|f| factor * f).collect();
                problem.set_load(p, &load).unwrap();
            }
        }
        1 => {
            story.push("one body without load".to_string());
            let p = random.below(deck.bodies.len());
            problem.set_load(p, &vec![0.0; deck.bodies[p].dofs()]).unwrap();
        }
        2 => {
            story.push(format!("gaps {factor:e}"));
            for (kind, rows) in rows(deck) {
                let rhs: Vec<f64> = rows
                    .rhs
                    .iter()
                    .map(|c| if c.is_finite() { c * (1.0 + factor * random.normal()) } else { *c })
                    .collect();
                problem.set_rhs(kind, 0, &rhs).unwrap();
            }
        }
        3 => {
            let part = random.below(1 + deck.contact.len());
            story.push(format!("{part} of {} rows", deck.contact.len()));
            problem.clear_rows(RowKind::Inequality);
            hand_over::add_rows(problem, RowKind::Inequality, &some(&deck.contact, 0..part)).unwrap();
        }
        4 => {
            let p = random.below(deck.bodies.len());
            story.push(format!("stiffness of body {p} times {}", 2.0 + factor.abs()));
            let values: Vec<f64> =
                deck.bodies[p].stiffness.val.iter().map(|k| (2.0 + factor.abs()) * k).collect();
            problem.set_values(p, &values).unwrap();
        }
        _ => {
            story.push("no rows".to_string());
            rows(deck).iter().for_each(|(kind, _)| problem.clear_rows(*kind));
        }
    }
}

fn rows(deck: &Deck) -> [(RowKind, &Rows); 2] {
    [(RowKind::Inequality, &deck.contact), (RowKind::Equality, &deck.equalities)]
}

fn some(rows: &Rows, range: std::ops::Range<usize>) -> Rows {
    let mut some = Rows::none(rows.matrix.cols);
    for i in range {
        let entries: Vec<_> = rows.matrix.row(i).collect();
        some.push_compliant(&entries, rows.rhs[i], rows.compliance[i]);
    }
    some
}

/// What has been changed becomes that of the deck again.
fn restore(problem: &mut Problem, deck: &Deck, how: usize) {
    match how {
        0 | 1 => {
            deck.bodies.iter().enumerate().for_each(|(p, body)| problem.set_load(p, &body.load).unwrap())
        }
        2 => rows(deck).iter().for_each(|(kind, rows)| problem.set_rhs(*kind, 0, &rows.rhs).unwrap()),
        3 => {
            let have = problem.sizes().rows;
            let rest = some(&deck.contact, have..deck.contact.len());
            hand_over::add_rows(problem, RowKind::Inequality, &rest).unwrap();
        }
        4 => {
            for (p, body) in deck.bodies.iter().enumerate() {
                problem.set_values(p, &body.stiffness.val).unwrap();
            }
        }
        _ => {
            for (kind, rows) in rows(deck) {
                hand_over::add_rows(problem, kind, rows).unwrap();
            }
        }
    }
}

/// The answer, or in words why there is none.
fn end(problem: &mut Problem) -> Result<Answer, String> {
    match problem.solve() {
        Ok(report) if report.outcome == Outcome::Solved => Ok(answer(problem)),
        Ok(report) => Err(format!("{:?}", report.outcome)),
        Err(error) => Err(format!("{:?}", error.kind)),
    }
}

/// What differs between two answers, or `None`: deformations and forces by the yardstick, u as a whole by 1e-6 of its own.
fn difference(deck: &Deck, a: &Answer, b: &Answer, undetermined: bool) -> Option<String> {
    let yardstick = yardstick(deck, b, undetermined, 0.0);
    let (error, body) = yardstick.worst(a);
    if error > 1.0 {
        return Some(format!("error {error:.1e} of allowed at body {body}"));
    }
    for p in 0..deck.bodies.len() {
        let moved: Vec<f64> = a.u.iter().zip(&b.u).map(|(a, b)| a - b).collect();
        let allowed = (1e-6 * yardstick.norm(p, &b.u, 1)).max(100.0 * yardstick.sizes[p].overlooked);
        let moved = yardstick.norm(p, &moved, 1);
        if moved > allowed {
            let size = |u: &[f64]| {
                let all = (0..deck.bodies.len()).map(|q| yardstick.norm(q, u, 1).powi(2));
                all.sum::<f64>().sqrt()
            };
            let forces = |a: &Answer| {
                let some = || a.lambda.iter().copied().filter(|force| *force > 0.0);
                format!(
                    "{} of {:.0e} to {:.0e}",
                    some().count(),
                    some().fold(f64::MAX, f64::min),
                    some().fold(0.0, f64::max)
                )
            };
            return Some(format!(
                "u of body {p} differs by {:.1e} of itself; |u|_D {:e} and fresh {:e}, forces {}, fresh {}",
                moved / yardstick.norm(p, &b.u, 1),
                size(&a.u),
                size(&b.u),
                forces(a),
                forces(b)
            ));
        }
    }
    None
}

#[test]
fn an_answer_does_not_depend_on_what_the_problem_was_before() {
    let (mut table, mut ends, mut compared) = (Vec::new(), Vec::new(), 0);
    for seed in seeds().step_by(SHARE as usize) {
        let mut random = Random::new(seed ^ 0x6869_7374);
        let (deck, undetermined, condition) = if random.chance(0.6) {
            let case = hard::mixed(seed, crate::battery::hard::mixture());
            (case.deck, case.undetermined > 0, case.condition)
        } else {
            let case = varied::mixed(seed, crate::battery::mixture());
            (case.deck, case.undetermined > 0, case.condition)
        };
        if hand_over::problem(&deck).is_err() {
            continue;
        }
        let mut story = Vec::new();
        let mut with_past = lived(&deck, &mut random, &mut story);
        let bytes = with_past.write_bytes().unwrap();
        let (mut read, mut fresh) = (Problem::new(), hand_over::problem(&deck).unwrap());
        read.read_bytes(&bytes).unwrap();
        let [past, read, fresh] = [&mut with_past, &mut read, &mut fresh].map(end);
        let name = format!("{} ({condition:.0e}, undetermined {undetermined}) {story:?}", deck.name);
        match (&read, &fresh) {
            (Ok(a), Ok(b)) if a.u == b.u && a.lambda == b.lambda && a.mu == b.mu => {}
            (Err(a), Err(b)) if a == b => {}
            _ => table.push(format!("{name}: not the bits of its file")),
        }
        match (&past, &fresh) {
            (Ok(a), Ok(b)) => {
                compared += 1;
                let differs = difference(&deck, a, b, undetermined).filter(|_| condition <= CONDITION);
                table.extend(differs.map(|what| format!("{name}: {what}")));
            }
            (Err(a), Err(b)) if a == b => {}
            // rounding may decide
            _ if condition > CONDITION => {}
            _ => ends.push(format!("{name}: {:?}, fresh {:?}", past.as_ref().err(), fresh.as_ref().err())),
        }
    }
    if std::env::var("BATTERY").is_err() {
        table.truncate(LINES);
        ends.truncate(LINES);
    }
    assert!(
        table.is_empty() && ends.is_empty(),
        "{} of {compared} differ, {} end otherwise:\n{}\nends:\n{}",
        table.len(),
        ends.len(),
        table.join("\n"),
        ends.join("\n")
    );
}
