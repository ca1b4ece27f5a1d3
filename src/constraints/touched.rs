//! The unknowns of bodies that rows touch. They are the columns of the rows of an island: all that rows see of a body are the values
//! there.

use std::ops::Range;

use crate::linalg::hash::{hash, START};
use crate::linalg::ByBody;

/// Touched unknowns, numbered body after body.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Touched {
    /// The end of each body among all touched unknowns.
    ends: Box<[usize]>,
    /// Each within its body, ascending.
    dofs: Box<[u32]>,
}

impl Touched {
    /// The columns of these rows, whose unknowns are those of bodies that begin and end here, one after the other.
    pub fn of(bodies: &[Range<usize>], columns: impl IntoIterator<Item = usize>) -> Self {
        let mut touched = vec![false; bodies.last().map_or(0, |range| range.end)];
        columns.into_iter().for_each(|j| touched[j] = true);
        let (mut ends, mut dofs) = (Vec::with_capacity(bodies.len()), Vec::new());
        for range in bodies {
            dofs.extend(range.clone().filter(|j| touched[*j]).map(|j| (j - range.start) as u32));
            ends.push(dofs.len());
        }
        Self { ends: ends.into(), dofs: dofs.into() }
    }

    /// Hash key.
    pub fn key(&self) -> u64 {
        let ends = self.ends.iter().map(|end| *end as u64);
        hash(START, ends.chain(self.dofs.iter().map(|dof| u64::from(*dof))))
    }

    pub fn len(&self) -> usize {
        self.dofs.len()
    }

    /// Numbers of the touched unknowns of a body.
    pub fn range(&self, body: usize) -> Range<usize> {
        body.checked_sub(1).map_or(0, |before| self.ends[before])..self.ends[body]
    }

    /// Touched unknowns of a body, within it, ascending.
    pub fn on(&self, body: usize) -> &[u32] {
        &self.dofs[self.range(body)]
    }

    /// The same as numbers of all sizes.
    pub fn dofs(&self, body: usize) -> impl ExactSizeIterator<Item = usize> + Clone + '_ {
        self.dofs[self.range(body)].iter().map(|dof| *dof as usize)
    }

    /// The body of touched unknown j.
    pub fn body_of(&self, j: usize) -> usize {
        self.ends.partition_point(|end| *end <= j)
    }

    /// Touched unknown j within its body.
    pub fn dof(&self, j: usize) -> usize {
        self.dofs[j] as usize
    }

    /// Replaces the values where rows touch.
    pub fn set<T: Copy>(&self, values: &[T], v: &mut ByBody<T>) {
        for p in 0..self.ends.len() {
            let own = v.on_mut(p);
            self.dofs(p).zip(&values[self.range(p)]).for_each(|(dof, value)| own[dof] = *value);
        }
    }

    /// The number of an unknown of a body, if rows touch it.
    pub fn place(&self, body: usize, dof: usize) -> Option<usize> {
        let own = self.range(body);
        Some(own.start + self.dofs[own].binary_search(&(dof as u32)).ok()?)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::sync::Arc;

    /// Bodies of 3, 0, 2 and 4 unknowns; rows touch unknowns 0 and 2 of the first, 1 of the third and 3 of the last.
    #[test]
    fn rows_read_and_change_the_values_that_they_touch_and_no_others() {
        let ranges = [0..3, 3..3, 3..5, 5..9];
        let touched = Touched::of(&ranges, [8, 0, 4, 2, 4]);
        let places: Vec<_> = (0..touched.len()).map(|j| (touched.body_of(j), touched.dof(j))).collect();
        assert_eq!(places, [(0, 0), (0, 2), (2, 1), (3, 3)]);
        assert_eq!((touched.range(1), touched.range(3)), (2..2, 3..4));
        assert!(places.iter().enumerate().all(|(j, &(body, dof))| touched.place(body, dof) == Some(j)));
        assert_eq!(touched.place(0, 1), None);
        let mut v = ByBody::of(&Arc::new(ranges.to_vec()), (0..9).map(f64::from).collect());
        assert_eq!((touched.on(0), touched.on(1), touched.on(2)), (&[0, 2][..], &[][..], &[1][..]));
        touched.set(&[10.0, 12.0, 14.0, 18.0], &mut v);
        assert_eq!(v.in_sequence(), [10.0, 1.0, 12.0, 3.0, 14.0, 5.0, 6.0, 7.0, 18.0]);
    }
}
