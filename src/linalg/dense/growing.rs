//! `argmin |A c - b|` of a matrix that grows by columns: modified Gram-Schmidt with pivots, A P = Q T. Applied to b as to a further
//! column it is as accurate as reflections (Bjorck).

use crate::linalg::vector::{axpy, dot_in_parts};

/// Columns that come later may be longer: those before them end in zeros that are not stored.
#[derive(Default)]
pub struct Growing {
    /// Number of columns of A.
    columns: usize,
    /// Columns of A that are used, with those of Q and, with the diagonal, of T.
    used: Vec<(usize, Column)>,
}

/// What is left of a column beside those that are used, or that part with length 1; its shares of them.
struct Column {
    rest: Vec<f64>,
    shares: Vec<f64>,
}

/// A column that is not used yet: its length, and that of what is left of it.
struct Waiting {
    number: usize,
    whole: f64,
    left: f64,
    column: Column,
}

impl Growing {
    pub fn columns(&self) -> usize {
        self.columns
    }

    /// Appends columns of one length. Of which most is left, relative to its whole length, is used next, until no more than `cut` is left
    /// of any: those depend on the ones used.
    pub fn extend(&mut self, columns: Vec<Vec<f64>>, cut: f64) {
        let begun = |(k, mut rest): (usize, Vec<f64>)| {
            let whole = length(&rest);
            let shares = self.without(&mut rest);
            Waiting { number: self.columns + k, whole, left: length(&rest), column: Column { rest, shares } }
        };
        let count = columns.len();
        let mut waiting: Vec<_> = columns.into_iter().enumerate().map(begun).collect();
        self.columns += count;
        loop {
            let parts = waiting.iter().map(|w| w.left / w.whole).enumerate();
            // false for NaN
            let Some((most, _)) = parts.filter(|part| part.1 > cut).max_by(|a, b| a.1.total_cmp(&b.1)) else {
                break;
            };
            let Waiting { number, left, column: mut next, .. } = waiting.swap_remove(most);
            next.rest.iter_mut().for_each(|v| *v /= left);
            next.shares.push(left);
            for Waiting { left, column: other, .. } in &mut waiting {
                other.shares.push(take(&next.rest, &mut other.rest));
                *left = length(&other.rest);
            }
            self.used.push((number, next));
        }
    }

    /// c, with zeros for dependent columns; b, as long as the last column, becomes `b - A c`.
    pub fn solve(&self, b: &mut [f64]) -> Vec<f64> {
        let (mut y, mut c) = (self.without(b), vec![0.0; self.columns]);
        for (k, (number, Column { shares, .. })) in self.used.iter().enumerate().rev() {
            y[k] /= shares[k];
            c[*number] = y[k];
            axpy(-c[*number], &shares[..k], &mut y[..k]);
        }
        c
    }

    /// Removes from v its part in the span of the columns; `Q'v`.
    fn without(&self, v: &mut [f64]) -> Vec<f64> {
        self.used.iter().map(|(_, used)| take(&used.rest, v)).collect()
    }
}

/// `v -= q q'v` for v at least as long as q; `q'v`.
fn take(q: &[f64], v: &mut [f64]) -> f64 {
    let v = &mut v[..q.len()];
    let share = dot_in_parts(q, v);
    axpy(-share, q, v);
    share
}

fn length(v: &[f64]) -> f64 {
    dot_in_parts(v, v).sqrt()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::linalg::dense::least_squares::least_squares;
    use crate::linalg::Matrix;

    #[test]
    fn it_finds_what_reflections_find_and_leaves_the_rest() {
        let entry = |i: usize, j: usize| ((7 * i * i + 3 * i * j + 5 * j + 1) as f64).sin();
        for (rows, columns) in [(1, 1), (5, 3), (40, 7), (40, 40)] {
            let a = Matrix::from_fn(rows, columns, entry).unwrap();
            let b: Vec<f64> = (0..rows).map(|i| (i as f64).cos()).collect();
            let expected = least_squares(&a, &b, 1e-12).unwrap();
            let near = |x: &[f64], y: &[f64]| x.iter().zip(y).all(|(x, y)| (x - y).abs() < 1e-10);
            for once in [columns, columns / 2, 1] {
                let (mut growing, mut left, mut rest) = (Growing::default(), b.clone(), b.clone());
                for from in (0..columns).step_by(once.max(1)) {
                    let until = columns.min(from + once.max(1));
                    growing.extend((from..until).map(|j| a.col(j).to_vec()).collect(), 1e-12);
                }
                let c = growing.solve(&mut left);
                assert!(near(&c, &expected), "{rows} x {columns}: {c:?} {expected:?}");
                a.mul_add(-1.0, &c, &mut rest);
                assert!(near(&left, &rest));
            }
        }
    }

    #[test]
    fn later_columns_and_what_is_approached_may_be_longer() {
        let (short, long) = (vec![1.0; 35], (0..50).map(|i| (i as f64).sin()).collect::<Vec<_>>());
        let mut growing = Growing::default();
        growing.extend(vec![short.clone()], 1e-12);
        growing.extend(vec![long.clone()], 1e-12);
        let mut b: Vec<f64> = long.iter().map(|v| 3.0 * v).collect();
        short.iter().zip(&mut b).for_each(|(v, b)| *b += 2.0 * v);
        let c = growing.solve(&mut b);
        assert!((c[0] - 2.0).abs() < 1e-14 && (c[1] - 3.0).abs() < 1e-14, "{c:?}");
        assert!(b.iter().all(|b| b.abs() < 1e-14));
    }

    /// The second depends on the first up to 1e-13, the next ones are not numbers, infinite and nothing; then a longer column.
    #[test]
    fn a_column_that_depends_on_others_is_not_used_and_later_ones_may_be_longer() {
        let mut growing = Growing::default();
        let nothing = [vec![f64::NAN, 0.0], vec![f64::INFINITY, 0.0], vec![0.0; 2]];
        for columns in
            [vec![vec![1.0, 0.0]], vec![vec![1.0, 1e-13]], nothing.into(), vec![vec![1.0, 0.0, 2.0]]]
        {
            growing.extend(columns, 1e-12);
        }
        let mut b = [3.0, 5.0, 4.0];
        assert_eq!(growing.solve(&mut b), [1.0, 0.0, 0.0, 0.0, 0.0, 2.0]);
        assert_eq!((b, growing.columns()), ([0.0, 5.0, 0.0], 6));
        assert!(Growing::default().solve(&mut []).is_empty());
    }

    /// The first two agree up to 1e-9: their difference would have the amplitude 1e9.
    #[test]
    fn of_columns_that_agree_the_one_that_adds_most_is_used() {
        let mut growing = Growing::default();
        growing.extend(vec![vec![1.0, 0.0], vec![1.0, 1e-9], vec![0.0, 1.0]], 1e-12);
        let mut b = [1.0, 1.0];
        let c = growing.solve(&mut b);
        assert!(c.iter().all(|c| c.abs() < 1.0 + 1e-8) && b.iter().all(|b| b.abs() < 1e-15), "{c:?} {b:?}");
    }
}
