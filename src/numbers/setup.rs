//! Setup: shares of the progress bar, and uneven rows.

/// Progress after the functions of the host are checked.
pub const TRIED: f64 = 0.03;
/// Progress after the null spaces.
pub const NULL_SPACES: f64 = 0.05;
/// Progress after the analyses.
pub const ANALYSED: f64 = 0.3;
/// Progress after the factorisations.
pub const FACTORISED: f64 = 0.9;
/// Progress after F, with the Dirichlet preconditioner.
pub const ASSEMBLED: f64 = 0.6;
/// Progress after F, with the lumped preconditioner.
pub const ASSEMBLED_LUMPED: f64 = 0.98;
/// Power of the entries of a factor with which its operations grow.
pub const WORK: f64 = 1.5;
/// Operations in the time in which a byte is sent to another rank: a body that costs less per byte of its K is not lent.
pub const SENT: f64 = 20.0;
/// Time until the next message, relative to the time so far.
pub const NEXT_MESSAGE: f64 = 0.1;
/// Ratio of the bodies' parts of b D^-1 b' from which rounding of one counts beside the other (S13).
pub const UNEVEN_STIFFNESS: f64 = 1e4;
/// Solves expected with one K for which single precision is faster: a later solve takes five times as long as with a factor in double
/// precision, and the first saves more than two of these.
pub const FEW_STEPS: i64 = 2;
/// Operations of a round of factorisations on every rank, about a second: after it rank 0 hears of them.
pub const ROUND: f64 = 1e10;
