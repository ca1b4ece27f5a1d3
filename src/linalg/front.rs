//! Dense work on one supernode: its panel is factorised, and the update for the supernodes above is formed,
//!
//! ```text
//! [A11    ]   [L11   ]            U <- U - L21 L21'
//! [A21   U],  [L21   ],
//! ```
//!
//! the lower triangle of U stored by tiles: block columns, each from its diagonal down. Tiles are independent of each
//! other; the sums within one are the same whoever forms it.

use faer::dyn_stack::{MemBuffer, MemStack, StackReq};
use faer::linalg::cholesky::llt::factor::{cholesky_in_place, cholesky_in_place_scratch, LltError};
use faer::linalg::matmul::matmul;
use faer::linalg::matmul::triangular::{self, BlockStructure};
use faer::linalg::triangular_solve::solve_lower_triangular_in_place;
use faer::{Accum, MatMut, MatRef, Par};
use rayon::prelude::*;

/// Columns of a tile.
pub const TILE: usize = 256;
/// Columns of a panel factorised at a time.
const BLOCK: usize = 128;

/// Values of the lower triangle of an update of order b.
pub fn update_len(b: usize) -> usize {
    tile_start(b, b.div_ceil(TILE))
}

/// Where tile t of an update of order b starts: before it come t tiles of b, b - TILE, ... rows.
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
pub fn update_column(b: usize, j: usize) -> std::ops::Range<usize> {
    let t = j / TILE;
    let height = b - t * TILE;
    let column = tile_start(b, t) + (j - t * TILE) * height;
    column + (j - t * TILE)..column + height
}

/// Workspace of the dense kernels.
pub fn scratch() -> StackReq {
    cholesky_in_place_scratch::<f64>(BLOCK, Par::Seq, Default::default())
}

/// Factorises the panel (height x width, column-major) and subtracts `L21 L21'` from the update. `parallel`: tiles are
/// shared among the threads of the present pool. `Err`: the column whose pivot is not positive.
pub fn factorize(
    panel: &mut [f64],
    width: usize,
    update: &mut [f64],
    workspace: &mut MemBuffer,
    parallel: bool,
) -> Result<(), usize> {
    let height = panel.len() / width.max(1);
    let mut first = 0;
    while first < width {
        let block = BLOCK.min(width - first);
        let (own, later) = panel[first * height..].split_at_mut(block * height);
        factorize_block(own, height, first, workspace, parallel).map_err(|at| first + at)?;
        let own = MatRef::from_column_major_slice(own, height, block);
        let tiles = later[..(width - first - block) * height].chunks_mut(TILE * height).enumerate();
        each(parallel, tiles.collect(), |(t, tile)| {
            let top = first + block + t * TILE;
            let columns = tile.len() / height;
            let tile = MatMut::from_column_major_slice_mut(tile, height, columns);
            subtract_product(tile.subrows_mut(top, height - top), own.subrows(top, height - top));
        });
        first += block;
    }
    let below = height - width;
    let panel = MatRef::from_column_major_slice(panel, height, width);
    each(parallel, tiles_mut(update, below), |(t, tile)| {
        let rows = below - t * TILE;
        let columns = tile.len() / rows;
        let tile = MatMut::from_column_major_slice_mut(tile, rows, columns);
        subtract_product(tile, panel.subrows(height - rows, rows));
    });
    Ok(())
}

/// The tiles of an update of order b, with their numbers.
fn tiles_mut(mut update: &mut [f64], b: usize) -> Vec<(usize, &mut [f64])> {
    let mut tiles = Vec::with_capacity(b.div_ceil(TILE));
    for t in 0..b.div_ceil(TILE) {
        let rows = b - t * TILE;
        let (tile, rest) = update.split_at_mut(rows * TILE.min(rows));
        tiles.push((t, tile));
        update = rest;
    }
    tiles
}

/// One block of columns, `height` x a few, from row `first` on: the triangle, then the rows below.
fn factorize_block(
    columns: &mut [f64],
    height: usize,
    first: usize,
    workspace: &mut MemBuffer,
    parallel: bool,
) -> Result<(), usize> {
    let width = columns.len() / height;
    let columns = MatMut::from_column_major_slice_mut(columns, height, width);
    let (_, rows) = columns.split_at_row_mut(first);
    let (mut top, below) = rows.split_at_row_mut(width);
    let stack = MemStack::new(workspace);
    match cholesky_in_place(top.as_mut(), Default::default(), Par::Seq, stack, Default::default()) {
        Ok(_) => {}
        Err(LltError::NonPositivePivot { index }) => return Err(index),
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
    // X L' = A is L X' = A'
    each(parallel, parts, |part| solve_lower_triangular_in_place(top, part.transpose_mut(), Par::Seq));
    Ok(())
}

/// `tile -= a a_1'`, on and below the diagonal of the first rows; a_1 are as many rows of a as the tile has columns.
fn subtract_product(tile: MatMut<'_, f64>, a: MatRef<'_, f64>) {
    let columns = tile.ncols();
    let first = a.subrows(0, columns);
    let (top, below) = tile.split_at_row_mut(columns);
    let (full, lower) = (BlockStructure::Rectangular, BlockStructure::TriangularLower);
    triangular::matmul(top, lower, Accum::Add, first, full, first.transpose(), full, -1.0, Par::Seq);
    matmul(below, Accum::Add, a.subrows(columns, a.nrows() - columns), first.transpose(), -1.0, Par::Seq);
}

/// Does all tasks, in the present pool or one after the other.
fn each<T: Send>(parallel: bool, tasks: Vec<T>, work: impl Fn(T) + Send + Sync) {
    if parallel && tasks.len() > 1 {
        tasks.into_par_iter().for_each(work);
    } else {
        tasks.into_iter().for_each(work);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_tiles_of_an_update_follow_each_other_without_gaps() {
        for b in [0, 1, TILE - 1, TILE, TILE + 1, 3 * TILE + 7] {
            let mut update = vec![0.0; update_len(b)];
            assert_eq!(tiles_mut(&mut update, b).iter().map(|tile| tile.1.len()).sum::<usize>(), update_len(b));
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
