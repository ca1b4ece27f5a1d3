//! One body of an island under the forces of its rows. All that the certificate takes from its K, null space, load and displacement are
//! sizes, amplitudes, and values where rows touch it: `Fitted`, then, once the island has decided which motions are free, `Measured`.

mod measured;

pub use measured::{Measure, Measured};

use std::collections::HashSet;

use crate::body::{wire_struct, wire_unit, HostLoad, Local, Name, Question};
use crate::certificate::{acting, Load, LoadOfWhole, NOISE};
use crate::error::Result;
use crate::linalg::vector::{axpy, norm_max, weighted_norm};
use crate::linalg::Matrix;
use crate::platform::memory::{copied, filled, zeros};

const WHAT: &str = "the certificate";

wire_unit!(Largest, LoadOf, SizeOfLoad);
wire_struct!(Told { unit, without, metric, led, carried, push, push_terms, passed_on });
wire_struct!(Fit { told });
wire_struct!(Fitted { amplitudes, motions, unit, grounded, load, sizes });
wire_struct!(Sizes { load, push, all, terms, led, noise, moved });
wire_struct!(Lend { whole });

/// What rows do to a body, at the t unknowns that they touch.
#[derive(Clone, Default)]
pub struct Told {
    /// U, the power of two below max D of the island, force / length.
    pub unit: f64,
    /// The metric of unknowns without stiffness, force / length.
    pub without: f64,
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

/// What follows from it, kept with the body.
#[derive(Clone, Default)]
pub struct Felt {
    told: Told,
    /// D~ / U, n_p, no unit.
    metric: Vec<f64>,
    /// D^ / U, n_p, no unit: in it forces that cancel move an unknown by their rounding.
    led: Vec<f64>,
    /// R in the metric of the island, with `R'D~R = U`; none: that of the body.
    motions: Option<Matrix>,
    /// Grounded unknowns.
    grounded: Vec<bool>,
    /// r = B'lambda + H'mu + T'lambda_t, n_p, force.
    push: Vec<f64>,
    /// `|B'||lambda| + |H'||mu| + |T'||lambda_t|`, n_p, force.
    push_terms: Vec<f64>,
    sizes: Sizes,
}

/// A body with u and its load.
struct Part<'a> {
    body: &'a Local<'a>,
    felt: &'a Felt,
    /// n_p, length.
    u: &'a [f64],
    load: &'a Load,
}

/// Asks what the island has to know before it decides which motions are free.
pub struct Fit {
    pub told: Told,
}

/// What a body tells first.
pub struct Fitted {
    /// `a = R'D u / unit`, r, length, without grounded unknowns.
    pub amplitudes: Vec<f64>,
    /// R where rows touch, t x r, and its unit, force / length.
    pub motions: Matrix,
    pub unit: f64,
    /// Grounded unknowns where rows touch.
    pub grounded: Vec<bool>,
    /// f where rows touch, force.
    pub load: Vec<f64>,
    pub sizes: Sizes,
}

/// Sizes of the forces on a body.
#[derive(Clone, Copy, Default)]
pub struct Sizes {
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

impl Question for Fit {
    const NAME: Name = Name::Fit;
    type Answer = Fitted;
    type Kept = Felt;
    type Given = (Vec<f64>, Load);

    fn answer(self, body: &Local, felt: &mut Felt, (u, load): (&Vec<f64>, &Load)) -> Result<Fitted> {
        *felt = Felt::of(body, self.told)?;
        let part = Part { body, felt, u, load };
        let (sizes, amplitudes) = (part.sizes(), part.amplitudes());
        let ((motions, unit), at) = (part.motions(), body.touched);
        let fitted = Fitted {
            amplitudes,
            motions: Matrix::from_fn(at.len(), motions.cols, |j, k| motions.get(at[j] as usize, k))?,
            unit,
            grounded: body.at_rows(&felt.grounded),
            load: at.iter().map(|dof| load.at(*dof as usize)).collect(),
            sizes,
        };
        felt.sizes = sizes;
        Ok(fitted)
    }
}

/// Asks for the largest entries of u and of the load.
pub struct Largest;

impl Question for Largest {
    const NAME: Name = Name::Largest;
    type Answer = (f64, f64);
    type Kept = ();
    type Given = (Vec<f64>, Load);

