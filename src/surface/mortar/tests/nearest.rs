//! Which parts of a master count, and in which order they are summed.

use super::*;
use crate::surface::Faces;

fn joined(shape: Shape, parts: Vec<Mesh>) -> Mesh {
    let x: Vec<Vector> = parts.iter().flat_map(|part| part.x.clone()).collect();
    let mut faces = Faces::new(shape.dim(), x.len()).unwrap();
    let mut first = 0;
    for part in parts {
        let nodes = (0..part.faces.len()).flat_map(|face| part.faces.nodes_of(face));
        let nodes: Vec<i64> = nodes.map(|node| i64::from(*node) + first).collect();
        faces.add(shape, &nodes, &x).unwrap();
        first += part.x.len() as i64;
    }
    Mesh { faces, x }
}

#[test]
fn of_two_thin_plates_in_one_master_the_nearer_one_counts() {
    for (shape, other) in pairs() {
        // the upper plate ends in the middle of faces of the slave: beyond its edge the lower one counts
        for end in [1.0, 0.13] {
            let lower = raised(grid(other, 5, [-1.0, 1.0], true), -0.05);
            let mut upper = grid(other, 4, [-1.0, 1.0], true);
            upper.x.iter_mut().for_each(|x| x[0] = if x[0] > 0.0 { end * x[0] } else { x[0] });
            straighten(&mut upper);
            let master = joined(other, vec![lower, upper]);
            let case = Case::new(raised(grid(shape, 3, [-1.0, 1.0], false), 0.01), master, 0.2);
            let area: f64 = case.mortar().areas().sum();
            assert!(
                (area - if shape.dim() == 2 { 2.0 } else { 4.0 }).abs() < 1e-13,
                "{shape:?} {other:?} {end}: {area}"
            );
            for (node, rows) in case.rows() {
                let gap = rows.opening[2];
                assert!(end < 1.0 || (gap - 0.01).abs() < 1e-14, "{shape:?} {other:?} {node}: {gap}");
            }
            let volume: f64 =
                case.rows().iter().map(|(node, rows)| case.mortar().area(*node) * rows.opening[2]).sum();
            let width = if shape.dim() == 2 { 1.0 } else { 2.0 };
            let expected = width * (2.0 * 0.01 + if end < 1.0 { (1.0 - end) * 0.05 } else { 0.0 });
            assert!((volume - expected).abs() < 1e-14, "{shape:?} {other:?}: {volume} {expected}");
        }
    }
}

#[test]
fn parts_side_by_side_count_both() {
    for (shape, other) in pairs() {
        let mut right = grid(other, 3, [0.0, 1.0], true);
        let mut left = grid(other, 2, [-1.0, 0.0], true);
        if shape.dim() == 3 {
            right.x.iter_mut().for_each(|x| x[1] = 2.0 * x[1] - 1.0);
            left.x.iter_mut().for_each(|x| x[1] = 2.0 * x[1] + 1.0);
        }
        let case = Case::new(
            raised(grid(shape, 3, [-1.0, 1.0], false), 0.01),
            joined(other, vec![left, right]),
            0.2,
        );
        let area: f64 = case.mortar().areas().sum();
        assert!((area - if shape.dim() == 2 { 2.0 } else { 4.0 }).abs() < 1e-13, "{area}");
    }
}

#[test]
fn faces_beyond_the_distance_and_faces_that_look_away_are_not_met() {
    for (shape, other) in pairs() {
        let met = |height: f64, up: bool| {
            let slave = raised(grid(shape, 3, [-1.0, 1.0], false), height);
            Case::new(slave, grid(other, 4, [-1.0, 1.0], up), 0.1).rows().len()
        };
        assert!(met(0.09, true) > 0 && met(-0.09, true) > 0);
        assert_eq!((met(0.11, true), met(-0.11, true), met(0.05, false)), (0, 0, 0));
    }
}

#[test]
fn finds_have_the_same_bits_again_and_on_two_threads() {
    for (shape, other) in pairs() {
        let made = |threads: usize| {
            let n = if shape.dim() == 2 { 300 } else { 18 };
            let slave = raised(distorted(grid(shape, n, [-1.0, 1.0], false), 0.2, 2.0 / n as f64), 0.01);
            let master = distorted(grid(other, 5, [-1.0, 1.0], true), 0.2, 0.4);
            Case::by(threads, slave, master, 0.1).rows()
        };
        let once = made(1);
        assert!(once == made(1) && once == made(2), "{shape:?} {other:?}");
    }
}

