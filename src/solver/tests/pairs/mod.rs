//! Whole problems with surfaces: bodies that meet on their faces.

mod block;
mod contract;
mod forms;
mod hertz;
mod loops;
mod patch;
mod pressed;
mod solids;
mod tabled;
mod ties;
mod valley;

pub use block::{block, stacked, Block};

use crate::solver::{PairMethod, Problem, Shape};

pub const METHODS: [PairMethod; 2] = [PairMethod::NodeToFace, PairMethod::Mortar];

pub fn pair(problem: &mut Problem, slave: usize, master: usize, distance: f64) -> usize {
    pair_by(problem, PairMethod::NodeToFace, slave, master, distance)
}

pub fn pair_by(
    problem: &mut Problem,
    method: PairMethod,
    slave: usize,
    master: usize,
    distance: f64,
) -> usize {
    problem.pair_add(slave, master, method, false, distance).unwrap().0
}
