//! The projected gradient `g^P = g^I + g^C` of Section 4, and the largest feasible step along a direction.

use crate::linalg::vector::{dot, norm};

/// Parts of the gradient g at a point x >= 0, m entries each.
#[derive(Clone)]
pub struct Split {
    /// A(x) of (21): bounded rows at zero. The others are F(x).
    pub active: Vec<bool>,
    /// Inner gradient g^I (22): g on F(x), 0 on A(x).
    pub free: Vec<f64>,
    /// Chopped gradient g^C (23): min(g, 0) on A(x), 0 on F(x).
    pub chopped: Vec<f64>,
}

impl Split {
    /// Without a gradient.
    pub fn of(active: Vec<bool>) -> Self {
        let (free, chopped) = (vec![0.0; active.len()], vec![0.0; active.len()]);
        Self { active, free, chopped }
    }

    /// (21), (22), (23); returns whether the active set is unchanged.
    pub fn update(&mut self, active: Vec<bool>, g: &[f64]) -> bool {
        let same = active == self.active;
        self.active = active;
        self.update_on_face(g);
        same
    }

    /// (22), (23) on the present active set: rows at zero may count as free.
    pub fn update_on_face(&mut self, g: &[f64]) {
        for (i, active) in self.active.iter().enumerate() {
            let (free, chopped) = if *active { (0.0, g[i].min(0.0)) } else { (g[i], 0.0) };
            (self.free[i], self.chopped[i]) = (free, chopped);
        }
    }

    /// `|g^P|`, 0 at the solution.
    pub fn norm(&self) -> f64 {
        (dot(&self.free, &self.free) + dot(&self.chopped, &self.chopped)).sqrt()
    }

    /// x is *proportional* if `|g^C| <= Gamma |g^I|` (Section 4): the error on the current face exceeds the error of the
    /// choice of this face.
    pub fn is_proportional(&self, gamma: f64) -> bool {
        norm(&self.chopped) <= gamma * norm(&self.free)
    }
}

/// (21): bounded rows of x at zero.
pub fn at_bound(bounded: &[bool], x: &[f64]) -> Vec<bool> {
    x.iter().zip(bounded).map(|(x, bounded)| *bounded && *x <= 0.0).collect()
}

/// Largest t with `x - t p >= 0` on the rows i where `ends(i)`.
pub fn feasible_step(x: &[f64], p: &[f64], ends: impl Fn(usize) -> bool) -> f64 {
    (0..p.len()).filter(|&i| p[i] > 0.0 && ends(i)).map(|i| x[i] / p[i]).fold(f64::INFINITY, f64::min)
}
