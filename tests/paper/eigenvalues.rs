//! Eigenvalues of small symmetric matrices by Jacobi rotations, independent of the library.

use crate::qp::dense::Dense;

/// Ascending.
pub fn eigenvalues(matrix: &Dense) -> Vec<f64> {
    let mut a = matrix.0.clone();
    let n = a.len();
    for _ in 0..60 {
        let mut rest = 0.0;
        for p in 0..n {
            for q in p + 1..n {
                rest += a[p][q] * a[p][q];
                rotate(&mut a, p, q);
            }
        }
        let size: f64 = (0..n).map(|i| a[i][i] * a[i][i]).sum();
        if rest <= 1e-32 * size {
            break;
        }
    }
    let mut values: Vec<f64> = (0..n).map(|i| a[i][i]).collect();
    values.sort_by(f64::total_cmp);
    values
}

/// Makes a_pq zero.
fn rotate(a: &mut [Vec<f64>], p: usize, q: usize) {
    if a[p][q] == 0.0 {
        return;
    }
    let theta = 0.5 * (a[q][q] - a[p][p]) / a[p][q];
    let t = theta.signum() / (theta.abs() + (theta * theta + 1.0).sqrt());
    let c = 1.0 / (t * t + 1.0).sqrt();
    let s = t * c;
    for row in a.iter_mut() {
        let (x, y) = (row[p], row[q]);
        (row[p], row[q]) = (c * x - s * y, s * x + c * y);
    }
    for k in 0..a.len() {
        let (x, y) = (a[p][k], a[q][k]);
        (a[p][k], a[q][k]) = (c * x - s * y, s * x + c * y);
    }
}

#[test]
fn the_eigenvalues_of_a_chain_are_known() {
    let n = 12;
    let entry = |i: usize, j: usize| if i == j { 2.0 } else { -f64::from(u8::from(i.abs_diff(j) == 1)) };
    let chain = Dense((0..n).map(|i| (0..n).map(|j| entry(i, j)).collect()).collect());
    for (k, value) in eigenvalues(&chain).iter().enumerate() {
        let angle = (k + 1) as f64 * std::f64::consts::PI / (n + 1) as f64;
        assert!((value - (2.0 - 2.0 * angle.cos())).abs() < 1e-13);
    }
}