    fn answer(self, _: &Local, _: &mut (), (u, load): (&Vec<f64>, &Load)) -> Result<(f64, f64)> {
        Ok((norm_max(u), norm_max(load.entries())))
    }
}

/// Asks for the load of a body, n_p.
pub struct LoadOf;

impl Question for LoadOf {
    const NAME: Name = Name::LoadOf;
    type Answer = Vec<f64>;
    type Kept = ();
    type Given = (Load,);

    fn answer(self, body: &Local, _: &mut (), load: &Load) -> Result<Vec<f64>> {
        load.everywhere(body.order())
    }
}

/// Asks for the size of a load, for the body of the host of which the body is a part.
pub struct SizeOfLoad;

impl Question for SizeOfLoad {
    const NAME: Name = Name::SizeOfLoad;
    type Answer = LoadOfWhole;
    type Kept = ();
    type Given = (HostLoad,);

    fn answer(self, body: &Local, _: &mut (), HostLoad(load): &HostLoad) -> Result<LoadOfWhole> {
        let dual = body.dual()?;
        let (mut own, mut largest) = (Vec::new(), 0.0);
        for (i, f) in acting(load.as_deref().unwrap_or_default(), body.grounded) {
            own.push(f / (dual.metric[i] * dual.island).sqrt());
            largest = f64::max(largest, f.abs());
        }
        Ok(LoadOfWhole { size: weighted_norm(&own, |_| 1.0), largest })
    }
}

/// Keeps the load of a body with that of the body of the host of which it is a part.
pub struct Lend {
    pub whole: LoadOfWhole,
}

impl Question for Lend {
    const NAME: Name = Name::Lend;
    type Answer = ();
    type Kept = Load;
    type Given = (HostLoad,);

    fn answer(self, _: &Local, load: &mut Load, HostLoad(own): &HostLoad) -> Result<()> {
        *load = Load { own: own.clone(), whole: self.whole };
        Ok(())
    }
}

impl Felt {
    fn of(body: &Local, told: Told) -> Result<Self> {
        let n = body.order();
        let mut metric = zeros(n, WHAT)?;
        metric
            .iter_mut()
            .enumerate()
            .for_each(|(j, d)| *d = body.stiffness.metric(j, told.without) / told.unit);
        body.set_at_rows(&told.metric, &mut metric);
        let mut led = copied(&metric, WHAT)?;
        body.set_at_rows(&told.led, &mut led);
        let (mut push, mut push_terms) = (zeros(n, WHAT)?, zeros(n, WHAT)?);
        body.set_at_rows(&told.push, &mut push);
        body.set_at_rows(&told.push_terms, &mut push_terms);
        let motions = motions(body, &metric, told.carried.contains(&true))?;
        let grounded = grounded(body, &told)?;
        Ok(Self { told, metric, led, motions, grounded, push, push_terms, sizes: Sizes::default() })
    }
}

impl Part<'_> {
    /// R, and the unit with `R'D~R = unit`, force / length.
    fn motions(&self) -> (&Matrix, f64) {
        match &self.felt.motions {
            Some(motions) => (motions, self.felt.told.unit),
            None => (self.body.null_space, self.felt.told.without),
        }
    }

