//! Motions that were given, of which not all are null vectors.

use std::fmt;

use crate::numbers::body::RESISTED;
use crate::ranks::wire_struct;

/// Rigid motions of coordinates, or candidates, of which not all fit K, or which are not all motions of K.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Misfit {
    pub fit: usize,
    pub of: usize,
    /// The least `|D^-1 K v|` of a unit vector v among the others.
    pub next: f64,
}

wire_struct!(Misfit { fit, of, next });

impl fmt::Display for Misfit {
    fn fmt(&self, out: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self { fit, of, next } = self;
        if fit == of {
            return write!(
                out,
                "the {of} rigid motions of these coordinates fit K, which has others, as of a hinge"
            );
        }
        write!(out, "{fit} of {of} rigid motions of these coordinates fit K, the next leaves |K R| = {next:.1e} |D||R|")
    }
}

impl Misfit {
    /// What K holds, if some motions float or if it holds a motion by less than its stiffness elsewhere.
    pub fn held(&self) -> Option<String> {
        let Self { fit, of, next } = self;
        (*fit > 0 || *next < RESISTED).then(|| {
            format!(
                "{fit} of {of} rigid motions float, {} held by K, the softest by |K R| = {next:.1e} |D||R|",
                of - fit
            )
        })
    }
}
