//! Dense work on one supernode: its panel is factorised, and the update for the supernodes above is formed,
//!
//! ```text
//! [A11   ]   [L11   ]
//! [A21  0] = [L21   ],   U = - L21 L21' + updates of the children
//! ```
//!
//! the lower triangle of U stored by tiles: block columns, each from its diagonal down. Tiles are independent of each
//! other; the sums within a tile do not depend on the thread that forms it.

use std::ops::Range;

use faer::dyn_stack::{MemBuffer, MemStack, StackReq};
use faer::linalg::cholesky::llt::factor::{cholesky_in_place, cholesky_in_place_scratch, LltError};
use faer::linalg::matmul::matmul;
use faer::linalg::matmul::triangular::{self, BlockStructure};
use faer::linalg::triangular_solve::solve_lower_triangular_in_place;
use faer::{Accum, MatMut, MatRef, Par};

use crate::linalg::cholesky::analysis::subtrees::each;
use crate::linalg::cholesky::numeric::Entry;
use crate::numbers::linalg::HELD_PIVOT;

/// Columns of a tile.
pub const TILE: usize = 256;
/// Columns of a panel factorised together.
const BLOCK: usize = 128;

/// Number of values in the lower triangle of an update of order b.
pub fn update_len(b: usize) -> usize {
    tile_start(b, b.div_ceil(TILE))
}

/// Start of tile t in an update of order b: before it are t tiles of b, b - TILE, ... rows.
fn tile_start(b: usize, t: usize) -> usize {
    let before = t.min(b / TILE);
    let whole = before * TILE * b - TILE * TILE * (before * before.saturating_sub(1) / 2);
    if t > before {
        whole + (b - before * TILE) * (b - before * TILE)
    } else {
        whole
    }
}

/// Column j of an update of order b, from the diagonal down.
pub fn update_column(b: usize, j: usize) -> Range<usize> {
    let t = j / TILE;
    let height = b - t * TILE;
    let column = tile_start(b, t) + (j - t * TILE) * height;
    column + (j - t * TILE)..column + height
}

/// Workspace of the dense kernels.
pub fn scratch<T: Entry>() -> StackReq {
    cholesky_in_place_scratch::<T>(BLOCK, Par::Seq, Default::default())
}

/// Factorises the panel, height x width, column-major. `parallel`: the threads of the present pool share the tiles. If
/// `hold` is positive, pivots up to `hold` are held. `Err`: the column whose pivot is not positive.
pub fn factorize<T: Entry>(
    panel: &mut [T],
    width: usize,
    hold: f64,
    workspace: &mut MemBuffer,
    parallel: bool,
) -> Result<(), usize> {
    let height = panel.len() / width.max(1);
    let mut first = 0;
    while first < width {
        let block = BLOCK.min(width - first);
        let (own, later) = panel[first * height..].split_at_mut(block * height);
        factorize_block(own, (height, first), hold, workspace, parallel).map_err(|at| first + at)?;
        let own = MatRef::from_column_major_slice(own, height, block);
        let tiles = later[..(width - first - block) * height].chunks_mut(TILE * height).enumerate();
        each(parallel, tiles.collect(), |(t, tile)| {
            let top = first + block + t * TILE;
            let columns = tile.len() / height;
            let tile = MatMut::from_column_major_slice_mut(tile, height, columns);
            subtract_product(tile.subrows_mut(top, height - top), own.subrows(top, height - top), Accum::Add);
        });
        first += block;
    }
    Ok(())
}

/// The update from a factorised panel. `complete` adds the updates of the children to some of its columns, on and below
/// the diagonal.
pub fn update<T: Entry>(
    panel: &[T],
    width: usize,
    update: &mut [T],
    parallel: bool,
    complete: impl Fn(&mut Tile<'_, T>) + Send + Sync,
) {
    let height = panel.len() / width.max(1);
    let below = height - width;
    let panel = MatRef::from_column_major_slice(panel, height, width);
    each(parallel, tiles(update, below), |mut tile| {
        let (rows, columns) = (below - tile.columns.start, tile.columns.len());
        let to = MatMut::from_column_major_slice_mut(tile.values, rows, columns);
        subtract_product(to, panel.subrows(height - rows, rows), Accum::Replace);
        complete(&mut tile);
    });
}

/// Some columns of an update, from the diagonal of the first column down.
pub struct Tile<'a, T> {
    pub columns: Range<usize>,
    values: &'a mut [T],
}

