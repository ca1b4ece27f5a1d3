//! Meshes, and properties of their cuts, computed from the generated nodes and faces, not from those found by the
//! library.

use std::collections::{BTreeMap, BTreeSet};

use crate::mesh::{cut, Elements};

pub type Point = [f64; 3];

#[derive(Clone, Default)]
pub struct Mesh {
    pub nodes: Vec<Vec<u32>>,
    pub centres: Vec<Point>,
    /// Unknowns per node.
    pub each: u32,
    /// Least number of nodes that two elements with a common face share.
    pub face: usize,
    /// Nodes without unknowns.
    pub held: BTreeSet<u32>,
}

/// The quality of a cut.
#[derive(Debug)]
pub struct Quality {
    pub pieces: usize,
    /// Pieces that are not connected by faces.
    pub apart: usize,
    /// Sum of the unknowns of all pieces minus the unknowns of the body.
    pub copies: usize,
    /// Unknowns of the largest piece over the mean.
    pub largest: f64,
}

const KUHN: [[usize; 3]; 6] = [[0, 1, 2], [0, 2, 1], [1, 0, 2], [1, 2, 0], [2, 0, 1], [2, 1, 0]];

impl Mesh {
    /// Boxes: `n` along three directions, with corners at `place`.
    pub fn bricks(n: [usize; 3], keep: impl Fn([usize; 3]) -> bool, place: impl Fn(Point) -> Point) -> Self {
        let mut mesh = Self { each: 3, face: 4, ..Self::default() };
        for c in cells(n).filter(|&c| keep(c)) {
            let corner = |k: usize| number(n, [c[0] + (k & 1), c[1] + (k >> 1 & 1), c[2] + (k >> 2)]);
            mesh.nodes.push((0..8).map(corner).collect());
            mesh.centres.push(place(c.map(|x| x as f64 + 0.5)));
        }
        mesh
    }

    pub fn cube(n: usize) -> Self {
        Self::bricks([n; 3], |_| true, |x| x)
    }

    /// Six linear tetrahedra per box of a cube; quadratic ones also have a node on each edge.
    pub fn tetrahedra(n: usize, quadratic: bool) -> Self {
        let mut mesh = Self { each: 3, face: if quadratic { 6 } else { 3 }, ..Self::default() };
        let mut middle = BTreeMap::new();
        for c in cells([n; 3]) {
            for order in KUHN {
                let mut x = c;
                let mut nodes = vec![number([n; 3], x)];
                let mut centre = x.map(|x| x as f64);
                for (k, axis) in order.into_iter().enumerate() {
                    x[axis] += 1;
                    nodes.push(number([n; 3], x));
                    centre[axis] += 0.75 - 0.25 * k as f64;
                }
                for (a, b) in
                    [(0, 1), (0, 2), (0, 3), (1, 2), (1, 3), (2, 3)].into_iter().filter(|_| quadratic)
                {
                    let next = ((n + 1).pow(3) + middle.len()) as u32;
                    nodes.push(*middle.entry((nodes[a], nodes[b])).or_insert(next));
                }
                mesh.nodes.push(nodes);
                mesh.centres.push(centre);
            }
        }
        mesh
    }

    /// A plane mesh of quadrangles with `each` unknowns per node.
    pub fn quadrangles(n: [usize; 2], each: u32, place: impl Fn(Point) -> Point) -> Self {
        let mut mesh = Self { each, face: 2, ..Self::default() };
        for j in 0..n[1] {
            for i in 0..n[0] {
                let at = |i: usize, j: usize| (j * (n[0] + 1) + i) as u32;
                mesh.nodes.push(vec![at(i, j), at(i + 1, j), at(i + 1, j + 1), at(i, j + 1)]);
                mesh.centres.push(place([i as f64 + 0.5, j as f64 + 0.5, 0.0]));
            }
        }
        mesh
    }

    /// Boxes around a circle: `n` around, radially and along the axis.
    pub fn ring(n: [usize; 3]) -> Self {
        let place = |x: Point| {
            let (angle, radius) = (std::f64::consts::TAU * x[0] / n[0] as f64, 20.0 + x[1]);
            [radius * angle.cos(), radius * angle.sin(), x[2]]
        };
        let mut mesh = Self::bricks(n, |_| true, place);
        for node in mesh.nodes.iter_mut().flatten() {
            // the last nodes around the ring are the first
            if *node as usize % (n[0] + 1) == n[0] {
                *node -= n[0] as u32;
            }
        }
        mesh
    }

