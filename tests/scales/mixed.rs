//! Stiffnesses that differ by 100, gaps from 1e-6 to 1 of the displacement: what is called solved is right, by the dense
//! reference.

use decks::random::Random;
use decks::{Body, Csr, Deck, Rows};
use feti_contact::solver::{Outcome, Problem};

use crate::scales::dense::{dual_optimum, optimum, Dense};
use crate::scales::plane::under_a_wall_of;
use crate::scales::{answer, difference, dot, largest, problem, solved, Claims};

const SEEDS: u64 = 1000;
/// What a force may be wrong by, against the largest force on each body that its row touches.
const WRONG: f64 = 1e-6;

/// Two or three held bodies of 4 to 7 unknowns, K = Q diag Q' with eigenvalues over two and a half decades, one body 100
/// times as stiff as another: condition 3e4. Rows join random unknowns of two bodies.
fn random_bodies(seed: u64) -> Deck {
    let mut random = Random::new(seed);
    let count = 2 + random.below(2);
    let contrast = [1.0, 100.0, 10.0];
    let bodies: Vec<Body> = (0..count).map(|p| random_body(contrast[p], &mut random)).collect();
    let mut deck = Deck::new(format!("random_{seed}"), bodies);
    for _ in 0..deck.dofs() * 9 / 10 {
        let first = random.below(count);
        let second = (first + 1 + random.below(count - 1)) % count;
        let mut row = Vec::new();
        for (p, sign) in [(first, 1.0), (second, -1.0)] {
            let (from, n) = (deck.offset(p), deck.bodies[p].dofs());
            (0..3).for_each(|_| row.push((from + random.below(n), sign * random.between(0.2, 1.0))));
        }
        deck.contact.push(&row, 0.0);
    }
    set_gaps(&mut deck, &mut random);
    near_twins(&mut deck, &mut random);
    deck
}

/// Every third row again, its entries and its gap changed by a hundredth, as those of neighbours on a stiff face: how the two
/// share a force is known much less well than their sum.
fn near_twins(deck: &mut Deck, random: &mut Random) {
    for row in (0..deck.contact.len()).step_by(3) {
        let change = |random: &mut Random| 1.0 + 1e-2 * random.normal();
        let entries: Vec<_> =
            deck.contact.matrix.row(row).map(|(dof, b)| (dof, b * change(random))).collect();
        let gap = deck.contact.rhs[row] * change(random);
        deck.contact.push(&entries, gap);
    }
}

fn random_body(stiffness: f64, random: &mut Random) -> Body {
    let n = 4 + random.below(4);
    let mut k = vec![0.0; n * n];
    (0..n).for_each(|i| k[i * n + i] = stiffness * 10f64.powf(-2.5 * i as f64 / (n - 1) as f64));
    // two reflections I - 2 vv' / v'v from both sides
    for _ in 0..2 {
        let v = random.normals(n, 1.0);
        let factor = 2.0 / dot(&v, &v);
        for by_rows in [true, false] {
            for line in 0..n {
                let at = |i: usize| if by_rows { line * n + i } else { i * n + line };
                let along = factor * (0..n).map(|i| k[at(i)] * v[i]).sum::<f64>();
                (0..n).for_each(|i| k[at(i)] -= along * v[i]);
            }
        }
    }
    for i in 0..n {
        (0..i).for_each(|j| k[i * n + j] = k[j * n + i]);
    }
    Body {
        stiffness: Csr::from_dense(n, &k),
        null_space: None,
        load: random.normals(n, 1.0),
        coordinates: vec![[0.0; 3]; n],
        node: (1..=n as i32).collect(),
        direction: vec![1; n],
    }
}

/// Gaps of 1e-6 to 1 of the largest displacement without contact.
fn set_gaps(deck: &mut Deck, random: &mut Random) {
    let alone = Deck { contact: Rows::none(deck.dofs()), ..deck.clone() };
    let most = largest(&solved(&mut problem(&alone)).u);
    deck.contact.rhs.iter_mut().for_each(|c| *c = most * random.decades(-6.0, 0.0));
}

/// Largest error of the forces on a body against the largest force on it, of a row or of the load.
fn error(deck: &Deck, found: &[f64], right: &[f64]) -> f64 {
    let of = |p: usize| {
        let range = deck.offset(p)..deck.offset(p + 1);
        let touches = |i: &usize| deck.contact.matrix.row(*i).any(|(dof, _)| range.contains(&dof));
        let rows: Vec<usize> = (0..found.len()).filter(touches).collect();
        let off = largest(&rows.iter().map(|i| found[*i] - right[*i]).collect::<Vec<_>>());
        let own = largest(&rows.iter().map(|i| right[*i]).collect::<Vec<_>>());
        off / own.max(largest(&deck.bodies[p].load))
    };
    largest(&(0..deck.bodies.len()).map(of).collect::<Vec<_>>())
}

