//! The pattern of L: supernodes, neighbouring columns with the same rows below them, and the tree they form.
//!
//! Everything is done on blocks of dofs with the same neighbours (the dofs of a node), of which a body in space has a
//! third of its dofs, with a ninth of their couplings.

use std::ops::Range;

use crate::error::Result;
use crate::linalg::elimination::{elimination_tree, postorder, NONE};
use crate::linalg::graph::Graph;
use crate::linalg::memory::reserved;

const WHAT: &str = "the pattern of a Cholesky factor";

/// A supernode joins its parent when this share of the panel they form is zero at most, by the columns it has.
/// Larger panels make faster products; the zeros cost memory and work.
const RELAXED: [(usize, f64); 3] = [(12, 0.9), (48, 0.25), (usize::MAX, 0.05)];

/// Supernodes in postorder. The panel of one holds L at its columns: height x width, column-major, first the rows of the
/// columns themselves, then `rows`.
pub struct Supernodes {
    /// First column of every supernode, then n.
    begin: Vec<usize>,
    row_ptr: Vec<usize>,
    row: Vec<u32>,
    parent: Vec<usize>,
    level: Vec<u32>,
    /// Where the panel of every supernode starts, then the end.
    panel: Vec<usize>,
}

/// One supernode.
#[derive(Clone)]
pub struct Node<'a> {
    /// First column.
    pub begin: usize,
    /// Number of columns.
    pub width: usize,
    /// Positions of the rows below the columns, ascending.
    pub rows: &'a [u32],
    /// The panel among the values of L.
    pub panel: Range<usize>,
}

impl Node<'_> {
    pub fn end(&self) -> usize {
        self.begin + self.width
    }

    /// Rows of the panel.
    pub fn height(&self) -> usize {
        self.width + self.rows.len()
    }

    /// Position of every row of the panel.
    pub fn front_rows(&self) -> impl Iterator<Item = usize> + '_ {
        (self.begin..self.end()).chain(self.rows.iter().map(|&row| row as usize))
    }

    /// Multiplications to factorise the panel and to form its update, about.
    pub fn work(&self) -> f64 {
        let (w, b) = (self.width as f64, self.rows.len() as f64);
        w * (w * w / 3.0 + b * (w + b))
    }
}

impl Supernodes {
    /// For the columns of `order` (dofs of `graph`; others are held). Gives the order too, rearranged into a postorder of
    /// the tree: the same fill, far fewer supernodes.
    pub fn of(graph: &Graph, order: &[usize]) -> Result<(Vec<usize>, Self)> {
        let blocks = Blocks::of(graph, order)?;
        let parent = elimination_tree(blocks.count(), |b| blocks.neighbours(b).iter());
        let sequence = postorder(&parent);
        let blocks = blocks.permuted(&sequence)?;
        let mut dofs = reserved(order.len(), WHAT)?;
        dofs.extend(blocks.range.iter().flat_map(|range| range.clone().map(|k| order[k])));
        let chains = Chains::of(&blocks)?;
        Ok((dofs, Self::relaxed(&blocks, &chains)?))
    }

    /// Number of supernodes.
    pub fn count(&self) -> usize {
        self.parent.len()
    }

    /// Number of columns n.
    pub fn order(&self) -> usize {
        self.begin[self.count()]
    }

    /// Values that all panels hold.
    pub fn values(&self) -> usize {
        self.panel[self.count()]
    }

    /// Where the panel of supernode s starts among the values; their number for s = count.
    pub fn first_value(&self, s: usize) -> usize {
        self.panel[s]
    }

