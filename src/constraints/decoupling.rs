//! The rows in another basis, `B = L B'`: equality rows that share unknowns are orthonormal in the metric `D^-1`,
//! and contact rows are orthogonal to them and of unit length. With `c = L c'` and `lambda' = L'lambda` the problem is equivalent;
//! forces of contact rows keep their sign, because no row is combined with a contact row. A contact row on one of
//! several glued dofs therefore has the weight of all of them together, however soft its own dof is.

use std::ops::Range;

use crate::constraints::accumulator::Accumulator;
use crate::error::Result;
use crate::linalg::graph::components;
use crate::linalg::{Csr, Symmetric};
use crate::numbers::linalg::ROOT;
use crate::numbers::rows::REMAINDER;
use crate::platform::memory::{filled, headroom};

/// Limit of rows per cluster; mortar rows can connect a whole surface.
const LARGEST: usize = 32;

const WHAT: &str = "the decoupling of rows";

/// L, m x m: lower triangular, the diagonal positive and the last entry of every row.
#[derive(Debug, Clone, PartialEq)]
pub struct Decoupling {
    /// m
    count: usize,
    /// None: L = I.
    rows: Option<Box<Csr>>,
}

/// Rows scaled so that `B D^-1 B' + C` has the diagonal 1 (mean over the rows of a node): equality rows, contact rows,
/// tangential rows.
#[derive(Debug, Clone, Copy)]
pub struct UnitRows<'a> {
    /// B, m x n.
    pub matrix: &'a Csr,
    /// Number of equality rows.
    pub equalities: usize,
    /// The tangential rows of each node with friction.
    pub nodes: &'a [Range<usize>],
    /// Diagonal of C, no unit.
    pub compliance: &'a [f64],
    /// D over the unknowns.
    pub metric: &'a [f64],
}

impl Decoupling {
    /// L and `B'`, none if L = I. Compliant equality rows, large or redundant clusters of equality rows, and contact rows that are
    /// nearly combinations of equality rows are not changed.
    pub fn of(given: UnitRows) -> Result<(Self, Option<Csr>)> {
        let (matrix, m) = (given.matrix, given.matrix.rows());
        let _room = headroom(64 * (matrix.val.len() + m + matrix.cols), WHAT)?;
        let mut work = Orthogonalisation::new(given)?;
        let mut cluster_of = filled(matrix.cols, None, WHAT)?;
        let clusters = clusters(given)?;
        for (number, cluster) in clusters.iter().enumerate() {
            if work.orthonormalise(cluster) {
                let touched = cluster.iter().flat_map(|&i| matrix.row(i));
                touched.for_each(|(j, _)| cluster_of[j] = Some(number));
            }
        }
        let equalities_at = |i: usize| -> Vec<usize> {
            let mut met: Vec<usize> = matrix.row(i).filter_map(|(j, _)| cluster_of[j]).collect();
            met.sort_unstable();
            met.dedup();
            met.iter().flat_map(|&c| clusters[c].iter().copied()).collect()
        };
        let tangential = given.nodes.first().map_or(m, |node| node.start);
        for i in given.equalities..tangential {
            work.clear_contact_row(i, &equalities_at(i));
        }
        for node in given.nodes {
            work.clear_node(node.clone(), equalities_at);
        }
        Ok(work.finish())
    }

    /// L = I, of m rows.
    pub fn none(count: usize) -> Self {
        Self { count, rows: None }
    }

    /// l_ii: `lambda_i = x_i / l_ii` if no later row is combined with row i.
    pub fn factor(&self, i: usize) -> f64 {
        self.diagonal(i)
    }

    /// `c' = L^-1 c`
    pub fn solve(&self, mut c: Vec<f64>) -> Vec<f64> {
        for i in 0..c.len() {
            let known: f64 = self.below(i).map(|(j, l)| l * c[j]).sum();
            c[i] = (c[i] - known) / self.diagonal(i);
        }
        c
    }

    /// `lambda = L'^-1 lambda'`; entries beyond the rows are dropped.
    pub fn solve_transposed(&self, mut x: Vec<f64>) -> Vec<f64> {
        x.truncate(self.count);
        for i in (0..x.len()).rev() {
            let value = x[i] / self.diagonal(i);
            x[i] = value;
            self.below(i).for_each(|(j, l)| x[j] -= l * value);
        }
        x
    }

    /// `c = L c'`; entries beyond the rows are ignored.
    pub fn apply(&self, c: &[f64]) -> Vec<f64> {
        (0..self.count).map(|i| self.row(i).map(|(j, l)| l * c[j]).sum()).collect()
    }

