//! Hat functions of the corners of a sub-face, made dual on its covered part.

use crate::numbers::surface::{FAR, SLIVER};

/// Entries beyond the corners are 0.
pub type Square = [[f64; 4]; 4];

/// C with `Phi = C psi`, from `d = int psi` and `M = int psi psi'` over the covered part: `diag(d) M^-1`, so that `int Phi_j psi_k` is 0 for
/// j != k. A corner that lies far from the covered part leaves its function to the others, in proportion to their d; where M is singular to
/// some digits, as on specks, Phi are the hat functions. Always `sum Phi = 1` and `int Phi_j >= 0`.
pub fn dual(d: &[f64; 4], m: &Square, count: usize) -> Square {
    let most = d.iter().fold(0.0f64, |most, d| most.max(*d));
    let near: Vec<usize> = (0..count).filter(|&j| d[j] > FAR * most).collect();
    let sum: f64 = near.iter().map(|&j| d[j]).sum();
    // hat functions of the near corners, psi' = S psi
    let mut s = [[0.0; 4]; 4];
    for (row, &j) in s.iter_mut().zip(&near) {
        let far = |k: usize| !near.contains(&k);
        (0..count).for_each(|k| {
            row[k] = if k == j {
                1.0
            } else if far(k) {
                d[j] / sum
            } else {
                0.0
            }
        });
    }
    let d = s.map(|row| (0..4).map(|k| row[k] * d[k]).sum::<f64>());
    let m = product(&product(&s, m), &transposed(&s));
    let inverse = inverse(&m, near.len()).filter(|inverse| norm(&m) * norm(inverse) <= SLIVER);
    let made =
        inverse.map_or(s, |inverse| product(&std::array::from_fn(|j| inverse[j].map(|v| d[j] * v)), &s));
    let mut c = [[0.0; 4]; 4];
    near.iter().zip(made).for_each(|(j, row)| c[*j] = row);
    c
}

fn product(a: &Square, b: &Square) -> Square {
    std::array::from_fn(|i| std::array::from_fn(|j| (0..4).map(|k| a[i][k] * b[k][j]).sum()))
}

fn transposed(a: &Square) -> Square {
    std::array::from_fn(|i| std::array::from_fn(|j| a[j][i]))
}

/// Largest sum of a row.
fn norm(m: &Square) -> f64 {
    m.iter().map(|row| row.iter().map(|v| v.abs()).sum()).fold(0.0, f64::max)
}

/// By Cholesky's factors; none if m is not positive definite.
fn inverse(m: &Square, count: usize) -> Option<Square> {
    let mut l = [[0.0; 4]; 4];
    for j in 0..count {
        for i in j..count {
            let rest = m[i][j] - (0..j).map(|k| l[i][k] * l[j][k]).sum::<f64>();
            if i == j && !(rest > 0.0) {
                return None;
            }
            l[i][j] = if i == j { rest.sqrt() } else { rest / l[j][j] };
        }
    }
    let mut inverse = [[0.0; 4]; 4];
    for column in 0..count {
        let mut y = [0.0; 4];
        for i in 0..count {
            let e = if i == column { 1.0 } else { 0.0 };
            y[i] = (e - (0..i).map(|k| l[i][k] * y[k]).sum::<f64>()) / l[i][i];
        }
        for i in (0..count).rev() {
            y[i] = (y[i] - (i + 1..count).map(|k| l[k][i] * y[k]).sum::<f64>()) / l[i][i];
            inverse[i][column] = y[i];
        }
    }
    Some(inverse)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// d and M of the bilinear functions on [0, a] x [0, b].
    fn covered(a: f64, b: f64) -> ([f64; 4], Square) {
        let line = |a: f64| {
            let (second, third) = (a * a / 2.0, a * a * a / 3.0);
            ([a - second, second], [[a - 2.0 * second + third, second - third], [second - third, third]])
        };
        let ((p, m), (q, n)) = (line(a), line(b));
        let of = [[0, 0], [1, 0], [1, 1], [0, 1]];
        let product = |j: usize, k: usize| m[of[j][0]][of[k][0]] * n[of[j][1]][of[k][1]];
        (
            std::array::from_fn(|j| p[of[j][0]] * q[of[j][1]]),
            std::array::from_fn(|j| std::array::from_fn(|k| product(j, k))),
        )
    }

    #[test]
    fn functions_on_the_covered_part_are_dual_to_the_hats_and_sum_to_one() {
        for (a, b) in
            [(1.0, 1.0), (0.3, 1.0), (1.0, 1e-3), (0.2, 0.1), (0.03, 0.04), (1e-6, 1.0), (1e-9, 1e-9)]
        {
            let (d, m) = covered(a, b);
            let c = dual(&d, &m, 4);
            let is_dual = a * b > 0.05;
            for k in 0..4 {
                assert!((0..4).all(|j| !is_dual || {
                    let product: f64 = (0..4).map(|i| c[j][i] * m[i][k]).sum();
                    (product - if j == k { d[j] } else { 0.0 }).abs() < 1e-12 * a * b
                }));
                let sum: f64 = (0..4).map(|j| c[j][k]).sum();
                assert!((sum - 1.0).abs() < 1e-11, "{a} {b}: {sum}");
            }
            let areas: Vec<f64> = (0..4).map(|j| (0..4).map(|k| c[j][k] * d[k]).sum()).collect();
            assert!(
                areas.iter().all(|area| *area >= 0.0)
                    && (areas.iter().sum::<f64>() - a * b).abs() < 1e-14 * a * b
            );
        }
        // on a strip those of its line
        let (d, m) = covered(1e-6, 1.0);
        let c = dual(&d, &m, 4);
        assert!(c[1] == [0.0; 4] && c[2] == [0.0; 4]);
        assert!((c[0][0] - 2.0).abs() < 1e-5 && (c[0][3] + 1.0).abs() < 1e-5, "{c:?}");
    }
}
