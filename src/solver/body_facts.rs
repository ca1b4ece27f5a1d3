//! What is known about one body.

use crate::body::{Doubt, Modes};
use crate::error::{Error, Kind, Result};
use crate::linalg::graph;
use crate::linalg::Symmetric;
use crate::platform::memory::room;
use crate::solver::problem::Problem;
use crate::solver::setup::Setup;

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
        let k = self.slot(body)?.body.stiffness.as_ref().ok_or_else(missing)?;
        let _room = room(k.order() * PER_DOF, "the connected parts of a body")?;
        Ok(graph::components(k))
    }

    pub fn body_facts(&self, body: usize) -> Result<BodyFacts> {
        let slot = self.slot(body)?;
        let n = slot.body.order;
        let components = match &slot.body.stiffness {
            None => None,
            Some(_) => Some(self.components(body)?.1),
        };
        let k = slot.body.stiffness.as_deref();
        let origin = match (&slot.body.null_space, &slot.body.coordinates) {
            (Some(given), _) if given.modes == Modes::Exact => Origin::Given,
            (Some(_), _) => Origin::Candidates,
            // where coordinates did not fit
            (None, _) if slot.inverse.as_ref().is_some_and(|of| of.kplus.misfit.is_some()) => Origin::Found,
            (None, Some(_)) => Origin::Coordinates,
            (None, None) => Origin::Found,
        };
        let operator = self.ready.as_ref().map(|Setup { operators, .. }| {
            (!operators.implicit[body]).then(|| operators.sizes[body].bytes(false))
        });
        Ok(BodyFacts {
            unknowns: n,
            entries: slot.form.as_ref().map(|form| form.entries(n)),
            components,
            matrix_bytes: k.map_or(0, Symmetric::bytes),
            borrowed: k.map_or([false; 2], |k| [k.val.is_of_host(), k.col.is_of_host()]),
            origin,
            factors: self.factors_of(body),
            operator,
            force_error: self.answer.as_ref().map(|answer| answer.force_errors[body]),
        })
    }

    fn factors_of(&self, body: usize) -> Option<Factors> {
        let of = self.bodies[body].inverse.as_ref()?;
        let address = |p: usize| self.bodies[p].inverse.as_ref().map(|of| of.kplus.factor_address());
        Some(Factors {
            null_space: of.kplus.null_space.cols,
            gap: of.kplus.gap,
            doubts: of.kplus.doubts.clone(),
            entries: of.kplus.entries(),
            bytes: of.bytes,
            shared_with: (0..self.bodies.len()).find(|&p| p != body && address(p) == address(body)),
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::solver::{Modes, SparseInput, Storage};

    /// Two springs that share nothing, one on the ground; the same again; a dense body.
    #[test]
    fn facts_tell_what_was_given_and_what_was_made_of_it() {
        let mut problem = Problem::new();
        let (ptr, col, val) = ([0, 1, 3, 4], [0, 0, 1, 2], [1.0, -1.0, 1.0, 2.0]);
        for _ in 0..2 {
            let body = problem.add_body(3).unwrap();
            assert_eq!(problem.components(body).unwrap_err().kind, Kind::State);
            let k = SparseInput { ptr: &ptr, col: &col, val: &val, storage: Storage::Lower };
            problem.set_stiffness(body, k).unwrap();
        }
        problem.add_body(2).unwrap();
        let before = problem.body_facts(2).unwrap();
        assert_eq!((before.entries, before.components, before.matrix_bytes), (None, None, 0));
        problem.set_stiffness_dense(2, 2, &[4.0, 0.0, 0.0, 4.0], 2, Storage::Full).unwrap();
        problem.set_null_space(2, 2, 0, &[], 2, Modes::Exact).unwrap();
        assert_eq!(problem.components(0).unwrap(), (vec![0, 0, 1], 2));
        assert_eq!(problem.body_facts(0).unwrap().factors, None);
        problem.setup().unwrap();
        let [first, second, dense] = [0, 1, 2].map(|p| problem.body_facts(p).unwrap());
        assert_eq!((first.unknowns, first.entries, first.components), (3, Some(4), Some(2)));
        assert_eq!((first.origin, first.borrowed), (Origin::Found, [false; 2]));
        let factors = first.factors.unwrap();
        assert_eq!((factors.null_space, factors.shared_with), (1, Some(1)));
        assert!(factors.gap.is_some() && factors.entries > 0 && factors.bytes > 0, "{factors:?}");
        assert_eq!(second.factors.unwrap().shared_with, Some(0));
        assert_eq!((dense.entries, dense.components, dense.origin), (Some(4), Some(2), Origin::Given));
        let factors = dense.factors.unwrap();
        assert_eq!((factors.null_space, factors.shared_with, factors.gap), (0, None, None));
        assert!(dense.operator == Some(Some(0)) && dense.matrix_bytes >= 40, "no row touches it");
        assert!(problem.body_facts(3).is_err());
    }
}
