//! Symbolic analyses and what they depend on besides the pattern of K.

use std::sync::Arc;

use crate::error::Result;
use crate::linalg::Analysis;
use crate::ranks::Wire;

/// The input of a symbolic analysis besides the pattern of K. Bodies with the same pattern and layout share one analysis.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum Layout {
    /// The dofs held.
    Held(Vec<usize>),
    /// Dofs that are eliminated last.
    Last(Vec<usize>),
}

/// A symbolic analysis and its layout.
pub struct Symbolic {
    pub layout: Arc<Layout>,
    pub analysis: Arc<Analysis>,
}

impl Wire for Layout {
    fn put(&self, to: &mut Vec<u8>) {
        let (held, dofs) = match self {
            Self::Held(dofs) => (true, dofs),
            Self::Last(dofs) => (false, dofs),
        };
        held.put(to);
        dofs.put(to);
    }

    fn take(from: &mut &[u8]) -> Result<Self> {
        let of = if bool::take(from)? { Self::Held } else { Self::Last };
        Ok(of(Vec::take(from)?))
    }
}
