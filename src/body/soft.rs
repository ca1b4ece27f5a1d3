//! Rigid motions with small stiffness: weak springs, rounding of the entries, geometric stiffness. With the unknowns x held
//! and k free, as in (14)-(15),
//!
//! ```text
//! R = [-K_kk^-1 K_kx; I] R_x,   K = K_0 + E_x S_x E_x',   K_0 R = 0,   R_x'S_x R_x = R'K R = diag(lambda)
//! ```
//!
//! exactly, for the given K. K_0 floats, K+ of (15) is one of its generalised inverses, and S_x are springs at the held
//! unknowns, where K+ is 0: for `u = K+ (f - B'l) + R a` they resist a with the forces `lambda_j a_j`, and no other
//! motion.

use crate::body::null_space::orthonormal;
use crate::body::probe::Factor;
use crate::body::spectrum::symmetric;
use crate::error::Result;
use crate::linalg::dense::spectrum::symmetric_eigen;
use crate::linalg::random::Random;
use crate::linalg::twofold::Twofold;
use crate::linalg::vector::{axpy, dot, norm_max, NOISE};
use crate::linalg::{Matrix, Multiple};
use crate::numbers::body::{MOST_ERROR, SAMPLE};
use crate::platform::memory::filled;

const WHAT: &str = "the soft motions of a body";

/// The resistance of K to motions.
struct Resistance {
    /// `K R`, rounded once.
    image: Matrix,
    /// `64 eps |r|'|K||r|`: smaller values of `r'K r` are rounding.
    noise: Vec<f64>,
}

/// Whether K resists some of the motions by more than rounding.
pub fn are_resisted(k: &Multiple, r: &Matrix) -> Result<bool> {
    let found = Resistance::of(k, r)?;
    let is_resisted = found.diagonal(r).zip(&found.noise).any(|(stiffness, noise)| stiffness > *noise);
    Ok(is_resisted)
}

/// R with the span of `null` and of `vectors` at the held unknowns, `R'DR = I` and `R'K R = diag(lambda)`; and lambda, 0 if
/// it is rounding or of a vector of `null`, which K does not resist. `weights`: the metric if it is not D.
pub fn soft_motions(
    factor: &Factor,
    (k, weights): (&Multiple, Option<&[f64]>),
    null: Matrix,
    vectors: Matrix,
) -> Result<(Matrix, Vec<f64>)> {
    let metric = |i: usize| weights.map_or(k.metric(i, 1.0), |weights| weights[i]);
    let vectors = corrected(factor, k, vectors)?;
    let null = orthonormal(metric, &following(k, corrected(factor, k, null)?, &vectors)?)?;
    let r = without(metric, vectors, &null);
    let mut r = corrected(factor, k, orthonormal(metric, &r)?)?;
    if r.cols > 0 {
        let (_, turn) = symmetric_eigen(&Resistance::of(k, &r)?.stiffness(&r)?)?;
        r.turn_rows(&turn);
        // rounding of the stiffest couples the others with them
        let Resistance { noise, image } = Resistance::of(k, &r)?;
        for i in (1..r.cols).rev() {
            let (stiffer, stiffness) = (r.col(i).to_vec(), dot(r.col(i), image.col(i)));
            for j in (0..i).filter(|_| stiffness > noise[i]) {
                let share = dot(r.col(j), image.col(i)) / stiffness;
                axpy(-share, &stiffer, r.col_mut(j));
            }
        }
    }
    let found = Resistance::of(k, &r)?;
    let known = found.diagonal(&r).zip(&found.noise);
    let lambda = known.map(|(stiffness, noise)| if stiffness.abs() > *noise { stiffness } else { 0.0 });
    let lambda = std::iter::repeat_n(0.0, null.cols).chain(lambda).collect();
    let mut all = null;
    all.push_cols(&r);
    Ok((all, lambda))
}

/// `r - V (V'K V)^-1 V'K r`: null vectors r, which may be inexact, with soft motions V that K does not couple with them.
fn following(k: &Multiple, mut null: Matrix, soft: &Matrix) -> Result<Matrix> {
    let mut done: Vec<(Vec<f64>, Vec<f64>)> = Vec::new();
    let take = |done: &[(Vec<f64>, Vec<f64>)], r: &mut [f64]| {
        done.iter().for_each(|(v, image)| axpy(-dot(image, r), v, r));
    };
    for j in (0..soft.cols).filter(|_| null.cols > 0) {
        let mut v = soft.col(j).to_vec();
        take(&done, &mut v);
        let mut image = product(k, &v)?;
        let stiffness = dot(&v, &image);
        if stiffness > 0.0 {
            image.iter_mut().for_each(|image| *image /= stiffness);
            done.push((v, image));
        }
    }
    (0..null.cols).for_each(|j| take(&done, null.col_mut(j)));
    Ok(null)
}

