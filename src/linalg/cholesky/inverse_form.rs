//! `B K_ff^-1 B'` by supernode reach: each supernode of L processes only the rows of B whose elimination path
//! meets it. With `Y = L^-1 P B'` the result is `Y'Y`: exactly symmetric and positive semidefinite.
//!
//! As in the factorisation, a supernode receives from its children their contributions to the rows below them, in the
//! columns of Y that the children have; tiles of columns are independent of each other. Subtrees add up their products
//! separately: equal sums, and equal bits, for any number of threads.

use std::ops::Range;

use faer::linalg::matmul::matmul;
use faer::linalg::triangular_solve::solve_lower_triangular_in_place;
use faer::{Accum, MatMut, MatRef, Par};
use rayon::prelude::*;

use crate::error::Result;
use crate::linalg::cholesky::analysis::elimination::NONE;
use crate::linalg::cholesky::analysis::subtrees::{each, outside, parts, shared};
use crate::linalg::cholesky::analysis::supernodes::{Node, Supernodes};
use crate::linalg::cholesky::numeric::updates::{RowMap, Updates};
use crate::linalg::cholesky::numeric::Entry;
use crate::linalg::{Cholesky, Csr, Packed};
use crate::platform::memory::{filled, headroom, PRODUCTS};
use crate::platform::pages::Pages;
use crate::platform::Interrupt;

const WHAT: &str = "the dual operator of a body";

/// Columns of Y per tile, also for their products with each other: only half of the product of a tile with itself is
/// needed.
const TILE: usize = 384;
const SQUARE: usize = 160;
/// Rows of Y per block of a solve.
const BLOCK: usize = 192;

/// The m x m matrix for `rows` (m x n, over all dofs of the body).
pub fn inverse_form<T: Entry>(cholesky: &Cholesky<T>, rows: &Csr) -> Result<Packed> {
    let nodes = &cholesky.analysis.nodes;
    // lists by supernode, by dof and by entry of B, which grow in small allocations
    let small_pieces = 96 * nodes.count() + 8 * nodes.order() + 96 * rows.col.len();
    let _room = headroom(small_pieces + PRODUCTS, WHAT)?;
    let reach = Reach::of(cholesky, rows)?;
    let mut form = Packed::zeros(rows.rows())?;
    let parts = parts(nodes);
    let run = |range: &Range<usize>| reach.part(range.clone());
    let done: Vec<Result<FormShare<T>>> = match rayon::current_thread_index() {
        Some(_) if parts.len() > 1 => parts.par_iter().map(run).collect(),
        _ => parts.iter().map(run).collect(),
    };
    let mut above = 0;
    let mut task = FormTask::new(&reach, outside(nodes, &parts))?;
    for (range, part) in parts.iter().zip(done) {
        (above..range.start).try_for_each(|s| task.eliminate(s, &mut form, |row| row as usize))?;
        let (part, root) = (part?, range.end - 1);
        let rows = &reach.columns[root];
        for (i, &row) in rows.iter().enumerate() {
            (0..=i).for_each(|j| form.add(row as usize, rows[j] as usize, part.form.get(i, j)));
        }
        if !rows.is_empty() {
            task.updates.push(root, part.update);
        }
        above = range.end;
    }
    (above..nodes.count()).try_for_each(|s| task.eliminate(s, &mut form, |row| row as usize))?;
    Ok(form)
}

/// The rows of B that reach each supernode.
struct Reach<'a, T: Entry> {
    cholesky: &'a Cholesky<T>,
    nodes: &'a Supernodes,
    /// Entries of P B' by supernode: row of B, position, value.
    own: Vec<Vec<(u32, u32, f64)>>,
    /// Rows of B that reach each supernode, ascending: its columns of Y.
    columns: Vec<Vec<u32>>,
    /// The interrupt of the task that computes the form.
    interrupt: Interrupt,
}

/// The contribution of a subtree to the form, and its update for the rows above.
struct FormShare<T: Entry> {
    form: Packed,
    update: Pages<T>,
}

