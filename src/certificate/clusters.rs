//! Groups of unknowns that K couples, such as those of a node, and the rows of every unknown, for the search for what rows hold.

use std::collections::HashMap;

use crate::body::Stiffness;
use crate::certificate::grounded::each_entry;
use crate::constraints::RowSet;
use crate::error::Result;
use crate::linalg::graph::joined;
use crate::linalg::sparse::csr::by_columns;
use crate::numbers::certificate::CARRIED;
use crate::platform::memory::filled;

/// Most unknowns of a cluster: those of a node. Larger clusters, and those that rows hold in part, deform, as rubber on steel
/// does.
const CLUSTER: usize = 6;
const WHAT: &str = "the metric of an island";

/// A body: its first unknown in the island, its K, and the metric of unknowns without stiffness.
pub type Metered<'a> = (usize, Stiffness<'a>, f64);

/// The clusters of all unknowns: those that K couples by more than the springs that hang a pilot on a body; and their rows.
pub(super) struct Clusters {
    /// Cluster of every unknown.
    pub of: Vec<usize>,
    sizes: Vec<usize>,
    /// Stiffness of the ground: of the stiffest connection of two unknowns, `max |K_ij|`, not of a penalty; force / length.
    pub ground: f64,
    /// The rows of unknown j are `rows[starts[j]..starts[j + 1]]`, each with its kind.
    starts: Vec<usize>,
    rows: Vec<(usize, usize)>,
}

impl Clusters {
    pub fn of(bodies: &[Metered], rows: [&RowSet; 3], n: usize) -> Result<Self> {
        let (mut pairs, mut hidden, mut ground) = (Vec::new(), Vec::new(), 0.0f64);
        for (start, k, _) in bodies {
            let couple = |i: usize, j: usize, v: f64| {
                ground = if i == j { ground } else { ground.max(v.abs()) };
                // as far apart as a pilot and the body on which it hangs: |K_ij| < (K_ii K_jj)^1/2 / CARRIED
                let [part, of] = [i, j].map(|of| CARRIED * v.abs() / k.metric(of, 0.0));
                if i != j && v != 0.0 && (part * of).is_nan() | (part * of >= 1.0) {
                    pairs.push([start + i, start + j]);
                }
            };
            if !each_entry(*k, couple) {
                hidden.extend(*start..start + k.order());
            }
        }
        let (of, count) = joined(n, pairs.into_iter().map(|pair| pair.into_iter()));
        let mut sizes = filled(count, 0, WHAT)?;
        of.iter().for_each(|&cluster| sizes[cluster] += 1);
        // K+ of a body whose entries the host keeps cannot hold further unknowns
        hidden.into_iter().for_each(|j| sizes[of[j]] += CLUSTER);
        let of_row = |kind: usize, i: usize| rows[kind].matrix.row(i).map(move |(j, v)| ((kind, i), j, v));
        let of_set = |kind: usize| (0..rows[kind].len()).flat_map(move |i| of_row(kind, i));
        let (starts, rows, _) = by_columns(n, || (0..rows.len()).flat_map(of_set), WHAT)?;
        Ok(Self { of, sizes, ground, starts, rows })
    }

    /// Kind and number of the rows of these unknowns, ascending.
    pub fn rows_of(&self, unknowns: &[usize]) -> Vec<(usize, usize)> {
        let of = |j: &usize| &self.rows[self.starts[*j]..self.starts[j + 1]];
        let mut rows: Vec<_> = unknowns.iter().flat_map(of).copied().collect();
        rows.sort_unstable();
        rows.dedup();
        rows
    }

    /// K couples it to no other unknown. Elastic bodies deform on the ground, also soft ones.
    pub fn is_alone(&self, j: usize) -> bool {
        self.sizes[self.of[j]] == 1
    }

    /// Keeps the unknowns of small clusters all of which are among these.
    pub fn keep_whole(&self, found: &mut Vec<usize>) {
        let mut counts = HashMap::new();
        found.retain(|&j| self.sizes[self.of[j]] <= CLUSTER);
        found.iter().for_each(|&j| *counts.entry(self.of[j]).or_insert(0) += 1);
        found.retain(|j| counts[&self.of[*j]] == self.sizes[self.of[*j]]);
    }
}
