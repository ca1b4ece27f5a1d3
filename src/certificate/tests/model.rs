//! Small dense models: their correct answers by elimination, and the certificate of any other answer.

use super::nodes::DenseNode;
use super::*;
use crate::body::{grounded, Local};
use crate::linalg::vector::power_of_two_below;
use crate::linalg::{Csr, Matrix, Symmetric};

pub const LIMIT: f64 = 1e-8;

/// A dense matrix by rows.
pub type Dense = Vec<Vec<f64>>;

#[derive(Clone)]
pub struct DenseBody {
    pub k: Dense,
    pub load: Vec<f64>,
    /// Columns, before orthonormalisation.
    pub motions: Vec<Vec<f64>>,
}

/// Rows as (entries, right-hand side, compliance).
pub type DenseRows = Vec<(Vec<(usize, f64)>, f64, f64)>;

#[derive(Clone, Default)]
pub struct DenseModel {
    pub parts: Vec<DenseBody>,
    pub contact: DenseRows,
    pub equalities: DenseRows,
    /// Contact rows that carry a force.
    pub active: Vec<usize>,
    /// A rigid motion that is part of the answer, n or empty, length: given exactly, since elimination would lose digits.
    pub travel: Vec<f64>,
    /// Nodes with friction; their tangential rows are numbered consecutively.
    pub nodes: Vec<DenseNode>,
}

#[derive(Clone, Debug)]
pub struct DenseAnswer {
    pub u: Vec<f64>,
    pub lambda: Vec<f64>,
    pub mu: Vec<f64>,
    pub tangential: Vec<f64>,
}

/// A chain of springs between unknowns, and springs to the ground.
pub fn chain(springs: &[f64], held: &[(usize, f64)]) -> DenseBody {
    let n = springs.len() + 1;
    let mut k = vec![vec![0.0; n]; n];
    for (i, s) in springs.iter().enumerate() {
        k[i][i] += s;
        k[i + 1][i + 1] += s;
        k[i][i + 1] -= s;
        k[i + 1][i] -= s;
    }
    held.iter().for_each(|&(i, s)| k[i][i] += s);
    let motions = if held.is_empty() { vec![vec![1.0; n]] } else { Vec::new() };
    DenseBody { k, load: vec![0.0; n], motions }
}

/// A plane truss, two unknowns per node; bars as (node, node, stiffness).
pub fn truss(nodes: &[[f64; 2]], bars: &[(usize, usize, f64)]) -> DenseBody {
    let n = 2 * nodes.len();
    let mut k = vec![vec![0.0; n]; n];
    for &(a, b, s) in bars {
        let along = [nodes[b][0] - nodes[a][0], nodes[b][1] - nodes[a][1]];
        let length = along[0].hypot(along[1]);
        let ends = [(2 * a, -along[0]), (2 * a + 1, -along[1]), (2 * b, along[0]), (2 * b + 1, along[1])];
        for (i, x) in ends {
            for (j, y) in ends {
                k[i][j] += s * x * y / (length * length);
            }
        }
    }
    let of = |motion: &dyn Fn([f64; 2]) -> [f64; 2]| nodes.iter().flat_map(|x| motion(*x)).collect();
    let motions = vec![of(&|_| [1.0, 0.0]), of(&|_| [0.0, 1.0]), of(&|[x, y]| [-y, x])];
    DenseBody { k, load: vec![0.0; n], motions }
}

impl DenseBody {
    pub fn loaded(mut self, loads: &[(usize, f64)]) -> Self {
        loads.iter().for_each(|&(i, f)| self.load[i] += f);
        self
    }

    fn matrix(&self) -> Symmetric {
        let (mut ptr, mut col, mut val) = (vec![0], Vec::new(), Vec::new());
        for (i, row) in self.k.iter().enumerate() {
            for (j, v) in row.iter().enumerate().take(i + 1).filter(|(j, v)| **v != 0.0 || *j == i) {
                col.push(j as u32);
                val.push(*v);
            }
            ptr.push(col.len());
        }
        Symmetric::new(ptr, col, val)
    }

    fn unit(&self) -> f64 {
        power_of_two_below((0..self.k.len()).map(|i| self.k[i][i]).fold(0.0, f64::max))
    }

