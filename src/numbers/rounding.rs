//! What counts as rounding, apart from sums (`linalg::vector::NOISE`) and small multiples of eps.

/// Part of the largest term, after one sum.
pub const SUM: f64 = 1e-14;
/// Pivots, entries and shifts relative to the unit diagonal, after one factorisation.
pub const SOLVE: f64 = 1e-13;
/// Part of the data, after a method of many steps, or in rows and supports that a host has computed.
pub const METHOD: f64 = 1e-12;
