//! Elastic bodies by their elements: hexahedra and tetrahedra of any shape, a modulus for each.

/// Kind of all elements of a mesh.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Shape {
    /// 8 nodes in tensor order, as in [`crate::elements`].
    Hex8,
    /// 4 corners.
    Tet4,
    /// 4 corners, then the middles of the edges 01, 12, 20, 03, 13, 23.
    Tet10,
}

/// Nodes and elements of one body; three unknowns for each node that is not held.
#[derive(Clone, Debug)]
pub struct Mesh {
    pub shape: Shape,
    /// Position of every node, length.
    pub nodes: Vec<[f64; 3]>,
    /// Nodes of every element.
    pub elements: Vec<Vec<usize>>,
    /// Modulus of every element, force / length^2.
    pub young: Vec<f64>,
    pub poisson: f64,
    /// Held nodes.
    pub held: Vec<bool>,
}

/// Edges whose middles are the nodes 4 to 9 of a tetrahedron.
const EDGES: [[usize; 2]; 6] = [[0, 1], [1, 2], [2, 0], [0, 3], [1, 3], [2, 3]];
/// The six tetrahedra around the long diagonal of a hexahedron, by its nodes; all of positive volume.
const TETS: [[usize; 4]; 6] =
    [[0, 1, 3, 7], [0, 5, 1, 7], [0, 3, 2, 7], [0, 2, 6, 7], [0, 6, 4, 7], [0, 4, 5, 7]];

impl Mesh {
    /// A grid of hexahedra; node `at` of it lies at `place(at / steps)`, the argument in [0, 1]^3.
    pub fn grid(steps: [usize; 3], place: impl Fn([f64; 3]) -> [f64; 3]) -> Self {
        let along = steps.map(|steps| steps + 1);
        let number = |at: [usize; 3]| at[0] + along[0] * (at[1] + along[1] * at[2]);
        let at =
            |k: usize, along: [usize; 3]| [k % along[0], k / along[0] % along[1], k / along[0] / along[1]];
        let nodes = (0..along.iter().product()).map(|k| {
            let at = at(k, along);
            place(std::array::from_fn(|axis| at[axis] as f64 / steps[axis] as f64))
        });
        let elements = (0..steps.iter().product()).map(|k| {
            let low = at(k, steps);
            let corner = |bits: usize| number(std::array::from_fn(|axis| low[axis] + (bits >> axis & 1)));
            (0..8).map(corner).collect()
        });
        let (nodes, elements): (Vec<_>, Vec<Vec<usize>>) = (nodes.collect(), elements.collect());
        let (young, held) = (vec![1.0; elements.len()], vec![false; nodes.len()]);
        Self { shape: Shape::Hex8, nodes, elements, young, poisson: 0.3, held }
    }

    /// The same with its last layer of nodes along x glued to the first: a ring, if they lie there.
    pub fn closed(mut self) -> Self {
        let mut first: Vec<usize> = (0..self.nodes.len()).collect();
        for (k, here) in self.nodes.iter().enumerate() {
            let near = |other: &[f64; 3]| (0..3).all(|axis| (other[axis] - here[axis]).abs() < 1e-9);
            first[k] = self.nodes.iter().position(near).unwrap_or(k);
        }
        self.keep(&first);
        self
    }

    /// Nodes in place of others; those that nobody has any more are dropped.
    fn keep(&mut self, node: &[usize]) {
        let mut number = vec![usize::MAX; node.len()];
        let (mut nodes, mut held) = (Vec::new(), Vec::new());
        for k in (0..node.len()).filter(|&k| node[k] == k) {
            number[k] = nodes.len();
            nodes.push(self.nodes[k]);
            held.push(self.held[k]);
        }
        self.elements.iter_mut().flatten().for_each(|k| *k = number[node[*k]]);
        (self.nodes, self.held) = (nodes, held);
    }

    /// Six tetrahedra for each hexahedron.
    pub fn tetrahedra(mut self) -> Self {
        let split = |corners: &Vec<usize>| TETS.map(|tet| tet.map(|k| corners[k]).to_vec());
        self.elements = self.elements.iter().flat_map(split).collect();
        self.young = self.young.iter().flat_map(|young| [*young; 6]).collect();
        self.shape = Shape::Tet4;
        self
    }

