//! Dense matrices and their decompositions.

pub mod growing;
pub mod least_squares;
pub mod matrix;
pub mod packed;
pub mod pivoted;
pub mod spectrum;
