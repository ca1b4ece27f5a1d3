//! The time of a find of 1e5 nodes and 1e5 faces, printed.

use std::time::Instant;

use super::*;
use crate::surface::Shape;

#[test]
#[ignore = "a measurement"]
fn a_find_of_100_000_nodes_and_faces() {
    for shape in [Shape::Quad4, Shape::Tri3, Shape::Quad8] {
        let side = |n: usize, up: f64| {
            let at = move |u: f64, v: f64| [u, v, up + 0.05 * (7.0 * u).sin() * (5.0 * v).cos()];
            mesh(shape, &[(n, n, &at)])
        };
        let (cells, nodes) = if shape == Shape::Tri3 {
            (223, 310)
        } else if shape == Shape::Quad8 {
            (316, 178)
        } else {
            (316, 310)
        };
        let (slave, master) = (side(nodes, 1e-4), side(cells, 0.0));
        for threads in [1, 2] {
            let begun = Instant::now();
            let mut kept = vec![NONE; slave.x.len()];
            let partners =
                found(&slave, &master, Rule { cosine: 2.0, ..rule(0.01) }, threads, &mut kept).unwrap();
            let first = begun.elapsed().as_secs_f64();
            let begun = Instant::now();
            found(&slave, &master, Rule { cosine: 2.0, ..rule(0.01) }, threads, &mut kept).unwrap();
            println!(
                "{shape:?}: {} nodes, {} faces, {} rows, {threads} threads: {first:.3} s, again {:.3} s",
                slave.x.len(),
                master.faces.len(),
                partners.iter().flatten().count(),
                begun.elapsed().as_secs_f64()
            );
        }
    }
}

#[test]
#[ignore = "a measurement"]
fn mortar_of_100_000_nodes_and_faces() {
    use crate::surface::{Depth, Mortar, Opposite, Slave};
    for shape in [Shape::Quad4, Shape::Tri3, Shape::Quad8] {
        let side = |n: usize, up: f64, turned: bool| {
            let at = move |u: f64, v: f64| {
                let (u, v) = if turned { (v, u) } else { (u, v) };
                [u, v, up + 0.05 * (7.0 * u).sin() * (5.0 * v).cos()]
            };
            mesh(shape, &[(n, n, &at)])
        };
        let (cells, nodes) = match shape {
            Shape::Tri3 => (223, 310),
            Shape::Quad8 => (316, 178),
            _ => (316, 310),
        };
        let (slave, master) = (side(nodes, 1e-4, true), side(cells, 0.0, false));
        let normals = master.faces.normals(&master.x).unwrap();
        let placed = Placed { faces: &master.faces, x: &master.x, normals: &normals };
        let of = Slave { faces: &slave.faces, x: &slave.x, begin: &slave.x };
        for threads in [1, 2] {
            let begun = Instant::now();
            let met = Master::Faces(placed, Tree::new(&master.faces, &master.x).unwrap());
            let depth = Depth { thickness: 1.0, axisymmetric: false };
            let mortar = Mortar::find(threads, &of, &met, &rule(0.01), depth).unwrap();
            let found = begun.elapsed().as_secs_f64();
            let begun = Instant::now();
            let opposite = Opposite::Faces(placed, &master.x);
            let rows = slave.faces.used().filter_map(|node| mortar.rows(&of, &opposite, node)).count();
            println!(
                "{shape:?}: {} nodes, {} faces, {rows} rows, {threads} threads: {found:.3} s, {:.0} MB, rows {:.3} s",
                slave.x.len(),
                master.faces.len(),
                mortar.bytes() as f64 / 1e6,
                begun.elapsed().as_secs_f64()
            );
        }
    }
}
