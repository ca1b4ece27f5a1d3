//! The input of a problem, to look at: as the library holds it, which is what a problem file has.

use std::borrow::Cow;

use crate::body::Body;
use crate::constraints::{Friction, RowKind, RowSet};
use crate::error::Result;
use crate::linalg::Symmetric;
use crate::solver::Problem;

/// A body as the host has given it.
pub struct Given<'a> {
    pub body: &'a Body,
    /// The lower triangle of K, of a body in pieces their sum; none if the host keeps it, or has not given it.
    pub k: Option<Cow<'a, Symmetric>>,
    /// Pieces into which it is cut; 1 if it is not cut.
    pub pieces: usize,
    /// Its unknowns have numbers of the host.
    pub numbered: bool,
}

impl Problem {
    /// What a body was given.
    pub fn given(&self, body: usize) -> Result<Given<'_>> {
        let given = self.model.given(body)?;
        let (whole, cut) = (given.body.stiffness.as_deref().map(Cow::Borrowed), given.body.assembled());
        let sum = cut.map(|k| k.sum().map(Cow::Owned)).transpose()?;
        Ok(Given {
            body: &given.body,
            k: whole.or(sum),
            pieces: cut.map_or(1, |k| k.pieces().len()),
            numbered: given.numbers.is_some(),
        })
    }

    /// The rows of one kind; their unknowns count through all bodies. Tangential rows have `s_old` as right-hand sides.
    pub fn given_rows(&self, kind: RowKind) -> &RowSet {
        self.model.rows(kind)
    }

    /// The nodes with friction.
    pub fn given_friction(&self) -> &Friction {
        &self.model.friction
    }
}
