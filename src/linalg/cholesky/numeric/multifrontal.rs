//! The numeric factorisation, multifrontal: each supernode, from the leaves of the tree upwards, adds the updates of its
//! children to its own entries of K, factorises its panel, and forms an update for its parent.
//!
//! Subtrees are independent: a pool of threads factorises them in parallel, then the supernodes above them one after the
//! other, each by parallel tiles. Every sum has a fixed order: the result has equal bits for any number of threads.

use std::ops::Range;

use faer::dyn_stack::MemBuffer;
use rayon::prelude::*;

use crate::error::Result;
use crate::linalg::cholesky::analysis::subtrees::{outside, shared, subtrees};
use crate::linalg::cholesky::analysis::supernodes::{Node, Supernodes};
use crate::linalg::cholesky::numeric::front::{self, Tile};
use crate::linalg::cholesky::numeric::updates::{self, RowMap, Updates};
use crate::linalg::cholesky::numeric::Entry;
use crate::platform::memory::{copied, filled, refusal};
use crate::platform::pages::Pages;
use crate::platform::Interrupt;

const WHAT: &str = "a factorisation";

/// The lower triangle of K in the order of elimination, by columns, rows of a column in any order.
pub struct LowerColumns {
    pub ptr: Vec<usize>,
    pub row: Vec<u32>,
    pub val: Vec<f64>,
}

/// A factor, or the position of a pivot that is not positive.
type Pivoted<T> = std::result::Result<T, usize>;

/// L by panels; if `hold` is positive, pivots up to `hold` are held.
pub fn factorize<T: Entry>(
    nodes: &Supernodes,
    matrix: &LowerColumns,
    hold: f64,
) -> Result<Pivoted<Pages<T>>> {
    let mut values = Pages::zeros(nodes.values(), "a Cholesky factor")?;
    let subtrees = subtrees(nodes);
    let tasks = split(nodes, &subtrees, &mut values);
    let (whole, interrupt) = ((nodes, matrix, hold), Interrupt::present());
    let run = |(range, panels): (Range<usize>, &mut [T])| {
        Task::new(whole, range.clone(), &interrupt)?.eliminate_subtree(range, panels)
    };
    let left: Vec<_> = match tasks.len() {
        0 | 1 => tasks.into_iter().map(run).collect(),
        _ => tasks.into_par_iter().map(run).collect(),
    };
    let mut above = 0;
    let mut task = Task::new(whole, outside(nodes, &subtrees), &interrupt)?;
    for (range, update) in subtrees.iter().zip(left) {
        if let Err(at) = task.eliminate_shared(above..range.start, &mut values)? {
            return Ok(Err(at));
        }
        match update? {
            Ok(update) => task.updates.push(range.end - 1, update),
            Err(at) => return Ok(Err(at)),
        }
        above = range.end;
    }
    Ok(task.eliminate_shared(above..nodes.count(), &mut values)?.map(|()| values))
}

/// Updates of supernodes that are not renewed for supernodes that are, in the order of the latter.
pub struct Kept(Vec<(usize, Vec<f64>)>);

/// As `factorize`, on one thread; keeps the updates of supernodes outside `renewed` for those in `renewed`, which
/// includes all ancestors of its supernodes.
pub fn factorize_keeping(
    nodes: &Supernodes,
    matrix: &LowerColumns,
    hold: f64,
    renewed: &[usize],
) -> Result<Pivoted<(Pages, Kept)>> {
    let mut values = Pages::zeros(nodes.values(), "a Cholesky factor")?;
    let interrupt = Interrupt::present();
    let mut task = Task::new((nodes, matrix, hold), 0..nodes.count(), &interrupt)?;
    let is_renewed = |s: usize| renewed.binary_search(&s).is_ok();
    let mut kept = Vec::new();
    for s in 0..nodes.count() {
        if let Err(at) = task.eliminate_shared(s..s + 1, &mut values)? {
            return Ok(Err(at));
        }
        if !is_renewed(s) && is_renewed(nodes.parent(s)) {
            kept.push((s, copied(task.updates.last(), WHAT)?));
        }
    }
    kept.sort_by_key(|(child, _)| nodes.parent(*child));
    Ok(Ok((values, Kept(kept))))
}

