//! Varied problems whose K does not quite have its rigid motions: entries of 8 to 12 digits, or springs of 1e-12 to 1e-6 of K at some
//! unknowns. The answer is that of the K given, by conditions solved dense in double-double arithmetic on the rows that have a force;
//! where the host says that motions are free, or nothing, it may be off by what rounding and springs have changed.

use std::collections::BTreeMap;
use std::fmt::Write;

use decks::dd::Dd;
use decks::random::Random;
use decks::varied::{self, Class, Varied};
use decks::yardstick::{Answer, Yardstick};
use decks::{Deck, Rows};
use feti_contact::error::{Error, Kind, Proof, Result};
use feti_contact::solver::{Modes, Outcome, Problem};

use crate::battery::some_seeds;
use crate::battery::varied::{answer, CONDITION};
use crate::support::{face, hand_over};

/// Number of problems of the ordinary run, one for this many of the others.
const SHARE: u64 = 2;
/// Of the problems of a class this part may have no answer.
const UNSOLVED: f64 = 0.01;
const LINES: usize = 60;
/// Pivots of the conditions that are rounding.
const SINGULAR: f64 = 1e-24;
/// What a row moves by rounding, against its largest entry and the fastest unknown.
const STILL: f64 = 1e-8;

/// What the host says of the rigid motions.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
enum Told {
    Exact,
    Soft,
    Nothing,
}

#[derive(Clone, Copy, Debug, PartialEq)]
enum Change {
    /// Decimal digits of the entries of K.
    Digits(usize),
    /// Springs of so much of the largest K_ii.
    Springs(i32),
}

impl Change {
    fn of(seed: u64) -> Self {
        if seed % 2 == 0 {
            Self::Digits(8 + (seed / 2 % 5) as usize)
        } else {
            Self::Springs(-12 + (seed / 2 % 7) as i32)
        }
    }

    fn made(self, deck: &Deck, seed: u64) -> Deck {
        let (mut deck, mut random) = (deck.clone(), Random::new(seed ^ 0x50f7));
        for body in deck.bodies.iter_mut().filter(|body| !body.modes().is_empty()) {
            let largest = body.stiffness.diagonal().into_iter().fold(0.0, f64::max);
            match self {
                Self::Digits(digits) => body
                    .stiffness
                    .val
                    .iter_mut()
                    .for_each(|v| *v = format!("{v:.*e}", digits - 1).parse().unwrap()),
                Self::Springs(decade) => {
                    for dof in 0..body.dofs() {
                        let row = body.stiffness.ptr[dof]..body.stiffness.ptr[dof + 1];
                        let at = row.start + body.stiffness.col[row].iter().position(|j| *j == dof).unwrap();
                        if random.chance(0.4) {
                            body.stiffness.val[at] += 10f64.powi(decade) * largest;
                        }
                    }
                }
            }
        }
        deck
    }
}

fn problem(deck: &Deck, told: Told) -> Result<Problem> {
    let modes = match told {
        Told::Exact => return hand_over::problem(deck),
        Told::Nothing => return hand_over::without_null_spaces(deck),
        Told::Soft => Modes::Soft,
    };
    let mut problem = hand_over::without_null_spaces(deck)?;
    for (p, body) in deck.bodies.iter().enumerate() {
        let (n, motions) = (body.dofs(), body.modes());
        problem.set_null_space(p, n, motions.len(), &motions.concat(), n, modes)?;
    }
    Ok(problem)
}

/// The optimality conditions on the rows with a force; none where they are singular.
fn on_face(deck: &Deck, forces: &[f64]) -> Option<Answer> {
    let closed: Vec<usize> = (0..forces.len()).filter(|&i| forces[i] > 0.0).collect();
    face::answer(deck, &closed, SINGULAR)
}

/// Forces of the truth push, and no row is passed, but for what the yardstick overlooks.
fn has_signs(deck: &Deck, truth: &Answer) -> bool {
    let most = truth.lambda.iter().chain(&truth.mu).fold(0.0, |m: f64, l| m.max(l.abs()));
    let moved = deck.contact.matrix.times(&truth.u);
    let given = deck.contact.compliance.iter().zip(&truth.lambda).map(|(c, l)| c * l);
    let given: Vec<f64> = given.chain(deck.contact.rhs.iter().copied().filter(|c| c.is_finite())).collect();
    let far = moved.iter().chain(&truth.u).chain(&given).fold(0.0, |m: f64, v| m.max(v.abs()));
    let open = |i: usize| deck.contact.rhs[i] + deck.contact.compliance[i] * truth.lambda[i] - moved[i];
    truth.lambda.iter().all(|l| *l >= -1e-6 * most) && (0..moved.len()).all(|i| open(i) >= -1e-6 * far)
}

#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
enum Verdict {
    Answered,
    /// Motions that K resists by 1e-8 of its stiffness are not its null space; springs of 1e-11 have no gap to rounding.
    Unread,
    Refused,
    Inaccurate,
    Wrong,
    /// The conditions are singular, or the case is beyond the condition.
    Unknown,
}

