//! The numeric factorisation, multifrontal: supernode by supernode up the tree, each adds the updates of its children to
//! its own entries of K, factorises its panel, and leaves an update for its parent on a stack.
//!
//! Subtrees are independent: on a pool of threads they are done side by side, then the supernodes above them one after
//! the other, each by tiles side by side. Every sum has its fixed order: the same bits on any number of threads.

use std::ops::Range;

use faer::dyn_stack::MemBuffer;
use rayon::prelude::*;

use crate::error::Result;
use crate::linalg::front;
use crate::linalg::memory::{refusal, reserved, untouched_zeros};
use crate::linalg::subtrees::{subtrees, SHARED};
use crate::linalg::supernodes::{Node, Supernodes};

const WHAT: &str = "a factorisation";

/// The lower triangle of K in the order of elimination, by columns, rows of a column in any order.
pub struct Columns {
    pub ptr: Vec<usize>,
    pub row: Vec<u32>,
    pub val: Vec<f64>,
}

/// L, or the position of a pivot that is not positive.
pub fn factorize(nodes: &Supernodes, matrix: &Columns) -> Result<std::result::Result<Vec<f64>, usize>> {
    let mut values = untouched_zeros(nodes.values(), "a Cholesky factor")?;
    let subtrees = subtrees(nodes);
    let tasks = split(nodes, &subtrees, &mut values);
    let run = |(range, panels): (Range<usize>, &mut [f64])| {
        Task::new(nodes, matrix, range.clone())?.eliminate_subtree(range, panels)
    };
    let updates: Vec<_> = match tasks.len() {
        1 => tasks.into_iter().map(run).collect(),
        _ => tasks.into_par_iter().map(run).collect(),
    };
    let mut above = 0..0;
    let mut task = Task::new(nodes, matrix, nodes_above(nodes, &subtrees))?;
    for (range, update) in subtrees.iter().zip(updates) {
        if let Some(at) = task.eliminate_shared(above.end..range.start, &mut values)? {
            return Ok(Err(at));
        }
        match update? {
            Ok(update) => task.waiting.push((range.end - 1, Place::Apart(update))),
            Err(at) => return Ok(Err(at)),
        }
        above = range.clone();
    }
    let last = task.eliminate_shared(above.end..nodes.count(), &mut values)?;
    Ok(last.map_or(Ok(values), Err))
}

/// Bytes that the factorisation takes on one thread besides L and the matrix.
pub fn bytes(nodes: &Supernodes) -> usize {
    stack_len(nodes, 0..nodes.count()) * size_of::<f64>() + nodes.order() * size_of::<u32>()
}

/// Supernodes outside all subtrees.
fn nodes_above<'a>(nodes: &Supernodes, subtrees: &'a [Range<usize>]) -> impl Iterator<Item = usize> + 'a {
    let starts = subtrees.iter().map(|range| range.start).chain([nodes.count()]);
    let ends = [0].into_iter().chain(subtrees.iter().map(|range| range.end));
    ends.zip(starts).flat_map(|(end, start)| end..start)
}

/// Every subtree with its own panels.
fn split<'a>(
    nodes: &Supernodes,
    subtrees: &[Range<usize>],
    mut values: &'a mut [f64],
) -> Vec<(Range<usize>, &'a mut [f64])> {
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

/// Most values that wait on the stack at a time, the update being formed among them.
fn stack_len(nodes: &Supernodes, sequence: impl Iterator<Item = usize>) -> usize {
    let (mut most, mut top) = (0, 0);
    let mut waiting: Vec<(usize, usize)> = Vec::new();
    for s in sequence {
        let len = front::update_len(nodes.node(s).rows.len());
        most = most.max(top + len);
        while waiting.last().is_some_and(|child| nodes.parent(child.0) == s) {
            top -= waiting.pop().map_or(0, |child| child.1);
        }
        waiting.push((s, len));
        top += len;
    }
    most
}

/// Where an update waits.
enum Place {
    Stack(Range<usize>),
    Apart(Vec<f64>),
}

/// Supernodes eliminated one after the other.
struct Task<'a> {
    nodes: &'a Supernodes,
    matrix: &'a Columns,
    /// Row of a position within the present front.
    local: Vec<u32>,
    /// Updates that wait, in the order of their supernodes, those on the stack one after the other up to `top`.
    waiting: Vec<(usize, Place)>,
    stack: Vec<f64>,
    top: usize,
    workspace: MemBuffer,
}

impl<'a> Task<'a> {
    fn new(
        nodes: &'a Supernodes,
        matrix: &'a Columns,
        sequence: impl Iterator<Item = usize>,
    ) -> Result<Self> {
        let mut local = reserved(nodes.order(), WHAT)?;
        local.resize(nodes.order(), 0);
        let need = front::scratch();
        let workspace =
            MemBuffer::try_new(need).map_err(|_| refusal(need.unaligned_bytes_required(), WHAT))?;
        let stack = untouched_zeros(stack_len(nodes, sequence), WHAT)?;
        Ok(Self { nodes, matrix, local, waiting: Vec::new(), stack, top: 0, workspace })
    }

