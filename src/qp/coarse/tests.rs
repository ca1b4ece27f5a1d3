//! Faces that resist all motions, some of them, or some of them weakly.

use super::*;
use crate::linalg::random::scattered;
use crate::linalg::vector::{dot, norm, norm_max};

/// The coarse space with single columns as blocks.
fn coarse<'a>(g_transposed: &'a Csr, bounded: &[bool], rounding: f64) -> Coarse<'a> {
    Coarse::on_space(
        Space::new(g_transposed, g_transposed, bounded.to_vec()).unwrap(),
        g_transposed,
        &[],
        rounding,
    )
}

fn undetermined(g_transposed: &Csr, held: &[bool], rounding: f64) -> Result<Matrix> {
    AnswerFace::new(g_transposed, &[], held, rounding)?.undetermined()
}

#[test]
fn the_projected_vector_lies_on_the_face_and_in_the_kernel_of_g() {
    let mut g_transposed = Csr::empty(1);
    for v in [1.0, 2.0, -1.0, 3.0] {
        g_transposed.push_row([(0, v)]);
    }
    let mut coarse = coarse(&g_transposed, &[true; 4], 1e-14);
    let mut v = [1.0, 1.0, 1.0, 1.0];
    coarse.project(&[false, true, false, false], &mut v).unwrap();
    assert_eq!(v[1], 0.0);
    assert!(coarse.image(&v)[0].abs() < 1e-15);
    let before = v;
    coarse.project(&[false, true, false, false], &mut v).unwrap();
    assert!(v.iter().zip(&before).all(|(a, b)| (a - b).abs() < 1e-15), "a projection repeats itself");
}

#[test]
fn a_face_without_a_mode_has_a_kernel_and_its_solution_minimum_norm() {
    let mut g_transposed = Csr::empty(2);
    g_transposed.push_row([(0, 1.0), (1, 1.0)]);
    g_transposed.push_row([(0, 1.0), (1, -1.0)]);
    let mut coarse = coarse(&g_transposed, &[true; 2], 1e-14);
    let mut face = coarse.on(&[false, true]).unwrap();
    assert_eq!(face.deficiency(), 1);
    let x = face.solve(&[1.0, 1.0]).unwrap();
    assert!((x[0] - 0.5).abs() < 1e-14 && (x[1] - 0.5).abs() < 1e-14);
    let free = undetermined(&g_transposed, &[false, true], 1e-14).unwrap();
    assert_eq!((free.rows, free.cols), (2, 1));
    assert!((free.get(0, 0) + free.get(1, 0)).abs() < 1e-14 && free.get(0, 0).abs() == 1.0);
    assert_eq!(undetermined(&g_transposed, &[false, false], 1e-14).unwrap().cols, 0);
    assert_eq!(undetermined(&g_transposed, &[true, true], 1e-14).unwrap().data, [1.0, 0.0, 0.0, 1.0]);
}

/// Numbers in [-1/2, 1/2) and an orthogonal matrix.
fn random() -> impl FnMut() -> f64 {
    let mut numbers = scattered(100_000).into_iter();
    move || numbers.next().unwrap()
}

fn orthogonal(n: usize, next: &mut impl FnMut() -> f64) -> Matrix {
    let data = (0..n * n).map(|_| next()).collect();
    Matrix { rows: n, cols: n, data }.orthonormalised(0.0)
}

/// Rows of `G' T`, |G T|_F = 1.
fn turned(rows: &[[f64; 6]], t: &Matrix) -> Csr {
    let size = rows.iter().flatten().map(|v| v * v).sum::<f64>().sqrt();
    let mut g_transposed = Csr::empty(6);
    for row in rows {
        g_transposed.push_row((0..6).map(|k| (k, dot(row, t.col(k)) / size)));
    }
    g_transposed
}

/// A flat contact resists one translation and two rotations; it resists the others by the factors `weak`.
fn flat(weak: [f64; 3], next: &mut impl FnMut() -> f64) -> Vec<[f64; 6]> {
    (0..300).map(|_| [next(), 1.0, next(), weak[0] * next(), weak[1] * next(), weak[2] * next()]).collect()
}

/// Checks that as many columns of T' are free as `weak` has zeros, and that `free` spans them to `accuracy`.
fn assert_free(g_transposed: &Csr, rounding: f64, t: &Matrix, expected: &[usize], accuracy: f64) {
    let held = vec![false; g_transposed.rows()];
    let free = undetermined(g_transposed, &held, rounding).unwrap();
    let mut coarse = coarse(g_transposed, &held, rounding);
    let face = coarse.on(&held).unwrap();
    assert_eq!((free.cols, face.deficiency()), (expected.len(), expected.len()));
    for j in 0..free.cols {
        let mut original = vec![0.0; 6];
        t.mul_add(1.0, free.col(j), &mut original);
        for k in (0..6).filter(|k| !expected.contains(k)) {
            assert!(original[k].abs() <= accuracy * norm(&original), "{k}: {original:?}");
        }
    }
}

