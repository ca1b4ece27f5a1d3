//! Every wrong order of each shape is refused; meshes that are curved, graded, warped or distorted are not.

use super::*;
use crate::linalg::random::scattered;
use crate::surface::tests::{cube, curve, mesh, pulled};
use crate::surface::{Faces, Shape};

const QUADRATIC: [Shape; 4] = [Shape::Line3, Shape::Tri6, Shape::Quad8, Shape::Quad9];
/// Half the angle of an arc of 60 degrees, radian.
const HALF: f64 = std::f64::consts::PI / 6.0;

/// The nodes of one face, the parent mapped by `to`.
fn nodes(shape: Shape, to: impl Fn(f64, f64) -> Vector) -> Vec<Vector> {
    (0..shape.nodes()).map(|k| shape.place(k)).map(|[r, s]| to(r, s)).collect()
}

fn added(shape: Shape, x: &[Vector], order: &[i64]) -> Result<usize> {
    Faces::new(shape.dim(), x.len()).unwrap().add(shape, order, x)
}

fn is_refused(shape: Shape, x: &[Vector], order: &[i64]) -> bool {
    added(shape, x, order).is_err()
}

fn straight(r: f64, s: f64) -> Vector {
    [r, s, 0.0]
}

fn skew(r: f64, s: f64) -> Vector {
    [r + 0.5 * s, 0.8 * s, 0.0]
}

/// Arcs of 60 degrees in both directions of a square, one of 30 on lines and triangles; outward or, with -1, inward.
fn bent(sign: f64) -> impl Fn(f64, f64) -> Vector {
    move |r, s| [(HALF * r).sin(), (HALF * s).sin(), sign * ((HALF * r).cos() + (HALF * s).cos())]
}

fn arc(sign: f64) -> impl Fn(f64, f64) -> Vector {
    move |r, _| [(HALF * r).sin(), sign * (HALF * r).cos(), 0.0]
}

/// Orders that other programs have, or that a slip makes.
fn wrong_orders(shape: Shape) -> Vec<Vec<i64>> {
    match shape {
        Shape::Line3 => vec![vec![0, 2, 1], vec![2, 0, 1], vec![1, 2, 0]],
        Shape::Quad4 => vec![vec![0, 1, 3, 2], vec![0, 2, 1, 3], vec![1, 0, 2, 3]],
        Shape::Tri6 => vec![
            vec![0, 3, 1, 4, 2, 5],
            vec![0, 1, 2, 4, 5, 3],
            vec![0, 1, 2, 5, 3, 4],
            vec![3, 4, 5, 0, 1, 2],
            vec![0, 3, 1, 5, 4, 2],
        ],
        Shape::Quad8 | Shape::Quad9 => {
            let orders = [
                [0, 4, 1, 5, 2, 6, 3, 7],
                [0, 1, 2, 3, 5, 6, 7, 4],
                [0, 1, 2, 3, 7, 4, 5, 6],
                [0, 1, 2, 3, 6, 7, 4, 5],
                [0, 1, 2, 3, 4, 7, 5, 6],
                [0, 1, 3, 2, 4, 5, 6, 7],
                [0, 1, 3, 2, 4, 7, 5, 6],
                [4, 5, 6, 7, 0, 1, 2, 3],
                [0, 4, 1, 7, 5, 3, 6, 2],
            ];
            let mut orders = orders.map(Vec::from).to_vec();
            if shape == Shape::Quad9 {
                orders.iter_mut().for_each(|order| order.push(8));
                orders.push(vec![0, 4, 1, 7, 8, 5, 3, 6, 2]);
                orders.push(vec![8, 0, 1, 2, 3, 4, 5, 6, 7]);
            }
            orders
        }
        _ => Vec::new(),
    }
}