    /// Permutes the elements and the node numbers.
    pub fn shuffled(mut self) -> Self {
        let key = |x: u64| {
            (x + 1).wrapping_mul(0x9e37_79b9_7f4a_7c15).rotate_left(29).wrapping_mul(0xd6e8_feb8_6659_fd93)
        };
        let mut order: Vec<usize> = (0..self.nodes.len()).collect();
        order.sort_by_key(|&e| key(e as u64));
        let mut nodes: Vec<u32> = (0..=self.nodes.iter().flatten().copied().max().unwrap()).collect();
        nodes.sort_by_key(|&n| key(u64::from(n) << 32));
        self.nodes =
            order.iter().map(|&e| self.nodes[e].iter().map(|&n| nodes[n as usize]).collect()).collect();
        self.centres = order.iter().map(|&e| self.centres[e]).collect();
        self
    }

    /// Rotated about two axes, moved and scaled.
    pub fn turned(mut self, shift: f64, scale: f64) -> Self {
        let ((s, c), (t, d)) = (0.5_f64.sin_cos(), 0.8_f64.sin_cos());
        for x in &mut self.centres {
            let y = [c * x[0] - s * x[1], s * x[0] + c * x[1], x[2]];
            *x = [y[0], d * y[1] - t * y[2], t * y[1] + d * y[2]].map(|y| scale * (y + shift));
        }
        self
    }

    /// Adds an element.
    pub fn with(mut self, nodes: &[u32]) -> Self {
        self.nodes.push(nodes.to_vec());
        self.centres.push([0.0; 3]);
        self
    }

    pub fn arrays(&self) -> (Vec<usize>, Vec<u32>, usize) {
        let (mut ptr, mut dof) = (vec![0], Vec::new());
        for nodes in &self.nodes {
            let free = nodes.iter().filter(|n| !self.held.contains(n));
            dof.extend(free.flat_map(|n| (0..self.each).map(move |k| self.each * n + k)));
            ptr.push(dof.len());
        }
        let nodes = self.nodes.iter().flatten().copied().max().map_or(0, |last| last as usize + 1);
        (ptr, dof, self.each as usize * nodes)
    }

    pub fn cut(&self, pieces: usize, with_centres: bool) -> Vec<u32> {
        let (ptr, dof, unknowns) = self.arrays();
        let elements = Elements { ptr: &ptr, dof: &dof, unknowns };
        cut(&elements, with_centres.then_some(&self.centres[..]), pieces).unwrap()
    }

    pub fn quality(&self, piece: &[u32]) -> Quality {
        let pieces = piece.iter().max().map_or(0, |&last| last as usize + 1);
        let mut of_node: BTreeMap<u32, BTreeSet<u32>> = BTreeMap::new();
        for (nodes, &p) in self.nodes.iter().zip(piece) {
            for &n in nodes.iter().filter(|n| !self.held.contains(n)) {
                of_node.entry(n).or_default().insert(p);
            }
        }
        let mut sizes = vec![0; pieces];
        of_node.values().flatten().for_each(|&p| sizes[p as usize] += self.each as usize);
        let total: usize = sizes.iter().sum();
        Quality {
            pieces,
            apart: (self.parts(piece).into_iter().collect::<BTreeSet<_>>().len()).saturating_sub(pieces),
            copies: total - self.each as usize * of_node.len(),
            largest: *sizes.iter().max().unwrap() as f64 * pieces as f64 / total as f64,
        }
    }

    /// For each element, the first element connected to it by faces within its piece.
    fn parts(&self, piece: &[u32]) -> Vec<usize> {
        let mut at_node: BTreeMap<u32, Vec<usize>> = BTreeMap::new();
        for (e, nodes) in self.nodes.iter().enumerate() {
            nodes.iter().for_each(|&n| at_node.entry(n).or_default().push(e));
        }
        let mut part = vec![usize::MAX; piece.len()];
        for first in 0..piece.len() {
            let mut queue = if part[first] == usize::MAX { vec![first] } else { vec![] };
            queue.iter().for_each(|_| part[first] = first);
            while let Some(e) = queue.pop() {
                let mut shared: BTreeMap<usize, usize> = BTreeMap::new();
                self.nodes[e]
                    .iter()
                    .flat_map(|n| &at_node[n])
                    .for_each(|&f| *shared.entry(f).or_default() += 1);
                for (f, _) in shared.into_iter().filter(|&(_, count)| count >= self.face) {
                    if piece[f] == piece[e] && part[f] == usize::MAX {
                        part[f] = first;
                        queue.push(f);
                    }
                }
            }
        }
        part
    }
}

fn number(n: [usize; 3], x: [usize; 3]) -> u32 {
    ((x[2] * (n[1] + 1) + x[1]) * (n[0] + 1) + x[0]) as u32
}

fn cells(n: [usize; 3]) -> impl Iterator<Item = [usize; 3]> {
    (0..n[2]).flat_map(move |k| (0..n[1]).flat_map(move |j| (0..n[0]).map(move |i| [i, j, k])))
}

/// Number of copies if a cube with `n` elements per edge is cut into `k`^3 blocks of equal size.
pub fn ideal(n: usize, k: usize) -> usize {
    3 * ((n + k).pow(3) - (n + 1).pow(3))
}
