//! The updates that supernodes leave for their parents, stored until they are used.

use std::ops::Range;
use std::vec::IntoIter;

use crate::error::Result;
use crate::linalg::cholesky::analysis::supernodes::Supernodes;
use crate::linalg::cholesky::numeric::Entry;
use crate::platform::memory::reserved;
use crate::platform::pages::Pages;

/// Updates that are not used yet, in the order of their supernodes. A supernode finds the updates of its children on one
/// stack and puts its own on the other: the stack depends on whether its level is even or odd, so that nothing is moved.
pub struct Updates<'a, T: Entry> {
    nodes: &'a Supernodes,
    waiting: Vec<(usize, KeptUpdate<'a, T>)>,
    stacks: [Pages<T>; 2],
    tops: [usize; 2],
    /// Number of values that each stack still needs, for every further supernode.
    needs: IntoIter<[usize; 2]>,
}

enum KeptUpdate<'a, T: Entry> {
    Stack(Range<usize>),
    /// Formed by another task.
    Apart(Pages<T>),
    /// Kept from another factorisation.
    Lent(&'a [T]),
}

impl<'a, T: Entry> Updates<'a, T> {
    /// For supernodes in this sequence; supernode s has an update of `len(s)` values. `what`: its purpose, for errors.
    pub fn new(
        nodes: &'a Supernodes,
        sequence: impl Iterator<Item = usize>,
        len: impl Fn(usize) -> usize,
        what: &str,
    ) -> Result<Self> {
        let mut needs = reserved(nodes.count(), what)?;
        for_each_step(nodes, sequence, len, |tops| needs.push(tops));
        let mut later = [0, 0];
        needs.iter_mut().rev().for_each(|tops| {
            later = larger(later, *tops);
            *tops = later;
        });
        let stacks = [Pages::zeros(later[0], what)?, Pages::zeros(later[1], what)?];
        Ok(Self { nodes, waiting: Vec::new(), stacks, tops: [0, 0], needs: needs.into_iter() })
    }

    /// Adds an update of another task for the parent of s.
    pub fn push(&mut self, s: usize, update: Pages<T>) {
        self.waiting.push((s, KeptUpdate::Apart(update)));
    }

    /// Adds an update, kept from another factorisation, of a child of the next supernode, in the order of the children,
    /// so that sums do not depend on which updates are lent.
    pub fn lend(&mut self, child: usize, update: &'a [T]) {
        let before = self.waiting.iter().rposition(|(other, _)| *other < child);
        self.waiting.insert(before.map_or(0, |at| at + 1), (child, KeptUpdate::Lent(update)));
    }

    /// The last update on the stacks.
    pub fn last(&self) -> &[T] {
        match self.waiting.last() {
            Some((s, KeptUpdate::Stack(range))) => &self.stacks[self.nodes.level(*s) % 2][range.clone()],
            Some((_, KeptUpdate::Apart(values))) => values,
            Some((_, KeptUpdate::Lent(values))) => values,
            None => &[],
        }
    }

    /// Room for the update of s, the next of the sequence, and the children of s with their updates.
    pub fn open(&mut self, s: usize, len: usize) -> (&mut [T], Vec<(usize, &[T])>) {
        for (stack, need) in self.stacks.iter_mut().zip(self.needs.next().into_iter().flatten()) {
            stack.truncate(need);
        }
        let first = self.first_child(s);
        let level = self.nodes.level(s) % 2;
        let [even, odd] = &mut self.stacks;
        let (own, others) = if level == 0 { (even, odd) } else { (odd, even) };
        let children = self.waiting[first..].iter().map(|(child, place)| match place {
            KeptUpdate::Stack(range) => (*child, &others[range.clone()]),
            KeptUpdate::Apart(values) => (*child, &values[..]),
            KeptUpdate::Lent(values) => (*child, *values),
        });
        (&mut own[self.tops[level]..self.tops[level] + len], children.collect())
    }

    /// Stores the update of s, of `len` values, and removes those of its children.
    pub fn close(&mut self, s: usize, len: usize) {
        let first = self.first_child(s);
        let level = self.nodes.level(s) % 2;
        for (_, place) in self.waiting.drain(first..) {
            if let KeptUpdate::Stack(range) = place {
                self.tops[1 - level] = self.tops[1 - level].min(range.start);
            }
        }
        let place = self.tops[level]..self.tops[level] + len;
        self.tops[level] = place.end;
        self.waiting.push((s, KeptUpdate::Stack(place)));
    }

    /// The update of the root of a subtree, which is the last one.
    pub fn into_last(self, root: usize) -> Pages<T> {
        let [even, odd] = self.stacks;
        let level = self.nodes.level(root) % 2;
        let mut update = if level == 0 { even } else { odd };
        update.truncate(self.tops[level]);
        update
    }

