//! Bodies: null spaces, generalised inverses, digits of K (S2).

/// Length that a motion must keep beside the null vectors to be another motion.
pub const BESIDE_NULL: f64 = 1e-6;
/// Compliances L'T, in units of 1 / K_ii, from which motions are carried. All motions of a cube of 4^3 elements have 8 and
/// more, no motion of a thin layer held on a whole face more than 2.
pub const CARRIED: f64 = 4.0;
/// Part of the off-diagonal entries that must need the last digits, for K to have that many: 99 of 100 rounded numbers do,
/// but meshes and frames have round numbers, too.
pub const LAST_DIGITS_USED: f64 = 0.4;
/// Part of the rows that must sum to 0, for the entries of K to be exact.
pub const ROWS_SUM_TO_0: f64 = 0.9;
/// Rounding of a pivot that cancels, in roundings of one entry.
pub const PIVOT_ROUNDING: f64 = 10.0;
/// Smallest singular value of the host's fixed unknowns, relative to that of the best ones, from which they are used. K+ grows
/// with its inverse square: one digit.
pub const AS_WELL: f64 = 0.3;
/// The limit below which fixed unknowns are replaced where K is indefinite: three digits.
pub const LOOSE: f64 = 0.03;
/// Factor on the tolerance of rigid motions, since terms of their combinations may cancel.
pub const MIXED: f64 = 16.0;
/// A skew or negative part of K, or a negative pivot, relative to the diagonal, that is no rounding.
pub const NEGATIVE: f64 = 1e-10;
/// |D^-1 K v| relative to |v| from which a motion is resisted like any other.
pub const RESISTED: f64 = 0.1;
/// Largest error of a null vector, relative to its mean error.
pub const PEAK: f64 = 8.0;
/// Squares of larger numbers overflow.
pub const LARGEST: f64 = 1e150;
/// A random vector has the part 1 / n^1/2 along a direction, and not less by this factor.
pub const UNLIKELY: f64 = 1e3;
/// Residual of a solution with K+ relative to its terms: more is a defect.
pub const PROBE: f64 = 1e-8;
/// Error of R relative to what |K+ K R| shows of it.
pub const SAMPLE: f64 = 16.0;
/// Largest error of R that counts as rounding, relative to its fastest unknown.
pub const MOST_ERROR: f64 = 1e-7;
/// Largest part of a row or of a load that counts as rounding, however inaccurate R is.
pub const MOST_ROUNDING: f64 = 1e-9;
/// Rounding of K, in eps, that null vectors do not follow. 1 and 64 leave twice as many wrong answers of bodies with parts of
/// different stiffness.
pub const SHARPENING: f64 = 8.0;
/// What may be left of a motion after its rigid part, relative to it.
pub const RIGID: f64 = 1e-6;
/// Error that one correction with L in single precision may leave, relative to the error before.
pub const SHARE: f64 = 1e-3;
/// Part of the residual that a correction leaves where it has reached rounding.
pub const REACHED_ROUNDING: f64 = 0.25;
/// Squared pivots below this lose digits in single precision.
pub const TINY: f64 = 1e-60;
/// Roundings of a load at which corrections stop: they reach 2.5 on cubes of 144 thousand unknowns, and another correction none.
pub const ROUNDINGS: f64 = 4.0;
/// As many times this may be missed: 64 as for sums. Of a random load at least 1e-10 lies along a missing motion.
pub const CONVERGED: f64 = 16.0;
/// Multiplications of a factorisation below which single precision saves little: 1e9 take 30 ms.
pub const WORTH_SINGLE: f64 = 1e9;
/// Rows of the largest front, relative to n^2/3, from which a body counts as solid: cubes have 1.4, plates and beams less than 0.6.
pub const SOLID: f64 = 0.7;
/// Ratio of stiffnesses D_ii from which single precision is not tried.
pub const CONTRAST: f64 = 1e3;
/// Resistance, relative to the stiffest motion, below which a motion may belong to the null space.
pub const MAY_BE_FREE: f64 = 1e-11;
/// Stiffness, relative to the stiffest motion, below which motions are measured over the whole part.
pub const MEASURED: f64 = 1e-3;
/// Ratio of stiffness that separates the null space from soft motions, and supports from rounding.
pub const GAP: f64 = 1e3;
/// Bound of rounding in standard deviations.
pub const DEVIATIONS: f64 = 5.0;
/// Rounding relative to the softest other motion that changes forces by less than the certificate allows.
pub const TRIFLE: f64 = 1e-6;
/// Stiffness of weak springs that make K regular, relative to the stiffest motion: 1e-6 of K at every unknown.
pub const WEAK_SPRINGS: f64 = 1e-5;
/// Largest p and q of a simple ratio p / q of two entries of K.
pub const SIMPLE: [f64; 2] = [4096.0, 64.0];
/// Stiffness relative to the neighbours from which an unknown is held by a penalty: chains, trusses, beams and solids have at
/// most 4.5.
pub const GROUNDED: f64 = 1e3;