/// The energy has no least value: along the motion of the error K as it is given is negative, and no row is in the way.
fn falls_without_end(deck: &Deck, error: &Error) -> bool {
    let (Kind::Indefinite, Some(Proof::Motion { v, .. })) = (error.kind, error.proof.as_deref()) else {
        return false;
    };
    let mut energy = Dd::ZERO;
    for (p, body) in deck.bodies.iter().enumerate() {
        let own = &v[deck.offset(p)..deck.offset(p + 1)];
        for i in 0..body.dofs() {
            body.stiffness.row(i).for_each(|(j, k)| energy = energy + Dd::product(own[i], own[j]) * k.into());
        }
    }
    let still = |rows: &Rows, i: usize| STILL * rows.matrix.row(i).map(|(_, b)| b.abs()).fold(0.0, f64::max);
    let moved = |rows: &Rows| rows.matrix.times(v);
    energy.value() < 0.0
        && moved(&deck.contact).iter().enumerate().all(|(i, moved)| *moved <= still(&deck.contact, i))
        && moved(&deck.equalities)
            .iter()
            .enumerate()
            .all(|(i, moved)| moved.abs() <= still(&deck.equalities, i))
}

fn verdict(case: &Varied, deck: &Deck, told: Told) -> (Verdict, String) {
    let ended = problem(deck, told).and_then(|mut problem| problem.solve().map(|report| (problem, report)));
    let (problem, report) = match ended {
        Err(error) if told != Told::Soft && error.kind == Kind::NullSpace => {
            return (Verdict::Unread, format!("{:?}", error.kind))
        }
        Err(error) if told == Told::Soft && falls_without_end(deck, &error) => {
            return (Verdict::Answered, String::new())
        }
        Err(error) => return (Verdict::Refused, error.to_string()),
        Ok(ended) => ended,
    };
    if report.outcome != Outcome::Solved {
        return (Verdict::Inaccurate, format!("{:?} {:.1e}", report.outcome, report.certificate.worst()));
    }
    let found = answer(&problem);
    let Some(truth) = on_face(deck, &found.lambda) else { return (Verdict::Unknown, String::new()) };
    let yardstick = Yardstick::new(deck, &truth, false);
    let plain = Answer {
        u: case.displacement.clone(),
        lambda: case.forces.clone(),
        mu: case.equality_forces.clone(),
    };
    let changed = if told == Told::Soft { 0.0 } else { 2.0 * yardstick.worst(&plain).0 };
    let error = yardstick.worst(&found).0;
    if error > 1.0 && varied::condition(deck, &truth.lambda) > CONDITION {
        return (Verdict::Unknown, String::new());
    }
    if error > 1.0 + changed || !has_signs(deck, &truth) && told == Told::Soft {
        return (Verdict::Wrong, format!("error {error:.1e}, changed {changed:.1e}"));
    }
    (Verdict::Answered, String::new())
}

/// Every motion is held by closed rows, and rows are no function of each other: the answer is one.
fn is_asked(case: &Varied) -> bool {
    let not = [Class::Penalty, Class::Glue, Class::Far, Class::Rounded, Class::Noisy, Class::Moduli];
    case.undetermined == 0
        && case.condition <= CONDITION
        && !case.classes.iter().any(|class| not.contains(class))
}

#[test]
fn stiffness_that_all_but_has_its_rigid_motions_is_taken_as_it_is() {
    let mut table: BTreeMap<String, BTreeMap<Verdict, usize>> = BTreeMap::new();
    let mut lists: BTreeMap<Verdict, Vec<String>> = BTreeMap::new();
    for seed in some_seeds(SHARE) {
        let (case, change) = (varied::case(seed), Change::of(seed / 13));
        if !is_asked(&case) {
            continue;
        }
        let deck = change.made(&case.deck, seed);
        let of = match change {
            Change::Digits(_) => &[Told::Exact, Told::Soft, Told::Nothing][..],
            Change::Springs(_) => &[Told::Soft, Told::Nothing][..],
        };
        for &told in of {
            let (verdict, what) = verdict(&case, &deck, told);
            *table.entry(format!("{told:?} {change:?}")).or_default().entry(verdict).or_default() += 1;
            if !matches!(verdict, Verdict::Answered | Verdict::Unknown) {
                let line =
                    format!("{seed:6} {told:?} {change:?} {what} ({}, {:.0e})", case.kind(), case.condition);
                lists.entry(verdict).or_default().push(line);
            }
        }
    }
    let mut text = String::new();
    table.iter().for_each(|(class, ends)| writeln!(text, "{class:24} {ends:?}").unwrap());
    for (verdict, lines) in &lists {
        let _ =
            writeln!(text, "{verdict:?}: {}\n{}", lines.len(), lines[..lines.len().min(LINES)].join("\n"));
    }
    if std::env::var("BATTERY").is_ok() {
        println!("{text}");
    }
    let count = |verdict: Verdict| lists.get(&verdict).map_or(0, Vec::len);
    let all: usize = table.values().flat_map(BTreeMap::values).sum();
    let unsolved = count(Verdict::Refused) + count(Verdict::Inaccurate);
    let may_be_unread = |line: &String| {
        ["Exact Digits(8)", "Nothing Springs(-11)", "Nothing Springs(-10)"]
            .iter()
            .any(|class| line.contains(class))
    };
    // motions that the host tells of leave no doubt
    let doubted = [Verdict::Refused, Verdict::Inaccurate, Verdict::Unread].map(|verdict| {
        let lines = lists.get(&verdict).map_or(&[][..], Vec::as_slice);
        lines.iter().filter(|line| line.contains(" Soft ")).count()
    });
    assert_eq!(doubted, [0; 3], "{text}");
    let unread = lists.get(&Verdict::Unread).is_none_or(|lines| lines.iter().all(may_be_unread));
    assert!(unread && count(Verdict::Wrong) == 0 && unsolved <= (UNSOLVED * all as f64) as usize, "{text}");
}
