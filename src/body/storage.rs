//! The storage formats of a stiffness matrix, and the permitted difference of its transposed entries.

use crate::error::Error;

/// Which entries the host gives.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Storage {
    Full,
    Lower,
    Upper,
}

/// A matrix by rows as given: `ptr` has n + 1 nondecreasing entries from 0, columns count from 0 in any order within a
/// row.
#[derive(Debug, Clone, Copy)]
pub struct SparseInput<'a> {
    pub ptr: &'a [usize],
    pub col: &'a [i64],
    pub val: &'a [f64],
    pub storage: Storage,
}

/// The permitted difference of `K_ij` and `K_ji`, from the square roots of their diagonal entries.
pub(super) fn may_differ(tolerance: f64, root_i: f64, root_j: f64) -> f64 {
    tolerance * root_i * root_j
}

/// What a matrix in full storage may be if it is not symmetric.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Shape {
    /// All off-diagonal entries are on one side of the diagonal: the triangle of that storage.
    Triangle(Storage),
    /// One of the two rows has only a diagonal entry.
    Lonely,
    Neither,
}

const SUPPORT: &str = "an identity row meets a full column: eliminate supports symmetrically";

/// In a triangle of two unknowns, the other possible reason is a support that was not eliminated in the other row.
pub(super) fn unsymmetric(
    shape: (Shape, usize),
    (i, j): (usize, usize),
    difference: f64,
    limit: f64,
) -> Error {
    let what = match shape {
        (Shape::Triangle(storage), n) => {
            let (side, name) = match storage {
                Storage::Upper => ("above", "FETI_UPPER"),
                Storage::Lower | Storage::Full => ("below", "FETI_LOWER"),
            };
            let or = if n > 2 { String::new() } else { format!("; or {SUPPORT}") };
            format!("all entries beside the diagonal are {side} it: give this triangle with {name}, not with FETI_FULL{or}")
        }
        (Shape::Lonely, _) => SUPPORT.to_owned(),
        (Shape::Neither, _) => {
            format!(
                "|K_ij - K_ji| = {:.1e} exceeds {limit:.1e}: the matrix is not symmetric",
                difference.abs()
            )
        }
    };
    Error::argument("val", what).row(i).dof(j).value(difference.abs()).limit(limit)
}
