//! The foot of a node on a face, and the direction of their contact: the line that joins the two points.

use crate::numbers::surface::{KEEP, ON_EDGE, RIM};
use crate::surface::domain::Domain;
use crate::surface::faces::Faces;
use crate::surface::patch::Patch;
use crate::surface::shape::Parent;
use crate::surface::vector::{cross, dot, length, minus, plus, times, unit, Vector, ZERO};

/// Where a node meets a face: `x - y = g n`, y = X(r).
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Foot {
    pub face: usize,
    pub r: Parent,
    /// n, outward from the master: no unit.
    pub normal: Vector,
    /// g, length; negative where the node is in the body.
    pub gap: f64,
    /// |x - y|, length
    pub distance: f64,
    /// The foot is in the face or its continuation, not on an edge.
    pub is_inside: bool,
}

/// Faces of the master at their positions, with the normals of the nodes.
#[derive(Clone, Copy)]
pub struct Placed<'a> {
    pub faces: &'a Faces,
    pub x: &'a [Vector],
    pub normals: &'a [Vector],
}

/// A slave node.
#[derive(Debug, Clone, Copy)]
pub struct Node {
    pub x: Vector,
    /// Outward unit normal; 0 for a node that has none, as those of clouds.
    pub normal: Vector,
    /// Largest cosine between the outward normals of slave and master.
    pub cosine: f64,
}

impl Node {
    /// The node looks at a face with this normal.
    pub fn faces(&self, normal: Vector) -> bool {
        self.normal == ZERO || dot(self.normal, normal) <= self.cosine
    }
}

/// What lies around a foot on an edge or corner.
struct Around {
    /// Mean outward normal.
    normal: Vector,
    /// Edges of the face beyond which lies a face at which the node does not look.
    ends: [bool; 4],
    /// No face there leads closer to the node, and none of those at which the node looks.
    is_nearest: bool,
    is_nearest_of_faced: bool,
}

