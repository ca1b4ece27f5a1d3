//! Integrals over the covered part of one sub-face.

use crate::numbers::surface::{AFFINE, SPECK};
use crate::surface::areas::Depth;
use crate::surface::find::{Master, Rule as Belief};
use crate::surface::mortar::hats::{dual, Square};
use crate::surface::mortar::piece::Piece;
use crate::surface::mortar::polygon::Flat;
use crate::surface::mortar::quadrature::{self, Rule};
use crate::surface::mortar::segments::SubFace;
use crate::surface::patch::Patch;
use crate::surface::rigid::{Rigid, RigidFoot};
use crate::surface::rows::Slave;
use crate::surface::shape::{Functions, Shape, MOST};
use crate::surface::vector::{angle, dot, plus, times, Vector};

/// The piece of a sub-face, or those of its points on a rigid master.
pub fn pieces(
    slave: &Slave,
    face: usize,
    of: &[usize; 4],
    master: &Master,
    rule: &Belief,
    depth: Depth,
) -> Vec<Piece> {
    let Some(sub_face) = SubFace::new(slave.faces.patch(face, slave.x), *of) else { return Vec::new() };
    let sums = match master {
        Master::Rigid(rigid) => of_points(&sub_face, rigid, rule, depth),
        Master::Faces(placed, tree) => {
            let (mut sums, rule_for) = (Sums::default(), rules(&sub_face));
            for segment in sub_face.segments(placed, tree, rule) {
                let Some(seen) = segment.seen(&sub_face.plane) else { continue };
                let nodes = placed.faces.nodes_of(segment.face);
                let first = sums.master.len();
                sums.master.extend(nodes.iter().map(|node| (*node, [0.0; 4])));
                quadrature::points(&segment.polygon, rule_for(&segment.master), |z, w| {
                    let (Some((psi, n)), Some((_, m))) = (sub_face.at(z), seen.above(z)) else { return };
                    let weight = w * weight(&sub_face, z, depth);
                    sums.add(psi, &n, weight);
                    sums.master[first..].iter_mut().zip(m).for_each(|((_, sum), m)| {
                        (0..4).for_each(|j| sum[j] += weight * psi[j] * m);
                    });
                });
                sums.normal = plus(sums.normal, 1.0, segment.weighted_normal());
            }
            vec![sums]
        }
    };
    let c = dual_of(&sums, sub_face.count());
    let made = sums.into_iter().filter_map(|sums| sums.piece(slave, face, &sub_face, &c));
    made.collect()
}

fn weight(sub_face: &SubFace, z: Flat, depth: Depth) -> f64 {
    match (sub_face.patch.shape.dim(), depth.axisymmetric) {
        (3, _) => 1.0,
        (_, false) => depth.thickness,
        _ => depth.thickness * sub_face.plane.up(z)[0],
    }
}

/// Which points are exact where both faces are affine, by the degree of the product of hat function and shape function. Elsewhere none are,
/// and small triangles serve.
fn rules(slave: &SubFace) -> impl Fn(&Patch) -> Rule + '_ {
    let degree = |shape: Shape| match shape {
        Shape::Line2 | Shape::Tri3 => 1,
        Shape::Line3 | Shape::Tri6 | Shape::Quad4 => 2,
        Shape::Quad8 => 3,
        Shape::Quad9 => 4,
    };
    let hats = if slave.count() == 4 { 2 } else { 1 };
    let own = slave.patch.is_affine(AFFINE);
    move |master| match own && master.is_affine(AFFINE) {
        true if hats + degree(slave.patch.shape).max(degree(master.shape)) <= 4 => Rule::Three,
        true => Rule::Four,
        false => Rule::FourAround,
    }
}

