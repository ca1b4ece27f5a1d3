//! Friction beside negative stiffness: what stress and curvature give a pressed body that nothing but its contact holds.

use std::collections::BTreeMap;

use decks::dense::solve;
use decks::random::Random;
use decks::{Block, Body, Csr, Deck, Friction};
use feti_contact::error::{Error, Kind, Proof};
use feti_contact::solver::{FrictionState, Modes, Outcome, Problem};

use crate::coulomb::battery::answer;
use crate::coulomb::judge;
use crate::support::asked::seeds;
use crate::support::hand_over;
use crate::support::rungs::{self, Ended};

/// Number of pressed blocks of the ordinary run.
const BLOCKS: u64 = 300;
/// An answer is right if its worst error is below this part of what is there.
const RIGHT: f64 = 1e-8;

/// The deck with its rigid motions declared soft.
fn soft(deck: &Deck) -> Problem {
    hand_over::with_motions(deck, Modes::Soft).unwrap()
}

/// `K - by r r'`, r = `motion` / |motion|
fn driven(stiffness: &Csr, motion: &[f64], by: f64) -> Csr {
    let size = motion.iter().map(|r| r * r).sum::<f64>();
    let mut matrix = Csr::empty(motion.len());
    for i in 0..motion.len() {
        let mut row: Vec<f64> = motion.iter().map(|r| -by * motion[i] * r / size).collect();
        stiffness.row(i).for_each(|(j, v)| row[j] += v);
        matrix.push_row(&row.into_iter().enumerate().collect::<Vec<_>>());
    }
    matrix
}

/// Bars of stiffness k between three points, driven along their rotation by `by`; points 0 and 1 over a floor, gaps 0 and
/// .1, pressed and pushed to the right.
fn triangle(k: f64, by: f64, mu: f64) -> Deck {
    let points = [[0.0, 0.0], [1.0, 0.0], [0.4, 0.8]];
    let mut entries = vec![0.0; 36];
    for (i, j) in [(0, 1), (1, 2), (2, 0)] {
        let way: [f64; 2] = [points[i][0] - points[j][0], points[i][1] - points[j][1]];
        let length = way[0].hypot(way[1]);
        let mut v = [0.0; 6];
        for axis in 0..2 {
            (v[2 * i + axis], v[2 * j + axis]) = (way[axis] / length, -way[axis] / length);
        }
        (0..36).for_each(|at| entries[at] += k * v[at / 6] * v[at % 6]);
    }
    let middle = [1.4 / 3.0, 0.8 / 3.0];
    let turn = points.iter().flat_map(|x| [middle[1] - x[1], x[0] - middle[0]]).collect::<Vec<_>>();
    let mut plain = Csr::empty(6);
    entries.chunks(6).for_each(|row| plain.push_row(&row.iter().copied().enumerate().collect::<Vec<_>>()));
    let [right, up] = [0, 1].map(|axis| (0..6).map(|j| f64::from(j % 2 == axis)).collect::<Vec<_>>());
    let body = Body {
        stiffness: driven(&plain, &turn, by * k / 1000.0),
        null_space: Some(vec![right, up, turn]),
        load: [1.0, -5.0, 1.0, -5.0, 0.0, -5.0].map(|f| f * k / 1000.0).to_vec(),
        coordinates: points.iter().flat_map(|x| [[x[0], x[1], 0.0]; 2]).collect(),
        node: vec![1, 1, 2, 2, 3, 3],
        direction: vec![1, 2, 1, 2, 1, 2],
    };
    let mut deck = Deck::new("triangle", vec![body]);
    for (node, gap) in [(0, 0.0), (1, 0.1)] {
        deck.contact.push(&[(2 * node + 1, -1.0)], gap);
        deck.friction.push(Some(node), &[&[(2 * node, 1.0)]], mu, 0.0);
    }
    deck
}

