//! The null space selected from candidates, and null spaces that the host gives.

use crate::body::misfit::Misfit;
use crate::body::null_space::{
    orthonormal_by_parts, refuse_overflow, verified_by_parts, FreePart, Modes, NullSpaceInput, Products,
    Verified, DEPENDENT, ROUNDING,
};
use crate::error::Result;
use crate::linalg::dense::spectrum::right_singular;
use crate::linalg::vector::{axpy, dot, norm, norm_max};
use crate::linalg::Matrix;
use crate::platform::memory::{reserved, zeros};

/// A candidate motion belongs to the null space if `|D^-1 K v|` does not exceed this part of `|v|`.
pub(super) const CANDIDATE: f64 = 1e-11;
/// Entries that cancelled to this part of their terms are zero (supports of 1e30 would multiply them).
const CANCELLED: f64 = 1e-12;

/// Basis of the null space with `R'DR = I`; all dofs form one part.
pub fn verified<K: Products>(k: &K, input: &NullSpaceInput, tolerance: f64) -> Result<Verified> {
    let dofs: Vec<usize> = (0..input.vectors.rows).collect();
    let exact = |vectors: &Matrix| {
        verified_by_parts(k, vectors, &[FreePart { dofs: &dofs, count: vectors.cols, tolerance }])
    };
    match input.modes {
        Modes::Exact => exact(&input.vectors),
        Modes::Candidates => {
            let found = kernel_by_parts(k, &input.vectors, &[(&dofs, input.vectors.cols)], CANDIDATE)?;
            Ok(Verified { misfit: found.misfit(), ..exact(&found.kernel.columns(0..found.counts[0]))? })
        }
        Modes::Soft => {
            let part = FreePart { dofs: &dofs, count: input.vectors.cols, tolerance: 0.0 };
            let basis = orthonormal_by_parts(k, &input.vectors, &[part])?;
            Ok(Verified { basis, error: ROUNDING, misfit: None })
        }
    }
}

/// The null space within candidates.
pub struct KernelByParts {
    /// Motions j of all parts in column j.
    pub kernel: Matrix,
    /// Dimension of the null space of every part.
    pub counts: Vec<usize>,
    /// Dimension of the span of the candidates of all parts.
    pub candidates: usize,
    /// The least `|D^-1 K v|` of a unit vector v among the other candidates.
    pub next: f64,
}

impl KernelByParts {
    /// The candidates that are not in the null space.
    pub fn misfit(&self) -> Option<Misfit> {
        let fit = self.counts.iter().sum();
        (fit < self.candidates).then_some(Misfit { fit, of: self.candidates, next: self.next })
    }
}

/// The part of the span of the candidates with `|D^-1 K v| <= limit |v|`, part by part: from the singular values of `D^-1 K Q`,
/// Q an orthonormal basis of the span. Motions beyond the limit belong to it if the rounding of the candidates explains every
/// entry of K v: far from the origin, rotations are translations up to their last digits. `parts`: dofs and number of
/// candidates, which are in the first columns.
pub fn kernel_by_parts<K: Products>(
    k: &K,
    candidates: &Matrix,
    parts: &[(&[usize], usize)],
    limit: f64,
) -> Result<KernelByParts> {
    let mut spans = reserved(parts.len(), "a null space")?;
    let mut all = Matrix::zeros(candidates.rows, candidates.cols)?;
    let (mut terms, mut coarse) = (Matrix::zeros(candidates.rows, candidates.cols)?, false);
    for &(dofs, count) in parts {
        let own = Matrix::from_fn(dofs.len(), count, |at, j| candidates.get(dofs[at], j))?;
        let (span, order) = own.clone().orthonormalised_in_order(DEPENDENT);
        let sizes = terms_of(&own, &span, &order)?;
        coarse |= (0..sizes.cols).any(|q| ROUNDING * norm(sizes.col(q)) > limit);
        for (from, to) in [(&span, &mut all), (&sizes, &mut terms)] {
            (0..span.cols).for_each(|j| from.col(j).iter().zip(dofs).for_each(|(v, &i)| to.set(i, j, *v)));
        }
        spans.push(span);
    }
    let (image, _) = k.mul_columns(&all)?;
    let rounding = if coarse { k.mul_columns(&terms)?.1 } else { Matrix::default() };
    all.data.fill(0.0);
    let mut found = KernelByParts { kernel: all, counts: Vec::new(), candidates: 0, next: f64::INFINITY };
    for (&(dofs, _), span) in parts.iter().zip(&spans) {
        let of = |at: usize, j: usize| image.get(dofs[at], j) / k.metric(dofs[at], 1.0);
        let resisted = Matrix::from_fn(dofs.len(), span.cols, of)?;
        found.candidates += span.cols;
        found.counts.push(0);
        if span.cols == 0 || dofs.len() < span.cols {
            continue;
        }
        refuse_overflow(&resisted.data, |at| dofs[at % dofs.len()])?;
        let (values, vectors) = right_singular(&resisted)?;
        for (j, value) in values.iter().enumerate() {
            let x = vectors.col(j);
            let explained = |&i: &usize| {
                let sum = |of: &dyn Fn(usize) -> f64| (0..span.cols).map(of).sum::<f64>();
                let force = sum(&|q| x[q] * image.get(i, q));
                force.abs() <= ROUNDING * sum(&|q| x[q].abs() * rounding.get(i, q))
            };
            if *value > limit && !(coarse && dofs.iter().all(explained)) {
                found.next = found.next.min(*value);
                continue;
            }
            let motion = combined(span, x)?;
            let count = found.counts.last_mut().filter(|_| norm(&motion) > 0.0);
            count.into_iter().for_each(|count| {
                dofs.iter().zip(&motion).for_each(|(&i, v)| found.kernel.set(i, *count, *v));
                *count += 1;
            });
        }
    }
    Ok(found)
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
    let floor = CANCELLED * norm_max(&motion);
    for (v, t) in motion.iter_mut().zip(&terms) {
        if v.abs() <= CANCELLED * t || v.abs() <= floor {
            *v = 0.0;
        }
    }
    Ok(motion)
}
