//! What must not change an answer: threads, units, the order of nodes, factors of rows, nodes without friction.

use decks::{Deck, Friction, Rows};
use feti_contact::error::Kind;
use feti_contact::solver::{Outcome, Problem};

use crate::coulomb::battery::answer;
use crate::coulomb::drawn::{case, Drawn, SIZES};
use crate::coulomb::enumeration;
use crate::coulomb::judge::{self, Answer};
use crate::support::hand_over;

/// Problems of every class.
const SEEDS: std::ops::Range<u64> = 20_000..20_170;
/// Other units and orders round otherwise: of the largest number of its kind.
const ROUNDING: f64 = 1e-9;

/// The answer, or why there is none.
fn solved(deck: &Deck, options: &str) -> Result<Answer, String> {
    let mut problem = hand_over::problem(deck).map_err(|error| error.to_string())?;
    problem.set_text(options).unwrap();
    ended(&mut problem)
}

fn ended(problem: &mut Problem) -> Result<Answer, String> {
    match problem.solve() {
        Ok(report) if report.outcome == Outcome::Solved => Ok(answer(problem)),
        Ok(report) => Err(format!("{:?}", report.outcome)),
        Err(error) if error.kind == Kind::LoadNotHeld => Err("not held".into()),
        Err(error) => Err(error.to_string()),
    }
}

fn drawn() -> impl Iterator<Item = (u64, Drawn)> {
    SEEDS.map(|seed| (seed, case(seed, &SIZES)))
}

/// All numbers of an answer.
fn numbers(answer: &Answer) -> [&[f64]; 4] {
    [&answer.u, &answer.lambda, &answer.along, &answer.mu]
}

fn bits(ended: &Result<Answer, String>) -> Result<Vec<u64>, String> {
    let of = |answer: &Answer| numbers(answer).concat().iter().map(|v| (v + 0.0).to_bits()).collect();
    ended.as_ref().map(of).map_err(Clone::clone)
}

/// Each kind by its factor.
fn scaled(answer: Answer, [u, lambda, along, mu]: [f64; 4]) -> Answer {
    let by = |v: Vec<f64>, by: f64| v.into_iter().map(|v| v * by).collect();
    Answer {
        u: by(answer.u, u),
        lambda: by(answer.lambda, lambda),
        along: by(answer.along, along),
        mu: by(answer.mu, mu),
    }
}

fn in_units(deck: &Deck, force: f64, length: f64) -> Deck {
    let mut deck = deck.clone();
    for body in &mut deck.bodies {
        body.stiffness.val.iter_mut().for_each(|k| *k *= force / length);
        body.load.iter_mut().for_each(|f| *f *= force);
    }
    for rows in [&mut deck.contact, &mut deck.equalities, &mut deck.friction.rows] {
        rows.rhs.iter_mut().for_each(|c| *c *= length);
        rows.compliance.iter_mut().for_each(|inv_k| *inv_k *= length / force);
    }
    deck.friction.bound.iter_mut().for_each(|bound| *bound *= force);
    deck
}

/// Row i of `rows` by `factor`.
fn multiply(rows: &mut Rows, i: usize, factor: f64) {
    let range = rows.matrix.ptr[i]..rows.matrix.ptr[i + 1];
    rows.matrix.val[range].iter_mut().for_each(|b| *b *= factor);
    rows.rhs[i] *= factor;
    rows.compliance[i] *= factor * factor;
}

#[test]
fn the_bits_are_the_same_for_any_number_of_threads() {
    for (seed, drawn) in drawn() {
        let one = bits(&solved(&drawn.deck, "threads=1"));
        for options in ["threads=2", "threads=4"] {
            assert_eq!(bits(&solved(&drawn.deck, options)), one, "{seed} {}: {options}", drawn.class);
        }
    }
}

/// Bodies without any stiffness have no lengths that belong to forces.
fn is_stiff(deck: &Deck) -> bool {
    deck.bodies.iter().all(|body| size(&body.stiffness.val) > 0.0)
}

#[test]
fn powers_of_two_in_forces_and_lengths_change_no_bit() {
    for (seed, drawn) in drawn().filter(|(_, drawn)| is_stiff(&drawn.deck)) {
        let plain = bits(&solved(&drawn.deck, ""));
        for (force, length) in [(64.0, 1.0), (1.0, 1.0 / 512.0), (2f64.powi(-20), 2f64.powi(31))] {
            let found = solved(&in_units(&drawn.deck, force, length), "");
            let found =
                found.map(|found| scaled(found, [1.0 / length, 1.0 / force, 1.0 / force, 1.0 / force]));
            assert_eq!(bits(&found), plain, "{seed} {}: {force:e} {length:e}", drawn.class);
        }
    }
}

