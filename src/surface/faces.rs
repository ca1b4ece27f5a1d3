//! Faces of a surface, checked: which nodes they join, which face lies beyond each edge, normals of nodes.

use crate::error::{Error, Kind, Result, INDEX};
use crate::numbers::surface::NO_AREA;
use crate::platform::memory::{filled, reserved};
use crate::surface::order;
use crate::surface::patch::Patch;
use crate::surface::shape::{self, Shape};
use crate::surface::vector::{angle, cross, length, minus, plus, unit, Vector, ZERO};

/// No face, no node, no neighbour.
pub const NONE: u32 = u32::MAX;
/// In place of its first place: a point of a cloud, in no face.
const POINT: u32 = NONE - 1;
const WHAT: &str = "a surface";
/// Edges of a face at most; a neighbour is written as face x `EDGES` + edge.
const EDGES: u32 = 4;

/// Faces over `nodes` nodes, seen from outside counterclockwise; in the plane the body is on the left.
#[derive(Debug, Clone, Default)]
pub struct Faces {
    pub dim: usize,
    /// Number of nodes, those in no face included.
    pub nodes: usize,
    shape: Vec<Shape>,
    /// Where the nodes of each face begin in `node`, and their end.
    start: Vec<u32>,
    node: Vec<u32>,
    /// At the place of corner k the face and edge beyond edge k, `NONE` at a rim; unused places are `NONE`.
    beyond: Vec<u32>,
    /// Of every node its first place in `node`; in no face `NONE`, or `POINT`.
    first: Vec<u32>,
    /// Whether a node lies on an edge of one face only.
    rim: Vec<bool>,
}

impl Faces {
    pub fn new(dim: usize, nodes: usize) -> Result<Self> {
        if !(2..=3).contains(&dim) {
            return Err(Error::argument("dim", "a surface has 2 or 3 dimensions").value(dim as f64));
        }
        if nodes >= NONE as usize {
            return Err(Error::new(Kind::Overflow, "the surface has too many nodes").value(nodes as f64));
        }
        let (first, rim) = (filled(nodes, NONE, WHAT)?, filled(nodes, false, WHAT)?);
        Ok(Self { dim, nodes, start: vec![0], first, rim, ..Self::default() })
    }

    /// Number of faces.
    pub fn len(&self) -> usize {
        self.shape.len()
    }

    pub fn shape(&self, face: usize) -> Shape {
        self.shape[face]
    }

    pub fn nodes_of(&self, face: usize) -> &[u32] {
        &self.node[self.start[face] as usize..self.start[face + 1] as usize]
    }

    pub fn patch(&self, face: usize, x: &[Vector]) -> Patch {
        Patch::new(self.shape[face], self.nodes_of(face).iter().map(|&node| x[node as usize]))
    }

    /// The face beyond an edge and its edge there; none at a rim.
    pub fn beyond(&self, face: usize, edge: usize) -> Option<(usize, usize)> {
        let beyond = self.beyond[self.start[face] as usize + edge];
        (beyond != NONE).then_some(((beyond / EDGES) as usize, (beyond % EDGES) as usize))
    }

    pub fn is_on_rim(&self, node: u32) -> bool {
        self.rim[node as usize]
    }

