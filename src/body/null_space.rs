//! The null space `R_p` of a stiffness matrix, verified.
//! All tests use `A = D^-1/2 K D^-1/2`, D = diag K: they have no unit, and supports given as 1e30 on the
//! diagonal count as supports. K is scaled to a largest diagonal entry in [1, 2); a dof without any
//! stiffness has `D_ii = 1`.

use crate::body::misfit::Misfit;
use crate::error::{Error, Kind, Result};
use crate::linalg::vector::NOISE;
use crate::linalg::vector::{norm_max, ratio, weighted_norm};
use crate::linalg::{Matrix, Multiple, Symmetric};
use crate::numbers::body::{LARGEST, PEAK};
use crate::numbers::linalg::DEPENDENT;
use crate::platform::memory::zeros;
use crate::ranks::{wire_enum, wire_struct};

/// The meaning of the vectors given by the host, or of the rigid motions of its coordinates.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Modes {
    /// They span the null space.
    Exact,
    /// The null space lies in their span.
    #[default]
    Candidates,
    /// Motions of small stiffness, which need not be exact; they determine the dofs held.
    Soft,
}

/// n x r, any scaling of the columns.
#[derive(Debug, Clone)]
pub struct NullSpaceInput {
    pub vectors: Matrix,
    pub modes: Modes,
}

wire_enum!(Modes { Exact, Candidates, Soft });
wire_struct!(NullSpaceInput { vectors, modes });

impl NullSpaceInput {
    /// The vectors on one component of K, whose matrix is `k`: K has no entry between components, so that null vectors of
    /// K are null vectors of each. A vector is none on a component if it is rounding of its largest entry there.
    pub fn on(&self, dofs: &[u32], k: &Symmetric) -> Result<Self> {
        let mut vectors = Matrix::zeros(dofs.len(), 0)?;
        for j in 0..self.vectors.cols {
            let all = self.vectors.col(j);
            let mut own = zeros(dofs.len(), "a null space")?;
            own.iter_mut().zip(dofs).for_each(|(v, &dof)| *v = all[dof as usize]);
            if norm_max(&own) > DEPENDENT * norm_max(all) {
                vectors.push_col(&own);
            }
        }
        let root = |i: usize| k.metric(i, 1.0).sqrt();
        let scaled = Matrix::from_fn(dofs.len(), vectors.cols, |i, j| root(i) * vectors.get(i, j))?;
        let basis = scaled.orthonormalised(DEPENDENT);
        if basis.cols < vectors.cols {
            vectors = Matrix::from_fn(dofs.len(), basis.cols, |i, j| basis.get(i, j) / root(i))?;
        }
        Ok(Self { vectors, modes: self.modes })
    }
}

/// What the tests of a null space need of K.
pub trait Products {
    /// The terms to which products with R are relative, in words.
    const TERMS: &'static str;
    /// `D_ii`, or `without` for a dof without stiffness.
    fn metric(&self, i: usize, without: f64) -> f64;
    /// `K X`, and the terms to which its rounding errors are relative.
    fn mul_columns(&self, x: &Matrix) -> Result<(Matrix, Matrix)>;
}

impl Products for Multiple {
    const TERMS: &'static str = "|K||R|";

    fn metric(&self, i: usize, without: f64) -> f64 {
        self.metric(i, without)
    }

    fn mul_columns(&self, x: &Matrix) -> Result<(Matrix, Matrix)> {
        self.mul_columns(x)
    }
}

/// A null space and its accuracy, relative to the fastest dof.
pub struct Verified {
    /// `R'DR = I`
    pub basis: Matrix,
    pub error: f64,
    /// Candidates that K resists.
    pub misfit: Option<Misfit>,
}

