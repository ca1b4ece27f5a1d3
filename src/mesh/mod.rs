//! Bodies that are given by their elements: how one is cut into pieces.

mod cut;

pub use cut::{cut, pieces_for, Elements};