/// Factorises the panels of some supernodes, including all their ancestors, again.
pub fn renew(
    nodes: &Supernodes,
    matrix: &LowerColumns,
    hold: f64,
    renewed: &[usize],
    Kept(kept): &Kept,
    values: &mut [f64],
) -> Result<Pivoted<()>> {
    let interrupt = Interrupt::present();
    let mut task = Task::new((nodes, matrix, hold), renewed.iter().copied(), &interrupt)?;
    for &s in renewed {
        let first = kept.partition_point(|(child, _)| nodes.parent(*child) < s);
        let own = kept[first..].iter().take_while(|(child, _)| nodes.parent(*child) == s);
        own.for_each(|(child, update)| task.updates.lend(*child, update));
        if let Err(at) = task.eliminate_shared(s..s + 1, values)? {
            return Ok(Err(at));
        }
    }
    Ok(Ok(()))
}

/// Bytes for the factorisation on one thread in addition to L and the matrix.
pub fn bytes<T>(nodes: &Supernodes) -> usize {
    let waiting: usize = updates::most(nodes, 0..nodes.count(), |s| update_len(nodes, s)).iter().sum();
    waiting * size_of::<T>() + nodes.order() * size_of::<u32>()
}

fn update_len(nodes: &Supernodes, s: usize) -> usize {
    front::update_len(nodes.node(s).rows.len())
}

/// Splits the values into the panels of every subtree.
fn split<'a, T>(
    nodes: &Supernodes,
    subtrees: &[Range<usize>],
    mut values: &'a mut [T],
) -> Vec<(Range<usize>, &'a mut [T])> {
    let mut at = 0;
    let mut tasks = Vec::with_capacity(subtrees.len());
    for range in subtrees {
        let (begin, end) = (nodes.first_value(range.start), nodes.first_value(range.end));
        let (_, rest) = values.split_at_mut(begin - at);
        let (own, rest) = rest.split_at_mut(end - begin);
        tasks.push((range.clone(), own));
        (values, at) = (rest, end);
    }
    tasks
}

/// Eliminates supernodes one after the other.
struct Task<'a, T: Entry> {
    nodes: &'a Supernodes,
    matrix: &'a LowerColumns,
    hold: f64,
    /// Row in the present front by position.
    local: Vec<u32>,
    updates: Updates<'a, T>,
    workspace: MemBuffer,
    interrupt: &'a Interrupt,
}

impl<'a, T: Entry> Task<'a, T> {
    fn new(
        (nodes, matrix, hold): (&'a Supernodes, &'a LowerColumns, f64),
        sequence: impl Iterator<Item = usize>,
        interrupt: &'a Interrupt,
    ) -> Result<Self> {
        let local = filled(nodes.order(), 0, WHAT)?;
        let need = front::scratch::<T>();
        let workspace =
            MemBuffer::try_new(need).map_err(|_| refusal(need.unaligned_bytes_required(), WHAT))?;
        let updates = Updates::new(nodes, sequence, |s| update_len(nodes, s), WHAT)?;
        Ok(Self { nodes, matrix, hold, local, updates, workspace, interrupt })
    }

    /// Eliminates all supernodes of a subtree, with their panels; returns the update of its root.
    fn eliminate_subtree(mut self, subtree: Range<usize>, panels: &mut [T]) -> Result<Pivoted<Pages<T>>> {
        let first = self.nodes.first_value(subtree.start);
        for s in subtree.clone() {
            self.interrupt.check()?;
            let panel = self.nodes.node(s).panel;
            let panel = &mut panels[panel.start - first..panel.end - first];
            if let Err(at) = self.eliminate(s, panel, false) {
                return Ok(Err(at));
            }
        }
        Ok(Ok(self.updates.into_last(subtree.end - 1)))
    }

    /// Eliminates the supernodes above all subtrees.
    fn eliminate_shared(&mut self, range: Range<usize>, values: &mut [T]) -> Result<Pivoted<()>> {
        for s in range {
            self.interrupt.check()?;
            let node = self.nodes.node(s);
            if let Err(at) = self.eliminate(s, &mut values[node.panel.clone()], shared(node.work())) {
                return Ok(Err(at));
            }
        }
        Ok(Ok(()))
    }

