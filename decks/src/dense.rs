//! Small dense linear algebra for the decks and their yardsticks: singular vectors, eigenvalues, elimination.

use crate::vector::{axpy, dot};

/// A = U diag(values) V', by columns: `columns[k]` = U_k values_k, `right[k]` = V_k, values descending.
pub struct Singular {
    pub values: Vec<f64>,
    pub columns: Vec<Vec<f64>>,
    pub right: Vec<Vec<f64>>,
}

/// One-sided Jacobi on the columns of A, each of length `rows`: small singular values of a matrix with columns of unequal
/// length are found to their own precision.
pub fn singular(mut columns: Vec<Vec<f64>>) -> Singular {
    let n = columns.len();
    let unit = |k: usize| (0..n).map(|i| f64::from(i == k)).collect::<Vec<f64>>();
    let mut right: Vec<Vec<f64>> = (0..n).map(unit).collect();
    for _ in 0..60 {
        let mut turned = false;
        for p in 0..n {
            for q in p + 1..n {
                turned |= orthogonalise(&mut columns, &mut right, p, q);
            }
        }
        if !turned {
            break;
        }
    }
    let lengths: Vec<f64> = columns.iter().map(|c| dot(c, c).sqrt()).collect();
    let mut order: Vec<usize> = (0..n).collect();
    order.sort_by(|&a, &b| lengths[b].total_cmp(&lengths[a]));
    let pick = |from: &[Vec<f64>]| order.iter().map(|&k| from[k].clone()).collect();
    Singular {
        values: order.iter().map(|&k| lengths[k]).collect(),
        columns: pick(&columns),
        right: pick(&right),
    }
}

/// Turns columns p and q until they are orthogonal; false where they are.
fn orthogonalise(columns: &mut [Vec<f64>], right: &mut [Vec<f64>], p: usize, q: usize) -> bool {
    let (a, b, c) =
        (dot(&columns[p], &columns[p]), dot(&columns[q], &columns[q]), dot(&columns[p], &columns[q]));
    if c == 0.0 || c.abs() <= 4.0 * f64::EPSILON * (a * b).sqrt() {
        return false;
    }
    let zeta = (b - a) / (2.0 * c);
    let t = zeta.signum() / (zeta.abs() + zeta.hypot(1.0));
    let cosine = 1.0 / t.hypot(1.0);
    for side in [columns, right] {
        let (left, rest) = side.split_at_mut(q);
        for (x, y) in left[p].iter_mut().zip(&mut rest[0]) {
            (*x, *y) = (cosine * (*x - t * *y), cosine * (t * *x + *y));
        }
    }
    true
}

/// All eigenvalues of a symmetric matrix, n x n by rows: Householder's tridiagonal form, then QL with implicit shifts.
/// Right to eps times the largest.
pub fn eigenvalues(mut a: Vec<f64>, n: usize) -> Vec<f64> {
    let mut beside = vec![0.0; n];
    for k in 0..n.saturating_sub(2) {
        reduce(&mut a, n, k);
    }
    (1..n).for_each(|i| beside[i - 1] = a[i * n + i - 1]);
    let mut diagonal: Vec<f64> = (0..n).map(|i| a[i * n + i]).collect();
    for l in 0..n {
        for _ in 0..80 {
            let small =
                |m: usize| beside[m].abs() <= f64::EPSILON * (diagonal[m].abs() + diagonal[m + 1].abs());
            let m = (l..n - 1).find(|&m| small(m)).unwrap_or(n - 1);
            if m == l {
                break;
            }
            ql_step(&mut diagonal, &mut beside, l, m);
        }
    }
    diagonal
}

/// A := P A P with the reflection P = I - 2 v v' that clears column k below its second entry.
fn reduce(a: &mut [f64], n: usize, k: usize) {
    let mut v: Vec<f64> = (k + 1..n).map(|i| a[i * n + k]).collect();
    let length = dot(&v, &v).sqrt();
    if length == 0.0 {
        return;
    }
    v[0] += length.copysign(v[0]);
    let size = dot(&v, &v).sqrt();
    v.iter_mut().for_each(|x| *x /= size);
    let v: Vec<f64> = std::iter::repeat_n(0.0, k + 1).chain(v).collect();
    let mut p: Vec<f64> = (0..n).map(|i| 2.0 * dot(&a[i * n..(i + 1) * n], &v)).collect();
    axpy(-dot(&v, &p), &v, &mut p);
    for i in 0..n {
        for j in 0..n {
            a[i * n + j] -= v[i] * p[j] + p[i] * v[j];
        }
    }
}