impl<'a, T: Entry> Reach<'a, T> {
    fn of(cholesky: &'a Cholesky<T>, rows: &Csr) -> Result<Self> {
        let nodes = &cholesky.analysis.nodes;
        let mut own: Vec<Vec<(u32, u32, f64)>> = filled(nodes.count(), Vec::new(), WHAT)?;
        for i in 0..rows.rows() {
            for (at, value) in cholesky.eliminated(rows, i) {
                own[nodes.of_column(at)].push((i as u32, at as u32, value));
            }
        }
        let mut columns: Vec<Vec<u32>> = filled(nodes.count(), Vec::new(), WHAT)?;
        for s in 0..nodes.count() {
            columns[s].extend(own[s].iter().map(|entry| entry.0));
            columns[s].sort_unstable();
            columns[s].dedup();
            let (seen, later) = columns.split_at_mut(s + 1);
            if nodes.parent(s) != NONE {
                later[nodes.parent(s) - s - 1].extend_from_slice(&seen[s]);
            }
        }
        Ok(Self { cholesky, nodes, own, columns, interrupt: Interrupt::present() })
    }

    /// Number of values in the update of s for the rows below its columns.
    fn update_len(&self, s: usize) -> usize {
        self.nodes.node(s).rows.len() * self.columns[s].len()
    }

    fn part(&self, range: Range<usize>) -> Result<FormShare<T>> {
        let root = range.end - 1;
        let rows = &self.columns[root];
        let mut form = Packed::zeros(rows.len())?;
        let mut task = FormTask::new(self, range.clone())?;
        let place = |row: u32| rows.partition_point(|&other| other < row);
        { range }.try_for_each(|s| task.eliminate(s, &mut form, place))?;
        let update = if rows.is_empty() { Pages::zeros(0, WHAT)? } else { task.updates.into_last(root) };
        Ok(FormShare { form, update })
    }
}

/// Processes supernodes one after the other.
struct FormTask<'a, T: Entry> {
    reach: &'a Reach<'a, T>,
    /// Row in the present front by position.
    local: Vec<u32>,
    updates: Updates<'a, T>,
    /// Rows of Y of the present supernode: width x columns.
    y: Pages<T>,
    /// Products of the columns of two tiles.
    product: Pages<T>,
}

impl<'a, T: Entry> FormTask<'a, T> {
    fn new(reach: &'a Reach<'a, T>, sequence: impl Iterator<Item = usize> + Clone) -> Result<Self> {
        let nodes = reach.nodes;
        let local = filled(nodes.order(), 0, WHAT)?;
        let seen = sequence.filter(|&s| !reach.columns[s].is_empty());
        let updates = Updates::new(nodes, seen.clone(), |s| reach.update_len(s), WHAT)?;
        let y = seen.clone().map(|s| nodes.node(s).width * reach.columns[s].len()).max().unwrap_or(0);
        let side = seen.map(|s| reach.columns[s].len().min(SQUARE)).max().unwrap_or(0);
        let (y, product) = (Pages::zeros(y, WHAT)?, Pages::zeros(side * side, WHAT)?);
        Ok(Self { reach, local, updates, y, product })
    }

