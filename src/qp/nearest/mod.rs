//! `a = argmin |a - a0|` subject to `A a <= g`: the dual active-set method of Goldfarb and Idnani (1983) with unit
//! Hessian. It ends after finitely many steps, even for linearly dependent rows, and shows which rows cannot be satisfied
//! together.

use crate::error::{Error, Kind, Result};
use crate::linalg::graph::joined;
use crate::linalg::vector::{axpy, dot, norm, norm_max, power_of_two_below, NOISE};
use crate::linalg::{Csr, Matrix};
use crate::numbers::linalg::SINGULAR;
use crate::numbers::qp::DISTANCE_FALLS;
use crate::platform::interrupt;

/// Each pass removes from the rows the rounding of the previous one.
const PASSES: usize = 2;

/// The problem: A, m x d, its gaps g, +infinity for no restriction, with the error `noise`, and a0, with the error
/// `rounding` |a0|.
#[derive(Clone, Copy)]
pub struct Polyhedron<'a> {
    pub rows: &'a Csr,
    pub gap: &'a [f64],
    pub target: &'a [f64],
    pub noise: &'a [f64],
    pub rounding: f64,
}

/// The solution of the problem.
pub struct Nearest {
    /// a, d entries.
    pub point: Vec<f64>,
    /// Forces l >= 0 of the rows with `a = a0 - A'l`, m entries.
    pub forces: Vec<f64>,
    /// Weights w >= 0 of rows with `A'w = 0` and `g'w < 0`, up to rounding: these rows were left out.
    pub contradictions: Vec<Vec<(usize, f64)>>,
}

/// Columns that no row connects are solved separately; columns without rows keep their values of a0.
pub fn nearest_point(of: Polyhedron) -> Result<Nearest> {
    let Polyhedron { rows: matrix, gap, target, noise, rounding } = of;
    let length = |i: usize| matrix.row(i).map(|(_, v)| v * v).sum::<f64>().sqrt();
    let rows: Vec<usize> =
        (0..matrix.rows()).filter(|&i| gap[i] < f64::INFINITY && length(i) > 0.0).collect();
    let asked = rows.iter().map(|&i| -gap[i] / length(i)).fold(norm_max(target), f64::max);
    let unit = power_of_two_below(asked);
    let entries = |i: usize| matrix.row(i).filter(|(_, v)| *v != 0.0);
    let columns = |&i: &usize| entries(i).map(|entry| entry.0);
    let (part_of, count) = joined(target.len(), rows.iter().map(columns));
    let (mut local, mut parts) = (vec![0; target.len()], vec![ConnectedColumns::default(); count]);
    for (j, &part) in part_of.iter().enumerate() {
        (local[j], parts[part].rows.cols) = (parts[part].rows.cols, parts[part].rows.cols + 1);
        parts[part].target.push(target[j] / unit);
    }
    for (i, first) in rows.into_iter().filter_map(|i| Some((i, entries(i).next()?.0))) {
        let (part, length) = (&mut parts[part_of[first]], length(i));
        part.rows.push_row(entries(i).map(|(j, v)| (local[j], v / length)));
        part.gap.push(gap[i] / unit / length);
        part.noise.push(noise[i] / unit / length);
        part.row.push((i, length));
    }
    let mut found = Nearest { point: Vec::new(), forces: vec![0.0; gap.len()], contradictions: Vec::new() };
    let mut points = Vec::with_capacity(count);
    for part in &parts {
        let (active, contradictions) = part.nearest(rounding)?;
        for (&k, force) in active.rows.iter().zip(&active.force) {
            let (i, length) = part.row[k];
            found.forces[i] = unit * force / length;
        }
        let of_host = |weights: Vec<(usize, f64)>| {
            weights.into_iter().map(|(k, w)| (part.row[k].0, w / part.row[k].1)).collect()
        };
        found.contradictions.extend(contradictions.into_iter().map(of_host));
        points.push(active.a);
    }
    found.point = local.iter().zip(&part_of).map(|(&j, &part)| unit * points[part][j]).collect();
    Ok(found)
}

