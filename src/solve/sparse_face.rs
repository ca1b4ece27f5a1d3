//! Sparse Cholesky factors of an island with the rows of a face, for corrections and for an interior point method:
//!
//! ```text
//! (K + B_F' W B_F) du = r + B_F' W g,   dx = W (B_F du - g),   W = 1 / max(C, c)
//! ```
//!
//! for the residual loads r and gaps g. With W = 1/C this solves the face; a row that is stiffer than 1/c takes some corrections
//! more. The interior point method has weights of its own for all rows.

use std::sync::Arc;

use crate::body::{Distributed, Locals};
use crate::certificate::Data;
use crate::constraints::Touched;
use crate::error::Result;
use crate::linalg::by_body::Ranges;
use crate::linalg::cholesky::{Analysis, Cholesky};
use crate::linalg::sparse::gram::Gram;
use crate::linalg::vector::{axpy, weighted_norm, NOISE};
use crate::linalg::{ByBody, Csr, Symmetric};
use crate::numbers::solve::{LEAST_COMPLIANCE, STIFFER};
use crate::platform::memory::{copied, reserved, zeros};
use crate::platform::{interrupt, tally};
use crate::qp::{Interior, Inverse, Point, Stiffness};
use crate::setup::Ready;
use crate::solve::gaps::Gaps;
use crate::solve::scaled::Scaled;

/// Rows with more entries would fill the factor.
const WIDE: usize = 100;

const WHAT: &str = "the matrix of a face";

/// The pattern of all faces of an island.
pub struct SparseFaces<'a> {
    bodies: Locals<'a>,
    ranges: &'a Ranges,
    touched: &'a Touched,
    /// B, the rows of the dual, over all unknowns.
    rows: Csr,
    compliance: &'a [f64],
    /// D / 2^p
    metric: Vec<f64>,
    /// c
    least: Vec<f64>,
    gram: Gram,
    /// K in units of 2^p, with the pattern of K + B'B.
    k: Symmetric,
    analysis: Arc<Analysis>,
}

/// A point inside of the bounds.
pub struct Inside {
    /// Rows that it shows without a force.
    pub active: Vec<bool>,
    pub force: Vec<f64>,
    /// Length.
    pub motion: ByBody,
}

/// The factor of a face.
pub struct SparseFace<'a> {
    faces: &'a SparseFaces<'a>,
    rows: Vec<usize>,
    /// W
    weight: Vec<f64>,
    factor: Factor,
}

/// The factor of `S (K + B' W B) S` with S = diag(.)^-1/2.
struct Factor {
    factor: Cholesky,
    scale: Vec<f64>,
}

impl Inverse for Factor {
    fn solve(&self, load: &[f64]) -> Result<Vec<f64>> {
        let mut motion: Vec<f64> = load.iter().zip(&self.scale).map(|(v, s)| v * s).collect();
        self.factor.solve(&mut motion)?;
        motion.iter_mut().zip(&self.scale).for_each(|(v, s)| *v *= s);
        Ok(motion)
    }
}

impl Stiffness for &SparseFaces<'_> {
    fn subtract(&self, a: &[f64], left: &mut [f64]) -> Result<()> {
        let mut image = zeros(a.len(), WHAT)?;
        self.k.mul(a, &mut image);
        axpy(-1.0, &image, left);
        Ok(())
    }

    fn size(&self, loads: &[f64]) -> f64 {
        weighted_norm(loads, |j| 1.0 / self.metric[j])
    }

    fn with_rows(&mut self, weights: &[f64]) -> Result<Option<Box<dyn Inverse + '_>>> {
        Ok(self.factor(weights)?.map(|factor| Box::new(factor) as _))
    }
}

impl<'a> SparseFaces<'a> {
    /// None if some K is not given by its entries, or rows are wide.
    pub fn of(ready: &'a Ready, data: &Data<'a>) -> Result<Option<Self>> {
        let given = &ready.rows.matrix;
        let wide = |i: usize| given.ptr[i + 1] - given.ptr[i] > WIDE;
        if (0..given.rows()).any(wide) {
            return Ok(None);
        }
        let (touched, ranges, n) = (data.touched, &ready.island.ranges, ready.island.unknowns());
        let Some(bodies) = data.bodies.sections()? else { return Ok(None) };
        let mut rows = Csr::with_room(n, given.rows(), given.val.len());
        let unknown = |j: usize| ranges[touched.body_of(j)].start + touched.dof(j);
        (0..given.rows()).for_each(|i| rows.push_row(given.row(i).map(|(j, v)| (unknown(j), v))));
        let gram = Gram::of(&rows)?;
        let (pattern, unit) = (gram.pattern(), ready.island.unit);
        let mut metric = reserved(n, WHAT)?;
        let mut k = Symmetric::with_room(n, pattern.col.len(), WHAT)?;
        for ((own, of_body), range) in bodies.iter().zip(&**ranges) {
            metric.extend_from_slice(of_body);
            for i in 0..own.order() {
                let stiff = own.lower_row(i).map(|(j, v)| (range.start + j, v / unit));
                k.push_row(merged(stiff, pattern.lower_row(range.start + i).map(|(j, _)| (j, 0.0))));
            }
        }
        let least = (0..rows.rows()).map(|i| {
            let stiffest = rows.row(i).map(|(j, _)| metric[j]).fold(0.0, f64::max);
            rows.row(i).map(|(_, b)| b * b).fold(0.0, f64::max) / (STIFFER * stiffest)
        });
        let analysis = Arc::new(Analysis::new(&k, &vec![false; n])?);
        let (least, compliance) = (least.collect(), &ready.dual.compliance[..rows.rows()]);
        let bodies = data.bodies.clone();
        Ok(Some(Self { bodies, ranges, touched, rows, compliance, metric, least, gram, k, analysis }))
    }

