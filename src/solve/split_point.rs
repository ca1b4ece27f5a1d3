//! A point of the finish: forces and displacements in two doubles, corrected on one face by the residuals of the host's data.

use crate::body::{Distributed, Kept, Seen};
use crate::certificate::NOISE;
use crate::error::Result;
use crate::linalg::twofold::TwofoldVector;
use crate::linalg::vector::{axpy, norm_max, weighted_norm};
use crate::numbers::solve::FAR;
use crate::qp::friction::{Corrected, State};
use crate::qp::Face;
use crate::solve::feedback::{Feedback, NegativeMotions};
use crate::solve::local::{
    Added, Begin, Correct, Deformation, Displacement, Point, PointAtRows, Residual, Rigid, Shift,
};
use crate::solve::recovery::{Ending, Recovery};

use crate::solve::sparse_face::{Inside, SparseFace};

/// Limit of corrections on one active set, and of steps that close rows left out there.
pub const CORRECTIONS: usize = 10;

/// The factors of a face: dense ones of F and the modes, or sparse ones of the island.
#[derive(Clone, Copy)]
pub enum FaceSolver<'a> {
    Dense(&'a Feedback<'a>),
    Sparse(&'a SparseFace<'a>),
}

/// Forces x and amplitudes alpha with u = v + w: w are motions that K does not resist; in a sum with large w, v would
/// lose its digits. v, w and x are in two doubles: where loads and forces nearly cancel, rounding of x would move v.
#[derive(Clone)]
pub struct SplitPoint {
    /// v and w of every body.
    point: Kept<Point>,
    /// Amplitudes of the motions that v contains.
    beta: Vec<f64>,
    x: TwofoldVector,
    pub alpha: Vec<f64>,
    /// A motion of a body is added to w where it is larger than v by this factor.
    apart: f64,
    /// The largest correction of each touched unknown on this face: its rounding is not seen in u where a row presses u to zero.
    corrected: Vec<f64>,
}

impl SplitPoint {
    /// The current answer, or zero if it does not pass: redundant rows may have spoilt its forces. With friction the states need the
    /// answer.
    pub fn of(recovery: &Recovery, ending: &Ending, apart: f64) -> Result<Self> {
        let Ending { solution, deformed, judgement, .. } = ending;
        let modes = solution.alpha.len();
        if !judgement.certificate.passed() && !recovery.friction {
            let x = vec![0.0; solution.x.len()];
            return Self::begin(recovery, (&deformed.of, true), (x, modes), apart);
        }
        let deformed = recovery.deformed(&solution.x)?;
        let mut point = Self::at_origin(recovery, &deformed.of, (solution.x.clone(), modes), apart)?;
        point.turn(recovery, &solution.alpha)?;
        Ok(point)
    }

    pub fn at_origin(recovery: &Recovery, v: &Kept, x: (Vec<f64>, usize), apart: f64) -> Result<Self> {
        Self::begin(recovery, (v, false), x, apart)
    }

    /// At v, or 0 if `at_rest`.
    fn begin(
        recovery: &Recovery,
        (v, at_rest): (&Kept, bool),
        (x, modes): (Vec<f64>, usize),
        apart: f64,
    ) -> Result<Self> {
        let corrected = vec![0.0; recovery.data.touched.len()];
        let (_, point) = recovery.data.bodies.make(|_| Begin { at_rest }, v)?;
        Ok(Self { point, x: x.into(), alpha: vec![0.0; modes], beta: vec![0.0; modes], apart, corrected })
    }

    /// The point of an interior point method.
    pub fn inside(recovery: &Recovery, Inside { motion, force, .. }: &Inside) -> Result<Self> {
        let v = recovery.data.bodies.put(motion.each().map(<[f64]>::to_vec).collect())?;
        let alpha = recovery.data.bodies.ask(|_| Rigid, &v)?.concat();
        let point = Self::at_origin(recovery, &v, (force.clone(), alpha.len()), FAR)?;
        Ok(Self { beta: alpha.clone(), alpha, ..point })
    }

    /// Adds R a.
    fn turn(&mut self, recovery: &Recovery, a: &[f64]) -> Result<()> {
        let shift = |p: usize| Shift { a: recovery.of_modes(p, a), apart: self.apart };
        let apart = recovery.data.bodies.change(shift, &mut self.point, ())?;
        self.turned(recovery, a, apart.into_iter());
        Ok(())
    }

