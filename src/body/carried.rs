//! Rigid motions that K resists firmly but that nevertheless enter the coarse problem. A piece whose supports are eliminated has no null
//! space; without this treatment the iteration has to find its softest motions, which are nearly rigid, and takes two to three times the
//! products. With the rigid motions Z that are not null vectors, D-orthogonal to the null vectors R_0, and L = D Z,
//!
//! ```text
//! T = K+ L,  S = (L'T)^-1,  R_c = T S,   K_c+ = K+ - T S T',   L'K_c+ = 0,   R_c'K R_c = S
//! u = K_c+ (f - B'l) + R_0 a_0 + R_c a_c,   R_0'(f - B'l) = 0,   S a_c = R_c'(f - B'l)
//! ```
//!
//! exactly: S are springs like those of [`soft`](crate::body::soft) motions, with the functionals L in place of held unknowns.

use crate::body::probe::Factor;
use crate::body::spectrum::symmetric;
use crate::error::Result;
use crate::linalg::dense::spectrum::symmetric_eigen;
use crate::linalg::vector::{axpy, dot, norm};
use crate::linalg::{Csr, Matrix, Multiple, Packed};
use crate::numbers::body::{BESIDE_NULL, CARRIED};
use crate::numbers::linalg::ROOT;
use crate::platform::memory::zeros;

/// C with `C C' = T S T'`, n x q.
#[derive(Clone)]
pub struct Carried {
    c: Matrix,
}

/// The motions R_c, n x q, with `R'DR = I` and `R_c'K R_c = diag(stiffness)`, beside R_0.
pub struct Motions {
    pub carried: Carried,
    pub vectors: Matrix,
    pub stiffness: Vec<f64>,
}

/// Selected from the rigid motions, one per column; none if none is left, K has negative stiffness along one, or rounding
/// hides them.
pub(super) fn motions(
    factor: &Factor,
    k: &Multiple,
    null_space: &Matrix,
    rigid: &Matrix,
) -> Result<Option<Motions>> {
    let root = k.roots()?;
    let null = scaled(null_space, |i| root[i])?;
    let mut z = without(scaled(rigid, |i| root[i])?.orthonormalised(BESIDE_NULL), &null)?;
    for j in (0..z.cols).filter(|&j| norm(z.col(j)) <= BESIDE_NULL).collect::<Vec<_>>() {
        z.col_mut(j).fill(0.0);
    }
    let l = scaled(&z.orthonormalised(BESIDE_NULL), |i| root[i])?;
    let mut c = l.clone();
    for j in 0..c.cols {
        factor.solve(c.col_mut(j))?;
    }
    let (compliance, v) = symmetric_eigen(&symmetric(c.cols, |a, b| dot(l.col(a), c.col(b)))?)?;
    let most = compliance.iter().fold(0.0, |most: f64, value| most.max(*value));
    // ascending
    let first = compliance.iter().position(|value| *value >= CARRIED).unwrap_or(compliance.len());
    if compliance.iter().any(|value| value.is_nan() || *value <= ROOT * most) || first == c.cols {
        return Ok(None);
    }
    c.turn_rows(&v);
    let mut c = c.columns(first..c.cols);
    for (j, value) in compliance[first..].iter().enumerate() {
        c.col_mut(j).iter_mut().for_each(|c| *c /= value.sqrt());
    }
    // R_c = C Q, Q'C'D C Q = I and Q'Q = diag(stiffness), up to null vectors
    let y = without(scaled(&c, |i| root[i])?, &null)?;
    let (square, turn) = symmetric_eigen(&symmetric(y.cols, |a, b| dot(y.col(a), y.col(b)))?)?;
    if square.iter().any(|value| value.is_nan() || *value <= 0.0) {
        return Ok(None);
    }
    let mut vectors = scaled(&y, |i| 1.0 / root[i])?;
    vectors.turn_rows(&turn);
    for (j, value) in square.iter().enumerate() {
        vectors.col_mut(j).iter_mut().for_each(|v| *v /= value.sqrt());
    }
    let stiffness = square.iter().map(|value| 1.0 / value).collect();
    Ok(Some(Motions { carried: Carried { c }, vectors, stiffness }))
}

