//! Blocks of squares or cubes, one on a rigid plane or three upon each other whose meshes do not match, pressed down and pushed along:
//! the scaled dual problem by dense matrices.

use feti_contact::linalg::{Csr, Matrix, PivotedCholesky};
use feti_contact::qp::friction::{Cones, Node};

use crate::friction::dense::{Dense, OfMatrices};
use crate::friction::problem::{Given, Parts};

#[derive(Clone, Copy, Debug)]
pub struct Deck {
    pub dim: usize,
    pub elements: usize,
    pub blocks: usize,
    pub mu: f64,
    /// Of the load that makes it slide.
    pub load: f64,
    pub height: f64,
    /// Young's modulus of the second block.
    pub contrast: f64,
    pub bound: f64,
    /// Of all lengths and of all forces.
    pub units: (f64, f64),
    /// Angle between the tangential rows and the axes, and between both.
    pub turned: (f64, f64),
}

impl Deck {
    pub fn new(dim: usize, elements: usize, blocks: usize, mu: f64, load: f64) -> Self {
        let height = if blocks == 1 { 0.5 } else { 0.15 };
        let (contrast, bound) = (1.0, 0.0);
        let (units, turned) = ((1.0, 1.0), (0.0, 0.5 * std::f64::consts::PI));
        Self { dim, elements, blocks, mu, load, height, contrast, bound, units, turned }
    }
}

struct Block {
    elements: Vec<usize>,
    /// Coordinates of the nodes.
    points: Vec<Vec<f64>>,
    k: Matrix,
}

impl Block {
    fn new(dim: usize, n: usize, height: f64, young: f64) -> Self {
        let mut elements = vec![n; dim];
        elements[dim - 1] = ((n as f64 * height).round() as usize).max(1);
        let lengths: Vec<f64> = (0..dim).map(|a| if a + 1 < dim { 1.0 } else { height }).collect();
        let h: Vec<f64> = (0..dim).map(|a| lengths[a] / elements[a] as f64).collect();
        let count: usize = elements.iter().map(|n| n + 1).product();
        let digits = |mut k: usize, base: &dyn Fn(usize) -> usize| -> Vec<usize> {
            (0..dim)
                .map(|a| {
                    let digit = k % base(a);
                    k /= base(a);
                    digit
                })
                .collect()
        };
        let number = |at: &[usize]| (0..dim).rev().fold(0, |k, a| k * (elements[a] + 1) + at[a]);
        let points = (0..count)
            .map(|k| digits(k, &|a| elements[a] + 1).iter().zip(&h).map(|(i, h)| *i as f64 * h).collect())
            .collect();
        let element = element(&h, young);
        let mut k = Matrix::zeros(dim * count, dim * count).unwrap();
        for cell in 0..elements.iter().product() {
            let lowest = digits(cell, &|a| elements[a]);
            let corners: Vec<usize> = (0..1 << dim)
                .map(|c: usize| number(&(0..dim).map(|a| lowest[a] + (c >> a & 1)).collect::<Vec<_>>()))
                .collect();
            for (a, p) in corners.iter().enumerate() {
                for (b, q) in corners.iter().enumerate() {
                    for i in 0..dim {
                        for j in 0..dim {
                            let (row, col) = (dim * p + i, dim * q + j);
                            k.set(row, col, k.get(row, col) + element.get(dim * a + i, dim * b + j));
                        }
                    }
                }
            }
        }
        Self { elements, points, k }
    }

    /// Nodes of the upper face with their weights at a place.
    fn above(&self, place: &[f64]) -> Vec<(usize, f64)> {
        let dim = place.len() + 1;
        let cells: Vec<(usize, f64)> = (0..dim - 1)
            .map(|a| {
                let n = self.elements[a];
                let t = (place[a] * n as f64).clamp(0.0, n as f64);
                let i = ((t + 1e-12).floor() as usize).min(n - 1);
                (i, t - i as f64)
            })
            .collect();
        (0..1usize << (dim - 1))
            .filter_map(|c| {
                let bit = |a: usize| c >> a & 1;
                let weight: f64 =
                    (0..dim - 1).map(|a| if bit(a) == 1 { cells[a].1 } else { 1.0 - cells[a].1 }).product();
                let at = |a: usize| if a + 1 < dim { cells[a].0 + bit(a) } else { self.elements[a] };
                let number = (0..dim).rev().fold(0, |k, a| k * (self.elements[a] + 1) + at(a));
                (weight > 1e-12).then_some((number, weight))
            })
            .collect()
    }