/// The part of `vectors` orthogonal to the orthonormal `basis`.
fn without(metric: impl Fn(usize) -> f64, mut vectors: Matrix, basis: &Matrix) -> Matrix {
    for j in 0..vectors.cols {
        for c in (0..basis.cols).chain(0..basis.cols) {
            let (vector, of) = (vectors.col_mut(j), basis.col(c));
            let share: f64 = vector.iter().zip(of).enumerate().map(|(i, (v, b))| metric(i) * v * b).sum();
            axpy(-share, of, vector);
        }
    }
    vectors
}

/// `R - K+ K R`, which is `[-K_kk^-1 K_kx; I] R_x` for any values of R at the other unknowns.
fn corrected(factor: &Factor, k: &Multiple, mut r: Matrix) -> Result<Matrix> {
    for j in 0..r.cols {
        let mut image = product(k, r.col(j))?;
        factor.solve(&mut image)?;
        r.col_mut(j).iter_mut().zip(&image).for_each(|(r, x)| *r -= x);
    }
    Ok(r)
}

/// Accuracy of R of [`soft_motions`], relative to the fastest dof: effect of rounding in the entries of K through K+, by
/// a sample.
pub fn known_to_entries(factor: &Factor, k: &Multiple, r: &Matrix) -> Result<f64> {
    let (_, terms) = k.mul_columns(r)?;
    let (mut random, mut worst) = (Random::default(), NOISE);
    for j in 0..r.cols {
        let mut moved = random.vector(r.rows, |i| f64::EPSILON * terms.get(i, j))?;
        factor.solve(&mut moved)?;
        worst = worst.max(SAMPLE * norm_max(&moved) / norm_max(r.col(j)));
    }
    Ok(worst.min(MOST_ERROR))
}

/// `K v` in double-double arithmetic: for a soft motion the result is far smaller than its terms.
fn product(k: &Multiple, v: &[f64]) -> Result<Vec<f64>> {
    let mut image = filled(v.len(), Twofold::default(), WHAT)?;
    k.matrix.add_twofold(k.by, v, &mut image);
    Ok(image.into_iter().map(Twofold::value).collect())
}

impl Resistance {
    fn of(k: &Multiple, r: &Matrix) -> Result<Self> {
        let (mut image, terms) = k.mul_columns(r)?;
        for j in 0..r.cols {
            image.col_mut(j).copy_from_slice(&product(k, r.col(j))?);
        }
        let size =
            |j: usize| r.col(j).iter().zip(terms.col(j)).map(|(v, terms)| v.abs() * terms).sum::<f64>();
        Ok(Self { noise: (0..r.cols).map(|j| NOISE * size(j)).collect(), image })
    }

    /// `r_a'K r_b`
    fn entry(&self, r: &Matrix, a: usize, b: usize) -> f64 {
        let mut sum = Twofold::default();
        r.col(a).iter().zip(self.image.col(b)).for_each(|(v, image)| sum.add_product(*v, *image));
        sum.value()
    }

    /// `R'K R`
    fn stiffness(&self, r: &Matrix) -> Result<Matrix> {
        symmetric(r.cols, |a, b| self.entry(r, a, b))
    }

