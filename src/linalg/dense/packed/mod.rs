//! Dense symmetric matrices, the lower triangle: local dual operators F_p. Small matrices are stored by rows, others in
//! square tiles.
//!
//! Zeros before the first row and column fill the order up to a multiple of 8. In every column of tiles, the tiles on and
//! below the diagonal are consecutive, so that the product reads memory sequentially in whole cache lines; the tiles on
//! the diagonal contain both triangles.

#[cfg(avx512)]
mod avx512;
mod kernel;
mod product;
#[cfg(target_arch = "x86_64")]
mod x86;

use crate::error::Result;
use crate::linalg::{Entries, Matrix, Operator};
use crate::platform::memory::{filled, zeros};
use crate::ranks::{damaged, Wire};

const WHAT: &str = "an explicit dual operator";

/// Rows and columns of a tile: one cache line.
const SIDE: usize = 8;

/// Smaller matrices would mostly consist of diagonal tiles: their entries are stored and processed one by one.
const SMALL: usize = 128;

/// Consecutive entries of a column, or of a vector.
type Line = [f64; SIDE];

/// Column after column.
#[derive(Debug, Clone, PartialEq)]
#[repr(C, align(64))]
struct Tile([Line; SIDE]);

/// Symmetric `m x m`.
#[derive(Debug, Clone, PartialEq)]
pub struct Packed {
    order: usize,
    lower: Lower,
}

/// The lower triangle.
#[derive(Debug, Clone, PartialEq)]
enum Lower {
    Rows(Vec<f64>),
    Tiles(Vec<Tile>),
}

/// Sent row by row.
impl Wire for Packed {
    fn put(&self, to: &mut Vec<u8>) {
        self.order.put(to);
        (0..self.order).for_each(|i| (0..=i).for_each(|j| self.get(i, j).put(to)));
    }

    fn take(from: &mut &[u8]) -> Result<Self> {
        let order = usize::take(from)?;
        // the message has an entry for each of the memory
        if from.len() / size_of::<f64>() < row(order) {
            return Err(damaged());
        }
        let mut packed = Self::zeros(order)?;
        for i in 0..order {
            for j in 0..=i {
                packed.add(i, j, f64::take(from)?);
            }
        }
        Ok(packed)
    }
}

impl Packed {
    /// Bytes of a packed matrix of this order.
    pub fn bytes(order: usize) -> usize {
        if order < SMALL {
            return row(order) * size_of::<f64>();
        }
        tiles(order.div_ceil(SIDE)).saturating_mul(size_of::<Tile>())
    }

    pub fn zeros(order: usize) -> Result<Self> {
        if order < SMALL {
            return Ok(Self { order, lower: Lower::Rows(zeros(row(order), WHAT)?) });
        }
        Self::in_tiles(order)
    }

    fn in_tiles(order: usize) -> Result<Self> {
        let tiles = filled(tiles(order.div_ceil(SIDE)), Tile([[0.0; SIDE]; SIDE]), WHAT)?;
        Ok(Self { order, lower: Lower::Tiles(tiles) })
    }

    /// `A_ij += value`, for i and j in any order.
    pub fn add(&mut self, i: usize, j: usize, value: f64) {
        self.change(i, j, |entry| *entry += value);
    }

    /// `A_ij <- by_i A_ij by_j`
    pub fn scale(&mut self, by: &[f64]) {
        for i in 0..self.order {
            (0..=i).for_each(|j| self.change(i, j, |entry| *entry = by[i] * (by[j] * *entry)));
        }
    }

    fn change(&mut self, i: usize, j: usize, change: impl Fn(&mut f64)) {
        let (i, j, order) = (i.max(j), i.min(j), self.order);
        match &mut self.lower {
            Lower::Rows(entries) => change(&mut entries[row(i) + j]),
            Lower::Tiles(tiles) => {
                let (i, j) = (padded(order, i), padded(order, j));
                let tile = &mut tiles[tile(order, i / SIDE, j / SIDE)].0;
                change(&mut tile[j % SIDE][i % SIDE]);
                if i / SIDE == j / SIDE && i != j {
                    change(&mut tile[i % SIDE][j % SIDE]);
                }
            }
        }
    }

    /// `A_ij += gram_kl` for i = `indices[k]`, j = `indices[l]`, k >= l: n ascending `indices`, `gram` n x n by columns,
    /// of which the lower triangle is read.
    pub fn add_lower<T: Copy + Into<f64>>(&mut self, indices: &[usize], gram: &[T]) {
        let (n, pad) = (indices.len(), padded(self.order, 0));
        let mut start = 0;
        for columns in indices.chunk_by(|a, b| (pad + a) / SIDE == (pad + b) / SIDE) {
            self.add_columns(&indices[start..], columns.len(), &gram[start * (n + 1)..], n);
            start += columns.len();
        }
    }

