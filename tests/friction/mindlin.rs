//! Cattaneo and Mindlin: two elastic half planes, pressed together and pushed along, against the closed form.

use feti_contact::linalg::{Matrix, SpdSolver};
use feti_contact::qp::friction::{FrictionStart, Node};
use feti_contact::qp::Verdict;

use crate::friction::dense::OfMatrices;
use crate::friction::problem::Given;

const MU: f64 = 0.3;

/// n cells over 3 a, a = 1, E* = 1, R = 1/2, p0 = 1: forces of cells, the push so much of what makes it slide.
fn given(n: usize, part: f64) -> (Given, Vec<f64>) {
    let h = 3.0 / n as f64;
    let place: Vec<f64> = (0..n).map(|i| -1.5 + (i as f64 + 0.5) * h).collect();
    // displacement by a unit force spread over a cell, -2/pi mean of ln(|x - s|/10)
    let primitive = |s: f64| if s == 0.0 { 0.0 } else { s * ((s / 10.0).abs().ln() - 1.0) };
    let by = |x: f64| -2.0 / std::f64::consts::PI * (primitive(x + 0.5 * h) - primitive(x - 0.5 * h)) / h;
    let entry = |i: usize, j: usize| if i % 2 == j % 2 { by(place[i / 2] - place[j / 2]) } else { 0.0 };
    let f = Matrix::from_fn(2 * n, 2 * n, entry).unwrap();
    let d: Vec<f64> =
        (0..2 * n).map(|i| if i % 2 == 0 { -place[i / 2] * place[i / 2] } else { 0.0 }).collect();
    let nodes = (0..n).map(|i| Node::new(Some(2 * i), &[2 * i + 1], MU, 0.0).unwrap()).collect();
    let unit = 1.0 / (n as f64).sqrt();
    let g: Vec<Vec<f64>> =
        (0..2).map(|c| (0..2 * n).map(|i| if i % 2 == c { unit } else { 0.0 }).collect()).collect();
    let pressed = 0.5 * std::f64::consts::PI;
    let e = vec![unit * pressed, unit * part * MU * pressed];
    let identity = Matrix::from_fn(2 * n, 2 * n, |i, j| f64::from(u8::from(i == j))).unwrap();
    let inverse = SpdSolver::new(&f, &vec![1.0; 2 * n]).unwrap();
    let mut middle = Matrix::zeros(2 * n, 2 * n).unwrap();
    for j in 0..2 * n {
        middle.col_mut(j).copy_from_slice(&inverse.solve(identity.col(j)));
    }
    let mut given = Given::new(f, d, nodes).floating(&g, e);
    given.preconditioner = Some(OfMatrices { coupling: identity, middle });
    (given, place)
}

/// Root of the mean square error of the shear against that of the closed form.
fn error(n: usize, part: f64) -> f64 {
    let (given, place) = given(n, part);
    let found = given.from(FrictionStart::default(), 1e-10, 0);
    assert_eq!(found.verdict, Verdict::Solved, "{} {:?}", found.merit, found.counts);
    println!("n {n} push {part}: {} products, {:?}", found.counts.products, found.counts);
    let h = 3.0 / n as f64;
    let stuck = (1.0 - part).sqrt();
    let half = |x: f64, a: f64| (1.0 - x * x / (a * a)).max(0.0).sqrt();
    let closed: Vec<f64> = place.iter().map(|x| MU * (half(*x, 1.0) - stuck * half(*x, stuck))).collect();
    let square: f64 = closed.iter().map(|q| q * q).sum();
    let missed: f64 = closed.iter().enumerate().map(|(i, q)| (found.x[2 * i + 1] / h - q).powi(2)).sum();
    (missed / square).sqrt()
}

#[test]
fn the_shear_between_half_planes_is_that_of_cattaneo_and_mindlin() {
    for part in [0.3, 0.6, 0.9] {
        let error = error(100, part);
        assert!(error < 2.5e-2, "{part}: {error:e}");
    }
}

#[test]
#[ignore]
fn the_shear_between_finely_divided_half_planes_is_that_of_cattaneo_and_mindlin() {
    for (part, limit) in [(0.3, 3e-3), (0.6, 2e-3), (0.9, 1.2e-3)] {
        let error = error(400, part);
        println!("{part}: {error:e}");
        assert!(error < limit, "{part}: {error:e}");
    }
}
