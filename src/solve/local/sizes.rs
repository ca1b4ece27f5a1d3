//! Sizes of the loads and forces on a body, and of the part of its load that nothing holds.

use crate::body::{wire_struct, wire_unit, Local, Name, Question};
use crate::certificate::Load;
use crate::error::Result;
use crate::linalg::twofold::Twofold;
use crate::linalg::vector::{axpy, dot, fastest, weighted_norm};
use crate::platform::memory::{copied, zeros};
use crate::solve::local::displaced::resultants;

const WHAT: &str = "the sizes of loads";

wire_unit!(Take, Work);
wire_struct!(Sizes { push });
wire_struct!(SizesOfForces { load, push, of_load, of_push, free, resultants });
wire_struct!(Left { rest, resultants });
wire_struct!(SizesLeft { left, resultants, load, told });
wire_struct!(Proof { moves });
wire_struct!(ProofOfBody { at_rows, moved, work, strain, is_stiff });

/// Asks for the sizes of the load and of forces of rows, `push` where they touch, force.
pub struct Sizes {
    pub push: Vec<f64>,
}

pub struct SizesOfForces {
    /// `|.|_{D^-1}` of load and forces, in the units of the host.
    pub load: f64,
    pub push: f64,
    /// The references of their resultants, in the units of the dual.
    pub of_load: f64,
    pub of_push: f64,
    /// The same of the load without grounded unknowns.
    pub free: f64,
    /// `R'f`, in the scaling of the dual; 0 if it is rounding.
    pub resultants: Vec<f64>,
}

impl Question for Sizes {
    const NAME: Name = Name::Sizes;
    type Answer = SizesOfForces;
    type Kept = ();
    type Given = (Vec<f64>,);

    fn answer(self, body: &Local, _: &mut (), scaled: &Vec<f64>) -> Result<SizesOfForces> {
        let dual = body.dual()?;
        let mut load: Vec<f64> = scaled.iter().map(|f| f * dual.island).collect();
        let mut push = zeros(load.len(), WHAT)?;
        body.set_at_rows(&self.push, &mut push);
        let size = |f: &[f64]| weighted_norm(f, |j| 1.0 / dual.metric[j]);
        let reference = |f: &[f64]| weighted_norm(f, |j| 1.0 / (dual.metric[j] * dual.by)) / dual.size;
        let sizes = [size(&load), size(&push)];
        load.iter_mut().chain(&mut push).for_each(|f| *f /= dual.island);
        let references = [reference(&load), reference(&push)];
        let free = reference(&without_grounded(body, copied(scaled, WHAT)?));
        Ok(SizesOfForces {
            load: sizes[0],
            push: sizes[1],
            of_load: references[0],
            of_push: references[1],
            free,
            resultants: resultants(body, &load)?,
        })
    }
}

/// What nothing holds of a load, and the motion that it causes.
#[derive(Clone, Default)]
pub struct Unheld {
    /// D R c without grounded unknowns, in units of 2^p.
    pub load: Vec<f64>,
    /// R c
    pub motion: Vec<f64>,
}

/// Keeps the part of the load with the resultants `rest`.
pub struct Left {
    pub rest: Vec<f64>,
    pub resultants: Vec<f64>,
}

/// `|.|_{D^-1}` without grounded unknowns, in units of 2^p.
pub struct SizesLeft {
    pub left: f64,
    pub resultants: f64,
    pub load: f64,
    /// The load that counts: that of the host's body if this one is rounding of it.
    pub told: f64,
}

impl Question for Left {
    const NAME: Name = Name::Left;
    type Answer = SizesLeft;
    type Kept = Unheld;
    type Given = (Vec<f64>, Load);

    fn answer(
        self,
        body: &Local,
        unheld: &mut Unheld,
        (scaled, of_host): (&Vec<f64>, &Load),
    ) -> Result<SizesLeft> {
        let metric = body.dual()?.metric;
        let load = load_of(body, &self.rest)?;
        let motion = load.iter().zip(metric).map(|(f, d)| f / d).collect();
        let load = without_grounded(body, load);
        let resultants = without_grounded(body, load_of(body, &self.resultants)?);
        let all = without_grounded(body, copied(scaled, WHAT)?);
        let size = |f: &[f64]| weighted_norm(f, |j| 1.0 / metric[j]);
        let whole = size(&all);
        let root = body.dual()?.island.sqrt();
        let is_noise = of_host.is_noise(whole * root, body.grounded);
        let told = if is_noise { of_host.whole.size / root } else { whole };
        let sizes = SizesLeft { left: size(&load), resultants: size(&resultants), load: whole, told };
        *unheld = Unheld { load, motion };
        Ok(sizes)
    }
}

