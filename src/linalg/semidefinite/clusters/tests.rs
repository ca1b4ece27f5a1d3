//! Sliding blocks in a chain.

use super::*;
use crate::linalg::random::scattered;
use crate::linalg::vector::{axpy, dot, norm};

/// Stones with two modes (across, up) in a chain: rows join neighbours in the direction up, every third pair also across;
/// the first stone is joined to the ground in the direction up, every fifth row with the factor `weak`.
fn stones(count: usize, weak: f64) -> Csr {
    let mut g = Csr::empty(2 * count);
    let random = scattered(4 * count);
    g.push_row([(1, 0.9)]);
    for k in 1..count {
        let size = if k % 5 == 0 { weak } else { 1.0 + random[k] };
        let turn = |k: usize| (0.6, if k % 2 == 0 { 0.8 } else { -0.8 });
        let ((a, b), (c, d)) = (turn(k - 1), turn(k));
        // up is (a, b) in the modes of a stone, across (-b, a)
        g.push_row([
            (2 * k - 2, -size * a),
            (2 * k - 1, -size * b),
            (2 * k, size * c),
            (2 * k + 1, size * d),
        ]);
        if k % 3 == 0 {
            g.push_row([(2 * k - 2, b), (2 * k - 1, -a), (2 * k, -d), (2 * k + 1, c)]);
        }
    }
    g
}

fn whole(g: &Csr) -> Vec<f64> {
    let mut whole = vec![0.0; g.cols];
    g.col.iter().zip(&g.val).for_each(|(&k, v)| whole[k] += v * v);
    whole
}

#[test]
fn a_chain_of_stones_that_slide_is_solved_with_minimum_norm() {
    for weak in [1.0, 1e-3, 1e-6] {
        let g = stones(60, weak);
        let starts: Vec<usize> = (0..60).map(|k| 2 * k).collect();
        let held = vec![false; g.rows()];
        let mut blocks = Blocks::new(&g, &starts, &vec![false; g.rows()], (1.0, &whole(&g), 1e-14)).unwrap();
        let inverse = blocks.inverse(&held).unwrap();
        let kernel = inverse.kernel();
        assert_eq!((inverse.deficiency(), kernel.cols), (120 - g.rows(), 120 - g.rows()), "{weak}");
        let image = |a: &[f64]| {
            let mut image = vec![0.0; g.rows()];
            g.mul(a, &mut image);
            image
        };
        assert!((0..kernel.cols).all(|j| norm(&image(kernel.col(j))) < 1e-13), "{weak}");
        let y: Vec<f64> = (0..120).map(|i| (1.0 + i as f64).sin()).collect();
        let forces = image(&y);
        let mut b = vec![0.0; 120];
        g.mul_transposed_add(1.0, &forces, &mut b);
        let x = inverse.solve(&b).unwrap();
        let mut rest = forces.clone();
        axpy(-1.0, &image(&x), &mut rest);
        assert!(norm(&rest) < 1e-14 / weak * norm(&forces), "{weak}: {:e}", norm(&rest));
        assert!((0..kernel.cols).all(|j| dot(kernel.col(j), &x).abs() < 1e-9), "{weak}: not of minimum norm");
        let basis = inverse.basis();
        assert_eq!(basis.cols, g.rows());
    }
}

/// Rows that leave one motion of n unknowns free, which moves i by `little` times the others and j by its square.
fn all_but_ending(n: usize, (i, j): (usize, usize), little: f64) -> Csr {
    let mut motion = vec![1.0; n];
    (motion[i], motion[j]) = (little, little * little);
    let mut g = Csr::empty(n);
    for numbers in scattered(n * 3 * n).chunks(n) {
        let part = dot(numbers, &motion) / dot(&motion, &motion);
        g.push_row(numbers.iter().zip(&motion).map(|(v, m)| v - part * m).enumerate());
    }
    g
}

/// If i and j are eliminated last, the pivot before them is the square of `little`, and the last pivot is rounding over
/// its fourth power.
#[test]
fn a_motion_that_all_but_ends_before_its_last_unknown_is_free() {
    let n = 8;
    for little in [1e-2, 3e-3, 1e-3, 3e-4, 1e-4] {
        for (i, j) in (0..n * n).map(|at| (at / n, at % n)).filter(|(i, j)| i != j) {
            let g = all_but_ending(n, (i, j), little);
            let (starts, held) = ((0..n).collect::<Vec<_>>(), vec![false; g.rows()]);
            let mut blocks = Blocks::new(&g, &starts, &held, (1.0, &whole(&g), 1.5e-14)).unwrap();
            assert_eq!(blocks.inverse(&held).unwrap().deficiency(), 1, "{little:e} {i} {j}");
        }
    }
}

/// Chains of springs between these numbers of masses, one row per spring: free chains, and `held` chains with a spring to
/// the ground; a single mass has no spring.
fn chains(lengths: &[(usize, bool)]) -> Csr {
    let mut springs = Csr::empty(lengths.iter().map(|(length, _)| length).sum());
    let mut first = 0;
    for &(length, held) in lengths {
        (0..usize::from(held)).for_each(|_| springs.push_row([(first, 0.7)]));
        (first + 1..first + length).for_each(|i| springs.push_row([(i - 1, -0.7), (i, 0.7)]));
        first += length;
    }
    springs
}

#[test]
fn small_and_large_singular_parts_beside_regular_ones_are_solved_and_counted() {
    let g = chains(&[(100, true), (60, false), (3, true), (2, false), (1, false), (80, false), (70, true)]);
    let (columns, held) = (g.cols, vec![false; g.rows()]);
    let mut blocks = Blocks::new(&g, &[], &held, (1.0, &whole(&g), 1e-14)).unwrap();
    let inverse = blocks.inverse(&held).unwrap();
    let kernel = inverse.kernel();
    assert_eq!((inverse.deficiency(), kernel.cols), (4, 4));
    let product = |a: &[f64]| {
        let (mut along, mut image) = (vec![0.0; g.rows()], vec![0.0; columns]);
        g.mul(a, &mut along);
        g.mul_transposed_add(1.0, &along, &mut image);
        image
    };
    assert!((0..kernel.cols).all(|j| product(kernel.col(j)).iter().all(|v| v.abs() < 1e-12)));
    let b = product(&(0..columns).map(|i| (1.0 + i as f64).sin()).collect::<Vec<_>>());
    let x = inverse.solve(&b).unwrap();
    assert!(product(&x).iter().zip(&b).all(|(a, b)| (a - b).abs() < 1e-10));
    assert!((0..kernel.cols).all(|j| dot(kernel.col(j), &x).abs() < 1e-9), "not of minimum norm");
}