/// Forces of the triangle with both points closed and sticking: normal ones, then tangential ones.
fn sticking(deck: &Deck) -> Vec<f64> {
    let (n, size) = (6, 10);
    let (mut a, mut b) = (vec![0.0; size * size], deck.load());
    let unit = deck.bodies[0].stiffness.diagonal()[0];
    (0..n).for_each(|i| deck.bodies[0].stiffness.row(i).for_each(|(j, v)| a[i * size + j] = v / unit));
    b.iter_mut().for_each(|f| *f /= unit);
    for (k, rows) in [(6, &deck.contact), (8, &deck.friction.rows)] {
        for i in 0..2 {
            rows.matrix.row(i).for_each(|(j, v)| {
                (a[(k + i) * size + j], a[j * size + k + i]) = (v, v);
            });
            b.push(rows.rhs[i]);
        }
    }
    solve(a, b).unwrap().split_off(n).iter().map(|force| force * unit).collect()
}

#[test]
fn a_driven_triangle_that_sticks_has_the_forces_of_its_linear_problem_in_any_unit() {
    for k in [1000.0, 1e-3, 2.1e11] {
        for by in [0.0, 1e-6, 1e-4, 1e-2, 1.0, 10.0] {
            let deck = triangle(k, by, 1.0);
            let (mut problem, right) = (soft(&deck), sticking(&deck));
            let report = problem.solve().unwrap();
            assert_eq!(report.outcome, Outcome::Solved, "{k} {by}");
            assert_eq!(problem.friction_states().unwrap(), [FrictionState::Stick; 2]);
            let found = answer(&problem);
            for (found, right) in found.lambda.iter().chain(&found.along).zip(&right) {
                assert!((found - right).abs() <= 1e-9 * right.abs(), "{k} {by}: {found} for {right}");
            }
            let (error, what) = judge::worst(&deck, &found);
            assert!(error <= RIGHT, "{k} {by}: {what}: {error:e}");
        }
    }
}

/// By hand: normal forces 8 and 7 hold the plain triangle; driven by 1000, K is negative along the rotation of point 1 about
/// point 0, which nothing stops.
#[test]
fn a_tilt_that_nothing_stops_is_no_rest() {
    let deck = triangle(1000.0, 3000.0, 1.0);
    let end = soft(&deck).solve();
    assert!(proves(&deck, &end.as_ref().err().cloned().unwrap()), "{end:?}");
}

/// The error proves by a motion v that there is no rest: f'v > 0 or v'K v < 0, up to rounding.
fn proves(deck: &Deck, error: &Error) -> bool {
    let Some(Proof::Motion { v, .. }) = error.proof.as_deref() else { return false };
    let (mut energy, mut first) = (0.0, 0);
    for body in &deck.bodies {
        let own = &v[first..first + body.dofs()];
        first += body.dofs();
        energy += body.stiffness.times(own).iter().zip(own).map(|(k, v)| k * v).sum::<f64>();
    }
    match error.kind {
        Kind::Indefinite => energy < 0.0,
        Kind::Slides | Kind::LoadNotHeld => deck.load().iter().zip(v).map(|(f, v)| f * v).sum::<f64>() > 0.0,
        _ => false,
    }
}

