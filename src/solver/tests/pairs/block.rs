//! Blocks of bilinear elements, with their sides as surfaces.

use crate::solver::{Problem, Shape, Storage};

/// A box of rectangular elements, K of its unknowns that are not held.
pub struct Block {
    pub dim: usize,
    steps: [usize; 3],
    /// Positions, `dim` per node.
    pub x: Vec<f64>,
    /// Unknown of each direction of each node; -1: held.
    pub dof: Vec<i64>,
    pub free: usize,
    /// Of all directions, dense.
    pub k: Vec<f64>,
    /// Of every element, by rows.
    pub ke: Vec<f64>,
    /// Nodes of the elements, one element after the other.
    pub corners: Vec<usize>,
}

/// Young's modulus 1, Poisson's ratio 0.3; `held`: which directions at a position.
pub fn block(low: &[f64], size: &[f64], steps: &[usize], held: impl Fn(&[f64]) -> bool) -> Block {
    let dim = low.len();
    let mut all = [0; 3];
    all[..dim].copy_from_slice(steps);
    let edges: Vec<f64> = (0..dim).map(|i| size[i] / steps[i] as f64).collect();
    let ke = decks::elements::elasticity(&edges, 1.0, 0.3);
    let made = Block {
        dim,
        steps: all,
        x: Vec::new(),
        dof: Vec::new(),
        free: 0,
        k: Vec::new(),
        ke,
        corners: Vec::new(),
    };
    let nodes = (0..dim).map(|i| steps[i] + 1).product::<usize>();
    let (mut x, mut dof, mut free) = (Vec::new(), Vec::new(), 0);
    for node in 0..nodes {
        let at = made.grid(node);
        let position: Vec<f64> = (0..dim).map(|i| low[i] + edges[i] * at[i] as f64).collect();
        for _ in 0..dim {
            dof.push(if held(&position) {
                -1
            } else {
                free += 1;
                free - 1
            });
        }
        x.extend(position);
    }
    let mut k = vec![0.0; (dim * nodes).pow(2)];
    let (elements, mut corners) = (steps.iter().product::<usize>(), Vec::new());
    for element in 0..elements {
        let (mut rest, mut first) = (element, [0; 3]);
        for i in 0..dim {
            (first[i], rest) = (rest % steps[i], rest / steps[i]);
        }
        let corner = |a: usize| made.node(std::array::from_fn(|i| first[i] + (a >> i & 1)));
        corners.extend((0..1 << dim).map(&corner));
        let order = dim << dim;
        for (r, c) in (0..order).flat_map(|r| (0..order).map(move |c| (r, c))) {
            let [i, j] = [r, c].map(|p| dim * corner(p / dim) + p % dim);
            k[i * dim * nodes + j] += made.ke[r * order + c];
        }
    }
    Block { x, dof, free: free as usize, k, corners, ..made }
}

/// A block held at its foot, on which another lies that is held at its top.
pub fn stacked(dim: usize) -> [Block; 2] {
    let (size, steps) = (&[2.0, 1.0, 0.5][3 - dim..], &[4, 3, 2][3 - dim..]);
    let mut low = vec![0.0; dim];
    let lower = block(&low, size, steps, |x| x[dim - 1] == 0.0 || x[0] == 0.0);
    low[dim - 1] = size[dim - 1];
    let top = 2.0 * size[dim - 1];
    [lower, block(&low, size, steps, |x| x[dim - 1] == top)]
}

impl Block {
    fn grid(&self, node: usize) -> [usize; 3] {
        let (mut rest, mut at) = (node, [0; 3]);
        for i in 0..self.dim {
            (at[i], rest) = (rest % (self.steps[i] + 1), rest / (self.steps[i] + 1));
        }
        at
    }

    fn node(&self, at: [usize; 3]) -> usize {
        (0..self.dim).rev().fold(0, |node, i| node * (self.steps[i] + 1) + at[i])
    }

    pub fn nodes(&self) -> usize {
        self.x.len() / self.dim
    }

    /// Nodes at the end of the last axis, below or above.
    pub fn side(&self, top: bool) -> Vec<usize> {
        let last = self.dim - 1;
        (0..self.nodes())
            .filter(|&node| self.grid(node)[last] == if top { self.steps[last] } else { 0 })
            .collect()
    }

    /// Faces of the lower or upper side, seen from outside counterclockwise; in the plane the body is on the left.
    pub fn faces(&self, top: bool) -> Vec<i64> {
        let mut all = Vec::new();
        let z = if top { self.steps[self.dim - 1] } else { 0 };
        for (i, j) in (0..self.steps[0]).flat_map(|i| (0..self.steps[1].max(1)).map(move |j| (i, j))) {
            let mut face = match self.dim {
                2 => vec![[i + 1, z, 0], [i, z, 0]],
                _ => vec![[i, j, z], [i + 1, j, z], [i + 1, j + 1, z], [i, j + 1, z]],
            };
            if self.dim == 2 && j > 0 {
                continue;
            }
            if !top {
                face.reverse();
            }
            all.extend(face.into_iter().map(|at| self.node(at) as i64));
        }
        all
    }

    /// K of the unknowns that are not held, by columns.
    pub fn dense(&self) -> Vec<f64> {
        let free: Vec<usize> = (0..self.dof.len()).filter(|&i| self.dof[i] >= 0).collect();
        let mut dense = Vec::new();
        for j in &free {
            dense.extend(free.iter().map(|i| self.k[i * self.dof.len() + j]));
        }
        dense
    }

    /// Unknowns of all elements, one after the other.
    pub fn element_dofs(&self) -> Vec<i64> {
        let directions = |node: &usize| (self.dim * node..self.dim * (node + 1)).map(|i| self.dof[i]);
        self.corners.iter().flat_map(directions).collect()
    }

    /// Adds the body and returns its number.
    pub fn give(&self, problem: &mut Problem) -> usize {
        let body = problem.add_body(self.free).unwrap();
        let dense = self.dense();
        problem.set_stiffness_dense(body, self.free, &dense, self.free, Storage::Full).unwrap();
        problem.set_load(body, &vec![0.0; self.free]).unwrap();
        body
    }

    /// Adds one side as a surface.
    pub fn surface(&self, problem: &mut Problem, body: usize, top: bool) -> usize {
        self.surface_of(problem, Some(body), &self.dof, top)
    }

    /// Adds one side as a surface whose directions have these unknowns.
    pub fn surface_of(&self, problem: &mut Problem, body: Option<usize>, dof: &[i64], top: bool) -> usize {
        let surface = problem.surface_add(body, self.dim, &self.x, self.dim, Some((dof, self.dim))).unwrap();
        let shape = if self.dim == 2 { Shape::Line2 } else { Shape::Quad4 };
        problem.surface_faces(surface, shape, &self.faces(top)).unwrap();
        surface
    }

    /// u of all directions, 0 where they are held, from that of the unknowns.
    pub fn spread(&self, u: &[f64]) -> Vec<f64> {
        self.dof.iter().map(|dof| usize::try_from(*dof).map_or(0.0, |dof| u[dof])).collect()
    }

    pub fn gathered(&self, all: &[f64]) -> Vec<f64> {
        (0..all.len()).filter(|&i| self.dof[i] >= 0).map(|i| all[i]).collect()
    }

    /// `K u` over all directions.
    pub fn forces(&self, u: &[f64]) -> Vec<f64> {
        self.k.chunks(u.len()).map(|row| row.iter().zip(u).map(|(k, u)| k * u).sum()).collect()
    }
}