#[test]
fn every_wrong_order_is_refused_on_straight_skew_and_curved_faces() {
    for shape in Shape::ALL {
        let right: Vec<i64> = (0..shape.nodes() as i64).collect();
        let forms = match shape.dim() {
            2 => vec![nodes(shape, |r, _| [r, 0.0, 0.0]), nodes(shape, arc(1.0)), nodes(shape, arc(-1.0))],
            _ => vec![
                nodes(shape, straight),
                nodes(shape, skew),
                nodes(shape, bent(1.0)),
                nodes(shape, bent(-1.0)),
            ],
        };
        for (form, x) in forms.iter().enumerate() {
            assert!(!is_refused(shape, x, &right), "{shape:?}, form {form}");
            for order in wrong_orders(shape) {
                assert!(is_refused(shape, x, &order), "{shape:?}, form {form}: {order:?}");
            }
        }
    }
}

#[test]
fn mid_nodes_one_place_on_are_refused_on_every_triangle_and_convex_quadrilateral() {
    for w in scattered(8 * 500).chunks(8) {
        let triangle = |r: f64, s: f64| [r + s * w[0], s * (1.05 + w[1]), 0.0];
        let square = |r: f64, s: f64| {
            let by = |k: usize| 0.4 * (1.0 + [-r, r][k % 2]) * (1.0 + [-s, s][k / 2]);
            let moved = |i: usize| (0..4).map(|k| by(k) * 0.5 * w[2 * k + i]).sum::<f64>();
            [r + moved(0), s + moved(1), 0.0]
        };
        for (shape, x, corners) in [
            (Shape::Tri6, nodes(Shape::Tri6, triangle), 3),
            (Shape::Quad8, nodes(Shape::Quad8, square), 4),
            (Shape::Quad9, nodes(Shape::Quad9, square), 4),
        ] {
            let mut order: Vec<i64> = (0..shape.nodes() as i64).collect();
            assert!(added(shape, &x, &order).is_ok(), "{shape:?} {w:?}");
            for _ in 1..corners {
                order[corners..2 * corners].rotate_left(1);
                assert!(is_refused(shape, &x, &order), "{shape:?} {w:?}: {order:?}");
            }
        }
    }
}

#[test]
fn a_refusal_names_face_and_nodes_in_the_counting_of_the_call() {
    let x = nodes(Shape::Quad8, straight);
    let said = |order: &[i64]| added(Shape::Quad8, &x, order).unwrap_err().index_from(1).to_string();
    assert_eq!(
        said(&[0, 1, 2, 3, 5, 6, 7, 4]),
        "face 0: node 6 is not near the middle of the edge of nodes 1 and 2: 0.71 of its length away; the order is corners, then \
         mid nodes of edges, then the centre, as in VTK"
    );
    assert_eq!(
        said(&[0, 1, 3, 2, 4, 5, 6, 7]),
        "face 0: the corners of the face cross: its edges go from node 1 to 2, 4, 3 and back"
    );
}

#[test]
fn curved_faces_are_in_order() {
    for shape in QUADRATIC {
        for closed in [3, 6, 12] {
            if shape.dim() == 2 {
                curve(shape, closed, |u| {
                    let turn = 2.0 * std::f64::consts::PI * u;
                    [turn.cos(), turn.sin(), 0.0]
                });
            }
        }
        if shape.dim() == 3 {
            for n in 1..4 {
                cube(shape, n, [1.0; 3], false, pulled(1.0));
                cube(shape, n, [1.0; 3], true, pulled(1.0));
            }
        }
    }
}