    /// Of every body: whether its motion by R a is apart.
    fn turned(&mut self, recovery: &Recovery, a: &[f64], apart: impl Iterator<Item = bool>) {
        for (p, _) in apart.enumerate().filter(|(_, apart)| !apart) {
            let modes = recovery.ready.dual.modes_of(p);
            axpy(1.0, &a[modes.clone()], &mut self.beta[modes]);
        }
        axpy(1.0, a, &mut self.alpha);
    }

    /// u - R alpha
    pub fn deformed(&self, recovery: &Recovery) -> Result<Distributed> {
        let deformation = |p: usize| Deformation { beta: recovery.of_modes(p, &self.beta) };
        Ok(Distributed::new(recovery.data.bodies.make(deformation, &self.point)?))
    }

    /// u
    pub fn displacement(&self, recovery: &Recovery) -> Result<Distributed> {
        Ok(Distributed::new(recovery.data.bodies.make(|_| Displacement, &self.point)?))
    }

    fn gaps_left(&self, recovery: &Recovery) -> Result<Vec<f64>> {
        let parts = recovery.data.bodies.ask(|_| PointAtRows, &self.point)?;
        let parts = [0, 1, 2, 3].map(|k| parts.iter().flat_map(|of| &of[k]).copied().collect::<Vec<_>>());
        Ok(recovery.gaps_left(&parts.each_ref().map(|part| &part[..]), &self.x.parts()))
    }

    fn load_left(&self, recovery: &Recovery) -> Result<Distributed> {
        recovery.load_left(&self.point, &self.x.parts())
    }

    /// Sets the forces to 0 on rows outside the active set.
    pub fn hold(&mut self, active: &[bool]) {
        (0..active.len()).filter(|&i| active[i]).for_each(|i| self.x.set_to_zero(i));
        self.corrected.fill(0.0);
    }

    /// Takes away forces that cancel between rows of a face which depend on each other, as far as contact rows still press: beside
    /// soft bodies their rounding would exceed what these carry. Each force counts by the motions that it would cause alone, by
    /// D even at carried unknowns.
    pub fn settle(&mut self, recovery: &Recovery, face: &Face) -> Result<()> {
        let (rows, bounded) = (&recovery.ready.rows.matrix, &recovery.scaled.gaps.bounded);
        let of_body = |body: &Seen| {
            let stiff = |d: &f64| Some(*d).filter(|d| *d > 0.0).unwrap_or(body.unit());
            body.diagonal().iter().map(stiff).collect::<Vec<f64>>()
        };
        let stiffness: Vec<f64> = recovery.data.bodies.iter().flat_map(of_body).collect();
        // a spring of a body depends on no row
        let weight = |&i: &usize| {
            let of_row = |i: usize| rows.row(i).map(|(j, v)| v * v / stiffness[j]).sum::<f64>();
            if i < rows.rows() {
                of_row(i)
            } else {
                1.0
            }
        };
        let x: Vec<f64> = face.rows().iter().map(|&i| self.x.get(i)).collect();
        let idle = face.idle(&x, &face.rows().iter().map(weight).collect::<Vec<_>>())?;
        let lifts = |k: &usize| bounded[face.rows()[*k]] && idle[*k] > 0.0;
        let part = (0..x.len()).filter(lifts).map(|k| x[k] / idle[k]).fold(1.0, f64::min).max(0.0);
        face.rows().iter().zip(idle).for_each(|(&i, idle)| self.x.add(i, -part * idle));
        Ok(())
    }

    /// x without the rounding of forces that are zero.
    pub fn forces(&self, bounded: &[bool]) -> TwofoldVector {
        let (mut x, is_rounding) = (self.x.clone(), |&i: &usize| bounded[i] && self.x.get(i) < 0.0);
        (0..x.len()).filter(is_rounding).for_each(|i| x.set_to_zero(i));
        x
    }

