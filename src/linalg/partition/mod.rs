//! Parts of a graph with few edges between them, found on successively coarser graphs: halves for the cut of a body (`mesh`),
//! and for the separators of nested dissection (`cholesky`).

pub mod bisection;
pub mod levels;
pub mod weighted;

pub use weighted::Weighted;

/// No vertex, part or piece.
pub const NONE: u32 = u32::MAX;

const WHAT: &str = "the graph of a body";
