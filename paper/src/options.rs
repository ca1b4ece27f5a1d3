//! The options of the paper's methods as parameters of Algorithm 3.

use feti_contact::solver::{Method, PaperStep1, PaperUnits, Settings};

use super::{PaperRule, Parameters, StepOne, Units, Variant};

pub fn parameters(settings: &Settings) -> Parameters {
    let whole = |n: i64| usize::try_from(n).unwrap_or(usize::MAX);
    Parameters {
        alpha: settings.paper_alpha,
        beta: settings.paper_beta,
        rho_0: settings.paper_rho_0,
        eta_0: settings.paper_eta_0,
        m: Some(settings.paper_m).filter(|m| *m > 0.0),
        mu_0: settings.paper_mu_0,
        outer: whole(settings.paper_outer),
        rule: PaperRule {
            gamma: settings.gamma,
            variant: match settings.method {
                Method::PaperFeasible => Variant::Feasible,
                Method::PaperExtrapolating => Variant::Extrapolating,
                Method::PaperMonotone | Method::Proportioning => Variant::Monotone,
            },
            extrapolation: settings.paper_extrapolation,
        },
        units: match settings.paper_units {
            PaperUnits::Relative => Units::Relative,
            PaperUnits::Printed => Units::Printed,
        },
        step_1: match settings.paper_step_1 {
            PaperStep1::Corrected => StepOne::Corrected,
            PaperStep1::Printed => StepOne::Printed,
        },
        tolerance: settings.tolerance,
        steps: whole(settings.max_steps),
    }
}
