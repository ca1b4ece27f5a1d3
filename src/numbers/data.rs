//! What the host gives.

/// Multiple of the accuracy of the data up to which a part of the load that nothing holds makes an answer marginal.
pub const MARGINAL: f64 = 1e3;
/// Largest accuracy that the digits of coordinates may show, relative to an edge.
pub const MOST_BY_COORDINATES: f64 = 1e-6;
/// No limit of time: more seconds than any run.
pub const NO_LIMIT: f64 = 1e300;
/// 2^53: integers up to this are exact.
pub const MANY: f64 = 9_007_199_254_740_992.0;
/// 2^20: coordinates that are multiples of its inverse are exact numbers, not printed ones.
pub const BINARY: f64 = 1_048_576.0;
/// Coefficient of friction from which the log asks: steel on rubber has 1 to 2.
pub const HIGH_FRICTION: f64 = 5.0;
