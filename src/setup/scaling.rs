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
/// where the rows of a group, multiples of each other, have one x and one c'. Rows of a group carry shares of the force.
#[derive(PartialEq)]
pub struct Scaling {
    /// 2^p, force / length.
    pub unit: f64,
    /// s_i of every row, `length^-1` in units of 2^p; 0 for rigid rows without entries.
    pub scale: Vec<f64>,
    pub grouping: Grouping,
    pub decoupling: Decoupling,
}

impl Scaling {
    /// Ratio of the force of a contact row or a tangential row that carries all of it to the x of its group.
    pub fn force_of(&self, group: usize, row: usize) -> f64 {
        self.scale[row] * self.unit / self.decoupling.factor(group)
    }

    /// x for forces lambda of the rows of the stack.
    pub fn forces_to_dual(&self, lambda: impl Fn(usize) -> f64) -> Result<Vec<f64>> {
        let mut x = zeros(self.grouping.leaders.len(), "multipliers")?;
        for (i, (group, sign)) in self.grouping.members() {
            x[group] += sign * lambda(i) / (self.scale[i] * self.unit);
        }
        Ok(self.decoupling.apply_transposed(&x))
    }

    /// lambda over the stack; every row carries its share of the force of its group.
    pub fn forces_to_host(&self, x: &[f64], share: &[f64]) -> Vec<f64> {
        let mut lambda = vec![0.0; self.scale.len()];
        let x = self.decoupling.solve_transposed(x.to_vec());
        for (i, (group, _)) in self.grouping.members().filter(|(i, _)| share[*i] > 0.0) {
            lambda[i] = x[group] * self.scale[i] * self.unit * share[i];
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
