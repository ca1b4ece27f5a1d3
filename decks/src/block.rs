//! Structured elastic blocks in two (plane strain) and three dimensions.

use crate::elements::elasticity;
use crate::sparse::Csr;
use crate::Body;

/// A rectangle or box of equal quad4 or hex8 elements. Nodes run along x first, then y, then z; dofs node by
/// node.
#[derive(Clone, Debug)]
pub struct Block {
    /// 2 or 3.
    pub dimension: usize,
    /// Elements along each axis; entries from `dimension` on are ignored.
    pub elements: [usize; 3],
    /// Edge lengths.
    pub size: [f64; 3],
    /// Position of the first node, length.
    pub origin: [f64; 3],
    /// Young's modulus, force per length^2.
    pub young: f64,
    /// Poisson's ratio.
    pub poisson: f64,
    /// What `young` is multiplied by in each element, x first, then y, then z; no unit. Empty: 1 everywhere.
    pub factors: Vec<f64>,
}

impl Default for Block {
    /// One element, the unit cube, E = 1, nu = 0.3.
    fn default() -> Block {
        Block {
            dimension: 3,
            elements: [1; 3],
            size: [1.0; 3],
            origin: [0.0; 3],
            young: 1.0,
            poisson: 0.3,
            factors: Vec::new(),
        }
    }
}

/// A body made of a block, possibly with clamped nodes eliminated.
#[derive(Clone, Debug)]
pub struct Part {
    pub body: Body,
    /// Dof of the body for each dof of the block, `None` where clamped.
    pub number: Vec<Option<usize>>,
}

impl Block {
    /// Nodes along `axis`; 1 along an axis the block does not have.
    pub fn nodes_along(&self, axis: usize) -> usize {
        if axis < self.dimension {
            self.elements[axis] + 1
        } else {
            1
        }
    }

    /// Number of nodes.
    pub fn nodes(&self) -> usize {
        (0..3).map(|axis| self.nodes_along(axis)).product()
    }

    /// Number of the node at grid position (i, j, k).
    pub fn node(&self, at: [usize; 3]) -> usize {
        at[0] + self.nodes_along(0) * (at[1] + self.nodes_along(1) * at[2])
    }

    /// Grid position (i, j, k) of a node.
    pub fn grid(&self, node: usize) -> [usize; 3] {
        let (nx, ny) = (self.nodes_along(0), self.nodes_along(1));
        [node % nx, node / nx % ny, node / (nx * ny)]
    }

