//! Compressed sparse rows, and triplets that become them.

/// A sparse matrix by rows, 0-based: row i holds entries ptr[i]..ptr[i+1], columns ascending, none repeated.
#[derive(Clone, Debug, PartialEq)]
pub struct Csr {
    pub rows: usize,
    pub cols: usize,
    pub ptr: Vec<usize>,
    pub col: Vec<usize>,
    pub val: Vec<f64>,
}

impl Csr {
    /// 0 x `cols`, to be filled with [`Csr::push_row`].
    pub fn empty(cols: usize) -> Csr {
        Csr { rows: 0, cols, ptr: vec![0], col: Vec::new(), val: Vec::new() }
    }

    /// n x n without an entry.
    pub fn zero(n: usize) -> Csr {
        Csr { rows: n, cols: n, ptr: vec![0; n + 1], col: Vec::new(), val: Vec::new() }
    }

    /// n x n from `n * n` values by rows; zeros are stored, so that the diagonal always is.
    pub fn from_dense(n: usize, values: &[f64]) -> Csr {
        assert_eq!(values.len(), n * n, "a dense {n} x {n} matrix");
        Csr {
            rows: n,
            cols: n,
            ptr: (0..=n).map(|i| i * n).collect(),
            col: (0..n * n).map(|k| k % n).collect(),
            val: values.to_vec(),
        }
    }

    /// Appends one row: entries in any order, repeated columns summed in the order given, zero sums left out.
    pub fn push_row(&mut self, entries: &[(usize, f64)]) {
        let mut sorted = entries.to_vec();
        sorted.sort_by_key(|&(column, _)| column);
        for same in sorted.chunk_by(|a, b| a.0 == b.0) {
            let sum: f64 = same.iter().map(|&(_, value)| value).sum();
            assert!(same[0].0 < self.cols, "column {} of {}", same[0].0, self.cols);
            if sum != 0.0 {
                self.col.push(same[0].0);
                self.val.push(sum);
            }
        }
        self.rows += 1;
        self.ptr.push(self.col.len());
    }

    /// The entries (column, value) of row `i`.
    pub fn row(&self, i: usize) -> impl Iterator<Item = (usize, f64)> + '_ {
        let range = self.ptr[i]..self.ptr[i + 1];
        let columns = self.col[range.clone()].iter();
        columns.copied().zip(self.val[range].iter().copied())
    }

    /// A_ij, 0 where nothing is stored.
    pub fn get(&self, i: usize, j: usize) -> f64 {
        let columns = &self.col[self.ptr[i]..self.ptr[i + 1]];
        let found = columns.binary_search(&j);
        found.map_or(0.0, |k| self.val[self.ptr[i] + k])
    }

    /// A x.
    pub fn times(&self, x: &[f64]) -> Vec<f64> {
        assert_eq!(x.len(), self.cols);
        let product = |i| self.row(i).map(|(j, value)| value * x[j]).sum();
        (0..self.rows).map(product).collect()
    }

    /// A'y.
    pub fn transpose_times(&self, y: &[f64]) -> Vec<f64> {
        assert_eq!(y.len(), self.rows);
        let mut product = vec![0.0; self.cols];
        for (i, factor) in y.iter().enumerate() {
            for (j, value) in self.row(i) {
                product[j] += value * factor;
            }
        }
        product
    }

    /// diag A.
    pub fn diagonal(&self) -> Vec<f64> {
        (0..self.rows).map(|i| self.get(i, i)).collect()
    }

    /// a A.
    pub fn scaled(mut self, a: f64) -> Csr {
        self.val.iter_mut().for_each(|value| *value *= a);
        self
    }

    /// The lower triangle with the diagonal, for hosts that store one triangle.
    pub fn lower(&self) -> Csr {
        self.filtered(self.cols, |i, j| (j <= i).then_some(j), 0..self.rows)
    }

    /// Rows and columns `keep` (ascending) of a square matrix.
    pub fn restricted(&self, keep: &[usize]) -> Csr {
        let mut number = vec![None; self.cols];
        for (new, &old) in keep.iter().enumerate() {
            number[old] = Some(new);
        }
        self.filtered(keep.len(), |_, j| number[j], keep.iter().copied())
    }

    /// The given rows with column j of row i renamed to `column(i, j)` or left out; order must be kept.
    fn filtered(
        &self,
        cols: usize,
        column: impl Fn(usize, usize) -> Option<usize>,
        rows: impl Iterator<Item = usize>,
    ) -> Csr {
        let mut result = Csr::empty(cols);
        for i in rows {
            for (j, value) in self.row(i) {
                if let Some(new) = column(i, j) {
                    result.col.push(new);
                    result.val.push(value);
                }
            }
            result.rows += 1;
            result.ptr.push(result.col.len());
        }
        result
    }

    /// max |A_ij - A_ji|.
    pub fn asymmetry(&self) -> f64 {
        let mut largest = 0.0f64;
        for i in 0..self.rows {
            for (j, value) in self.row(i) {
                largest = largest.max((value - self.get(j, i)).abs());
            }
        }
        largest
    }

    /// True when the columns of every row ascend strictly.
    pub fn is_sorted(&self) -> bool {
        let ascending = |i| self.col[self.ptr[i]..self.ptr[i + 1]].is_sorted_by(|a, b| a < b);
        (0..self.rows).all(ascending)
    }
}