    /// Rigid motions, columns over the unknowns.
    fn motions(&self) -> Vec<Vec<f64>> {
        let dim = self.points[0].len();
        let n = self.points.len();
        let mean: Vec<f64> =
            (0..dim).map(|a| self.points.iter().map(|p| p[a]).sum::<f64>() / n as f64).collect();
        let mut motions: Vec<Vec<f64>> =
            (0..dim).map(|a| (0..dim * n).map(|i| f64::from(u8::from(i % dim == a))).collect()).collect();
        for a in 0..dim {
            for b in 0..a {
                let turn = |i: usize| {
                    let p = &self.points[i / dim];
                    if i % dim == a {
                        p[b] - mean[b]
                    } else if i % dim == b {
                        mean[a] - p[a]
                    } else {
                        0.0
                    }
                };
                motions.push((0..dim * n).map(turn).collect());
            }
        }
        motions
    }

    /// Share of each node in the block, or in its upper face.
    fn share(&self, upper: bool) -> Vec<f64> {
        let dim = self.elements.len();
        let mut share: Vec<f64> = (0..self.points.len())
            .map(|mut k| {
                (0..dim)
                    .map(|a| {
                        let i = k % (self.elements[a] + 1);
                        k /= self.elements[a] + 1;
                        let last = i == self.elements[a];
                        match (upper && a + 1 == dim, last || i == 0) {
                            (true, _) => f64::from(u8::from(last)),
                            (false, true) => 0.5,
                            (false, false) => 1.0,
                        }
                    })
                    .product()
            })
            .collect();
        let sum: f64 = share.iter().sum();
        share.iter_mut().for_each(|v| *v /= sum);
        share
    }
}

/// Square or cube of linear displacements, Poisson's ratio .3, plane strain.
fn element(h: &[f64], young: f64) -> Matrix {
    let (dim, poisson) = (h.len(), 0.3);
    let lame = young * poisson / ((1.0 + poisson) * (1.0 - 2.0 * poisson));
    let shear = young / 2.0 / (1.0 + poisson);
    let (corners, place) = (1usize << dim, 1.0 / 3f64.sqrt());
    let sign = |c: usize, a: usize| if c >> a & 1 == 1 { 1.0 } else { -1.0 };
    let volume: f64 = h.iter().map(|h| 0.5 * h).product();
    let mut k = Matrix::zeros(dim * corners, dim * corners).unwrap();
    for point in 0..corners {
        let slope = |c: usize, a: usize| -> f64 {
            let others: f64 = (0..dim)
                .filter(|b| *b != a)
                .map(|b| 0.5 * (1.0 + sign(c, b) * sign(point, b) * place))
                .product();
            sign(c, a) / h[a] * others
        };
        for p in 0..corners {
            for q in 0..corners {
                let same: f64 = (0..dim).map(|a| slope(p, a) * slope(q, a)).sum();
                for i in 0..dim {
                    for j in 0..dim {
                        let mut v = lame * slope(p, i) * slope(q, j) + shear * slope(p, j) * slope(q, i);
                        v += if i == j { shear * same } else { 0.0 };
                        let (row, col) = (dim * p + i, dim * q + j);
                        k.set(row, col, k.get(row, col) + volume * v);
                    }
                }
            }
        }
    }
    k
}

/// One row over the unknowns of all blocks, with its gap.
type Row = Vec<(usize, f64)>;