#[test]
fn a_power_of_two_on_all_rows_of_a_node_changes_no_bit() {
    for (seed, drawn) in drawn() {
        let plain = solved(&drawn.deck, "");
        let (mut deck, mut factors) = (drawn.deck.clone(), (Vec::new(), Vec::new()));
        factors.0.resize(deck.contact.len(), 1.0);
        for node in 0..deck.friction.normal.len() {
            let factor = [4.0, 1.0, 0.125][node % 3];
            if let Some(row) = deck.friction.normal[node] {
                multiply(&mut deck.contact, row, factor);
                factors.0[row] = factor;
            }
            for k in 0..deck.friction.dim {
                multiply(&mut deck.friction.rows, node * deck.friction.dim + k, factor);
                factors.1.push(factor);
            }
            deck.friction.bound[node] /= factor;
        }
        let back = |mut found: Answer| {
            found.lambda.iter_mut().zip(&factors.0).for_each(|(l, factor)| *l *= factor);
            found.along.iter_mut().zip(&factors.1).for_each(|(l, factor)| *l *= factor);
            found
        };
        assert_eq!(bits(&solved(&deck, "").map(back)), bits(&plain), "{seed} {}", drawn.class);
    }
}

fn size(v: &[f64]) -> f64 {
    v.iter().fold(0.0, |most: f64, v| most.max(v.abs()))
}

/// How far answers are apart, each kind as a part of its largest number.
fn apart(one: &Answer, other: &Answer) -> f64 {
    let of = |(a, b): (&[f64], &[f64])| {
        let difference: Vec<f64> = a.iter().zip(b).map(|(a, b)| a - b).collect();
        let (difference, whole) = (size(&difference), size(a).max(size(b)));
        if difference == 0.0 {
            0.0
        } else {
            difference / whole
        }
    };
    numbers(one).into_iter().zip(numbers(other)).map(of).fold(0.0, f64::max)
}

/// The only answer there is, no motion undetermined and no force shared at will.
fn is_determined(deck: &Deck) -> bool {
    let all = enumeration::answers(deck);
    let only = all.is_some_and(|all| !all.doubtful && all.answers.len() == 1);
    only && is_stiff(deck)
        && hand_over::problem(deck).unwrap().solve().is_ok_and(|report| report.undetermined == 0)
}

/// Answers that are determined stay what they are.
fn assert_the_same(change: impl Fn(&Deck) -> Deck, back: impl Fn(&Deck, Answer) -> Answer) {
    let (mut same, mut others) = (0, Vec::new());
    for (seed, drawn) in drawn().filter(|(_, drawn)| is_determined(&drawn.deck)) {
        match (solved(&drawn.deck, ""), solved(&change(&drawn.deck), "")) {
            (Ok(one), Ok(other)) => {
                let far = apart(&one, &back(&drawn.deck, other));
                if far <= ROUNDING {
                    same += 1;
                } else {
                    others.push(format!("{seed} {}: {far:.0e}", drawn.class));
                }
            }
            (one, other) => {
                let of = |ended: Result<Answer, String>| ended.err().unwrap_or("solved".into());
                others.push(format!("{seed} {}: {} and {}", drawn.class, of(one), of(other)));
            }
        }
    }
    assert!(others.is_empty() && same > 20, "{same} the same; {others:#?}");
}

#[test]
fn powers_of_ten_in_forces_and_lengths_change_little() {
    let (force, length) = (1e5, 1e-3);
    let by = [1.0 / length, 1.0 / force, 1.0 / force, 1.0 / force];
    assert_the_same(|deck| in_units(deck, force, length), |_, found| scaled(found, by));
}

/// Node `node` of `old`, with the contact row `normal`, as the last one.
fn push_again(nodes: &mut Friction, old: &Friction, node: usize, normal: Option<usize>) {
    let rows = node * old.dim..(node + 1) * old.dim;
    let entries: Vec<Vec<(usize, f64)>> = rows.clone().map(|k| old.rows.matrix.row(k).collect()).collect();
    let views: Vec<&[(usize, f64)]> = entries.iter().map(Vec::as_slice).collect();
    nodes.push(normal, &views, old.coefficient[node], old.bound[node]);
    let first = nodes.rows.len() - old.dim;
    nodes.rows.rhs[first..].copy_from_slice(&old.rows.rhs[rows.clone()]);
    nodes.rows.compliance[first..].copy_from_slice(&old.rows.compliance[rows]);
}

