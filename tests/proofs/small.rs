//! Small problems, 4 to 25 unknowns, that are degenerate in many ways at once and have an answer by construction.

use decks::random::Random;
use decks::{Csr, Deck};
use feti_contact::solver::Outcome;

use crate::proofs::body;
use crate::support::hand_over;

/// How a problem is made difficult.
#[derive(Clone, Copy, Debug)]
enum Kind {
    /// Ties that are combinations of others, contact rows that repeat others.
    Redundant,
    /// Copies of rows that differ by 1e-9 or less.
    Copies,
    /// Most rows touch without force, most bodies are free.
    Idle,
    /// Angles of 1e-6 to 1e-12 between rows.
    Parallel,
}

/// A network of springs between n unknowns, free or with one spring to the ground.
fn network(n: usize, free: bool, random: &mut Random) -> decks::Body {
    let mut k = vec![0.0; n * n];
    let mut spring = |i: usize, j: usize, s: f64| {
        k[i * n + i] += s;
        k[j * n + j] += s;
        k[i * n + j] -= s;
        k[j * n + i] -= s;
    };
    for i in 1..n {
        spring(i, random.below(i), random.decades(-1.0, 1.0));
        let j = random.below(n);
        if j != i {
            spring(i, j, random.decades(-1.0, 1.0));
        }
    }
    if !free {
        k[0] += random.decades(-1.0, 1.0);
    }
    let modes = if free { vec![vec![1.0; n]] } else { vec![] };
    body(Csr::from_dense(n, &k), modes, vec![0.0; n])
}

/// The problem of a seed: u, forces and closed rows are drawn, loads and gaps follow.
fn draw(kind: Kind, seed: u64) -> Deck {
    let random = &mut Random::new(seed);
    let count = 2 + random.below(3);
    let free = if matches!(kind, Kind::Idle) { 0.9 } else { 0.5 };
    let bodies = (0..count).map(|_| network(2 + random.below(5), random.chance(free), random)).collect();
    let mut deck = Deck::new(format!("{kind:?} {seed}"), bodies);
    let n = deck.dofs();
    let idle = matches!(kind, Kind::Idle) && random.chance(0.5);
    let moving = if idle { 0.0 } else { 1.0 };
    let u = random.normals(n, moving);
    let mut load: Vec<f64> = Vec::new();
    for (p, body) in deck.bodies.iter().enumerate() {
        load.extend(body.stiffness.times(&u[deck.offset(p)..deck.offset(p + 1)]));
    }
    let row = |random: &mut Random| -> Vec<(usize, f64)> {
        let i = random.below(n);
        let j = (i + 1 + random.below(n - 1)) % n;
        vec![(i, random.between(0.5, 1.5)), (j, -random.between(0.5, 1.5))]
    };
    let (mut ties, mut walls): (Vec<Vec<(usize, f64)>>, Vec<Vec<(usize, f64)>>) = (Vec::new(), Vec::new());
    (0..1 + random.below(3)).for_each(|_| ties.push(row(random)));
    (0..2 + random.below(5)).for_each(|_| walls.push(row(random)));
    let combined = |rows: &[Vec<(usize, f64)>], random: &mut Random, signs: bool| -> Vec<(usize, f64)> {
        let mut sum = vec![0.0; n];
        for row in rows {
            let by = if signs { random.normal() } else { random.uniform() };
            row.iter().for_each(|(j, v)| sum[*j] += by * v);
        }
        sum.into_iter().enumerate().filter(|(_, v)| *v != 0.0).collect()
    };
    let small = |random: &mut Random| random.decades(-12.0, -6.0);
    match kind {
        Kind::Redundant => {
            let next = combined(&ties, random, true);
            ties.push(next);
            let next = combined(&walls, random, false);
            walls.push(next);
        }
        Kind::Copies | Kind::Parallel => {
            for rows in [&mut ties, &mut walls] {
                let mut copy = rows[0].clone();
                let by = if matches!(kind, Kind::Copies) { 1e-9 } else { small(random) };
                copy.iter_mut().for_each(|(_, v)| *v *= 1.0 + by * random.normal());
                rows.push(copy);
            }
        }
        Kind::Idle => {
            let copy = walls[0].clone();
            walls.push(copy);
        }
    }
    let at = |row: &[(usize, f64)]| row.iter().map(|(j, v)| v * u[*j]).sum::<f64>();
    for tie in &ties {
        let force = if idle { 0.0 } else { random.normal() };
        tie.iter().for_each(|(j, v)| load[*j] += v * force);
        deck.equalities.push(tie, at(tie));
    }
    for wall in &walls {
        let share = if matches!(kind, Kind::Idle) { 0.15 } else { 0.6 };
        let force = if !idle && random.chance(share) { random.uniform() } else { 0.0 };
        let gap = if force > 0.0 || random.chance(0.4) { 0.0 } else { random.uniform() };
        wall.iter().for_each(|(j, v)| load[*j] += v * force);
        deck.contact.push(wall, at(wall) + gap);
    }
    let offsets: Vec<usize> = (0..=count).map(|p| deck.offset(p)).collect();
    for (p, body) in deck.bodies.iter_mut().enumerate() {
        body.load.copy_from_slice(&load[offsets[p]..offsets[p + 1]]);
    }
    deck
}

fn not_solved(kind: Kind, count: u64) -> Vec<String> {
    let mut table = Vec::new();
    for seed in 0..count {
        let deck = draw(kind, seed);
        let ended = match hand_over::problem(&deck).unwrap().solve() {
            Ok(report) if report.outcome == Outcome::Solved => continue,
            Ok(report) => format!(
                "{:?}, worst {:.1e}, {} steps",
                report.outcome,
                report.certificate.worst(),
                report.counts.steps()
            ),
            Err(error) => error.to_string(),
        };
        table.push(format!("{}: {ended}", deck.name));
    }
    table
}

fn assert_all_solved(kind: Kind) {
    let table = not_solved(kind, 2000);
    assert!(table.is_empty(), "{} of 2000:\n{}", table.len(), table[..table.len().min(40)].join("\n"));
}

#[test]
fn rows_that_repeat_others_leave_every_small_problem_solved() {
    assert_all_solved(Kind::Redundant);
}

#[test]
fn rows_that_nearly_repeat_others_leave_every_small_problem_solved() {
    assert_all_solved(Kind::Copies);
}

#[test]
fn rows_at_small_angles_leave_every_small_problem_solved() {
    assert_all_solved(Kind::Parallel);
}

#[test]
fn free_bodies_and_rows_without_force_leave_every_small_problem_solved() {
    assert_all_solved(Kind::Idle);
}
