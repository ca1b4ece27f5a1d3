//! The numeric factorisation, multifrontal: supernode by supernode up the tree, each adds the updates of its children to
//! its own entries of K, factorises its panel, and leaves an update for its parent on a stack.
//!
//! Subtrees are independent: on a pool of threads they are done side by side, then the supernodes above them one after
//! the other, each by tiles side by side. Every sum has its fixed order: the same bits on any number of threads.

use std::ops::Range;

use faer::dyn_stack::MemBuffer;
use rayon::prelude::*;

use crate::error::Result;
use crate::linalg::front::{self, Tile};
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
    stack_lens(nodes, 0..nodes.count()).iter().sum::<usize>() * size_of::<f64>() + nodes.order() * size_of::<u32>()
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

/// Most values that wait on each of the two stacks at a time.
fn stack_lens(nodes: &Supernodes, sequence: impl Iterator<Item = usize>) -> [usize; 2] {
    let (mut most, mut top) = ([0, 0], [0, 0]);
    let mut waiting: Vec<(usize, usize)> = Vec::new();
    for s in sequence {
        let (own, len) = (nodes.level(s) % 2, front::update_len(nodes.node(s).rows.len()));
        while waiting.last().is_some_and(|child| nodes.parent(child.0) == s) {
            top[1 - own] -= waiting.pop().map_or(0, |child| child.1);
        }
        waiting.push((s, len));
        top[own] += len;
        most[own] = most[own].max(top[own]);
    }
    most
}

/// Where an update waits: on the stack of its level, even or odd, or apart.
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
    /// Updates that wait, in the order of their supernodes.
    waiting: Vec<(usize, Place)>,
    /// A supernode takes its children from one stack and leaves its update on the other.
    stacks: [Stack; 2],
    workspace: MemBuffer,
}

struct Stack {
    values: Vec<f64>,
    top: usize,
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
        let [even, odd] = stack_lens(nodes, sequence);
        let stack = |len| untouched_zeros(len, WHAT).map(|values| Stack { values, top: 0 });
        let stacks = [stack(even)?, stack(odd)?];
        Ok(Self { nodes, matrix, local, waiting: Vec::new(), stacks, workspace })
    }

    /// All supernodes of a subtree, whose panels these are; the update of its root, or where a pivot is not positive.
    fn eliminate_subtree(
        mut self,
        subtree: Range<usize>,
        panels: &mut [f64],
    ) -> Result<std::result::Result<Vec<f64>, usize>> {
        let first = self.nodes.first_value(subtree.start);
        for s in subtree.clone() {
            let panel = self.nodes.node(s).panel;
            if let Some(at) = self.eliminate(s, &mut panels[panel.start - first..panel.end - first], false) {
                return Ok(Err(at));
            }
        }
        let [even, odd] = self.stacks;
        let own = if self.nodes.level(subtree.end - 1) % 2 == 0 { even } else { odd };
        let mut update = own.values;
        update.truncate(own.top);
        update.shrink_to_fit();
        Ok(Ok(update))
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

    /// Factorises the panel of s and puts its update on a stack in place of those of its children. Gives the position
    /// of a pivot that is not positive.
    fn eliminate(&mut self, s: usize, panel: &mut [f64], shared: bool) -> Option<usize> {
        let node = self.nodes.node(s);
        panel.fill(0.0);
        self.scatter(&node, panel);
        let first = self.waiting.iter().rposition(|child| self.nodes.parent(child.0) != s);
        let first = first.map_or(0, |at| at + 1);
        let own = self.nodes.level(s) % 2;
        let [even, odd] = &mut self.stacks;
        let (own, others) = if own == 0 { (even, odd) } else { (odd, even) };
        let mut children = Vec::with_capacity(self.waiting.len() - first);
        for (child, place) in &self.waiting[first..] {
            let values = match place {
                Place::Stack(range) => &others.values[range.clone()],
                Place::Apart(values) => values,
            };
            children.push(Child::new(values, self.nodes.node(*child).rows, node.end(), &self.local));
        }
        children.iter().for_each(|child| child.add_to_panel(panel, node.height()));
        if let Err(at) = front::factorize(panel, node.width, &mut self.workspace, shared) {
            return Some(node.begin + at);
        }
        let place = own.top..own.top + front::update_len(node.rows.len());
        front::update(panel, node.width, &mut own.values[place.clone()], shared, |tile| {
            children.iter().for_each(|child| child.add_to_tile(tile, node.width));
        });
        own.top = place.end;
        for (_, place) in self.waiting.drain(first..) {
            if let Place::Stack(range) = place {
                others.top = others.top.min(range.start);
            }
        }
        self.waiting.push((s, Place::Stack(place)));
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

/// The update of a child as its parent sees it.
struct Child<'a> {
    values: &'a [f64],
    order: usize,
    /// Its first rows, so many, are columns of the parent.
    inside: usize,
    /// Row of the parent's front for each row.
    to: Vec<u32>,
    runs: Vec<Range<usize>>,
}

impl<'a> Child<'a> {
    fn new(values: &'a [f64], rows: &[u32], end: usize, local: &[u32]) -> Self {
        let to: Vec<u32> = rows.iter().map(|&row| local[row as usize]).collect();
        let inside = rows.partition_point(|&row| (row as usize) < end);
        Self { values, order: rows.len(), inside, runs: runs(&to), to }
    }

    fn add_to_panel(&self, panel: &mut [f64], height: usize) {
        for (j, &column) in self.to[..self.inside].iter().enumerate() {
            let column = column as usize * height;
            self.add_column(j, &mut panel[column..column + height], 0);
        }
    }

    /// To a tile of the update of a parent with so many columns.
    fn add_to_tile(&self, tile: &mut Tile<'_>, width: usize) {
        let place = |row: usize| self.to.partition_point(|&to| (to as usize) < row);
        for j in place(width + tile.columns.start)..place(width + tile.columns.end) {
            let column = self.to[j] as usize;
            self.add_column(j, tile.column(column - width), column);
        }
    }

    /// Column j, to a column of the parent that starts at row `first`.
    fn add_column(&self, j: usize, to: &mut [f64], first: usize) {
        let from = &self.values[front::update_column(self.order, j)];
        let run = self.runs.partition_point(|run| run.end <= j);
        for run in &self.runs[run..] {
            let begin = run.start.max(j);
            let at = self.to[begin] as usize - first;
            let from = &from[begin - j..run.end - j];
            to[at..at + from.len()].iter_mut().zip(from).for_each(|(to, from)| *to += from);
        }
    }
}

/// Rows that are neighbours in the front of the parent too.
fn runs(to: &[u32]) -> Vec<Range<usize>> {
    let mut runs: Vec<Range<usize>> = Vec::new();
    for (i, &row) in to.iter().enumerate() {
        match runs.last_mut() {
            Some(run) if to[run.start] as usize + run.len() == row as usize => run.end = i + 1,
            _ => runs.push(i..i + 1),
        }
    }
    runs
}
