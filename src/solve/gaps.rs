//! The gaps of an island, scaled for its dual problem.

/// The right-hand sides of the dual rows: of one for every group of rows, then of the springs of bodies.
pub struct Gaps {
    /// `S c` or `S h` of every group: the tightest gap of its contact rows.
    pub value: Vec<f64>,
    /// c' = L^-1 of them, for the rows of the dual.
    pub dual: Vec<f64>,
    /// The row of the group that carries its multiplier; springs have none.
    pub holder: Vec<usize>,
    /// Groups with a multiplier >= 0.
    pub bounded: Vec<bool>,
    /// Those whose gaps are far beyond all that loads and rows move.
    pub far: Vec<bool>,
}

impl Gaps {
    /// Springs begin at rest and pull as well as push: with them there are so many rows.
    pub fn add_springs(&mut self, rows: usize) {
        [&mut self.value, &mut self.dual].into_iter().for_each(|c| c.resize(rows, 0.0));
        [&mut self.bounded, &mut self.far].into_iter().for_each(|is| is.resize(rows, false));
    }
}
