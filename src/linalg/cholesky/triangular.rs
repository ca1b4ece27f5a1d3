//! Solves with L and L' for one right-hand side: each reads L once, at the speed of the memory.

use std::ops::Range;

use crate::error::Result;
use crate::linalg::cholesky::factor::Cholesky;
use crate::linalg::cholesky::numeric::Entry;
use crate::platform::memory::zeros;

/// Columns per block: the vector is read once for each block.
const COLUMNS: usize = 4;
/// Entries of a column that are prefetched together.
const AHEAD: usize = 32;

impl<T: Entry> Cholesky<T> {
    /// Workspace of a solve.
    pub(super) fn workspace(&self) -> Result<Vec<f64>> {
        zeros(self.analysis.highest_front(), "a solution")
    }

    /// `y <- L^-1 y`, in the order of elimination, for the columns of some supernodes, which no other supernodes precede.
    pub(super) fn forward(&self, nodes: Range<usize>, y: &mut [f64], workspace: &mut [f64]) {
        for node in nodes.map(|s| self.analysis.nodes.node(s)) {
            let front = &mut workspace[..node.height()];
            front[..node.width].copy_from_slice(&y[node.begin..node.end()]);
            front[node.width..].fill(0.0);
            by_vectors::<T, Forward>(&self.values[node.panel.clone()], node.width, front);
            y[node.begin..node.end()].copy_from_slice(&front[..node.width]);
            node.rows.iter().zip(&front[node.width..]).for_each(|(&row, v)| y[row as usize] += v);
        }
    }

    /// `y <- L^-T y`, in the order of elimination, for the columns of some supernodes.
    pub(super) fn backward(&self, nodes: Range<usize>, y: &mut [f64], workspace: &mut [f64]) {
        for node in nodes.rev().map(|s| self.analysis.nodes.node(s)) {
            let front = &mut workspace[..node.height()];
            front[..node.width].copy_from_slice(&y[node.begin..node.end()]);
            front[node.width..].iter_mut().zip(node.rows).for_each(|(v, &row)| *v = y[row as usize]);
            by_vectors::<T, Backward>(&self.values[node.panel.clone()], node.width, front);
            y[node.begin..node.end()].copy_from_slice(&front[..node.width]);
        }
    }
}

/// Prefetches the cache lines of the next columns: these are too short for the processor's own prefetch.
#[inline(always)]
#[cfg_attr(not(target_arch = "x86_64"), allow(unused_variables))]
fn ask_for<T>(entries: *const T) {
    #[cfg(target_arch = "x86_64")]
    for line in 0..AHEAD * size_of::<T>() / 64 {
        use std::arch::x86_64::{_mm_prefetch, _MM_HINT_T0};
        // SAFETY: SSE is part of x86-64; nothing is read or written, for any address
        unsafe { _mm_prefetch::<_MM_HINT_T0>(entries.cast::<i8>().wrapping_add(64 * line)) };
    }
}

/// An operation on a panel, height x width.
trait Step {
    fn take<T: Entry>(panel: &[T], width: usize, x: &mut [f64]);
}

struct Forward;
struct Backward;

impl Step for Forward {
    #[inline(always)]
    fn take<T: Entry>(panel: &[T], width: usize, x: &mut [f64]) {
        eliminate(panel, width, x);
    }
}

impl Step for Backward {
    #[inline(always)]
    fn take<T: Entry>(panel: &[T], width: usize, x: &mut [f64]) {
        substitute(panel, width, x);
    }
}

/// Uses the vector instructions of the processor, with equal bits: single precision must be converted as fast as it is
/// read.
fn by_vectors<T: Entry, S: Step>(panel: &[T], width: usize, x: &mut [f64]) {
    #[cfg(target_arch = "x86_64")]
    if std::arch::is_x86_feature_detected!("avx2") {
        // SAFETY: the processor has AVX2
        return unsafe { by_avx2::<T, S>(panel, width, x) };
    }
    S::take(panel, width, x);
}

#[cfg(target_arch = "x86_64")]
#[target_feature(enable = "avx2")]
unsafe fn by_avx2<T: Entry, S: Step>(panel: &[T], width: usize, x: &mut [f64]) {
    S::take(panel, width, x);
}