#[test]
fn the_order_of_nodes_changes_little() {
    let turned = |deck: &Deck| {
        let mut deck = deck.clone();
        let none = Friction::none(deck.friction.dim, deck.dofs());
        let old = std::mem::replace(&mut deck.friction, none);
        for node in (0..old.normal.len()).rev() {
            push_again(&mut deck.friction, &old, node, old.normal[node]);
        }
        deck
    };
    assert_the_same(turned, |deck, mut found| {
        found.along = found.along.rchunks(deck.friction.dim).flatten().copied().collect();
        found
    });
}

/// Without mu and bounds the rows of friction carry nothing, whatever they are.
#[test]
fn nodes_without_mu_and_bound_give_the_answer_without_friction() {
    let mut compared = 0;
    for (seed, drawn) in drawn() {
        let mut without = drawn.deck.clone();
        without.friction.coefficient.fill(0.0);
        without.friction.bound.fill(0.0);
        let mut never = drawn.deck.clone();
        never.friction = Friction::none(1, never.dofs());
        let (found, expected) = (solved(&without, "finish=direct"), solved(&never, "finish=direct"));
        match (found, expected) {
            (Ok(found), Ok(mut expected)) => {
                assert_eq!(size(&found.along), 0.0, "{seed} {}", drawn.class);
                expected.along = vec![0.0; found.along.len()];
                let far = apart(&found, &expected);
                assert!(far <= 1e-10, "{seed} {}: {far:e}", drawn.class);
                compared += 1;
            }
            (Err(found), Err(expected)) => assert_eq!(found, expected, "{seed} {}", drawn.class),
            (found, expected) => {
                panic!("{seed} {}: {:?} and {:?}", drawn.class, found.err(), expected.err())
            }
        }
    }
    assert!(compared > 20, "{compared}");
}

/// However little is asked of the dual, an answer is one that the certificate accepts.
#[test]
fn a_loose_tolerance_of_the_dual_leaves_no_answer_inaccurate() {
    let mut others = Vec::new();
    for (seed, drawn) in drawn() {
        let tight = solved(&drawn.deck, "");
        for options in ["tolerance=1e-2", "tolerance=1e-5"] {
            if let (Ok(_), Err(end)) = (&tight, solved(&drawn.deck, options)) {
                others.push(format!("{seed} {}: {options}: {end}", drawn.class));
            }
        }
    }
    assert!(others.is_empty(), "{others:#?}");
}

/// After a solve entries of F are kept, which may change last bits.
#[test]
fn friction_that_is_cleared_leaves_the_answer_of_a_problem_without() {
    for (seed, drawn) in drawn() {
        let mut never = drawn.deck.clone();
        never.friction = Friction::none(1, never.dofs());
        let expected = solved(&never, "");
        for after_a_solve in [false, true] {
            let mut problem = hand_over::problem(&drawn.deck).unwrap();
            if after_a_solve {
                let _ = problem.solve();
            }
            problem.clear_friction();
            let found = ended(&mut problem);
            match (&found, &expected) {
                (Ok(found), Ok(expected)) if after_a_solve => {
                    let far = apart(found, expected);
                    assert!(far <= ROUNDING, "{seed} {}: {far:e}", drawn.class);
                }
                _ => assert_eq!(bits(&found), bits(&expected), "{seed} {}", drawn.class),
            }
        }
    }
}

/// Every node of friction with its contact row once more, with half of the bound and twice the compliance.
fn twice(deck: &Deck) -> Deck {
    let mut deck = deck.clone();
    let old = deck.friction.clone();
    deck.friction.bound.iter_mut().for_each(|bound| *bound *= 0.5);
    deck.friction.rows.compliance.iter_mut().for_each(|inv_kt| *inv_kt *= 2.0);
    for (node, &normal) in old.normal.iter().enumerate() {
        let again = normal.map(|row| {
            let (entries, gap) = (deck.contact.matrix.row(row).collect::<Vec<_>>(), deck.contact.rhs[row]);
            deck.contact.compliance[row] *= 2.0;
            deck.contact.push_compliant(&entries, gap, deck.contact.compliance[row]);
            deck.contact.len() - 1
        });
        push_again(&mut deck.friction, &old, node, again);
        deck.friction.bound[old.normal.len() + node] *= 0.5;
        let first = deck.friction.rows.len() - old.dim;
        deck.friction.rows.compliance[first..].iter_mut().for_each(|inv_kt| *inv_kt *= 2.0);
    }
    deck
}