    /// All grid positions in the order of the nodes.
    pub fn grids(&self) -> impl Iterator<Item = [usize; 3]> + '_ {
        (0..self.nodes()).map(|node| self.grid(node))
    }

    /// Position of the node at a grid position, length.
    pub fn position(&self, at: [usize; 3]) -> [f64; 3] {
        std::array::from_fn(|axis| {
            let steps = if axis < self.dimension { self.elements[axis] } else { 1 };
            self.origin[axis] + self.size[axis] * at[axis] as f64 / steps as f64
        })
    }

    /// K with both triangles. Each node meets at most 3^d neighbours: rows are gathered node by node, the
    /// elements around a node always in ascending order, so that K is symmetric to the last bit.
    pub fn stiffness(&self) -> Csr {
        let d = self.dimension;
        let element = self.element();
        let mut matrix = Csr::empty(d * self.nodes());
        for at in self.grids() {
            let gathered = self.gather(at, &element);
            for i in 0..d {
                for (node, blocks) in &gathered {
                    matrix.col.extend((0..d).map(|j| d * node + j));
                    matrix.val.extend_from_slice(&blocks[i * d..(i + 1) * d]);
                }
                matrix.rows += 1;
                matrix.ptr.push(matrix.col.len());
            }
        }
        matrix
    }

    /// Stiffness of an element whose factor is 1, node by node in tensor order.
    pub fn element(&self) -> Vec<f64> {
        let edges: Vec<f64> = (0..self.dimension).map(|a| self.size[a] / self.elements[a] as f64).collect();
        elasticity(&edges, self.young, self.poisson)
    }

    /// The d x d blocks (by rows) of the stiffness between the node `at` and its neighbours, ascending.
    fn gather(&self, at: [usize; 3], element: &[f64]) -> Vec<(usize, Vec<f64>)> {
        let d = self.dimension;
        let order = d << d;
        let mut neighbours = self.neighbours(at);
        for corner in (0..1usize << d).rev() {
            let Some(low) = self.element_with(at, corner) else {
                continue;
            };
            let factor = self.factor(low);
            for other in 0..1usize << d {
                let node = self.node(std::array::from_fn(|a| low[a] + (other >> a & 1)));
                let place = neighbours.binary_search_by_key(&node, |entry| entry.0);
                let block = &mut neighbours[place.expect("a node of the same element")].1;
                for i in 0..d {
                    for j in 0..d {
                        block[i * d + j] += factor * element[(corner * d + i) * order + other * d + j];
                    }
                }
            }
        }
        neighbours
    }

    /// Number of elements.
    pub fn volume(&self) -> usize {
        self.elements[..self.dimension].iter().product()
    }

    /// Lowest grid position of an element.
    pub fn low(&self, element: usize) -> [usize; 3] {
        let [nx, ny, _] = self.elements;
        [element % nx, element / nx % ny, element / (nx * ny)]
    }

    /// What `young` is multiplied by in the element whose lowest node is at `low`.
    fn factor(&self, low: [usize; 3]) -> f64 {
        let [nx, ny, _] = self.elements;
        let layer = if self.dimension == 3 { nx * ny * low[2] } else { 0 };
        self.factors.get(low[0] + nx * low[1] + layer).copied().unwrap_or(1.0)
    }

    /// Zero blocks for all nodes at most one step away from `at`, ascending.
    fn neighbours(&self, at: [usize; 3]) -> Vec<(usize, Vec<f64>)> {
        let range = |a: usize| at[a].saturating_sub(1)..=(at[a] + 1).min(self.nodes_along(a) - 1);
        let mut found = Vec::with_capacity(27);
        for k in range(2) {
            for j in range(1) {
                let nodes = range(0).map(|i| self.node([i, j, k]));
                found.extend(nodes.map(|node| (node, vec![0.0; self.dimension * self.dimension])));
            }
        }
        found
    }

    /// Lowest grid position of the element in which the node `at` is corner number `corner`.
    fn element_with(&self, at: [usize; 3], corner: usize) -> Option<[usize; 3]> {
        let mut low = at;
        for axis in 0..self.dimension {
            low[axis] = at[axis].checked_sub(corner >> axis & 1)?;
            if low[axis] >= self.elements[axis] {
                return None;
            }
        }
        Some(low)
    }

    /// The 3 (plane) or 6 rigid modes about the centre: translations, then rotations. Each has length dofs.
    pub fn rigid_modes(&self) -> Vec<Vec<f64>> {
        let d = self.dimension;
        let planes: &[(usize, usize)] = if d == 2 { &[(0, 1)] } else { &[(0, 1), (1, 2), (2, 0)] };
        let mut modes = vec![vec![0.0; d * self.nodes()]; d + planes.len()];
        for (node, at) in self.grids().enumerate() {
            let position = self.position(at);
            let arm = |axis: usize| position[axis] - self.origin[axis] - self.size[axis] / 2.0;
            for axis in 0..d {
                modes[axis][d * node + axis] = 1.0;
            }
            for (mode, &(p, q)) in modes[d..].iter_mut().zip(planes) {
                mode[d * node + p] = -arm(q);
                mode[d * node + q] = arm(p);
            }
        }
        modes
    }

    /// The block as a floating body without load.
    pub fn floating(&self) -> Part {
        self.part(|_| false)
    }

    /// The block as a body without load, all dofs of the nodes `clamped` names eliminated. A clamped set
    /// must be empty or hold the body: a face, or three nodes that are not in line.
    pub fn part(&self, clamped: impl Fn([usize; 3]) -> bool) -> Part {
        let mut part = self.outline(clamped);
        let stiffness = self.stiffness();
        let keep: Vec<usize> = (0..stiffness.rows).filter(|&dof| part.number[dof].is_some()).collect();
        let all = keep.len() == stiffness.rows;
        part.body.stiffness = if all { stiffness } else { stiffness.restricted(&keep) };
        part
    }

    /// The same without an entry in its stiffness.
    pub fn outline(&self, clamped: impl Fn([usize; 3]) -> bool) -> Part {
        let d = self.dimension;
        let keep: Vec<usize> = (self.grids().enumerate())
            .filter(|&(_, at)| !clamped(at))
            .flat_map(|(node, _)| d * node..d * (node + 1))
            .collect();
        let mut number = vec![None; d * self.nodes()];
        for (new, &old) in keep.iter().enumerate() {
            number[old] = Some(new);
        }
        let body = Body {
            stiffness: Csr::zero(keep.len()),
            null_space: (keep.len() == number.len()).then(|| self.rigid_modes()),
            load: vec![0.0; keep.len()],
            coordinates: keep.iter().map(|dof| self.position(self.grid(dof / d))).collect(),
            node: keep.iter().map(|dof| (dof / d + 1) as i32).collect(),
            direction: keep.iter().map(|dof| (dof % d + 1) as i32).collect(),
        };
        Part { body, number }
    }
}

