//! `y = A x` with the tiles of a packed matrix: each is read once, and used both below the diagonal and, transposed,
//! above it. Four columns of tiles are read in parallel, because a single stream of memory waits at the end of every
//! page.

use crate::linalg::dense::packed::kernel::{Kernel, Portable};
use crate::linalg::dense::packed::{Line, Tile, SIDE};
use crate::linalg::vector::{as_arrays, as_arrays_mut};

/// Number of columns of tiles in a panel.
const PANEL: usize = 4;
/// Tiles below the diagonal tiles of a panel that are prefetched while the previous panel is read.
const AHEAD: usize = 2;

/// `y = A x` by the fastest instructions of this processor.
pub fn product(tiles: &[Tile], x: &[f64], y: &mut [f64]) {
    #[cfg(target_arch = "x86_64")]
    {
        use crate::linalg::dense::packed::x86::Avx2;
        #[cfg(avx512)]
        if let Some(avx512) = crate::linalg::dense::packed::avx512::Avx512::detect() {
            return product_by(&avx512, tiles, x, y);
        }
        if let Some(avx2) = Avx2::detect() {
            return product_by(&avx2, tiles, x, y);
        }
    }
    product_by(&Portable, tiles, x, y);
}

/// The first column of tiles contains the zeros before the first row of A, so it is separate; all others have whole
/// lines.
pub fn product_by(kernel: &impl Kernel, tiles: &[Tile], x: &[f64], y: &mut [f64]) {
    y.fill(0.0);
    let own = x.len() - SIDE * (x.len().div_ceil(SIDE).max(1) - 1);
    let ((x_first, x), (y_first, y)) = (x.split_at(own), y.split_at_mut(own));
    let (x, y) = (as_arrays::<SIDE>(x).0, as_arrays_mut::<SIDE>(y).0);
    let Some((corner, tiles)) = tiles.split_first() else { return };
    let mut factors = [0.0; SIDE];
    factors[SIDE - own..].copy_from_slice(x_first);
    let (column, tiles) = tiles.split_at(x.len());
    let [sums] = kernel.columns([column], x, y, &[factors]);
    let mut line = [0.0; SIDE];
    add_diagonal(corner, &factors, &sums, &mut line);
    y_first.copy_from_slice(&line[SIDE - own..]);
    whole_lines(kernel, tiles, x, y);
}

fn whole_lines(kernel: &impl Kernel, mut tiles: &[Tile], mut x: &[Line], mut y: &mut [Line]) {
    while !x.is_empty() {
        let (n, width) = (x.len(), PANEL.min(x.len()));
        let mut columns: [&[Tile]; PANEL] = [&[]; PANEL];
        for (p, column) in columns.iter_mut().enumerate().take(width) {
            (*column, tiles) = tiles.split_at(n - p);
        }
        let ((x_own, x_below), (y_own, y_below)) = (x.split_at(width), y.split_at_mut(width));
        triangle(kernel, &columns[..width], x_own, y_own);
        if let Some(factors) = x_own.first_chunk::<PANEL>() {
            ask_for_panel(kernel, tiles, x_below.len());
            let below = std::array::from_fn(|p| &columns[p][PANEL - p..]);
            let sums = kernel.columns::<PANEL>(below, x_below, y_below, factors);
            y_own.iter_mut().zip(&sums).for_each(|(y, sums)| add(sums, y));
        }
        (x, y) = (x_below, y_below);
    }
}

/// The processor prefetches the next tiles of a column, but not the first tiles of another column.
fn ask_for_panel(kernel: &impl Kernel, mut tiles: &[Tile], n: usize) {
    for p in 0..PANEL.min(n) {
        let (column, rest) = tiles.split_at(n - p);
        kernel.ask_for(&column[..(PANEL - p + AHEAD).min(column.len())]);
        tiles = rest;
    }
}

/// The diagonal tiles of a panel and the tiles between them.
fn triangle(kernel: &impl Kernel, columns: &[&[Tile]], x: &[Line], y: &mut [Line]) {
    let width = x.len();
    for (p, column) in columns.iter().enumerate() {
        let (own, below) = y[p..].split_at_mut(1);
        let [sums] = kernel.columns([&column[1..width - p]], &x[p + 1..], below, &[x[p]]);
        add_diagonal(&column[0], &x[p], &sums, &mut own[0]);
    }
}

/// `y += A_pp x + sums`, with the whole tile A_pp.
fn add_diagonal(tile: &Tile, x: &Line, sums: &Line, y: &mut Line) {
    for (a, x) in tile.0.iter().zip(x) {
        (0..SIDE).for_each(|k| y[k] += a[k] * x);
    }
    add(sums, y);
}

fn add(x: &Line, y: &mut Line) {
    y.iter_mut().zip(x).for_each(|(y, x)| *y += x);
}
