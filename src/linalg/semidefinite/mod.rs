//! Systems `W x = b` that may be singular, as those of the coarse space: W positive semidefinite, x of minimum norm.

pub mod dense;
mod resisted;
pub mod sparse;
