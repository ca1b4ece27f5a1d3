//! Iteration (P1 to P13), projection and coarse problem (J1 to J4). Counts of products: 38 decks together, and thousands on 3000
//! hard problems; 554 and 296 with the values given.

/// Error of alpha, relative to the remainder of v, that takes another solution. Without it a tower of 1000 blocks does not
/// converge.
pub const ERROR_OF_ALPHA: f64 = 0.1;
/// Entries of free motions that are rounding, in units of that of G.
pub const DROP: f64 = 16.0;
/// Residual at which the interior point method ends, relative to the terms of the equations.
pub const INTERIOR_ACCURACY: f64 = 1e-7;
/// Forces times their multipliers at its end, relative to squared forces.
pub const COMPLEMENTARITY: f64 = 1e-12;
/// Part of its step to the next bound.
pub const CLOSE: f64 = 0.995;
/// Part of the distance that must be left for another pass of the nearest point (S4, S6, S12).
pub const DISTANCE_FALLS: f64 = 0.999;
/// Part of a Newton step of the projection (J2) at which it counts as cut.
pub const CUT_STEP: f64 = 0.9;
/// Accuracy of the projection, relative to |e| + |G||l|. Measured: 1e-10: 554, 302; 1e-14: 554, 371.
pub const PROJECTED: f64 = 1e-12;
/// Accuracy that is accepted if no step improves it.
pub const STAGNATED: f64 = 1e-10;
/// Residual relative to |e| + |G||y| up to which e is balanced.
pub const BALANCED: f64 = 1e-6;
/// Error of an updated gradient before the first measurement, relative to the updates (P0).
pub const FIRST_DRIFT: f64 = 1e-5;
/// Factor on measured errors of the gradient.
pub const DRIFT_SAFETY: f64 = 4.0;
/// Error of the gradient relative to the residual from which it is computed again. Two blocks of 144k: 3 times in 37 products.
pub const DRIFT_FELT: f64 = 0.1;
/// Free motions relative to all others from which only rounding holds the load (P10).
pub const FAR_AWAY: f64 = 1e6;
/// Contact forces that are 0, relative to the largest (P11).
pub const NO_FORCE: f64 = 1e-15;
/// Entries of a direction without curvature that are 0, relative to the largest (P5): it would always end far away.
pub const FLAT_ENTRY: f64 = 1e-10;
/// Part of a step within which a bound is worth a projection and another product (P6). Measured: .01: 554, 308; 1: 556, 357.
pub const CUT_SHORT: f64 = 0.1;
/// Part of a direction that must be left beside the kept ones (P3). Measured: 1e-5: 554, 286; 1e-9: 554, 296.
pub const LOST: f64 = 1e-7;
/// Steps relative to x that are kept (P7.3): rounding moves shorter ones out of ker G. Measured: 1e-4: 554, 310; 1e-8: 554, 324.
pub const SHORT_STEP: f64 = 1e-6;
/// L relative to the largest curvature so far.
pub const CURVATURE_MARGIN: f64 = 1.1;
/// Length of gradient projection, in 1 / L (P10): theta falls below 2. Measured: .75: 554, 296; 1.9: 554, 278.
pub const GRADIENT_STEP: f64 = 1.5;
/// Ratio of a refusal that further steps may correct (P1.3).
pub const MISSED: f64 = 1e3;
/// Part of the previous violation above which a refusal does not depend on the residual (P1.2). Layers of 1:1e6 in 8 pieces: 45
/// products instead of 1205.
pub const STAYS: f64 = 0.5;
/// Part of the residual that a refusal demands next (P1.3).
pub const BY_MISSED: f64 = 0.4;
/// Factor on tolerances after a refusal (P1.4).
pub const TIGHTER: f64 = 0.1;
