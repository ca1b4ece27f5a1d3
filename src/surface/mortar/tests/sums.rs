//! Sums of rows and columns: constants are kept, and so are forces.

use super::*;
use crate::surface::mortar::polygon::Polygon;
use crate::surface::mortar::quadrature::{of_square, points, Rule};
use crate::surface::shape::Kind;
use crate::surface::vector::{cross, largest, length};

/// `int N_k dA` of all nodes, of flat faces.
fn consistent(of: &Mesh) -> Vec<f64> {
    let mut sums = vec![0.0; of.x.len()];
    for face in 0..of.faces.len() {
        let (patch, nodes) = (of.faces.patch(face, &of.x), of.faces.nodes_of(face));
        let mut all = Vec::new();
        let polygon = |of: &[[f64; 2]]| Polygon(of.to_vec());
        match patch.shape.kind() {
            Kind::Line => points(&polygon(&[[-1.0, 0.0], [1.0, 0.0]]), Rule::Three, |r, w| all.push((r, w))),
            Kind::Triangle => points(&polygon(patch.shape.corners()), Rule::Four, |r, w| all.push((r, w))),
            Kind::Square => all.extend(of_square()),
        }
        for (r, w) in all {
            let functions = patch.shape.at(r);
            let [a, b] = patch.tangents(&functions);
            nodes
                .iter()
                .zip(functions.n)
                .for_each(|(node, n)| sums[*node as usize] += w * n * length(cross(a, b)));
        }
    }
    sums
}

/// Largest difference of column sums and consistent forces of pressure 1 on the sides asked for, relative to the mean force.
fn worst(case: &Case, sides: &[usize]) -> f64 {
    let (sums, up) = (case.column_sums(), case.slave.faces.dim - 1);
    let meshes = [&case.slave, &case.master];
    let of_side = |side: &usize| {
        let forces = consistent(meshes[*side]);
        let mean = forces.iter().map(|f| f.abs()).sum::<f64>() / forces.len() as f64;
        let sign = if *side == 0 { 1.0 } else { -1.0 };
        let off = |(sum, force): (&Vector, &f64)| {
            let mut expected = ZERO;
            expected[up] = sign * force;
            largest(plus(*sum, -1.0, expected)) / mean
        };
        sums[*side].iter().zip(&forces).map(off).fold(0.0, f64::max)
    };
    sides.iter().map(of_side).fold(0.0, f64::max)
}

/// Largest sum of a row, each of its directions for itself: of the slave 1, of both sides 0.
fn row_sums(case: &Case) -> f64 {
    let mut worst = 0.0f64;
    for (_, rows) in case.rows() {
        for i in 0..3 {
            let sum = |of: &[(u32, [Vector; 3])]| of.iter().fold(ZERO, |sum, (_, of)| plus(sum, 1.0, of[i]));
            let (slave, master) = (sum(&rows.slave), sum(&rows.master));
            worst = worst.max(largest(plus(slave, 1.0, master))).max(largest(plus(
                slave,
                -1.0,
                rows.directions[i],
            )));
        }
    }
    worst
}

#[test]
fn forces_of_a_constant_pressure_are_consistent_on_both_sides() {
    for (shape, other) in pairs() {
        for (n, m) in [(3, 5), (5, 3)] {
            for by in [0.0, 0.2] {
                let of = |shape, n: usize, up| distorted(grid(shape, n, [-1.0, 1.0], up), by, 2.0 / n as f64);
                let case = Case::new(raised(of(shape, n, false), 0.1), of(other, m, true), 0.2);
                let is_affine =
                    by == 0.0 || [shape, other].iter().all(|of| !matches!(of.kind(), Kind::Square));
                let (columns, rows) = (worst(&case, &[0, 1]), row_sums(&case));
                if std::env::var("SHOW").is_ok() {
                    println!("{shape:?} {n} - {other:?} {m}, {by}: columns {columns:.1e}, rows {rows:.1e}");
                }
                assert!(
                    columns < if is_affine { 1e-13 } else { 1e-6 },
                    "{shape:?} {other:?} {by}: {columns:e}"
                );
                assert!(rows < 1e-13, "{shape:?} {other:?} {by}: {rows:e}");
                assert_eq!(case.rows().len(), case.slave.x.len());
            }
        }
    }
}

#[test]
fn overhanging_faces_and_slivers_leave_sums_and_gaps_as_they_are() {
    for (shape, other) in pairs() {
        for shift in [0.2, 0.07, 0.01, 1e-3, 1e-4, 1e-5, 1e-7, 1e-9, 1e-12, -1e-3, -1e-9] {
            for slave_is_larger in [false, true] {
                // the smaller one is covered; lines of both grids are `shift` apart
                let (small, large) = ([-1.0 + shift, 1.0 + shift], [-1.5, 1.5]);
                let (of_slave, of_master) = if slave_is_larger { (large, small) } else { (small, large) };
                let cells = |of: [f64; 2]| (2.0 * (of[1] - of[0])).round() as usize;
                let slave = raised(grid(shape, cells(of_slave), of_slave, false), 0.1);
                let case = Case::new(slave, grid(other, cells(of_master), of_master, true), 0.2);
                let side = usize::from(slave_is_larger);
                let (columns, rows) = (worst(&case, &[side]), row_sums(&case));
                let gaps =
                    case.rows().iter().map(|(_, rows)| (rows.opening[2] - 0.1).abs()).fold(0.0, f64::max);
                let entry = |(_, rows): &(u32, Rows)| {
                    let all = rows.slave.iter().chain(&rows.master);
                    all.map(|(_, of)| largest(of[2])).fold(0.0, f64::max)
                };
                let entries = case.rows().iter().map(entry).fold(0.0, f64::max);
                if std::env::var("SHOW").is_ok() {
                    println!(
                        "{shape:?} {other:?} {shift} {slave_is_larger}: {columns:.1e} {rows:.1e} {gaps:.1e} {entries:.1}"
                    );
                }
                assert!(
                    columns < 1e-13 && rows < 1e-13 && gaps < 1e-13,
                    "{shape:?} {other:?} {shift}: {columns:e} {rows:e} {gaps:e}"
                );
                assert!(case.mortar().areas().all(|area| area >= 0.0) && entries < 20.0, "{entries}");
            }
        }
    }
}
