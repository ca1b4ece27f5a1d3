//! The gaps of an island as its dual takes them.

/// The right-hand sides of the dual rows.
pub struct Gaps {
    /// `S c` or `S h` of every group: the tightest gap of its contact rows.
    pub value: Vec<f64>,
    /// c' = L^-1 of them, for the rows of the dual.
    pub dual: Vec<f64>,
    /// The row of the group that carries its multiplier.
    pub holder: Vec<usize>,
    /// Groups with a multiplier >= 0.
    pub bounded: Vec<bool>,
    /// Those whose gaps are far beyond all that loads and rows move.
    pub far: Vec<bool>,
}