    /// Tetrahedra with nodes in the middle of their edges.
    pub fn quadratic(mut self) -> Self {
        let mut middles = std::collections::BTreeMap::new();
        for corners in &mut self.elements {
            for edge in EDGES {
                let [a, b] = edge.map(|k| corners[k]);
                let next = self.nodes.len();
                let middle = *middles.entry([a.min(b), a.max(b)]).or_insert(next);
                if middle == next {
                    self.nodes.push(std::array::from_fn(|k| 0.5 * (self.nodes[a][k] + self.nodes[b][k])));
                    self.held.push(self.held[a] && self.held[b]);
                }
                corners.push(middle);
            }
        }
        self.shape = Shape::Tet10;
        self
    }

    /// First unknown of every node that moves, and the number of all unknowns.
    pub fn numbers(&self) -> (Vec<Option<usize>>, usize) {
        let mut count = 0;
        let number = |held: &bool| {
            let own = (!held).then_some(count);
            count += if *held { 0 } else { 3 };
            own
        };
        (self.held.iter().map(number).collect(), count)
    }

    /// What the elements join: held unknown k of all, three for each held node, is -1 - k.
    pub fn connectivity(&self) -> (Vec<usize>, Vec<i64>) {
        let (number, _) = self.numbers();
        let mut held = 0;
        let named = number.iter().map(|own| match own {
            Some(first) => *first as i64,
            None => {
                held += 3;
                2 - held
            }
        });
        let named: Vec<i64> = named.collect();
        let dof = |k: usize, axis: i64| if named[k] < 0 { named[k] - axis } else { named[k] + axis };
        let (mut ptr, mut dofs) = (vec![0], Vec::new());
        for nodes in &self.elements {
            nodes.iter().for_each(|&k| dofs.extend((0..3).map(|axis| dof(k, axis))));
            ptr.push(dofs.len());
        }
        (ptr, dofs)
    }

    /// Stiffness of an element, dense, node by node, force / length.
    pub fn stiffness(&self, element: usize) -> Vec<f64> {
        let nodes = &self.elements[element];
        let order = 3 * nodes.len();
        let (young, poisson) = (self.young[element], self.poisson);
        let lambda = young * poisson / ((1.0 + poisson) * (1.0 - 2.0 * poisson));
        let mu = young / (2.0 * (1.0 + poisson));
        let mut stiffness = vec![0.0; order * order];
        for (weight, local) in self.shape.points() {
            let jacobian: [[f64; 3]; 3] = std::array::from_fn(|i| {
                std::array::from_fn(|j| nodes.iter().zip(&local).map(|(&k, g)| self.nodes[k][i] * g[j]).sum())
            });
            let (inverse, volume) = inverse(jacobian);
            let gradients: Vec<[f64; 3]> = local
                .iter()
                .map(|g| std::array::from_fn(|i| (0..3).map(|j| inverse[j][i] * g[j]).sum()))
                .collect();
            for (a, ga) in gradients.iter().enumerate() {
                for (b, gb) in gradients.iter().enumerate() {
                    let along: f64 = (0..3).map(|k| ga[k] * gb[k]).sum();
                    for i in 0..3 {
                        for j in 0..3 {
                            let shear = if i == j { mu * along } else { 0.0 };
                            stiffness[(3 * a + i) * order + 3 * b + j] +=
                                weight * volume * (lambda * ga[i] * gb[j] + mu * ga[j] * gb[i] + shear);
                        }
                    }
                }
            }
        }
        stiffness
    }
}

impl Shape {
    /// Weight and local gradients of the shape functions at every Gauss point.
    fn points(self) -> Vec<(f64, Vec<[f64; 3]>)> {
        match self {
            Self::Hex8 => (0..8).map(|point| (1.0, hex_gradients(point))).collect(),
            Self::Tet4 => vec![(1.0 / 6.0, corner_gradients().to_vec())],
            Self::Tet10 => (0..4).map(|point| (1.0 / 24.0, tet10_gradients(point))).collect(),
        }
    }
}

