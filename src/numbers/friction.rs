//! Newton's method for friction, its path, slides and loads that nothing holds.

/// Merit relative to the scale at which an answer may be as accurate as rounding allows.
pub const NEAR: f64 = 1e-7;
/// Tolerance from which every power of ten more allows one more refusal.
pub const FINE: f64 = 1e-12;
/// Resistance of weighted rows, relative to |G|, below which motions are free: its square is the limit of A w^2 A'.
pub const FREE_MOTIONS: f64 = 3e-6;
/// Residual of a projection that is accepted, relative to |e| + |G||y|.
pub const PROJECTION_ACCEPTED: f64 = 1e-8;
/// First shift of a projection, relative to the diagonal of G G': cones leave a singular part.
pub const FIRST_SHIFT: f64 = 1e-6;
/// Factor on the shift after a full step.
pub const SHIFT_LESS: f64 = 0.1;
/// Factor after a short step.
pub const SHIFT_MORE: f64 = 10.0;
/// Part of a step that is short.
pub const SHIFT_SHORT: f64 = 0.1;
/// Armijo's factor on the slope.
pub const ARMIJO: f64 = 1e-4;
/// Shortest step of a projection.
pub const SHORTEST_PROJECTION_STEP: f64 = 1e-10;
/// Multipliers relative to the data beyond which phi falls without end.
pub const ENDLESS: f64 = 1e14;
/// rho, by which forces and lengths are compared: rows have the compliance b K_d^-1 b' + C = 1.
pub const RHO: f64 = 0.2;
/// Part of the linear residual at which a model is solved: a step is taken even if the merit rises.
pub const MODEL_SOLVED: f64 = 1e-2;
/// Part of t by which a step of length t must reduce the merit.
pub const NEWTON_FALLS: f64 = 0.01;
/// Part of its best value to which the merit must fall; else the method cycles.
pub const CYCLING: f64 = 0.8;
/// First eps of the path, relative to the largest force.
pub const FIRST_EPS: f64 = 0.3;
/// Factor on eps after a full step.
pub const EPS_SHRINKS: f64 = 0.5;
/// Factor after a shorter step.
pub const EPS_SHRINKS_LESS: f64 = 0.6;
/// Part of the linear residual that a step of the path may leave.
pub const PATH_LEFT: f64 = 0.3;
/// Part of t by which a step of the path must reduce the residual.
pub const PATH_FALLS: f64 = 0.1;
/// Shortest step of the path.
pub const SHORTEST_PATH_STEP: f64 = 1e-4;
/// First stiffness of the supports of a slide, where rows have the compliance 1 and motions |G_p| = 1.
pub const STIFFEST: f64 = 1e-3;
/// Factor from one support to the next.
pub const WEAKER: f64 = 0.1;
/// Last stiffness, and the accuracy of its forces.
pub const WEAKEST: f64 = 1e-9;
/// Change of the forces of supports, relative to them, that shows a slide; their limit, relative to them, that shows a rest.
pub const SLIDE_OR_REST: f64 = 0.05;
/// Gap rates of rows with forces, and forces across the slip, relative to the largest, in a steady slide.
pub const STEADY: f64 = 1e-2;
/// Smaller weights are those of held values, against infinite dampings.
pub const SMALLEST_WEIGHT: f64 = 1e-100;
/// Merit that counts as zero, in missed balances of the start divided by rho.
pub const MISSED_BALANCE: f64 = 4.0;
/// First delta, relative to the diagonal of G G' (S6.2).
pub const FIRST_DELTA: f64 = 1.0;
/// Factor on delta; its root where Newton's method fails. Without roots 2 loads in 8000 beyond friction end inaccurate.
pub const DELTA_SHRINKS: f64 = 0.01;
/// Factor from which a smaller step is not tried.
pub const DELTA_SHRINKS_LEAST: f64 = 0.5;
/// Relative increase of coefficients, so that a load at the limit is held.
pub const WIDER: f64 = 1e-6;
/// Residual of forces that hold a load, relative to |e|.
pub const UNHELD_ACCEPTED: f64 = 1e-5;
/// Least and largest shift of a projection.
pub const SHIFTS: (f64, f64) = (1e-14, 1e-2);
/// Lengths of trial steps.
pub const TRIALS: [f64; 4] = [1.0, 0.5, 0.25, 0.1];
/// Lengths of trial steps that take no product.
pub const INNER_TRIALS: [f64; 2] = [1.0, 0.3];
/// Last eps of the short path, relative to the first: states are known, and most problems on which Newton's method cycles need
/// no more.
pub const SHORT_PATH: f64 = 1e-3;