    /// The first `width` columns of `add_lower`, all within one column of tiles; `stride`: distance of the columns of
    /// `gram`.
    fn add_columns<T: Copy + Into<f64>>(
        &mut self,
        indices: &[usize],
        width: usize,
        gram: &[T],
        stride: usize,
    ) {
        let (own, below) = indices.split_at(width);
        for (l, &j) in own.iter().enumerate() {
            (l..width).for_each(|k| self.add(indices[k], j, gram[l * stride + k].into()));
        }
        let (pad, mut start) = (padded(self.order, 0), width);
        for rows in below.chunk_by(|a, b| (pad + a) / SIDE == (pad + b) / SIDE) {
            for (l, &j) in own.iter().enumerate() {
                let gram = rows.iter().zip(gram[l * stride + start..].iter().map(|v| (*v).into()));
                match &mut self.lower {
                    Lower::Rows(entries) => gram.for_each(|(&i, v)| entries[row(i) + j] += v),
                    Lower::Tiles(tiles) => {
                        let tile = tile(self.order, (pad + rows[0]) / SIDE, (pad + j) / SIDE);
                        let line = &mut tiles[tile].0[(pad + j) % SIDE];
                        gram.for_each(|(i, v)| line[(pad + i) % SIDE] += v);
                    }
                }
            }
            start += rows.len();
        }
    }

    /// `A <- -A`
    pub fn negate(&mut self) {
        let negate = |values: &mut [f64]| values.iter_mut().for_each(|v| *v = -*v);
        match &mut self.lower {
            Lower::Rows(entries) => negate(entries),
            Lower::Tiles(tiles) => tiles.iter_mut().for_each(|tile| negate(tile.0.as_flattened_mut())),
        }
    }

    pub fn get(&self, i: usize, j: usize) -> f64 {
        let (i, j) = (i.max(j), i.min(j));
        match &self.lower {
            Lower::Rows(entries) => entries[row(i) + j],
            Lower::Tiles(tiles) => {
                let (i, j) = (padded(self.order, i), padded(self.order, j));
                tiles[tile(self.order, i / SIDE, j / SIDE)].0[j % SIDE][i % SIDE]
            }
        }
    }
}

/// Position of the first entry of row i of a lower triangle by rows.
fn row(i: usize) -> usize {
    i * (i + 1) / 2
}

/// `y = A x`, row by row of the lower triangle.
fn product_by_rows(entries: &[f64], x: &[f64], y: &mut [f64]) {
    y.fill(0.0);
    for i in 0..x.len() {
        let (own, diagonal) = (&entries[row(i)..][..i], entries[row(i) + i]);
        let mut sum = diagonal * x[i];
        for (j, a) in own.iter().enumerate() {
            sum += a * x[j];
            y[j] += a * x[i];
        }
        y[i] += sum;
    }
}

/// Number of a row including the zeros before the first row.
fn padded(order: usize, i: usize) -> usize {
    order.next_multiple_of(SIDE) - order + i
}

/// Position of tile (i, j), j <= i.
fn tile(order: usize, i: usize, j: usize) -> usize {
    let columns = order.div_ceil(SIDE);
    tiles(columns) - tiles(columns - j) + i - j
}

/// Number of tiles for this number of columns.
fn tiles(columns: usize) -> usize {
    columns.saturating_mul(columns + 1) / 2
}

impl Operator for Packed {
    fn order(&self) -> usize {
        self.order
    }

    /// `y = A x`; every entry is read once.
    fn apply(&self, x: &[f64], y: &mut [f64]) {
        match &self.lower {
            Lower::Rows(entries) => product_by_rows(entries, x, y),
            Lower::Tiles(tiles) => product::product(tiles, x, y),
        }
    }

    fn bytes_kept(&self) -> usize {
        Self::bytes(self.order)
    }
}