#[cfg(test)]
mod tests {
    use super::Block;
    use crate::vector::{dot, norm_max};

    fn uneven(dimension: usize) -> Block {
        Block {
            dimension,
            elements: [3, 2, 4],
            size: [1.0, 0.5, 3.0],
            origin: [5.0, -2.0, 1.0],
            young: 7.0,
            ..Block::default()
        }
    }

    #[test]
    fn block_stiffness_is_symmetric_to_the_last_bit_and_sorted() {
        for d in [2, 3] {
            let stiffness = uneven(d).stiffness();
            assert_eq!(stiffness.asymmetry(), 0.0);
            assert!(stiffness.is_sorted());
        }
    }

    /// Factors 1 change no bit; the factor of one element enters at its own nodes alone.
    #[test]
    fn factors_multiply_the_modulus_of_their_elements() {
        for d in [2, 3] {
            let plain = uneven(d);
            let mut factors = vec![1.0; plain.volume()];
            assert_eq!(Block { factors: factors.clone(), ..plain.clone() }.stiffness(), plain.stiffness());
            factors[0] = 3.0;
            let varied = Block { factors, ..plain.clone() }.stiffness();
            assert_eq!(varied.asymmetry(), 0.0);
            assert_eq!(varied.get(0, 0), 3.0 * plain.stiffness().get(0, 0));
            let last = varied.rows - 1;
            assert_eq!(varied.get(last, last), plain.stiffness().get(last, last));
        }
    }

    #[test]
    fn rigid_modes_lie_in_the_kernel() {
        for d in [2, 3] {
            let stiffness = uneven(d).stiffness();
            let modes = uneven(d).rigid_modes();
            assert_eq!(modes.len(), if d == 2 { 3 } else { 6 });
            for mode in &modes {
                let force = norm_max(&stiffness.times(mode));
                assert!(force <= 1e-12 * norm_max(&stiffness.val) * norm_max(mode), "{force:e}");
            }
        }
    }

    /// u = (s/E)(x, -nu y, -nu z) is uniaxial stress s: the ends carry s times their area, sides nothing.
    #[test]
    fn assembled_block_passes_the_uniaxial_patch_test() {
        let block = uneven(3);
        let strain = 0.01;
        let mut stretch = vec![0.0; 3 * block.nodes()];
        for (node, at) in block.grids().enumerate() {
            let x = block.position(at);
            let factors = [strain, -block.poisson * strain, -block.poisson * strain];
            (0..3).for_each(|axis| stretch[3 * node + axis] = factors[axis] * x[axis]);
        }
        let force = block.stiffness().times(&stretch);
        let mut pull = 0.0;
        for (node, at) in block.grids().enumerate() {
            let end = at[0] == block.elements[0];
            pull += if end { force[3 * node] } else { 0.0 };
            let free = if end || at[0] == 0 { 1..3 } else { 0..3 };
            free.for_each(|axis| assert!(force[3 * node + axis].abs() < 1e-13));
        }
        assert!((pull - block.young * strain * block.size[1] * block.size[2]).abs() < 1e-13);
    }

    #[test]
    fn node_number_and_grid_position_are_inverse() {
        let block = uneven(3);
        assert_eq!(block.node([1, 2, 3]), 1 + 4 * (2 + 3 * 3));
        (0..block.nodes()).for_each(|node| assert_eq!(block.node(block.grid(node)), node));
        assert_eq!(block.position([3, 2, 4]), [6.0, -1.5, 4.0]);
    }

    #[test]
    fn clamped_face_is_eliminated_and_leaves_a_positive_matrix() {
        let block = uneven(3);
        let part = block.part(|at| at[2] == 0);
        assert_eq!(part.body.dofs(), 3 * 4 * 3 * 4);
        assert!(part.body.null_space.is_none());
        assert_eq!(part.body.node[0], 13);
        assert_eq!(part.number[3 * 12], Some(0));
        assert_eq!(part.number[0], None);
        let lift: Vec<f64> = part.body.direction.iter().map(|&d| f64::from(d == 3)).collect();
        assert!(dot(&lift, &part.body.stiffness.times(&lift)) > 0.1);
    }
}