    pub fn node(&self, s: usize) -> Node<'_> {
        Node {
            begin: self.begin[s],
            width: self.begin[s + 1] - self.begin[s],
            rows: &self.row[self.row_ptr[s]..self.row_ptr[s + 1]],
            panel: self.panel[s]..self.panel[s + 1],
        }
    }

    pub fn nodes(&self) -> impl DoubleEndedIterator<Item = Node<'_>> {
        (0..self.count()).map(|s| self.node(s))
    }

    /// The supernode that takes the update of s, `NONE` for a root.
    pub fn parent(&self, s: usize) -> usize {
        self.parent[s]
    }

    /// Number of supernodes above s.
    pub fn level(&self, s: usize) -> usize {
        self.level[s] as usize
    }

    /// The supernode of a column.
    pub fn of_column(&self, column: usize) -> usize {
        self.begin.partition_point(|&begin| begin <= column) - 1
    }

    /// Bytes of the lists.
    pub fn bytes(&self) -> usize {
        self.row.len() * size_of::<u32>() + 4 * self.begin.len() * size_of::<usize>()
    }

    /// Joins supernodes with their parents where few zeros come in; rows and columns of dofs in place of blocks.
    fn relaxed(blocks: &Blocks, chains: &Chains) -> Result<Self> {
        let groups = chains.groups(blocks)?;
        let mut group_of_block = reserved(blocks.count(), WHAT)?;
        for g in 0..groups.len() {
            let end = groups.get(g + 1).map_or(blocks.count(), |next| next.first_block);
            group_of_block.resize(end, g);
        }
        let entries = groups.iter().map(|group| group.below).sum();
        let mut nodes = Self {
            begin: reserved(groups.len() + 1, WHAT)?,
            row_ptr: reserved(groups.len() + 1, WHAT)?,
            row: reserved(entries, WHAT)?,
            parent: reserved(groups.len(), WHAT)?,
            level: reserved(groups.len(), WHAT)?,
            panel: reserved(groups.len() + 1, WHAT)?,
        };
        let (mut column, mut value) = (0, 0);
        for group in &groups {
            nodes.begin.push(column);
            nodes.row_ptr.push(nodes.row.len());
            nodes.panel.push(value);
            let rows = chains.rows(group.last);
            nodes.parent.push(rows.first().map_or(NONE, |&block| group_of_block[block as usize]));
            let positions = rows.iter().flat_map(|&block| blocks.position(block as usize));
            nodes.row.extend(positions.map(|position| position as u32));
            column += group.width;
            value += group.width * (group.width + group.below);
        }
        nodes.begin.push(column);
        nodes.row_ptr.push(nodes.row.len());
        nodes.panel.push(value);
        nodes.level.resize(groups.len(), 0);
        for s in (0..groups.len()).rev() {
            let parent = nodes.parent[s];
            nodes.level[s] = if parent == NONE { 0 } else { nodes.level[parent] + 1 };
        }
        Ok(nodes)
    }
}

/// Dofs that follow each other in the order and have the same neighbours, each other among them.
struct Blocks {
    /// Their places in the order that was given.
    range: Vec<Range<usize>>,
    /// Position of the first column of every block, then n.
    start: Vec<usize>,
    ptr: Vec<usize>,
    adj: Vec<u32>,
}

impl Blocks {
    fn of(graph: &Graph, order: &[usize]) -> Result<Self> {
        let mut range: Vec<Range<usize>> = reserved(order.len(), WHAT)?;
        let mut block_of: Vec<u32> = reserved(graph.order(), WHAT)?;
        block_of.resize(graph.order(), u32::MAX);
        for (k, &dof) in order.iter().enumerate() {
            match range.last_mut() {
                Some(last) if graph.neighbours(dof) == graph.neighbours(order[k - 1]) => last.end = k + 1,
                _ => range.push(k..k + 1),
            }
            block_of[dof] = (range.len() - 1) as u32;
        }
        let mut seen: Vec<u32> = reserved(range.len(), WHAT)?;
        seen.resize(range.len(), u32::MAX);
        let (mut ptr, mut adj) = (reserved(range.len() + 1, WHAT)?, Vec::new());
        ptr.push(0);
        for (own, range) in range.iter().enumerate() {
            seen[own] = own as u32;
            for &dof in graph.neighbours(order[range.start]) {
                let other = block_of[dof as usize];
                if other != u32::MAX && seen[other as usize] != own as u32 {
                    seen[other as usize] = own as u32;
                    adj.push(other);
                }
            }
            ptr.push(adj.len());
        }
        let start = starts(&range)?;
        Ok(Self { range, start, ptr, adj })
    }

    fn count(&self) -> usize {
        self.range.len()
    }

    fn neighbours(&self, block: usize) -> &[u32] {
        &self.adj[self.ptr[block]..self.ptr[block + 1]]
    }

    /// Columns of a block.
    fn position(&self, block: usize) -> Range<usize> {
        self.start[block]..self.start[block + 1]
    }

    /// Dofs of a block.
    fn size(&self, block: usize) -> usize {
        self.position(block).len()
    }

    /// The blocks in another sequence.
    fn permuted(&self, sequence: &[usize]) -> Result<Self> {
        let mut new: Vec<u32> = reserved(sequence.len(), WHAT)?;
        new.resize(sequence.len(), 0);
        sequence.iter().enumerate().for_each(|(at, &block)| new[block] = at as u32);
        let (mut ptr, mut adj) = (reserved(sequence.len() + 1, WHAT)?, reserved(self.adj.len(), WHAT)?);
        ptr.push(0);
        for &block in sequence {
            adj.extend(self.neighbours(block).iter().map(|&other| new[other as usize]));
            ptr.push(adj.len());
        }
        let mut range = reserved(sequence.len(), WHAT)?;
        range.extend(sequence.iter().map(|&block| self.range[block].clone()));
        let start = starts(&range)?;
        Ok(Self { range, start, ptr, adj })
    }
}