    /// Factorises the panel of s and forms its update.
    fn eliminate(&mut self, s: usize, panel: &mut [T], shared: bool) -> Pivoted<()> {
        let node = self.nodes.node(s);
        panel.fill(T::of(0.0));
        self.scatter(&node, panel);
        let len = front::update_len(node.rows.len());
        let (update, children) = self.updates.open(s, len);
        let child = |(s, values)| {
            let rows = RowMap::new(self.nodes.node(s).rows, node.end(), &self.local);
            Child { values, rows }
        };
        let children: Vec<Child<'_, T>> = children.into_iter().map(child).collect();
        children.iter().for_each(|child| child.add_to_panel(panel, node.height()));
        front::factorize(panel, node.width, self.hold, &mut self.workspace, shared)
            .map_err(|at| node.begin + at)?;
        front::update(panel, node.width, update, shared, |tile| {
            children.iter().for_each(|child| child.add_to_tile(tile, node.width));
        });
        drop(children);
        self.updates.close(s, len);
        Ok(())
    }

    /// Copies the entries of K in the columns of a supernode to its panel.
    fn scatter(&mut self, node: &Node<'_>, panel: &mut [T]) {
        node.front_rows().enumerate().for_each(|(at, row)| self.local[row] = at as u32);
        let columns = node.begin..node.end();
        for (column, panel) in columns.zip(panel.chunks_exact_mut(node.height())) {
            let entries = self.matrix.ptr[column]..self.matrix.ptr[column + 1];
            for (&row, val) in self.matrix.row[entries.clone()].iter().zip(&self.matrix.val[entries]) {
                panel[self.local[row as usize] as usize] += T::of(*val);
            }
        }
    }
}

/// The update of a child, in terms of its parent.
struct Child<'a, T> {
    values: &'a [T],
    rows: RowMap,
}

impl<T: Entry> Child<'_, T> {
    fn add_to_panel(&self, panel: &mut [T], height: usize) {
        for (j, &column) in self.rows.to[..self.rows.inside].iter().enumerate() {
            let column = column as usize * height;
            self.add_column(j, &mut panel[column..column + height], 0);
        }
    }

    /// Adds it to a tile of the update of a parent with this number of columns.
    fn add_to_tile(&self, tile: &mut Tile<'_, T>, width: usize) {
        let place = |row: usize| self.rows.to.partition_point(|&to| (to as usize) < row);
        for j in place(width + tile.columns.start)..place(width + tile.columns.end) {
            let column = self.rows.to[j] as usize;
            self.add_column(j, tile.column(column - width), column);
        }
    }

    /// Adds column j to a column that starts at row `first` of the parent's front.
    fn add_column(&self, j: usize, to: &mut [T], first: usize) {
        let order = self.rows.to.len();
        self.rows.add(j..order, &self.values[front::update_column(order, j)], to, first);
    }
}

#[cfg(test)]
mod tests {
    use std::sync::Arc;

    use crate::linalg::{Analysis, Cholesky, Symmetric};

    /// Two dense parts of 330 dofs, both coupled to 400 others: fronts of several tiles, and sums of updates.
    fn two_parts() -> Symmetric {
        let (mut ptr, mut col, mut val) = (vec![0], Vec::new(), Vec::new());
        for i in 0..1060_usize {
            let apart = |j: usize| i < 660 && (i < 330) != (j < 330);
            for j in (0..i).filter(|&j| !apart(j)) {
                col.push(j as u32);
                val.push(((7 * i + 3 * j) % 11) as f64 / 11.0 - 0.5);
            }
            col.push(i as u32);
            val.push(400.0 + (i % 5) as f64);
            ptr.push(col.len());
        }
        Symmetric::new(ptr, col, val)
    }

    fn factor(matrix: &Symmetric) -> Cholesky {
        let held = vec![false; matrix.order()];
        Arc::new(Analysis::new(matrix, &held).unwrap()).factorize(matrix, 1.0).unwrap().unwrap()
    }

    #[test]
    fn fronts_of_several_tiles_are_factorised() {
        let matrix = two_parts();
        let n = matrix.order();
        let b: Vec<f64> = (0..n).map(|i| (i as f64).cos()).collect();
        let (mut x, mut image) = (b.clone(), vec![0.0; n]);
        factor(&matrix).solve(&mut x).unwrap();
        matrix.mul(&x, &mut image);
        assert!(image.iter().zip(&b).all(|(image, b)| (image - b).abs() < 1e-12));
    }

    #[test]
    fn a_pool_of_threads_gives_the_same_bits() {
        let matrix = two_parts();
        let alone = factor(&matrix).values;
        for threads in [2, 3] {
            let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
            assert!(pool.install(|| factor(&matrix)).values[..] == alone[..], "{threads} threads");
        }
    }
}
