//! Unknowns that rows hold better than K, such as pilots and reference nodes with dummy stiffness, and the metric D~ in which they
//! count with what their rows give them:
//!
//! ```text
//! D~_j = D_j + sum_i b_ij^2 / (sum_l b_il^2 / D~_l + C_i),   l outside the cluster of j and not found together with j
//! ```
//!
//! from the stiffest outward. Where K couples the only unknown of a row to no other, the ground is the other unknown of this row, as
//! stiff as the stiffest connection of two unknowns. A row within a cluster adds nothing, and D~ = D for all other unknowns.

use std::rc::Rc;

use crate::certificate::clusters::{Clusters, Trace};
use crate::constraints::RowSet;
use crate::error::Result;
use crate::linalg::graph::joined;
use crate::linalg::vector::NOISE;
use crate::numbers::certificate::CARRIED;
use crate::platform::memory::{filled, reserved, zeros};

const WHAT: &str = "the metric of an island";

/// `D~ / unit` at the unknowns that rows touch.
pub struct Metric {
    pub values: Vec<f64>,
    /// Carried unknowns, ascending.
    pub carried: Vec<usize>,
}

impl Metric {
    /// For the rows of the island that may hold something, as far as known by the kind of a row and its number; a row with an
    /// infinite gap holds nothing.
    pub fn of(
        trace: &Trace,
        rows: [&RowSet; 3],
        holds: &dyn Fn(usize, usize) -> bool,
        unit: f64,
    ) -> Result<Self> {
        Search::new(trace, rows, holds, unit)?.metric()
    }
}

/// D^ / unit at the unknowns that rows touch: D~ with what all rows lead to, however few of them hold an unknown and however large its cluster. It
/// measures motions that rows pass on from soft unknowns to stiff ones, and the rounding of forces that cancel between rows. A row
/// gives no more than the stiffest unknown to which it leads: an entry that is nearly 0 is no lever.
pub fn led(
    trace: &Trace,
    rows: [&RowSet; 3],
    holds: &dyn Fn(usize, usize) -> bool,
    unit: f64,
) -> Result<Vec<f64>> {
    Search::new(trace, rows, holds, unit)?.led()
}

/// The search for D~ or D^ from the stiffest unknowns outward.
#[derive(Clone)]
pub(super) struct Search<'a> {
    rows: [&'a RowSet; 3],
    holds: &'a dyn Fn(usize, usize) -> bool,
    unit: f64,
    /// None if rows hold no unknown far better than K.
    clusters: Option<Rc<Clusters>>,
    /// D / unit, of n touched unknowns.
    values: Vec<f64>,
    /// D~ / unit as far as it is known, n; 0 without stiffness.
    stiffness: Vec<f64>,
    /// Unknowns that are held so far, and the ground, n + 1.
    held: Vec<bool>,
}

