//! Slips of a step with a large rotation.

use super::*;
use crate::surface::vector::{dot, minus, plus, turned, unit, ZERO};
use crate::surface::{Faces, Meeting, Opposite, Rigid, RigidShape, Shape, Slave};

/// Half a radian about (1, 2, -1), or in the plane about the origin.
pub fn rotated(x: Vector, flat: bool) -> Vector {
    let axis = if flat { [0.0, 0.0, 1.0] } else { unit([1.0, 2.0, -1.0]).unwrap() };
    let (from, _) = (crate::surface::vector::any_across(axis), 0);
    let to = plus(
        crate::surface::vector::times(0.5f64.cos(), from),
        0.5f64.sin(),
        crate::surface::vector::cross(axis, from),
    );
    turned(x, from, to)
}

/// Both sides turn by .5 rad, and the slave slips by a known vector before it: with a gap of .3, as shells have by their offset.
#[test]
fn a_known_slip_comes_out_of_a_step_with_half_a_radian() {
    for shape in Shape::ALL {
        let flat = shape.dim() == 2;
        let (begin_of_master, mut begin_of_slave) = (random_mesh(shape, 4, 0.3), random_mesh(shape, 5, 0.2));
        begin_of_slave.x.iter_mut().for_each(|x| x[shape.dim() - 1] += 0.3);
        let slip = if flat { [0.02, 0.05, 0.0] } else { [0.02, 0.05, -0.03] };
        let turn = |x: &[Vector], by: Vector| -> Vec<Vector> {
            x.iter().map(|x| plus([0.3, 0.2, 0.0], 1.0, rotated(plus(*x, 1.0, by), flat))).collect()
        };
        let master = Mesh { x: turn(&begin_of_master.x, ZERO), faces: begin_of_master.faces.clone() };
        let slave = Mesh { x: turn(&begin_of_slave.x, slip), faces: begin_of_slave.faces.clone() };
        let mut kept = vec![NONE; slave.x.len()];
        let found = found(&slave, &master, Rule { cosine: 2.0, ..rule(1.0) }, 1, &mut kept).unwrap();
        let normals = master.faces.normals(&master.x).unwrap();
        let placed = Placed { faces: &master.faces, x: &master.x, normals: &normals };
        let mut seen = 0;
        for (k, partner) in found.iter().enumerate() {
            let Some(partner) = partner else { continue };
            // once with t of the slave, once with t of the master, as nodes of a cloud have
            for faces in [&slave.faces, &Faces::new(shape.dim(), slave.x.len()).unwrap()] {
                let of_slave = Slave { faces, x: &slave.x, begin: &begin_of_slave.x };
                let opposite = Opposite::Faces(placed, &begin_of_master.x);
                let all =
                    Meeting::Feet(vec![Some(*partner)]).rows(&of_slave, &opposite, 0, k as u32).unwrap();
                for a in 0..shape.dim() - 1 {
                    let expected = -dot(all.directions[a], rotated(slip, flat));
                    let s_old = all.before[a] - all.opening[a];
                    assert!((s_old - expected).abs() < 1e-12, "{shape:?}: {s_old} {expected}");
                }
                seen += 1;
            }
        }
        assert!(seen > 10, "{shape:?}");
    }
}

#[test]
fn a_rigid_plane_that_turns_takes_its_points_along() {
    let normal = |x: Vector| rotated(x, false);
    let of = |p: Vector, n: Vector| Rigid::new(3, RigidShape::Plane, &[p, n].concat()).unwrap();
    let n = unit([0.1, 0.2, 1.0]).unwrap();
    let to = crate::surface::vector::turned(n, [0.0, 0.0, 1.0], normal([0.0, 0.0, 1.0]));
    let (begin, now) = (of([0.0; 3], n), of([0.5, 0.1, 0.2], to));
    let slip = [0.2, -0.1, 0.0];
    let slip = minus(slip, crate::surface::vector::times(dot(slip, n), n));
    let cloud = Faces::new(3, 1).unwrap();
    let before = plus([0.3, 0.4, 0.0], 0.7, n);
    let turned_now = plus([0.5, 0.1, 0.2], 1.0, turned(plus(before, 1.0, slip), n, to));
    let (x, begin_x) = ([turned_now], [before]);
    let mut kept = [NONE];
    let found = find(1, &Master::Rigid(&now), &rule(5.0), &[(x[0], ZERO)], &mut kept).unwrap()[0].unwrap();
    let of = Slave { faces: &cloud, x: &x, begin: &begin_x };
    let opposite = Opposite::Rigid { found: &now, now: &now, begin: &begin };
    let all = Meeting::Feet(vec![Some(found)]).rows(&of, &opposite, 0, 0).unwrap();
    for a in 0..2 {
        let s_old = all.before[a] - all.opening[a];
        assert!((s_old + dot(all.directions[a], turned(slip, n, to))).abs() < 1e-14);
    }
    assert!(all.master.is_empty() && all.slave == [(0, all.directions)]);
}