    /// `Y_s <- L_ss^-1 (Y_s)` with the updates of the children, its products, and the update for the rows below; `place`:
    /// position of a row of B in the form.
    fn eliminate(&mut self, s: usize, form: &mut Packed, place: impl Fn(u32) -> usize) -> Result<()> {
        let columns = &self.reach.columns[s];
        if columns.is_empty() {
            return Ok(());
        }
        self.reach.interrupt.check()?;
        let node = self.reach.nodes.node(s);
        node.front_rows().enumerate().for_each(|(at, row)| self.local[row] = at as u32);
        let y = &mut self.y[..node.width * columns.len()];
        y.fill(T::of(0.0));
        for &(row, position, value) in &self.reach.own[s] {
            let column = columns.partition_point(|&other| other < row);
            y[column * node.width + position as usize - node.begin] += T::of(value);
        }
        let len = self.reach.update_len(s);
        let (update, children) = self.updates.open(s, len);
        let child = |(child, values)| {
            let rows = RowMap::new(self.reach.nodes.node(child).rows, node.end(), &self.local);
            let of = self.reach.columns[child].iter();
            FormBelow {
                values,
                rows,
                columns: of.map(|row| columns.partition_point(|other| other < row)).collect(),
            }
        };
        let children: Vec<FormBelow<'_, T>> = children.into_iter().map(child).collect();
        let panel = &self.reach.cholesky.values[node.panel.clone()];
        let work = node.work() / node.width as f64 * columns.len() as f64;
        each(shared(work), tiles(&node, y, update), |mut tile| {
            children.iter().for_each(|child| child.add_above(&mut tile));
            tile.solve(panel, &node);
            children.iter().for_each(|child| child.add_below(&mut tile));
        });
        drop(children);
        self.updates.close(s, len);
        let y = MatRef::from_column_major_slice(y, node.width, columns.len());
        let places: Vec<usize> = columns.iter().map(|&row| place(row)).collect();
        add_products(y, &places, &mut self.product, form);
        Ok(())
    }
}

/// Some columns of Y at a supernode.
struct FormTile<'a, T> {
    /// Range among the columns of the supernode.
    columns: Range<usize>,
    /// width x columns
    above: &'a mut [T],
    /// rows below x columns
    below: &'a mut [T],
}

fn tiles<'a, T>(node: &Node<'_>, mut y: &'a mut [T], mut update: &'a mut [T]) -> Vec<FormTile<'a, T>> {
    let count = y.len() / node.width;
    let mut tiles = Vec::with_capacity(count.div_ceil(TILE));
    for first in (0..count).step_by(TILE) {
        let columns = first..count.min(first + TILE);
        let (above, rest) = y.split_at_mut(node.width * columns.len());
        let (below, other) = update.split_at_mut(node.rows.len() * columns.len());
        tiles.push(FormTile { columns, above, below });
        (y, update) = (rest, other);
    }
    tiles
}

impl<T: Entry> FormTile<'_, T> {
    /// `Y_1 <- L11^-1 Y_1`, `Y_2 <- -L21 Y_1`
    fn solve(&mut self, panel: &[T], node: &Node<'_>) {
        let panel = MatRef::from_column_major_slice(panel, node.height(), node.width);
        let (count, minus) = (self.columns.len(), T::of(-1.0));
        let mut above = MatMut::from_column_major_slice_mut(self.above, node.width, count);
        for first in (0..node.width).step_by(BLOCK) {
            let end = node.width.min(first + BLOCK);
            let columns = panel.subcols(first, end - first);
            let (mut own, later) =
                above.as_mut().subrows_mut(first, node.width - first).split_at_row_mut(end - first);
            let triangle = columns.subrows(first, end - first);
            solve_lower_triangular_in_place(triangle, own.as_mut(), Par::Seq);
            let below = columns.subrows(end, node.width - end);
            matmul(later, Accum::Add, below, own.as_ref(), minus, Par::Seq);
        }
        let below = MatMut::from_column_major_slice_mut(self.below, node.rows.len(), count);
        let l21 = panel.subrows(node.width, node.rows.len());
        matmul(below, Accum::Replace, l21, above.as_ref(), minus, Par::Seq);
    }
}

/// The update of a child, in terms of its parent.
struct FormBelow<'a, T> {
    values: &'a [T],
    rows: RowMap,
    /// Position of its columns among those of the parent, ascending.
    columns: Vec<usize>,
}

