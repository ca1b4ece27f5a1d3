//! All combinations of states of a few nodes, one dense system each. In the plane they are all rests that there are.

use crate::error::Result;
use crate::linalg::vector::{axpy, norm, NOISE};
use crate::numbers::friction::RHO;
use crate::numbers::rounding;
use crate::qp::friction::cones::Node;
use crate::qp::friction::direct::Dense;
use crate::qp::friction::face::{Face, State};
use crate::qp::friction::newton::{Point, Run};
use crate::qp::friction::path::{Solves, Way};
use crate::qp::Rung;

/// More combinations are not tried: five nodes in the plane have as many.
const MOST: usize = 1024;
/// Newton steps by which slip directions in space turn after they were assumed along the axes.
const TURNS: usize = 8;

/// Contact and friction of one node.
#[derive(Clone, Copy)]
struct Choice {
    closed: bool,
    state: State,
    along: [f64; 2],
}

impl Choice {
    fn all(node: &Node) -> Vec<Self> {
        let mut all = Vec::new();
        for closed in [true, false].into_iter().filter(|closed| !closed || node.normal.is_some()) {
            let rubs = node.bound > 0.0 || (closed && node.mu > 0.0);
            let choice = |state, along| Self { closed, state, along };
            if !rubs || node.tangents().is_empty() {
                all.push(choice(State::Open, [1.0, 0.0]));
                continue;
            }
            all.push(choice(State::Stick, [1.0, 0.0]));
            for axis in 0..node.tangents().len() {
                for sense in [1.0, -1.0] {
                    let mut along = [0.0; 2];
                    along[axis] = sense;
                    all.push(choice(State::Slip, along));
                }
            }
        }
        all
    }
}

impl Run<'_, '_> {
    /// An answer by exactly solved systems: paths, then all combinations of states.
    pub fn densely(&mut self, dense: &Dense, start: &Point) -> Result<Option<Point>> {
        for relaxed in [0.0, 1.0] {
            let rung = if relaxed == 0.0 { Rung::DensePath } else { Rung::DenseRelaxed };
            if !rung.is_tried() {
                continue;
            }
            let way = Way { relaxed, last: rounding::SUM, solves: Solves::Dense(dense) };
            let now = self.along_path(start, way)?;
            if self.is_met(&now) {
                return Ok(Some(now));
            }
        }
        match Rung::Combinations.is_tried() {
            true => self.by_all_states(dense, start),
            false => Ok(None),
        }
    }

    /// The answer with the least motion among all combinations of states; none if there is none, or if there are too many combinations.
    fn by_all_states(&mut self, dense: &Dense, start: &Point) -> Result<Option<Point>> {
        let nodes = self.problem.cones.nodes();
        let choices: Vec<Vec<Choice>> = nodes.iter().map(Choice::all).collect();
        let count = choices.iter().try_fold(1usize, |count, own| count.checked_mul(own.len()));
        let Some(count) = count.filter(|count| *count <= MOST) else { return Ok(None) };
        let mut best: Option<Point> = None;
        for mut number in 0..count {
            let states: Vec<Choice> = choices
                .iter()
                .map(|own| {
                    let choice = own[number % own.len()];
                    number /= own.len();
                    choice
                })
                .collect();
            // nodes that share a normal row are closed together
            if (1..nodes.len()).any(|i| nodes[i].follows && states[i].closed != states[i - 1].closed) {
                continue;
            }
            self.counts.starts += 1;
            let Some(found) = self.of_states(dense, &states, start)? else { continue };
            if best.as_ref().is_none_or(|best| norm(&found.alpha) < norm(&best.alpha)) {
                best = Some(found);
            }
        }
        Ok(best)
    }

    /// The point with these states, if it meets the laws.
    fn of_states(&mut self, dense: &Dense, states: &[Choice], start: &Point) -> Result<Option<Point>> {
        let mut face = Face::empty(self.problem.cones, RHO);
        for (node, choice) in self.problem.cones.nodes().iter().zip(states) {
            face.push_node(node, choice.closed, choice.state, (choice.along, 0.0));
        }
        face.finish(self.problem.cones);
        let turns = if face.coordinates.iter().any(|at| at.rows[0] != at.rows[1]) { TURNS } else { 0 };
        let mut now = start.clone();
        for _ in 0..=turns {
            self.counts.direct += 1;
            let (step, turn) = dense.solved(&self.problem, &face, &now)?;
            let ((x, g), mut alpha) = (step.from(&now.x, &now.g, 1.0), now.alpha);
            axpy(1.0, &turn, &mut alpha);
            now = self.point(x, g, alpha)?;
            // the system is solved exactly: only its rounding is left
            let rounding = NOISE * (norm(&now.x) + norm(&now.g) + norm(&now.r));
            if now.merit <= self.small.max(rounding) {
                return Ok(Some(now));
            }
            if !now.merit.is_finite() {
                break;
            }
            face = Face::at(self.problem.cones, &now.x, &now.r, RHO);
        }
        Ok(None)
    }
}
