//! Every slave node within the distance has one row, with the right sign.

use super::*;
use crate::linalg::random::scattered;
use crate::surface::vector::{dot, length, minus, plus, times, unit};
use crate::surface::{between_walls, Foot, Node, Shape};

const SPACE: [Shape; 5] = [Shape::Tri3, Shape::Tri6, Shape::Quad4, Shape::Quad8, Shape::Quad9];
const PLANE: [Shape; 2] = [Shape::Line2, Shape::Line3];

fn foot(partner: &Option<Partner>) -> Foot {
    match partner {
        Some(Partner::Face(foot)) => *foot,
        _ => panic!("a node has no partner"),
    }
}

#[test]
fn a_ball_in_a_hollow_sphere_meets_it_at_every_node() {
    for (shape, other) in SPACE.into_iter().zip(SPACE.into_iter().rev()) {
        let hole = cube(other, 6, [1.0; 3], true, pulled(1.1));
        for radius in [1.0, 1.2] {
            let ball = cube(shape, 7, [1.0; 3], false, pulled(radius));
            for (x, partner) in ball.x.iter().zip(partners(&ball, &hole, 0.3)) {
                let foot = foot(&partner);
                assert!((foot.gap - (1.1 - radius)).abs() < 0.03, "{shape:?} {other:?}: {foot:?}");
                assert!(dot(foot.normal, unit(*x).unwrap()) < -0.97);
            }
        }
    }
}

#[test]
fn a_pin_in_a_hole_meets_it_all_around() {
    const TURN: f64 = 2.0 * std::f64::consts::PI;
    for (shape, other) in PLANE.into_iter().flat_map(|a| PLANE.map(|b| (a, b))) {
        let circle = |shape, n, radius: f64, way: f64, shift: f64| {
            let at = |u: f64| [shift + radius * (way * TURN * u).cos(), radius * (way * TURN * u).sin(), 0.0];
            curve(shape, n, at)
        };
        // the body on the left: the pin counterclockwise, the hole clockwise
        let (pin, hole) = (circle(shape, 23, 1.0, 1.0, 0.04), circle(other, 31, 1.05, -1.0, 0.0));
        for (x, partner) in pin.x.iter().zip(partners(&pin, &hole, 0.2)) {
            let foot = foot(&partner);
            assert!((foot.gap - (1.05 - length(*x))).abs() < 0.01, "{shape:?}: {foot:?}");
            assert!(dot(foot.normal, unit(*x).unwrap()) < -0.98);
        }
    }
}

#[test]
fn a_box_around_a_cube_meets_its_sides_edges_and_corners() {
    for (shape, other) in SPACE.into_iter().zip(SPACE.into_iter().rev()) {
        let cube_ = cube(other, 4, [1.0; 3], false, |p| p);
        for h in [1.05, 0.97] {
            let around = cube(shape, 5, [h; 3], true, |p| p);
            for (x, partner) in around.x.iter().zip(partners(&around, &cube_, 0.2)) {
                let foot = foot(&partner);
                let out = x.map(|v| (v.abs() - 1.0).max(0.0));
                let expected = if h > 1.0 { length(out) } else { h - 1.0 };
                assert!((foot.gap - expected).abs() < 1e-14, "{shape:?} {other:?} {x:?}: {foot:?}");
                let y = minus(*x, times(foot.gap, foot.normal));
                assert!((crate::surface::vector::largest(y) - 1.0).abs() < 1e-14);
                assert!(h < 1.0 || length(minus(y, x.map(|v| v.clamp(-1.0, 1.0)))) < 1e-14);
            }
        }
    }
}

/// The side of the block is no partner of the die: its normal is across that of the die.
#[test]
fn a_die_over_an_edge_of_a_block_meets_the_top_and_the_edge() {
    for shape in SPACE {
        let block = cube(shape, 4, [1.0; 3], false, |p| p);
        for height in [1.02, 0.98] {
            let die = mesh(shape, &[(8, 8, &|u, v| [3.0 * v, 2.0 * u - 1.0, height])]);
            for (x, partner) in die.x.iter().zip(partners(&die, &block, 0.5)) {
                let over = (x[0] - 1.0).max(0.0);
                if over < 1e-9 {
                    let foot = foot(&partner);
                    assert!(
                        (foot.gap - (height - 1.0)).abs() < 1e-14 && foot.normal[2] > 0.999_999,
                        "{foot:?}"
                    );
                } else if let Some(Partner::Face(foot)) = partner {
                    // beyond the edge: only upwards from it
                    let expected = [over, 0.0, height - 1.0];
                    assert!(height > 1.0 && foot.normal[2] > 0.17, "{x:?} {foot:?}");
                    assert!(length(minus(times(foot.gap, foot.normal), expected)) < 1e-14);
                }
            }
        }
    }
}