impl<T: Entry> FormBelow<'_, T> {
    /// Adds to the rows of the parent's columns.
    fn add_above(&self, tile: &mut FormTile<'_, T>) {
        let rows = 0..self.rows.inside;
        let width = tile.above.len() / tile.columns.len();
        for (from, column) in self.columns_of(&tile.columns) {
            let to = &mut tile.above[column * width..(column + 1) * width];
            self.rows.add(rows.clone(), &from[rows.clone()], to, 0);
        }
    }

    /// Adds to the rows below them.
    fn add_below(&self, tile: &mut FormTile<'_, T>) {
        let rows = self.rows.inside..self.rows.to.len();
        let (width, below) = (tile.above.len(), tile.below.len());
        let (width, below) = (width / tile.columns.len(), below / tile.columns.len());
        for (from, column) in self.columns_of(&tile.columns) {
            let to = &mut tile.below[column * below..(column + 1) * below];
            self.rows.add(rows.clone(), &from[rows.clone()], to, width);
        }
    }

    /// Columns of the child and their positions in a tile of the parent.
    fn columns_of(&self, tile: &Range<usize>) -> impl Iterator<Item = (&[T], usize)> {
        let rows = self.rows.to.len();
        let place = |column: usize| self.columns.partition_point(|&other| other < column);
        let first = tile.start;
        (place(tile.start)..place(tile.end))
            .map(move |k| (&self.values[k * rows..(k + 1) * rows], self.columns[k] - first))
    }
}

/// `form += Y'Y`, entry (i, j) at (`places[i]`, `places[j]`); `product`: workspace for a tile.
fn add_products<T: Entry>(y: MatRef<'_, T>, places: &[usize], product: &mut [T], form: &mut Packed) {
    let tile = |first: usize| first..places.len().min(first + SQUARE);
    for right in (0..places.len()).step_by(SQUARE).map(tile) {
        for left in (right.start..places.len()).step_by(SQUARE).map(tile) {
            let product = &mut product[..left.len() * right.len()];
            let to = MatMut::from_column_major_slice_mut(product, left.len(), right.len());
            let columns = |range: &Range<usize>| y.subcols(range.start, range.len());
            matmul(to, Accum::Replace, columns(&left).transpose(), columns(&right), T::of(1.0), Par::Seq);
            if left == right {
                form.add_lower(&places[left], product);
                continue;
            }
            for (column, &j) in product.chunks_exact(left.len()).zip(&places[right.clone()]) {
                places[left.clone()]
                    .iter()
                    .zip(column)
                    .for_each(|(&i, value)| form.add(i, j, (*value).into()));
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::linalg::{Analysis, Symmetric};
    use std::sync::Arc;

    #[test]
    fn the_form_equals_one_solution_per_row() {
        let (n, mut ptr, mut col, mut val) = (60usize, vec![0], Vec::new(), Vec::new());
        for i in 0..n {
            for j in [i.wrapping_sub(13), i.wrapping_sub(2), i.wrapping_sub(1)] {
                if j < i {
                    col.push(j as u32);
                    val.push(-0.2 - 0.01 * (i % 5) as f64);
                }
            }
            col.push(i as u32);
            val.push(2.0 + 0.1 * (i % 3) as f64);
            ptr.push(col.len());
        }
        let matrix = Symmetric::new(ptr, col, val);
        let mut held = vec![false; n];
        held[5] = true;
        let factor =
            Arc::new(Analysis::new(&matrix, &held).unwrap()).factorize(&matrix, 1.0).unwrap().unwrap();
        let mut rows = Csr::empty(n);
        for i in 0..9 {
            rows.push_row([(i, 1.0), (5 * i + 10, -0.5), (59, 0.1 * i as f64)]);
        }
        let form = inverse_form(&factor, &rows).unwrap();
        let ended = Interrupt::new(Arc::new(true.into())).during(|| inverse_form(&factor, &rows));
        assert_eq!(ended.unwrap_err().kind, crate::error::Kind::Cancelled);
        for j in 0..9 {
            let mut x = vec![0.0; n];
            rows.row(j).for_each(|(dof, v)| x[dof] += v);
            factor.solve(&mut x).unwrap();
            for i in 0..9 {
                assert!((rows.row_dot(i, &x) - form.get(i, j)).abs() < 1e-14, "({i}, {j})");
            }
        }
    }
}
