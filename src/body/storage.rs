//! How a host stores the entries of a stiffness matrix.

/// Which entries the host hands over.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Storage {
    Full,
    Lower,
    Upper,
}

/// A matrix by rows as it arrived: `ptr` has n + 1 nondecreasing entries from 0, columns count from 0 in any
/// order within a row.
#[derive(Debug, Clone, Copy)]
pub struct SparseInput<'a> {
    pub ptr: &'a [usize],
    pub col: &'a [i64],
    pub val: &'a [f64],
    pub storage: Storage,
}
