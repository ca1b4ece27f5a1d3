//! The bodies that varied problems are made of: springs, networks, trusses, small elastic blocks.

use crate::dense::singular;
use crate::random::Random;
use crate::sparse::Triplets;
use crate::vector::dot;
use crate::{Block, Body};

/// Which springs of a body differ from each other: stiffness times 10^x, x in [-`decades`, 0].
#[derive(Clone, Copy)]
pub struct Spread {
    pub stiffness: f64,
    pub decades: f64,
}

impl Spread {
    fn draw(&self, random: &mut Random) -> f64 {
        self.stiffness * random.between(0.5, 2.0) * random.decades(-self.decades, f64::MIN_POSITIVE)
    }
}

/// A body of at most `most` unknowns without load; `held`: has no null space.
pub fn draw(most: usize, held: bool, spread: Spread, random: &mut Random) -> Body {
    loop {
        let body = match random.below(if spread.decades > 1.0 { 3 } else { 5 }) {
            0 => chain(2 + random.below(11), held, spread, random),
            1 => network(3 + random.below(18), held, spread, random),
            2 => truss(4 + random.below(9), held, spread, random),
            3 => block(2, held, spread, random),
            _ => block(3, held, spread, random),
        };
        if body.dofs() <= most {
            return body;
        }
    }
}

/// One unknown on a spring to the ground.
pub fn single(spread: Spread, random: &mut Random) -> Body {
    line(1, &[(None, 0, spread.draw(random))])
}

/// Springs 0-1, 1-2, ...; held: the first unknown on a spring to the ground, half of the time the last as well.
fn chain(n: usize, held: bool, spread: Spread, random: &mut Random) -> Body {
    let mut springs: Vec<_> = (1..n).map(|i| (Some(i - 1), i, spread.draw(random))).collect();
    if held {
        springs.push((None, 0, spread.draw(random)));
        if random.chance(0.5) {
            springs.push((None, n - 1, spread.draw(random)));
        }
    }
    line(n, &springs)
}

/// A tree of springs with n/2 more between any two unknowns; held: two springs to the ground.
fn network(n: usize, held: bool, spread: Spread, random: &mut Random) -> Body {
    let mut springs: Vec<_> = (1..n).map(|i| (Some(random.below(i)), i, spread.draw(random))).collect();
    for _ in 0..n / 2 {
        let (a, b) = (random.below(n), random.below(n));
        if a != b {
            springs.push((Some(a), b, spread.draw(random)));
        }
    }
    for _ in 0..if held { 2 } else { 0 } {
        springs.push((None, random.below(n), spread.draw(random)));
    }
    line(n, &springs)
}

/// Unknowns at x = 0, 1, ... along x, springs (a, b, k) between two of them or, without a, to the ground.
fn line(n: usize, springs: &[(Option<usize>, usize, f64)]) -> Body {
    let mut matrix = Triplets::new(n, n);
    for &(a, b, k) in springs {
        matrix.add(b, b, k);
        if let Some(a) = a {
            matrix.add(a, a, k);
            matrix.add(a, b, -k);
            matrix.add(b, a, -k);
        }
    }
    let floating = springs.iter().all(|spring| spring.0.is_some());
    Body {
        stiffness: matrix.to_csr(),
        null_space: floating.then(|| vec![vec![1.0; n]]),
        load: vec![0.0; n],
        coordinates: (0..n).map(|i| [i as f64, 0.0, 0.0]).collect(),
        node: (1..=n as i32).collect(),
        direction: vec![1; n],
    }
}

/// A plane strip of triangles: node i at (i / 2, i mod 2), bars to the next and to the next but one: k d d', d the
/// direction of the bar. Held: the first two nodes are eliminated.
fn truss(nodes: usize, held: bool, spread: Spread, random: &mut Random) -> Body {
    let at = |i: usize| [0.5 * i as f64, (i % 2) as f64];
    let mut matrix = Triplets::new(2 * nodes, 2 * nodes);
    for (a, b) in (1..nodes).map(|b| (b - 1, b)).chain((2..nodes).map(|b| (b - 2, b))) {
        let (edge, k) = ([at(b)[0] - at(a)[0], at(b)[1] - at(a)[1]], spread.draw(random));
        let square = dot(&edge, &edge);
        for (i, j) in [(0, 0), (0, 1), (1, 0), (1, 1)] {
            let value = k * (edge[i] * edge[j]) / square;
            matrix.add(2 * a + i, 2 * a + j, value);
            matrix.add(2 * b + i, 2 * b + j, value);
            matrix.add(2 * a + i, 2 * b + j, -value);
            matrix.add(2 * b + i, 2 * a + j, -value);
        }
    }
    let keep: Vec<usize> = (if held { 4 } else { 0 }..2 * nodes).collect();
    let motion =
        |dof: usize| [[1.0, 0.0], [0.0, 1.0], [0.5 - at(dof / 2)[1], at(dof / 2)[0] - nodes as f64 / 4.0]];
    let modes = || (0..3).map(|k| keep.iter().map(|&dof| motion(dof)[k][dof % 2]).collect()).collect();
    Body {
        stiffness: matrix.to_csr().restricted(&keep),
        null_space: (!held).then(modes),
        load: vec![0.0; keep.len()],
        coordinates: keep.iter().map(|dof| [at(dof / 2)[0], at(dof / 2)[1], 0.0]).collect(),
        node: keep.iter().map(|dof| (dof / 2 + 1) as i32).collect(),
        direction: keep.iter().map(|dof| (dof % 2 + 1) as i32).collect(),
    }
}

/// An elastic block of one to three elements along each axis; held: clamped at x = 0.
fn block(dimension: usize, held: bool, spread: Spread, random: &mut Random) -> Body {
    let most = if dimension == 2 { 3 } else { 2 };
    let elements = std::array::from_fn(|_| 1 + random.below(most));
    let young = spread.draw(random);
    let block = Block { dimension, elements, young, ..Block::default() };
    block.part(|at| held && at[0] == 0).body
}

/// K_jj := K_jj (1 + p) on enough unknowns to hold the body, p from 1e8 to 1e20: a support by penalty. Those unknowns.
pub fn support(body: &mut Body, random: &mut Random) -> Vec<usize> {
    let n = body.dofs();
    let mut chosen = Vec::new();
    let wanted = body.modes().len().max(1);
    while chosen.len() < wanted.min(n - 1) || !resists(body, &chosen) {
        let dof = random.below(n);
        if !chosen.contains(&dof) {
            chosen.push(dof);
        }
        if chosen.len() + 1 >= n {
            break;
        }
    }
    let factor = random.decades(8.0, 20.0);
    for &dof in &chosen {
        let (from, to) = (body.stiffness.ptr[dof], body.stiffness.ptr[dof + 1]);
        let entries = (from..to).find(|&k| body.stiffness.col[k] == dof);
        body.stiffness.val[entries.expect("a diagonal")] *= 1.0 + factor;
    }
    body.null_space = None;
    chosen
}

/// The rigid modes are independent on these unknowns.
fn resists(body: &Body, chosen: &[usize]) -> bool {
    let columns: Vec<Vec<f64>> =
        body.modes().iter().map(|mode| chosen.iter().map(|&dof| mode[dof]).collect()).collect();
    columns.is_empty() || {
        let values = singular(columns).values;
        values[values.len() - 1] > 1e-2 * values[0]
    }
}
