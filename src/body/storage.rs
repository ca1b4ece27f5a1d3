//! How a host stores the entries of a stiffness matrix, and how far that may be from symmetric.

use crate::error::Error;

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

/// How far `K_ij` and `K_ji` may be apart, given the square roots of their diagonal entries.
pub(super) fn may_differ(tolerance: f64, root_i: f64, root_j: f64) -> f64 {
    tolerance * root_i * root_j
}

/// `lonely`: one of the two rows has nothing beside its diagonal.
pub(super) fn unsymmetric(lonely: bool, (i, j): (usize, usize), difference: f64, limit: f64) -> Error {
    let what = if lonely {
        "an identity row meets a full column: eliminate supports symmetrically".to_owned()
    } else {
        format!("|K_ij - K_ji| = {:.1e} exceeds {limit:.1e}: the matrix is not symmetric", difference.abs())
    };
    Error::argument("val", what).row(i).dof(j).value(difference.abs()).limit(limit)
}