    fn sizes(&self) -> Sizes {
        let felt = self.felt;
        let load = self.size(&self.free(|j| self.load(j)));
        let push = self.size(&self.free(|j| felt.push[j]));
        let all = felt.grounded.iter().all(|grounded| *grounded);
        let given = self.free(|j| self.load(j).abs() + felt.push_terms[j]);
        let is_noise = self.load.is_noise(load / felt.told.unit.sqrt(), self.body.grounded);
        Sizes {
            load,
            push: self.size(&felt.push),
            all: (!all).then_some(load + push),
            terms: self.size(&given),
            led: self.led_size(&given),
            noise: if is_noise { load } else { 0.0 },
            moved: self.moved_by_ground(),
        }
    }

    fn moved_by_ground(&self) -> f64 {
        let Felt { grounded, metric, .. } = self.felt;
        let softest = |free: f64, j: usize| if grounded[j] { free } else { metric[j].max(free) };
        let stiffness = self.dofs().fold(0.0, softest).sqrt();
        let moved = self.dofs().filter(|j| grounded[*j]);
        let moved: Vec<f64> = moved.map(|j| stiffness * self.load(j) / metric[j]).collect();
        weighted_norm(&moved, |_| 1.0)
    }

    /// `a = R'D u / unit`, r, length, without grounded unknowns; a second fit of the remainder removes rounding of a long travel.
    fn amplitudes(&self) -> Vec<f64> {
        let (motions, unit) = self.motions();
        let mut all = vec![0.0; motions.cols];
        if all.is_empty() {
            return all;
        }
        let by = self.felt.told.unit / unit;
        let mut left = self.free(|j| self.u[j]);
        for _ in 0..2 {
            let weighed: Vec<f64> =
                left.iter().zip(&self.felt.metric).map(|(left, d)| by * d * left).collect();
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
        self.load.at(j)
    }

    /// `value` over the unknowns, 0 if they are grounded.
    fn free(&self, value: impl Fn(usize) -> f64) -> Vec<f64> {
        self.dofs().map(|j| if self.felt.grounded[j] { 0.0 } else { value(j) }).collect()
    }

    /// `|v|_{D^-1}`, force.
    fn size(&self, v: &[f64]) -> f64 {
        weighted_norm(v, |j| 1.0 / self.felt.metric[j])
    }

    /// `|v|_{D^-1}` in D^, force.
    fn led_size(&self, v: &[f64]) -> f64 {
        weighted_norm(v, |j| 1.0 / self.felt.led[j])
    }
}

/// R with `R'D~R = U` if some unknowns of the body are carried or may be by more rows than have a force here: then its own was scaled in
/// another metric, and all of u would count as deformation.
fn motions(body: &Local, metric: &[f64], is_carried: bool) -> Result<Option<Matrix>> {
    let given = body.null_space;
    if given.cols == 0 || !body.soft && !is_carried {
        return Ok(None);
    }
    let root = |i: usize| metric[i].sqrt();
    let basis = Matrix::from_fn(given.rows, given.cols, |i, j| root(i) * given.get(i, j))?;
    let basis = basis.orthonormalised(NOISE);
    Matrix::from_fn(basis.rows, basis.cols, |i, j| basis.get(i, j) / root(i)).map(Some)
}

/// Grounded unknowns that are not carried, and that no motion moves.
fn grounded(body: &Local, told: &Told) -> Result<Vec<bool>> {
    let mut grounded = filled(body.order(), false, WHAT)?;
    if body.grounded.is_empty() {
        return Ok(grounded);
    }
    let moving = moving(body)?;
    let is_carried = |j: u32| body.touched.binary_search(&j).is_ok_and(|at| told.carried[at]);
    let held = body.grounded.iter().filter(|j| !is_carried(**j) && !moving.contains(j));
    held.for_each(|j| grounded[*j as usize] = true);
    Ok(grounded)
}

/// Grounded unknowns j of a body that its null space moves nevertheless, `|K_jj R_j| > 1/4 sum_k |K_jk||R_k|`: they are
/// held only by a stiff neighbour, which may itself move. The motion of what rows may carry is no such motion: K resists it, and
/// it bends what a support holds.
fn moving(body: &Local) -> Result<HashSet<u32>> {
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