    /// Solves (10)-(11) on the face for the residual loads and gaps, `f - K u - B'x` and `c + C x - B u`: every
    /// correction reduces the errors of F and K+. Returns the length of the correction, `|.|_D`.
    pub fn correct(
        &mut self,
        recovery: &Recovery,
        negative: &NegativeMotions,
        face: FaceSolver,
    ) -> Result<f64> {
        let dual = &recovery.ready.dual;
        let load = self.load_left(recovery)?;
        let left = self.gaps_left(recovery)?;
        let (length, forces) = match face {
            FaceSolver::Sparse(face) => {
                let (moved, mut forces) = face.solve(&load, &left)?;
                let added = |p: usize| Added { by: moved.on(p).to_vec() };
                let added = recovery.data.bodies.change(added, &mut self.point, ())?;
                let turn: Vec<f64> = added.iter().flat_map(|of| &of.a).copied().collect();
                axpy(1.0, &turn, &mut self.alpha);
                axpy(1.0, &turn, &mut self.beta);
                // a spring of a body is its stiffness along a soft motion, which K contains
                let first = forces.len() - dual.springs;
                let springs = forces.iter_mut().enumerate().skip(first);
                springs.for_each(|(i, force)| *force = dual.coarse.row_dot(i, &turn));
                (self.note(added.iter().map(|of| (&of.at_rows, of.length))), forces)
            }
            FaceSolver::Dense(feedback) => {
                let face = &feedback.face;
                let mut gaps = vec![0.0; self.x.len()];
                face.rows().iter().for_each(|&i| gaps[i] = left[i]);
                let (load, (d, resultants)) = self.dual_of(recovery, load, &gaps)?;
                let force = face.rows().iter().map(|&i| d[i]).collect();
                let (step, turn) = feedback.solve(negative, force, &resultants)?;
                let mut forces = vec![0.0; self.x.len()];
                face.rows().iter().zip(step).for_each(|(&i, step)| forces[i] = step);
                (self.moved_by(recovery, load, (&forces, &turn))?, forces)
            }
        };
        forces.iter().enumerate().for_each(|(i, force)| self.x.add(i, *force));
        Ok(length)
    }

    /// Completes the residual loads by their values where rows touch; d and e of (12)-(13) for them and these gaps.
    fn dual_of(
        &self,
        recovery: &Recovery,
        mut load: Distributed,
        gaps: &[f64],
    ) -> Result<(Distributed, (Vec<f64>, Vec<f64>))> {
        let residual = |p: usize| Residual { at_rows: recovery.of_rows(p, &load.at_rows) };
        let answers = recovery.data.bodies.change(residual, &mut load.of, ())?.into_iter();
        let (moved, resultants): (Vec<_>, Vec<_>) = answers.map(|of| (of.moved, of.resultants)).unzip();
        let d = recovery.ready.dual.rhs(&moved, gaps);
        Ok((load, (d, resultants.concat())))
    }

    /// Adds the motion of the bodies by residual loads, the change of the forces and of the amplitudes; its length.
    fn moved_by(
        &mut self,
        recovery: &Recovery,
        load: Distributed,
        (forces, turn): (&[f64], &[f64]),
    ) -> Result<f64> {
        let at_rows = recovery.ready.without_forces(forces, load.at_rows);
        let correct = |p: usize| Correct {
            at_rows: recovery.of_rows(p, &at_rows),
            a: recovery.of_modes(p, turn),
            apart: self.apart,
        };
        let corrected = recovery.data.bodies.change(correct, &mut self.point, &load.of)?;
        self.turned(recovery, turn, corrected.iter().map(|of| of.apart));
        Ok(self.note(corrected.iter().map(|of| (&of.at_rows, of.length))))
    }

