//! Solutions with L and L' for one right-hand side: L is read once each, at the speed of the memory.

use std::ops::Range;

use crate::error::Result;
use crate::linalg::Cholesky;
use crate::platform::memory::zeros;

/// Columns taken at a time: the vector is read once for all of them.
const COLUMNS: usize = 4;

impl Cholesky {
    /// Values that a solution works in.
    pub(super) fn workspace(&self) -> Result<Vec<f64>> {
        let highest = self.analysis.nodes.nodes().map(|node| node.height()).max().unwrap_or(0);
        zeros(highest, "a solution")
    }

    /// `y <- L^-1 y`, in the order of elimination, for the columns of some supernodes that no others come before.
    pub(super) fn forward(&self, nodes: Range<usize>, y: &mut [f64], workspace: &mut [f64]) {
        for node in nodes.map(|s| self.analysis.nodes.node(s)) {
            let front = &mut workspace[..node.height()];
            front[..node.width].copy_from_slice(&y[node.begin..node.end()]);
            front[node.width..].fill(0.0);
            eliminate(&self.values[node.panel.clone()], node.width, front);
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
            substitute(&self.values[node.panel.clone()], node.width, front);
            y[node.begin..node.end()].copy_from_slice(&front[..node.width]);
        }
    }
}

/// `x_1 <- L11^-1 x_1`, `x_2 <- x_2 - L21 x_1`; the panel is height x width.
fn eliminate(panel: &[f64], width: usize, x: &mut [f64]) {
    let height = x.len();
    let mut j = 0;
    while j < width {
        let count = COLUMNS.min(width - j);
        let columns = &panel[j * height..(j + count) * height];
        for k in 0..count {
            let column = &columns[k * height..(k + 1) * height];
            let v = x[j + k] * column[j + k].recip();
            x[j + k] = v;
            (j + k + 1..j + count).for_each(|i| x[i] -= column[i] * v);
        }
        let (own, below) = x.split_at_mut(j + count);
        let own = &own[j..];
        let column = |k: usize| &columns[k * height + j + count..(k + 1) * height];
        if let [a, b, c, d] = *own {
            let rest = column(0).iter().zip(column(1)).zip(column(2)).zip(column(3));
            below.iter_mut().zip(rest).for_each(|(x, (((la, lb), lc), ld))| {
                *x -= (la * a + lb * b) + (lc * c + ld * d);
            });
        } else {
            for (k, v) in own.iter().enumerate() {
                below.iter_mut().zip(column(k)).for_each(|(x, l)| *x -= l * v);
            }
        }
        j += count;
    }
}

/// `x_1 <- L11^-T (x_1 - L21' x_2)`; the panel is height x width.
fn substitute(panel: &[f64], width: usize, x: &mut [f64]) {
    let height = x.len();
    let mut end = width;
    while end > 0 {
        let count = if end.is_multiple_of(COLUMNS) { COLUMNS } else { end % COLUMNS };
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
            let known: f64 = (k + 1..count).map(|i| column[i] * own[i]).sum();
            own[k] = (own[k] - known) * column[k].recip();
        }
        end = j;
    }
}

/// Products of some columns with x, in eight partial sums each.
fn dots<const N: usize>(columns: [&[f64]; N], x: &[f64]) -> [f64; N] {
    const LANES: usize = 8;
    let mut sums = [[0.0; LANES]; N];
    let whole = x.len() / LANES * LANES;
    for at in (0..whole).step_by(LANES) {
        let x: &[f64; LANES] = x[at..at + LANES].try_into().unwrap_or(&[0.0; LANES]);
        for (sums, column) in sums.iter_mut().zip(&columns) {
            let column = &column[at..at + LANES];
            (0..LANES).for_each(|lane| sums[lane] += column[lane] * x[lane]);
        }
    }
    let mut dots = sums.map(|sums| sums.iter().sum::<f64>());
    for (dot, column) in dots.iter_mut().zip(&columns) {
        *dot += column[whole..].iter().zip(&x[whole..]).map(|(l, x)| l * x).sum::<f64>();
    }
    dots
}
