//! Bodies whose rigid motions K resists softly, or drives: weak springs of the host, rounding of the entries of K, geometric
//! stiffness. The answer is that of the K given: [`oracle`] solves it dense in double-double arithmetic.
//!
//! | module | claims |
//! |---|---|
//! | [`averaged`] | more averaged rows than gaps, almost dependent, at the end of a Newton method, from given answers |
//! | [`column`] | diagonal entries of K that are negative, or 0 beside others: a rigid column with its load on top |
//! | [`coordinates`] | rigid motions of coordinates, with and without supports, resisted or driven |
//! | [`driven`] | negative stiffness of rho from .007 to .9, and of no minimum |
//! | [`random`] | driven problems against all their stationary points |
//! | [`units`] | units of forces and lengths, problem files |
//! | [`weak`] | springs and rounding of 1e-12 to 1e-4 of K: forces, products, units, threads |

mod averaged;
mod column;
mod coordinates;
mod driven;
mod oracle;
pub mod random;
mod units;
mod weak;

use crate::support::hand_over;
use decks::{Block, Body, Deck};
use feti_contact::error::Result;
use feti_contact::solver::{Modes, Outcome, Problem, RowKind};

/// Elements of a block.
const ELEMENTS: [usize; 3] = [8, 4, 1];
const SIZE: [f64; 3] = [2.0, 1.0, 1.0];

/// A column of floating blocks on the ground, pressed from above and aside, one row per pair of nodes; a node at the foot of
/// each is held sideways.
pub fn column(blocks: usize) -> Deck {
    column_on(blocks, 0..=ELEMENTS[0], 0.15)
}

/// The same with rows at these nodes of every joint alone; the load grows by `slope` from node to node.
pub fn column_on(blocks: usize, joint: std::ops::RangeInclusive<usize>, slope: f64) -> Deck {
    let block = |p: usize| Block {
        dimension: 2,
        elements: ELEMENTS,
        size: SIZE,
        origin: [0.0, p as f64, 0.0],
        ..Block::default()
    };
    let mut bodies: Vec<Body> = (0..blocks).map(|p| block(p).floating().body).collect();
    let (grid, [nx, ny, _]) = (block(0), ELEMENTS);
    let node = |x: usize, y: usize| 2 * grid.node([x, y, 0]);
    for (p, body) in bodies.iter_mut().enumerate() {
        for x in 0..=nx {
            let share = if x == 0 || x == nx { 0.5 } else { 1.0 };
            body.load[node(x, ny) + 1] = -1e-3 * share * (1.0 + slope * x as f64 + 0.1 * p as f64);
        }
        body.load[node(0, ny)] = 2e-3 * slope;
    }
    let mut deck = Deck::new(format!("column of {blocks}"), bodies);
    for p in 0..blocks {
        let (own, below) = (deck.offset(p), if p > 0 { Some(deck.offset(p - 1)) } else { None });
        for x in joint.clone() {
            let gap = if x == 2 { 2e-3 } else { 0.0 };
            let foot = (own + node(x, 0) + 1, -1.0);
            match below {
                Some(below) => deck.contact.push(&[(below + node(x, ny) + 1, 1.0), foot], gap),
                None => deck.contact.push(&[foot], gap),
            }
        }
        deck.equalities.push(&[(own + node(0, 0), 1.0)], 0.0);
    }
    deck
}

/// Adds `share` of the largest K_ii to the diagonal, at the four corners of every block in both directions.
pub fn with_springs(mut deck: Deck, share: f64) -> Deck {
    for body in &mut deck.bodies {
        let largest = body.stiffness.diagonal().into_iter().fold(0.0, f64::max);
        let [nx, ny, _] = ELEMENTS;
        for node in [0, nx, ny * (nx + 1), ny * (nx + 1) + nx] {
            for dof in [2 * node, 2 * node + 1] {
                add_diagonal(body, dof, share * largest);
            }
        }
    }
    deck
}

pub fn add_diagonal(body: &mut Body, dof: usize, value: f64) {
    let row = body.stiffness.ptr[dof]..body.stiffness.ptr[dof + 1];
    let at = row.start + body.stiffness.col[row].iter().position(|j| *j == dof).unwrap();
    body.stiffness.val[at] += value;
}

/// The entries of K with so many decimal digits.
pub fn rounded(mut deck: Deck, digits: usize) -> Deck {
    let round = |v: &mut f64| *v = format!("{v:.*e}", digits - 1).parse().unwrap();
    deck.bodies.iter_mut().for_each(|body| body.stiffness.val.iter_mut().for_each(round));
    deck
}

/// The deck with its rigid motions given as these.
pub fn given(deck: &Deck, modes: Modes) -> Problem {
    hand_over::with_motions(deck, modes).unwrap()
}

/// Forces, displacements and products of a solve that passes.
pub struct Solved {
    pub lambda: Vec<f64>,
    pub mu: Vec<f64>,
    pub u: Vec<f64>,
    pub products: usize,
}

pub fn solved(problem: &mut Problem) -> Result<Solved> {
    let report = problem.solve()?;
    assert_eq!(report.outcome, Outcome::Solved, "{:?}", report.certificate);
    assert!(report.certificate.passed());
    Ok(Solved {
        lambda: problem.multipliers(RowKind::Inequality)?.to_vec(),
        mu: problem.multipliers(RowKind::Equality)?.to_vec(),
        u: problem.displacements()?.to_vec(),
        products: report.counts.products,
    })
}

pub fn assert_same_bits_for_any_threads(deck: &Deck) {
    let with = |threads: i64| {
        let mut problem = given(deck, Modes::Soft);
        problem.set_i64("threads", threads).unwrap();
        let found = solved(&mut problem).unwrap();
        found.u.iter().chain(&found.lambda).map(|v| v.to_bits()).collect::<Vec<_>>()
    };
    assert!(with(1) == with(2) && with(1) == with(4));
}

/// max |x_i - y_i| / max |y_i|
pub fn difference(x: &[f64], y: &[f64]) -> f64 {
    let largest = |x: &mut dyn Iterator<Item = f64>| {
        x.fold(0.0, |most: f64, v| if v.abs() > most || v.is_nan() { v.abs() } else { most })
    };
    largest(&mut x.iter().zip(y).map(|(x, y)| x - y)) / largest(&mut y.iter().copied())
}
