//! Motions of a body: the rigid part of u, slides, free motions, and motions along which the energy may fall.

use crate::body::{wire_struct, wire_unit, Local, Modes, Name, NullSpaceInput, Question};
use crate::error::Result;
use crate::linalg::twofold::Twofold;
use crate::linalg::vector::{norm_max, weighted_norm};
use crate::linalg::Matrix;
use crate::numbers::solve::FAR;
use crate::platform::memory::{copied, filled, zeros};
use crate::solve::local::displaced::turn;

const WHAT: &str = "a motion";

wire_unit!(Rigid, Basis, Split, Energy, Negate);
wire_struct!(Parted { at_rows, slides });
wire_struct!(Along { a });
wire_struct!(Moved { v, size, loose });
wire_struct!(FreeMotions { rounding });
wire_struct!(FreeMotionsAtRows { at_rows, fastest, gram });
wire_struct!(Place { a });
wire_struct!(EnergyOfMotion { stored, terms, entries, length, fastest });

/// Asks for `R'D u` over the modes of the dual.
pub struct Rigid;

impl Question for Rigid {
    const NAME: Name = Name::Rigid;
    type Answer = Vec<f64>;
    type Kept = ();
    type Given = (Vec<f64>,);

    fn answer(self, body: &Local, _: &mut (), u: &Vec<f64>) -> Result<Vec<f64>> {
        amplitudes(body, u)
    }
}

/// Asks for T with `R_host = R T`, r x r: `R'D R_host`, as `R'DR = I`, over the modes of the dual; without a null space of the host
/// `R_host` is R.
pub struct Basis;

impl Question for Basis {
    const NAME: Name = Name::Basis;
    type Answer = Matrix;
    type Kept = ();
    type Given = ();

    fn answer(self, body: &Local, _: &mut (), (): ()) -> Result<Matrix> {
        let (modes, size) = (body.null_space.cols, body.dual()?.size);
        let mut t = Matrix::zeros(modes, modes)?;
        (0..modes).for_each(|j| t.set(j, j, size));
        if let Some(NullSpaceInput { vectors, .. }) = body.said.filter(|said| said.modes == Modes::Exact) {
            for j in 0..vectors.cols.min(modes) {
                t.col_mut(j).copy_from_slice(&amplitudes(body, vectors.col(j))?);
            }
        }
        Ok(t)
    }
}

/// Splits u into its rigid motion and its deformation.
pub struct Split;

/// The parts of u.
pub struct Parted {
    /// Deformation where rows touch.
    pub at_rows: Vec<f64>,
    /// Amplitudes of the rigid motion over the modes of the dual, if it is far larger; soft bodies are held by K: they do not slide.
    pub slides: Option<Vec<f64>>,
}

impl Question for Split {
    const NAME: Name = Name::Split;
    type Answer = Parted;
    type Kept = ();
    type Given = (Vec<f64>,);

    fn answer(self, body: &Local, _: &mut (), u: &Vec<f64>) -> Result<Parted> {
        let mut rest = copied(u, WHAT)?;
        let mut amplitudes = vec![0.0; body.null_space.cols];
        for _ in 0..2 {
            let part = rigid_part(body, &rest)?;
            body.null_space.mul_add(-1.0, &part, &mut rest);
            amplitudes.iter_mut().zip(part).for_each(|(a, part)| *a += part);
        }
        let mut v = zeros(rest.len(), WHAT)?;
        body.null_space.mul_add(1.0, &amplitudes, &mut v);
        let slides = !(body.soft || length(body, &v)? <= FAR * length(body, &rest)?);
        let size = body.dual()?.size;
        let slides = slides.then(|| amplitudes.into_iter().map(|a| a * size).collect());
        Ok(Parted { at_rows: body.at_rows(&rest), slides })
    }
}

/// Keeps a motion `v = R a` of the modes of the dual, and asks for it; nothing if there are no amplitudes.
pub struct Along {
    pub a: Option<Vec<f64>>,
}

/// A motion where rows touch.
pub struct Moved {
    pub v: Vec<f64>,
    /// `D^-1 |K||v|`, no unit.
    pub size: Vec<f64>,
    /// |v|_D over the unknowns without stiffness.
    pub loose: f64,
}

impl Question for Along {
    const NAME: Name = Name::Along;
    type Answer = Option<Moved>;
    type Kept = Vec<f64>;
    type Given = ();

    fn answer(self, body: &Local, v: &mut Vec<f64>, _: ()) -> Result<Option<Moved>> {
        let Some(a) = &self.a else { return Ok(None) };
        let dual = body.dual()?;
        *v = turn(body, a)?;
        let (_, terms) = body.products(v, WHAT)?;
        let stiff = |j: usize| body.stiffness.metric(j, 0.0) > 0.0;
        let loose = weighted_norm(v, |j| if stiff(j) { 0.0 } else { dual.metric[j] });
        let size =
            body.touched.iter().map(|dof| terms[*dof as usize] / (dual.metric[*dof as usize] * dual.island));
        Ok(Some(Moved { v: body.at_rows(v), size: size.collect(), loose }))
    }
}

/// Keeps R, exactly 0 on grounded unknowns where it is rounding: below this part of the fastest unknown of each vector. Unknowns that
/// hang softly on stiff ones move with them.
pub struct FreeMotions {
    pub rounding: f64,
}