    /// Multiplications of a factorisation.
    pub fn work(&self) -> f64 {
        self.analysis.work()
    }

    /// None if the matrix of this face is not positive semidefinite.
    pub fn on(&self, mut rows: Vec<usize>) -> Result<Option<SparseFace<'_>>> {
        let mut weight = zeros(self.rows.rows(), WHAT)?;
        // springs of bodies are a part of K
        rows.retain(|&i| i < weight.len());
        rows.iter().for_each(|&i| weight[i] = self.compliance[i].max(self.least[i]).recip());
        let factor = self.factor(&weight)?;
        Ok(factor.map(|factor| SparseFace { faces: self, rows, weight, factor }))
    }

    /// The point of an interior point method.
    pub fn inside(&self, scaled: &Scaled) -> Result<Option<Inside>> {
        let (Gaps { dual, value, bounded, far, .. }, e) =
            (&scaled.gaps, &self.bodies.bring(&scaled.load.of)?.concat());
        let m = self.rows.rows();
        let held: Vec<bool> = (0..m).map(|i| far[i] || value[i] == f64::INFINITY).collect();
        let gap: Vec<f64> = (0..m).map(|i| if held[i] { 0.0 } else { dual[i] }).collect();
        // rows have the compliance 1
        let first: Vec<f64> = self.compliance.iter().map(|c| c.max(1.0)).collect();
        let weight: Vec<f64> = (0..m).map(|i| if held[i] { 0.0 } else { 1.0 / first[i] }).collect();
        let Some(factor) = self.factor(&weight)? else { return Ok(None) };
        let pull: Vec<f64> = weight.iter().zip(&gap).map(|(w, c)| w * c).collect();
        let mut load = copied(e, WHAT)?;
        self.rows.mul_transposed_add(1.0, &pull, &mut load);
        let motion = factor.solve(&load)?;
        let mut stiffness = self;
        let mean = stiffness.size(e).powi(2) / m as f64;
        let least: Vec<f64> = self
            .compliance
            .iter()
            .zip(&self.least)
            .map(|(c, least)| c.max(LEAST_COMPLIANCE * least))
            .collect();
        let interior = Interior {
            rows: &self.rows,
            e,
            bounded,
            held: &held,
            gap: &gap,
            compliance: self.compliance,
            first: &first,
            least: &least,
            mean,
        };
        let Point { motion, mut force, slack, .. } = interior.solve(&mut stiffness, motion)?;
        let active = |i: usize| bounded[i] && (held[i] || force[i] * first[i] < slack[i]);
        let active = (0..bounded.len()).map(|i| i < m && active(i)).collect();
        force.resize(bounded.len(), 0.0);
        Ok(Some(Inside { active, force, motion: ByBody::of(self.ranges, motion) }))
    }

    /// Of `K + B'W B`; none if it is not positive semidefinite.
    fn factor(&self, weight: &[f64]) -> Result<Option<Factor>> {
        interrupt::check()?;
        tally::costly();
        let pressed = self.gram.weighted(&self.rows, |i| weight[i])?;
        let diagonal = (0..self.k.order()).map(|i| self.k.diagonal(i) + pressed.diagonal(i));
        let scale: Vec<f64> = diagonal.map(|d| if d > 0.0 { d.sqrt().recip() } else { 1.0 }).collect();
        let mut scaled = Symmetric::with_room(scale.len(), self.k.col.len(), WHAT)?;
        for i in 0..scale.len() {
            let row = merged(self.k.lower_row(i), pressed.lower_row(i));
            scaled.push_row(row.map(|(j, v)| (j, scale[i] * v * scale[j])));
        }
        let factor = self.analysis.pivoted(&scaled, 1.0, NOISE)?;
        Ok(factor.ok().map(|factor| Factor { factor, scale }))
    }
}

impl SparseFace<'_> {
    /// du, and dx over all rows, for residual loads and gaps in units of 2^p.
    pub fn solve(&self, load: &Distributed, gaps: &[f64]) -> Result<(ByBody, Vec<f64>)> {
        let (mut load, at_rows) =
            (ByBody::of(self.faces.ranges, self.faces.bodies.bring(&load.of)?.concat()), &load.at_rows);
        self.faces.touched.set(at_rows, &mut load);
        let mut load = load.into_sequence();
        let mut pull = zeros(gaps.len(), WHAT)?;
        self.rows.iter().for_each(|&i| pull[i] = self.weight[i] * gaps[i]);
        self.faces.rows.mul_transposed_add(1.0, &pull[..self.weight.len()], &mut load);
        let moved = self.factor.solve(&load)?;
        for &i in &self.rows {
            pull[i] = self.weight[i] * (self.faces.rows.row_dot(i, &moved) - gaps[i]);
        }
        Ok((ByBody::of(self.faces.ranges, moved), pull))
    }

    /// Motions that neither K nor the rows resist.
    pub fn undetermined(&self) -> usize {
        self.factor.factor.at_rest().len()
    }
}

/// The sum of two rows, each ascending.
fn merged(
    a: impl Iterator<Item = (usize, f64)>,
    b: impl Iterator<Item = (usize, f64)>,
) -> impl Iterator<Item = (usize, f64)> {
    let (mut a, mut b) = (a.peekable(), b.peekable());
    std::iter::from_fn(move || match (a.peek().copied(), b.peek().copied()) {
        (Some((i, v)), Some((j, w))) if i == j => {
            a.next();
            b.next();
            Some((i, v + w))
        }
        (Some((i, _)), Some((j, _))) if j < i => b.next(),
        (None, _) => b.next(),
        _ => a.next(),
    })
}