/// Entries (i, j, value) in any order; repeated ones are summed.
#[derive(Clone, Debug)]
pub struct Triplets {
    cols: usize,
    entries: Vec<Vec<(usize, f64)>>,
}

impl Triplets {
    /// A zero `rows` x `cols` matrix.
    pub fn new(rows: usize, cols: usize) -> Triplets {
        Triplets { cols, entries: vec![Vec::new(); rows] }
    }

    /// A_ij := A_ij + value.
    pub fn add(&mut self, i: usize, j: usize, value: f64) {
        self.entries[i].push((j, value));
    }

    /// The matrix; entries that sum to exactly zero are left out.
    pub fn to_csr(&self) -> Csr {
        let mut matrix = Csr::empty(self.cols);
        for row in &self.entries {
            matrix.push_row(row);
        }
        matrix
    }
}

#[cfg(test)]
mod tests {
    use super::{Csr, Triplets};

    fn three_by_three() -> Csr {
        let mut triplets = Triplets::new(3, 3);
        for (i, j, value) in [(2, 1, -1.0), (0, 0, 2.0), (1, 2, -1.0), (1, 1, 3.0), (0, 0, 0.5)] {
            triplets.add(i, j, value);
        }
        triplets.add(2, 2, 4.0);
        triplets.to_csr()
    }

    #[test]
    fn triplets_are_sorted_and_repeated_entries_summed() {
        let matrix = three_by_three();
        assert_eq!(matrix.ptr, [0, 1, 3, 5]);
        assert_eq!(matrix.col, [0, 1, 2, 1, 2]);
        assert_eq!(matrix.val, [2.5, 3.0, -1.0, -1.0, 4.0]);
    }

    #[test]
    fn lower_triangle_keeps_the_diagonal_and_drops_the_upper_part() {
        let lower = three_by_three().lower();
        assert_eq!(lower.col, [0, 1, 1, 2]);
        assert_eq!(lower.val, [2.5, 3.0, -1.0, 4.0]);
    }

    #[test]
    fn restriction_keeps_the_chosen_rows_and_columns() {
        let part = three_by_three().restricted(&[1, 2]);
        assert_eq!(part, Csr::from_dense(2, &[3.0, -1.0, -1.0, 4.0]));
    }

    #[test]
    fn transpose_product_is_adjoint_to_the_product() {
        let mut matrix = Csr::empty(3);
        matrix.push_row(&[(2, 5.0), (0, 1.0)]);
        matrix.push_row(&[(1, -2.0)]);
        assert_eq!(matrix.times(&[1.0, 2.0, 3.0]), [16.0, -4.0]);
        assert_eq!(matrix.transpose_times(&[1.0, 10.0]), [1.0, -20.0, 5.0]);
    }

    #[test]
    fn asymmetry_sees_a_missing_entry() {
        let mut triplets = Triplets::new(2, 2);
        triplets.add(0, 1, 3.0);
        assert_eq!(triplets.to_csr().asymmetry(), 3.0);
    }
}