/// R where rows touch, t x r; the largest entry of each of its columns; `R'D R`, r x r.
pub struct FreeMotionsAtRows {
    pub at_rows: Matrix,
    pub fastest: Vec<f64>,
    pub gram: Matrix,
}

impl Question for FreeMotions {
    const NAME: Name = Name::FreeMotions;
    type Answer = FreeMotionsAtRows;
    type Kept = Matrix;
    type Given = ();

    fn answer(self, body: &Local, motions: &mut Matrix, _: ()) -> Result<FreeMotionsAtRows> {
        *motions =
            Matrix::from_fn(body.null_space.rows, body.null_space.cols, |i, j| body.null_space.get(i, j))?;
        for j in 0..motions.cols {
            let rounding = self.rounding * norm_max(body.null_space.col(j));
            for i in body.grounded.iter().map(|i| *i as usize) {
                if motions.get(i, j).abs() <= rounding {
                    motions.set(i, j, 0.0);
                }
            }
        }
        let mut gram = Matrix::zeros(motions.cols, motions.cols)?;
        for j in 0..motions.cols {
            gram.col_mut(j).copy_from_slice(&weighed(body, motions, motions.col(j))?);
        }
        let at = body.touched;
        Ok(FreeMotionsAtRows {
            at_rows: Matrix::from_fn(at.len(), motions.cols, |i, j| motions.get(at[i] as usize, j))?,
            fastest: (0..motions.cols).map(|j| norm_max(motions.col(j))).collect(),
            gram,
        })
    }
}

/// Keeps `u = v + R a`; asks for it where rows touch, and for `R'D u`.
pub struct Place {
    pub a: Vec<f64>,
}

impl Question for Place {
    const NAME: Name = Name::Place;
    type Answer = (Vec<f64>, Vec<f64>);
    type Kept = Vec<f64>;
    type Given = (Matrix, Vec<f64>);

    fn answer(
        self,
        body: &Local,
        u: &mut Vec<f64>,
        (motions, deformed): (&Matrix, &Vec<f64>),
    ) -> Result<Self::Answer> {
        *u = copied(deformed, WHAT)?;
        motions.mul_add(1.0, &self.a, u);
        Ok((body.at_rows(u), weighed(body, motions, u)?))
    }
}

/// Asks for the energy of a motion.
pub struct Energy;

pub struct EnergyOfMotion {
    /// `v'K v` in units of 2^p, the sum of the sizes of its terms, and the same of the terms of its entries.
    pub stored: Twofold,
    pub terms: f64,
    pub entries: f64,
    /// `|v|_D`
    pub length: f64,
    /// The largest entry of v.
    pub fastest: f64,
}

impl Question for Energy {
    const NAME: Name = Name::Energy;
    type Answer = EnergyOfMotion;
    type Kept = ();
    type Given = (Vec<f64>,);

    fn answer(self, body: &Local, _: &mut (), v: &Vec<f64>) -> Result<EnergyOfMotion> {
        let unit = body.dual()?.island;
        let (_, of_entries) = body.products(v, WHAT)?;
        let entries = v.iter().zip(of_entries).map(|(v, terms)| v.abs() * terms / unit).sum();
        let mut image = filled(v.len(), Twofold::default(), WHAT)?;
        body.stiffness.add_twofold(1.0 / unit, v, &mut image)?;
        let (mut stored, mut terms) = (Twofold::default(), 0.0);
        for (v, image) in v.iter().zip(image) {
            stored.add_product(*v, image.value());
            terms += (v * image.value()).abs();
        }
        Ok(EnergyOfMotion { stored, terms, entries, length: length(body, v)?, fastest: norm_max(v) })
    }
}

/// Reverses a motion.
pub struct Negate;

impl Question for Negate {
    const NAME: Name = Name::Negate;
    type Answer = ();
    type Kept = Vec<f64>;
    type Given = ();

    fn answer(self, _: &Local, v: &mut Vec<f64>, _: ()) -> Result<()> {
        v.iter_mut().for_each(|v| *v = -*v);
        Ok(())
    }
}

/// `|u|_D`
pub(super) fn length(body: &Local, u: &[f64]) -> Result<f64> {
    let metric = body.dual()?.metric;
    Ok(weighted_norm(u, |j| metric[j]))
}

/// `R'D u` over the modes of the dual.
pub(super) fn amplitudes(body: &Local, u: &[f64]) -> Result<Vec<f64>> {
    let size = body.dual()?.size;
    Ok(rigid_part(body, u)?.into_iter().map(|a| a * size).collect())
}

/// `R'D u`
fn rigid_part(body: &Local, u: &[f64]) -> Result<Vec<f64>> {
    let dual = body.dual()?;
    let by = dual.island / body.unit;
    let weighted: Vec<f64> = u.iter().zip(dual.metric).map(|(u, d)| by * d * u).collect();
    Ok(body.null_space.mul_transposed(&weighted))
}

/// `R'D u` of these motions, in units of 2^p.
fn weighed(body: &Local, motions: &Matrix, u: &[f64]) -> Result<Vec<f64>> {
    if motions.cols == 0 {
        return Ok(Vec::new());
    }
    let weighted: Vec<f64> = body.dual()?.metric.iter().zip(u).map(|(d, v)| d * v).collect();
    Ok(motions.mul_transposed(&weighted))
}