/// One QL step with Wilkinson's shift on rows l..=m of a tridiagonal matrix.
fn ql_step(d: &mut [f64], e: &mut [f64], l: usize, m: usize) {
    let mut g = (d[l + 1] - d[l]) / (2.0 * e[l]);
    g = d[m] - d[l] + e[l] / (g + g.hypot(1.0).copysign(g));
    let (mut s, mut c, mut p) = (1.0, 1.0, 0.0);
    for i in (l..m).rev() {
        let (f, b) = (s * e[i], c * e[i]);
        let r = f.hypot(g);
        e[i + 1] = r;
        if r == 0.0 {
            d[i + 1] -= p;
            e[m] = 0.0;
            return;
        }
        (s, c) = (f / r, g / r);
        g = d[i + 1] - p;
        let r = (d[i] - g) * s + 2.0 * c * b;
        p = s * r;
        d[i + 1] = g + p;
        g = c * r - b;
    }
    d[l] -= p;
    e[l] = g;
    e[m] = 0.0;
}

/// A^-1 b by elimination with partial pivoting, A n x n by rows; `None` where a pivot is zero.
pub fn solve(mut a: Vec<f64>, mut b: Vec<f64>) -> Option<Vec<f64>> {
    let n = b.len();
    for k in 0..n {
        let best = (k..n).max_by(|&i, &j| a[i * n + k].abs().total_cmp(&a[j * n + k].abs()))?;
        if a[best * n + k] == 0.0 {
            return None;
        }
        (0..n).for_each(|j| a.swap(k * n + j, best * n + j));
        b.swap(k, best);
        for i in k + 1..n {
            let factor = a[i * n + k] / a[k * n + k];
            (k..n).for_each(|j| a[i * n + j] -= factor * a[k * n + j]);
            b[i] -= factor * b[k];
        }
    }
    for k in (0..n).rev() {
        let known: f64 = (k + 1..n).map(|j| a[k * n + j] * b[j]).sum();
        b[k] = (b[k] - known) / a[k * n + k];
    }
    Some(b)
}

/// The span of the modes of a body with R'DR = I, D = diag K: Gram-Schmidt, twice.
pub fn orthonormal(modes: &[Vec<f64>], diagonal: &[f64]) -> Vec<Vec<f64>> {
    let mut basis: Vec<Vec<f64>> = Vec::with_capacity(modes.len());
    for mode in modes {
        let mut rest = mode.clone();
        for _ in 0..2 {
            remove(&basis, diagonal, &mut rest);
        }
        let length = inner(&rest, diagonal, &rest).sqrt();
        rest.iter_mut().for_each(|value| *value /= length);
        basis.push(rest);
    }
    basis
}

/// v := v - R R'D v with R'DR = I.
pub fn remove(basis: &[Vec<f64>], diagonal: &[f64], v: &mut [f64]) {
    for mode in basis {
        axpy(-inner(mode, diagonal, v), mode, v);
    }
}

/// x'D y.
pub fn inner(x: &[f64], diagonal: &[f64], y: &[f64]) -> f64 {
    x.iter().zip(diagonal).zip(y).map(|((x, d), y)| x * d * y).sum()
}

#[cfg(test)]
mod tests {
    use super::{eigenvalues, singular, solve};
    use crate::random::Random;

    /// A = U diag(s) V' with chosen s: both routines find them, of A and of [0 A; A' 0].
    #[test]
    fn singular_values_are_those_the_matrix_was_made_of() {
        let (mut random, n) = (Random::new(1), 12);
        let basis = |random: &mut Random| singular((0..n).map(|_| random.normals(n, 1.0)).collect());
        let (left, right) = (basis(&mut random).right, basis(&mut random).right);
        let wanted: Vec<f64> = (0..n).map(|k| 10f64.powi(-(k as i32) / 2)).collect();
        let entry = |i: usize, j: usize| (0..n).map(|k| left[k][i] * wanted[k] * right[k][j]).sum::<f64>();
        let found = singular((0..n).map(|j| (0..n).map(|i| entry(i, j)).collect()).collect());
        let mut both = vec![0.0; 4 * n * n];
        for i in 0..n {
            for j in 0..n {
                both[i * 2 * n + n + j] = entry(i, j);
                both[(n + j) * 2 * n + i] = entry(i, j);
            }
        }
        let mut values: Vec<f64> = eigenvalues(both, 2 * n).iter().map(|v| v.abs()).collect();
        values.sort_by(|a, b| b.total_cmp(a));
        for k in 0..n {
            assert!((found.values[k] - wanted[k]).abs() < 1e-14);
            assert!((values[2 * k] - wanted[k]).abs() < 1e-14, "{k} {values:?}");
        }
    }

    #[test]
    fn elimination_solves_and_refuses_a_zero_pivot() {
        assert_eq!(solve(vec![0.0, 2.0, 4.0, 0.0], vec![2.0, 8.0]), Some(vec![2.0, 1.0]));
        assert_eq!(solve(vec![1.0, 1.0, 1.0, 1.0], vec![1.0, 1.0]), None);
    }
}