/// Takes from a load what nothing holds of it; asks for the rest where rows touch.
pub struct Take;

impl Question for Take {
    const NAME: Name = Name::Take;
    type Answer = Vec<f64>;
    type Kept = Vec<f64>;
    type Given = (Unheld,);

    fn answer(self, body: &Local, scaled: &mut Vec<f64>, unheld: &Unheld) -> Result<Vec<f64>> {
        axpy(-1.0, &unheld.load, scaled);
        Ok(body.at_rows(scaled))
    }
}

/// Keeps the motion, or 0 unless the body `moves`, for the proof that nothing holds the load.
pub struct Proof {
    pub moves: bool,
}

pub struct ProofOfBody {
    pub at_rows: Vec<f64>,
    /// The motion is not 0.
    pub moved: bool,
    /// f'v
    pub work: Twofold,
    /// `|K v|_{D^-1}`, force / length x length.
    pub strain: f64,
    /// K resists the unknown that moves fastest.
    pub is_stiff: bool,
}

impl Question for Proof {
    const NAME: Name = Name::Proof;
    type Answer = ProofOfBody;
    type Kept = Vec<f64>;
    type Given = (Vec<f64>, Unheld);

    fn answer(
        self,
        body: &Local,
        v: &mut Vec<f64>,
        (scaled, unheld): (&Vec<f64>, &Unheld),
    ) -> Result<ProofOfBody> {
        *v = if self.moves { copied(&unheld.motion, WHAT)? } else { zeros(body.order(), WHAT)? };
        let (mut work, mut strained) = (Twofold::default(), zeros(v.len(), WHAT)?);
        scaled.iter().zip(v.iter()).for_each(|(f, v)| work.add_product(*f, *v));
        body.stiffness.mul(v, &mut strained)?;
        let metric = body.dual()?.metric;
        let strain = weighted_norm(&strained, |j| 1.0 / metric[j]);
        let (moved, is_stiff) = (v.iter().any(|v| *v != 0.0), body.stiffness.metric(fastest(v), 0.0) > 0.0);
        Ok(ProofOfBody { at_rows: body.at_rows(v), moved, work, strain, is_stiff })
    }
}

/// Asks for a lower bound of `g'K+ g`, the work of the load without its resultants on the body alone: v = K+ g makes it large, and an
/// inexact K+ cannot make it too large.
pub struct Work;

impl Question for Work {
    const NAME: Name = Name::Work;
    type Answer = f64;
    type Kept = ();
    type Given = (Load,);

    fn answer(self, body: &Local, _: &mut (), of_host: &Load) -> Result<f64> {
        let dual = body.dual()?;
        let mut load = without_grounded(body, of_host.everywhere(body.order())?);
        let resultants = body.null_space.mul_transposed(&load);
        let mut rigid = zeros(load.len(), WHAT)?;
        body.null_space.mul_add(1.0 / body.unit, &resultants, &mut rigid);
        let rigid = rigid.iter().zip(dual.metric);
        load.iter_mut().zip(rigid).for_each(|(f, (rigid, d))| *f -= dual.island * d * rigid);
        let (mut v, mut strain) = (zeros(load.len(), WHAT)?, zeros(load.len(), WHAT)?);
        dual.kplus.apply(&load, &mut v)?;
        v.iter_mut().for_each(|v| *v *= dual.by);
        body.stiffness.mul(&v, &mut strain)?;
        let (done, stored) = (dot(&load, &v), dot(&v, &strain));
        Ok(if stored > 0.0 { done * (done / stored) } else { 0.0 })
    }
}

/// `D R c`, the load of least |f|_{D^-1} with these resultants.
fn load_of(body: &Local, resultants: &[f64]) -> Result<Vec<f64>> {
    let dual = body.dual()?;
    let mut load = zeros(body.order(), WHAT)?;
    body.null_space.mul_add(dual.size, resultants, &mut load);
    load.iter_mut().zip(dual.metric).for_each(|(f, d)| *f *= d * dual.by);
    Ok(load)
}

/// A vector that is 0 on grounded unknowns.
fn without_grounded(body: &Local, mut v: Vec<f64>) -> Vec<f64> {
    body.grounded.iter().for_each(|j| v[*j as usize] = 0.0);
    v
}