    /// All supernodes of a subtree, whose panels these are; the update of its root, or where a pivot is not positive.
    fn eliminate_subtree(
        mut self,
        subtree: Range<usize>,
        panels: &mut [f64],
    ) -> Result<std::result::Result<Vec<f64>, usize>> {
        let first = self.nodes.first_value(subtree.start);
        for s in subtree {
            let panel = self.nodes.node(s).panel;
            if let Some(at) = self.eliminate(s, &mut panels[panel.start - first..panel.end - first], false) {
                return Ok(Err(at));
            }
        }
        self.stack.truncate(self.top);
        self.stack.shrink_to_fit();
        Ok(Ok(self.stack))
    }

    /// Supernodes that are as large as several threads are worth.
    fn eliminate_shared(&mut self, range: Range<usize>, values: &mut [f64]) -> Result<Option<usize>> {
        for s in range {
            let node = self.nodes.node(s);
            let shared = node.work() > SHARED && rayon::current_thread_index().is_some();
            if let Some(at) = self.eliminate(s, &mut values[node.panel], shared) {
                return Ok(Some(at));
            }
        }
        Ok(None)
    }

    /// Factorises the panel of s and puts its update on the stack in place of those of its children. Gives the position
    /// of a pivot that is not positive.
    fn eliminate(&mut self, s: usize, panel: &mut [f64], shared: bool) -> Option<usize> {
        let node = self.nodes.node(s);
        self.scatter(&node, panel);
        let first = self.waiting.iter().rposition(|child| self.nodes.parent(child.0) != s);
        let first = first.map_or(0, |at| at + 1);
        let (below, update) = self.stack.split_at_mut(self.top);
        let update = &mut update[..front::update_len(node.rows.len())];
        update.fill(0.0);
        let mut front = Front { panel, update, width: node.width, height: node.height() };
        let mut base = self.top;
        for (child, place) in &self.waiting[first..] {
            let values = match place {
                Place::Stack(range) => {
                    base = base.min(range.start);
                    &below[range.clone()]
                }
                Place::Apart(values) => values,
            };
            front.add(values, self.nodes.node(*child).rows, &self.local);
        }
        let Front { panel, update, .. } = front;
        if let Err(at) = front::factorize(panel, node.width, update, &mut self.workspace, shared) {
            return Some(node.begin + at);
        }
        let len = update.len();
        self.stack.copy_within(self.top..self.top + len, base);
        self.top = base + len;
        self.waiting.truncate(first);
        self.waiting.push((s, Place::Stack(base..self.top)));
        None
    }

    /// The entries of K in the columns of a supernode.
    fn scatter(&mut self, node: &Node<'_>, panel: &mut [f64]) {
        node.front_rows().enumerate().for_each(|(at, row)| self.local[row] = at as u32);
        let columns = node.begin..node.begin + node.width;
        for (column, panel) in columns.zip(panel.chunks_exact_mut(node.height())) {
            let entries = self.matrix.ptr[column]..self.matrix.ptr[column + 1];
            for (&row, val) in self.matrix.row[entries.clone()].iter().zip(&self.matrix.val[entries]) {
                panel[self.local[row as usize] as usize] += val;
            }
        }
    }
}

/// A panel with its update.
struct Front<'a> {
    panel: &'a mut [f64],
    update: &'a mut [f64],
    width: usize,
    height: usize,
}

impl Front<'_> {
    /// Adds the update of a child with these rows.
    fn add(&mut self, child: &[f64], rows: &[u32], local: &[u32]) {
        let (order, below) = (rows.len(), self.height - self.width);
        let runs = runs(rows, local);
        let mut run = 0;
        for j in 0..order {
            while runs[run].1.end <= j {
                run += 1;
            }
            let from = &child[front::update_column(order, j)];
            let column = local[rows[j] as usize] as usize;
            let (to, offset) = if column < self.width {
                (&mut self.panel[column * self.height..(column + 1) * self.height], 0)
            } else {
                (&mut self.update[front::update_column(below, column - self.width)], column)
            };
            for (start, range) in &runs[run..] {
                let begin = range.start.max(j);
                let first = start + (begin - range.start) - offset;
                let from = &from[begin - j..range.end - j];
                to[first..first + from.len()].iter_mut().zip(from).for_each(|(to, from)| *to += from);
            }
        }
    }
}

/// Rows that stay neighbours in the front: first row there, and their range.
fn runs(rows: &[u32], local: &[u32]) -> Vec<(usize, Range<usize>)> {
    let mut runs: Vec<(usize, Range<usize>)> = Vec::new();
    for (i, &row) in rows.iter().enumerate() {
        let at = local[row as usize] as usize;
        match runs.last_mut() {
            Some((start, range)) if *start + range.len() == at => range.end = i + 1,
            _ => runs.push((at, i..i + 1)),
        }
    }
    runs
}