    /// Orthonormal in D / unit.
    fn null_space(&self) -> Matrix {
        let (n, unit) = (self.k.len(), self.unit());
        let mut basis: Vec<Vec<f64>> = Vec::new();
        let metric = |i: usize| if self.k[i][i] == 0.0 { 1.0 } else { self.k[i][i] / unit };
        let inner = |a: &[f64], b: &[f64]| (0..n).map(|i| metric(i) * a[i] * b[i]).sum::<f64>();
        for motion in &self.motions {
            let mut v = motion.clone();
            for _ in 0..2 {
                for b in &basis {
                    let part = inner(b, &v);
                    v.iter_mut().zip(b).for_each(|(v, b)| *v -= part * b);
                }
                let length = inner(&v, &v).sqrt();
                v.iter_mut().for_each(|v| *v /= length);
            }
            basis.push(v);
        }
        Matrix { rows: n, cols: basis.len(), data: basis.concat() }
    }
}

/// The solution of a symmetric system scaled to unit diagonal, refined.
pub fn solve(a: &Dense, b: &[f64]) -> Vec<f64> {
    let n = a.len();
    let scale: Vec<f64> = (0..n).map(|i| if a[i][i] > 0.0 { a[i][i] } else { 1.0 }.sqrt().recip()).collect();
    let largest = |i: usize| (0..n).map(|j| (a[i][j] * scale[j]).abs()).fold(0.0, f64::max);
    let scale: Vec<f64> = (0..n).map(|i| if a[i][i] > 0.0 { scale[i] } else { largest(i).recip() }).collect();
    let lu = |b: &[f64]| {
        let mut m: Dense = (0..n)
            .map(|i| {
                let mut row: Vec<f64> = (0..n).map(|j| scale[i] * a[i][j] * scale[j]).collect();
                row.push(scale[i] * b[i]);
                row
            })
            .collect();
        for c in 0..n {
            let p = (c..n).fold(c, |p, i| if m[i][c].abs() > m[p][c].abs() { i } else { p });
            m.swap(c, p);
            for i in c + 1..n {
                let by = m[i][c] / m[c][c];
                if by != 0.0 {
                    let (upper, lower) = m.split_at_mut(i);
                    lower[0].iter_mut().zip(&upper[c]).skip(c).for_each(|(x, y)| *x -= by * y);
                }
            }
        }
        let mut x = vec![0.0; n];
        for i in (0..n).rev() {
            let rest: f64 = (i + 1..n).map(|j| m[i][j] * x[j]).sum();
            x[i] = (m[i][n] - rest) / m[i][i];
        }
        (0..n).map(|i| scale[i] * x[i]).collect::<Vec<f64>>()
    };
    let mut x = lu(b);
    for _ in 0..3 {
        let left: Vec<f64> = (0..n).map(|i| b[i] - (0..n).map(|j| a[i][j] * x[j]).sum::<f64>()).collect();
        x.iter_mut().zip(lu(&left)).for_each(|(x, d)| *x += d);
    }
    x
}

impl DenseModel {
    pub fn unknowns(&self) -> usize {
        self.parts.iter().map(|part| part.k.len()).sum()
    }

    pub fn rows(rows: &DenseRows, n: usize) -> RowSet {
        let mut matrix = Csr::empty(n);
        rows.iter().for_each(|row| matrix.push_row(row.0.iter().copied()));
        RowSet {
            matrix: matrix.into(),
            rhs: rows.iter().map(|row| row.1).collect(),
            compliance: rows.iter().map(|row| row.2).collect::<Vec<_>>().into(),
            ..RowSet::default()
        }
    }

