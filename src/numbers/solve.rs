//! What follows the iteration (S4, S9 to S14).

/// Amplitudes of motions with negative stiffness that differ by less have settled.
pub const SETTLED: f64 = 1e-11;
/// Part of the energy norm of the forces that jumps between pieces may have, in units of the limit of equilibrium.
pub const JUMPS: f64 = 0.3;
/// Factor over all demands, loads and what they cause, from which a motion proves that no answer exists. `tests/proofs`.
pub const BEYOND: f64 = 1e6;
/// Minimum of the search for a contradiction, relative to 1, that is looked into: the square of 1 / 1e3.
pub const MAY_CONTRADICT: f64 = 1e-6;
/// Factor from gaps to the displacements of which they may be differences. `tests/proofs`.
pub const TRAVELLED: f64 = 1e3;
/// Smallest load that is distinguished, relative to the largest (S11.1).
pub const LOAD_RANGE: f64 = 1e-7;
/// Part of a free motion that is more than rounding.
pub const FREE_PART: f64 = 1e-6;
/// Ratios of the certificate, 1 allowed, that are rounding (S13).
pub const RATIO_ROUNDING: f64 = 1e-4;
/// Ratio to the one before that is much better (S13.3).
pub const MUCH_BETTER: f64 = 0.5;
/// Ratio to the one before that is no worse.
pub const NO_WORSE: f64 = 1.1;
/// Deformation of the neighbours relative to a body's own, from which its errors are looked at.
pub const UNEVEN_DEFORMATION: f64 = 100.0;
/// Force relative to those on its bodies that may be rounding if the load does no work along what it holds (S12.1).
pub const SMALL_FORCE: f64 = 1e-6;
/// Energies that are equal, relative to their terms.
pub const SAME_ENERGY: f64 = 1e-9;
/// Gaps of parallel rows that are equal, relative to them (S4.2).
pub const EQUAL_GAPS: f64 = 1e-10;
/// Factor by which a motion exceeds the deformation, or a gap all motion, from which a body slides, or the gap is far (S4.5, S12).
pub const FAR: f64 = 1e4;
/// The factor with friction, where gaps of open rows enter the scale of the laws.
pub const FAR_WITH_FRICTION: f64 = 1e2;
/// Motion of a row relative to what its fastest unknown could cause, from which it moves.
pub const STILL: f64 = 1e-9;
/// The same for a closed row, known to the tolerance of a method.
pub const CLOSED_MOVES: f64 = 1e-5;
/// Inverse compliance of rows of a sparse face, in stiffnesses of their stiffest unknown (S13.2). A glued cantilever: 1e6 leaves
/// 5e-4 after 6 corrections, 1e3 leaves 3e-10 after 3.
pub const STIFFER: f64 = 1e3;
/// Part of that compliance that rows of the interior point method keep (S13.6): forces of nearly dependent rows settle slowly.
pub const LEAST_COMPLIANCE: f64 = 1e-6;
/// Sparse factorisations in the price of a step while the iteration runs (S10): a few sets.
pub const SET_FACTORS: f64 = 4.0;
/// The same with an interior point. Beams on 1100 to 4000 springs: .019 to .091 s instead of .13 to 1.07 s.
pub const INTERIOR_FACTORS: f64 = 16.0;
