//! Option `method` = paper-...: the paper's own methods in its notation, Algorithm 1 for bounds only and Algorithm 3 for bounds and
//! equalities. They keep the form of the paper, for its readers and as a baseline; the default is `qp/proportioning/` of the
//! library.
//!
//! | paper | file |
//! |---|---|
//! | (20) theta(x), L(x, mu, rho) | `quadratic.rs` |
//! | (21)-(23) active set, g^I, g^C; proportional points | `qp/gradient.rs` of the library |
//! | Algorithm 1 | `bound.rs` |
//! | conjugate gradients for min theta(y), y in W_I | `face.rs` |
//! | feasible, monotone and extrapolating proportioning | `variants.rs` |
//! | (24)-(25), Algorithm 3 | `augmented_lagrangian.rs` |
//! | reference values of rho_0, M and eta_0 | `sizes.rs` |
//! | options `paper_...` | `options.rs`, `host_units.rs` |

mod augmented_lagrangian;
mod bound;
mod face;
mod host_units;
mod options;
mod quadratic;
mod sizes;
mod variants;

pub use augmented_lagrangian::algorithm_3;
pub use bound::{PaperRule, Point, Proportioning};
pub use quadratic::Quadratic;
pub use variants::Variant;

use feti_contact::error::Result;
use feti_contact::qp::{AcceptanceTest, Observer, Qp, Solution};
use feti_contact::solver::{DualMethod, HostForm, Settings};

use host_units::HostUnits;

/// Algorithm 3, as a `feti_contact::solver::Problem` takes it by `offer_method`.
pub struct Paper;

impl DualMethod for Paper {
    fn is_in_units_of_host(&self, settings: &Settings) -> bool {
        options::parameters(settings).units == Units::Printed
    }

    fn solve(
        &self,
        settings: &Settings,
        qp: Qp,
        form: Option<&HostForm>,
        start: &[f64],
        judge: &mut dyn AcceptanceTest,
        observer: &mut dyn Observer,
    ) -> Result<Solution> {
        let parameters = options::parameters(settings);
        match form {
            Some(form) => HostUnits { parameters, form }.solve(qp, start, judge, observer),
            None => algorithm_3(Qp { preconditioner: None, ..qp }, start, &parameters, judge, observer),
        }
    }
}

/// The parameters of Algorithm 3 in their printed symbols, and of Algorithm 1 within it.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Parameters {
    /// alpha, 0 < alpha < 1: eta_{k+1} = alpha eta_k.
    pub alpha: f64,
    /// beta > 1: rho_{k+1} = beta rho_k.
    pub beta: f64,
    /// rho_0 > 0.
    pub rho_0: f64,
    /// eta_0 > 0.
    pub eta_0: f64,
    /// M > 0 of `|g^P| <= M |D x - d|`; none: rho_0 / 100.
    pub m: Option<f64>,
    /// Every entry of mu^0.
    pub mu_0: f64,
    /// Limit of problems with bounds only.
    pub outer: usize,
    pub rule: PaperRule,
    pub units: Units,
    pub step_1: StepOne,
    /// Projected gradient and `|D x - d|` are sufficiently small (Step 2) below this part of the reference chosen by
    /// `units`.
    pub tolerance: f64,
    /// Limit of steps of Algorithm 1, over all problems.
    pub steps: usize,
}

/// Condition for the end of Step 1 of Algorithm 3.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum StepOne {
    /// `|g^P| <= M |D x - d|`.
    Printed,
    /// As printed, but after `|D x - d|` is sufficiently small, `|g^P|` must also be.
    Corrected,
}

/// Units of the numbers in `Parameters`.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Units {
    /// rho_0 in |A| / |D|^2, M in |A| / |D|, eta_0 in the size of d, mu^0 in the size of b / |D|: the iteration does not
    /// depend on the units of force and length or on the basis R.
    Relative,
    /// As printed: absolute numbers, and Step 2 relative to |b| and |d|.
    Printed,
}
