//! Rows of a body that are multiples of each other, `B_p = T B`: for example, all rows that glue one unknown to its
//! copies are multiples of one unit vector in this body. F_p = T (B K_p+ B') T' is assembled and applied with the rows of
//! B alone.

use std::sync::Arc;

use crate::linalg::Csr;

pub struct Multiples {
    /// Rows of B.
    pub count: usize,
    /// T by rows: row i of B_p is `factor` times row `of` of B. Empty if T = I.
    multiples: Vec<RowMultiple>,
}

#[derive(Debug, Clone, Copy, PartialEq)]
struct RowMultiple {
    of: usize,
    factor: f64,
}

impl Multiples {
    /// T of B_p; and B, one row per direction, in the order of first appearance; B_p itself if T = I. Rows count as multiples if their
    /// entries, divided by the largest, are equal bit by bit.
    pub fn of(matrix: &Arc<Csr>) -> (Self, Arc<Csr>) {
        let scale: Vec<f64> = (0..matrix.rows()).map(|i| largest(matrix, i)).collect();
        let key = |i: usize| {
            let scale = scale[i];
            matrix.row(i).map(move |(j, v)| (j, (v / scale).to_bits()))
        };
        let mut order: Vec<usize> = (0..matrix.rows()).collect();
        order.sort_unstable_by(|&a, &b| key(a).cmp(key(b)).then(a.cmp(&b)));
        let mut first = vec![0; order.len()];
        for group in order.chunk_by(|&a, &b| key(a).eq(key(b))) {
            group.iter().for_each(|&i| first[i] = group[0]);
        }
        let (mut distinct, mut multiples) =
            (Csr::empty(matrix.cols), Vec::<RowMultiple>::with_capacity(first.len()));
        for (i, &first) in first.iter().enumerate() {
            if first == i {
                multiples.push(RowMultiple { of: distinct.rows(), factor: 1.0 });
                distinct.push_row(matrix.row(i));
            } else {
                multiples.push(RowMultiple { of: multiples[first].of, factor: scale[i] / scale[first] });
            }
        }
        let count = distinct.rows();
        if count == matrix.rows() {
            return (Self { count, multiples: Vec::new() }, Arc::clone(matrix));
        }
        (Self { count, multiples }, Arc::new(distinct))
    }

    fn row(&self, i: usize) -> RowMultiple {
        self.multiples.get(i).copied().unwrap_or(RowMultiple { of: i, factor: 1.0 })
    }

    /// The rows of B among those of B_p; none: all.
    pub fn firsts(&self) -> Option<Vec<usize>> {
        let mut next = 0..self.count;
        let is_first = |i: &usize| self.multiples[*i].of == next.start && next.next().is_some();
        (!self.multiples.is_empty()).then(|| (0..self.multiples.len()).filter(is_first).collect())
    }

    /// Rows of B that the first rows of B_p, so many, are multiples of.
    pub fn count_of_first(&self, rows: usize) -> usize {
        (0..rows).map(|i| self.row(i).of + 1).max().unwrap_or(0)
    }

    /// Rows of B that these rows of B_p are multiples of, ascending.
    pub fn distinct(&self, rows: impl Iterator<Item = usize>) -> Vec<usize> {
        let mut all: Vec<usize> = rows.map(|i| self.row(i).of).collect();
        all.sort_unstable();
        all.dedup();
        all
    }

    /// `T' x_p` of the entries `rows` of x.
    pub fn gather(&self, rows: &[usize], x: &[f64]) -> Vec<f64> {
        let mut sums = vec![0.0; self.count];
        for (at, &i) in rows.iter().enumerate() {
            let RowMultiple { of, factor } = self.row(at);
            sums[of] += factor * x[i];
        }
        sums
    }

    /// `T v`
    pub fn spread<'a>(&'a self, v: &'a [f64]) -> impl Iterator<Item = f64> + 'a {
        let rows = self.multiples.len().max(self.count);
        (0..rows).map(|i| self.row(i)).map(|m| m.factor * v[m.of])
    }

    /// Entry (i, j) of `T A T'` from the entries of A.
    pub fn entry(&self, i: usize, j: usize, of: impl Fn(usize, usize) -> f64) -> f64 {
        let (i, j) = (self.row(i), self.row(j));
        i.factor * j.factor * of(i.of, j.of)
    }
}

/// The entry of row i with the largest absolute value; 1 for a row of zeros.
fn largest(matrix: &Csr, i: usize) -> f64 {
    let largest =
        matrix.row(i).fold(0.0, |largest: f64, (_, v)| if v.abs() > largest.abs() { v } else { largest });
    if largest == 0.0 {
        1.0
    } else {
        largest
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn rows_that_are_multiples_share_one_and_all_others_stay_apart() {
        let mut rows = Csr::empty(3);
        rows.push_row([(1, 2.0)]);
        rows.push_row([(0, 1.0), (1, 1.0)]);
        rows.push_row([(1, -1.0)]);
        rows.push_row([(0, 1.0), (1, -1.0)]);
        rows.push_row([(0, 0.25), (1, 0.25)]);
        rows.push_row([(2, 0.0)]);
        let (multiples, distinct) = Multiples::of(&Arc::new(rows.clone()));
        let expected = [(0, 1.0), (1, 1.0), (0, -0.5), (2, 1.0), (1, 0.25), (3, 1.0)];
        let expected = expected.map(|(of, factor)| RowMultiple { of, factor });
        assert_eq!(multiples.multiples, expected);
        assert_eq!((multiples.count, distinct.rows()), (4, 4));
        assert_eq!(multiples.firsts(), Some(vec![0, 1, 3, 5]));
        assert_eq!([0, 1, 3, 4].map(|rows| multiples.count_of_first(rows)), [0, 1, 2, 3]);
        for i in 0..6 {
            let RowMultiple { of, factor } = multiples.multiples[i];
            let made = distinct.row(of).map(|(j, v)| (j, factor * v));
            assert!(made.eq(rows.row(i)), "row {i}");
        }
    }

    #[test]
    fn the_operator_of_all_rows_is_that_of_the_distinct_ones_between_its_factors() {
        let mut rows = Csr::empty(2);
        [(0, 1.0), (1, 3.0), (0, -2.0)].into_iter().for_each(|entry| rows.push_row([entry]));
        let (multiples, _) = Multiples::of(&Arc::new(rows));
        // A = [[5, 7], [7, 11]] between rows 0 and 1; the rows of the body are rows 4, 2, 0 of x
        let a = |i: usize, j: usize| [[5.0, 7.0], [7.0, 11.0]][i][j];
        let full = [[5.0, 7.0, -10.0], [7.0, 11.0, -14.0], [-10.0, -14.0, 20.0]];
        let (list, x) = ([4, 2, 0], [1.0, 9.0, 2.0, 9.0, 3.0]);
        let sums = multiples.gather(&list, &x);
        let image = [0, 1].map(|i| a(i, 0) * sums[0] + a(i, 1) * sums[1]);
        let product: Vec<f64> = multiples.spread(&image).collect();
        for i in 0..3 {
            (0..3).for_each(|j| assert_eq!(multiples.entry(i, j, a), full[i][j]));
            assert_eq!(product[i], (0..3).map(|j| full[i][j] * x[list[j]]).sum::<f64>());
        }
    }
}