    /// Notes a correction of every body, where rows touch and its length; their length, `|.|_D`.
    fn note<'c>(&mut self, corrections: impl Iterator<Item = (&'c Vec<f64>, f64)>) -> f64 {
        let (at_rows, lengths): (Vec<_>, Vec<f64>) = corrections.unzip();
        let at_rows = at_rows.into_iter().flatten();
        self.corrected.iter_mut().zip(at_rows).for_each(|(most, by)| *most = most.max(by.abs()));
        weighted_norm(&lengths, |_| 1.0)
    }

    /// A Newton step of the laws of friction for the residual loads, gaps and slips; the length of the step and the states that it
    /// assumes. None if too many rows may carry a force.
    pub fn step_with_friction(&mut self, recovery: &Recovery) -> Result<Option<(f64, Vec<State>)>> {
        let gaps = self.gaps_left(recovery)?;
        let open = recovery.open_rows(&self.x.values(), &gaps)?;
        self.hold(&open);
        let (gaps, load) = (self.gaps_left(recovery)?, self.load_left(recovery)?);
        let (load, (d, left)) = self.dual_of(recovery, load, &gaps)?;
        let follows: Vec<f64> = d.iter().map(|d| -d).collect();
        let (x, stiffness) = (self.x.values(), &recovery.ready.dual.negative);
        let at = Corrected { x: &x, r: &gaps, follows: &follows, left: &left, stiffness };
        let Some(step) = recovery.friction_step(&open, at)? else { return Ok(None) };
        let length = self.moved_by(recovery, load, (&step.forces, &step.turn))?;
        step.forces.iter().enumerate().for_each(|(i, force)| self.x.add(i, *force));
        Ok(Some((length, step.states)))
    }

    /// The gaps of the rows, and the sizes of their terms, also of those that corrections have cancelled.
    fn gaps(&self, recovery: &Recovery) -> Result<(Vec<f64>, Vec<f64>)> {
        let (rows, value) = (&recovery.ready.rows.scaled, &recovery.scaled.gaps.value);
        let u = self.displacement(recovery)?.at_rows;
        let term = |(j, v): (usize, f64)| v.abs() * u[j].abs().max(self.corrected[j]);
        let terms = (0..rows.rows()).map(|i| value[i].abs() + rows.row(i).map(term).sum::<f64>());
        Ok((self.gaps_left(recovery)?, terms.collect()))
    }

    /// The active set by the signs of forces and gaps.
    pub fn active(&self, recovery: &Recovery) -> Result<Vec<bool>> {
        let ((left, terms), x) = (self.gaps(recovery)?, self.x.values());
        // a gap that corrections cannot close depends on other rows, which also carry its force
        let leaves = |i: usize| x[i] < 0.0 || left[i] > NOISE * terms[i];
        // in two doubles a gap is known to the rounding of its row
        let stays = |i: usize| if x[i] == 0.0 { left[i] >= -f64::EPSILON * terms[i] } else { leaves(i) };
        let bounded = &recovery.scaled.gaps.bounded;
        Ok((0..x.len()).map(|i| bounded[i] && stays(i)).collect())
    }

    /// Closes rows that the factors of a face have left out. Rows that depend on each other to t have pivots of t^2, which A shows only down
    /// to rounding; in two doubles `correct` shows how forces on them open their gaps: conjugate gradients over these forces.
    pub fn close(
        &mut self,
        recovery: &Recovery,
        face: &Face,
        correct: impl Fn(&mut Self) -> Result<()>,
    ) -> Result<()> {
        let (left, terms) = self.gaps(recovery)?;
        let is_open = |(i, _): &(usize, f64)| left[*i].abs() > f64::EPSILON * terms[*i];
        let rows: Vec<(usize, f64)> = face.left_out().filter(is_open).collect();
        let (mut along, mut before) = (vec![0.0; rows.len()], f64::INFINITY);
        for _ in 0..rows.len().min(CORRECTIONS) {
            let left = self.gaps_left(recovery)?;
            let work = rows.iter().map(|(i, stiffness)| left[*i] * left[*i] / stiffness).sum::<f64>();
            for (along, (i, stiffness)) in along.iter_mut().zip(&rows) {
                *along = work / before * *along - left[*i] / stiffness;
            }
            let press = |point: &mut Self, share: f64| {
                rows.iter().zip(&along).for_each(|((i, _), along)| point.x.add(*i, share * along));
                correct(point)
            };
            let (mut pressed, share) = (self.clone(), norm_max(&self.x.values()) / norm_max(&along));
            press(&mut pressed, share)?;
            let opened: Vec<f64> = pressed
                .gaps_left(recovery)?
                .iter()
                .zip(&left)
                .map(|(to, from)| (to - from) / share)
                .collect();
            let dot = |of: &[f64]| rows.iter().zip(&along).map(|((i, _), along)| along * of[*i]).sum::<f64>();
            let alone = rows.iter().zip(&along).map(|((_, stiffness), along)| stiffness * along * along);
            if !(dot(&opened) > NOISE * NOISE * alone.sum::<f64>()) {
                break;
            }
            press(self, -dot(&left) / dot(&opened))?;
            before = work;
        }
        Ok(())
    }
}