/// `x_1 <- L11^-1 x_1`, `x_2 <- x_2 - L21 x_1`.
#[inline(always)]
fn eliminate<T: Entry>(panel: &[T], width: usize, x: &mut [f64]) {
    let height = x.len();
    let mut j = 0;
    while j < width {
        let count = COLUMNS.min(width - j);
        let columns = &panel[j * height..(j + count) * height];
        for k in 0..count {
            let column = &columns[k * height..(k + 1) * height];
            let v = x[j + k] * column[j + k].into().recip();
            x[j + k] = v;
            (j + k + 1..j + count).for_each(|i| x[i] -= column[i].into() * v);
        }
        let (own, below) = x.split_at_mut(j + count);
        let own = &own[j..];
        let column = |k: usize| &columns[k * height + j + count..(k + 1) * height];
        if let [a, b, c, d] = *own {
            for (at, below) in below.chunks_mut(AHEAD).enumerate() {
                let at = at * AHEAD;
                let column = |k: usize| &column(k)[at..at + below.len()];
                (0..COLUMNS).for_each(|k| ask_for::<T>(column(k).as_ptr().wrapping_add(COLUMNS * height)));
                let rest = column(0).iter().zip(column(1)).zip(column(2)).zip(column(3));
                below.iter_mut().zip(rest).for_each(|(x, (((la, lb), lc), ld))| {
                    let [la, lb, lc, ld] = [*la, *lb, *lc, *ld].map(T::into);
                    *x -= (la * a + lb * b) + (lc * c + ld * d);
                });
            }
        } else {
            for (k, v) in own.iter().enumerate() {
                below.iter_mut().zip(column(k)).for_each(|(x, l)| *x -= (*l).into() * v);
            }
        }
        j += count;
    }
}

/// `x_1 <- L11^-T (x_1 - L21' x_2)`.
#[inline(always)]
fn substitute<T: Entry>(panel: &[T], width: usize, x: &mut [f64]) {
    let height = x.len();
    let mut end = width;
    while end > 0 {
        let count = if end % COLUMNS == 0 { COLUMNS } else { end % COLUMNS };
        let j = end - count;
        let columns = &panel[j * height..end * height];
        let (own, below) = x.split_at_mut(end);
        let own = &mut own[j..];
        let column = |k: usize| &columns[k * height + end..(k + 1) * height];
        if let [a, b, c, d] = own {
            let sums = dots([column(0), column(1), column(2), column(3)], below);
            (*a, *b, *c, *d) = (*a - sums[0], *b - sums[1], *c - sums[2], *d - sums[3]);
        } else {
            own.iter_mut().enumerate().for_each(|(k, x)| *x -= dots([column(k)], below)[0]);
        }
        for k in (0..count).rev() {
            let column = &columns[k * height + j..k * height + end];
            let known: f64 = (k + 1..count).map(|i| column[i].into() * own[i]).sum();
            own[k] = (own[k] - known) * column[k].into().recip();
        }
        end = j;
    }
}

/// Products of some columns with x, in eight partial sums each.
#[inline(always)]
fn dots<T: Entry, const N: usize>(columns: [&[T]; N], x: &[f64]) -> [f64; N] {
    const LANES: usize = 8;
    let mut sums = [[0.0; LANES]; N];
    let whole = x.len() / LANES * LANES;
    for at in (0..whole).step_by(LANES) {
        let x: &[f64; LANES] = x[at..at + LANES].try_into().unwrap_or(&[0.0; LANES]);
        for (sums, column) in sums.iter_mut().zip(&columns) {
            let column = &column[at..at + LANES];
            (0..LANES).for_each(|lane| sums[lane] += column[lane].into() * x[lane]);
        }
    }
    let mut dots = sums.map(|sums| sums.iter().sum::<f64>());
    for (dot, column) in dots.iter_mut().zip(&columns) {
        *dot += column[whole..].iter().zip(&x[whole..]).map(|(l, x)| (*l).into() * x).sum::<f64>();
    }
    dots
}