    /// The nodes in some face, or the points, ascending.
    pub fn used(&self) -> impl Iterator<Item = u32> + '_ {
        (0..self.nodes as u32).filter(|&node| self.first[node as usize] != NONE)
    }

    /// The first face of a node, and its number there.
    pub fn first_face(&self, node: u32) -> Option<(usize, usize)> {
        let place = self.first[node as usize];
        let face = self.start.partition_point(|&start| start <= place).checked_sub(1)?;
        (place < POINT).then(|| (face, (place - self.start[face]) as usize))
    }

    /// Adds faces of one shape, `node` counting from 0, at positions x; returns the number of the first. An error changes nothing.
    #[cfg(test)]
    pub fn add(&mut self, shape: Shape, node: &[i64], x: &[Vector]) -> Result<usize> {
        let first = self.len();
        *self = self.with(shape, node, x)?;
        Ok(first)
    }

    /// These nodes, counting from 0, become points of a cloud; without any call all nodes are.
    pub fn with_points(&self, node: &[i64]) -> Result<Self> {
        if self.len() > 0 {
            return Err(Error::argument("shape", "the surface has faces, and points do not join them"));
        }
        let mut all = self.with_room(0, 0)?;
        for (k, &number) in node.iter().enumerate() {
            let node = self.known(number).map_err(|error| error.entry(k))?;
            all.first[node as usize] = POINT;
        }
        Ok(all)
    }

    /// The node of this number.
    fn known(&self, number: i64) -> Result<u32> {
        u32::try_from(number).ok().filter(|&node| (node as usize) < self.nodes).ok_or_else(|| {
            let what = format!("node {INDEX} does not exist: the surface has {} nodes", self.nodes);
            Error::argument("node", what).index(number)
        })
    }

    /// These faces and further ones of one shape, `node` counting from 0, at positions x.
    pub fn with(&self, shape: Shape, node: &[i64], x: &[Vector]) -> Result<Self> {
        if shape.dim() != self.dim {
            let what = format!("{} is no face in {} dimensions", shape.name(), self.dim);
            return Err(Error::argument("shape", what));
        }
        if self.first.contains(&POINT) {
            return Err(Error::argument(
                "shape",
                "the surface is a cloud of points, which faces do not join",
            ));
        }
        let (k, first) = (shape.nodes(), self.len());
        if node.len() % k != 0 {
            let what = format!("{} numbers are no faces of {k} nodes", node.len());
            return Err(Error::argument("node", what).value(node.len() as f64));
        }
        if self.node.len().saturating_add(node.len()) >= (NONE / EDGES) as usize {
            return Err(Error::new(Kind::Overflow, "the surface has too many faces"));
        }
        let mut all = self.with_room(node.len() / k, node.len())?;
        for (face, given) in node.chunks_exact(k).enumerate() {
            all.push(shape, given, x).map_err(|error| match error.place.entry {
                Some(entry) => error.face(first + face).entry(face * k + entry),
                None => error.face(first + face),
            })?;
        }
        all.connect()?;
        Ok(all)
    }

    /// A copy with room for further faces.
    fn with_room(&self, faces: usize, nodes: usize) -> Result<Self> {
        fn copy<T: Copy>(of: &[T], more: usize) -> Result<Vec<T>> {
            let mut copy = reserved(of.len() + more, WHAT)?;
            copy.extend_from_slice(of);
            Ok(copy)
        }
        Ok(Self {
            shape: copy(&self.shape, faces)?,
            start: copy(&self.start, faces)?,
            node: copy(&self.node, nodes)?,
            beyond: copy(&self.beyond, nodes)?,
            first: copy(&self.first, 0)?,
            rim: copy(&self.rim, 0)?,
            ..*self
        })
    }

    fn push(&mut self, shape: Shape, given: &[i64], x: &[Vector]) -> Result<()> {
        let mut nodes = [0u32; shape::MOST];
        for (k, &number) in given.iter().enumerate() {
            nodes[k] = self.known(number).map_err(|error| error.entry(k))?;
        }
        let (shape, nodes) = without_last_corner(shape, &nodes);
        let nodes = &nodes[..shape.nodes()];
        if let Some(k) = (1..nodes.len()).find(|&k| nodes[..k].contains(&nodes[k])) {
            let what = format!("node {INDEX} is twice in the face");
            return Err(Error::argument("node", what).index(nodes[k].into()).entry(k));
        }
        let patch = Patch::new(shape, nodes.iter().map(|&node| x[node as usize]));
        let (area, whole) = extent(&patch);
        if !(area > NO_AREA * whole) {
            let what = format!("the face has no area: {area:.1e} of {whole:.1e}");
            return Err(Error::argument("node", what).value(area).limit(NO_AREA * whole));
        }
        order::check(&patch, nodes)?;
        for (k, &node) in nodes.iter().enumerate() {
            let first = &mut self.first[node as usize];
            if *first == NONE {
                *first = (self.node.len() + k) as u32;
            }
        }
        self.node.extend(nodes);
        self.beyond.resize(self.node.len(), NONE);
        self.shape.push(shape);
        self.start.push(self.node.len() as u32);
        Ok(())
    }

    /// Which face lies beyond each edge. In the plane the edges are the ends of lines.
    fn connect(&mut self) -> Result<()> {
        let mut edges: Vec<(u32, u32, u32)> = reserved(self.node.len(), WHAT)?;
        for face in 0..self.len() {
            let (shape, nodes) = (self.shape[face], self.nodes_of(face));
            for k in 0..shape.corners().len() {
                let [a, b] = shape.edge(k).map(|corner| nodes[corner]);
                edges.push((a.min(b), a.max(b), face as u32 * EDGES + k as u32));
            }
        }
        edges.sort_unstable();
        self.beyond.fill(NONE);
        self.rim.fill(false);
        for edge in edges.chunk_by(|a, b| (a.0, a.1) == (b.0, b.1)) {
            let face = |which: usize| (edge[which].2 / EDGES) as usize;
            match edge {
                [(a, b, _)] => [*a, *b].into_iter().for_each(|node| self.rim[node as usize] = true),
                [one, other] => {
                    if self.begins(one.2) == self.begins(other.2) {
                        let what = format!(
                            "the face and face {INDEX} beside it disagree about which side is outside"
                        );
                        return Err(Error::argument("node", what).face(face(1)).index(face(0) as i64));
                    }
                    for (at, to) in [(one.2, other.2), (other.2, one.2)] {
                        let place = self.start[(at / EDGES) as usize] + at % EDGES;
                        self.beyond[place as usize] = to;
                    }
                }
                _ => {
                    let what = format!("an edge of the face is one of face {INDEX} and of another one, too");
                    return Err(Error::argument("node", what).face(face(2)).index(face(0) as i64));
                }
            }
        }
        Ok(())
    }

    /// What two faces on an edge must have different: its first node; in the plane the end of the line.
    fn begins(&self, edge: u32) -> u32 {
        let (face, k) = ((edge / EDGES) as usize, (edge % EDGES) as usize);
        if self.dim == 2 {
            return k as u32;
        }
        self.nodes_of(face)[k]
    }

    /// Outward unit normals of the nodes: those of their faces, weighted by the angle that the face has at the node; 0 in no face.
    pub fn normals(&self, x: &[Vector]) -> Result<Vec<Vector>> {
        let mut sums = filled(self.nodes, ZERO, "normals of a surface")?;
        for face in 0..self.len() {
            let patch = self.patch(face, x);
            for (k, &node) in self.nodes_of(face).iter().enumerate() {
                let (normal, weight) = normal_at(&patch, k);
                let sum = &mut sums[node as usize];
                *sum = plus(*sum, weight, normal);
            }
        }
        sums.iter_mut().for_each(|sum| *sum = unit(*sum).unwrap_or(ZERO));
        Ok(sums)
    }
}

