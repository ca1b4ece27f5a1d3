//! Newton loops by mortar: a convex block slides up the side of a valley.

use super::pair_by;
use super::solids::{mapped, Solid};
use crate::solver::{PairMethod, Problem, Shape};

/// Curvatures / 2 of the valley and of the foot of the block, 1 / length. On the way of the block the valley rises to 25 degrees.
const VALLEY: f64 = 0.15;
const FOOT: f64 = 0.6;
/// Way of a step, and steps.
const STEP: f64 = 0.3;
const STEPS: usize = 4;

/// Two bodies with all their displacements; those of the upper one's top are prescribed.
struct Sliding {
    problem: Problem,
    solids: [Solid; 2],
    bodies: [usize; 2],
    surfaces: [usize; 2],
    pair: usize,
    u: [Vec<f64>; 2],
}

impl Sliding {
    fn new(shape: Shape, friction: f64) -> Self {
        let coarse = if shape == Shape::Line3 { 2 } else { 1 };
        let grid = |low: [f64; 2], size: [f64; 2], steps: [usize; 2], to: &dyn Fn(f64, f64) -> f64| {
            let steps = steps.map(|n| n / coarse);
            let corner = |at: [usize; 3]| {
                [0, 1, 2].map(|i| if i < 2 { low[i] + size[i] * at[i] as f64 / steps[i] as f64 } else { 0.0 })
            };
            mapped(shape, &steps, corner, |x| [x[0], to(x[0], x[1]), 0.0])
        };
        let mut lower = grid([-2.0, -1.5], [5.0, 1.5], [60, 8], &|x, y| y + VALLEY * x * x * (1.0 + y / 1.5));
        let mut upper = grid([-0.6, 0.0], [1.2, 1.0], [18, 8], &|x, y| y + FOOT * x * x * (1.0 - y));
        lower.hold(|x, _| x[1] == -1.5);
        upper.hold(|x, _| x[1] == 1.0);
        let mut problem = Problem::new();
        let zeros = |of: &Solid| vec![0.0; of.x.len()];
        let u = [zeros(&lower), zeros(&upper)];
        let bodies = [lower.give(&mut problem, &u[0]), upper.give(&mut problem, &u[1])];
        let surfaces =
            [lower.surface(&mut problem, bodies[0], true), upper.surface(&mut problem, bodies[1], false)];
        let pair = pair_by(&mut problem, PairMethod::Mortar, surfaces[1], surfaces[0], 0.5);
        if friction > 0.0 {
            problem.pair_set(pair, "friction", &[friction]).unwrap();
        }
        Self { problem, solids: [lower, upper], bodies, surfaces, pair, u }
    }

    /// One iteration; the largest increment.
    fn iterate(&mut self) -> f64 {
        for (k, of) in self.solids.iter().enumerate() {
            let x: Vec<f64> = of.x.iter().zip(&self.u[k]).map(|(x, u)| x + u).collect();
            self.problem.surface_move(self.surfaces[k], &x, 2).unwrap();
            let forces = of.forces(&self.u[k]);
            let free = of.dof.iter().zip(&forces).filter(|(dof, _)| **dof >= 0);
            self.problem.set_load(self.bodies[k], &free.map(|(_, f)| -f).collect::<Vec<_>>()).unwrap();
        }
        self.problem.pairs_find().unwrap();
        self.problem.solve().unwrap();
        let mut largest = 0.0f64;
        for (k, of) in self.solids.iter().enumerate() {
            let du = self.problem.displacement(self.bodies[k]).unwrap();
            for (u, dof) in self.u[k].iter_mut().zip(&of.dof).filter(|(_, dof)| **dof >= 0) {
                *u += du[*dof as usize];
                largest = largest.max(du[*dof as usize].abs());
            }
        }
        largest
    }

    /// Iterations of one step, to increments of 1e-10.
    fn step(&mut self, to: f64) -> usize {
        self.problem.pairs_commit().unwrap();
        // without the last term the two would only touch
        let by = [to, VALLEY * to * to * FOOT / (FOOT - VALLEY) - 0.03];
        for (i, u) in self.u[1].iter_mut().enumerate().filter(|(i, _)| self.solids[1].dof[*i] < 0) {
            *u = by[i % 2];
        }
        let mut history = Vec::new();
        while history.len() < 40 {
            history.push(self.iterate());
            if history[history.len() - 1] <= 1e-10 {
                return history.len();
            }
        }
        panic!("no end: {history:?}");
    }
}

#[test]
fn newtons_method_of_a_block_that_slides_up_a_valley_ends() {
    for (shape, friction, most) in
        [(Shape::Line2, 0.0, 15), (Shape::Line3, 0.0, 15), (Shape::Line2, 0.3, 20), (Shape::Line3, 0.3, 20)]
    {
        let mut sliding = Sliding::new(shape, friction);
        let counts: Vec<usize> = (0..=STEPS).map(|k| sliding.step(STEP * k as f64)).collect();
        let facts = sliding.problem.pair_info(sliding.pair).unwrap();
        assert!(counts.iter().all(|count| *count <= most), "{shape:?} {friction}: {counts:?}");
        assert!(facts.closed > 3 && facts.largest_angle.is_some_and(|of| of.1 < 0.15), "{facts:?}");
        assert!(friction == 0.0 || facts.slipping > 0, "{facts:?}");
    }
}