impl Placed<'_> {
    pub fn patch(&self, face: usize) -> Patch {
        self.faces.patch(face, self.x)
    }

    /// The foot of a node on the closed face, if no other face at the foot is nearer. A face is continued by `RIM` where the surface ends,
    /// and where it bends away so far that the node does not look at the face beyond; a foot further out is none, unless it is the nearest
    /// point of all faces.
    pub fn foot(&self, face: usize, node: &Node) -> Option<Foot> {
        let patch = self.patch(face);
        let edges = patch.shape.corners().len();
        let mut ends: [bool; 4] = std::array::from_fn(|k| k < edges && self.faces.beyond(face, k).is_none());
        let mut beyond_end = None;
        for _ in 0..=edges {
            let domain = Domain::grown(patch.shape, |edge| if ends[edge] { RIM } else { 0.0 });
            let r = patch.nearest(node.x, &domain);
            let mut on = domain.edges_of(r);
            let Some(edge) = on.next() else { return Some(self.inside(face, &patch, r, node.x)) };
            let other = on.next().filter(|_| patch.shape.dim() == 3);
            if ends[edge] || other.is_some_and(|other| ends[other]) {
                break;
            }
            let from = minus(node.x, patch.point(r));
            let around = match other {
                None => self.beyond_edge(face, &patch, (edge, r), from, node),
                // the corner with which the later edge begins, or edge 0
                Some(other) => {
                    self.around_corner(face, if edge + 1 == other { other } else { edge }, from, node)
                }
            };
            match around {
                Some(around) if !around.ends.contains(&true) => {
                    let joined = || self.joined(face, &patch, r, from, around.normal);
                    return around.is_nearest_of_faced.then(joined);
                }
                Some(around) => {
                    if around.is_nearest {
                        beyond_end = beyond_end.or(Some(self.joined(face, &patch, r, from, around.normal)));
                    }
                    (0..edges).for_each(|k| ends[k] |= around.ends[k]);
                }
                None => (0..edges).for_each(|k| ends[k] |= k == edge || Some(k) == other),
            }
        }
        beyond_end
    }

    /// The foot of a node that keeps this face: inside the face grown by `KEEP`, where the surface ends by `RIM`.
    pub fn kept_foot(&self, face: usize, node: &Node) -> Option<Foot> {
        let grown = |edge: usize| if self.faces.beyond(face, edge).is_none() { RIM } else { KEEP };
        // a foot in the face itself has the bits that it has without memory
        let free = self.foot(face, node).filter(|foot| foot.is_inside);
        free.or_else(|| self.inside_grown(face, node.x, grown))
    }

    fn inside_grown(&self, face: usize, x: Vector, growth: impl Fn(usize) -> f64) -> Option<Foot> {
        let patch = self.patch(face);
        let domain = Domain::grown(patch.shape, growth);
        let r = patch.nearest(x, &domain);
        let is_inside = domain.edges_of(r).next().is_none();
        is_inside.then(|| self.inside(face, &patch, r, x))
    }

    fn inside(&self, face: usize, patch: &Patch, r: Parent, x: Vector) -> Foot {
        let functions = patch.shape.at(r);
        let normal = patch.normal(&functions);
        let gap = dot(normal, minus(x, patch.point(r)));
        Foot { face, r, normal, gap, distance: gap.abs(), is_inside: true }
    }

    /// The foot on an edge: n along `from` = x - y, to the side of `outward`; at the foot itself n = `outward`.
    fn joined(&self, face: usize, patch: &Patch, r: Parent, from: Vector, outward: Vector) -> Foot {
        let (distance, along) = (length(from), dot(from, outward));
        let (normal, gap) = match unit(from).filter(|_| distance > ON_EDGE * patch.size()) {
            Some(v) if along < 0.0 => (times(-1.0, v), -distance),
            Some(v) => (v, distance),
            None => (outward, along),
        };
        Foot { face, r, normal, gap, distance, is_inside: false }
    }

    /// The face beyond the edge at the foot r on it; none where the edge itself is continued beyond the end of the surface.
    fn beyond_edge(
        &self,
        face: usize,
        patch: &Patch,
        (edge, r): (usize, Parent),
        from: Vector,
        node: &Node,
    ) -> Option<Around> {
        let ends =
            |patch: &Patch, edge: usize| patch.shape.edge(edge).map(|corner| patch.shape.corners()[corner]);
        let [a, b] = ends(patch, edge);
        let e = [b[0] - a[0], b[1] - a[1]];
        let square = e[0] * e[0] + e[1] * e[1];
        let t = if square > 0.0 { ((r[0] - a[0]) * e[0] + (r[1] - a[1]) * e[1]) / square } else { 0.0 };
        if !(-ON_EDGE..=1.0 + ON_EDGE).contains(&t) {
            return None;
        }
        let beside = edge;
        let (there, edge) = self.faces.beyond(face, edge)?;
        let other = self.patch(there);
        let ([a, b], centre) = (ends(&other, edge), other.shape.centre());
        let r_there = [0, 1].map(|i| a[i] + (1.0 - t) * (b[i] - a[i]));
        let at = other.shape.at(r_there);
        let (normal, [first, second]) = (other.normal(&at), other.tangents(&at));
        // from the edge towards the inside, across the edge
        let to_centre = plus(times(centre[0] - r_there[0], first), centre[1] - r_there[1], second);
        let inward = match other.shape.dim() {
            2 => times(centre[0] - r_there[0], first),
            _ => {
                let along = plus(times(b[0] - a[0], first), b[1] - a[1], second);
                let across = cross(normal, along);
                times(dot(across, to_centre).signum(), across)
            }
        };
        let own = patch.normal(&patch.shape.at(r));
        let limit = ON_EDGE * patch.size() * length(inward);
        let is_nearest = dot(from, inward) <= limit;
        Some(Around {
            normal: unit(plus(own, 1.0, normal)).unwrap_or(own),
            ends: std::array::from_fn(|k| k == beside && !node.faces(normal)),
            is_nearest,
            is_nearest_of_faced: is_nearest || !node.faces(normal),
        })
    }

    /// The faces around a corner; none where the surface ends there.
    fn around_corner(&self, face: usize, corner: usize, from: Vector, node: &Node) -> Option<Around> {
        /// Faces around a corner, against endless walks.
        const MOST: usize = 64;
        let center = self.faces.nodes_of(face)[corner];
        if self.faces.is_on_rim(center) {
            return None;
        }
        let normal = self.normals[center as usize];
        let mut around = Around { normal, ends: [false; 4], is_nearest: true, is_nearest_of_faced: true };
        let edges = self.faces.shape(face).corners().len();
        let (mut at, mut k) = (face, corner);
        for step in 0..MOST {
            let patch = self.patch(at);
            let along = patch.edges_at(k);
            let normal = unit(cross(along[0], along[1])).unwrap_or_else(|| patch.centre_normal());
            let is_faced = node.faces(normal);
            let is_nearest = along.iter().all(|e| dot(from, *e) <= ON_EDGE * patch.size() * length(*e));
            around.is_nearest &= is_nearest;
            around.is_nearest_of_faced &= is_nearest || !is_faced;
            // the face beyond the edge that begins here ends that edge here
            let (next, edge) = self.faces.beyond(at, k)?;
            around.ends[corner] |= step == 1 && !is_faced;
            (at, k) = (next, (edge + 1) % self.faces.shape(next).corners().len());
            if at == face {
                around.ends[(corner + edges - 1) % edges] |= step > 0 && !is_faced;
                break;
            }
        }
        Some(around)
    }
}
