//! Newton loops of a host: find, residual, solve.

use super::*;
use crate::solver::{PairField, RowKind};

/// A block that is pressed by its top into another one and slides on it; K is that of small strains.
struct Sliding {
    problem: Problem,
    blocks: [Block; 2],
    bodies: [usize; 2],
    surfaces: [usize; 2],
    pair: usize,
    /// All directions, those of the top prescribed.
    u: [Vec<f64>; 2],
    /// Positions; the foot of the upper block is a little convex, so that the pressure has no peaks at its ends.
    x: [Vec<f64>; 2],
}

/// Curvature / 2 of the foot of the upper block, 1 / length.
const CROWN: f64 = 0.15;

impl Sliding {
    fn new(method: PairMethod, friction: f64, elements: usize) -> Self {
        let lower = block(&[0.0, 0.0], &[4.0, 1.0], &[elements, 5], |x| x[1] == 0.0);
        let upper = block(&[0.5, 1.0], &[1.5, 1.0], &[11, 6], |x| x[1] == 2.0);
        let mut problem = Problem::new();
        let bodies = [lower.give(&mut problem), upper.give(&mut problem)];
        let surfaces =
            [lower.surface(&mut problem, bodies[0], true), upper.surface(&mut problem, bodies[1], false)];
        let made = pair_by(&mut problem, method, surfaces[1], surfaces[0], 0.5);
        if friction > 0.0 {
            problem.pair_set(made, "friction", &[friction]).unwrap();
        }
        let u = [vec![0.0; lower.dof.len()], vec![0.0; upper.dof.len()]];
        let mut x = [lower.x.clone(), upper.x.clone()];
        for node in upper.side(false) {
            x[1][2 * node + 1] += CROWN * (x[1][2 * node] - 1.25).powi(2);
        }
        for (x, surface) in x.iter().zip(surfaces) {
            problem.surface_move(surface, x, 2).unwrap();
        }
        problem.pairs_commit().unwrap();
        Self { problem, blocks: [lower, upper], bodies, surfaces, pair: made, u, x }
    }

    /// Prescribes the displacement of the top.
    fn top(&mut self, by: [f64; 2]) {
        for node in self.blocks[1].side(true) {
            self.u[1][2 * node..2 * node + 2].copy_from_slice(&by);
        }
    }

    /// One iteration; the largest increment.
    fn iterate(&mut self) -> f64 {
        for k in 0..2 {
            let x: Vec<f64> = self.x[k].iter().zip(&self.u[k]).map(|(x, u)| x + u).collect();
            self.problem.surface_move(self.surfaces[k], &x, 2).unwrap();
            let residual: Vec<f64> = self.blocks[k].forces(&self.u[k]).iter().map(|f| -f).collect();
            self.problem.set_load(self.bodies[k], &self.blocks[k].gathered(&residual)).unwrap();
        }
        self.problem.pairs_find().unwrap();
        self.problem.solve().unwrap();
        let mut largest = 0.0f64;
        for k in 0..2 {
            let du = self.blocks[k].spread(self.problem.displacement(self.bodies[k]).unwrap());
            self.u[k].iter_mut().zip(&du).for_each(|(u, du)| *u += du);
            largest = du.iter().fold(largest, |most, du| most.max(du.abs()));
        }
        largest
    }

    fn converge(&mut self) -> usize {
        let mut history = Vec::new();
        while history.len() < 30 {
            history.push(self.iterate());
            if history[history.len() - 1] <= 1e-10 {
                return history.len();
            }
        }
        panic!("no end: {history:?}");
    }
}

#[test]
fn newtons_method_of_two_sliding_blocks_ends_within_twenty_iterations() {
    let cases = [(0.0, 21), (0.0, 25), (0.3, 22), (0.3, 25)];
    for (method, (friction, elements)) in METHODS.into_iter().flat_map(|of| cases.map(|case| (of, case))) {
        let is_mortar = method == PairMethod::Mortar;
        let mut sliding = Sliding::new(method, friction, elements);
        let mut counts = Vec::new();
        for step in 1..=4 {
            sliding.problem.pairs_commit().unwrap();
            sliding.top([0.12 * f64::from(step), -0.1]);
            counts.push(sliding.converge());
        }
        let facts = sliding.problem.pair_info(sliding.pair).unwrap();
        let mean = facts.force[1] / facts.closed_area;
        assert!(mean > 0.04, "p/E = {mean}");
        assert!(counts.iter().all(|count| *count <= 20), "{friction}: {counts:?}");
        // master nodes sink in between slave nodes
        assert!(
            facts.deepest_of_master.is_none_or(|deepest| deepest.1 < 1e-3) && facts.between_walls == 0,
            "{facts:?}"
        );
        // an edge of a face is 0.19, kinks have some hundredths of a radian
        let deepest = if is_mortar { 1e-3 } else { 0.02 * 0.19 * 0.1 };
        assert!(facts.deepest.is_none_or(|of| of.1 < deepest), "{facts:?}");
        assert!(facts.largest_angle.is_some_and(|of| of.1 < 0.2) == is_mortar, "{facts:?}");
        if friction > 0.0 {
            let [pressure, shear] = [PairField::Pressure, PairField::Shear]
                .map(|of| sliding.problem.pair_field(sliding.pair, of).unwrap());
            let slipping = sliding.blocks[1].side(false).into_iter().filter(|node| pressure[*node] > 0.0);
            for node in slipping {
                let size = shear[2 * node].hypot(shear[2 * node + 1]);
                assert!(size <= 0.3 * pressure[node] * (1.0 + 1e-8));
            }
            assert!(facts.force[0] < -0.25 * facts.force[1], "friction holds the block back: {facts:?}");
        }
    }
}

/// Nodes at a kink of the master change their face in each iteration, unless they keep it for a while: `pairs_commit` makes them forget.
#[test]
fn without_kept_faces_a_loop_may_run_in_a_circle() {
    let mut sliding = Sliding::new(PairMethod::NodeToFace, 0.0, 25);
    sliding.top([0.12, -0.1]);
    let mut iterate = || {
        sliding.problem.pairs_commit().unwrap();
        sliding.iterate()
    };
    (0..25).for_each(|_| _ = iterate());
    assert!(iterate() > 1e-3 && iterate() > 1e-3);
}

#[test]
fn a_state_saved_in_the_middle_of_a_loop_brings_back_every_bit() {
    METHODS.into_iter().for_each(saved_in_the_middle);
}

fn saved_in_the_middle(method: PairMethod) {
    let mut sliding = Sliding::new(method, 0.3, 21);
    sliding.top([0.12, -0.1]);
    (0..3).for_each(|_| _ = sliding.iterate());
    let (state, u) = (sliding.problem.save_state().unwrap(), sliding.u.clone());
    let rest = |sliding: &mut Sliding| {
        (0..4).for_each(|_| _ = sliding.iterate());
        let bits = |values: &[f64]| values.iter().map(|v| v.to_bits()).collect::<Vec<_>>();
        let forces = bits(sliding.problem.multipliers(RowKind::Inequality).unwrap());
        (bits(&sliding.u[0]), bits(&sliding.u[1]), forces)
    };
    let first = rest(&mut sliding);
    sliding.problem.pairs_commit().unwrap();
    sliding.top([0.3, -0.15]);
    sliding.iterate();
    sliding.problem.restore_state(state).unwrap();
    sliding.u = u;
    assert!(rest(&mut sliding) == first);
}
