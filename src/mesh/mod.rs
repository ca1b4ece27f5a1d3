//! Bodies given by elements: which unknowns an element joins, how a body is cut into pieces, the matrices of the pieces.

mod connectivity;
mod cut;
mod elements;
mod held;
mod pattern;
mod piece;

pub use connectivity::Connectivity;
pub use cut::{cut, pieces_for, Elements};
pub use elements::{ElementMatrix, ElementStorage, Mesh};
pub use piece::Piece;
