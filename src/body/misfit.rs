//! Coordinates whose rigid motions do not all fit K.

use std::fmt;

/// Rigid motions that do not all fit K.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Misfit {
    pub fit: usize,
    pub of: usize,
    /// The least `|D^-1 K v|` of a unit vector v among the others.
    pub next: f64,
}

impl fmt::Display for Misfit {
    fn fmt(&self, out: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self { fit, of, next } = self;
        write!(out, "{fit} of {of} rigid motions of these coordinates fit K, the next leaves |K R| = {next:.1e} |D||R|")
    }
}

/// How the null space is sought in K where K turns out to have more null vectors than rigid motions that fit.
pub(super) struct Retry {
    pub misfit: Misfit,
    pub tolerance: f64,
    pub fixing: Option<Vec<usize>>,
}
