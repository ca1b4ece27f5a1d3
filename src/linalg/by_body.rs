//! A vector over the unknowns of several bodies in one place, body after body: their metric, and what the factor of a whole island takes
//! and gives. What else belongs to bodies stays with each.

use std::ops::Range;
use std::sync::Arc;

use crate::error::Result;
use crate::platform::memory::reserved;

/// Where each body begins and ends among all unknowns.
pub type Ranges = Arc<Vec<Range<usize>>>;

/// Bodies of so many unknowns, one after the other.
pub fn ranges(orders: impl Iterator<Item = usize>) -> Vec<Range<usize>> {
    let mut end = 0;
    let range = |order: usize| {
        end += order;
        end - order..end
    };
    orders.map(range).collect()
}

#[derive(Debug, Clone, Default, PartialEq)]
pub struct ByBody<T = f64> {
    ranges: Ranges,
    values: Vec<T>,
}

impl<T: Copy> ByBody<T> {
    /// These values, body after body.
    pub fn of(ranges: &Ranges, values: Vec<T>) -> Self {
        Self { ranges: Arc::clone(ranges), values }
    }

    /// Of each body its own.
    pub fn from_each<O: AsRef<[T]>>(
        ranges: &Ranges,
        own: impl IntoIterator<Item = O>,
        what: &str,
    ) -> Result<Self> {
        let mut values = reserved(ranges.last().map_or(0, |range| range.end), what)?;
        own.into_iter().for_each(|own| values.extend_from_slice(own.as_ref()));
        Ok(Self::of(ranges, values))
    }

    /// The values of body p.
    pub fn on(&self, p: usize) -> &[T] {
        &self.values[self.ranges[p].clone()]
    }

    pub fn on_mut(&mut self, p: usize) -> &mut [T] {
        &mut self.values[self.ranges[p].clone()]
    }

    /// The values of every body.
    pub fn each(&self) -> impl Iterator<Item = &[T]> + '_ {
        self.ranges.iter().map(|range| &self.values[range.clone()])
    }

    /// All values, body after body: for what needs K of all bodies in one place.
    pub fn in_sequence(&self) -> &[T] {
        &self.values
    }

    pub fn into_sequence(self) -> Vec<T> {
        self.values
    }
}
