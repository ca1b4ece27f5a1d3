//! The adjacency graph of a stiffness matrix: connected parts, and the dofs of each node.

use crate::error::{Error, Kind, Result};
use crate::linalg::hash::{hash, START};
use crate::linalg::Symmetric;
use crate::platform::memory::{filled, reserved};

const WHAT: &str = "the graph of a body";

/// Both triangles and the diagonal: the neighbours of `i` are `adj[ptr[i]..ptr[i+1]]`, ascending.
pub struct Graph {
    pub ptr: Vec<usize>,
    pub adj: Vec<u32>,
}

impl Graph {
    pub fn of(matrix: &Symmetric) -> Result<Self> {
        let n = matrix.order();
        if u32::try_from(n).is_err() {
            return Err(Error::new(Kind::Overflow, "a body has more than 2^32 unknowns"));
        }
        let mut ptr = filled(n + 1, 0, WHAT)?;
        for i in 0..n {
            for (j, _) in matrix.lower_row(i) {
                ptr[i + 1] += 1;
                ptr[j + 1] += usize::from(i != j);
            }
        }
        (0..n).for_each(|i| ptr[i + 1] += ptr[i]);
        let (mut next, mut adj) = (ptr.clone(), filled(ptr[n], 0, WHAT)?);
        // row i writes its lower part before any later row appends to it: so it is ascending without a sort
        for i in 0..n {
            for (j, _) in matrix.lower_row(i) {
                adj[next[i]] = j as u32;
                next[i] += 1;
                if i != j {
                    adj[next[j]] = i as u32;
                    next[j] += 1;
                }
            }
        }
        Ok(Self { ptr, adj })
    }

    /// Number of dofs.
    pub fn order(&self) -> usize {
        self.ptr.len() - 1
    }

    pub fn neighbours(&self, i: usize) -> &[u32] {
        &self.adj[self.ptr[i]..self.ptr[i + 1]]
    }

    /// Groups dofs with identical neighbours (the dofs of one node): group of each dof, and the
    /// first dof of each group. Groups are numbered by their first dof.
    pub fn nodes(&self) -> Result<(Vec<u32>, Vec<usize>)> {
        let n = self.order();
        let mut by_key = reserved(n, WHAT)?;
        by_key.extend((0..n).map(|i| (self.key(i), i as u32)));
        by_key.sort_unstable();
        let mut leader: Vec<u32> = filled(n, 0, WHAT)?;
        for same_key in by_key.chunk_by(|a, b| a.0 == b.0) {
            for (at, &(_, i)) in same_key.iter().enumerate() {
                let alike = |j: u32| self.neighbours(j as usize) == self.neighbours(i as usize);
                let earlier = same_key[..at].iter().map(|&(_, j)| j);
                leader[i as usize] =
                    earlier.filter(|&j| leader[j as usize] == j).find(|&j| alike(j)).unwrap_or(i);
            }
        }
        let (mut group, mut first) = (reserved(n, WHAT)?, reserved(n, WHAT)?);
        for i in 0..n {
            let of = leader[i] as usize;
            group.push(if of == i { first.len() as u32 } else { group[of] });
            if of == i {
                first.push(i);
            }
        }
        Ok((group, first))
    }

    /// Hash key of the neighbours of `i`.
    fn key(&self, i: usize) -> u64 {
        hash(START, self.neighbours(i).iter().map(|&j| u64::from(j)))
    }
}

/// Connected parts of the matrix: the part of every dof, numbered by first dofs, and their count. Entries that are 0
/// connect nothing.
pub fn components(matrix: &Symmetric) -> (Vec<usize>, usize) {
    let row =
        |i| std::iter::once(i).chain(matrix.lower_row(i).filter(|(_, v)| *v != 0.0).map(|entry| entry.0));
    joined(matrix.order(), (0..matrix.order()).map(row))
}

/// Parts of 0..n in which the members of each set are together: the part of each, numbered by first members, and their
/// count.
pub fn joined(n: usize, sets: impl Iterator<Item = impl Iterator<Item = usize>>) -> (Vec<usize>, usize) {
    let mut root: Vec<usize> = (0..n).collect();
    for mut set in sets {
        let Some(first) = set.next() else { continue };
        for i in set {
            let (a, b) = (find(&mut root, first), find(&mut root, i));
            root[a.max(b)] = a.min(b);
        }
    }
    let (mut label, mut count) = (vec![usize::MAX; n], 0);
    for i in 0..n {
        let r = find(&mut root, i);
        if r == i {
            label[i] = count;
            count += 1;
        } else {
            label[i] = label[r];
        }
    }
    (label, count)
}

/// The smallest dof of the part of `i`; halves paths on the way.
fn find(root: &mut [usize], mut i: usize) -> usize {
    while root[i] != i {
        root[i] = root[root[i]];
        i = root[i];
    }
    i
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Dofs 0, 1 form one node coupled to dof 2; dof 3 is not coupled.
    fn sample() -> Symmetric {
        let val = vec![4.0, 1.0, 4.0, 1.0, 1.0, 4.0, 1.0];
        Symmetric::new(vec![0, 1, 3, 6, 7], vec![0, 0, 1, 0, 1, 2, 3], val)
    }

    #[test]
    fn unconnected_dofs_are_found_as_parts_of_their_own() {
        assert_eq!(components(&sample()), (vec![0, 0, 0, 1], 2));
    }

    #[test]
    fn dofs_with_the_same_neighbours_form_one_node() {
        let (group, first) = Graph::of(&sample()).unwrap().nodes().unwrap();
        assert_eq!((group, first), (vec![0, 0, 0, 1], vec![0, 3]));
    }
}