    /// `lambda' = L'lambda`
    pub fn apply_transposed(&self, x: &[f64]) -> Vec<f64> {
        let mut y = vec![0.0; x.len()];
        for (i, x) in x.iter().enumerate().filter(|(_, x)| **x != 0.0) {
            self.row(i).for_each(|(j, l)| y[j] += x * l);
        }
        y
    }

    /// The diagonal of C' in `C = L C'L'`: compliant rows are not combined with others.
    pub fn compliance(&self, c: &[f64]) -> Vec<f64> {
        (0..c.len()).map(|i| c[i] / self.diagonal(i).powi(2)).collect()
    }

    fn diagonal(&self, i: usize) -> f64 {
        self.rows.as_ref().map_or(1.0, |rows| rows.val[rows.ptr[i + 1] - 1])
    }

    fn below(&self, i: usize) -> impl Iterator<Item = (usize, f64)> + '_ {
        self.rows.iter().flat_map(move |rows| rows.row(i)).take_while(move |(j, _)| *j < i)
    }

    fn row(&self, i: usize) -> impl Iterator<Item = (usize, f64)> + '_ {
        self.below(i).chain([(i, self.diagonal(i))])
    }
}

/// Groups of rigid equality rows that share unknowns, at most `LARGEST` rows each, ascending.
fn clusters(given: UnitRows) -> Result<Vec<Vec<usize>>> {
    let mut last = filled(given.matrix.cols, None, WHAT)?;
    let mut joined = Symmetric::empty();
    let is_rigid = |i: &usize| given.compliance[*i] == 0.0;
    for i in 0..given.equalities {
        let mut neighbours = vec![i];
        if is_rigid(&i) {
            neighbours.extend(given.matrix.row(i).filter_map(|(j, _)| last[j].replace(i)));
        }
        neighbours.sort_unstable();
        neighbours.dedup();
        joined.push_row(neighbours.into_iter().map(|j| (j, 1.0)));
    }
    let (cluster, count) = components(&joined);
    let mut clusters = vec![Vec::new(); count];
    (0..given.equalities).filter(is_rigid).for_each(|i| clusters[cluster[i]].push(i));
    clusters.retain(|rows| (1..=LARGEST).contains(&rows.len()));
    Ok(clusters)
}

type Combination = Vec<(usize, f64)>;

struct Orthogonalisation<'a> {
    given: UnitRows<'a>,
    /// Rows of B' and of L that differ from those of B and I.
    changed: Vec<Option<(Combination, Combination)>>,
    sum: Accumulator,
}

impl<'a> Orthogonalisation<'a> {
    fn new(given: UnitRows<'a>) -> Result<Self> {
        let changed = filled(given.matrix.rows(), None, WHAT)?;
        Ok(Self { given, changed, sum: Accumulator::new(given.matrix.cols)? })
    }

    /// False if the cluster may be redundant: then it is not changed.
    fn orthonormalise(&mut self, cluster: &[usize]) -> bool {
        for (at, &i) in cluster.iter().enumerate() {
            let parts = self.cleared(i, &cluster[..at]);
            let square = self.sum.square(self.given.metric);
            if square <= ROOT {
                cluster.iter().for_each(|&i| self.changed[i] = None);
                return false;
            }
            // without parts it has its length already
            if !parts.is_empty() {
                self.store(i, parts, square.sqrt());
            }
        }
        true
    }

    fn clear_contact_row(&mut self, i: usize, equalities: &[usize]) {
        let parts = self.cleared(i, equalities);
        let square = self.sum.square(self.given.metric);
        let before: f64 = self.given.matrix.row(i).map(|(j, v)| v * v / self.given.metric[j]).sum();
        if !parts.is_empty() && square > REMAINDER * REMAINDER * before {
            self.store(i, parts, (square + self.given.compliance[i]).sqrt());
        }
    }

    /// One scale factor for all rows of a node, so that the disc of admissible forces remains a disc; all rows change
    /// or none, also those that no equality row meets.
    fn clear_node(&mut self, node: Range<usize>, equalities_at: impl Fn(usize) -> Vec<usize>) {
        let (mut squares, mut changes) = (0.0, false);
        for i in node.clone() {
            changes |= !self.cleared(i, &equalities_at(i)).is_empty();
            let square = self.sum.square(self.given.metric);
            let before: f64 = self.given.matrix.row(i).map(|(j, v)| v * v / self.given.metric[j]).sum();
            if square < REMAINDER * REMAINDER * before {
                return;
            }
            squares += square + self.given.compliance[i];
        }
        if !changes {
            return;
        }
        let factor = (squares / node.len() as f64).sqrt();
        for i in node {
            // the sum holds one row at a time
            let parts = self.cleared(i, &equalities_at(i));
            self.store(i, parts, factor);
        }
    }