/// Columns connected by rows, with rows of unit length.
#[derive(Clone)]
struct ConnectedColumns {
    rows: Csr,
    gap: Vec<f64>,
    noise: Vec<f64>,
    target: Vec<f64>,
    /// Number and length of each row.
    row: Vec<(usize, f64)>,
}

impl Default for ConnectedColumns {
    fn default() -> Self {
        let (gap, noise, target, row) = Default::default();
        Self { rows: Csr::empty(0), gap, noise, target, row }
    }
}

impl ConnectedColumns {
    fn nearest(&self, rounding: f64) -> Result<(Active<'_>, Vec<Vec<(usize, f64)>>)> {
        let (size, mut left_out) = (norm(&self.target), vec![false; self.gap.len()]);
        let at_origin = |a: &[f64]| norm(a) <= NOISE * size && self.gap.iter().all(|gap| *gap >= 0.0);
        let (mut active, mut contradictions, mut farthest) = (Active::new(self), Vec::new(), 0.0);
        let enough = 5 * (self.target.len() + self.gap.len());
        for round in 0..enough.max(50 * (self.target.len() + 2)) {
            let violated = self.most_violated(&active, rounding * size, &left_out);
            let Some(p) = violated.filter(|_| !at_origin(&active.a)) else {
                return Ok((active, contradictions));
            };
            interrupt::reached("rows admitted to a nearest point", round)?;
            if let Some(weights) = active.admit(p)? {
                contradictions.push(weights);
                left_out[p] = true;
            }
            // |a - a0| increases from row to row; if it decreases, rows are exchanged because of rounding
            let distance = active.distance();
            if round > enough && distance < DISTANCE_FALLS * farthest {
                return Ok((active, contradictions));
            }
            farthest = distance;
        }
        Err(Error::new(Kind::Internal, "the active set of a nearest point does not converge"))
    }

    /// `n_i'a - g_i`
    fn excess(&self, i: usize, a: &[f64]) -> f64 {
        self.rows.row_dot(i, a) - self.gap[i]
    }

    /// The row with the largest violation; active rows are satisfied up to rounding and do not count.
    fn most_violated(&self, active: &Active, known: f64, left_out: &[bool]) -> Option<usize> {
        let (mut worst, zero) = ((None, 0.0), known + NOISE * norm(&active.a));
        let mut asked: Vec<bool> = left_out.iter().map(|out| !out).collect();
        active.rows.iter().for_each(|&i| asked[i] = false);
        for i in (0..self.gap.len()).filter(|&i| asked[i]) {
            let excess = self.excess(i, &active.a);
            if excess > worst.1 && excess > zero + self.noise[i] {
                worst = (Some(i), excess);
            }
        }
        worst.0
    }
}

/// Active rows, `N = Q R` the matrix of their normals, their forces >= 0 and `a = a0 - N force`.
struct Active<'a> {
    of: &'a ConnectedColumns,
    rows: Vec<usize>,
    q: Matrix,
    /// Columns of R.
    r: Vec<Vec<f64>>,
    force: Vec<f64>,
    a: Vec<f64>,
}

impl<'a> Active<'a> {
    fn new(of: &'a ConnectedColumns) -> Self {
        let q = Matrix { rows: of.target.len(), ..Matrix::default() };
        Self { of, rows: Vec::new(), q, r: Vec::new(), force: Vec::new(), a: of.target.clone() }
    }

    /// `|a - a0|`
    fn distance(&self) -> f64 {
        self.a.iter().zip(&self.of.target).map(|(a, target)| (a - target) * (a - target)).sum::<f64>().sqrt()
    }