    fn first_child(&self, s: usize) -> usize {
        let stranger = self.waiting.iter().rposition(|(child, _)| self.nodes.parent(*child) != s);
        stranger.map_or(0, |at| at + 1)
    }
}

/// Largest number of values on each of the two stacks.
pub fn most(
    nodes: &Supernodes,
    sequence: impl Iterator<Item = usize>,
    len: impl Fn(usize) -> usize,
) -> [usize; 2] {
    let mut most = [0, 0];
    for_each_step(nodes, sequence, len, |tops| most = larger(most, tops));
    most
}

fn larger(a: [usize; 2], b: [usize; 2]) -> [usize; 2] {
    [a[0].max(b[0]), a[1].max(b[1])]
}

/// Calls `tell` with the sizes of both stacks during every supernode, when its update and those of its children are
/// stored.
fn for_each_step(
    nodes: &Supernodes,
    sequence: impl Iterator<Item = usize>,
    len: impl Fn(usize) -> usize,
    mut tell: impl FnMut([usize; 2]),
) {
    let mut tops = [0, 0];
    let mut waiting: Vec<(usize, usize)> = Vec::new();
    for s in sequence {
        let (level, len) = (nodes.level(s) % 2, len(s));
        tops[level] += len;
        tell(tops);
        while waiting.last().is_some_and(|child| nodes.parent(child.0) == s) {
            tops[1 - level] -= waiting.pop().map_or(0, |child| child.1);
        }
        waiting.push((s, len));
    }
}

/// Positions of the rows of a child in the front of its parent.
pub struct RowMap {
    /// Row of the parent's front.
    pub to: Vec<u32>,
    /// The first `inside` rows are columns of the parent.
    pub inside: usize,
    /// Ranges of rows that are consecutive in both.
    runs: Vec<Range<usize>>,
}

impl RowMap {
    /// `local`: row of the parent's front by position; `end`: the position after the parent's columns.
    pub fn new(rows: &[u32], end: usize, local: &[u32]) -> Self {
        let to: Vec<u32> = rows.iter().map(|&row| local[row as usize]).collect();
        let inside = rows.partition_point(|&row| (row as usize) < end);
        let mut runs: Vec<Range<usize>> = Vec::new();
        for (i, &row) in to.iter().enumerate() {
            match runs.last_mut() {
                Some(run) if to[run.start] as usize + run.len() == row as usize => run.end = i + 1,
                _ => runs.push(i..i + 1),
            }
        }
        Self { to, inside, runs }
    }

    /// Adds values of the child's rows `rows` to a column that starts at row `first` of the parent's front.
    pub fn add<T: Entry>(&self, rows: Range<usize>, from: &[T], to: &mut [T], first: usize) {
        let run = self.runs.partition_point(|run| run.end <= rows.start);
        for run in &self.runs[run..] {
            let (begin, end) = (run.start.max(rows.start), run.end.min(rows.end));
            if begin >= end {
                break;
            }
            let at = self.to[begin] as usize - first;
            let from = &from[begin - rows.start..end - rows.start];
            to[at..at + from.len()].iter_mut().zip(from).for_each(|(to, from)| *to += from);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::linalg::cholesky::analysis::ordering::order_of_elimination;
    use crate::linalg::sparse::graph::Graph;
    use crate::linalg::Symmetric;

    #[test]
    fn updates_wait_unchanged_while_the_stacks_shrink_to_what_is_still_needed() {
        let n = 40;
        let (mut ptr, mut col) = (vec![0], Vec::new());
        for i in 0..n * n {
            let edges = [(i >= n).then(|| i - n), (i % n > 0).then(|| i - 1), Some(i)];
            col.extend(edges.into_iter().flatten().map(|j| j as u32));
            ptr.push(col.len());
        }
        let graph = Graph::of(&Symmetric::new(ptr, col.clone(), vec![1.0; col.len()])).unwrap();
        let order = order_of_elimination(&graph, &vec![false; n * n]).unwrap();
        let nodes = &Supernodes::of(&graph, &order).unwrap().1;
        let len = |s: usize| 100 * nodes.node(s).rows.len();
        let children = |s: usize| (0..s).filter(move |&child| nodes.parent(child) == s);
        let mut updates = Updates::new(nodes, 0..nodes.count(), len, "a test").unwrap();
        let room = |updates: &Updates<'_, f64>| updates.stacks.iter().map(|stack| stack.len()).sum::<usize>();
        let first = room(&updates);
        for s in 0..nodes.count() {
            let (own, waiting) = updates.open(s, len(s));
            assert!(waiting.iter().map(|child| child.0).eq(children(s)));
            for (child, values) in waiting {
                assert!(values.len() == len(child) && values.iter().all(|v| *v == child as f64));
            }
            own.fill(s as f64);
            updates.close(s, len(s));
        }
        let root = nodes.count() - 1;
        assert_eq!(room(&updates), children(root).map(len).sum::<usize>());
        assert!(first > 2 * room(&updates));
    }
}