/// A block on the ground, pressed, pushed by a part of what friction holds, driven along a rotation.
pub fn pressed(seed: u64) -> Deck {
    let mut random = Random::new(seed ^ 0x7469_6c74);
    let dimension = 2 + usize::from(random.chance(0.3));
    let elements = match dimension {
        2 => [1 + random.below(3), 1 + random.below(3), 1],
        _ => [1 + random.below(2), 1, 1],
    };
    let young = random.decades(-3.0, 6.0);
    let block = Block { dimension, elements, size: [1.0; 3], young, ..Block::default() };
    let (grid, up) = (block.grids().collect::<Vec<_>>(), dimension - 1);
    let mut body = block.floating().body;
    let (modes, drive) = (body.modes().to_vec(), young * random.decades(-9.0, -1.0));
    let turn = modes[dimension + random.below(modes.len() - dimension)].clone();
    body.stiffness = driven(&body.stiffness, &turn, drive);
    let press = 1e-3 * young;
    let mu = random.between(0.01, 0.3);
    let (feet, top): (Vec<usize>, Vec<usize>) = (
        (0..grid.len()).filter(|&i| grid[i][up] == 0).collect(),
        (0..grid.len()).filter(|&i| grid[i][up] == elements[up]).collect(),
    );
    let mut pressed = 0.0;
    for &i in &top {
        let own = press * random.between(0.5, 1.5) / top.len() as f64;
        body.load[dimension * i + up] -= own;
        pressed += own;
    }
    let push = random.between(-0.9, 0.9) * mu * pressed / feet.len() as f64;
    feet.iter().for_each(|&i| body.load[dimension * i] += push);
    let mut deck = Deck::new(format!("pressed {seed}"), vec![body]);
    deck.friction = Friction::none(dimension - 1, deck.dofs());
    for &i in &feet {
        let gap = if random.chance(0.7) { 0.0 } else { random.between(0.0, 1e-3) };
        deck.contact.push(&[(dimension * i + up, -1.0)], gap);
        let rows: Vec<[(usize, f64); 1]> = (0..up).map(|axis| [(dimension * i + axis, 1.0)]).collect();
        let rows: Vec<&[(usize, f64)]> = rows.iter().map(|row| &row[..]).collect();
        deck.friction.push(Some(deck.contact.len() - 1), &rows, mu, 0.0);
    }
    deck
}

#[test]
fn pressed_blocks_with_negative_stiffness_rest_or_are_proved_not_to() {
    let (mut counts, mut lines) = (BTreeMap::<String, usize>::new(), Vec::new());
    let seeds = seeds(BLOCKS);
    let all = seeds.end - seeds.start;
    for seed in seeds {
        let deck = pressed(seed);
        let mut problem = soft(&deck);
        let (end, fails) = match problem.solve() {
            Ok(report) if report.outcome == Outcome::Solved => {
                let (error, what) = judge::worst(&deck, &answer(&problem));
                ("OK".to_owned(), (!(error <= RIGHT)).then(|| format!("{what}: {error:e}")))
            }
            // pushed off their middle, some slide; nothing else is right
            Ok(report) => (format!("{:?}", report.outcome), None),
            Err(error) => (format!("{:?}", error.kind), (!proves(&deck, &error)).then(|| error.to_string())),
        };
        *counts.entry(end.clone()).or_default() += 1;
        lines.extend(fails.map(|what| format!("{seed}: {end} {what}")));
    }
    println!("{counts:?}\n{}", lines.join("\n"));
    assert!(lines.is_empty(), "{counts:?}\n{}", lines.join("\n"));
    let of = |end: &str| counts.get(end).copied().unwrap_or(0) as u64;
    assert!(of("OK") > all / 2 && of("OK") + of("Indefinite") + of("Slides") == all, "{counts:?}");
}

/// The same blocks without friction: nothing holds the push. The reason was once negative stiffness along a motion whose v'K v is rounding.
#[test]
fn pushed_blocks_without_friction_are_named_with_a_motion_that_proves_it() {
    for seed in 0..200 {
        let mut deck = pressed(111000000 + seed);
        deck.friction = Friction::none(deck.friction.dim, deck.dofs());
        match soft(&deck).solve() {
            Err(error) => assert!(proves(&deck, &error), "{seed}: {error}"),
            Ok(report) => assert_ne!(report.outcome, Outcome::Solved, "{seed}"),
        }
    }
}

/// `make rungs`: pressed blocks, every second one without friction.
#[test]
#[ignore]
fn what_each_second_try_saves() {
    rungs::print("pressed", seeds(BLOCKS), |seed, without| {
        let mut deck = pressed(seed);
        if seed % 2 == 1 {
            deck.friction = Friction::none(deck.friction.dim, deck.dofs());
        }
        let mut problem = soft(&deck);
        problem.set_i64("without", without).unwrap();
        let (solved, wrong, report) = match problem.solve() {
            Ok(report) if report.outcome == Outcome::Solved => {
                (true, !(judge::worst(&deck, &answer(&problem)).0 <= RIGHT), Some(report))
            }
            Ok(report) => (false, false, Some(report)),
            Err(error) => (true, !proves(&deck, &error), None),
        };
        Some(Ended { solved, wrong, report })
    });
}