    /// Makes the violated row p active; rows whose forces would become negative leave. If the row cannot be satisfied,
    /// returns its weight and the weights of the active rows that contradict it.
    fn admit(&mut self, p: usize) -> Result<Option<Vec<(usize, f64)>>> {
        let mut own = 0.0;
        loop {
            interrupt::check()?;
            let (along, outside) = self.split(p);
            let turn = self.back(along.clone());
            let reach = norm(&outside);
            let full =
                if reach > SINGULAR { self.of.excess(p, &self.a) / (reach * reach) } else { f64::INFINITY };
            let mut first = (full, None);
            for (j, turn) in turn.iter().enumerate().filter(|(_, turn)| **turn > 0.0) {
                if self.force[j] / turn < first.0 {
                    first = (self.force[j] / turn, Some(j));
                }
            }
            let (step, leaving) = first;
            if step == f64::INFINITY {
                self.settle();
                let against = self.rows.iter().zip(&turn).map(|(&i, turn)| (i, -turn));
                return Ok(Some(std::iter::once((p, 1.0)).chain(against).collect()));
            }
            axpy(-step, &turn, &mut self.force);
            own += step;
            if reach > SINGULAR {
                axpy(-step, &outside, &mut self.a);
            }
            match leaving {
                Some(j) => self.remove(j),
                None => {
                    self.push(p, along, outside, own);
                    self.settle();
                    return Ok(None);
                }
            }
        }
    }

    /// `n_p = Q h + z`: h and z.
    fn split(&self, p: usize) -> (Vec<f64>, Vec<f64>) {
        let (mut h, mut z) = (vec![0.0; self.q.cols], vec![0.0; self.q.rows]);
        self.of.rows.row(p).for_each(|(j, v)| z[j] = v);
        for _ in 0..2 {
            for (k, h) in h.iter_mut().enumerate() {
                let part = dot(self.q.col(k), &z);
                axpy(-part, self.q.col(k), &mut z);
                *h += part;
            }
        }
        (h, z)
    }

    fn push(&mut self, p: usize, mut along: Vec<f64>, mut outside: Vec<f64>, force: f64) {
        let length = norm(&outside);
        outside.iter_mut().for_each(|v| *v /= length);
        along.push(length);
        self.rows.push(p);
        self.q.push_col(&outside);
        self.r.push(along);
        self.force.push(force);
    }

    /// Rotations of adjacent columns of Q make R triangular again.
    fn remove(&mut self, j: usize) {
        self.rows.remove(j);
        self.force.remove(j);
        self.r.remove(j);
        for k in j..self.r.len() {
            let (above, below) = (self.r[k][k], self.r[k][k + 1]);
            let length = above.hypot(below);
            let (c, s) = if length > 0.0 { (above / length, below / length) } else { (1.0, 0.0) };
            for column in &mut self.r[k..] {
                let (a, b) = (column[k], column[k + 1]);
                (column[k], column[k + 1]) = (c * a + s * b, c * b - s * a);
            }
            self.r[k].truncate(k + 1);
            let n = self.q.rows;
            let (left, right) = self.q.data[k * n..(k + 2) * n].split_at_mut(n);
            for (a, b) in left.iter_mut().zip(right) {
                (*a, *b) = (c * *a + s * *b, c * *b - s * *a);
            }
        }
        self.q.cols = self.r.len();
        self.q.data.truncate(self.q.cols * self.q.rows);
    }

    /// `R^-1 x`
    fn back(&self, mut x: Vec<f64>) -> Vec<f64> {
        for j in (0..x.len()).rev() {
            x[j] /= self.r[j][j];
            let part = x[j];
            axpy(-part, &self.r[j][..j], &mut x[..j]);
        }
        x
    }

    /// Recomputes a and the forces of the active rows without accumulated rounding: `a = a0 - Q y`, `R'y = N'a0 - g`;
    /// then again for the remainder, so that rows are satisfied up to rounding of a, not of a0.
    fn settle(&mut self) {
        let mut all = vec![0.0; self.rows.len()];
        self.a.clone_from(&self.of.target);
        for _ in 0..PASSES {
            let mut y: Vec<f64> = self.rows.iter().map(|&p| self.of.excess(p, &self.a)).collect();
            for j in 0..y.len() {
                y[j] = (y[j] - dot(&self.r[j][..j], &y[..j])) / self.r[j][j];
            }
            self.q.mul_add(-1.0, &y, &mut self.a);
            axpy(1.0, &y, &mut all);
        }
        self.force = self.back(all);
        self.force.iter_mut().for_each(|force| *force = force.max(0.0));
    }
}

#[cfg(test)]
mod tests;
