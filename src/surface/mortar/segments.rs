//! Segments: the parts of a slave's sub-face that single sub-faces of the master cover, seen along the slave's normal.

use crate::numbers::surface::{EDGE_ON, SPECK};
use crate::surface::find::Rule;
use crate::surface::foot::Placed;
use crate::surface::mortar::plane::{Plane, Seen};
use crate::surface::mortar::polygon::{Flat, Polygon};
use crate::surface::mortar::quadrature::{self, of_square, points};
use crate::surface::patch::Patch;
use crate::surface::shape::{Parent, Shape, MOST};
use crate::surface::tree::Tree;
use crate::surface::vector::{dot, times, Vector};

/// A straight sub-face of the slave, with the face on which its points lie.
pub struct SubFace {
    pub patch: Patch,
    /// Local numbers of its corners, and their positions.
    pub of: [usize; 4],
    pub corners: [Vector; 4],
    pub plane: Plane,
    pub polygon: Polygon,
    pub area: f64,
    /// The sub-face itself and the face, along the normal; one of both where they are the same.
    straight: Seen,
    curved: Option<Seen>,
}

/// What one sub-face of the master covers.
pub struct Segment {
    pub face: usize,
    pub polygon: Polygon,
    pub area: f64,
    /// Along the slave's normal at its centroid, length.
    pub gap: f64,
    /// Outward normal of the master there.
    pub normal: Vector,
    pub master: Patch,
    /// The point there.
    middle: Parent,
}

/// The parent's point in the middle of a sub-face.
fn middle(shape: Shape, of: &[usize; 4]) -> Parent {
    // triangles and lines repeat their last corner
    let count = shape_of(of).nodes();
    [0, 1].map(|i| of[..count].iter().map(|&k| shape.place(k)[i]).sum::<f64>() / count as f64)
}

/// The shape of a straight sub-face.
fn shape_of(of: &[usize; 4]) -> Shape {
    match (of[1] == of[2], of[2] == of[3]) {
        (true, _) => Shape::Line2,
        (_, true) => Shape::Tri3,
        _ => Shape::Quad4,
    }
}

impl SubFace {
    /// None for one without a plane, as a needle between two corners and the node between them.
    pub fn new(patch: Patch, of: [usize; 4]) -> Option<Self> {
        let (corners, shape) = (patch.sub_face(&of), shape_of(&of));
        let plane = Plane::of(corners, patch.shape.dim())?;
        let polygon = Polygon(corners[..shape.nodes()].iter().map(|x| plane.down(*x)).collect());
        let area = polygon.area();
        let own = Patch::new(shape, corners.into_iter().take(shape.nodes()));
        let straight = Seen::new(&own, &plane, shape.centre())?;
        let curved = if patch.shape == shape {
            None
        } else {
            Some(Seen::new(&patch, &plane, middle(patch.shape, &of))?)
        };
        (area > 0.0).then_some(Self { patch, of, corners, plane, polygon, area, straight, curved })
    }

    /// Number of corners.
    pub fn count(&self) -> usize {
        self.straight.shape.nodes()
    }

    /// Points for an obstacle that covers all of it, 3 in each direction, with their weights, area.
    pub fn points(&self) -> Vec<(Flat, f64)> {
        let mut all = Vec::new();
        if self.count() < 4 {
            points(&self.polygon, quadrature::Rule::Three, |z, weight| all.push((z, weight)));
            return all;
        }
        let place = |(r, weight)| self.straight.below(r).map(|(z, area)| (z, area * weight));
        of_square().filter_map(place).collect()
    }

    /// At the point z of the plane the hat functions psi and the functions N of the face.
    pub fn at(&self, z: Flat) -> Option<([f64; 4], [f64; MOST])> {
        let (_, hats) = self.straight.above(z)?;
        // Gauss points are inside: below 0 is rounding
        let psi = std::array::from_fn(|k| hats[k].max(0.0));
        let n = self.curved.as_ref().map_or(Some(hats), |curved| Some(curved.above(z)?.1))?;
        Some((psi, n))
    }

    /// The segments in which the rule believes, in the order of the master's faces. Where parts of the master that are not connected lie one
    /// above the other, as thin plates, the nearest hides the others.
    pub fn segments(&self, master: &Placed, tree: &Tree, rule: &Rule) -> Vec<Segment> {
        let mut all: Vec<Segment> = Vec::new();
        for face in self.candidates(tree, rule.distance) {
            let patch = master.patch(face);
            for of in patch.shape.sub_faces() {
                all.extend(self.segments_of(face, &patch, of, rule));
            }
        }
        let part = parts(&all, master);
        if part.iter().all(|part| *part == 0) {
            return all;
        }
        self.nearest(all, &part)
    }