impl Carried {
    /// Number q of motions.
    pub fn count(&self) -> usize {
        self.c.cols
    }

    /// C~ for an approximation K~+ of K+, so that `K~+ - C~ C~'` is semidefinite like `K+ - C C'`: with `L = K C`, `L'C =
    /// 1`, `C~ C~' = T (L'T)^-1 T'`, `T = K~+ L`. None if K~+ is not close enough.
    pub fn near(&self, k: &Multiple, solve: impl Fn(&mut [f64]) -> Result<()>) -> Result<Option<Self>> {
        let mut l = Matrix::zeros(self.c.rows, self.c.cols)?;
        (0..l.cols).for_each(|j| k.mul(self.c.col(j), l.col_mut(j)));
        let mut t = l.clone();
        for j in 0..t.cols {
            solve(t.col_mut(j))?;
        }
        let (values, turn) = symmetric_eigen(&symmetric(t.cols, |a, b| dot(l.col(a), t.col(b)))?)?;
        if values.iter().any(|value| value.is_nan() || *value < 0.5) {
            return Ok(None);
        }
        t.turn_rows(&turn);
        for (j, value) in values.iter().enumerate() {
            t.col_mut(j).iter_mut().for_each(|t| *t /= value.sqrt());
        }
        Ok(Some(Self { c: t }))
    }

    /// `C C'b`
    pub fn motions_under(&self, load: &[f64]) -> Result<Vec<f64>> {
        let mut motions = zeros(load.len(), "a displacement")?;
        self.c.mul_add(1.0, &self.c.mul_transposed(load), &mut motions);
        Ok(motions)
    }

    /// `x <- K+ x - C C'x`, by solves with K+.
    pub fn apply_in_place(&self, x: &mut [f64], solve: impl FnOnce(&mut [f64]) -> Result<()>) -> Result<()> {
        let shares = self.c.mul_transposed(x);
        solve(x)?;
        self.c.mul_add(-1.0, &shares, x);
        Ok(())
    }

    /// `B C`, m x q.
    fn images(&self, rows: &Csr) -> Result<Matrix> {
        Matrix::from_fn(rows.rows(), self.c.cols, |i, j| rows.row_dot(i, self.c.col(j)))
    }

    /// Subtracts `B C C'B'` from `B K+ B'`.
    pub fn take_from_form(&self, rows: &Csr, form: &mut Packed) -> Result<()> {
        let images = self.images(rows)?;
        let m = images.rows;
        let mut gram = Matrix::zeros(m, m)?;
        for j in 0..m {
            let column = &mut gram.col_mut(j)[j..];
            (0..images.cols).for_each(|k| axpy(-images.get(j, k), &images.col(k)[j..], column));
        }
        form.add_lower(&(0..m).collect::<Vec<_>>(), &gram.data);
        Ok(())
    }
}

/// Multiplies row i by `by(i)`.
fn scaled(matrix: &Matrix, by: impl Fn(usize) -> f64) -> Result<Matrix> {
    Matrix::from_fn(matrix.rows, matrix.cols, |i, j| by(i) * matrix.get(i, j))
}