/// The points of a sub-face on a rigid master, in which the rule believes by the point in the middle.
fn of_points(sub_face: &SubFace, rigid: &Rigid, rule: &Belief, depth: Depth) -> Vec<Sums> {
    let at = |z| {
        let (psi, n) = sub_face.at(z)?;
        let x = Functions::sum(&n, sub_face.patch.nodes());
        Some((psi, n, rigid.foot(x)?))
    };
    let Some((_, _, middle)) = at(sub_face.polygon.centroid()) else { return Vec::new() };
    let faces = dot(middle.normal, sub_face.plane.normal) <= rule.cosine.min(0.0);
    if !(faces && middle.gap.abs() <= rule.distance && middle.gap >= -rule.depth) {
        return Vec::new();
    }
    let point = |(z, w): (Flat, f64)| {
        let (psi, n, foot) = at(z)?;
        let mut sums =
            Sums { rigid: Some(foot), normal: times(-1.0, sub_face.plane.normal), ..Sums::default() };
        sums.add(psi, &n, w * weight(sub_face, z, depth));
        Some(sums)
    };
    sub_face.points().into_iter().filter_map(point).collect()
}

/// Integrals with the hat functions psi.
#[derive(Default)]
struct Sums {
    d: [f64; 4],
    m: Square,
    slave: [[f64; MOST]; 4],
    master: Vec<(u32, [f64; 4])>,
    rigid: Option<RigidFoot>,
    /// Of the master, weighted by areas.
    normal: Vector,
}

/// The coefficients of the dual functions over all points.
fn dual_of(all: &[Sums], count: usize) -> Square {
    let (mut d, mut m) = ([0.0; 4], [[0.0; 4]; 4]);
    for sums in all {
        for j in 0..4 {
            d[j] += sums.d[j];
            (0..4).for_each(|k| m[j][k] += sums.m[j][k]);
        }
    }
    dual(&d, &m, count)
}

impl Sums {
    fn add(&mut self, psi: [f64; 4], n: &[f64; MOST], weight: f64) {
        for j in 0..4 {
            let share = weight * psi[j];
            self.d[j] += share;
            (0..4).for_each(|k| self.m[j][k] += share * psi[k]);
            self.slave[j].iter_mut().zip(n).for_each(|(sum, n)| *sum += share * n);
        }
    }

    /// With the functions Phi = C psi.
    fn piece(mut self, slave: &Slave, face: usize, sub_face: &SubFace, c: &Square) -> Option<Piece> {
        if self.d == [0.0; 4] {
            return None;
        }
        let times_c = |of: [f64; 4]| c.map(|row| (0..4).map(|k| row[k] * of[k]).sum::<f64>());
        let area = times_c(self.d);
        // dual functions leave rounding at all nodes but one
        let of_node = |of: [f64; 4]| {
            let products = times_c(of);
            std::array::from_fn(|j| if products[j].abs() > SPECK * area[j].abs() { products[j] } else { 0.0 })
        };
        self.master.sort_by_key(|(node, _)| *node);
        let same = self.master.chunk_by(|a, b| a.0 == b.0).map(|same| {
            let sum = same.iter().fold([0.0; 4], |sum, (_, of)| std::array::from_fn(|j| sum[j] + of[j]));
            (same[0].0, of_node(sum))
        });
        let mut master: Vec<(u32, [f64; 4])> = same.filter(|(_, of)| *of != [0.0; 4]).collect();
        let of_slave: [[f64; 4]; MOST] = std::array::from_fn(|k| of_node(self.slave.map(|row| row[k])));
        // the sums of both sides are int Phi_j, to the digits that are left where functions cancel: constants have no gap
        let area: [f64; 4] = std::array::from_fn(|j| of_slave.iter().map(|of| of[j]).sum());
        for j in 0..4 {
            let of_master: f64 = master.iter().map(|(_, of)| of[j]).sum();
            if of_master != 0.0 {
                master.iter_mut().for_each(|(_, of)| of[j] *= area[j] / of_master);
            }
        }
        let n0 = sub_face.plane.normal;
        let nodes = slave.faces.nodes_of(face);
        let normal = self.rigid.map_or(n0, |foot| foot.normal);
        Some(Piece {
            face: face as u32,
            corners: sub_face.of.map(|k| k as u8),
            count: sub_face.count() as u8,
            area,
            slave: std::array::from_fn(|j| of_slave.map(|of| of[j])),
            along: sub_face.of.map(|k| slave.edge_across(nodes[k], normal).unwrap_or(nodes[k])),
            angle: angle(times(-1.0, n0), self.normal),
            master,
            rigid: self.rigid,
        })
    }
}
