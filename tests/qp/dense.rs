//! Small dense matrices by rows, independent of the library.

use feti_contact::linalg::Operator;

/// Square or rectangular, `data[i][j]`.
#[derive(Clone, Debug)]
pub struct Dense(pub Vec<Vec<f64>>);

impl Dense {
    pub fn zeros(rows: usize, cols: usize) -> Self {
        Self(vec![vec![0.0; cols]; rows])
    }

    pub fn diagonal(values: &[f64]) -> Self {
        let mut matrix = Self::zeros(values.len(), values.len());
        values.iter().enumerate().for_each(|(i, v)| matrix.0[i][i] = *v);
        matrix
    }

    /// `C'C`: semidefinite of the rank of C.
    pub fn gram(c: &Self) -> Self {
        let m = c.0[0].len();
        let entry = |i: usize, j: usize| c.0.iter().map(|row| row[i] * row[j]).sum();
        Self((0..m).map(|i| (0..m).map(|j| entry(i, j)).collect()).collect())
    }

    pub fn times(&self, x: &[f64]) -> Vec<f64> {
        self.0.iter().map(|row| dot(row, x)).collect()
    }

    pub fn transpose_times(&self, y: &[f64], cols: usize) -> Vec<f64> {
        (0..cols).map(|j| self.0.iter().zip(y).map(|(row, y)| row[j] * y).sum()).collect()
    }
}

impl Operator for Dense {
    fn order(&self) -> usize {
        self.0.len()
    }

    fn apply(&self, x: &[f64], y: &mut [f64]) {
        y.copy_from_slice(&self.times(x));
    }
}

pub fn dot(x: &[f64], y: &[f64]) -> f64 {
    x.iter().zip(y).map(|(x, y)| x * y).sum()
}

pub fn norm(x: &[f64]) -> f64 {
    dot(x, x).sqrt()
}

/// `M x = b` by elimination with complete pivoting; `None` when a pivot is below 1e-9 of the first.
pub fn solve(mut m: Vec<Vec<f64>>, mut b: Vec<f64>) -> Option<Vec<f64>> {
    let n = b.len();
    let mut order: Vec<usize> = (0..n).collect();
    let mut first = 0.0;
    for k in 0..n {
        let places = (k..n).flat_map(|i| (k..n).map(move |j| (i, j)));
        let (i, j) = places.max_by(|p, q| m[p.0][p.1].abs().total_cmp(&m[q.0][q.1].abs()))?;
        first = if k == 0 { m[i][j].abs() } else { first };
        if m[i][j].abs() <= 1e-9 * first {
            return None;
        }
        m.swap(k, i);
        b.swap(k, i);
        m.iter_mut().for_each(|row| row.swap(k, j));
        order.swap(k, j);
        for i in k + 1..n {
            let factor = m[i][k] / m[k][k];
            let (above, below) = m.split_at_mut(i);
            below[0][k..].iter_mut().zip(&above[k][k..]).for_each(|(v, u)| *v -= factor * u);
            b[i] -= factor * b[k];
        }
    }
    let mut x = vec![0.0; n];
    for k in (0..n).rev() {
        let rest: f64 = (k + 1..n).map(|j| m[k][j] * x[order[j]]).sum();
        x[order[k]] = (b[k] - rest) / m[k][k];
    }
    Some(x)
}

/// Rows of `m` that do not depend on the rows before them.
pub fn independent_rows(m: &Dense) -> Vec<usize> {
    let (mut basis, mut kept): (Vec<Vec<f64>>, _) = (Vec::new(), Vec::new());
    for (i, row) in m.0.iter().enumerate() {
        let mut rest = row.clone();
        for q in basis.iter().chain(&basis) {
            let part = dot(q, &rest);
            rest.iter_mut().zip(q).for_each(|(r, q)| *r -= part * q);
        }
        let length = norm(&rest);
        if length > 1e-9 * norm(row) {
            rest.iter_mut().for_each(|r| *r /= length);
            basis.push(rest);
            kept.push(i);
        }
    }
    kept
}
