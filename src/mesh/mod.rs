//! Bodies given by elements: the unknowns of the elements, the cut of a body into pieces, the matrices of the pieces.

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
