//! Whole problems with surfaces: blocks of bilinear elements that meet on their faces.

mod block;
mod contract;
mod loops;
mod pressed;
mod ties;

pub use block::{block, Block};

use crate::solver::{PairMethod, Problem, Shape};

pub fn pair(problem: &mut Problem, slave: usize, master: usize, distance: f64) -> usize {
    problem.pair_add(slave, master, PairMethod::NodeToFace, false, distance).unwrap().0
}