/// Checks `|A z| <= tolerance | |A| |z| |`, or rounding, for an orthonormal basis z of the span of `D^1/2 R`.
pub fn exact<K: Products>(k: &K, vectors: &Matrix, tolerance: f64) -> Result<Verified> {
    let basis = orthonormal(|i| k.metric(i, 1.0), vectors)?;
    let (image, terms) = k.mul_columns(&basis)?;
    let mut error = NOISE;
    let weight = |i: usize| 1.0 / k.metric(i, 1.0);
    for j in 0..basis.cols {
        let left = weighted_norm(image.col(j), weight);
        let found = ratio(left, weighted_norm(terms.col(j), weight));
        if found.is_nan() || found > tolerance && left > NOISE {
            let what = format!("not a null space: |K R| = {found:.1e} {} exceeds {tolerance:.1e}", K::TERMS);
            let dof = largest(image.col(j), weight);
            return Err(Error::new(Kind::NullSpace, what).dof(dof).value(found).limit(tolerance));
        }
        // the resistance of A to z measures the error; at single dofs the error is larger than the mean
        error = error.max(PEAK * found.min(left));
    }
    Ok(Verified { basis, error, misfit: None })
}

/// A basis of the span with `R'DR = I`, for this metric D.
pub fn orthonormal(metric: impl Fn(usize) -> f64, vectors: &Matrix) -> Result<Matrix> {
    let root = |i: usize| metric(i).sqrt();
    let scaled = Matrix::from_fn(vectors.rows, vectors.cols, |i, j| root(i) * vectors.get(i, j))?;
    let mut basis = scaled.orthonormalised(DEPENDENT);
    if basis.cols < vectors.cols {
        let what = format!("the {} vectors span only {} dimensions", vectors.cols, basis.cols);
        let error = Error::new(Kind::NullSpace, what);
        return Err(error.value(basis.cols as f64).limit(vectors.cols as f64));
    }
    for j in 0..basis.cols {
        basis.col_mut(j).iter_mut().enumerate().for_each(|(i, v)| *v /= root(i));
    }
    Ok(basis)
}

/// Position of the largest `w_i x_i^2`.
pub fn largest(x: &[f64], weight: impl Fn(usize) -> f64) -> usize {
    (0..x.len()).fold(0, |best, i| {
        let size = |i: usize| weight(i) * x[i] * x[i];
        if size(i) > size(best) {
            i
        } else {
            best
        }
    })
}

/// Refuses the matrix at the unknown of the first value that is NaN or whose square overflows; `dof` gives the unknown of
/// a position.
pub(super) fn refuse_overflow(values: &[f64], dof: impl Fn(usize) -> usize) -> Result<()> {
    let fits = |value: &f64| value.abs() <= LARGEST;
    match values.iter().position(|value| !fits(value)) {
        Some(at) => Err(overflow().dof(dof(at)).value(values[at]).limit(LARGEST)),
        None => Ok(()),
    }
}