#[test]
fn the_middle_of_three_stacked_slabs_meets_the_upper_and_the_lower_one() {
    for shape in SPACE {
        let slab = |n: usize, z: f64| {
            move |shape| cube(shape, n, [1.0, 1.0, 0.1], false, move |p| plus(p, z, [0.0, 0.0, 1.0]))
        };
        let middle = slab(5, 0.0)(shape);
        let gap = |side: f64| if side > 0.0 { 0.03 } else { -0.02 };
        let (upper, lower) = (slab(4, 0.2 + gap(1.0)), slab(6, -0.2 - gap(-1.0)));
        let (upper, lower) = (upper(shape), lower(shape));
        let both = joined(shape, &[upper, lower]);
        for (x, partner) in middle.x.iter().zip(partners(&middle, &both, 0.05)) {
            if x[2].abs() < 0.1 - 1e-9 {
                continue; // the sides look at nothing
            }
            let foot = foot(&partner);
            let side = x[2].signum();
            assert!((foot.gap - gap(side)).abs() < 1e-14, "{shape:?} {x:?} {foot:?}");
            assert!(foot.normal[2] * side < -0.999_999);
        }
    }
}

/// All faces in one surface.
fn joined(shape: Shape, parts: &[Mesh]) -> Mesh {
    let x: Vec<Vector> = parts.iter().flat_map(|part| part.x.clone()).collect();
    let mut faces = crate::surface::Faces::new(3, x.len()).unwrap();
    let mut first = 0;
    for part in parts {
        let nodes = (0..part.faces.len()).flat_map(|face| part.faces.nodes_of(face));
        let nodes: Vec<i64> = nodes.map(|&node| i64::from(node) + first).collect();
        faces.add(shape, &nodes, &x).unwrap();
        first += part.x.len() as i64;
    }
    Mesh { faces, x }
}

/// Independent of the tree: the nearest of all feet.
#[test]
fn the_partner_is_the_nearest_of_all_faces() {
    for shape in Shape::ALL {
        let master = random_mesh(shape, 6, 0.3);
        let normals = master.faces.normals(&master.x).unwrap();
        let placed = Placed { faces: &master.faces, x: &master.x, normals: &normals };
        let tree = Tree::new(&master.faces, &master.x).unwrap();
        let master_ = Master::Faces(placed, tree);
        for w in scattered(3 * 2000).chunks(3) {
            let x = [
                2.4 * w[0],
                if shape.dim() == 2 { w[2] } else { 2.4 * w[1] },
                if shape.dim() == 2 { 0.0 } else { w[2] },
            ];
            let best = (0..master.faces.len())
                .filter_map(|face| placed.foot(face, &Node { x, normal: [0.0; 3], cosine: COSINE }));
            let best = best
                .filter(|foot| foot.distance <= 0.4)
                .map(|foot| foot.distance)
                .fold(f64::INFINITY, f64::min);
            let found =
                find(1, &master_, &rule(0.4), &[(x, crate::surface::vector::ZERO)], &mut [NONE]).unwrap()[0];
            match found {
                Some(Partner::Face(foot)) => {
                    assert!(foot.distance <= best * (1.0 + 1e-9) + 1e-14, "{shape:?}")
                }
                _ => assert!(best == f64::INFINITY, "{shape:?} {x:?}: {best}"),
            }
        }
    }
}

#[test]
fn a_rim_is_continued_by_a_twentieth_of_its_edge_and_no_further() {
    for shape in Shape::ALL {
        let plate = random_mesh(shape, 4, 0.0);
        let normals = plate.faces.normals(&plate.x).unwrap();
        let placed = Placed { faces: &plate.faces, x: &plate.x, normals: &normals };
        let up = |x: f64, y: f64, z: f64| if shape.dim() == 2 { [x, z, 0.0] } else { [x, y, z] };
        let master = Master::Faces(placed, Tree::new(&plate.faces, &plate.x).unwrap());
        // edges have the length 1/2; at corners, and where an edge inside the surface ends, too, where triangles reach a little further
        let further = if matches!(shape, Shape::Tri3 | Shape::Tri6) { 0.06 } else { 0.026 };
        for (out, y) in [0.0, 0.13, 0.5, 1.0].into_iter().flat_map(|y| [(0.024, y), (further, y), (0.1, y)]) {
            for z in [0.3, 1e-12, -0.1] {
                let x = up(1.0 + out, if y == 1.0 { 1.0 + out } else { y }, z);
                let down = times(-1.0, up(0.0, 0.0, 1.0));
                let found = find(1, &master, &rule(0.5), &[(x, down)], &mut [NONE]).unwrap()[0];
                match found {
                    Some(Partner::Face(foot)) => {
                        assert!(out < 0.025, "{shape:?} {x:?}");
                        assert!(
                            (foot.gap - z).abs() < 1e-15 && length(plus(foot.normal, 1.0, down)) < 1e-14,
                            "{shape:?} {x:?} {foot:?}"
                        );
                    }
                    _ => assert!(out > 0.025, "{shape:?} {x:?}"),
                }
            }
        }
    }
}