impl<'a> Search<'a> {
    pub fn new(
        trace: &Trace,
        rows: [&'a RowSet; 3],
        holds: &'a dyn Fn(usize, usize) -> bool,
        unit: f64,
    ) -> Result<Self> {
        let Trace { diagonal, without, .. } = trace;
        let n = diagonal.len();
        let (mut values, mut stiffness) = (reserved(n, WHAT)?, reserved(n, WHAT)?);
        let value = |(d, without): (&f64, &f64)| if *d > 0.0 { *d } else { *without };
        values.extend(diagonal.iter().zip(without).map(|of| value(of) / unit));
        stiffness.extend(diagonal.iter().map(|d| d / unit));
        let mut held = filled(n + 1, false, WHAT)?;
        held[n] = true;
        let mut search = Self { rows, holds, unit, clusters: None, values, stiffness, held };
        if search.is_needed(trace.most() / unit) {
            search.clusters = Some(Rc::new(trace.clusters(rows)?));
        }
        Ok(search)
    }

    /// D~
    pub fn metric(mut self) -> Result<Metric> {
        self.outward(|search, mut found, clusters| {
            clusters.keep_whole(&mut found);
            search.carry(found, clusters)
        })?;
        let carried = (0..self.values.len()).filter(|&j| self.held[j]).collect();
        Ok(Metric { values: self.with_held(), carried })
    }

    /// D^
    pub fn led(mut self) -> Result<Vec<f64>> {
        self.outward(|search, found, clusters| {
            let mut given = zeros(found.len(), WHAT)?;
            search.each_link(&found, clusters, |own, yielding, stiffest| {
                own.iter().for_each(|(at, square)| given[*at] += (square / yielding).min(stiffest));
            });
            let led = (0..found.len()).filter(|&at| given[at] > 0.0).map(|at| found[at]).collect();
            Ok(search.hold(led, &found, &given))
        })?;
        Ok(self.with_held())
    }

    /// D / unit, and what the search has found where it has found more.
    fn with_held(self) -> Vec<f64> {
        let Self { mut values, stiffness, held, .. } = self;
        (0..values.len()).filter(|&j| held[j]).for_each(|j| values[j] = stiffness[j]);
        values
    }

    /// Whether rows may hold some unknown far better than K: another unknown, or the ground.
    fn is_needed(&self, stiffest: f64) -> bool {
        let mut soft = false;
        self.each_row(self.every_row(), |row, _| {
            soft |= row.len() == 1 && CARRIED * self.stiffness[row[0].0] < stiffest;
        });
        soft || !self.found(self.every_row(), |j| j).is_empty()
    }

    /// From the stiffest outward: `carry` is given the unknowns that are found and not yet held, and returns those that it holds. A row
    /// is searched again only if one of its unknowns was held: then its other unknowns yield more than this one, if not before.
    fn outward(
        &mut self,
        mut carry: impl FnMut(&mut Self, Vec<usize>, &Clusters) -> Result<Vec<usize>>,
    ) -> Result<()> {
        let Some(clusters) = self.clusters.clone() else { return Ok(()) };
        let (mut found, mut rows) = (Vec::new(), self.every_row().collect());
        while !Vec::is_empty(&rows) {
            found.extend(self.found(rows, |j| clusters.of[j]));
            found.sort_unstable();
            found.dedup();
            rows = clusters.rows_of(&carry(self, found.clone(), &clusters)?);
            found.retain(|&j| !self.held[j]);
        }
        Ok(())
    }

    /// Holds these of the unknowns that are found, to which rows give this.
    fn hold(&mut self, held: Vec<usize>, found: &[usize], given: &[f64]) -> Vec<usize> {
        for (&j, given) in found.iter().zip(given).filter(|(j, _)| held.binary_search(j).is_ok()) {
            self.stiffness[j] += given;
            self.held[j] = true;
        }
        held
    }

    /// Kind and number of every row.
    fn every_row(&self) -> impl Iterator<Item = (usize, usize)> + 'a {
        let sets = self.rows.into_iter().enumerate();
        sets.flat_map(|(kind, set)| (0..set.len()).map(move |i| (kind, i)))
    }

    /// Unknown and `b_ij^2 / D~_j` of the entries of every one of these rows, and `C_i`, without unit.
    fn each_row(
        &self,
        rows: impl IntoIterator<Item = (usize, usize)>,
        mut visit: impl FnMut(&[(usize, f64, f64)], f64),
    ) {
        let mut row = Vec::new();
        for (kind, i) in rows {
            let set = self.rows[kind];
            if !set.is_finite(i) || !(self.holds)(kind, i) {
                continue;
            }
            row.clear();
            // the rounding of a direction joins nothing
            let rounding = NOISE * set.largest_entry(i);
            let entries = set.matrix.row(i).filter(|(_, b)| b.abs() > rounding);
            row.extend(entries.map(|(j, b)| (j, b * b, b * b / self.stiffness[j])));
            if let (Some(clusters), [(j, square, _)]) = (&self.clusters, &row[..]) {
                if clusters.is_alone(*j) {
                    row.push((self.stiffness.len(), *square, *square / (clusters.ground / self.unit)));
                }
            }
            visit(&row, self.unit * set.compliance[i]);
        }
    }