impl<T> Tile<'_, T> {
    /// Column j of the update from the row j on.
    pub fn column(&mut self, j: usize) -> &mut [T] {
        let height = self.values.len() / self.columns.len();
        let column = j - self.columns.start;
        &mut self.values[column * height + column..(column + 1) * height]
    }
}

/// The tiles of an update of order b.
fn tiles<T>(mut update: &mut [T], b: usize) -> Vec<Tile<'_, T>> {
    let mut tiles = Vec::with_capacity(b.div_ceil(TILE));
    for first in (0..b).step_by(TILE) {
        let (rows, columns) = (b - first, TILE.min(b - first));
        let (values, rest) = update.split_at_mut(rows * columns);
        tiles.push(Tile { columns: first..first + columns, values });
        update = rest;
    }
    tiles
}

/// One block of columns of this height, from row `first` on: the triangle, then the rows below.
fn factorize_block<T: Entry>(
    columns: &mut [T],
    (height, first): (usize, usize),
    hold: f64,
    workspace: &mut MemBuffer,
    parallel: bool,
) -> Result<(), usize> {
    let width = columns.len() / height;
    let columns = MatMut::from_column_major_slice_mut(columns, height, width);
    let (_, rows) = columns.split_at_row_mut(first);
    let (mut top, below) = rows.split_at_row_mut(width);
    let stack = MemStack::new(workspace);
    if hold > 0.0 {
        factorize_holding(top.as_mut(), hold)?;
    } else {
        let done = cholesky_in_place(top.as_mut(), Default::default(), Par::Seq, stack, Default::default());
        done.map_err(|LltError::NonPositivePivot { index }| index)?;
    }
    let top = top.as_ref();
    let mut parts = Vec::new();
    let mut rest = below;
    while rest.nrows() > TILE && parallel {
        let (part, next) = rest.split_at_row_mut(TILE);
        parts.push(part);
        rest = next;
    }
    parts.push(rest);
    // X L' = A is equivalent to L X' = A'
    each(parallel, parts, |part| solve_lower_triangular_in_place(top, part.transpose_mut(), Par::Seq));
    Ok(())
}

/// L of a small block, column by column; pivots up to `hold` are held.
fn factorize_holding<T: Entry>(mut a: MatMut<'_, T>, hold: f64) -> Result<(), usize> {
    let n = a.ncols();
    for j in 0..n {
        let pivot: f64 = a[(j, j)].into();
        if pivot.is_nan() {
            return Err(j);
        }
        let root = T::of(if pivot > hold { pivot.sqrt() } else { HELD_PIVOT.sqrt() });
        a[(j, j)] = root;
        (j + 1..n).for_each(|i| a[(i, j)] /= root);
        for k in j + 1..n {
            let v = a[(k, j)];
            for i in k..n {
                let product = v * a[(i, j)];
                a[(i, k)] -= product;
            }
        }
    }
    Ok(())
}

/// `tile <- tile - a a_1'` or `- a a_1'`, on and below the diagonal of the first rows; a_1 are the first rows of a, one
/// per column of the tile.
fn subtract_product<T: Entry>(tile: MatMut<'_, T>, a: MatRef<'_, T>, to: Accum) {
    let columns = tile.ncols();
    let first = a.subrows(0, columns);
    let (top, below) = tile.split_at_row_mut(columns);
    let (full, lower) = (BlockStructure::Rectangular, BlockStructure::TriangularLower);
    let minus = T::of(-1.0);
    triangular::matmul(top, lower, to, first, full, first.transpose(), full, minus, Par::Seq);
    matmul(below, to, a.subrows(columns, a.nrows() - columns), first.transpose(), minus, Par::Seq);
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_tiles_of_an_update_follow_each_other_without_gaps() {
        for b in [0, 1, TILE - 1, TILE, TILE + 1, 3 * TILE + 7] {
            let mut update = vec![0.0; update_len(b)];
            let values = tiles(&mut update, b).iter().map(|tile| tile.values.len()).sum::<usize>();
            assert_eq!(values, update_len(b));
            for j in 0..b {
                let column = update_column(b, j);
                assert_eq!(column.len(), b - j);
                assert!(column.end <= update_len(b));
                update[column].iter_mut().for_each(|v| *v += 1.0);
            }
            assert!(update.iter().all(|v| *v <= 1.0));
            assert_eq!(update.iter().sum::<f64>() as usize, b * (b + 1) / 2);
        }
    }
}