    /// Leaves `b_i - sum l_k b'_k` in the sum and returns the l_k that are not zero: Gram-Schmidt, twice.
    fn cleared(&mut self, i: usize, against: &[usize]) -> Combination {
        let matrix = self.given.matrix;
        self.sum.reset();
        matrix.row(i).for_each(|(j, v)| self.sum.add(j, v));
        let mut parts = vec![0.0; against.len()];
        for _ in 0..2 {
            for (part, &k) in parts.iter_mut().zip(against) {
                let more = match &self.changed[k] {
                    Some((row, _)) => self.sum.clear(row.iter().copied(), self.given.metric),
                    None => self.sum.clear(matrix.row(k), self.given.metric),
                };
                *part += more;
            }
        }
        against.iter().copied().zip(parts).filter(|(_, part)| *part != 0.0).collect()
    }

    /// `b_i = sum l_k b'_k + length b'_i`
    fn store(&mut self, i: usize, mut parts: Combination, length: f64) {
        parts.sort_unstable_by_key(|(k, _)| *k);
        parts.push((i, length));
        self.changed[i] = Some((self.sum.divided(length), parts));
    }

    fn finish(self) -> (Decoupling, Option<Csr>) {
        let count = self.changed.len();
        if self.changed.iter().all(Option::is_none) {
            return (Decoupling::none(count), None);
        }
        let (mut rows, mut matrix) = (Csr::empty(count), Csr::empty(self.given.matrix.cols));
        for (i, changed) in self.changed.into_iter().enumerate() {
            match changed {
                Some((row, parts)) => {
                    matrix.push_row(row);
                    rows.push_row(parts);
                }
                None => {
                    matrix.push_row(self.given.matrix.row(i));
                    rows.push_row([(i, 1.0)]);
                }
            }
        }
        (Decoupling { count, rows: Some(Box::new(rows)) }, Some(matrix))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Rows over the metric, scaled to `b D^-1 b' + 1/k = 1`; rows without compliance are rigid.
    fn rows(metric: &[f64], rows: &[&[(usize, f64)]], compliance: &[f64]) -> (Csr, Vec<f64>) {
        let (mut matrix, mut scaled) = (Csr::empty(metric.len()), Vec::new());
        for (i, row) in rows.iter().enumerate() {
            let inv_k = compliance.get(i).copied().unwrap_or(0.0);
            let length = (row.iter().map(|(j, v)| v * v / metric[*j]).sum::<f64>() + inv_k).sqrt();
            matrix.push_row(row.iter().map(|(j, v)| (*j, v / length)));
            scaled.push(inv_k / (length * length));
        }
        (matrix, scaled)
    }

    fn product(a: &Csr, i: usize, b: &Csr, j: usize, metric: &[f64]) -> f64 {
        let mut dense = vec![0.0; metric.len()];
        a.row(i).for_each(|(k, v)| dense[k] = v / metric[k]);
        b.row_dot(j, &dense)
    }

    /// `b'_i D^-1 b'_j` = 1 or 0, and `B = L B'`.
    fn assert_orthonormal(given: &Csr, metric: &[f64], (decoupling, matrix): &(Decoupling, Csr)) {
        for i in 0..matrix.rows() {
            for j in 0..matrix.rows() {
                let expected = f64::from(u8::from(i == j));
                let found = product(matrix, i, matrix, j, metric);
                assert!((found - expected).abs() < 1e-12, "{i} {j}: {found}");
            }
        }
        for k in 0..metric.len() {
            let column = |a: &Csr, i: usize| a.row(i).find(|(j, _)| *j == k).map_or(0.0, |(_, v)| v);
            let new: Vec<f64> = (0..matrix.rows()).map(|i| column(matrix, i)).collect();
            for (i, v) in decoupling.apply(&new).iter().enumerate() {
                assert!((v - column(given, i)).abs() < 1e-14 * metric[k].sqrt(), "{i} {k}");
            }
        }
    }

    fn decoupled(matrix: &Csr, equalities: usize, compliance: &[f64], metric: &[f64]) -> (Decoupling, Csr) {
        let given = UnitRows { matrix, equalities, nodes: &[], compliance, metric };
        let (decoupling, changed) = Decoupling::of(given).unwrap();
        (decoupling, changed.unwrap_or_else(|| matrix.clone()))
    }

    /// Four copies of a node joined in a chain, a contact row on the softest: the contact row acts on all of them.
    #[test]
    fn rows_of_a_cluster_become_orthonormal_and_contact_weighs_as_the_whole_node() {
        let metric = [1.0, 1e6, 1e3, 7.0, 5.0];
        let chain: [&[(usize, f64)]; 5] = [
            &[(0, 1.0), (1, -1.0)],
            &[(1, 1.0), (2, -1.0)],
            &[(2, 1.0), (3, -1.0)],
            &[(0, 1.0)],
            &[(3, -2.0), (4, 1.0)],
        ];
        let (given, compliance) = rows(&metric, &chain[..4], &[]);
        let found = decoupled(&given, 3, &compliance, &metric);
        assert_orthonormal(&given, &metric, &found);
        let total: f64 = metric[..4].iter().sum();
        for (j, v) in found.1.row(3) {
            assert!((v / (metric[j] / total.sqrt()) - 1.0).abs() < 1e-10, "{j}: {v}");
        }
        assert!((found.0.diagonal(3) - (1.0 / total).sqrt()).abs() < 1e-13);
        // two contact rows on one node are not made orthogonal to each other: their signs would mix
        let (given, compliance) = rows(&metric, &chain, &[]);
        let (_, matrix) = decoupled(&given, 3, &compliance, &metric);
        let meet = product(&matrix, 3, &matrix, 4, &metric);
        assert!(meet < -1e-3 && (0..3).all(|k| product(&matrix, 4, &matrix, k, &metric).abs() < 1e-12));
    }

    #[test]
    fn a_spring_in_a_contact_row_stays_and_counts_in_its_length() {
        let metric = [1.0, 9.0];
        let (given, compliance) = rows(&metric, &[&[(0, 1.0), (1, -1.0)], &[(0, 1.0)]], &[0.0, 0.3]);
        let (decoupling, matrix) = decoupled(&given, 1, &compliance, &metric);
        let new = decoupling.compliance(&compliance);
        // D of the node is 10: 1/10 + 0.3 = 0.4
        assert!((product(&matrix, 1, &matrix, 1, &metric) - 0.25).abs() < 1e-14, "{matrix:?}");
        assert!((new[1] - 0.75).abs() < 1e-14 && new[0] == 0.0);
    }

    /// Redundant clusters, clusters too large and compliant equality rows are not changed, nor are contact rows on them.
    /// A contact row with a remainder of a millionth beside the glue is not changed either.
    #[test]
    fn rows_that_are_to_stay_are_the_same_bits() {
        let ring = vec![vec![(0, 1.0), (1, -1.0)], vec![(1, 1.0), (2, -1.0)], vec![(0, -1.0), (2, 1.0)]];
        let chain: Vec<Vec<(usize, f64)>> = (0..=LARGEST).map(|i| vec![(i, 1.0), (i + 1, -1.0)]).collect();
        let pair = vec![vec![(0, 1.0), (1, -1.0)]];
        let uniform = vec![1.0; LARGEST + 2];
        let contrast = vec![1.0, 1e12];
        let cases = [(ring, uniform.clone(), 0.0), (chain, uniform, 0.0)]
            .into_iter()
            .chain([(pair.clone(), vec![1.0; 2], 0.1), (pair, contrast, 0.0)]);
        for (mut all, metric, inv_k) in cases {
            let equalities = all.len();
            all.push(vec![(0, 1.0)]);
            let all: Vec<&[(usize, f64)]> = all.iter().map(Vec::as_slice).collect();
            let (given, compliance) = rows(&metric, &all, &vec![inv_k; equalities]);
            let (decoupling, matrix) = decoupled(&given, equalities, &compliance, &metric);
            assert_eq!(matrix, given);
            assert_eq!(decoupling.compliance(&compliance), compliance);
        }
    }

    #[test]
    fn solutions_undo_products_and_open_contact_stays_open() {
        let metric = [1.0, 50.0, 3.0];
        let all: [&[(usize, f64)]; 3] = [&[(0, 1.0), (1, -1.0)], &[(1, 1.0), (2, 1.0)], &[(0, 1.0)]];
        let (given, compliance) = rows(&metric, &all, &[]);
        let (decoupling, _) = decoupled(&given, 2, &compliance, &metric);
        let x = vec![1.0, -2.0, 3.0];
        let near = |y: &[f64]| y.iter().zip(&x).all(|(y, x)| (y - x).abs() < 1e-13);
        assert!(near(&decoupling.solve(decoupling.apply(&x))));
        assert!(near(&decoupling.solve_transposed(decoupling.apply_transposed(&x))));
        // c'(L'^-1 x) = (L^-1 c)'x: both forms give the same work
        let c = vec![0.3, 0.7, -0.2];
        let work = |a: &[f64], b: &[f64]| crate::linalg::vector::dot(a, b);
        let difference =
            work(&c, &decoupling.solve_transposed(x.clone())) - work(&decoupling.solve(c.clone()), &x);
        assert!(difference.abs() < 1e-13);
        assert_eq!(decoupling.solve_transposed(vec![1.0, 2.0, 0.0])[2], 0.0);
        assert!(decoupling.solve_transposed(vec![-9.0, 8.0, 1e-9])[2] > 0.0);
    }
}