#[test]
fn a_find_ends_when_it_is_cancelled() {
    use crate::platform::Interrupt;
    use std::sync::atomic::AtomicBool;
    let slave = grid(Shape::Quad4, 20, [-1.0, 1.0], false);
    let at =
        crate::surface::Rigid::new(3, crate::surface::RigidShape::Plane, &[0.0, 0.0, 0.0, 0.0, 0.0, 1.0])
            .unwrap();
    let cancelled = Interrupt::new(std::sync::Arc::new(AtomicBool::new(true)));
    for threads in [1, 2] {
        let of = Slave { faces: &slave.faces, x: &slave.x, begin: &slave.x };
        let ended = cancelled.during(|| Mortar::find(threads, &of, &Master::Rigid(&at), &rule(0.1), DEPTH));
        assert_eq!(ended.unwrap_err().kind, crate::error::Kind::Cancelled);
    }
}

/// A factor of 2 is exact, another one is not.
#[test]
fn units_and_the_order_of_faces_do_not_matter() {
    for (shape, other) in pairs() {
        let surfaces = |by: f64, backwards: bool| {
            let scaled = |mut of: Mesh| {
                of.x.iter_mut().for_each(|x| *x = times(by, *x));
                of
            };
            let master = distorted(grid(other, 4, [-1.0, 1.0], true), 0.2, 0.5);
            let master = if backwards { turned_round(other, &master) } else { master };
            Case::new(scaled(raised(grid(shape, 5, [-1.0, 1.0], false), 0.02)), scaled(master), 0.1 * by)
        };
        let all = surfaces(1.0, false).rows();
        for (by, backwards) in
            [(0.5f64.powi(30), false), (2f64.powi(30), false), (1e-9, false), (1e9, false), (1.0, true)]
        {
            let others = surfaces(by, backwards).rows();
            let is_exact = by.log2().fract() == 0.0 && !backwards;
            assert_eq!(all.len(), others.len());
            for ((node, a), (_, b)) in all.iter().zip(&others) {
                let exact = a.slave == b.slave && a.master == b.master && by * a.opening[2] == b.opening[2];
                let at = |rows: &Rows, node: u32| {
                    rows.master.iter().find(|of| of.0 == node).map_or(0.0, |of| of.1[2][shape.dim() - 1])
                };
                let mut nodes = a.master.iter().chain(&b.master).map(|of| of.0);
                let close = (by * a.opening[2] - b.opening[2]).abs() < 1e-12 * by
                    && nodes.all(|node| (at(a, node) - at(b, node)).abs() < 1e-11);
                assert!(
                    if is_exact { exact } else { close },
                    "{shape:?} {other:?} {by} {backwards} {node}: {a:?} {b:?}"
                );
            }
        }
    }
}

/// The same nodes with the faces in the other order.
fn turned_round(shape: Shape, of: &Mesh) -> Mesh {
    let nodes = (0..of.faces.len()).rev().flat_map(|face| of.faces.nodes_of(face));
    let nodes: Vec<i64> = nodes.map(|node| i64::from(*node)).collect();
    let mut faces = Faces::new(shape.dim(), of.x.len()).unwrap();
    faces.add(shape, &nodes, &of.x).unwrap();
    Mesh { faces, x: of.x.clone() }
}

/// Dual functions and a gap of 0 leave rounding, which is no entry.
#[test]
fn rows_of_linear_faces_that_lie_on_each_other_have_one_node_of_the_slave() {
    for (shape, other) in pairs().filter(|(shape, _)| !shape.is_quadratic()) {
        let case = Case::new(grid(shape, 5, [-0.8, 0.8], false), grid(other, 4, [-1.0, 1.0], true), 0.1);
        for (node, rows) in case.rows() {
            assert!(
                rows.slave.len() == 1 && rows.slave[0].0 == node,
                "{shape:?} {other:?}: {:?}",
                rows.slave
            );
        }
    }
}