#[test]
fn nodes_that_are_given_twice_share_their_forces() {
    assert_the_same(twice, |deck, mut found| {
        let (rows, nodes) = (deck.contact.len(), deck.friction.normal.len() * deck.friction.dim);
        let again = found.lambda.split_off(rows);
        deck.friction.normal.iter().flatten().zip(again).for_each(|(&row, force)| found.lambda[row] += force);
        let again = found.along.split_off(nodes);
        found.along.iter_mut().zip(again).for_each(|(force, again)| *force += again);
        found
    });
}

/// Both tangential rows of node i, with their slips at the beginning, turned by the angle i + 1: row k is `turns[k]` of the old ones.
fn turned(deck: &Deck) -> Deck {
    let mut deck = deck.clone();
    let none = Friction::none(2, deck.dofs());
    let old = std::mem::replace(&mut deck.friction, none);
    for node in 0..old.normal.len() {
        let rows = [2 * node, 2 * node + 1];
        let entries = turns(node).map(|by| {
            let mut row = vec![0.0; deck.dofs()];
            for (k, by) in rows.into_iter().zip(by) {
                old.rows.matrix.row(k).for_each(|(j, t)| row[j] += by * t);
            }
            (0..row.len()).filter(|&j| row[j] != 0.0).map(|j| (j, row[j])).collect::<Vec<_>>()
        });
        let views: Vec<&[(usize, f64)]> = entries.iter().map(Vec::as_slice).collect();
        deck.friction.push(old.normal[node], &views, old.coefficient[node], old.bound[node]);
        for (k, [first, second]) in rows.into_iter().zip(turns(node)) {
            deck.friction.rows.rhs[k] = first * old.rows.rhs[rows[0]] + second * old.rows.rhs[rows[1]];
            deck.friction.rows.compliance[k] = old.rows.compliance[k];
        }
    }
    deck
}

fn turns(node: usize) -> [[f64; 2]; 2] {
    let (sine, cosine) = (node as f64 + 1.0).sin_cos();
    [[cosine, sine], [-sine, cosine]]
}

/// There may be several answers: turned back it is one, and mostly the one found without turning.
#[test]
fn turned_tangents_turn_the_forces_along_them() {
    let (mut compared, mut near) = (0, 0);
    for (seed, drawn) in (20_000..20_500).map(|seed| (seed, case(seed, &SIZES))) {
        if drawn.deck.friction.dim != 2 || !is_stiff(&drawn.deck) {
            continue;
        }
        let (one, other) = (solved(&drawn.deck, ""), solved(&turned(&drawn.deck), ""));
        assert_eq!(one.as_ref().err(), other.as_ref().err(), "{seed} {}", drawn.class);
        let (Ok(one), Ok(mut other)) = (one, other) else { continue };
        for (node, forces) in other.along.chunks_mut(2).enumerate() {
            let ([[a, b], [c, d]], [first, second]) = (turns(node), [forces[0], forces[1]]);
            forces.copy_from_slice(&[a * first + c * second, b * first + d * second]);
        }
        let (ratio, place) = judge::worst(&drawn.deck, &other);
        assert!(ratio <= 1e-7, "{seed} {}: {ratio:e}, {place}", drawn.class);
        compared += 1;
        near += usize::from(apart(&one, &other) <= ROUNDING);
    }
    assert!(4 * near >= 3 * compared && compared > 100, "{near} of {compared}");
}

#[test]
fn a_cold_solve_gives_the_same_bits_whatever_was_solved_before() {
    for (seed, drawn) in drawn() {
        let mut problem = hand_over::problem(&drawn.deck).unwrap();
        for by in [0.7, 1.0] {
            for (p, body) in drawn.deck.bodies.iter().enumerate() {
                let load: Vec<f64> = body.load.iter().map(|f| by * f).collect();
                problem.set_load(p, &load).unwrap();
            }
            let found = ended(&mut problem);
            if by == 1.0 {
                assert_eq!(bits(&found), bits(&solved(&drawn.deck, "")), "{seed} {}", drawn.class);
            }
        }
    }
}
