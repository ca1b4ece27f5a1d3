//! What supernodes leave for their parents, from when it is formed until it is used.

use std::ops::Range;

use crate::error::Result;
use crate::linalg::pages::Pages;
use crate::linalg::supernodes::Supernodes;

/// Updates that wait, in the order of their supernodes. A supernode finds those of its children on one stack and puts its
/// own on the other, that of its level, even or odd: nothing is moved.
pub struct Updates<'a> {
    nodes: &'a Supernodes,
    waiting: Vec<(usize, Place)>,
    stacks: [Pages; 2],
    tops: [usize; 2],
}

enum Place {
    Stack(Range<usize>),
    /// Formed by another task.
    Apart(Pages),
}

impl<'a> Updates<'a> {
    /// For supernodes in this sequence, s of which leaves `len(s)` values; `what` they are for.
    pub fn new(
        nodes: &'a Supernodes,
        sequence: impl Iterator<Item = usize>,
        len: impl Fn(usize) -> usize,
        what: &str,
    ) -> Result<Self> {
        let [even, odd] = most(nodes, sequence, len);
        let stacks = [Pages::zeros(even, what)?, Pages::zeros(odd, what)?];
        Ok(Self { nodes, waiting: Vec::new(), stacks, tops: [0, 0] })
    }

    /// Takes over what another task has left for the parent of s.
    pub fn push(&mut self, s: usize, update: Pages) {
        self.waiting.push((s, Place::Apart(update)));
    }

    /// Room for the update of s, and the children of s with theirs.
    pub fn open(&mut self, s: usize, len: usize) -> (&mut [f64], Vec<(usize, &[f64])>) {
        let first = self.first_child(s);
        let level = self.nodes.level(s) % 2;
        let [even, odd] = &mut self.stacks;
        let (own, others) = if level == 0 { (even, odd) } else { (odd, even) };
        let children = self.waiting[first..].iter().map(|(child, place)| match place {
            Place::Stack(range) => (*child, &others[range.clone()]),
            Place::Apart(values) => (*child, &values[..]),
        });
        (&mut own[self.tops[level]..self.tops[level] + len], children.collect())
    }

    /// The update of s, of `len` values, waits; those of its children are gone.
    pub fn close(&mut self, s: usize, len: usize) {
        let first = self.first_child(s);
        let level = self.nodes.level(s) % 2;
        for (_, place) in self.waiting.drain(first..) {
            if let Place::Stack(range) = place {
                self.tops[1 - level] = self.tops[1 - level].min(range.start);
            }
        }
        let place = self.tops[level]..self.tops[level] + len;
        self.tops[level] = place.end;
        self.waiting.push((s, Place::Stack(place)));
    }

    /// The update of the root of a subtree, the last that waits.
    pub fn into_last(self, root: usize) -> Pages {
        let [even, odd] = self.stacks;
        let level = self.nodes.level(root) % 2;
        let update = if level == 0 { even } else { odd };
        update.truncated(self.tops[level])
    }

    fn first_child(&self, s: usize) -> usize {
        let stranger = self.waiting.iter().rposition(|(child, _)| self.nodes.parent(*child) != s);
        stranger.map_or(0, |at| at + 1)
    }
}

/// Most values that wait on each of the two stacks at a time.
pub fn most(
    nodes: &Supernodes,
    sequence: impl Iterator<Item = usize>,
    len: impl Fn(usize) -> usize,
) -> [usize; 2] {
    let (mut most, mut tops) = ([0, 0], [0, 0]);
    let mut waiting: Vec<(usize, usize)> = Vec::new();
    for s in sequence {
        let (level, len) = (nodes.level(s) % 2, len(s));
        while waiting.last().is_some_and(|child| nodes.parent(child.0) == s) {
            tops[1 - level] -= waiting.pop().map_or(0, |child| child.1);
        }
        waiting.push((s, len));
        tops[level] += len;
        most[level] = most[level].max(tops[level]);
    }
    most
}

/// Where the rows of a child are in the front of its parent.
pub struct RowMap {
    /// Row of the parent's front.
    pub to: Vec<u32>,
    /// So many of them, the first, are columns of the parent.
    pub inside: usize,
    /// Rows that are neighbours in both.
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
    pub fn add(&self, rows: Range<usize>, from: &[f64], to: &mut [f64], first: usize) {
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
