//! The plan of a body from what the host has given, on whatever rank the body is.

use std::sync::Arc;

use crate::body::digits::Digits;
use crate::body::generalized_inverse::GeneralizedInverse;
use crate::body::null_space::Modes;
use crate::body::pilots::{Carried, Pilots};
use crate::body::plan::Plan;
use crate::body::stiffness::check_diagonal;
use crate::body::Body;
use crate::error::{Error, Kind, Result};
use crate::linalg::Multiple;
use crate::ranks::{wire_struct, Wire};

/// What a plan needs beside the data of the host.
pub struct Planning {
    /// Unknowns that rows carry.
    pub carried: Option<Carried>,
    /// Option null_space_tolerance.
    pub tolerance: f64,
    /// A piece of a body that is cut.
    pub is_piece: bool,
}

wire_struct!(Planning { carried, tolerance, is_piece });

/// The matrix, and what the host has told of its null space.
impl Wire for Body {
    fn put(&self, to: &mut Vec<u8>) {
        self.order.put(to);
        self.stiffness.put(to);
        self.null_space.put(to);
        self.coordinates.put(to);
        self.coordinate_modes.put(to);
        self.fixing.put(to);
    }

    fn take(from: &mut &[u8]) -> Result<Self> {
        Ok(Self {
            order: Wire::take(from)?,
            stiffness: Wire::take(from)?,
            null_space: Wire::take(from)?,
            coordinates: Wire::take(from)?,
            coordinate_modes: Wire::take(from)?,
            fixing: Wire::take(from)?,
            ..Self::default()
        })
    }
}

impl Body {
    /// Null space and fixing dofs, found before any factorisation. Only now is it known whether its motions are soft.
    pub fn plan(&self, with: Planning) -> Result<Plan> {
        self.planned(with).map_err(|error| self.explained(error))
    }

    /// If a null space comes from coordinates, its error says so: the coordinates may be wrong.
    pub fn explained(&self, mut error: Error) -> Error {
        let only = self.null_space.is_none() && self.coordinates.is_some();
        if only && error.kind == Kind::NullSpace && !error.what.contains("of these coordinates") {
            error.what =
                format!("the coordinates, from which the null space comes, may be wrong: {}", error.what);
        }
        let entries = self.stiffness.as_deref().filter(|_| error.kind == Kind::Indefinite);
        if let Some(digits) = entries.and_then(|k| Digits::of_rounded(k, Digits::TOLD)) {
            error.what =
                format!("{}; the entries of K have {digits}: rounding may have made it so", error.what);
        }
        error
    }

    fn planned(&self, Planning { carried, tolerance, is_piece }: Planning) -> Result<Plan> {
        let missing = || Error::new(Kind::Internal, "a body without stiffness was set up");
        let matrix = Arc::clone(self.stiffness.as_ref().ok_or_else(missing)?);
        if !self.has_soft_motions() {
            check_diagonal(&matrix)?;
        }
        let pilots = carried.map(|carried| Pilots::of(&carried, &matrix)).transpose()?;
        let k = Multiple { matrix, by: 1.0 / self.unit() };
        match pilots {
            Some(pilots) if pilots.are_all() => Plan::of_pilots(k, pilots),
            pilots => self.own_plan(k, tolerance, is_piece)?.with_pilots(pilots),
        }
    }

    /// Without unknowns that rows carry.
    fn own_plan(&self, k: Multiple, tolerance: f64, is_piece: bool) -> Result<Plan> {
        let fixing = self.fixing.as_deref();
        if let Some(given) = &self.null_space {
            let planned = GeneralizedInverse::plan_with(k, given, tolerance, fixing)?;
            return Ok(if given.modes == Modes::Soft { planned } else { planned.or_search(tolerance, true) });
        }
        let Some(coordinates) = &self.coordinates else {
            return GeneralizedInverse::search(k, tolerance, fixing);
        };
        let rigid = coordinates.rigid_modes(|i| k.matrix.diagonal(i) > 0.0)?;
        let planned = match self.coordinate_modes {
            Modes::Soft => GeneralizedInverse::plan_soft(k, &rigid, fixing)?,
            modes => GeneralizedInverse::plan_near(k, &rigid, modes, tolerance, fixing)?,
        };
        if is_piece {
            return Ok(planned.or_search(tolerance, false).carrying(rigid));
        }
        Ok(planned)
    }
}
