//! Conversion between the host's rows and the rows of the dual problem: groups of parallel rows, S, L, 2^p.

use crate::constraints::{Decoupling, Grouping};
use crate::error::Result;
use crate::platform::memory::zeros;

/// The transformation between the stack of an island, contact rows first, and its dual,
///
/// ```text
/// lambda = 2^p S L'^-1 x,   c' = L^-1 S c
/// ```
///
/// where the rows of a group, multiples of each other, have one x and one c'. One row of a group, its holder, carries the
/// force.
pub struct Scaling {
    /// 2^p, force / length.
    pub unit: f64,
    /// s_i of every row, `length^-1` in units of 2^p; 0 for rigid rows without entries.
    pub scale: Vec<f64>,
    pub grouping: Grouping,
    pub decoupling: Decoupling,
}

impl Scaling {
    /// Ratio of the force of a holder, a contact row or a tangential row, to the x of its group.
    pub fn force_of(&self, group: usize, holder: usize) -> f64 {
        self.scale[holder] * self.unit / self.decoupling.factor(group)
    }

    /// x for forces lambda of the rows of the stack.
    pub fn forces_to_dual(&self, lambda: impl Fn(usize) -> f64) -> Result<Vec<f64>> {
        let mut x = zeros(self.grouping.leaders.len(), "multipliers")?;
        for (i, (group, sign)) in self.grouping.members() {
            x[group] += sign * lambda(i) / (self.scale[i] * self.unit);
        }
        Ok(self.decoupling.apply_transposed(&x))
    }

    /// lambda over the stack; only these holders carry forces.
    pub fn forces_to_host(&self, x: &[f64], holders: &[usize]) -> Vec<f64> {
        let mut lambda = vec![0.0; self.scale.len()];
        let x = self.decoupling.solve_transposed(x.to_vec());
        for (x, &holder) in x.iter().zip(holders) {
            lambda[holder] = x * self.scale[holder] * self.unit;
        }
        lambda
    }

    /// c' for lengths c along these holders.
    pub fn lengths_to_dual(&self, holders: &[usize], c: impl Fn(usize) -> f64) -> Vec<f64> {
        self.decoupling.solve(holders.iter().map(|&holder| c(holder) * self.scale[holder]).collect())
    }

    /// Lengths along all rows of the stack that are in a group, from lengths along the rows of the dual.
    pub fn lengths_to_host(&self, y: &[f64]) -> impl Iterator<Item = (usize, f64)> + '_ {
        let y = self.decoupling.apply(y);
        self.grouping.members().map(move |(i, (group, sign))| (i, sign * y[group] / self.scale[i]))
    }
}