    /// Unknowns that yield more than `CARRIED` times as much as another unknown of one of these rows, of another cluster.
    fn found(
        &self,
        rows: impl IntoIterator<Item = (usize, usize)>,
        cluster: impl Fn(usize) -> usize,
    ) -> Vec<usize> {
        let mut found = Vec::new();
        self.each_row(rows, |row, _| {
            // the entry that yields least, and the one that yields least outside its cluster
            let stiffest = |other: Option<usize>| {
                let among = row.iter().filter(|entry| entry.2 > 0.0 && Some(cluster(entry.0)) != other);
                among.min_by(|a, b| a.2.total_cmp(&b.2)).map(|entry| (cluster(entry.0), entry.2))
            };
            let Some(first) = stiffest(None) else { return };
            let second = stiffest(Some(first.0));
            for &(j, _, yields) in row.iter().filter(|entry| !self.held[entry.0]) {
                let other = if cluster(j) == first.0 { second } else { Some(first) };
                // without any stiffness it is a free motion: no gap is a difference of forces divided by K
                if other.is_some_and(|(_, least)| yields > CARRIED * least && yields < f64::INFINITY) {
                    found.push(j);
                }
            }
        });
        found
    }

    /// Place among these unknowns and `b_ij^2` of their entries in every row that joins them to others, `sum_l b_il^2 / D~_l + C_i` over
    /// these others, and the largest D~_l among them. Clusters are found as a whole: what is not found belongs to others.
    fn each_link(
        &self,
        found: &[usize],
        clusters: &Clusters,
        mut visit: impl FnMut(&[(usize, f64)], f64, f64),
    ) {
        let place = |entry: &(usize, f64, f64)| found.binary_search(&entry.0).ok();
        self.each_row(clusters.rows_of(found), |row, compliance| {
            let own: Vec<_> = row.iter().filter_map(|entry| Some((place(entry)?, entry.1))).collect();
            if own.is_empty() || own.len() == row.len() {
                return;
            }
            let others = || row.iter().filter(|entry| place(entry).is_none());
            let stiffest = others().map(|entry| entry.1 / entry.2).fold(0.0, f64::max);
            visit(&own, others().fold(compliance, |sum, entry| sum + entry.2), stiffest);
        });
    }

