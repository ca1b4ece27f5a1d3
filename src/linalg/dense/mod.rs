//! Dense matrices and their decompositions.

pub mod matrix;
pub mod packed;
pub mod pivoted;
pub mod spectrum;
