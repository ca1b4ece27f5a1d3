//! The sparsity pattern of a sum of element matrices.

use crate::error::Result;
use crate::linalg::Symmetric;
use crate::platform::memory::{filled, reserved};

const WHAT: &str = "the pattern of a stiffness matrix";

/// The elements of one piece, over the unknowns of the piece.
pub struct Local {
    /// First entry of every element, and the end.
    ptr: Vec<usize>,
    dof: Vec<u32>,
    unknowns: usize,
}

impl Local {
    /// `elements`: their number; `entries`: the total number of their unknowns.
    pub fn with_room(elements: usize, entries: usize, unknowns: usize) -> Result<Self> {
        let mut ptr = reserved(elements + 1, WHAT)?;
        ptr.push(0);
        Ok(Self { ptr, dof: reserved(entries, WHAT)?, unknowns })
    }

    pub fn push(&mut self, dofs: impl Iterator<Item = u32>) {
        self.dof.extend(dofs);
        self.ptr.push(self.dof.len());
    }

    /// The zero matrix with an entry for every two unknowns that share an element, and for the diagonal.
    pub fn pattern(&self) -> Result<Symmetric> {
        let by_dof = self.by_dof()?;
        let mut columns = Columns::new(self, &by_dof)?;
        let mut entries = 0;
        columns.each_row(|row| {
            entries += row.len();
        });
        let mut ptr = reserved(self.unknowns + 1, WHAT)?;
        ptr.push(0);
        let mut col: Vec<u32> = reserved(entries, WHAT)?;
        columns.each_row(|row| {
            col.extend_from_slice(row);
            ptr.push(col.len());
        });
        Ok(Symmetric::new(ptr, col, filled(entries, 0.0, WHAT)?))
    }

    /// The elements of every unknown, ascending.
    fn by_dof(&self) -> Result<(Vec<usize>, Vec<u32>)> {
        let mut ptr = filled(self.unknowns + 1, 0, WHAT)?;
        self.dof.iter().for_each(|&dof| ptr[dof as usize + 1] += 1);
        (0..self.unknowns).for_each(|i| ptr[i + 1] += ptr[i]);
        let (mut next, mut elements) = (filled(self.unknowns, 0, WHAT)?, filled(self.dof.len(), 0, WHAT)?);
        next.copy_from_slice(&ptr[..self.unknowns]);
        for element in 0..self.ptr.len() - 1 {
            for &dof in &self.dof[self.ptr[element]..self.ptr[element + 1]] {
                elements[next[dof as usize]] = element as u32;
                next[dof as usize] += 1;
            }
        }
        Ok((ptr, elements))
    }
}

/// Finds the neighbours of one unknown after the other; those of the unknowns of one node are equal.
struct Columns<'a> {
    local: &'a Local,
    ptr: &'a [usize],
    elements: &'a [u32],
    /// For each unknown: 1 + the last unknown as whose neighbour it was listed.
    seen: Vec<usize>,
    list: Vec<u32>,
}

impl<'a> Columns<'a> {
    fn new(local: &'a Local, (ptr, elements): &'a (Vec<usize>, Vec<u32>)) -> Result<Self> {
        Ok(Self { local, ptr, elements, seen: filled(local.unknowns, 0, WHAT)?, list: Vec::new() })
    }

    fn elements_of(&self, dof: usize) -> &'a [u32] {
        &self.elements[self.ptr[dof]..self.ptr[dof + 1]]
    }

    /// Calls `take` with the columns of every row of the lower triangle, ascending.
    fn each_row(&mut self, mut take: impl FnMut(&[u32])) {
        self.seen.fill(0);
        for dof in 0..self.local.unknowns {
            let same = dof > 0
                && !self.elements_of(dof).is_empty()
                && self.elements_of(dof) == self.elements_of(dof - 1);
            if !same {
                self.list_neighbours(dof);
            }
            take(&self.list[..self.list.partition_point(|&j| j as usize <= dof)]);
        }
    }

    fn list_neighbours(&mut self, dof: usize) {
        self.list.clear();
        self.list.push(dof as u32);
        self.seen[dof] = dof + 1;
        for &element in self.elements_of(dof) {
            let element = element as usize;
            for &j in &self.local.dof[self.local.ptr[element]..self.local.ptr[element + 1]] {
                if self.seen[j as usize] != dof + 1 {
                    self.seen[j as usize] = dof + 1;
                    self.list.push(j);
                }
            }
        }
        self.list.sort_unstable();
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn unknowns_of_one_element_are_neighbours_and_those_of_none_stand_alone() {
        let mut local = Local::with_room(3, 7, 6).unwrap();
        for dofs in [&[4, 0][..], &[0, 1, 0], &[3, 4]] {
            local.push(dofs.iter().copied());
        }
        let k = local.pattern().unwrap();
        let rows: Vec<Vec<usize>> = (0..6).map(|i| k.lower_row(i).map(|(j, _)| j).collect()).collect();
        assert_eq!(rows, [vec![0], vec![0, 1], vec![2], vec![3], vec![0, 3, 4], vec![5]]);
    }
}
