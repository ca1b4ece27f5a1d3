//! Mortar with rigid obstacles, and what belongs to areas.

use super::*;
use crate::surface::tests::motions::{norm, product};
use crate::surface::tests::slips::rotated;
use crate::surface::vector::{cross, dot, length, minus, turned, unit};
use crate::surface::{areas, Rigid, RigidShape};

fn all() -> impl Iterator<Item = Shape> {
    PLANE.into_iter().chain(SPACE)
}

/// A surface and an obstacle that has moved since the beginning of the step.
fn rows(
    slave: &Mesh,
    begin_x: &[Vector],
    now: &Rigid,
    begin: &Rigid,
    distance: f64,
) -> (Mortar, Vec<(u32, Rows)>) {
    let of = Slave { faces: &slave.faces, x: &slave.x, begin: begin_x };
    let mortar = Mortar::find(1, &of, &Master::Rigid(now), &rule(distance), DEPTH).unwrap();
    let opposite = Opposite::Rigid { found: now, now, begin };
    let rows =
        slave.faces.used().filter_map(|node| Some((node, mortar.rows(&of, &opposite, node)?))).collect();
    (mortar, rows)
}

fn plane(dim: usize, point: Vector, normal: Vector) -> Rigid {
    Rigid::new(dim, RigidShape::Plane, &[&point[..dim], &normal[..dim]].concat()).unwrap()
}

#[test]
fn over_a_plane_areas_are_those_of_the_faces_and_gaps_the_height() {
    for shape in all() {
        let dim = shape.dim();
        let slave = raised(distorted(grid(shape, 4, [-1.0, 1.0], false), 0.2, 0.5), 0.1);
        let mut up = ZERO;
        up[dim - 1] = 1.0;
        let at = plane(dim, ZERO, up);
        let (mortar, rows) = rows(&slave, &slave.x, &at, &at, 0.2);
        let whole = areas(&slave.faces, &slave.x, DEPTH).unwrap();
        assert_eq!(rows.len(), slave.x.len());
        for (node, rows) in &rows {
            let area = whole[*node as usize];
            assert!((mortar.area(*node) - area).abs() < 1e-14, "{shape:?}: {} {area}", mortar.area(*node));
            assert!((rows.opening[2] - 0.1).abs() < 1e-14 && rows.master.is_empty() && rows.angle < 1e-14);
        }
        let (_, far) = self::rows(&slave, &slave.x, &at, &at, 0.05);
        assert!(far.is_empty());
    }
}

#[test]
fn rows_with_a_sphere_do_no_work_in_turns_about_its_centre() {
    for shape in all() {
        let dim = shape.dim();
        let mut slave = grid(shape, 5, [-0.5, 0.5], false);
        let radius = 2.0;
        for x in &mut slave.x {
            x[dim - 1] += 0.01 + radius - (radius * radius - dot(*x, *x)).sqrt();
        }
        let mut centre = ZERO;
        centre[dim - 1] = radius;
        let hole = Rigid::new(dim, RigidShape::Sphere, &[&centre[..dim], &[-radius]].concat()).unwrap();
        let (_, rows) = rows(&slave, &slave.x, &hole, &hole, 0.2);
        assert_eq!(rows.len(), slave.x.len());
        for (_, rows) in &rows {
            let spin = if dim == 2 { [0.0, 0.0, 1.0] } else { [0.3, 0.5, -0.8] };
            let u = |k: usize| cross(spin, minus(slave.x[k], centre));
            let work = product(rows, 2, u, |_| ZERO);
            assert!(work.abs() <= 1e-13 * norm(rows, 2), "{shape:?}: {work:e}");
            // chords of 0.2 or 0.1 have a sagitta of 1e-3
            assert!((rows.opening[2] - 0.01).abs() < 5e-3, "{:?}", rows.opening);
        }
    }
}

/// The plane turns by .5 rad, and the slave with it after a slip.
#[test]
fn a_plane_that_turns_takes_its_points_along() {
    for shape in all() {
        let (dim, flat) = (shape.dim(), shape.dim() == 2);
        let slave = raised(grid(shape, 4, [-1.0, 1.0], false), 0.3);
        let mut n = ZERO;
        n[dim - 1] = 1.0;
        let before = rotated(n, flat);
        let (begin, now) = (plane(dim, ZERO, before), plane(dim, ZERO, n));
        let slip = if flat { [0.05, 0.0, 0.0] } else { [0.05, -0.02, 0.0] };
        let begin_x: Vec<Vector> = slave.x.iter().map(|x| turned(minus(*x, slip), n, before)).collect();
        let (_, rows) = rows(&slave, &begin_x, &now, &begin, 0.5);
        assert!(!rows.is_empty());
        for (_, rows) in rows {
            for a in 0..dim - 1 {
                let s_old = rows.before[a] - rows.opening[a];
                assert!((s_old + dot(rows.directions[a], slip)).abs() < 1e-13, "{shape:?}");
            }
        }
    }
}

#[test]
fn areas_have_the_thickness_or_the_radius_in_them() {
    for shape in PLANE {
        let mut slave = grid(shape, 3, [1.0, 4.0], false);
        slave.x.iter_mut().for_each(|x| x[1] = 0.1 + 0.2 * x[0]);
        let mut master = grid(Shape::Line3, 4, [0.5, 4.5], true);
        master.x.iter_mut().for_each(|x| x[1] = 0.2 * x[0]);
        let of = Slave { faces: &slave.faces, x: &slave.x, begin: &slave.x };
        for axisymmetric in [false, true] {
            let depth = Depth { thickness: 2.0, axisymmetric };
            let whole = areas(&slave.faces, &slave.x, depth).unwrap();
            let normals = master.faces.normals(&master.x).unwrap();
            let placed = Placed { faces: &master.faces, x: &master.x, normals: &normals };
            let at = plane(2, ZERO, unit([-0.2, 1.0, 0.0]).unwrap());
            let found = Master::Faces(placed, Tree::new(&master.faces, &master.x).unwrap());
            for master in [found, Master::Rigid(&at)] {
                let mortar = Mortar::find(1, &of, &master, &rule(0.5), depth).unwrap();
                for node in slave.faces.used() {
                    let (area, expected) = (mortar.area(node), whole[node as usize]);
                    assert!((area - expected).abs() < 1e-13, "{shape:?}: {area} {expected}");
                }
            }
        }
    }
}

#[test]
fn the_angle_between_rows_and_the_masters_normal_is_known() {
    for (shape, other) in pairs() {
        let mut slave = raised(grid(shape, 3, [-0.5, 0.5], false), 0.2);
        slave.x.iter_mut().for_each(|x| x[shape.dim() - 1] += 0.3 * x[0]);
        let case = Case::new(slave, grid(other, 4, [-1.0, 1.0], true), 1.0);
        assert!(
            case.rows().iter().all(|(_, rows)| (rows.angle - 0.3f64.atan()).abs() < 1e-14),
            "{shape:?} {other:?}"
        );
        assert!(case.rows().iter().all(|(_, rows)| (length(rows.directions[2]) - 1.0).abs() < 1e-14));
    }
}
