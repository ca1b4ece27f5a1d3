//! The symbolic side of a factorisation: what it depends on, so that it is done once for all bodies and all values of one
//! pattern.

use std::sync::Arc;

use crate::linalg::Analysis;

/// What the analysis of a body depends on besides the pattern of K.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum Layout {
    /// Dofs that are held.
    Held(Vec<usize>),
    /// Dofs of every connected part that are eliminated last, and the entries of K between parts, which are 0 and left
    /// out.
    Last { dofs: Vec<Vec<usize>>, between: Vec<usize> },
}

/// A symbolic analysis with what it was made for.
pub struct Symbolic {
    pub layout: Arc<Layout>,
    pub analysis: Arc<Analysis>,
}
