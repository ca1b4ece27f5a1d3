//! `a = argmin |a - a0|` subject to `A a <= g`: the dual active-set method of Goldfarb and Idnani (1983) with unit Hessian.

use crate::error::{Error, Kind, Result};
use crate::linalg::graph::joined;
use crate::linalg::vector::{axpy, dot, norm, norm_max, power_of_two_below};
use crate::linalg::{Csr, Matrix};

/// A unit row with less than this outside of the span of active rows depends on them.
const DEPENDENT: f64 = 1e-11;
/// A row is violated by more than this part of `|a0|`, and by more than its noise.
const ROUNDING: f64 = 64.0 * f64::EPSILON;

/// `motions` is A, m x d, and `gap` is g, +infinity where nothing restricts, known to `noise`. Columns that no row connects do
/// not know of each other; those that no row restricts are those of `target`, a0.
pub fn least_travel(motions: &Csr, gap: &[f64], target: &[f64], noise: &[f64]) -> Result<Vec<f64>> {
    let length = |i: usize| motions.row(i).map(|(_, v)| v * v).sum::<f64>().sqrt();
    let rows: Vec<usize> =
        (0..motions.rows()).filter(|&i| gap[i] < f64::INFINITY && length(i) > 0.0).collect();
    let asked = rows.iter().map(|&i| -gap[i] / length(i)).fold(norm_max(target), f64::max);
    let unit = power_of_two_below(asked);
    let entries = |i: usize| motions.row(i).filter(|(_, v)| *v != 0.0);
    let columns = |&i: &usize| entries(i).map(|entry| entry.0);
    let (part_of, count) = joined(target.len(), rows.iter().map(columns));
    let (mut local, mut parts) = (vec![0; target.len()], vec![Part::default(); count]);
    for (j, &part) in part_of.iter().enumerate() {
        (local[j], parts[part].rows.cols) = (parts[part].rows.cols, parts[part].rows.cols + 1);
        parts[part].target.push(target[j] / unit);
    }
    for (i, first) in rows.into_iter().filter_map(|i| Some((i, entries(i).next()?.0))) {
        let (part, length) = (&mut parts[part_of[first]], length(i));
        part.rows.push_row(entries(i).map(|(j, v)| (local[j], v / length)));
        part.gap.push(gap[i] / unit / length);
        part.noise.push(noise[i] / unit / length);
    }
    let solutions = parts.iter().map(Part::nearest).collect::<Result<Vec<_>>>()?;
    Ok(local.iter().zip(&part_of).map(|(&j, &part)| unit * solutions[part][j]).collect())
}

/// Columns that rows connect, with rows of unit length.
#[derive(Clone)]
struct Part {
    rows: Csr,
    gap: Vec<f64>,
    noise: Vec<f64>,
    target: Vec<f64>,
}

impl Default for Part {
    fn default() -> Self {
        Self { rows: Csr::empty(0), gap: Vec::new(), noise: Vec::new(), target: Vec::new() }
    }
}

impl Part {
    fn nearest(&self) -> Result<Vec<f64>> {
        let (size, mut left_out) = (norm(&self.target), vec![false; self.gap.len()]);
        let mut active = Active::new(self);
        for _ in 0..50 * (self.target.len() + 2) {
            let Some(p) = self.most_violated(&active.a, size, &left_out) else { return Ok(active.a) };
            // where some motion keeps all rows, only rounding can make one depend on active ones and be violated for ever
            left_out[p] = !active.admit(p);
        }
        Err(Error::new(Kind::Internal, "the active set of the least travel does not settle"))
    }

    /// `n_i'a - g_i`
    fn excess(&self, i: usize, a: &[f64]) -> f64 {
        self.rows.row_dot(i, a) - self.gap[i]
    }

    fn most_violated(&self, a: &[f64], size: f64, left_out: &[bool]) -> Option<usize> {
        let mut worst = (None, 0.0);
        for i in (0..self.gap.len()).filter(|&i| !left_out[i]) {
            let excess = self.excess(i, a);
            if excess > worst.1 && excess > ROUNDING * size + self.noise[i] {
                worst = (Some(i), excess);
            }
        }
        worst.0
    }
}