    /// Ascending.
    fn candidates(&self, tree: &Tree, distance: f64) -> Vec<usize> {
        let (bulge, n) = (self.patch.sagitta(), self.plane.normal);
        let reach = distance + bulge.iter().map(|b| b * b).sum::<f64>().sqrt();
        let bound = |i: usize, start: f64, of: fn(f64, f64) -> f64| {
            self.corners.iter().fold(start, |most, x| of(most, x[i]))
        };
        let low = std::array::from_fn(|i| bound(i, f64::INFINITY, f64::min) - reach * n[i].abs());
        let high = std::array::from_fn(|i| bound(i, f64::NEG_INFINITY, f64::max) + reach * n[i].abs());
        let mut faces: Vec<usize> = tree.within(low, high).collect();
        faces.sort_unstable();
        faces
    }

    fn segments_of(&self, face: usize, master: &Patch, of: &[usize; 4], rule: &Rule) -> Vec<Segment> {
        let corners = master.sub_face(of);
        let facing =
            Plane::of(corners, self.patch.shape.dim()).map(|plane| dot(plane.normal, self.plane.normal));
        if !facing.is_some_and(|cosine| cosine <= rule.cosine.min(-EDGE_ON)) {
            return Vec::new();
        }
        let count = shape_of(of).nodes();
        let seen = Polygon(corners[..count].iter().rev().map(|x| self.plane.down(*x)).collect());
        let start = middle(master.shape, of);
        let common = seen.convex_parts().into_iter().map(|part| self.polygon.common(&part));
        common.filter_map(|polygon| self.segment(face, master, start, polygon, rule)).collect()
    }

    fn segment(
        &self,
        face: usize,
        master: &Patch,
        start: Parent,
        polygon: Polygon,
        rule: &Rule,
    ) -> Option<Segment> {
        let area = polygon.area();
        if !(area > SPECK * self.area) {
            return None;
        }
        let (z, seen) = (polygon.centroid(), Seen::new(master, &self.plane, start)?);
        let ((_, own), (r, n)) = (self.at(z)?, seen.above(z)?);
        let gap = seen.height(&n) - self.curved.as_ref().unwrap_or(&self.straight).height(&own);
        let is_believed = gap.abs() <= rule.distance && gap >= -rule.depth;
        let normal = master.normal(&master.shape.at(r));
        is_believed.then_some(Segment { face, polygon, area, gap, normal, master: *master, middle: r })
    }

    /// The parts of segments that no nearer part of the master covers; `part` of each segment.
    fn nearest(&self, all: Vec<Segment>, part: &[usize]) -> Vec<Segment> {
        let distance = |of: usize| {
            let own = || all.iter().zip(part).filter(|(_, part)| **part == of).map(|(segment, _)| segment);
            own().map(|segment| segment.area * segment.gap.abs()).sum::<f64>()
                / own().map(|segment| segment.area).sum::<f64>()
        };
        let mut order: Vec<(f64, usize)> =
            (0..=part.iter().copied().max().unwrap_or(0)).map(|of| (distance(of), of)).collect();
        order.sort_by(|a, b| a.0.total_cmp(&b.0));
        let rank = |of: usize| order.iter().position(|(_, part)| *part == of);
        let mut kept = Vec::new();
        for (k, segment) in all.iter().enumerate() {
            let mut rest = vec![segment.polygon.clone()];
            for (nearer, _) in all.iter().zip(part).filter(|(_, of)| rank(**of) < rank(part[k])) {
                if segment.polygon.common(&nearer.polygon).area() > SPECK * self.area {
                    rest = rest.iter().flat_map(|rest| rest.without(&nearer.polygon)).collect();
                }
            }
            let visible = rest
                .into_iter()
                .map(|polygon| (polygon.area(), polygon))
                .filter(|(area, _)| *area > SPECK * self.area);
            kept.extend(visible.map(|(area, polygon)| Segment { polygon, area, ..*segment }));
        }
        kept
    }
}

impl Segment {
    /// The master's face along the normal of the plane.
    pub fn seen(&self, plane: &Plane) -> Option<Seen> {
        Seen::new(&self.master, plane, self.middle)
    }

    /// The master's normal times the area.
    pub fn weighted_normal(&self) -> Vector {
        times(self.area, self.normal)
    }
}

/// The connected part of the master to which each segment belongs, counted from 0: parts are connected through edges of their faces.
fn parts(segments: &[Segment], master: &Placed) -> Vec<usize> {
    const NONE: usize = usize::MAX;
    let mut part = vec![NONE; segments.len()];
    let mut parts = 0;
    while let Some(first) = part.iter().position(|part| *part == NONE) {
        let mut open = vec![segments[first].face];
        while let Some(face) = open.pop() {
            for (k, segment) in segments.iter().enumerate().filter(|(_, segment)| segment.face == face) {
                if part[k] == NONE {
                    part[k] = parts;
                    let edges = 0..segment.master.shape.corners().len();
                    open.extend(edges.filter_map(|edge| Some(master.faces.beyond(face, edge)?.0)));
                }
            }
        }
        parts += 1;
    }
    part
}
