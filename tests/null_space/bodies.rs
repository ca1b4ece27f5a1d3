//! Bodies whose null spaces are known by construction.

use decks::sparse::Triplets;
use decks::{Block, Csr};

/// A box of cubes (or nearly) in 3D with E = 1.
pub fn bar(elements: [usize; 3], size: [f64; 3], poisson: f64) -> Block {
    Block { elements, size, poisson, ..Block::default() }
}

pub fn cube(elements: usize) -> Block {
    bar([elements; 3], [1.0; 3], 0.3)
}

/// The dofs for which `held(grid position, direction)` is true are eliminated.
pub fn held(block: &Block, held: impl Fn([usize; 3], usize) -> bool) -> Csr {
    let free: Vec<usize> = (0..3 * block.nodes()).filter(|dof| !held(block.grid(dof / 3), dof % 3)).collect();
    block.stiffness().restricted(&free)
}

/// Matrices added up; `dofs` says where each row goes.
pub fn assembled(n: usize, parts: &[(&Csr, f64, Vec<usize>)]) -> Csr {
    let mut sum = Triplets::new(n, n);
    for (matrix, factor, dofs) in parts {
        for i in 0..matrix.rows {
            matrix.row(i).for_each(|(j, v)| sum.add(dofs[i], dofs[j], factor * v));
        }
    }
    sum.to_csr()
}

/// Blocks in a row; the last `shared` dofs of each are the first of the next. Blocks alternate.
pub fn chain(blocks: &[&Csr], shared: usize, factors: &[f64]) -> Csr {
    let (mut parts, mut start) = (Vec::new(), 0);
    for (block, factor) in blocks.iter().zip(factors) {
        parts.push((*block, *factor, (start..start + block.rows).collect()));
        start += block.rows - shared;
    }
    assembled(start + shared, &parts)
}

/// 12 x 12 stiffness of a beam of length h along axis 0 or 1 in the plane; six dofs per node, three displacements, then
/// three rotations. Square section of edge t, E = 1, G = 0.4.
fn beam(axis: usize, h: f64, t: f64) -> Csr {
    let (area, inertia) = (t * t, t.powi(4) / 12.0);
    let (x, y, z, sign) = if axis == 0 { (0, 1, 2, 1.0) } else { (1, 0, 2, -1.0) };
    let mut k = Triplets::new(12, 12);
    let mut springs = |dofs: &[usize], values: &[f64]| {
        for (i, &a) in dofs.iter().enumerate() {
            dofs.iter().enumerate().for_each(|(j, &b)| k.add(a, b, values[i * dofs.len() + j]));
        }
    };
    springs(&[x, 6 + x], &[area / h, -area / h, -area / h, area / h]);
    let twist = 0.4 * 2.0 * inertia / h;
    springs(&[3 + x, 9 + x], &[twist, -twist, -twist, twist]);
    // deflection w and slope along the beam: dw/dx = s rotation
    for (w, rotation, s) in [(y, 3 + z, sign), (z, 3 + y, -sign)] {
        let (a, b, c) = (12.0 * inertia / h.powi(3), s * 6.0 * inertia / (h * h), 2.0 * inertia / h);
        let values = [a, b, -a, b, b, 2.0 * c, -b, c, -a, -b, a, -b, b, c, -b, 2.0 * c];
        springs(&[w, rotation, 6 + w, 6 + rotation], &values);
    }
    k.to_csr()
}

/// A grid of beams, edge length 1, n beams along each edge, six dofs per node, with its six rigid motions.
pub fn frame(n: usize, t: f64) -> (Csr, Vec<Vec<f64>>) {
    let node = |i: usize, j: usize| i + (n + 1) * j;
    let (h, beams) = (1.0 / n as f64, [beam(0, 1.0 / n as f64, t), beam(1, 1.0 / n as f64, t)]);
    let mut parts = Vec::new();
    for j in 0..=n {
        for i in 0..=n {
            for (axis, to) in [(0, (i + 1, j)), (1, (i, j + 1))] {
                if to.0 <= n && to.1 <= n {
                    let ends = [node(i, j), node(to.0, to.1)];
                    let dofs = ends.iter().flat_map(|end| 6 * end..6 * end + 6).collect();
                    parts.push((&beams[axis], 1.0, dofs));
                }
            }
        }
    }
    let nodes = (n + 1) * (n + 1);
    let mut modes = vec![vec![0.0; 6 * nodes]; 6];
    for at in 0..nodes {
        let (x, y) = ((at % (n + 1)) as f64 * h, (at / (n + 1)) as f64 * h);
        for mode in 0..6 {
            modes[mode][6 * at + mode] = 1.0;
        }
        modes[3][6 * at + 2] = y;
        modes[4][6 * at + 2] = -x;
        modes[5][6 * at] = -y;
        modes[5][6 * at + 1] = x;
    }
    (assembled(6 * nodes, &parts), modes)
}

/// A square membrane of n x n bilinear elements, free.
pub fn membrane(n: usize) -> Csr {
    let element = Csr::from_dense(4, &decks::elements::bilinear_laplacian());
    let node = |i: usize, j: usize| i + (n + 1) * j;
    let parts: Vec<_> = (0..n * n)
        .map(|e| {
            let (i, j) = (e % n, e / n);
            (&element, 1.0, vec![node(i, j), node(i + 1, j), node(i, j + 1), node(i + 1, j + 1)])
        })
        .collect();
    assembled((n + 1) * (n + 1), &parts)
}