#[test]
fn a_node_keeps_its_face_a_little_beyond_the_edge_until_a_new_step() {
    for shape in Shape::ALL {
        // a roof with its ridge at x = 0
        let roof = |x: f64| -0.5 * x.abs();
        let mut master = random_mesh(shape, 4, 0.0);
        let z = shape.dim() - 1;
        master.x.iter_mut().for_each(|x| x[z] = roof(x[0]));
        let normals = master.faces.normals(&master.x).unwrap();
        let placed = Placed { faces: &master.faces, x: &master.x, normals: &normals };
        let all = Master::Faces(placed, Tree::new(&master.faces, &master.x).unwrap());
        let mut kept = [NONE];
        let at = |x: f64, kept: &mut [u32; 1]| {
            let mut p = [x, 0.1, 0.0];
            p[z] = roof(x);
            match find(1, &all, &rule(0.5), &[(p, crate::surface::vector::ZERO)], kept).unwrap()[0] {
                Some(Partner::Face(foot)) => foot,
                _ => panic!("no partner"),
            }
        };
        let left = at(-0.1, &mut kept);
        assert!(left.is_inside && left.normal[0] < -0.4);
        let edge = (0.25f64 + 0.0625).sqrt();
        let beyond = at(0.015 * edge, &mut kept);
        assert!(beyond.is_inside && beyond.face == left.face && beyond.gap < 0.0, "{shape:?} {beyond:?}");
        assert_eq!(at(0.015 * edge, &mut kept), beyond, "a second find differs");
        assert!(at(0.015 * edge, &mut [NONE]).normal[0] > 0.4, "a new step");
        assert!(at(0.05 * edge, &mut kept).normal[0] > 0.4);
    }
}

#[test]
fn a_deep_node_and_one_that_looks_away_have_no_partner() {
    let plate = random_mesh(Shape::Quad4, 3, 0.0);
    let normals = plate.faces.normals(&plate.x).unwrap();
    let placed = Placed { faces: &plate.faces, x: &plate.x, normals: &normals };
    let master = Master::Faces(placed, Tree::new(&plate.faces, &plate.x).unwrap());
    let has = |z: f64, normal: Vector, depth: f64| {
        let rule = Rule { depth, ..rule(0.5) };
        find(1, &master, &rule, &[([0.1, 0.2, z], normal)], &mut [NONE]).unwrap()[0].is_some()
    };
    let down = [0.0, 0.0, -1.0];
    assert!(has(0.4, down, 0.5) && has(-0.4, down, 0.5) && has(-0.4, [0.0; 3], 0.5));
    assert!(!has(-0.4, down, 0.3) && !has(0.6, down, 0.5));
    assert!(!has(0.4, [0.0, 0.0, 1.0], 0.5) && !has(0.4, [1.0, 0.0, -0.1], 0.5));
}

#[test]
fn finds_have_the_same_bits_again_and_on_two_threads() {
    for shape in Shape::ALL {
        let (mut slave, master) = (random_mesh(shape, 30, 0.2), random_mesh(shape, 27, 0.4));
        let up = shape.dim() - 1;
        slave.x.iter_mut().for_each(|x| x[up] += 0.01);
        let rule = Rule { cosine: 2.0, ..rule(0.1) };
        let mut kept = vec![NONE; slave.x.len()];
        let once = found(&slave, &master, rule, 1, &mut kept).unwrap();
        let first = kept.clone();
        let again = found(&slave, &master, rule, 2, &mut kept).unwrap();
        assert!(once == again && kept == first, "{shape:?}");
        assert!(once.iter().flatten().count() > slave.x.len() / 2);
        assert!(kept.iter().filter(|kept| **kept != NONE).count() > slave.x.len() / 4);
    }
}

