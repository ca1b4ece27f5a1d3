//! Finds between whole surfaces: who meets whom, on which side, with which bits.

mod closed;
mod meshes;
pub mod motions;
pub mod slips;
mod speed;

pub use meshes::{cube, curve, mesh, pulled, random_mesh, Mesh};

use crate::error::Result;
use crate::surface::vector::Vector;
use crate::surface::{find, Master, Partner, Placed, Rule, Tree, NONE};

/// The default angle, 100 degrees.
pub const COSINE: f64 = -0.17364817766693033;

pub fn rule(distance: f64) -> Rule {
    Rule { distance, depth: distance, cosine: COSINE }
}

/// Partners of all nodes of the slave, with faces kept.
pub fn found(
    slave: &Mesh,
    master: &Mesh,
    rule: Rule,
    threads: usize,
    kept: &mut [u32],
) -> Result<Vec<Option<Partner>>> {
    let (normals, of_slave) = (master.faces.normals(&master.x)?, slave.faces.normals(&slave.x)?);
    let placed = Placed { faces: &master.faces, x: &master.x, normals: &normals };
    let nodes: Vec<(Vector, Vector)> = slave.x.iter().copied().zip(of_slave).collect();
    find(threads, &Master::Faces(placed, Tree::new(&master.faces, &master.x)?), &rule, &nodes, kept)
}

pub fn partners(slave: &Mesh, master: &Mesh, distance: f64) -> Vec<Option<Partner>> {
    found(slave, master, rule(distance), 1, &mut vec![NONE; slave.x.len()]).unwrap()
}
