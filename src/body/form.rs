//! The form in which the host gave a matrix and will give new values.

use crate::body::skyline::Skyline;
use crate::body::storage::Storage;
use crate::body::triplets::Triplets;
use crate::body::values::Places;
use crate::error::Result;
use crate::linalg::Symmetric;

/// With all that new values need.
#[derive(Debug, PartialEq)]
pub enum Form {
    Sparse(Places),
    Skyline(Skyline),
    Triplets(Triplets),
    Dense(Storage),
    /// By elements, with this total number of entries.
    Elements(usize),
}

impl Form {
    /// Number of entries that the host gives for n unknowns.
    pub fn entries(&self, n: usize) -> usize {
        match self {
            Self::Dense(Storage::Full) => n * n,
            Self::Dense(_) => n * (n + 1) / 2,
            Self::Elements(entries) => *entries,
            _ => self.values(false).or_else(|| Some(n + self.values(true)?)).unwrap_or(0),
        }
    }

    /// Number of values beside a separate diagonal (`split`), or of all values; none if the host gives new values by another call.
    pub fn values(&self, split: bool) -> Option<usize> {
        let (is_split, entries) = match self {
            Self::Sparse(places) => (places.is_split(), places.entries()),
            Self::Skyline(profile) => (profile.is_split(), profile.entries()),
            Self::Triplets(triplets) => (false, triplets.entries()),
            Self::Dense(_) | Self::Elements(_) => return None,
        };
        (is_split == split).then_some(entries)
    }

    /// The new values of `k` from those of the host, checked like the first ones; none if `k` does not have an entry that is
    /// not 0 any more. `diag`: the diagonal, if it is a separate array.
    pub fn new_values(
        &self,
        k: &Symmetric,
        diag: &[f64],
        val: &[f64],
        tolerance: f64,
    ) -> Result<Option<Vec<f64>>> {
        match self {
            Self::Sparse(places) => places.values(k, diag, val, tolerance).map(Some),
            Self::Skyline(profile) => profile.values(k, diag, val),
            Self::Triplets(triplets) => triplets.values(k, val, tolerance).map(Some),
            Self::Dense(_) | Self::Elements(_) => Ok(None),
        }
    }

    /// How the matrix was given, and the call for its new values.
    pub fn told(&self) -> (&'static str, &'static str) {
        let split = self.values(true).is_some();
        let call = if split { "feti_body_values_split" } else { "feti_body_values" };
        match self {
            Self::Dense(_) => ("dense", "feti_body_values_dense"),
            Self::Elements(_) => ("by elements", "feti_body_element"),
            Self::Skyline(_) if split => ("by its profile with a separate diagonal", call),
            Self::Skyline(_) => ("by its profile", call),
            Self::Triplets(_) => ("by triplets", call),
            Self::Sparse(_) if split => ("with a separate diagonal", call),
            Self::Sparse(_) => ("by rows", call),
        }
    }
}
