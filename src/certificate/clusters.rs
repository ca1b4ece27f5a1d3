//! Groups of unknowns that K couples, such as those of a node, and the rows of every unknown, for the search for what rows hold.

use std::collections::HashMap;

use crate::body::{wire_struct, wire_unit, Local, Locals, Name, Question, Seen, Stiffness};
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

/// K where rows touch the bodies of an island, t unknowns: all that the search knows of it.
pub struct Trace<'a> {
    bodies: &'a Locals<'a>,
    /// D, 0 without stiffness, t, force / length.
    pub diagonal: Vec<f64>,
    /// The metric of unknowns without stiffness, t, force / length.
    pub without: Vec<f64>,
    /// The largest D of every body; empty beside other islands.
    pub stiffest: Vec<f64>,
    beside: Option<Beside<'a>>,
}

/// All islands, if what is little is so beside all of them.
#[derive(Clone, Copy)]
pub struct Beside<'a> {
    /// The largest D.
    pub stiffest: f64,
    /// `max |K_ij|`, force / length: asked for only where rows hold something.
    pub strongest: &'a dyn Fn() -> Result<f64>,
}

impl<'a> Trace<'a> {
    /// `without`: the metric of unknowns without stiffness in a body.
    pub fn of(bodies: &'a Locals<'a>, without: impl Fn(&Seen<'a>) -> f64) -> Self {
        let stiffest = bodies.iter().map(Seen::stiffest).collect();
        Self { stiffest, ..Self::at_rows(bodies, without) }
    }

    /// As `of`, beside all islands.
    pub fn beside(all: Beside<'a>, bodies: &'a Locals<'a>, without: impl Fn(&Seen<'a>) -> f64) -> Self {
        Self { beside: Some(all), ..Self::at_rows(bodies, without) }
    }

    fn at_rows(bodies: &'a Locals<'a>, without: impl Fn(&Seen<'a>) -> f64) -> Self {
        let (mut diagonal, mut all) = (Vec::new(), Vec::new());
        for body in bodies.iter() {
            diagonal.extend_from_slice(&body.diagonal());
            all.resize(diagonal.len(), without(body));
        }
        Self { bodies, diagonal, without: all, stiffest: Vec::new(), beside: None }
    }

    pub(super) fn most(&self) -> f64 {
        let beside = self.beside.map_or(0.0, |others| others.stiffest);
        self.stiffest.iter().copied().fold(beside, f64::max)
    }

    pub(super) fn clusters(&self, rows: [&RowSet; 3]) -> Result<Clusters> {
        let mut clusters = Clusters::of(self.bodies.ask(|_| Couple, ())?, rows)?;
        if let Some(others) = self.beside {
            clusters.ground = clusters.ground.max((others.strongest)()?);
        }
        Ok(clusters)
    }
}

/// What K couples in a body, and where rows touch it.
pub struct Coupled {
    /// Cluster of every touched unknown, in the order in which they appear.
    of: Vec<usize>,
    /// Unknowns of each cluster, also those that no row touches.
    sizes: Vec<usize>,
    /// `max |K_ij|`, force / length.
    strongest: f64,
}

wire_struct!(Coupled { of, sizes, strongest });

/// Asks for what K couples.
pub struct Couple;

wire_unit!(Couple);

impl Question for Couple {
    const NAME: Name = Name::Couple;
    type Answer = Coupled;
    type Kept = ();
    type Given = ();

    fn answer(self, body: &Local, _: &mut (), _: ()) -> Result<Coupled> {
        Coupled::of(body.stiffness, body.touched)
    }
}

impl Coupled {
    /// `max |K_ij|`, force / length.
    pub fn strongest(&self) -> f64 {
        self.strongest
    }

    fn of(k: Stiffness, touched: &[u32]) -> Result<Self> {
        let (mut pairs, mut strongest) = (Vec::new(), 0.0f64);
        let couple = |i: usize, j: usize, v: f64| {
            strongest = if i == j { strongest } else { strongest.max(v.abs()) };
            // as far apart as a pilot and the body on which it hangs: |K_ij| < (K_ii K_jj)^1/2 / CARRIED
            let [part, of] = [i, j].map(|of| CARRIED * v.abs() / k.metric(of, 0.0));
            if i != j && v != 0.0 && (part * of).is_nan() | (part * of >= 1.0) {
                pairs.push([i, j]);
            }
        };
        // K+ of a body whose entries the host keeps cannot hold further unknowns
        let least = if k.each_entry(couple) { 0 } else { CLUSTER };
        let (cluster, count) = joined(k.order(), pairs.into_iter().map(|pair| pair.into_iter()));
        let mut own = filled(count, least, WHAT)?;
        cluster.iter().for_each(|&cluster| own[cluster] += 1);
        let (mut number, mut sizes) = (filled(count, None, WHAT)?, Vec::new());
        let of = touched.iter().map(|dof| {
            let cluster = cluster[*dof as usize];
            *number[cluster].get_or_insert_with(|| {
                sizes.push(own[cluster]);
                sizes.len() - 1
            })
        });
        Ok(Self { of: of.collect(), sizes, strongest })
    }
}

/// The clusters of the unknowns that rows touch: those that K couples by more than the springs that hang a pilot on a body; and their rows.
pub(super) struct Clusters {
    /// Cluster of every touched unknown, then of the ground.
    pub of: Vec<usize>,
    /// Unknowns of each cluster, also those that no row touches.
    sizes: Vec<usize>,
    /// Stiffness of the ground: of the stiffest connection of two unknowns, `max |K_ij|`, not of a penalty; force / length.
    pub ground: f64,
    /// The rows of unknown j are `rows[starts[j]..starts[j + 1]]`, each with its kind.
    starts: Vec<usize>,
    rows: Vec<(usize, usize)>,
}

impl Clusters {
    pub fn of(coupled: Vec<Coupled>, rows: [&RowSet; 3]) -> Result<Self> {
        let (mut of, mut sizes, mut ground) = (Vec::new(), Vec::new(), 0.0f64);
        for body in coupled {
            of.extend(body.of.iter().map(|cluster| sizes.len() + cluster));
            sizes.extend(body.sizes);
            ground = ground.max(body.strongest);
        }
        of.push(sizes.len());
        sizes.push(1);
        let n = of.len();
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