#[test]
fn quarter_points_are_in_order() {
    // nodes at (1 + r)^2 / 4 of an edge that begins at a crack
    let quarter = |r: f64| 0.5 * (1.0 + r) * (1.0 + r) - 1.0;
    let toward_corner = |r: f64, s: f64| skew(quarter(r), quarter(s));
    let toward_edge = |r: f64, s: f64| bent(1.0)(quarter(r), s);
    for shape in [Shape::Quad8, Shape::Quad9] {
        let right: Vec<i64> = (0..shape.nodes() as i64).collect();
        for x in [nodes(shape, toward_corner), nodes(shape, toward_edge)] {
            assert!(added(shape, &x, &right).is_ok(), "{shape:?}");
        }
    }
    for tip in [-1.0, 1.0] {
        let x = nodes(Shape::Line3, |r, _| arc(1.0)(tip * quarter(tip * r), 0.0));
        assert!(added(Shape::Line3, &x, &[0, 1, 2]).is_ok());
    }
    // the crack at the first corner, whose two edges have their nodes at a quarter
    let mut x = nodes(Shape::Tri6, |r, s| [r + 0.9 * s, 0.3 * s, 0.0]);
    (x[3], x[5]) = (times(0.25, x[1]), times(0.25, x[2]));
    assert!(added(Shape::Tri6, &x, &[0, 1, 2, 3, 4, 5]).is_ok());
}

#[test]
fn warped_folded_and_distorted_faces_are_in_order() {
    for shape in [Shape::Quad4, Shape::Quad8, Shape::Quad9] {
        let right: Vec<i64> = (0..shape.nodes() as i64).collect();
        let folded = |angle: f64| {
            move |r: f64, s: f64| [r - s, (r + s) * angle.cos(), (r + s).abs() * angle.sin()].map(|x| 0.5 * x)
        };
        for height in [0.5, 2.0] {
            let twisted = nodes(shape, |r, s| [r, s, height * r * s]);
            assert!(added(shape, &twisted, &right).is_ok(), "{shape:?} {height}");
        }
        if shape == Shape::Quad4 {
            for degrees in [30.0f64, 60.0, 80.0] {
                let x = nodes(shape, folded(degrees.to_radians()));
                assert!(added(shape, &x, &right).is_ok(), "{degrees}");
            }
        }
    }
    // three corners on a line, a re-entrant corner, and two corners in one place
    for third in [[1.0, 1.0, 0.0], [0.9, 0.9, 0.0], [2.0, 0.0, 0.0]] {
        let x = [[0.0; 3], [2.0, 0.0, 0.0], third, [0.0, 2.0, 0.0]];
        assert!(added(Shape::Quad4, &x, &[0, 1, 2, 3]).is_ok(), "{third:?}");
    }
    // nodes of a grid moved by 30 % of the distance between corners
    for shape in Shape::ALL {
        let made =
            mesh(shape, &[(4, 4, &|u, v| [4.0 * u, if shape.dim() == 2 { 0.0 } else { 4.0 * v }, 0.0])]);
        let faces: Vec<i64> =
            (0..made.faces.len()).flat_map(|f| made.faces.nodes_of(f)).map(|n| i64::from(*n)).collect();
        let corners = shape.corners().len();
        for w in scattered(20 * 3 * made.x.len()).chunks(3 * made.x.len()) {
            let mut x = made.x.clone();
            let mut is_corner = vec![false; x.len()];
            for face in faces.chunks(shape.nodes()) {
                face[..corners].iter().for_each(|&n| is_corner[n as usize] = true);
            }
            for (n, x) in x.iter_mut().enumerate().filter(|(n, _)| is_corner[*n]) {
                *x = plus(
                    *x,
                    0.6,
                    [w[3 * n], if shape.dim() == 2 { 0.0 } else { w[3 * n + 1] }, w[3 * n + 2]],
                );
            }
            // mid nodes go with their corners
            for face in faces.chunks(shape.nodes()).filter(|_| shape.is_quadratic()) {
                let at = |k: usize| x[face[k] as usize];
                let edges = if shape.dim() == 2 { 1 } else { corners };
                let mids: Vec<_> =
                    (0..edges).map(|k| times(0.5, plus(at(k), 1.0, at((k + 1) % corners)))).collect();
                mids.iter().enumerate().for_each(|(k, mid)| x[face[corners + k] as usize] = *mid);
            }
            assert!(added(shape, &x, &faces).is_ok(), "{shape:?}");
        }
    }
}