    /// The judgement.
    pub fn judged(&self, point: &DenseAnswer) -> Judgement {
        let n = self.unknowns();
        let (contact, equalities) = (Self::rows(&self.contact, n), Self::rows(&self.equalities, n));
        let matrices: Vec<Symmetric> = self.parts.iter().map(DenseBody::matrix).collect();
        let spaces: Vec<Matrix> = self.parts.iter().map(DenseBody::null_space).collect();
        let grounded: Vec<Vec<u32>> = matrices.iter().map(|k| grounded(k.into()).unwrap()).collect();
        let mut end = 0;
        let ranges = self.parts.iter().map(|part| {
            end += part.k.len();
            end - part.k.len()..end
        });
        let ranges: Vec<_> = ranges.collect();
        let touched = Touched::of(&ranges, 0..n);
        let (tangential, nodes) = (Self::rows(&self.tangential(), n), self.laws());
        let mut bodies = Vec::new();
        for (p, part) in self.parts.iter().enumerate() {
            bodies.push(Seen::Here(Local {
                stiffness: (&matrices[p]).into(),
                null_space: &spaces[p],
                said: None,
                soft: false,
                unit: part.unit(),
                grounded: &grounded[p],
                touched: touched.on(p),
                dual: None,
            }));
        }
        let load = |part: &DenseBody| Load { own: Some(part.load.clone().into()), ..Load::default() };
        let data = Data {
            bodies: Locals::new(bodies, 1),
            loads: Kept::of(self.parts.iter().map(load).collect()),
            touched: &touched,
            contact: &contact,
            equalities: &equalities,
            tangential: &tangential,
            nodes: &nodes,
            limit: LIMIT,
            accuracy: 1e-10,
            unit: None,
        };
        let none = vec![0.0; tangential.len()];
        let tangential = if point.tangential.is_empty() { &none } else { &point.tangential };
        let u = Kept::of(ranges.iter().map(|range| point.u[range.clone()].to_vec()).collect());
        let answer = Candidate { u: &u, at_rows: &point.u, lambda: &point.lambda, mu: &point.mu, tangential };
        certify(&data, answer).unwrap()
    }

    pub fn certificate(&self, point: &DenseAnswer) -> Certificate {
        self.judged(point).certificate
    }

    /// The correct answer passes, also rounded to 15 digits.
    pub fn accepted(&self, name: &str) -> DenseAnswer {
        let right = self.answer();
        let certificate = self.certificate(&right);
        assert!(certificate.worst() <= 0.5, "{name}: {certificate:#?} {right:?}");
        let digits = |v: &Vec<f64>| v.iter().map(|v| format!("{v:.14e}").parse().unwrap()).collect();
        let rounded = DenseAnswer {
            u: digits(&right.u),
            lambda: digits(&right.lambda),
            mu: digits(&right.mu),
            tangential: digits(&right.tangential),
        };
        let certificate = self.certificate(&rounded);
        assert!(certificate.passed(), "{name} in 15 digits: {certificate:#?} {right:?}");
        right
    }

    pub fn refused(&self, name: &str, point: &DenseAnswer) {
        let certificate = self.certificate(point);
        assert!(!certificate.passed(), "{name}: {certificate:#?} {point:?}");
    }

    /// All wrong forces of an answer must be refused.
    pub fn refuses_wrong_forces(&self, name: &str) {
        let right = self.accepted(name);
        let times = |by: f64| {
            let scaled = |v: &[f64]| v.iter().map(|v| by * v).collect::<Vec<_>>();
            DenseAnswer {
                u: right.u.clone(),
                lambda: scaled(&right.lambda),
                mu: scaled(&right.mu),
                tangential: scaled(&right.tangential),
            }
        };
        for by in [1.5, 1.0 + 1e-5, 0.0, -1.0] {
            self.refused(&format!("{name}, all forces x {by}"), &times(by));
        }
        for i in self.active.iter().copied() {
            for by in [0.0, -1.0, 1.0 + 1e-5] {
                let mut wrong = right.clone();
                wrong.lambda[i] *= by;
                self.refused(&format!("{name}, force {i} x {by}"), &wrong);
            }
        }
    }

    /// Any unknown moved by 1e-5 of `deformation` must be refused.
    pub fn refuses_wrong_motions(&self, name: &str, deformation: f64) {
        let right = self.accepted(name);
        for j in 0..right.u.len() {
            for by in [1e-5, -1e-5] {
                let mut wrong = right.clone();
                wrong.u[j] += by * deformation;
                self.refused(&format!("{name}, unknown {j} moved by {by}"), &wrong);
            }
        }
    }
}
