//! One body of an island under the forces of its rows. All that the certificate takes from its K, null space, load and displacement are
//! sizes, amplitudes, and values where rows touch it: `Fitted`, then, once the island has decided which motions are free, `Measured`.

mod measured;

pub(super) use measured::{Measured, Shared};

use std::borrow::Cow;
use std::collections::HashSet;

use crate::certificate::{BodyData, NOISE};
use crate::error::Result;
use crate::linalg::vector::{axpy, weighted_norm};
use crate::linalg::Matrix;
use crate::platform::memory::{copied, filled, zeros};

const WHAT: &str = "the certificate";

/// What rows do to a body, at the t unknowns that they touch.
pub(super) struct Told {
    /// U, the power of two below max D of the island, force / length.
    pub unit: f64,
    /// These unknowns within the body, ascending.
    pub dofs: Vec<usize>,
    /// D~ / U and D^ / U, no unit.
    pub metric: Vec<f64>,
    pub led: Vec<f64>,
    /// Carried unknowns.
    pub carried: Vec<bool>,
    /// r and its terms, force.
    pub push: Vec<f64>,
    pub push_terms: Vec<f64>,
    /// r without the forces of an unknown's own rows where it is carried, force.
    pub passed_on: Vec<f64>,
}

/// A body with what its rows do.
pub(super) struct Part<'a> {
    body: &'a BodyData<'a>,
    told: Told,
    /// u, n_p, length.
    u: &'a [f64],
    /// D~ / U, n_p, no unit.
    metric: Vec<f64>,
    /// D^ / U, n_p, no unit: in it forces that cancel move an unknown by their rounding.
    led: Vec<f64>,
    /// R, and the unit with `R'D~R = unit`, force / length.
    motions: (Cow<'a, Matrix>, f64),
    /// Grounded unknowns.
    grounded: Vec<bool>,
    /// r = B'lambda + H'mu + T'lambda_t, n_p, force.
    push: Vec<f64>,
    /// `|B'||lambda| + |H'||mu| + |T'||lambda_t|`, n_p, force.
    push_terms: Vec<f64>,
    sizes: Sizes,
}

/// What a body tells first.
pub(super) struct Fitted {
    /// `a = R'D u / unit`, r, length, without grounded unknowns.
    pub amplitudes: Vec<f64>,
    /// R where rows touch, t x r, and its unit, force / length.
    pub motions: Matrix,
    pub unit: f64,
    /// Grounded unknowns where rows touch.
    pub grounded: Vec<bool>,
    pub sizes: Sizes,
}

/// Sizes of the forces on a body.
#[derive(Clone, Copy, Default)]
pub(super) struct Sizes {
    /// `|f|_{D^-1}` without grounded unknowns, force.
    pub load: f64,
    /// `|r|_{D^-1}`, force.
    pub push: f64,
    /// `|f|_{D^-1} + |r|_{D^-1}` without grounded unknowns, force; none if all unknowns are grounded.
    pub all: Option<f64>,
    /// `||f| + |B'||lambda| + |H'||mu||_{D^-1}` without grounded unknowns, force, and the same in D^.
    pub terms: f64,
    pub led: f64,
    /// The load if it is rounding of the load of the host's body, force; otherwise 0.
    pub noise: f64,
    /// `|D^1/2 f_j / K_jj|` over the grounded unknowns, with the largest D of the others: the motion that the ground prescribes, force.
    pub moved: f64,
}

impl<'a> Part<'a> {
    pub fn new(body: &'a BodyData<'a>, told: Told, u: &'a [f64]) -> Result<Self> {
        let n = body.stiffness.order();
        let mut metric = zeros(n, WHAT)?;
        metric.iter_mut().enumerate().for_each(|(j, d)| *d = body.stiffness.metric(j, body.unit) / told.unit);
        told.set(&told.metric, &mut metric);
        let mut led = copied(&metric, WHAT)?;
        told.set(&told.led, &mut led);
        let (mut push, mut push_terms) = (zeros(n, WHAT)?, zeros(n, WHAT)?);
        told.set(&told.push, &mut push);
        told.set(&told.push_terms, &mut push_terms);
        let motions = motions(body, told.unit, &metric, told.carried.contains(&true))?;
        let grounded = grounded(body, &told)?;
        let sizes = Sizes::default();
        let mut part = Self { body, told, u, metric, led, motions, grounded, push, push_terms, sizes };
        part.sizes = part.sizes();
        Ok(part)
    }

    /// What the island has to know before it decides which motions are free.
    pub fn fitted(&self) -> Result<Fitted> {
        let (motions, unit) = &self.motions;
        let dofs = &self.told.dofs;
        Ok(Fitted {
            amplitudes: self.amplitudes(),
            motions: Matrix::from_fn(dofs.len(), motions.cols, |j, k| motions.get(dofs[j], k))?,
            unit: *unit,
            grounded: dofs.iter().map(|dof| self.grounded[*dof]).collect(),
            sizes: self.sizes,
        })
    }

    fn sizes(&self) -> Sizes {
        let load = self.size(&self.free(|j| self.load(j)));
        let push = self.size(&self.free(|j| self.push[j]));
        let all = self.grounded.iter().all(|grounded| *grounded);
        let given = self.free(|j| self.load(j).abs() + self.push_terms[j]);
        let is_noise = self.body.is_noise(load / self.told.unit.sqrt());
        Sizes {
            load,
            push: self.size(&self.push),
            all: (!all).then_some(load + push),
            terms: self.size(&given),
            led: self.led_size(&given),
            noise: if is_noise { load } else { 0.0 },
            moved: self.moved_by_ground(),
        }
    }

