//! The gaps of an island, scaled for its dual problem.

/// The right-hand sides of the dual rows: first every group of rows, then the springs of bodies.
pub struct Gaps {
    /// `S c` or `S h` of every group: the tightest gap of its contact rows.
    pub value: Vec<f64>,
    /// `c' = L^-1 value`, for the rows of the dual.
    pub dual: Vec<f64>,
    /// The row of the group that stands for it: the first that carries its multiplier; springs have none.
    pub holder: Vec<usize>,
    /// The part of its group's force that each row carries: equal contact rows share evenly.
    pub share: Vec<f64>,
    /// Groups with a multiplier >= 0.
    pub bounded: Vec<bool>,
    /// Groups whose gaps far exceed all motion caused by loads and rows.
    pub far: Vec<bool>,
}

impl Gaps {
    /// Adds `rows` springs: they start at rest, and their forces have either sign.
    pub fn add_springs(&mut self, rows: usize) {
        [&mut self.value, &mut self.dual].into_iter().for_each(|c| c.resize(rows, 0.0));
        [&mut self.bounded, &mut self.far].into_iter().for_each(|is| is.resize(rows, false));
    }
}