    /// `r_j'K r_j`
    fn diagonal<'a>(&'a self, r: &'a Matrix) -> impl Iterator<Item = f64> + 'a {
        (0..r.cols).map(|j| self.entry(r, j, j))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::body::{GeneralizedInverse, Modes, NullSpaceInput};
    use crate::linalg::Symmetric;

    /// A chain of unit springs between n dofs, with a spring to the ground at either end.
    fn chain(n: usize, ground: [f64; 2]) -> Multiple {
        let mut k = Symmetric::empty();
        for i in 0..n {
            let own = f64::from(u8::from(i > 0)) + f64::from(u8::from(i + 1 < n));
            let held = if i == 0 { ground[0] } else { 0.0 } + if i + 1 == n { ground[1] } else { 0.0 };
            k.push_row((i > 0).then(|| (i - 1, -1.0)).into_iter().chain([(i, own + held)]));
        }
        k.into()
    }

    fn soft(k: &Multiple) -> GeneralizedInverse {
        let n = k.order();
        let vectors = Matrix::from_fn(n, 1, |i, _| 1.0 + 0.01 * i as f64).unwrap();
        let input = NullSpaceInput { vectors, modes: Modes::Soft };
        GeneralizedInverse::plan(k.clone(), &input, 1e-8).unwrap().execute().unwrap().inverse
    }

    /// K_0 = K - E_x S_x E_x' maps R to zero, with S_x = lambda / R_x^2 and R'DR = 1; R of a chain with a force at x
    /// alone is linear on each side of x.
    #[test]
    fn motion_and_stiffness_are_those_of_dense_arithmetic() {
        for ground in [1e-12, 1e-9, 1e-6, 1e-3, -1e-6] {
            // with the rounding of the diagonal
            let springs = [ground, 3.0 * ground].map(|spring| (1.0 + spring) - 1.0);
            let (n, k) = (7, chain(7, springs));
            let inverse = soft(&k);
            let (r, x) = (inverse.null_space.col(0), inverse.fixing[0]);
            let (mut image, mut length) = (vec![0.0; n], 0.0);
            k.mul(r, &mut image);
            (0..n).for_each(|i| length += k.metric(i, 1.0) * r[i] * r[i]);
            assert!((length - 1.0).abs() < 1e-13);
            image[x] = 0.0;
            assert!(image.iter().all(|v| v.abs() < 1e-15), "{ground:e}: {image:?}");
            // springs in series with the chain on each side of x
            let series = |spring: f64, links: usize| 1.0 / (1.0 / spring + links as f64);
            let held = series(springs[0], x) + series(springs[1], n - 1 - x);
            let expected = held * r[x] * r[x];
            let found = inverse.stiffness[0];
            assert!((found / expected - 1.0).abs() < 1e-12, "{ground:e}: {found:e} {expected:e}");
        }
    }

    /// `R'DR = I`, `R'K R = diag(lambda)`, and `K R` is 0 except at the held dofs.
    fn assert_soft(k: &Multiple, inverse: &GeneralizedInverse) {
        let (n, r) = (k.order(), &inverse.null_space);
        for a in 0..r.cols {
            let mut image = vec![0.0; n];
            k.mul(r.col(a), &mut image);
            for b in 0..r.cols {
                let (equal, mut metric, mut energy) = (f64::from(u8::from(a == b)), 0.0, 0.0);
                (0..n).for_each(|i| metric += k.metric(i, 1.0) * r.get(i, a) * r.get(i, b));
                (0..n).for_each(|i| energy += image[i] * r.get(i, b));
                assert!(
                    (metric - equal).abs() < 1e-13 && (energy - equal * inverse.stiffness[a]).abs() < 1e-14
                );
            }
            inverse.fixing.iter().for_each(|&x| image[x] = 0.0);
            assert!(image.iter().all(|v| v.abs() < 1e-15), "{image:?}");
        }
    }

    /// A spring of -0.3 at one end exceeds the stiffness 0.2 of five links to the dof held for one motion: F is
    /// indefinite with this dof alone.
    #[test]
    fn where_a_body_of_negative_stiffness_bends_between_the_dofs_held_another_is_held() {
        let k = chain(7, [-0.3, 0.0]);
        let inverse = soft(&k);
        assert_eq!((inverse.null_space.cols, inverse.fixing.len()), (2, 2));
        assert_soft(&k, &inverse);
        assert!(inverse.stiffness.iter().any(|v| *v < 0.0) && inverse.stiffness.iter().any(|v| *v > 0.0));
    }

    /// A spring of nearly -0.2: F is nearly singular with this dof, and regular with another.
    #[test]
    fn a_dof_that_leaves_a_body_of_negative_stiffness_nearly_loose_is_exchanged() {
        for less in [1e-3, 1e-6, 1e-9] {
            let k = chain(7, [-0.2 * (1.0 - less), 0.0]);
            let inverse = soft(&k);
            assert_eq!(inverse.null_space.cols, 1);
            assert_soft(&k, &inverse);
            assert!(inverse.stiffness[0] < 0.0 && inverse.softness > 1e-3, "{:e}", inverse.softness);
        }
    }

    #[test]
    fn what_is_rounding_of_the_entries_terms_is_no_stiffness() {
        assert_eq!(soft(&chain(7, [0.0; 2])).stiffness, [0.0]);
        assert_eq!(soft(&chain(7, [1e-16, 0.0])).stiffness, [0.0]);
        assert!(soft(&chain(7, [1e-12, 0.0])).stiffness[0] > 0.0);
    }
}