    /// Gives these unknowns D~: first those that rows hold one by one, then, of groups that rows join, those which have as many rows
    /// as unknowns; not those to which their rows give less than `CARRIED` times their stiffness.
    fn carry(&mut self, mut found: Vec<usize>, clusters: &Clusters) -> Result<Vec<usize>> {
        loop {
            let (mut given, mut alone) = (zeros(found.len(), WHAT)?, zeros(found.len(), WHAT)?);
            let mut links = Vec::new();
            self.each_link(&found, clusters, |own, yielding, _| {
                own.iter().for_each(|(at, square)| given[*at] += square / yielding);
                if let [(at, square)] = own {
                    alone[*at] += square / yielding;
                }
                links.push(own.iter().map(|(at, _)| *at).collect::<Vec<usize>>());
            });
            let held_by = |given: &[f64], may_be: &dyn Fn(usize) -> bool| {
                let enough = |at: usize| given[at] > CARRIED * self.stiffness[found[at]];
                let held = (0..found.len()).filter(|&at| may_be(at) && enough(at) && given[at].is_normal());
                let mut held = held.map(|at| found[at]).collect();
                clusters.keep_whole(&mut held);
                held
            };
            let held: Vec<usize> = held_by(&alone, &|_| true);
            if !held.is_empty() {
                return Ok(self.hold(held, &found, &alone));
            }
            // fewer rows than unknowns leave some of their motions to K
            let (group, count) = joined(found.len(), links.iter().map(|places| places.iter().copied()));
            let mut spare = filled(count, 0i64, WHAT)?;
            links.iter().for_each(|places| spare[group[places[0]]] += 1);
            group.iter().for_each(|&group| spare[group] -= 1);
            let held = held_by(&given, &|at| spare[group[at]] >= 0);
            if held.len() == found.len() {
                return Ok(self.hold(held, &found, &given));
            }
            found = held;
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::body::{Local, Locals, Seen};
    use crate::linalg::{Csr, Symmetric};
    use std::sync::Arc;

    fn rows(unknowns: usize, rows: &[&[(usize, f64)]]) -> RowSet {
        let mut matrix = Csr::empty(unknowns);
        rows.iter().for_each(|row| matrix.push_row(row.iter().copied()));
        RowSet {
            matrix: Arc::new(matrix),
            rhs: vec![0.0; rows.len()],
            compliance: vec![0.0; rows.len()].into(),
            ..RowSet::default()
        }
    }

    /// Of these bodies, all of whose unknowns are touched.
    fn of_matrices(matrices: &[Symmetric], rows: &RowSet) -> Metric {
        let all: Vec<Vec<u32>> = matrices.iter().map(|k| (0..k.order() as u32).collect()).collect();
        let each = matrices.iter().zip(&all).map(|(k, all)| Local::of_matrix(k.into(), 1.0, all));
        let bodies = Locals::new(each.map(Seen::Here).collect(), 1);
        let (trace, none) = (Trace::of(&bodies, |_| 1.0), RowSet::default());
        Metric::of(&trace, [&none, rows, &none], &|_, _| true, 1.0).unwrap()
    }

    /// Of springs to the ground, each a body.
    fn metric(springs: &[f64], of_rows: &[&[(usize, f64)]]) -> Metric {
        let matrices: Vec<Symmetric> =
            springs.iter().map(|&k| Symmetric::new(vec![0, 1], vec![0], vec![k])).collect();
        of_matrices(&matrices, &rows(springs.len(), of_rows))
    }

    #[test]
    fn a_pilot_counts_with_the_springs_to_which_its_rows_join_it() {
        for kp in [1e-300, 1e-9] {
            let of = metric(&[2.0, 3.0, kp], &[&[(0, -1.0), (2, 1.0)], &[(1, -1.0), (2, 2.0)], &[(2, 1.0)]]);
            assert_eq!(of.carried, [2]);
            assert_eq!(of.values, [2.0, 3.0, kp + 14.0]);
        }
        // stiff enough, or a free motion
        for kp in [0.2, 0.0] {
            let of = metric(&[2.0, 3.0, kp], &[&[(0, -1.0), (2, 1.0)], &[(1, -1.0), (2, 2.0)]]);
            assert!(of.carried.is_empty() && of.values == [2.0, 3.0, if kp > 0.0 { kp } else { 1.0 }]);
        }
    }

    #[test]
    fn a_chain_of_pilots_is_carried_from_the_stiffest_outward_also_if_it_becomes_softer_and_softer() {
        let link = |a: usize, b: usize| [(a, 1.0), (b, -1.0)];
        for (springs, error) in [([2.0, 1e-9, 1e-9, 1e-9], 1e-8), ([2.0, 1e-6, 1e-9, 1e-12], 1e-5)] {
            let of = metric(&springs, &[&link(0, 1), &link(1, 2), &link(2, 3)]);
            assert_eq!(of.carried, [1, 2, 3]);
            assert!(of.values.iter().all(|d| (d - 2.0).abs() < error), "{:?}", of.values);
        }
    }

    /// A displacement and a rotation of one node, in one row each with two springs.
    #[test]
    fn unknowns_of_one_node_do_not_hide_each_other() {
        let of = metric(
            &[1.0, 1.0, 1e-9, 1e-7],
            &[&[(0, -1.0), (2, 1.0), (3, 2.0)], &[(1, -1.0), (2, 1.0), (3, -2.0)]],
        );
        assert_eq!(of.carried, [2, 3]);
        assert_eq!(of.values, [1.0, 1.0, 2.0 + 1e-9, 8.0 + 1e-7]);
    }

    #[test]
    fn clusters_that_rows_hold_in_part_or_of_more_unknowns_deform() {
        let chain = |n: usize| {
            let mut k = Symmetric::empty();
            (0..n).for_each(|i| {
                k.push_row((i > 0).then(|| (i - 1, -1e-9)).into_iter().chain([(i, 2e-9)]));
            });
            k
        };
        let stiff = Symmetric::new(vec![0, 1], vec![0], vec![1.0]);
        for (n, held, carried) in [(6, 6, true), (6, 5, false), (7, 7, false)] {
            let entries: Vec<_> = (1..=held).map(|j| [(0, 1.0), (j, -1.0)]).collect();
            let rows = rows(n + 1, &entries.iter().map(|row| &row[..]).collect::<Vec<_>>());
            let of = of_matrices(&[stiff.clone(), chain(n)], &rows);
            assert_eq!(of.carried, if carried { (1..=n).collect() } else { vec![] });
        }
    }
}