impl Deck {
    pub fn given(&self) -> Given {
        let dim = self.dim;
        let (length, force) = self.units;
        let n = self.elements;
        let counts = if self.blocks == 1 { vec![n] } else { vec![n, (3 * n / 4).max(2), (n - 1).max(2)] };
        let blocks: Vec<Block> = counts
            .iter()
            .enumerate()
            .map(|(b, &n)| Block::new(dim, n, self.height, if b == 1 { self.contrast } else { 1.0 }))
            .collect();
        let mut first = vec![0];
        blocks.iter().for_each(|block| first.push(first[first.len() - 1] + block.k.rows));
        let (mut rows, mut gaps, mut nodes): (Vec<Row>, Vec<f64>, Vec<Vec<usize>>) = Default::default();
        for (b, block) in blocks.iter().enumerate() {
            for (i, point) in block.points.iter().enumerate().filter(|(_, point)| point[dim - 1] < 1e-12) {
                let place = &point[..dim - 1];
                let below = if b > 0 { blocks[b - 1].above(place) } else { Vec::new() };
                let mut add = |direction: &[f64], gap: f64| {
                    let own = (first[b] + dim * i, 1.0);
                    let others = below.iter().map(|(k, w)| (first[b - 1] + dim * k, -w));
                    let all = std::iter::once(own).chain(others);
                    rows.push(
                        all.flat_map(|(at, w)| {
                            direction.iter().enumerate().map(move |(c, d)| (at + c, w * d))
                        })
                        .collect(),
                    );
                    gaps.push(gap);
                    rows.len() - 1
                };
                let mut normal = vec![0.0; dim];
                normal[dim - 1] = -1.0;
                let far: f64 = place.iter().map(|x| (x - 0.5) * (x - 0.5)).sum();
                let mut own = vec![add(&normal, 2e-3 * far * (1.0 + 0.3 * b as f64))];
                for c in 0..dim - 1 {
                    let mut along = vec![0.0; dim];
                    along[c] = 1.0;
                    if dim == 3 {
                        let angle = self.turned.0 + if c == 1 { self.turned.1 } else { 0.0 };
                        (along[0], along[1]) = (angle.cos(), angle.sin());
                    }
                    own.push(add(&along, 0.0));
                }
                nodes.push(own);
            }
        }
        // pressure above, a push in the middle of the highest block
        let mut load = vec![0.0; first[blocks.len()]];
        let (at, highest) = (first[blocks.len() - 1], &blocks[blocks.len() - 1]);
        let pressure = 1e-3;
        let push = if dim == 2 { vec![1.0, 0.0] } else { vec![0.3f64.cos(), 0.3f64.sin(), 0.0] };
        for (k, (upper, whole)) in highest.share(true).iter().zip(highest.share(false)).enumerate() {
            load[at + dim * k + dim - 1] -= pressure * upper;
            (0..dim).for_each(|c| load[at + dim * k + c] += self.load * self.mu * pressure * push[c] * whole);
        }
        gaps.iter_mut().for_each(|gap| *gap *= length);
        load.iter_mut().for_each(|f| *f *= force);
        let stiffness: Vec<Matrix> = blocks.iter().map(|block| scaled(&block.k, force / length)).collect();
        let motions: Vec<Vec<Vec<f64>>> = blocks.iter().map(Block::motions).collect();
        let law = (self.mu, self.bound * force);
        dual((&stiffness, &motions, &first), (&rows, &gaps, &nodes), &load, law)
    }
}

fn scaled(k: &Matrix, by: f64) -> Matrix {
    Matrix { data: k.data.iter().map(|v| v * by).collect(), ..k.clone() }
}