#[test]
fn a_flat_contact_leaves_three_motions_free_however_the_modes_are_mixed_and_known() {
    let mut next = random();
    for mixed in 0..6 {
        let rows = flat([0.0; 3], &mut next);
        let mut t = Matrix::zeros(6, 6).unwrap();
        (0..6).for_each(|k| t.set(k, k, 1.0));
        match mixed {
            0 => {}
            1 | 2 => t = orthogonal(6, &mut next),
            3 => t.data.iter_mut().for_each(|v| *v += 1e-9 * next()),
            _ => t.data.iter_mut().for_each(|v| *v += next()),
        }
        let mut g_transposed = turned(&rows, &t);
        assert_free(&g_transposed, 1.5e-14, &t, &[3, 4, 5], 1e-12);
        let size = norm_max(&g_transposed.val);
        g_transposed.val.iter_mut().for_each(|v| *v += 1e-12 * size * next());
        assert_free(&g_transposed, 1e-12, &t, &[3, 4, 5], 1e-10);
    }
}

#[test]
fn a_motion_that_is_resisted_by_little_is_resisted_and_its_forces_are_found() {
    let mut next = random();
    for weak in [1e-5, 1e-7, 1e-10] {
        let rows = flat([weak, 0.0, weak], &mut next);
        let t = orthogonal(6, &mut next);
        let g_transposed = turned(&rows, &t);
        assert_free(&g_transposed, 1.5e-14, &t, &[4], 1e-3 * 1e-12 / weak);
        // the remainder of G'alpha is 0, although the rounding of G G'alpha is large relative to its weak part
        let mut coarse = coarse(&g_transposed, &[false; 300], 1.5e-14);
        let alpha = [1.0, -2.0, 0.5, 3.0, 1.0, 0.1];
        let mut v: Vec<f64> = (0..300).map(|i| g_transposed.row_dot(i, &alpha)).collect();
        coarse.project(&[false; 300], &mut v).unwrap();
        assert!(norm(&v) < 1e-14, "{weak}: {:e}", norm(&v));
        assert!((0..100).all(|i| coarse.image(&v)[i % 6].abs() < 1e-15));
    }
}

#[test]
fn rows_that_are_rounding_alone_hold_nothing() {
    let mut next = random();
    let mut rows = flat([0.0; 3], &mut next);
    rows.iter_mut().skip(10).for_each(|row| row.iter_mut().for_each(|v| *v *= 1e-16));
    let mut t = Matrix::zeros(6, 6).unwrap();
    (0..6).for_each(|k| t.set(k, k, 1.0));
    let g_transposed = turned(&rows, &t);
    let held: Vec<bool> = (0..300).map(|i| i < 10).collect();
    assert_eq!(undetermined(&g_transposed, &held, 1.5e-14).unwrap().cols, 6);
}

/// In a chain of single columns the free motion moves one column by 1e-3 or 1e-4 of the others, and another by the square
/// of that.
#[test]
fn a_motion_that_is_free_is_found_however_little_it_moves_some_columns() {
    let mut next = random();
    for (n, little) in [(8, 1e-3), (8, 1e-4), (100, 1e-3), (100, 1e-4)] {
        for _ in 0..20 {
            let mut motion = vec![1.0; n];
            let at = |x: f64| (((0.5 + x) * n as f64) as usize).min(n - 1);
            (motion[at(next())], motion[at(next())]) = (little, little * little);
            let mut g_transposed = Csr::empty(n);
            for first in 0..n - 1 {
                for _ in 0..3 {
                    let columns = first..n.min(first + 4);
                    let row: Vec<f64> = columns.clone().map(|_| next()).collect();
                    let own = &motion[columns.clone()];
                    let part = dot(&row, own) / dot(own, own);
                    g_transposed.push_row(columns.zip(row.iter().zip(own).map(|(v, m)| v - part * m)));
                }
            }
            let held = vec![false; g_transposed.rows()];
            assert_eq!(undetermined(&g_transposed, &held, 1.5e-14).unwrap().cols, 1, "{n} {little:e}");
        }
    }
}

/// Two blocks in a flat contact, few rows between the lower block and the ground; the modes of the stiff block are
/// divided by one number.
#[test]
fn a_body_a_million_times_stiffer_counts_alike() {
    let mut next = random();
    let (t, u) = (orthogonal(6, &mut next), orthogonal(6, &mut next));
    let between = flat([0.0; 3], &mut next);
    for stiffer in [1.0, 1e6] {
        let size = (between.iter().flatten().map(|v| v * v).sum::<f64>()).sqrt();
        let mut g_transposed = Csr::empty(12);
        let soft = |row: &[f64; 6], by: f64, t: &Matrix| -> Vec<f64> {
            (0..6).map(|k| by * dot(row, t.col(k)) / size).collect()
        };
        for row in &between {
            let of_stiff = soft(row, 1.0 / stiffer, &u);
            let scaled = of_stiff.iter().map(|v| -v * stiffer);
            g_transposed.push_row(soft(row, 1.0, &t).into_iter().chain(scaled).enumerate());
        }
        (0..6).for_each(|k| g_transposed.push_row([(6 + k, 0.1)]));
        let rows = g_transposed.rows();
        assert_eq!(undetermined(&g_transposed, &vec![false; rows], 1.5e-14).unwrap().cols, 3);
        let ground: Vec<bool> = (0..rows).map(|i| i >= 300).collect();
        assert_eq!(undetermined(&g_transposed, &ground, 1.5e-14).unwrap().cols, 9);
    }
}