/// The part of y orthogonal to orthonormal columns.
fn without(mut y: Matrix, basis: &Matrix) -> Result<Matrix> {
    for _ in 0..2 {
        for j in 0..y.cols {
            let shares = basis.mul_transposed(y.col(j));
            basis.mul_add(-1.0, &shares, y.col_mut(j));
        }
    }
    Ok(y)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::body::{GeneralizedInverse, Modes, NullSpaceInput};
    use crate::linalg::random::Random;
    use crate::linalg::Symmetric;
    use crate::platform::slabs::Slabs;
    use std::sync::Arc;

    /// Two chains of n unit springs; a nonzero `ground` is a spring from the first dof to the ground.
    fn chains(n: usize, ground: [f64; 2]) -> Multiple {
        let mut k = Symmetric::empty();
        for (chain, ground) in ground.into_iter().enumerate() {
            for i in 0..n {
                let joints = f64::from(u8::from(i > 0)) + f64::from(u8::from(i + 1 < n));
                let own = joints + if i == 0 { ground } else { 0.0 };
                let before = (i > 0).then(|| (chain * n + i - 1, -1.0));
                k.push_row(before.into_iter().chain([(chain * n + i, own)]));
            }
        }
        k.into()
    }

    /// Translations of each chain.
    fn rigid(n: usize, which: &[usize]) -> Matrix {
        Matrix::from_fn(2 * n, which.len(), |i, j| f64::from(u8::from(i / n == which[j]))).unwrap()
    }

    fn made(k: &Multiple, null_space: Matrix) -> GeneralizedInverse {
        let input = NullSpaceInput { vectors: null_space, modes: Modes::Exact };
        GeneralizedInverse::plan(k.clone(), &input, 1e-8).unwrap().execute().unwrap().inverse
    }

    /// `L'(K~+ - C~ C~')L = 0` as for K+, whatever the compliance L'K+ L; otherwise the dual operator might not be
    /// semidefinite.
    #[test]
    fn a_rounded_k_plus_has_no_force_against_the_motions_that_are_carried() {
        let (n, k) = (20, chains(20, [0.002, 0.0]));
        let inverse = made(&k, rigid(n, &[1])).with_carried(&k, &rigid(n, &[0, 1])).unwrap();
        let exact = inverse.clone();
        let inverse = inverse.rounded(&k, &Slabs::of(0).unwrap()).unwrap();
        assert!(inverse.is_rounded());
        let l: Vec<f64> = (0..2 * n).map(|i| if i < n { k.metric(i, 1.0) } else { 0.0 }).collect();
        let (mut own, mut near, mut refined) = (l.clone(), l.clone(), l.clone());
        exact.factor.solve(&mut own).unwrap();
        inverse.approximate_in_place(&mut near).unwrap();
        inverse.apply_in_place(&mut refined).unwrap();
        let compliance = dot(&l, &own);
        assert!(dot(&l, &near).abs() < 1e-13 * compliance, "{:e} of {compliance:e}", dot(&l, &near));
        assert!(dot(&l, &refined).abs() < 1e-13 * compliance);
        let mut load: Vec<f64> = (0..2 * n).map(|i| (i as f64).cos()).collect();
        let mut expected = load.clone();
        inverse.apply_in_place(&mut load).unwrap();
        exact.apply_in_place(&mut expected).unwrap();
        axpy(-1.0, &expected, &mut load);
        assert!(norm(&load) < 1e-12 * norm(&expected), "{:e}", norm(&load) / norm(&expected));
    }

    /// `u = K_c+ f + R a` with `S a = R'f` solves K u = f; the first chain is held, the second floats.
    #[test]
    fn springs_and_what_is_left_of_k_plus_give_the_displacement_of_k() {
        let (n, k) = (20, chains(20, [0.5, 0.0]));
        let inverse = made(&k, rigid(n, &[1]));
        let inverse = inverse.with_carried(&k, &rigid(n, &[0, 1])).unwrap();
        assert_eq!((inverse.null_space.cols, inverse.stiffness.len()), (2, 2));
        assert!(inverse.stiffness[0] == 0.0 && inverse.stiffness[1] > 0.0 && !inverse.is_soft());
        assert_eq!(inverse.free_motions().unwrap().cols, 1);
        // a load in equilibrium on the second chain
        let mut f: Vec<f64> = (0..2 * n).map(|i| (i as f64).sin()).collect();
        let unheld = f[n..].iter().sum::<f64>() / n as f64;
        f[n..].iter_mut().for_each(|f| *f -= unheld);
        let mut u = vec![0.0; 2 * n];
        inverse.apply(&f, &mut u).unwrap();
        let r = inverse.null_space.col(1);
        axpy(dot(r, &f) / inverse.stiffness[1], r, &mut u);
        let mut image = vec![0.0; 2 * n];
        k.mul(&u, &mut image);
        assert!(image.iter().zip(&f).all(|(a, b)| (a - b).abs() < 1e-13), "{image:?}");
        // the springs carry nothing of a load without part along L, the translation of the first chain in the metric D
        inverse.apply(&f, &mut u).unwrap();
        let (mut moved, mut terms) = (0.0, 0.0);
        for i in 0..n {
            moved += k.metric(i, 1.0) * u[i];
            terms += (k.metric(i, 1.0) * u[i]).abs();
        }
        assert!(moved.abs() < 1e-13 * terms, "{moved:e}");
    }

    #[test]
    fn operators_are_those_of_what_is_left_of_k_plus() {
        let (n, k) = (20, chains(20, [0.5, 2.0]));
        let inverse = made(&k, Matrix::zeros(2 * n, 0).unwrap());
        let inverse = Arc::new(inverse.with_carried(&k, &rigid(n, &[0, 1])).unwrap());
        let (mut rows, mut random) = (Csr::empty(2 * n), Random::default());
        for i in 0..5 {
            let v = random.vector(2 * n, |_| 1.0).unwrap();
            rows.push_row([(i, v[0]), (i + 3, v[1]), (2 * n - 1 - i, v[2])]);
        }
        let form = inverse.inverse_form(&rows).unwrap();
        for j in 0..5 {
            let (mut b, mut x) = (vec![0.0; 2 * n], vec![0.0; 2 * n]);
            rows.row(j).for_each(|(dof, v)| b[dof] = v);
            inverse.apply(&b, &mut x).unwrap();
            for i in 0..5 {
                assert!((rows.row_dot(i, &x) - form.get(i, j)).abs() < 1e-13);
            }
        }
    }

    /// Every dof of the first chain has a spring to the ground.
    #[test]
    fn motions_that_are_not_soft_are_left_to_k_plus() {
        let (n, mut k) = (20, chains(20, [0.5, 0.5]));
        let matrix = Arc::make_mut(&mut k.matrix);
        (0..n).for_each(|i| matrix.val[matrix.ptr[i + 1] - 1] += 2.0);
        let plain = made(&k, Matrix::zeros(2 * n, 0).unwrap());
        let inverse = plain.with_carried(&k, &rigid(n, &[0, 1])).unwrap();
        assert_eq!(inverse.null_space.cols, 1);
        assert!((0..n).all(|i| inverse.null_space.get(i, 0).abs() < 1e-14));
    }

    #[test]
    fn a_body_that_floats_carries_no_motion() {
        let (n, k) = (7, chains(7, [0.0; 2]));
        let inverse = made(&k, rigid(n, &[0, 1])).with_carried(&k, &rigid(n, &[0, 1])).unwrap();
        assert_eq!((inverse.null_space.cols, inverse.stiffness.len()), (2, 0));
    }

    /// `K^-1 = K_c+ + R S^-1 R'`, even if the metric is dominated by a support.
    #[test]
    fn supports_of_any_stiffness_leave_k_plus_as_exact_as_it_was() {
        let n = 20;
        for ground in [1e-6, 1.0, 1e6, 1e20] {
            let k = chains(n, [ground, 1.0]);
            let plain = made(&k, Matrix::zeros(2 * n, 0).unwrap());
            let inverse = plain.clone().with_carried(&k, &rigid(n, &[0, 1])).unwrap();
            let carried = inverse.stiffness.len();
            assert!(carried > 0);
            let f: Vec<f64> = (0..2 * n).map(|i| (i as f64).cos()).collect();
            let [mut u, mut expected] = [vec![0.0; 2 * n], vec![0.0; 2 * n]];
            plain.apply(&f, &mut expected).unwrap();
            inverse.apply(&f, &mut u).unwrap();
            for j in 0..carried {
                let r = inverse.null_space.col(j);
                axpy(dot(r, &f) / inverse.stiffness[j], r, &mut u);
            }
            let most = norm(&expected);
            assert!(u.iter().zip(&expected).all(|(a, b)| (a - b).abs() <= 1e-13 * most), "{ground:e}");
        }
    }
}
