//! Surfaces for tests, from grids that are mapped into space; equal points are one node.

use std::collections::HashMap;

use crate::linalg::random::scattered;
use crate::surface::vector::{length, plus, times, Vector};
use crate::surface::{Faces, Shape};

pub struct Mesh {
    pub faces: Faces,
    pub x: Vec<Vector>,
}

/// A map of [0, 1]^2 whose tangents turn to the outside.
pub type Map<'a> = (usize, usize, &'a dyn Fn(f64, f64) -> Vector);

/// Faces of one shape on grids; of lines the first direction alone.
pub fn mesh(shape: Shape, maps: &[Map]) -> Mesh {
    let (mut known, mut x, mut nodes) = (HashMap::new(), Vec::new(), Vec::new());
    let mut add = |p: Vector| {
        let key = p.map(|v| (v * 1e7).round() as i64);
        nodes.push(*known.entry(key).or_insert_with(|| {
            x.push(p);
            x.len() as i64 - 1
        }));
    };
    for &(n, m, map) in maps {
        let m = if shape.dim() == 2 { 1 } else { m };
        for (i, j) in (0..n).flat_map(|i| (0..m).map(move |j| (i, j))) {
            let at = |u: f64, v: f64| map((i as f64 + u) / n as f64, (j as f64 + v) / m as f64);
            let places = (0..shape.nodes()).map(|k| shape.place(k));
            match shape {
                Shape::Tri3 | Shape::Tri6 => {
                    places.clone().for_each(|[r, s]| add(at(r + s, s)));
                    places.for_each(|[r, s]| add(at(r, r + s)));
                }
                Shape::Line2 | Shape::Line3 => places.for_each(|[r, _]| add(at(0.5 + 0.5 * r, 0.0))),
                _ => places.for_each(|[r, s]| add(at(0.5 + 0.5 * r, 0.5 + 0.5 * s))),
            }
        }
    }
    let mut faces = Faces::new(shape.dim(), x.len()).unwrap();
    faces.add(shape, &nodes, &x).unwrap();
    Mesh { faces, x }
}

/// A line of the plane, the body on its left; closed if its ends meet.
pub fn curve(shape: Shape, n: usize, map: impl Fn(f64) -> Vector) -> Mesh {
    mesh(shape, &[(n, 1, &|u, _| map(u))])
}

/// The six sides of a box with half lengths `h`, mapped by `to`; with `inside` the body is around it.
pub fn cube(shape: Shape, n: usize, h: Vector, inside: bool, to: impl Fn(Vector) -> Vector) -> Mesh {
    let side = |axis: usize, sign: f64| {
        let to = &to;
        move |u: f64, v: f64| {
            let (u, v) = if (sign < 0.0) != inside { (v, u) } else { (u, v) };
            let mut p = [0.0; 3];
            p[axis] = sign * h[axis];
            p[(axis + 1) % 3] = (2.0 * u - 1.0) * h[(axis + 1) % 3];
            p[(axis + 2) % 3] = (2.0 * v - 1.0) * h[(axis + 2) % 3];
            to(p)
        }
    };
    let sides: Vec<_> = (0..6).map(|k| side(k / 2, if k % 2 == 0 { 1.0 } else { -1.0 })).collect();
    let maps: Vec<Map> = sides.iter().map(|map| (n, n, map as &dyn Fn(f64, f64) -> Vector)).collect();
    mesh(shape, &maps)
}

/// The point at distance `radius` from the origin in this direction.
pub fn pulled(radius: f64) -> impl Fn(Vector) -> Vector {
    move |p| times(radius / length(p), p)
}

/// An open surface over [-1, 1]^2 (or [-1, 1]) at height 0 with random bumps of `by` of the size of a face, outward upwards.
pub fn random_mesh(shape: Shape, n: usize, by: f64) -> Mesh {
    let mut made = match shape.dim() {
        2 => curve(shape, n, |u| [1.0 - 2.0 * u, 0.0, 0.0]),
        _ => mesh(shape, &[(n, n, &|u, v| [2.0 * u - 1.0, 2.0 * v - 1.0, 0.0])]),
    };
    let random = scattered(3 * made.x.len());
    for (x, w) in made.x.iter_mut().zip(random.chunks(3)) {
        let moved = if shape.dim() == 2 { [w[0], w[1], 0.0] } else { [w[0], w[1], w[2]] };
        *x = plus(*x, by * 2.0 / n as f64, moved);
    }
    made
}
