//! A point of the finish: forces and displacements in two doubles, corrected on one face by the residuals of the host's data.

use crate::certificate::{BodyData, NOISE};
use crate::error::Result;
use crate::linalg::twofold::{TwofoldByBody, TwofoldVector};
use crate::linalg::vector::axpy;
use crate::linalg::ByBody;
use crate::numbers::solve::FAR;
use crate::qp::friction::{Corrected, State};
use crate::qp::Face;
use crate::solve::feedback::{Feedback, NegativeMotions};
use crate::solve::gaps::Gaps;
use crate::solve::recovery::{Ending, Recovery};

use crate::solve::sparse_face::{Inside, SparseFace};

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
    v: TwofoldByBody,
    /// Amplitudes of the motions that v contains.
    beta: Vec<f64>,
    w: TwofoldByBody,
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
            let (v, x) = (deformed.map(|_| 0.0), vec![0.0; solution.x.len()]);
            return Ok(Self::at_origin(recovery, v, (x, modes), apart));
        }
        let deformed = recovery.deformed(&solution.x)?;
        let mut point = Self::at_origin(recovery, deformed, (solution.x.clone(), modes), apart);
        point.turn(recovery, &solution.alpha)?;
        Ok(point)
    }

    pub fn at_origin(recovery: &Recovery, v: ByBody, (x, modes): (Vec<f64>, usize), apart: f64) -> Self {
        let corrected = vec![0.0; recovery.data.touched.len()];
        let (w, v, x) = (v.map(|_| 0.0).into(), v.into(), x.into());
        Self { w, v, x, alpha: vec![0.0; modes], beta: vec![0.0; modes], apart, corrected }
    }

    /// The point of an interior point method.
    pub fn inside(recovery: &Recovery, Inside { motion, force, .. }: &Inside) -> Self {
        let alpha = recovery.amplitudes(motion);
        let point = Self::at_origin(recovery, motion.clone(), (force.clone(), alpha.len()), FAR);
        Self { beta: alpha.clone(), alpha, ..point }
    }

    /// Adds R a and returns R a.
    fn turn(&mut self, recovery: &Recovery, a: &[f64]) -> Result<ByBody> {
        let motion = recovery.ready.rigid_motion(a);
        let apart = recovery.travels(&motion, &self.v.values(), self.apart)?;
        for (p, apart) in apart.into_iter().enumerate() {
            let to = if apart { &mut self.w } else { &mut self.v };
            to.add_on(p, motion.on(p));
            if !apart {
                let modes = recovery.ready.dual.modes_of(p);
                axpy(1.0, &a[modes.clone()], &mut self.beta[modes]);
            }
        }
        axpy(1.0, a, &mut self.alpha);
        Ok(motion)
    }

    /// u - R alpha
    pub fn deformed(&self, recovery: &Recovery) -> ByBody {
        let mut v = self.v.values();
        v.add(-1.0, &recovery.ready.rigid_motion(&self.beta));
        v
    }

    /// u
    pub fn displacement(&self) -> ByBody {
        let mut u = self.w.values();
        u.add(1.0, &self.v.values());
        u
    }

    fn gaps_left(&self, recovery: &Recovery) -> Vec<f64> {
        recovery.gaps_left(&[self.v.parts(), self.w.parts()].concat(), &self.x.parts())
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
        let (touched, bodies) = (recovery.data.touched, &recovery.data.bodies);
        let of_body = |(p, body): (usize, &BodyData)| -> Vec<f64> {
            touched.dofs(p).map(|dof| body.stiffness.metric(dof, body.unit)).collect()
        };
        let stiffness: Vec<f64> = bodies.iter().enumerate().flat_map(of_body).collect();
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
        let load = recovery.load_left(&self.v.parts(), &self.x.parts())?;
        let left = self.gaps_left(recovery);
        let (moved, forces) = match face {
            FaceSolver::Sparse(face) => {
                let (moved, mut forces) = face.solve(&load, &left)?;
                self.v.add(&moved);
                let turn = recovery.amplitudes(&moved);
                axpy(1.0, &turn, &mut self.alpha);
                axpy(1.0, &turn, &mut self.beta);
                // a spring of a body is its stiffness along a soft motion, which K contains
                let first = forces.len() - dual.springs;

                forces
                    .iter_mut()
                    .enumerate()
                    .skip(first)
                    .for_each(|(i, force)| *force = dual.coarse.row_dot(i, &turn));
                (moved, forces)
            }
            FaceSolver::Dense(feedback) => {
                let face = &feedback.face;
                let mut gaps = vec![0.0; self.x.len()];
                face.rows().iter().for_each(|&i| gaps[i] = left[i]);
                let d = dual.rhs(&recovery.ready.moved(recovery.threads, &load)?, &gaps);
                let force = face.rows().iter().map(|&i| d[i]).collect();
                let (step, turn) = feedback.solve(negative, force, &dual.resultants(&load))?;
                let mut forces = vec![0.0; self.x.len()];
                face.rows().iter().zip(step).for_each(|(&i, step)| forces[i] = step);
                (self.moved_by(recovery, load, (&forces, &turn))?, forces)
            }
        };
        forces.iter().enumerate().for_each(|(i, force)| self.x.add(i, *force));
        let at = recovery.data.touched.at(&moved);
        self.corrected.iter_mut().zip(at).for_each(|(most, by)| *most = most.max(by.abs()));
        Ok(recovery.ready.length_of_all(&moved))
    }

    /// Adds the motion of the bodies by residual loads, the change of the forces and of the amplitudes, and returns it.
    fn moved_by(
        &mut self,
        recovery: &Recovery,
        mut load: ByBody,
        (forces, turn): (&[f64], &[f64]),
    ) -> Result<ByBody> {
        recovery.ready.take_forces(forces, &mut load);
        let mut moved = recovery.inverse(&load)?;
        self.v.add(&moved);
        moved.add(1.0, &self.turn(recovery, turn)?);
        Ok(moved)
    }

    /// A Newton step of the laws of friction for the residual loads, gaps and slips; the length of the step and the states that it
    /// assumes. None if too many rows may carry a force.
    pub fn step_with_friction(&mut self, recovery: &Recovery) -> Result<Option<(f64, Vec<State>)>> {
        let dual = &recovery.ready.dual;
        let gaps = self.gaps_left(recovery);
        let open = recovery.open_rows(&self.x.values(), &gaps)?;
        self.hold(&open);
        let (gaps, load) = (self.gaps_left(recovery), recovery.load_left(&self.v.parts(), &self.x.parts())?);
        let d = dual.rhs(&recovery.ready.moved(recovery.threads, &load)?, &gaps);
        let follows: Vec<f64> = d.iter().map(|d| -d).collect();
        let (x, left) = (self.x.values(), dual.resultants(&load));
        let at = Corrected { x: &x, r: &gaps, follows: &follows, left: &left, stiffness: &dual.negative };
        let Some(step) = recovery.friction_step(&open, at)? else { return Ok(None) };
        let moved = self.moved_by(recovery, load, (&step.forces, &step.turn))?;
        step.forces.iter().enumerate().for_each(|(i, force)| self.x.add(i, *force));
        Ok(Some((recovery.ready.length_of_all(&moved), step.states)))
    }

    /// The active set by the signs of forces and gaps.
    pub fn active(&self, recovery: &Recovery) -> Vec<bool> {
        let (left, rows) = (self.gaps_left(recovery), &recovery.ready.rows.scaled);
        let (u, x) = (recovery.data.touched.at(&self.displacement()), self.x.values());
        let Gaps { value, bounded, .. } = &recovery.scaled.gaps;
        let terms =
            |i: usize| rows.row(i).map(|(j, v)| v.abs() * u[j].abs().max(self.corrected[j])).sum::<f64>();
        let noise = |i: usize, of: f64| of * (value[i].abs() + terms(i));
        // a gap that corrections cannot close depends on other rows, which also carry its force
        let leaves = |i: usize| x[i] < 0.0 || left[i] > noise(i, NOISE);
        // in two doubles a gap is known to the rounding of its row
        let stays = |i: usize| if x[i] == 0.0 { left[i] >= -noise(i, f64::EPSILON) } else { leaves(i) };
        (0..x.len()).map(|i| bounded[i] && stays(i)).collect()
    }
}