/// The unit normal at node k, and the angle of the face there, radian; of lines 1.
fn normal_at(patch: &Patch, k: usize) -> (Vector, f64) {
    const HALF_TURN: f64 = std::f64::consts::PI;
    let shape = patch.shape;
    if shape.dim() == 3 && k < shape.corners().len() {
        let [next, before] = patch.edges_at(k);
        return (unit(cross(next, before)).unwrap_or_else(|| patch.centre_normal()), angle(next, before));
    }
    (patch.normal(&shape.at(shape.place(k))), if shape.dim() == 3 { HALF_TURN } else { 1.0 })
}

/// A quadrilateral with its last corner repeated is a triangle; QUAD8 has the node of the lost edge there, too.
fn without_last_corner(shape: Shape, nodes: &[u32; shape::MOST]) -> (Shape, [u32; shape::MOST]) {
    let [a, b, c, d, ab, bc, cd, da, _] = *nodes;
    match shape {
        Shape::Quad4 if c == d => (Shape::Tri3, *nodes),
        Shape::Quad8 if c == d && cd == c => (Shape::Tri6, [a, b, c, ab, bc, da, 0, 0, 0]),
        _ => (shape, *nodes),
    }
}

/// Area of the sub-faces and the square of the longest edge; of a line its chord and the longest distance of two nodes.
fn extent(patch: &Patch) -> (f64, f64) {
    let x = patch.nodes();
    let distance = |a: usize, b: usize| length(minus(x[b], x[a]));
    if patch.shape.dim() == 2 {
        let pairs = (0..x.len()).flat_map(|a| (0..a).map(move |b| (a, b)));
        return (distance(0, 1), pairs.map(|(a, b)| distance(a, b)).fold(0.0, f64::max));
    }
    let area = |of: &[usize; 4]| {
        let [a, b, c, d] = patch.sub_face(of);
        0.5 * length(cross(minus(c, a), minus(d, b))).max(length(cross(minus(b, a), minus(c, a))))
    };
    let size = patch.size();
    (patch.shape.sub_faces().iter().map(area).sum(), size * size)
}

#[cfg(test)]
mod tests;