/// At the Gauss point whose sign along axis a is bit a of `point`, in [-1, 1]^3.
fn hex_gradients(point: usize) -> Vec<[f64; 3]> {
    let sign = |bits: usize, axis: usize| if bits >> axis & 1 == 1 { 1.0 } else { -1.0 };
    let factor = |node: usize, axis: usize| (1.0 + sign(node, axis) * sign(point, axis) / 3f64.sqrt()) / 2.0;
    let component = |node: usize, axis: usize| {
        let others = (0..3).filter(|&other| other != axis);
        sign(node, axis) / 2.0 * others.map(|other| factor(node, other)).product::<f64>()
    };
    (0..8).map(|node| std::array::from_fn(|axis| component(node, axis))).collect()
}

fn corner_gradients() -> [[f64; 3]; 4] {
    [[-1.0; 3], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]]
}

/// At the Gauss point next to corner `point`.
fn tet10_gradients(point: usize) -> Vec<[f64; 3]> {
    const NEAR: f64 = 0.585_410_196_624_968_5;
    const FAR: f64 = 0.138_196_601_125_010_5;
    let l = |corner: usize| if corner == point { NEAR } else { FAR };
    let g = corner_gradients();
    let corner = |k: usize| g[k].map(|v| (4.0 * l(k) - 1.0) * v);
    let middle =
        |[a, b]: [usize; 2]| std::array::from_fn(|axis| 4.0 * (l(a) * g[b][axis] + l(b) * g[a][axis]));
    (0..4).map(corner).chain(EDGES.map(middle)).collect()
}

/// Inverse and determinant.
fn inverse(a: [[f64; 3]; 3]) -> ([[f64; 3]; 3], f64) {
    let cofactor = |i: usize, j: usize| {
        let (i1, i2, j1, j2) = ((i + 1) % 3, (i + 2) % 3, (j + 1) % 3, (j + 2) % 3);
        a[i1][j1] * a[i2][j2] - a[i1][j2] * a[i2][j1]
    };
    let determinant: f64 = (0..3).map(|j| a[0][j] * cofactor(0, j)).sum();
    (std::array::from_fn(|i| std::array::from_fn(|j| cofactor(j, i) / determinant)), determinant)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::elements::elasticity;

    /// A hexahedron has the stiffness of [`elasticity`]; bodies of tetrahedra do not resist rigid motions and have the volume.
    #[test]
    fn elements_are_those_of_elasticity() {
        let box_ = |at: [f64; 3]| [2.0 * at[0], 1.5 * at[1], at[2]];
        let hex = Mesh::grid([1, 1, 1], box_);
        let known = elasticity(&[2.0, 1.5, 1.0], 1.0, 0.3);
        assert!(hex.stiffness(0).iter().zip(&known).all(|(a, b)| (a - b).abs() < 1e-14));
        for mesh in [hex.clone().tetrahedra(), hex.tetrahedra().quadratic()] {
            let stretched = |k: usize| [0.1 * mesh.nodes[k][0], 0.0, 0.0];
            let turned = |k: usize| [-mesh.nodes[k][1], mesh.nodes[k][0], 0.0];
            let energy = |u: &dyn Fn(usize) -> [f64; 3]| -> f64 {
                let of = |e: usize| {
                    let (k, u): (_, Vec<f64>) =
                        (mesh.stiffness(e), mesh.elements[e].iter().flat_map(|&k| u(k)).collect());
                    (0..u.len())
                        .map(|i| (0..u.len()).map(|j| u[i] * k[i * u.len() + j] * u[j]).sum::<f64>())
                        .sum::<f64>()
                };
                (0..mesh.elements.len()).map(of).sum()
            };
            // (lambda + 2 mu) strain^2 volume
            let expected = (1.0 - 0.3) / (1.3 * 0.4) * 0.01 * 3.0;
            assert!((energy(&stretched) - expected).abs() < 1e-14, "{}", energy(&stretched) / expected);
            assert!(energy(&turned).abs() < 1e-13);
        }
    }
}
