//! The nearest point against brute force on faces of size 1 and 2.

use super::*;
use crate::linalg::random::scattered;
use crate::platform::threads::run;

const RANDOM: usize = 100_000;

/// A face whose nodes are moved at random by up to the part `by` of its edges.
fn bent(shape: Shape, by: f64, random: &[f64]) -> Patch {
    let mut at = random.iter();
    let dim = shape.dim();
    let edge = if shape.kind() == Kind::Triangle { 1.0 } else { 2.0 };
    let node = |k: usize| {
        let r = shape.place(k);
        let moved: Vector =
            std::array::from_fn(|i| if i < dim { 2.0 * by * edge * at.next().unwrap() } else { 0.0 });
        plus([r[0], r[1], 0.0], 1.0, moved)
    };
    Patch::new(shape, (0..shape.nodes()).map(node))
}

/// Least distance by a grid of 16 parts and pattern search from each of its local minima.
fn brute(patch: &Patch, x: Vector) -> f64 {
    const N: usize = 16;
    let shape = patch.shape;
    let is_inside = |r: Parent| match shape.kind() {
        Kind::Line => r[0].abs() <= 1.0 && r[1] == 0.0,
        Kind::Triangle => r[0] >= 0.0 && r[1] >= 0.0 && r[0] + r[1] <= 1.0,
        Kind::Square => r[0].abs() <= 1.0 && r[1].abs() <= 1.0,
    };
    let distance = |r: Parent| if is_inside(r) { length(minus(patch.point(r), x)) } else { f64::INFINITY };
    let (origin, h) = match shape.kind() {
        Kind::Triangle => (0.0, 1.0 / N as f64),
        _ => (-1.0, 2.0 / N as f64),
    };
    let lines = if shape.kind() == Kind::Line { 1 } else { N + 1 };
    let at =
        |i: usize, j: usize| [origin + h * i as f64, if lines == 1 { 0.0 } else { origin + h * j as f64 }];
    let mut grid = [[f64::INFINITY; N + 1]; N + 1];
    (0..=N).for_each(|i| (0..lines).for_each(|j| grid[i][j] = distance(at(i, j))));
    let around = |i: usize, j: usize| {
        (i.saturating_sub(1)..(i + 2).min(N + 1))
            .flat_map(move |k| (j.saturating_sub(1)..(j + 2).min(N + 1)).map(move |l| (k, l)))
    };
    let mut least = f64::INFINITY;
    for (i, j) in (0..=N).flat_map(|i| (0..lines).map(move |j| (i, j))) {
        let own = grid[i][j];
        if !own.is_finite() || around(i, j).any(|(k, l)| grid[k][l] < own) || own > least + 6.0 * h {
            continue;
        }
        let (mut r, mut best, mut step) = (at(i, j), own, h);
        while step > 1e-10 {
            let moves = [
                [1.0, 0.0],
                [-1.0, 0.0],
                [0.0, 1.0],
                [0.0, -1.0],
                [1.0, -1.0],
                [-1.0, 1.0],
                [1.0, 1.0],
                [-1.0, -1.0],
            ];
            let trials = moves.map(|m| [r[0] + step * m[0], r[1] + step * m[1]]);
            let next =
                trials.into_iter().map(|t| (distance(t), t)).min_by(|a, b| a.0.total_cmp(&b.0)).unwrap();
            if next.0 < best {
                (best, r) = next;
            } else {
                step *= 0.5;
            }
        }
        least = least.min(best);
    }
    least
}

#[test]
fn the_nearest_point_of_every_shape_is_that_of_brute_force() {
    const EACH: usize = 1000;
    for shape in Shape::ALL {
        let dim = shape.dim();
        let worst = run(2, RANDOM / EACH, |part| {
            let random = scattered((part + 1) * 40 * EACH).split_off(part * 40 * EACH);
            let gap = |w: &[f64]| {
                let patch = bent(shape, if part % 2 == 0 { 0.1 } else { 0.02 }, w);
                let x = std::array::from_fn(|i| if i < dim { 4.0 * w[36 + i] } else { 0.0 });
                let found = patch.nearest(x, &Domain::grown(shape, |_| 0.0));
                length(minus(patch.point(found), x)) - brute(&patch, x)
            };
            Ok(random.chunks(40).map(gap).fold(0.0, f64::max))
        });
        let above = worst.unwrap().into_iter().fold(0.0, f64::max);
        assert!(above <= 1e-12, "{shape:?}: {above:e}");
    }
}

#[test]
fn a_face_stays_in_the_box_of_its_corners_grown_by_the_sagitta() {
    for shape in Shape::ALL {
        for w in scattered(27 * 300).chunks(27) {
            let patch = bent(shape, 0.5, w);
            let (bulge, corners) = (patch.sagitta(), &patch.nodes()[..shape.corners().len()]);
            for t in scattered(60).chunks(2) {
                let r = match shape.kind() {
                    Kind::Line => [2.0 * t[0], 0.0],
                    Kind::Triangle => [t[0] + 0.5, (0.5 - t[0]) * (t[1] + 0.5)],
                    Kind::Square => [2.0 * t[0], 2.0 * t[1]],
                };
                let x = patch.point(r);
                for i in 0..3 {
                    let low = corners.iter().fold(f64::INFINITY, |low, c| low.min(c[i])) - bulge[i];
                    let high = corners.iter().fold(-f64::INFINITY, |high, c| high.max(c[i])) + bulge[i];
                    assert!(low - 1e-15 <= x[i] && x[i] <= high + 1e-15, "{shape:?}");
                }
            }
        }
    }
}
