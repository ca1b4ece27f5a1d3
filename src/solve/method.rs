//! A method of another crate for the dual problem, in place of the library's own, and the form of the dual that it may ask for.

use std::ops::Range;

use crate::error::{Error, Kind, Result};
use crate::linalg::Matrix;
use crate::model::{Method, Settings};
use crate::qp::{AcceptanceTest, Observer, Qp, Solution};

/// A method for the dual problem (12)-(13), used where option `method` is not `proportioning`.
pub trait DualMethod: Sync {
    /// Whether it needs the [`HostForm`]. Then it sees all rows, also those with gaps too large to be reached.
    fn is_in_units_of_host(&self, settings: &Settings) -> bool;
    /// Solves the dual as the library scales it, from x = `start`. Its points count as solved once `judge` accepts them.
    ///
    /// # Errors
    /// Those of the operator, of `judge` and of `observer`, but for a stop, which is a verdict.
    fn solve(
        &self,
        settings: &Settings,
        qp: Qp,
        form: Option<&HostForm>,
        start: &[f64],
        judge: &mut dyn AcceptanceTest,
        observer: &mut dyn Observer,
    ) -> Result<Solution>;
}

/// How the dual of the library comes from that of the host: `x_i = lambda_i / (s_i 2^p)`, `R_host = R T`.
pub struct HostForm {
    /// 2^p, stiffness.
    pub unit: f64,
    /// s_i of every group of rows, 1 of springs of bodies.
    pub scale: Vec<f64>,
    /// T of every body, and the range of its modes.
    pub basis: Vec<(Range<usize>, Matrix)>,
}

/// The method that the options ask for, if it is not the library's own.
pub fn chosen<'a>(
    settings: &Settings,
    offered: Option<&'a dyn DualMethod>,
) -> Result<Option<&'a dyn DualMethod>> {
    if settings.method == Method::Proportioning {
        return Ok(None);
    }
    let missing = || Error::new(Kind::State, "option method names a method that this program does not offer");
    offered.map(Some).ok_or_else(missing)
}
