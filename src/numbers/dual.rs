//! Choice of explicit or implicit F_p (S3.5).

/// Products with F that are expected of a solve and some load steps.
pub const PRODUCTS: f64 = 50.0;
/// Part of the factor that the solution for one row reaches, times (rows / n^2/3). Fitted to cubes of 375 to 20 000 unknowns.
pub const REACH: f64 = 0.4;
/// Speed of the assembly of F relative to substitution. Fitted as `REACH`.
pub const RATE: f64 = 5.0;
/// Bytes of a factor that stay in the cache between forward and backward substitution.
pub const CACHE: f64 = 8e6;
/// Part of a factor in the cache that is read again. Two blocks of 144k in 128 pieces: 3.6 s instead of 4.2 s.
pub const AGAIN: f64 = 0.25;
/// Least entries of a column: finding its order takes as long.
pub const THIN: f64 = 10.0;
/// Values added to the unit diagonal of blocks of rows that may depend; the first with which Cholesky succeeds is used. The
/// pivot of a dependent row is this divided by the square of its coefficient in the dependence: far below `linalg::ROOT`.
pub const PROBES: [f64; 4] = [0.0, 1e-13, 1e-12, 1e-11];
/// Columns of a call of 32 that cost the host as much as a column of K+ alone: blocks pass through the factor once for several
/// columns. SPOOLES on 10 000 unknowns: 4.1; a function that solves column by column: 1.
pub const ALONE: usize = 4;
/// How much more a dual operator is used that a second solve uses, relative to its use so far: with one K a host goes through several
/// steps of load, otherwise it changes K after one.
pub const LASTING: usize = 4;