    fn moved_by_ground(&self) -> f64 {
        let softest = |free: f64, j: usize| if self.grounded[j] { free } else { self.metric[j].max(free) };
        let stiffness = self.dofs().fold(0.0, softest).sqrt();
        let moved = self.dofs().filter(|j| self.grounded[*j]);
        let moved: Vec<f64> = moved.map(|j| stiffness * self.load(j) / self.metric[j]).collect();
        weighted_norm(&moved, |_| 1.0)
    }

    /// `a = R'D u / unit`, r, length, without grounded unknowns; a second fit of the remainder removes rounding of a long travel.
    fn amplitudes(&self) -> Vec<f64> {
        let (motions, unit) = &self.motions;
        let mut all = vec![0.0; motions.cols];
        if all.is_empty() {
            return all;
        }
        let by = self.told.unit / unit;
        let mut left = self.free(|j| self.u[j]);
        for _ in 0..2 {
            let weighed: Vec<f64> = left.iter().zip(&self.metric).map(|(left, d)| by * d * left).collect();
            let step = motions.mul_transposed(&weighed);
            motions.mul_add(-1.0, &step, &mut left);
            left = self.free(|j| left[j]);
            axpy(1.0, &step, &mut all);
        }
        all
    }

    fn dofs(&self) -> std::ops::Range<usize> {
        0..self.u.len()
    }

    /// `f_j`, force.
    fn load(&self, j: usize) -> f64 {
        self.body.load.map_or(0.0, |f| f[j])
    }

    /// `value` over the unknowns, 0 if they are grounded.
    fn free(&self, value: impl Fn(usize) -> f64) -> Vec<f64> {
        self.dofs().map(|j| if self.grounded[j] { 0.0 } else { value(j) }).collect()
    }

    /// `|v|_{D^-1}`, force.
    fn size(&self, v: &[f64]) -> f64 {
        weighted_norm(v, |j| 1.0 / self.metric[j])
    }

    /// `|v|_{D^-1}` in D^, force.
    fn led_size(&self, v: &[f64]) -> f64 {
        weighted_norm(v, |j| 1.0 / self.led[j])
    }
}

impl Told {
    /// Replaces the values where rows touch.
    fn set(&self, values: &[f64], v: &mut [f64]) {
        self.dofs.iter().zip(values).for_each(|(dof, value)| v[*dof] = *value);
    }
}

/// R of a body with its unit: those of the host, or of `R'D~R = U` if some of its unknowns are carried or may be by more rows than
/// have a force here: then it was scaled in another metric, and all of u would count as deformation.
fn motions<'a>(
    body: &BodyData<'a>,
    unit: f64,
    metric: &[f64],
    is_carried: bool,
) -> Result<(Cow<'a, Matrix>, f64)> {
    let given = body.null_space;
    if given.cols == 0 || !body.soft && !is_carried {
        return Ok((Cow::Borrowed(given), body.unit));
    }
    let root = |i: usize| metric[i].sqrt();
    let basis = Matrix::from_fn(given.rows, given.cols, |i, j| root(i) * given.get(i, j))?;
    let basis = basis.orthonormalised(NOISE);
    let motions = Matrix::from_fn(basis.rows, basis.cols, |i, j| basis.get(i, j) / root(i))?;
    Ok((Cow::Owned(motions), unit))
}

/// Grounded unknowns that are not carried, and that no motion moves.
fn grounded(body: &BodyData, told: &Told) -> Result<Vec<bool>> {
    let mut grounded = filled(body.stiffness.order(), false, WHAT)?;
    if body.grounded.is_empty() {
        return Ok(grounded);
    }
    let moving = moving(body)?;
    let is_carried = |j: u32| told.dofs.binary_search(&(j as usize)).is_ok_and(|at| told.carried[at]);
    let held = body.grounded.iter().filter(|j| !is_carried(**j) && !moving.contains(j));
    held.for_each(|j| grounded[*j as usize] = true);
    Ok(grounded)
}

/// Grounded unknowns j of a body that its null space moves nevertheless, `|K_jj R_j| > 1/4 sum_k |K_jk||R_k|`: they are
/// held only by a stiff neighbour, which may itself move. The motion of what rows may carry is no such motion: K resists it, and
/// it bends what a support holds.
fn moving(body: &BodyData) -> Result<HashSet<u32>> {
    let (n, motions) = (body.null_space.rows, body.null_space);
    let (mut image, mut terms, mut moving) = (vec![0.0; n], vec![0.0; n], HashSet::new());
    for k in 0..motions.cols {
        let motion = motions.col(k);
        body.stiffness.mul_with_terms(motion, &mut image, &mut terms)?;
        let work: f64 = motion.iter().zip(&image).map(|(r, f)| r * f).sum();
        let of_terms: f64 = motion.iter().zip(&terms).map(|(r, f)| r.abs() * f).sum();
        if work > NOISE * of_terms {
            continue;
        }
        let moves = |j: usize| 4.0 * (body.stiffness.metric(j, 0.0) * motion[j]).abs() > terms[j];
        moving.extend(body.grounded.iter().filter(|j| moves(**j as usize)));
    }
    Ok(moving)
}