pub(super) fn overflow() -> Error {
    let what =
        "the stiffness matrix is indefinite, or its entries are too far apart: products of them overflow";
    Error::new(Kind::Indefinite, what)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::body::{GeneralizedInverse, Plan};

    /// Chain of `n` unit springs, free at both ends, `support` added at dof 0.
    fn chain(n: usize, support: f64) -> Multiple {
        let (mut ptr, mut col, mut val) = (vec![0], Vec::new(), Vec::new());
        for i in 0..n {
            if i > 0 {
                col.push(i as u32 - 1);
                val.push(-1.0);
            }
            col.push(i as u32);
            let ends = f64::from(u8::from(i == 0) + u8::from(i + 1 == n));
            val.push(2.0 - ends + if i == 0 { support } else { 0.0 });
            ptr.push(col.len());
        }
        Symmetric::new(ptr, col, val).into()
    }

    fn verified(k: &Multiple, input: &NullSpaceInput, tolerance: f64) -> Result<Matrix> {
        crate::body::candidates::verified(k, input, tolerance).map(|found| found.basis)
    }

    fn translation(n: usize, modes: Modes) -> NullSpaceInput {
        NullSpaceInput { vectors: Matrix { rows: n, cols: 1, data: vec![3.0; n] }, modes }
    }

    #[test]
    fn a_true_null_space_is_accepted_and_normalised_in_the_metric_of_the_diagonal() {
        let k = chain(50, 0.0);
        let r = verified(&k, &translation(50, Modes::Exact), 1e-8).unwrap();
        let length: f64 = (0..50).map(|i| k.metric(i, 1.0) * r.get(i, 0) * r.get(i, 0)).sum();
        assert!((length - 1.0).abs() < 1e-14);
    }

    /// Orthonormalisation leaves of the second vector only the entry on the dof without stiffness, up to rounding.
    #[test]
    fn a_dof_without_stiffness_may_take_part_in_several_vectors() {
        let val = [12.0, 0.0, 4.0, 0.0, 12.0, -8.0, 6.0].map(|v| v / 64.0);
        let k = Symmetric::new(vec![0, 1, 2, 5, 7], vec![0, 1, 0, 1, 2, 2, 3], val.to_vec());
        let (a, b) = (0.19611613513818406, 0.7844645405527366);
        let data = vec![-2.0 * a, 1.0, 1.1766968108291044, 2.0 * b, -a, 0.0, 0.5883484054145522, b];
        let input = NullSpaceInput { vectors: Matrix { rows: 4, cols: 2, data }, modes: Modes::Exact };
        assert_eq!(verified(&k.into(), &input, 1e-8).unwrap().cols, 2);
    }

    #[test]
    fn a_support_of_any_stiffness_makes_an_exact_null_space_false() {
        for support in [1e-3, 1.0, 1e30] {
            let error = verified(&chain(50, support), &translation(50, Modes::Exact), 1e-8).unwrap_err();
            assert_eq!(error.kind, Kind::NullSpace, "support {support:e}");
        }
    }

    #[test]
    fn a_supported_candidate_is_dropped_and_a_free_one_kept() {
        for support in [1e-3, 1.0, 1e30] {
            let r = verified(&chain(50, support), &translation(50, Modes::Candidates), 1e-8).unwrap();
            assert_eq!(r.cols, 0, "support {support:e}");
        }
        assert_eq!(verified(&chain(50, 0.0), &translation(50, Modes::Candidates), 1e-8).unwrap().cols, 1);
    }

    #[test]
    fn dependent_vectors_are_refused() {
        let vectors = Matrix { rows: 5, cols: 2, data: [vec![1.0; 5], vec![2.0; 5]].concat() };
        let error =
            verified(&chain(5, 0.0), &NullSpaceInput { vectors, modes: Modes::Exact }, 1e-8).unwrap_err();
        assert_eq!((error.kind, error.place.value), (Kind::NullSpace, Some(1.0)));
    }

    fn vectors(data: &[f64], modes: Modes) -> NullSpaceInput {
        NullSpaceInput { vectors: Matrix { rows: 2, cols: data.len() / 2, data: data.to_vec() }, modes }
    }

    fn refused(plan: Result<Plan>) -> Error {
        plan.and_then(Plan::execute).err().unwrap()
    }

    /// K = [a b; b d] with finite entries whose products overflow.
    #[test]
    fn finite_entries_whose_products_overflow_are_refused_however_the_null_space_is_given() {
        for [a, b, d] in [[1.0, 1e300, 1.0], [1.0, -1e200, 1e-3], [1.0, 1.5e308, 1e-300]] {
            let k = || Multiple::from(Symmetric::new(vec![0, 1, 3], vec![0, 0, 1], vec![a, b, d]));
            for error in [
                refused(GeneralizedInverse::plan(k(), &vectors(&[], Modes::Exact), 1e-8)),
                refused(GeneralizedInverse::plan(k(), &vectors(&[1.0, 1.0], Modes::Candidates), 1e-8)),
                refused(GeneralizedInverse::search(k(), 1e-8, None)),
            ] {
                assert_eq!(error.kind, Kind::Indefinite, "{a:e} {b:e} {d:e}: {error}");
            }
        }
    }

    /// K = diag(1, 1e-310): its factor is correct, but 1e-310 has no finite reciprocal to measure forces with.
    #[test]
    fn a_diagonal_entry_without_a_reciprocal_is_refused_by_the_probe() {
        let k = Multiple::from(Symmetric::new(vec![0, 1, 2], vec![0, 1], vec![1.0, 1e-310]));
        let error = refused(GeneralizedInverse::plan(k, &vectors(&[], Modes::Exact), 1e-8));
        assert_eq!(error.kind, Kind::Indefinite, "{error}");
    }
}
