//! The null space selected from candidates, and null spaces that the host gives.

use crate::body::misfit::Misfit;
use crate::body::null_space::{
    exact, orthonormal, refuse_overflow, Modes, NullSpaceInput, Products, Verified,
};
use crate::error::Result;
use crate::linalg::dense::spectrum::right_singular;
use crate::linalg::vector::{axpy, dot, norm, norm_max, NOISE};
use crate::linalg::Matrix;
use crate::numbers::body::MAY_BE_FREE;
use crate::numbers::linalg::DEPENDENT;
use crate::numbers::rounding;
use crate::platform::memory::zeros;

/// Basis of the null space with `R'DR = I`.
pub fn verified<K: Products>(k: &K, input: &NullSpaceInput, tolerance: f64) -> Result<Verified> {
    match input.modes {
        Modes::Exact => exact(k, &input.vectors, tolerance),
        Modes::Candidates => {
            let found = Kernel::of(k, &input.vectors, MAY_BE_FREE)?;
            Ok(Verified { misfit: found.misfit(), ..exact(k, &found.motions, tolerance)? })
        }
        Modes::Soft => {
            let basis = orthonormal(|i| k.metric(i, 1.0), &input.vectors)?;
            Ok(Verified { basis, error: NOISE, misfit: None })
        }
    }
}

/// The null space within candidates.
pub struct Kernel {
    pub motions: Matrix,
    /// Dimension of the span of the candidates.
    pub candidates: usize,
    /// The least `|D^-1 K v|` of a unit vector v among the other candidates.
    pub next: f64,
}

impl Kernel {
    /// The candidates that are not in the null space.
    pub fn misfit(&self) -> Option<Misfit> {
        let fit = self.motions.cols;
        (fit < self.candidates).then_some(Misfit { fit, of: self.candidates, next: self.next })
    }

    /// The part of the span of the candidates with `|D^-1 K v| <= limit |v|`: from the singular values of `D^-1 K Q`, Q an
    /// orthonormal basis of the span. Motions beyond the limit belong to it if the rounding of the candidates explains
    /// every entry of K v: far from the origin, rotations are translations up to their last digits.
    pub fn of<K: Products>(k: &K, candidates: &Matrix, limit: f64) -> Result<Self> {
        let (span, order) = candidates.clone().orthonormalised_in_order(DEPENDENT);
        let mut found =
            Self { motions: Matrix::zeros(span.rows, 0)?, candidates: span.cols, next: f64::INFINITY };
        if span.cols == 0 || span.rows < span.cols {
            return Ok(found);
        }
        let sizes = terms_of(candidates, &span, &order)?;
        let coarse = (0..sizes.cols).any(|q| NOISE * norm(sizes.col(q)) > limit);
        let (image, _) = k.mul_columns(&span)?;
        let rounding = if coarse { k.mul_columns(&sizes)?.1 } else { Matrix::default() };
        let resisted = Matrix::from_fn(span.rows, span.cols, |i, j| image.get(i, j) / k.metric(i, 1.0))?;
        refuse_overflow(&resisted.data, |at| at % span.rows)?;
        let (values, vectors) = right_singular(&resisted)?;
        for (j, value) in values.iter().enumerate() {
            let x = vectors.col(j);
            let explained = |i: usize| {
                let sum = |of: &dyn Fn(usize) -> f64| (0..span.cols).map(of).sum::<f64>();
                let force = sum(&|q| x[q] * image.get(i, q));
                force.abs() <= NOISE * sum(&|q| x[q].abs() * rounding.get(i, q))
            };
            if *value > limit && !(coarse && (0..span.rows).all(explained)) {
                found.next = found.next.min(*value);
                continue;
            }
            let motion = combined(&span, x)?;
            if norm(&motion) > 0.0 {
                found.motions.push_col(&motion);
            }
        }
        Ok(found)
    }
}

/// The terms of an orthonormal basis Q of the span of V, whose rounding is eps times these; `order[q]` is the column of V
/// that column q comes from.
fn terms_of(v: &Matrix, basis: &Matrix, order: &[usize]) -> Result<Matrix> {
    let mut terms = Matrix::zeros(basis.rows, basis.cols)?;
    for (q, &j) in order.iter().enumerate() {
        let mut own: Vec<f64> = v.col(j).iter().map(|v| v.abs()).collect();
        for p in 0..q {
            axpy(dot(basis.col(p), v.col(j)).abs(), terms.col(p), &mut own);
        }
        let rest = dot(basis.col(q), v.col(j)).abs();
        terms.col_mut(q).iter_mut().zip(own).for_each(|(t, own)| *t = own / rest);
    }
    Ok(terms)
}

/// `Q x`, with zeros for entries that are rounding.
fn combined(span: &Matrix, x: &[f64]) -> Result<Vec<f64>> {
    let n = span.rows;
    let (mut motion, mut terms) = (zeros(n, "a null space")?, zeros(n, "a null space")?);
    span.mul_add(1.0, x, &mut motion);
    for (q, share) in x.iter().enumerate() {
        terms.iter_mut().zip(span.col(q)).for_each(|(t, v)| *t += share.abs() * v.abs());
    }
    // supports of 1e30 would multiply what is left of entries that cancel
    let floor = rounding::METHOD * norm_max(&motion);
    for (v, t) in motion.iter_mut().zip(&terms) {
        if v.abs() <= rounding::METHOD * t || v.abs() <= floor {
            *v = 0.0;
        }
    }
    Ok(motion)
}