/// Largest error of what the rows do to a body, `|B'(lambda - right)|_{D^-1}` against `|B'right|_{D^-1} + |f|_{D^-1}`: rows
/// that are nearly the same may share their force otherwise.
fn error_of_the_sum(deck: &Deck, found: &[f64], right: &[f64]) -> f64 {
    let forces = |lambda: &[f64]| deck.contact.matrix.transpose_times(lambda);
    let (found, right) = (forces(found), forces(right));
    let of = |p: usize| {
        let (start, diagonal) = (deck.offset(p), deck.bodies[p].stiffness.diagonal());
        let size = |v: &dyn Fn(usize) -> f64| {
            diagonal.iter().enumerate().map(|(i, d)| v(i).powi(2) / d).sum::<f64>().sqrt()
        };
        let off = size(&|i| found[start + i] - right[start + i]);
        off / (size(&|i| right[start + i]) + size(&|i| deck.bodies[p].load[i]))
    };
    largest(&(0..deck.bodies.len()).map(of).collect::<Vec<_>>())
}

/// Of a deck the error of forces found against the right ones.
type Measure = fn(&Deck, &[f64], &[f64]) -> f64;

fn assert_right_or_inaccurate(measure: Measure, options: impl Fn(&mut Problem)) {
    let (mut claims, mut called_solved) = (Claims::default(), 0);
    for seed in 0..SEEDS {
        let deck = random_bodies(seed);
        let mut problem = problem(&deck);
        options(&mut problem);
        let found = match answer(&mut problem) {
            Ok(found) => found,
            Err(error) => {
                claims.claim(false, || format!("seed {seed}: {error}"));
                continue;
            }
        };
        let (outcome, worst) = (found.report.outcome, found.report.certificate.worst());
        if outcome == Outcome::Solved {
            called_solved += 1;
            let (_, right) = optimum(&deck, found.lambda.iter().map(|l| *l > 0.0).collect());
            let off = measure(&deck, &found.lambda, &right);
            claims.at_most(off, WRONG, &format!("seed {seed}: solved, worst {worst:.1e}, forces"));
        } else {
            claims.claim(outcome == Outcome::Inaccurate, || format!("seed {seed}: {outcome:?}"));
        }
    }
    claims.claim(2 * called_solved > SEEDS, || format!("{called_solved} of {SEEDS} are solved"));
    claims.end();
}

#[test]
fn forces_among_gaps_of_mixed_scale_are_right_or_called_inaccurate() {
    assert_right_or_inaccurate(error, |_| {});
}

#[test]
fn forces_among_gaps_of_mixed_scale_are_right_or_called_inaccurate_under_a_loose_tolerance() {
    assert_right_or_inaccurate(error_of_the_sum, |p| p.set_f64("tolerance", 1e-8).unwrap());
}

#[test]
fn forces_among_gaps_of_mixed_scale_are_right_or_called_inaccurate_without_the_direct_method() {
    assert_right_or_inaccurate(error, |p| p.set_i64("direct_limit", 0).unwrap());
}

/// A block with moduli from 0.01 to 1 and gaps of mixed scale. The reference is the dual by active sets, its entries
/// F = B K^-1 B' and B K^-1 f from the factors of the library, which do not know the rows.
#[test]
fn forces_among_gaps_of_mixed_scale_are_right_among_40_thousand_unknowns() {
    let mut random = Random::new(3);
    let factors = (0..140 * 140).map(|_| random.decades(-2.0, 0.0)).collect();
    let mut deck = under_a_wall_of(factors, 140, 140);
    set_gaps(&mut deck, &mut random);
    let mut problem = problem(&deck);
    let found = solved(&mut problem);
    let (rows, n) = (deck.contact.len(), deck.dofs());
    let mut moved = |force: &[f64]| {
        let mut u = vec![0.0; n];
        problem.kplus(0, force, &mut u).unwrap();
        deck.contact.matrix.times(&u)
    };
    let mut f = Dense::zeros(rows);
    for column in 0..rows {
        let mut unit = vec![0.0; rows];
        unit[column] = 1.0;
        let length = moved(&deck.contact.matrix.transpose_times(&unit));
        length.iter().enumerate().for_each(|(row, length)| f.entries[row * rows + column] = *length);
    }
    let free = moved(&deck.load());
    let over: Vec<f64> = free.iter().zip(&deck.contact.rhs).map(|(u, c)| u - c).collect();
    let right = dual_optimum(&f, &over, found.lambda.iter().map(|l| *l > 0.0).collect());
    let closed = right.iter().filter(|l| **l > 0.0).count();
    assert!(closed > 20 && closed < rows, "{closed} of {rows} rows are closed");
    let off = difference(&found.lambda, &right);
    assert!(off < WRONG, "{off:e}");
}