/// Rows met, `N = Q R` the matrix of their normals, their forces >= 0 and `a = a0 - N force`.
struct Active<'a> {
    of: &'a Part,
    rows: Vec<usize>,
    q: Matrix,
    /// Columns of R.
    r: Vec<Vec<f64>>,
    force: Vec<f64>,
    a: Vec<f64>,
}

impl<'a> Active<'a> {
    fn new(of: &'a Part) -> Self {
        let q = Matrix { rows: of.target.len(), ..Matrix::default() };
        Self { of, rows: Vec::new(), q, r: Vec::new(), force: Vec::new(), a: of.target.clone() }
    }

    /// Makes the violated row p active; rows whose force would turn negative on the way leave. False: it cannot be met.
    fn admit(&mut self, p: usize) -> bool {
        let mut own = 0.0;
        loop {
            let (along, outside) = self.split(p);
            let turn = self.back(along.clone());
            let reach = norm(&outside);
            let full =
                if reach > DEPENDENT { self.of.excess(p, &self.a) / (reach * reach) } else { f64::INFINITY };
            let mut first = (full, None);
            for (j, turn) in turn.iter().enumerate().filter(|(_, turn)| **turn > 0.0) {
                if self.force[j] / turn < first.0 {
                    first = (self.force[j] / turn, Some(j));
                }
            }
            let (step, leaving) = first;
            if step == f64::INFINITY {
                self.settle();
                return false;
            }
            axpy(-step, &turn, &mut self.force);
            own += step;
            if reach > DEPENDENT {
                axpy(-step, &outside, &mut self.a);
            }
            match leaving {
                Some(j) => self.remove(j),
                None => {
                    self.push(p, along, outside, own);
                    self.settle();
                    return true;
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

    fn remove(&mut self, j: usize) {
        let (rows, force) = (self.rows.split_off(j), self.force.split_off(j));
        self.r.truncate(j);
        self.q.data.truncate(j * self.q.rows);
        self.q.cols = j;
        for (p, force) in rows.into_iter().zip(force).skip(1) {
            let (along, outside) = self.split(p);
            self.push(p, along, outside, force);
        }
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

    /// a and the forces of the active rows, without the rounding errors of the way: `a = a0 - Q y`, `R'y = N'a0 - g`.
    fn settle(&mut self) {
        let mut y: Vec<f64> = self.rows.iter().map(|&p| self.of.excess(p, &self.of.target)).collect();
        for j in 0..y.len() {
            y[j] = (y[j] - dot(&self.r[j][..j], &y[..j])) / self.r[j][j];
        }
        self.a = self.of.target.clone();
        self.q.mul_add(-1.0, &y, &mut self.a);
        self.force = self.back(y);
        self.force.iter_mut().for_each(|force| *force = force.max(0.0));
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::linalg::SpdSolver;
    use crate::qp::augmented::scattered;

    fn rows(rows: &[Vec<f64>]) -> Csr {
        let mut csr = Csr::empty(rows[0].len());
        rows.iter().for_each(|row| csr.push_row(row.iter().copied().enumerate()));
        csr
    }

    fn solve(a: &[Vec<f64>], gap: &[f64], target: &[f64]) -> Vec<f64> {
        least_travel(&rows(a), gap, target, &vec![0.0; gap.len()]).unwrap()
    }

    fn assert_near(found: &[f64], expected: &[f64], accuracy: f64) {
        let worst = found.iter().zip(expected).fold(0.0f64, |worst, (a, b)| worst.max((a - b).abs()));
        assert!(worst <= accuracy * norm_max(expected).max(f64::MIN_POSITIVE), "{found:?} {expected:?}");
    }

    #[test]
    fn one_and_two_motions_stop_where_they_must() {
        assert_eq!(solve(&[vec![2.0]], &[1.0], &[3.0]), [0.5]);
        assert_eq!(solve(&[vec![2.0], vec![-1.0]], &[1.0, 0.0], &[-3.0]), [0.0]);
        // the corner x <= 1, y <= 1; then the edge x + y <= 1 from (2, 0)
        assert_near(&solve(&[vec![1.0, 0.0], vec![0.0, 1.0]], &[1.0, 1.0], &[3.0, 2.0]), &[1.0, 1.0], 1e-15);
        assert_near(&solve(&[vec![1.0, 1.0]], &[1.0], &[2.0, 0.0]), &[1.5, -0.5], 1e-15);
        // a row that is met first is left again: x + y <= 1, then x <= 0 from (4, 1)
        assert_near(&solve(&[vec![1.0, 1.0], vec![1.0, 0.0]], &[1.0, 0.0], &[4.0, 0.5]), &[0.0, 0.5], 1e-15);
    }

    #[test]
    fn a_target_that_violates_nothing_is_the_answer_bit_for_bit() {
        let target = [0.1, -1.0 / 3.0, 7e-9];
        let a = vec![vec![1.0, 2.0, 3.0], vec![0.0; 3], vec![1e-17, -1e-17, 0.0], vec![0.0, -1.0, 0.0]];
        assert_eq!(solve(&a, &[0.0, 0.0, 1e-16, 1.0 / 3.0], &target), target);
        assert_eq!(solve(&a, &[f64::INFINITY, 0.0, 1e300, 1e20], &target), target);
        assert_eq!(solve(&a, &[0.0; 4], &[0.0; 3]), [0.0; 3]);
        let noisy = least_travel(&rows(&a), &[0.0, 0.0, -1e-17, 0.0], &[0.1, -0.3, 0.0], &[1.0; 4]).unwrap();
        assert_eq!(noisy, [0.1, -0.3, 0.0], "nothing is violated by more than its noise");
    }

    /// Of all sets of rows met that give a feasible point, the nearest.
    fn by_enumeration(a: &[Vec<f64>], gap: &[f64], target: &[f64]) -> Vec<f64> {
        let (mut best, mut nearest) = (f64::INFINITY, vec![0.0; target.len()]);
        for set in 0..1usize << a.len() {
            let met: Vec<usize> = (0..a.len()).filter(|i| set >> i & 1 == 1).collect();
            let n = met.len();
            let mut gram = Matrix::zeros(n, n).unwrap();
            (0..n * n).for_each(|k| gram.data[k] = dot(&a[met[k / n]], &a[met[k % n]]));
            let excess: Vec<f64> = met.iter().map(|&i| dot(&a[i], target) - gap[i]).collect();
            let scale: Vec<f64> = (0..n).map(|k| gram.get(k, k).max(1e-300)).collect();
            let mut point = target.to_vec();
            if n > 0 {
                let force = SpdSolver::new(&gram, &scale).unwrap().solve(&excess);
                met.iter().zip(force).for_each(|(&i, force)| axpy(-force, &a[i], &mut point));
            }
            let way: Vec<f64> = point.iter().zip(target).map(|(p, t)| p - t).collect();
            let feasible =
                (0..a.len()).all(|i| dot(&a[i], &point) <= gap[i] + 1e-12 * norm(target) * norm(&a[i]));
            if feasible && norm(&way) < best {
                (best, nearest) = (norm(&way), point);
            }
        }
        nearest
    }

    #[test]
    fn random_problems_also_degenerate_ones_are_solved_as_by_enumeration() {
        let mut numbers = scattered(200_000).into_iter();
        let mut next = move || numbers.next().unwrap();
        for case in 0..1500 {
            let (d, m) = (1 + case % 3, 1 + case / 3 % 8);
            let mut a: Vec<Vec<f64>> = (0..m).map(|_| (0..d).map(|_| next()).collect()).collect();
            let mut gap: Vec<f64> = (0..m).map(|_| (0.2 * next()).max(0.0)).collect();
            if case % 5 == 1 && m > 2 {
                (a[m - 1], gap[m - 1]) = (a[0].iter().map(|v| 3.0 * v).collect(), 3.0 * gap[0]);
                (a[1], gap[1]) = (a[0].clone(), gap[0] * 0.999);
            }
            if case % 5 == 2 {
                gap.iter_mut().for_each(|g| *g = 0.0);
            }
            if case % 5 == 3 && m > 3 {
                a[2] = (0..d).map(|k| 0.3 * a[0][k] + 0.6 * a[1][k]).collect();
                gap[2] = 0.3 * gap[0] + 0.6 * gap[1];
                a[3] = vec![0.0; d];
            }
            let target: Vec<f64> = (0..d).map(|_| next()).collect();
            let found = solve(&a, &gap, &target);
            let expected = by_enumeration(&a, &gap, &target);
            let worst = found.iter().zip(&expected).fold(0.0f64, |worst, (f, e)| worst.max((f - e).abs()));
            assert!(worst <= 1e-11, "case {case}: {worst:e} {found:?} {expected:?}");
        }
    }

    #[test]
    fn units_change_nothing_but_the_unit() {
        let mut numbers = scattered(10_000).into_iter();
        let mut next = move || numbers.next().unwrap();
        let a: Vec<Vec<f64>> = (0..40).map(|_| (0..9).map(|_| next()).collect()).collect();
        let gap: Vec<f64> = (0..40).map(|_| 0.1 + 0.1 * next()).collect();
        let target: Vec<f64> = (0..9).map(|_| next()).collect();
        let times = |x: &[f64], by: f64| -> Vec<f64> { x.iter().map(|v| v * by).collect() };
        let expected = solve(&a, &gap, &target);
        for power in [-300, -40, 3, 200] {
            let by = 2f64.powi(power);
            assert_eq!(solve(&a, &times(&gap, by), &times(&target, by)), times(&expected, by));
        }
        let scaled: Vec<Vec<f64>> = a.iter().map(|row| times(row, 1e-6)).collect();
        assert_near(&solve(&scaled, &times(&gap, 1e-6), &target), &expected, 1e-13);
        assert_near(&solve(&a, &times(&gap, 1e10), &times(&target, 1e10)), &times(&expected, 1e10), 1e-13);
    }

    /// Conditions of Karush, Kuhn and Tucker by the nearest point: (a0 - a)'(b - a) <= 0 for feasible b.
    #[test]
    fn hundreds_of_motions_and_rows_with_copies_that_differ_by_rounding() {
        let mut numbers = scattered(4_000_000).into_iter();
        let mut next = move || numbers.next().unwrap();
        let (d, m) = (120, 3000);
        let mut a: Vec<Vec<f64>> = (0..m / 2).map(|_| (0..d).map(|_| next()).collect()).collect();
        let mut gap: Vec<f64> = (0..m / 2).map(|_| 0.5 + next()).collect();
        for i in 0..m / 2 {
            a.push(a[i].iter().map(|v| v * (1.0 + 1e-15 * next())).collect());
            gap.push(gap[i]);
        }
        let target: Vec<f64> = (0..d).map(|_| 3.0 * next()).collect();
        let found = solve(&a, &gap, &target);
        assert!((0..m).all(|i| dot(&a[i], &found) <= gap[i] + 1e-12));
        let way: Vec<f64> = target.iter().zip(&found).map(|(t, f)| t - f).collect();
        assert!(dot(&way, &found) >= -1e-11, "0 is feasible");
        // the way back is a combination of rows that are met
        let met: Vec<usize> = (0..m / 2).filter(|&i| dot(&a[i], &found) > gap[i] - 1e-10).collect();
        let normals: Vec<f64> = met.iter().flat_map(|&i| a[i].clone()).collect();
        let basis = Matrix { rows: d, cols: met.len(), data: normals }.orthonormalised(1e-9);
        let mut left = way.clone();
        basis.mul_add(-1.0, &basis.mul_transposed(&way), &mut left);
        assert!(met.len() > 5 && norm(&left) <= 1e-10, "{} {:e}", met.len(), norm(&left));
        // motions apart from these change no bit
        let mut both: Vec<Vec<f64>> = a.iter().map(|row| [row.clone(), vec![0.0]].concat()).collect();
        both.push([vec![0.0; d], vec![1.0]].concat());
        let gaps = [gap.clone(), vec![0.25]].concat();
        let found_both = solve(&both, &gaps, &[target.clone(), vec![1.0]].concat());
        assert_eq!(found_both[..d], found[..]);
        assert_eq!(found_both[d], 0.25);
    }
}