impl Entries for Packed {
    fn add_block(&self, rows: &[usize], block: &mut Matrix) -> Result<()> {
        for (l, &j) in rows.iter().enumerate() {
            let column = block.col_mut(l);
            rows.iter().enumerate().skip(l).for_each(|(k, &i)| column[k] += self.get(i, j));
        }
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_packed_product_equals_the_full_one() {
        let mut a = Packed::zeros(3).unwrap();
        for (i, j, v) in [(0, 0, 2.0), (0, 1, -1.0), (1, 1, 3.0), (2, 0, 5.0), (2, 2, 1.0)] {
            a.add(i, j, v);
        }
        let mut y = [0.0; 3];
        a.apply(&[1.0, 2.0, 3.0], &mut y);
        assert_eq!(y, [15.0, 5.0, 8.0]);
        assert_eq!(a.get(0, 2), 5.0);
    }

    /// Integers of size up to 50: products and sums are exact in any order.
    fn entry(i: usize, j: usize) -> f64 {
        ((i.max(j) * 31 + i.min(j) * 17) % 101) as f64 - 50.0
    }

    fn filled(order: usize) -> Packed {
        with_entries(Packed::zeros(order).unwrap())
    }

    fn with_entries(mut a: Packed) -> Packed {
        let order = a.order;
        (0..order).for_each(|i| (0..=i).for_each(|j| a.add(j, i, entry(i, j))));
        a
    }

    fn orders() -> impl Iterator<Item = usize> {
        (0..71).chain([127, 128, 129, 333, 1001])
    }

    fn dense_product(order: usize, x: &[f64]) -> Vec<f64> {
        (0..order).map(|i| (0..order).map(|j| entry(i, j) * x[j]).sum()).collect()
    }

    #[test]
    fn the_product_equals_the_dense_one_for_any_order() {
        for order in orders() {
            let x: Vec<f64> = (0..order).map(|i| ((7 * i) % 23) as f64 - 11.0).collect();
            let mut y = vec![f64::NAN; order];
            filled(order).apply(&x, &mut y);
            assert_eq!(y, dense_product(order, &x), "{order}");
        }
    }

    /// The products by every set of instructions of this processor; prints their number.
    fn products(a: &Packed, x: &[f64]) -> Vec<Vec<f64>> {
        let Lower::Tiles(tiles) = &a.lower else { panic!("no tiles") };
        let mut y = vec![vec![f64::NAN; a.order]; 3];
        product::product_by(&kernel::Portable, tiles, x, &mut y[0]);
        let mut sets = 1;
        #[cfg(target_arch = "x86_64")]
        {
            if let Some(avx2) = x86::Avx2::detect() {
                product::product_by(&avx2, tiles, x, &mut y[sets]);
                sets += 1;
            }
            #[cfg(avx512)]
            if let Some(avx512) = avx512::Avx512::detect() {
                product::product_by(&avx512, tiles, x, &mut y[sets]);
                sets += 1;
            }
        }
        y.truncate(sets);
        y
    }

    #[test]
    fn all_sets_of_instructions_give_the_same_bits_and_the_dense_product_to_rounding() {
        for order in orders().filter(|order| *order > 0) {
            let mut a = with_entries(Packed::in_tiles(order).unwrap());
            (0..order).for_each(|i| a.add(i, i, 0.1 * i as f64 + 1.0 / 3.0));
            let x: Vec<f64> = (0..order).map(|i| (1.0 + i as f64).sin()).collect();
            let all = products(&a, &x);
            assert!(all.iter().all(|y| *y == all[0]), "{order}");
            for (i, y) in all[0].iter().enumerate() {
                let terms = (0..order).map(|j| a.get(i, j) * x[j]);
                let (exact, size) = terms.fold((0.0, 0.0), |(sum, size), t| (sum + t, size + t.abs()));
                assert!((y - exact).abs() <= 1e-14 * size, "{order}");
            }
        }
    }

    #[test]
    fn all_sets_of_instructions_agree_exactly_on_whole_numbers() {
        for order in orders() {
            let x: Vec<f64> = (0..order).map(|i| (i % 5) as f64 - 2.0).collect();
            let expected = dense_product(order, &x);
            let a = with_entries(Packed::in_tiles(order).unwrap());
            assert!(products(&a, &x).iter().all(|y| *y == expected), "{order}");
        }
    }

    #[test]
    fn a_block_added_at_once_equals_its_entries_added_one_by_one() {
        let lists: [&[usize]; 6] =
            [&[], &[40], &[0, 1, 2, 3, 4], &[3, 4, 5, 9, 17, 18, 19, 20, 21, 22, 30, 40], &[0, 40], &[7, 8]];
        for order in [41, 48, 64, SMALL] {
            for indices in lists.iter().copied().chain([(0..41).collect::<Vec<_>>().as_slice()]) {
                let n = indices.len();
                // the upper triangle must not be read
                let gram: Vec<f64> =
                    (0..n * n).map(|at| if at % n < at / n { f64::NAN } else { at as f64 }).collect();
                let (mut once, mut single) = (filled(order), filled(order));
                once.add_lower(indices, &gram);
                for l in 0..n {
                    (l..n).for_each(|k| single.add(indices[k], indices[l], gram[l * n + k]));
                }
                assert_eq!(once, single, "{order} {indices:?}");
                let mut y = [vec![0.0; order], vec![0.0; order]];
                once.apply(&vec![1.0; order], &mut y[0]);
                (0..order).for_each(|i| y[1][i] = (0..order).map(|j| once.get(i, j)).sum());
                assert_eq!(y[0], y[1]);
            }
        }
    }

    #[test]
    fn a_scaled_matrix_has_scaled_rows_and_columns() {
        for order in [3, 127, 128, 203] {
            let by: Vec<f64> = (0..order).map(|i| 2f64.powi(i as i32 % 7 - 3)).collect();
            let (mut scaled, mut expected) = (Packed::zeros(order).unwrap(), Packed::zeros(order).unwrap());
            for i in 0..order {
                for j in 0..=i {
                    let value = (3 * i + 5 * j) as f64 + 0.3;
                    scaled.add(i, j, value);
                    expected.add(i, j, by[i] * value * by[j]);
                }
            }
            scaled.scale(&by);
            assert_eq!(scaled, expected, "{order}");
        }
    }

    #[test]
    fn a_negated_matrix_gives_the_opposite_product() {
        let (a, x) = (filled(19), [1.0; 19]);
        let mut b = a.clone();
        b.negate();
        let (mut y, mut z) = ([0.0; 19], [0.0; 19]);
        a.apply(&x, &mut y);
        b.apply(&x, &mut z);
        assert!(y.iter().zip(z).all(|(y, z)| *y == -z));
    }
}
