//! What the pivot says at which a factorisation has ended.

use crate::error::{Error, Kind};
use crate::linalg::Breakdown;

/// A pivot below minus this, relative to its diagonal entry, is no rounding error: a(u, u) >= 0 of (4) is violated.
const NEGATIVE_PIVOT: f64 = 1e-10;

impl Breakdown {
    /// The error for a pivot so negative that K is indefinite.
    pub(super) fn refused(&self) -> Option<Error> {
        (self.relative_pivot < -NEGATIVE_PIVOT).then(|| self.indefinite())
    }

    pub(super) fn indefinite(&self) -> Error {
        let what = format!("the stiffness matrix is indefinite: pivot {:.1e} K_ii", self.relative_pivot);
        Error::new(Kind::Indefinite, what).dof(self.dof).value(self.relative_pivot).limit(0.0)
    }
}
