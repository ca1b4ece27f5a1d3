//! A body of an island as whoever decides sees it.

use std::borrow::Cow;

use crate::body::elsewhere::Away;
use crate::body::local::Local;
use crate::error::{Error, Kind, Result};

/// A body of an island, here or on another rank. Whoever decides knows of it what both have.
#[derive(Clone, Copy)]
pub enum Seen<'a> {
    Here(Local<'a>),
    /// With the unknowns that rows touch.
    Away(&'a Away, &'a [u32]),
}

impl<'a> Seen<'a> {
    pub fn order(&self) -> usize {
        match self {
            Self::Here(body) => body.order(),
            Self::Away(body, _) => body.order,
        }
    }

    /// Of K.
    pub(super) fn entries(&self) -> usize {
        match self {
            Self::Here(body) => body.stiffness.entries(),
            Self::Away(body, _) => body.entries,
        }
    }

    /// The metric of dofs without stiffness, force / length.
    pub fn unit(&self) -> f64 {
        match self {
            Self::Here(body) => body.unit,
            Self::Away(body, _) => body.unit,
        }
    }

    /// The t unknowns that rows touch, ascending.
    pub fn touched(&self) -> &'a [u32] {
        match self {
            Self::Here(body) => body.touched,
            Self::Away(_, touched) => touched,
        }
    }

    /// D where rows touch, t, 0 without stiffness, force / length.
    pub fn diagonal(&self) -> Cow<'a, [f64]> {
        match self {
            Self::Here(body) => body.diagonal().into(),
            Self::Away(body, _) => Cow::Borrowed(&body.diagonal),
        }
    }

    /// The largest D, 0 without stiffness, force / length.
    pub fn stiffest(&self) -> f64 {
        match self {
            Self::Here(body) => body.stiffness.stiffest(),
            Self::Away(body, _) => body.stiffest,
        }
    }

    /// The body, if it is here.
    pub fn here(&self) -> Result<&Local<'a>> {
        match self {
            Self::Here(body) => Ok(body),
            Self::Away(..) => Err(Error::new(Kind::Internal, "a body is looked for on the wrong rank")),
        }
    }

    pub(super) fn away(&self) -> Option<&'a Away> {
        match self {
            Self::Here(_) => None,
            Self::Away(body, _) => Some(body),
        }
    }

    /// The values of a vector over its unknowns where rows touch it.
    pub fn at_rows<T: Copy>(&self, v: &[T]) -> Vec<T> {
        self.touched().iter().map(|dof| v[*dof as usize]).collect()
    }
}
