//! What is known about one body.

use crate::body::{Doubt, Modes};
use crate::error::{Error, Kind, Result};
use crate::linalg::graph;
use crate::linalg::Symmetric;
use crate::platform::memory::headroom;
use crate::setup::Duals;
use crate::solver::problem::Problem;

/// What the null space of a body comes from.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Origin {
    /// Vectors of the host that span it.
    Given,
    /// Vectors of the host among which it was sought.
    Candidates,
    /// Rigid motions from the coordinates of the host.
    Coordinates,
    /// The matrix alone.
    Found,
}

/// A body as it is given, and what the last setup made of it.
#[derive(Debug, Clone, PartialEq)]
pub struct BodyFacts {
    pub unknowns: usize,
    /// Entries of K as the host gave them.
    pub entries: Option<usize>,
    /// Connected parts of K.
    pub components: Option<usize>,
    /// Bytes that the library keeps for K.
    pub matrix_bytes: usize,
    /// Values and columns of K lie with the host.
    pub borrowed: [bool; 2],
    pub origin: Origin,
    pub factors: Option<Factors>,
    /// Bytes of the dual operator; none of one that is known by its products.
    pub operator: Option<Option<usize>>,
    /// Estimated relative error of the forces on the body in the last answer, no unit; none without one.
    pub force_error: Option<f64>,
}

/// Null space and factor of a body.
#[derive(Debug, Clone, PartialEq)]
pub struct Factors {
    /// Dimension of the null space.
    pub null_space: usize,
    /// Of a null space that was found: the softest other motion against the stiffest of it.
    pub gap: Option<f64>,
    /// Motions that may be resisted by nothing but the rounding of the entries of K.
    pub doubts: Vec<Doubt>,
    pub entries: usize,
    pub bytes: usize,
    /// The first other body with this factor.
    pub shared_with: Option<usize>,
}

impl Factors {
    /// Motions that may be resisted by nothing but the rounding of the entries of K, taken as free or as supports.
    pub fn soft(&self, free: bool) -> usize {
        self.doubts.iter().filter(|doubt| doubt.free == free).map(|doubt| doubt.motions).sum()
    }
}

impl Problem {
    /// The connected part of every unknown of a body, numbered by their first unknowns, and their number. Entries that
    /// are 0 connect nothing.
    pub fn components(&self, body: usize) -> Result<(Vec<usize>, usize)> {
        const PER_DOF: usize = 2 * size_of::<usize>();
        let missing = || Error::new(Kind::State, "the stiffness matrix has not been given").body(body);
        let k = self.model.given(body)?.body.stiffness.as_ref().ok_or_else(missing)?;
        let _room = headroom(k.order() * PER_DOF, "the connected parts of a body")?;
        Ok(graph::components(k))
    }

    pub fn body_facts(&self, body: usize) -> Result<BodyFacts> {
        let given = self.model.given(body)?;
        let n = given.body.order;
        let k = given.body.stiffness.as_deref();
        let components = k.map(|_| self.components(body)).transpose()?.map(|(_, number)| number);
        let origin = match (&given.body.null_space, &given.body.coordinates) {
            (Some(r), _) if r.modes == Modes::Candidates => Origin::Candidates,
            (Some(_), _) => Origin::Given,
            // where coordinates did not fit
            (None, _)
                if self.prepared.inverse(&self.model, body).is_some_and(|of| of.kplus.misfit.is_some()) =>
            {
                Origin::Found
            }
            (None, Some(_)) => Origin::Coordinates,
            (None, None) => Origin::Found,
        };
        let operator = self.prepared.duals(&self.model).map(|Duals { operators, .. }| {
            (!operators.implicit[body]).then(|| operators.sizes[body].bytes(false))
        });
        Ok(BodyFacts {
            unknowns: n,
            entries: given.form.as_ref().map(|form| form.entries(n)),
            components,
            matrix_bytes: k.map_or(0, Symmetric::bytes),
            borrowed: k.map_or([false; 2], |k| [k.val.is_of_host(), k.col.is_of_host()]),
            origin,
            factors: self.factors_of(body),
            operator,
            force_error: self.current().map(|current| current.answer.force_errors[body]),
        })
    }

    fn factors_of(&self, body: usize) -> Option<Factors> {
        let inverse = |p: usize| self.prepared.inverse(&self.model, p);
        let of = inverse(body)?;
        let address = |p: usize| inverse(p).map(|of| of.kplus.factor_address());
        Some(Factors {
            null_space: of.kplus.null_space.cols,
            gap: of.kplus.gap,
            doubts: of.kplus.doubts.clone(),
            entries: of.kplus.entries(),
            bytes: of.bytes,
            shared_with: (0..self.model.bodies.len()).find(|&p| p != body && address(p) == address(body)),
        })
    }
}
