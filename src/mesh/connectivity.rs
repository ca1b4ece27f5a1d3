//! The unknowns joined by the elements of a body, in the numbering of the host.

use std::ops::Range;

use crate::error::{Error, Kind, Result, INDEX};
use crate::platform::memory::reserved;

const WHAT: &str = "the elements of a body";

/// One row and column of an element matrix.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Place {
    /// An unknown of the body.
    Free(usize),
    /// A held unknown: its position among the held unknowns.
    Held(usize),
}

/// The elements and the unknowns that they join.
#[derive(Debug, Default)]
pub struct Connectivity {
    /// First entry of every element, and the end.
    ptr: Vec<usize>,
    /// Unknowns from 0, held unknowns from the largest number downwards.
    entries: Vec<u32>,
    /// Number of unknowns n that are not held.
    unknowns: usize,
    /// Numbers k of the held unknowns, from 0, ascending; the host gives them as -1 - k.
    held: Vec<u64>,
}

impl Connectivity {
    /// Element e has the entries `ptr[e]..ptr[e + 1]` of `dof`, from 0 to n - 1; a negative entry -1 - k is the held
    /// unknown k.
    pub fn new(unknowns: usize, ptr: &[usize], dof: &[i64]) -> Result<Self> {
        let mut held: Vec<u64> = reserved(dof.iter().filter(|dof| **dof < 0).count(), WHAT)?;
        held.extend(dof.iter().filter(|dof| **dof < 0).map(|dof| !*dof as u64));
        held.sort_unstable();
        held.dedup();
        let limit = u32::MAX as usize;
        if unknowns.saturating_add(held.len()) > limit {
            let what =
                format!("a body of {unknowns} unknowns and {} held ones has more than {limit}", held.len());
            return Err(Error::new(Kind::Overflow, what).value(unknowns as f64).limit(limit as f64));
        }
        let mut entries = reserved(dof.len(), WHAT)?;
        for (at, &dof) in dof.iter().enumerate() {
            entries.push(match usize::try_from(dof) {
                Ok(free) if free < unknowns => free as u32,
                Ok(_) => {
                    let element = ptr.partition_point(|start| *start <= at) - 1;
                    let what = format!("unknown {INDEX} is outside the {unknowns} unknowns of the body");
                    let error = Error::argument("dof", what).element(element).entry(at);
                    return Err(error.index(dof).limit(unknowns as f64));
                }
                Err(_) => !(held.partition_point(|k| *k < !dof as u64) as u32),
            });
        }
        let mut own = reserved(ptr.len(), WHAT)?;
        own.extend_from_slice(ptr);
        Ok(Self { ptr: own, entries, unknowns, held })
    }

    /// Number of elements.
    pub fn elements(&self) -> usize {
        self.ptr.len().saturating_sub(1)
    }

    /// Number of unknowns n that are not held.
    pub fn unknowns(&self) -> usize {
        self.unknowns
    }

    /// Numbers of the held unknowns, from 0, ascending.
    pub fn held(&self) -> &[u64] {
        &self.held
    }

    /// Number of unknowns of an element, including held unknowns.
    pub fn size(&self, element: usize) -> usize {
        self.range(element).len()
    }

    /// The unknowns of an element, in the order of the rows and columns of its matrix.
    pub fn places(&self, element: usize) -> impl DoubleEndedIterator<Item = Place> + '_ {
        let free = |entry: u32| (entry as usize) < self.unknowns;
        self.entries[self.range(element)].iter().map(move |&entry| match free(entry) {
            true => Place::Free(entry as usize),
            false => Place::Held(!entry as usize),
        })
    }

    /// The unknowns of an element that are not held.
    pub fn free(&self, element: usize) -> impl DoubleEndedIterator<Item = u32> + '_ {
        let unknowns = self.unknowns;
        self.entries[self.range(element)].iter().copied().filter(move |entry| (*entry as usize) < unknowns)
    }

    /// Whether the input is equal, entry by entry.
    pub fn is(&self, unknowns: usize, ptr: &[usize], dof: &[i64]) -> bool {
        let host = |entry: u32| match (entry as usize) < self.unknowns {
            true => i64::from(entry),
            false => !(self.held[!entry as usize] as i64),
        };
        self.unknowns == unknowns
            && self.ptr == ptr
            && self.entries.iter().map(|e| host(*e)).eq(dof.iter().copied())
    }

    fn range(&self, element: usize) -> Range<usize> {
        self.ptr[element]..self.ptr[element + 1]
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_below_zero_are_held_unknowns_by_their_own_numbers() {
        let dof = [0, -1, 2, -1_000_000_001, 1, -1];
        let all = Connectivity::new(3, &[0, 3, 6], &dof).unwrap();
        assert_eq!(all.held(), [0, 1_000_000_000]);
        assert!(all.places(0).eq([Place::Free(0), Place::Held(0), Place::Free(2)]));
        assert!(all.places(1).eq([Place::Held(1), Place::Free(1), Place::Held(0)]));
        assert!(all.free(0).eq([0, 2]) && all.is(3, &[0, 3, 6], &dof));
        assert!(!all.is(3, &[0, 3, 6], &[0, -1, 2, -2, 1, -1]));
    }

    #[test]
    fn an_unknown_that_the_body_has_not_is_named_with_its_element() {
        let error = Connectivity::new(3, &[0, 2, 2, 4], &[0, 1, 2, 3]).unwrap_err();
        assert_eq!((error.place.element, error.place.entry, error.place.index), (Some(2), Some(3), Some(3)));
    }
}
