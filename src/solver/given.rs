//! The input of a problem, to look at: as the library holds it, which is what a problem file has.

use std::borrow::Cow;

use crate::body::Modes;
use crate::constraints::{Friction, RowKind, RowSet};
use crate::error::Result;
use crate::linalg::Symmetric;
use crate::solver::Problem;

/// A body as the host has given it.
pub struct Given<'a> {
    pub unknowns: usize,
    /// The lower triangle of K, of a body in pieces their sum; none if the host keeps it, or has not given it.
    pub k: Option<Cow<'a, Symmetric>>,
    /// Pieces into which it is cut; 1 if it is not cut.
    pub pieces: usize,
    /// Motions, one after the other, and what they are; none: the library finds them.
    pub motions: Option<(&'a [f64], Modes)>,
    /// x, y, z of every unknown, and its direction: 1 to 3 along, 4 to 6 about the axes.
    pub coordinates: Option<(&'a [[f64; 3]], &'a [i32])>,
    /// What the rigid motions of the coordinates are.
    pub coordinate_modes: Modes,
    /// None: no load.
    pub load: Option<&'a [f64]>,
    pub fixing: Option<&'a [usize]>,
    /// Its unknowns have numbers of the host.
    pub numbered: bool,
}

impl Problem {
    /// What a body was given.
    pub fn given(&self, body: usize) -> Result<Given<'_>> {
        let given = self.model.given(body)?;
        let body = &given.body;
        let (whole, cut) = (body.stiffness.as_deref().map(Cow::Borrowed), body.assembled());
        let sum = cut.map(|k| k.sum().map(Cow::Owned)).transpose()?;
        Ok(Given {
            unknowns: body.order,
            k: whole.or(sum),
            pieces: cut.map_or(1, |k| k.pieces().len()),
            motions: body.null_space.as_ref().map(|of| (&of.vectors.data[..], of.modes)),
            coordinates: body.coordinates.as_ref().map(|of| (of.places(), of.directions())),
            coordinate_modes: body.coordinate_modes,
            load: body.load.as_deref(),
            fixing: body.fixing.as_deref(),
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