fn starts(ranges: &[Range<usize>]) -> Result<Vec<usize>> {
    let mut start = reserved(ranges.len() + 1, WHAT)?;
    start.push(0);
    for (k, range) in ranges.iter().enumerate() {
        start.push(start[k] + range.len());
    }
    Ok(start)
}

/// Maximal chains of blocks with the same rows below: supernodes without any zeros.
struct Chains {
    first_block: Vec<usize>,
    /// Rows below, in blocks, ascending: `row[start[s]..end[s]]`.
    start: Vec<usize>,
    end: Vec<usize>,
    row: Vec<u32>,
}

/// Some chains joined: those up to `last`, whose rows they have.
struct Group {
    first_block: usize,
    last: usize,
    /// Columns, rows below and entries of the panel that are zero, in dofs.
    width: usize,
    below: usize,
    zeros: usize,
}

impl Chains {
    /// Blocks must be in a postorder of their tree.
    fn of(blocks: &Blocks) -> Result<Self> {
        let n = blocks.count();
        let mut chains =
            Self { first_block: Vec::new(), start: Vec::new(), end: Vec::new(), row: Vec::new() };
        let mut children = Children { head: vec![NONE; n], next: Vec::new() };
        // mark[r] is the last mark for the rows of the chain that is open.
        let (mut mark, mut current) = (vec![u32::MAX; n], 0_u32);
        for j in 0..n {
            let later = || blocks.neighbours(j).iter().copied().filter(|&r| r as usize > j);
            let open = chains.first_block.len().wrapping_sub(1);
            let follows = j > 0 && chains.rows(open).first() == Some(&(j as u32));
            if follows && children.head[j] == NONE && later().all(|r| mark[r as usize] == current) {
                chains.start[open] += 1;
                continue;
            }
            if let Some(&parent) = (j > 0).then(|| chains.rows(open).first()).flatten() {
                children.push(parent as usize, open);
            }
            current = current.wrapping_add(1);
            let begin = chains.row.len();
            let mut child = children.head[j];
            while child != NONE {
                for at in chains.start[child]..chains.end[child] {
                    chains.append(chains.row[at], j, &mut mark, current);
                }
                child = children.next[child];
            }
            later().for_each(|r| chains.append(r, j, &mut mark, current));
            if follows && chains.row.len() - begin + 1 == chains.rows(open).len() {
                chains.row.truncate(begin);
                chains.start[open] += 1;
                continue;
            }
            chains.row[begin..].sort_unstable();
            chains.first_block.push(j);
            chains.start.push(begin);
            chains.end.push(chains.row.len());
        }
        Ok(chains)
    }

    fn append(&mut self, row: u32, column: usize, mark: &mut [u32], current: u32) {
        if row as usize != column && mark[row as usize] != current {
            mark[row as usize] = current;
            self.row.push(row);
        }
    }

    fn rows(&self, chain: usize) -> &[u32] {
        &self.row[self.start[chain]..self.end[chain]]
    }

    /// Every chain joins the group of its parent as long as few zeros come in.
    fn groups(&self, blocks: &Blocks) -> Result<Vec<Group>> {
        let count = self.first_block.len();
        let mut groups: Vec<Group> = reserved(count, WHAT)?;
        for last in 0..count {
            let first_block = self.first_block[last];
            let end = self.first_block.get(last + 1).map_or(blocks.count(), |&next| next);
            let width = blocks.start[end] - blocks.start[first_block];
            let below = self.rows(last).iter().map(|&block| blocks.size(block as usize)).sum();
            let mut group = Group { first_block, last, width, below, zeros: 0 };
            while let Some(joined) = groups.last().and_then(|child| {
                let parent = self.rows(child.last).first().map(|&block| block as usize);
                parent.filter(|block| (first_block..end).contains(block)).and_then(|_| group.joined(child))
            }) {
                groups.pop();
                group = joined;
            }
            groups.push(group);
        }
        Ok(groups)
    }
}

impl Group {
    /// The group with `child`, whose columns come just before, where few entries are zero.
    fn joined(&self, child: &Group) -> Option<Group> {
        let width = self.width + child.width;
        let zeros = self.zeros + child.zeros + child.width * (self.width + self.below - child.below);
        let entries = width * (width + 1) / 2 + width * self.below;
        let (_, share) = RELAXED.into_iter().find(|(most, _)| width <= *most)?;
        let few = zeros as f64 <= share * entries as f64;
        few.then_some(Group {
            first_block: child.first_block,
            last: self.last,
            width,
            below: self.below,
            zeros,
        })
    }
}

/// Chains that are closed, by the block they pass their update to.
struct Children {
    head: Vec<usize>,
    next: Vec<usize>,
}

impl Children {
    fn push(&mut self, parent: usize, chain: usize) {
        self.next.resize(self.next.len().max(chain + 1), NONE);
        self.next[chain] = self.head[parent];
        self.head[parent] = chain;
    }
}