#[test]
fn a_find_ends_when_it_is_cancelled() {
    use crate::platform::Interrupt;
    use std::sync::atomic::AtomicBool;
    let plate = random_mesh(Shape::Quad4, 30, 0.1);
    let cancelled = Interrupt::new(std::sync::Arc::new(AtomicBool::new(true)));
    for threads in [1, 2] {
        let mut kept = vec![NONE; plate.x.len()];
        let ended = cancelled.during(|| found(&plate, &plate, rule(0.1), threads, &mut kept));
        assert_eq!(ended.unwrap_err().kind, crate::error::Kind::Cancelled);
        assert!(kept.iter().all(|kept| *kept == NONE));
    }
}

/// A factor of 2 is exact, another one is not.
#[test]
fn units_and_the_order_of_faces_do_not_matter() {
    for shape in Shape::ALL {
        let (mut slave, master) = (random_mesh(shape, 12, 0.2), random_mesh(shape, 9, 0.3));
        slave.x.iter_mut().for_each(|x| x[shape.dim() - 1] += 0.02);
        let all = partners_of(&slave, &master, 1.0);
        let scaled = |mesh: &Mesh, by: f64| Mesh {
            x: mesh.x.iter().map(|x| times(by, *x)).collect(),
            faces: mesh.faces.clone(),
        };
        for by in [(0.5f64).powi(30), 2f64.powi(30), 1e-9, 1e9] {
            let other = partners_of(&scaled(&slave, by), &scaled(&master, by), by);
            let is_exact = by.log2().fract() == 0.0;
            for (a, b) in all.iter().zip(&other) {
                let (Some(Partner::Face(a)), Some(Partner::Face(b))) = (a, b) else {
                    assert!(a.is_none() && b.is_none());
                    continue;
                };
                let exact = (a.face, a.r, a.normal, by * a.gap) == (b.face, b.r, b.normal, b.gap);
                let close =
                    (by * a.gap - b.gap).abs() < 1e-14 * by && length(minus(a.normal, b.normal)) < 1e-11;
                assert!(if is_exact { exact } else { close }, "{shape:?} {by}: {a:?} {b:?}");
            }
        }
        let faces: Vec<i64> = (0..master.faces.len())
            .rev()
            .flat_map(|face| master.faces.nodes_of(face))
            .map(|k| i64::from(*k))
            .collect();
        let mut backwards = Mesh {
            x: master.x.clone(),
            faces: crate::surface::Faces::new(shape.dim(), master.x.len()).unwrap(),
        };
        backwards.faces.add(shape, &faces, &master.x).unwrap();
        for (a, b) in all.iter().zip(&partners_of(&slave, &backwards, 1.0)) {
            let (Some(Partner::Face(a)), Some(Partner::Face(b))) = (a, b) else {
                assert!(a.is_none() && b.is_none());
                continue;
            };
            assert!(
                (a.gap - b.gap).abs() < 1e-14 && length(minus(a.normal, b.normal)) < 1e-11,
                "{shape:?}: {a:?} {b:?}"
            );
        }
    }
}

fn partners_of(slave: &Mesh, master: &Mesh, unit: f64) -> Vec<Option<Partner>> {
    let rule = Rule { cosine: 2.0, ..rule(0.2 * unit) };
    found(slave, master, rule, 1, &mut vec![NONE; slave.x.len()]).unwrap()
}

#[test]
fn nodes_between_two_walls_of_one_surface_are_found() {
    for shape in SPACE {
        // a groove of 90 degrees with its bottom along y
        let mut groove = random_mesh(shape, 6, 0.0);
        groove.x.iter_mut().for_each(|x| x[2] = x[0].abs());
        let normals = groove.faces.normals(&groove.x).unwrap();
        let placed = Placed { faces: &groove.faces, x: &groove.x, normals: &normals };
        let down = [0.0, 0.0, -1.0];
        let nodes = [([0.05, 0.1, 0.2], down), ([0.7, 0.1, 0.75], down)];
        let (rule, mut kept) = (rule(0.3), [NONE; 2]);
        let master = Master::Faces(placed, Tree::new(&groove.faces, &groove.x).unwrap());
        let partners = find(1, &master, &rule, &nodes, &mut kept).unwrap();
        let tree = Tree::new(&groove.faces, &groove.x).unwrap();
        assert_eq!(
            between_walls(2, &placed, &tree, &rule, &nodes, &partners).unwrap(),
            [true, false],
            "{shape:?}"
        );
    }
}
