//! The pattern of L: supernodes, which are consecutive columns with equal rows below them, and their tree.
//!
//! All work is done on blocks of dofs with equal neighbours (the dofs of a node). A body in 3D has one block for three
//! dofs, and a ninth of the couplings.

use std::ops::Range;

use crate::error::Result;
use crate::linalg::cholesky::analysis::blocks::Blocks;
use crate::linalg::cholesky::analysis::elimination::{elimination_tree, postorder, NONE};
use crate::linalg::sparse::graph::Graph;
use crate::numbers::linalg::RELAXED;
use crate::platform::memory::reserved;

const WHAT: &str = "the pattern of a Cholesky factor";

/// Supernodes in postorder. The panel of a supernode has the entries of L in its columns: height x width, column-major,
/// first the rows of the columns themselves, then `rows`.
pub struct Supernodes {
    /// First column of every supernode, and n.
    begin: Vec<usize>,
    row_ptr: Vec<usize>,
    row: Vec<u32>,
    parent: Vec<usize>,
    level: Vec<u32>,
    /// Start of the panel of every supernode, and the end.
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
    /// Range of the panel in the values of L.
    pub panel: Range<usize>,
}

impl Node<'_> {
    pub fn end(&self) -> usize {
        self.begin + self.width
    }

    /// Number of rows of the panel.
    pub fn height(&self) -> usize {
        self.width + self.rows.len()
    }

    /// Position in the elimination of every row of the panel.
    pub fn front_rows(&self) -> impl Iterator<Item = usize> + '_ {
        (self.begin..self.end()).chain(self.rows.iter().map(|&row| row as usize))
    }

    /// Approximate multiplications to factorise the panel and to form its update.
    pub fn work(&self) -> f64 {
        let (w, b) = (self.width as f64, self.rows.len() as f64);
        w * (w * w / 3.0 + b * (w + b))
    }
}

impl Supernodes {
    /// Supernodes for the columns of `order` (dofs of `graph`; others are held). Also returns the order, rearranged into
    /// a postorder of the tree: the fill is unchanged, with far fewer supernodes.
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

    /// Number of values in all panels.
    pub fn values(&self) -> usize {
        self.panel[self.count()]
    }

    /// Start of the panel of supernode s in the values; their number for s = count.
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

    /// The supernode that receives the update of s, `NONE` for a root.
    pub fn parent(&self, s: usize) -> usize {
        self.parent[s]
    }

    /// Number of supernodes above s.
    pub fn level(&self, s: usize) -> usize {
        self.level[s] as usize
    }

    /// Supernode s and its descendants: in postorder the deeper supernodes directly before it.
    pub fn subtree(&self, s: usize) -> Range<usize> {
        let deeper = (0..s).rev().take_while(|&below| self.level[below] > self.level[s]).count();
        s - deeper..s + 1
    }

    /// The supernode of a column.
    pub fn of_column(&self, column: usize) -> usize {
        self.begin.partition_point(|&begin| begin <= column) - 1
    }

    /// Bytes of the lists.
    pub fn bytes(&self) -> usize {
        self.row.len() * size_of::<u32>() + 4 * self.begin.len() * size_of::<usize>()
    }

    /// Merges supernodes with their parents if this adds few zeros; converts blocks to dofs.
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

/// Maximal chains of blocks with equal rows below: supernodes without zeros.
struct Chains {
    first_block: Vec<usize>,
    /// Rows below, in blocks, ascending: `row[start[s]..end[s]]`.
    start: Vec<usize>,
    end: Vec<usize>,
    row: Vec<u32>,
}

/// Merged chains; the rows below them are those of the last chain, `last`.
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
        // mark[r]: the chain whose rows r was last found among
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

    /// Merges every chain with the group of its parent while this adds few zeros.
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
    /// The group merged with `child`, whose columns come directly before, if few entries are zero.
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

/// Completed chains, by the block that receives their update.
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

#[cfg(test)]
mod tests {
    use super::*;
    use crate::linalg::Symmetric;

    /// Columns of L below the diagonal by elimination dof by dof: pairs (column, row) of positions.
    fn filled(k: &Symmetric, order: &[usize]) -> Vec<(usize, usize)> {
        let n = order.len();
        let mut position = vec![NONE; k.order()];
        order.iter().enumerate().for_each(|(at, &dof)| position[dof] = at);
        let mut full = vec![false; n * n];
        for i in 0..k.order() {
            for (j, _) in k.lower_row(i).filter(|(j, _)| position[i] != NONE && position[*j] != NONE) {
                full[position[i].min(position[j]) * n + position[i].max(position[j])] = true;
            }
        }
        for c in 0..n {
            let rows: Vec<usize> = (c + 1..n).filter(|&r| full[c * n + r]).collect();
            rows.iter().for_each(|&r| rows.iter().filter(|&&q| q > r).for_each(|&q| full[r * n + q] = true));
        }
        (0..n * n).filter(|&at| full[at] && at / n < at % n).map(|at| (at / n, at % n)).collect()
    }

    /// Random graphs of nodes with two dofs, some dofs held.
    #[test]
    fn panels_hold_all_of_l_and_little_else_and_updates_go_to_the_first_row_below() {
        let mut state = 7_u64;
        let mut random = move || {
            state = state.wrapping_mul(0x5851_f42d_4c95_7f2d).wrapping_add(0x1405_7b7e_f767_814f);
            (state >> 33) as usize
        };
        for nodes in 1..40 {
            let edges: Vec<bool> = (0..nodes * nodes).map(|_| random() % nodes < 2).collect();
            let (mut ptr, mut col) = (vec![0], Vec::new());
            for i in 0..2 * nodes {
                col.extend(
                    (0..=i).filter(|&j| i / 2 == j / 2 || edges[i / 2 * nodes + j / 2]).map(|j| j as u32),
                );
                ptr.push(col.len());
            }
            let val = vec![1.0; col.len()];
            let k = Symmetric::new(ptr, col, val);
            let given: Vec<usize> = (0..2 * nodes).filter(|_| random() % 8 > 0).collect();
            let (order, found) = Supernodes::of(&Graph::of(&k).unwrap(), &given).unwrap();
            let sorted = |mut dofs: Vec<usize>| {
                dofs.sort_unstable();
                dofs
            };
            assert_eq!(sorted(order.clone()), given);
            let l = filled(&k, &order);
            let mut entries = 0;
            for (s, node) in found.nodes().enumerate() {
                let rows: Vec<usize> = node.front_rows().collect();
                assert!(rows.windows(2).all(|pair| pair[0] < pair[1]));
                let own = |entry: &&(usize, usize)| found.of_column(entry.0) == s;
                assert!(l.iter().filter(own).all(|(_, row)| rows.binary_search(row).is_ok()));
                entries += node.width * (node.width + 1) / 2 + node.width * node.rows.len();
                let above = node.rows.first().map_or(NONE, |&row| found.of_column(row as usize));
                assert_eq!(found.parent(s), above);
            }
            let exact = l.len() + order.len();
            assert!(
                entries >= exact && (entries - exact) as f64 <= 0.9 * entries as f64,
                "{entries}, {exact}"
            );
        }
    }
}