/// The scaled dual of bodies with their motions, rows with gaps and nodes: F, d, G, e, cones, and the preconditioner of Dirichlet.
fn dual(
    (k, motions, first): (&[Matrix], &[Vec<Vec<f64>>], &[usize]),
    (rows, gaps, nodes): (&[Row], &[f64], &[Vec<usize>]),
    load: &[f64],
    (mu, bound): (f64, f64),
) -> Given {
    let (m, n) = (rows.len(), load.len());
    let diagonal: Vec<f64> = k.iter().flat_map(|k| (0..k.rows).map(|i| k.get(i, i))).collect();
    let square = |row: &Row| row.iter().map(|(j, v)| v * v / diagonal[*j]).sum::<f64>();
    let mut scale = vec![1.0; m];
    let mut cones = Vec::new();
    for own in nodes {
        let tangents = &own[1..];
        scale[own[0]] = 1.0 / square(&rows[own[0]]).sqrt();
        let mean = tangents.iter().map(|&i| square(&rows[i])).sum::<f64>() / tangents.len() as f64;
        let along = if mean > 0.0 { 1.0 / mean.sqrt() } else { 1.0 };
        tangents.iter().for_each(|&i| scale[i] = along);
        cones.push(Node::new(Some(own[0]), tangents, mu * scale[own[0]] / along, bound / along).unwrap());
    }
    let mut b = Matrix::zeros(n, m).unwrap();
    for (i, row) in rows.iter().enumerate() {
        row.iter().for_each(|(j, v)| b.set(*j, i, scale[i] * v));
    }
    let (mut f, mut middle, mut coupling) =
        (Matrix::zeros(m, m).unwrap(), Matrix::zeros(m, m).unwrap(), Matrix::zeros(m, m).unwrap());
    let mut d: Vec<f64> = gaps.iter().zip(&scale).map(|(gap, s)| -gap * s).collect();
    let mut g_rows: Vec<Vec<f64>> = Vec::new();
    let mut e = Vec::new();
    let mut boundaries = Vec::new();
    for (p, k) in k.iter().enumerate() {
        let (from, size) = (first[p], k.rows);
        let own = Matrix::from_fn(size, m, |i, j| b.get(from + i, j)).unwrap();
        let inverse = PivotedCholesky::new(k.clone()).unwrap().unwrap();
        assert_eq!(inverse.rank(), size - motions[p].len(), "rank of a block");
        let images = inverse.solve(&own).unwrap();
        add_product(&own, &images, &mut f);
        let force = Matrix { rows: size, cols: 1, data: load[from..from + size].to_vec() };
        let moved = inverse.solve(&force).unwrap();
        own.mul_transposed(moved.col(0)).iter().zip(&mut d).for_each(|(v, d)| *d += v);
        let weighted = Matrix::from_fn(size, m, |i, j| own.get(i, j) / diagonal[from + i]).unwrap();
        add_product(&own, &weighted, &mut coupling);
        let touched: Vec<usize> = (0..size).filter(|&i| (0..m).any(|j| own.get(i, j) != 0.0)).collect();
        let schur = schur(k, &touched);
        let on_touched = Matrix::from_fn(touched.len(), m, |i, j| weighted.get(touched[i], j)).unwrap();
        let mut forces = Matrix::zeros(touched.len(), m).unwrap();
        (0..m).for_each(|j| schur.mul_add(1.0, on_touched.col(j), forces.col_mut(j)));
        add_product(&on_touched, &forces, &mut middle);
        boundaries.push((touched.iter().map(|i| from + i).collect(), schur));
        let before = g_rows.len();
        for motion in &motions[p] {
            let size = motion.iter().enumerate().map(|(i, v)| v * v * diagonal[from + i]).sum::<f64>().sqrt();
            let motion: Vec<f64> = motion.iter().map(|v| v / size).collect();
            g_rows.push(own.mul_transposed(&motion));
            e.push(motion.iter().zip(&load[from..]).map(|(v, f)| v * f).sum::<f64>());
        }
        let norm = g_rows[before..].iter().flatten().map(|v| v * v).sum::<f64>().sqrt();
        g_rows[before..].iter_mut().flatten().for_each(|v| *v /= norm);
        e[before..].iter_mut().for_each(|v| *v /= norm);
    }
    let mut g_transposed = Csr::empty(g_rows.len());
    for i in 0..m {
        let entries: Vec<(usize, f64)> =
            g_rows.iter().enumerate().map(|(k, row)| (k, row[i])).filter(|(_, v)| *v != 0.0).collect();
        g_transposed.push_row(entries);
    }
    let preconditioner = Some(OfMatrices { coupling, middle });
    let mut by_rows = Csr::empty(n);
    for i in 0..m {
        let column = b.col(i);
        by_rows.push_row((0..n).filter(|&j| column[j] != 0.0).map(|j| (j, column[j])));
    }
    let parts = Some(Parts { b: by_rows, metric: diagonal, boundaries });
    let cones = Cones::new(m, cones).unwrap();
    Given { f: Dense(f), d, g_transposed, e, cones, preconditioner, parts }
}

/// `sum += A'B`
fn add_product(a: &Matrix, b: &Matrix, sum: &mut Matrix) {
    for j in 0..b.cols {
        let image = a.mul_transposed(b.col(j));
        sum.col_mut(j).iter_mut().zip(image).for_each(|(s, v)| *s += v);
    }
}

/// `K_ss - K_si K_ii^-1 K_is`
fn schur(k: &Matrix, s: &[usize]) -> Matrix {
    let inner: Vec<usize> = (0..k.rows).filter(|i| s.binary_search(i).is_err()).collect();
    let part =
        |a: &[usize], b: &[usize]| Matrix::from_fn(a.len(), b.len(), |i, j| k.get(a[i], b[j])).unwrap();
    let mut schur = part(s, s);
    if inner.is_empty() {
        return schur;
    }
    let outer = part(&inner, s);
    let solved = PivotedCholesky::new(part(&inner, &inner)).unwrap().unwrap().solve(&outer).unwrap();
    for j in 0..s.len() {
        let image = outer.mul_transposed(solved.col(j));
        schur.col_mut(j).iter_mut().zip(image).for_each(|(s, v)| *s -= v);
    }
    schur
}
