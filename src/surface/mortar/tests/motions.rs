//! Rows against motions that both sides share, and against differences of their openings.

use super::*;
use crate::surface::tests::motions::{norm, product, used};
use crate::surface::tests::random_mesh;
use crate::surface::vector::{cross, length};

/// Bumpy surfaces that look at each other.
pub fn bumpy(shape: Shape, other: Shape, gap: f64, bumps: f64) -> Case {
    let mut slave = grid(shape, if shape.dim() == 2 { 9 } else { 5 }, [-1.0, 1.0], false);
    let random = scattered(3 * slave.x.len());
    for (x, w) in slave.x.iter_mut().zip(random.chunks(3)) {
        *x = plus(*x, 0.3 * bumps, [w[1], w[0], if shape.dim() == 2 { 0.0 } else { w[2] }]);
    }
    Case::new(raised(slave, gap), random_mesh(other, 4, bumps), 1.0)
}

#[test]
fn rows_do_no_work_in_a_motion_that_both_sides_share() {
    let mut most = 0.0f64;
    for ((shape, other), gap) in pairs().flat_map(|of| [0.0, 0.05, 0.5, -0.2].map(|gap| (of, gap))) {
        let mut case = bumpy(shape, other, gap, 0.2);
        // at the find, and later with points that are kept
        for by in [0.0, 0.1] {
            let way = wiggled(&case, by);
            case.slave.x.iter_mut().zip(&way[0]).for_each(|(x, w)| *x = plus(*x, 1.0, *w));
            case.master.x.iter_mut().zip(&way[1]).for_each(|(x, w)| *x = plus(*x, 1.0, *w));
            let spins: &[Vector] = match shape.dim() {
                2 => &[[0.0, 0.0, 1.0]],
                _ => &[[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.3, -0.5, 0.8]],
            };
            let all = case.rows();
            assert!(all.len() > case.slave.x.len() / 2);
            for (spin, (_, rows)) in spins.iter().flat_map(|spin| all.iter().map(move |of| (*spin, of))) {
                // an opening across the face has a gradient at later positions only by its frame
                for i in used(shape.dim()) {
                    let work =
                        product(rows, i, |k| cross(spin, case.slave.x[k]), |k| cross(spin, case.master.x[k]));
                    most = most.max(work.abs() / norm(rows, i));
                    assert!(
                        work.abs() <= 1e-13 * norm(rows, i),
                        "{shape:?} {other:?} {gap} {by}: {i} {work:e}"
                    );
                }
            }
        }
    }
    println!("{most:e}");
}

#[test]
fn rows_are_the_gradients_of_their_openings_at_fixed_points() {
    const H: f64 = 1e-5;
    for (shape, other) in pairs() {
        let mut case = bumpy(shape, other, 0.2, 0.2);
        let way = wiggled(&case, 1.0);
        let move_by = |case: &mut Case, h: f64| {
            case.slave.x.iter_mut().zip(&way[0]).for_each(|(x, w)| *x = plus(*x, h, *w));
            case.master.x.iter_mut().zip(&way[1]).for_each(|(x, w)| *x = plus(*x, h, *w));
        };
        for at in [0.0, 0.05] {
            move_by(&mut case, at);
            let here = case.rows();
            move_by(&mut case, H);
            let above = case.rows();
            move_by(&mut case, -2.0 * H);
            let below = case.rows();
            move_by(&mut case, H);
            for ((a, b), (_, rows)) in above.iter().zip(&below).zip(&here) {
                for i in used(shape.dim()) {
                    let slope = (a.1.opening[i] - b.1.opening[i]) / (2.0 * H);
                    let expected = product(rows, i, |k| way[0][k], |k| way[1][k]);
                    let size = norm(rows, i).max(1.0);
                    assert!(
                        (slope - expected).abs() < 1e-7 * size,
                        "{shape:?} {other:?} {at} {i}: {slope} {expected}"
                    );
                }
            }
        }
    }
}

/// Points of both sides lie on lines along n0: nothing opens along the face.
#[test]
fn at_the_find_openings_along_the_face_are_nothing() {
    for (shape, other) in pairs() {
        for (_, rows) in bumpy(shape, other, 0.3, 0.2).rows() {
            assert!((0..2).all(|i| rows.opening[i].abs() < 1e-12), "{:?}", rows.opening);
            let unit = |i: usize| length(rows.directions[i]);
            assert!(unit(0) <= 1.0 + 1e-15 && unit(2) <= 1.0 + 1e-15 && unit(2) > 0.5);
        }
    }
}
