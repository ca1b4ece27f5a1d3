//! Contact between surfaces: a find makes the rows of all pairs from the present positions.

mod assembly;
mod fields;
mod info;

pub use fields::PairField;
pub use info::PairFacts;

use std::sync::Arc;

use crate::constraints::{OwnedRows, RowKind, RowSet, TabledRows};
use crate::error::{Error, Kind, Result};
use crate::model::{Geometry, HostModel, Met, Pair, PairMethod, PairRows, Tied};
use crate::numbers::surface::OVERLAP;
use crate::platform::memory::headroom;
use crate::progress::LogLevel;
use crate::solver::pairs::assembly::{Assembly, Contact};
use crate::solver::problem::Problem;
use crate::surface::vector::{largest, minus, Vector};
use crate::surface::{areas, find, Depth, Master, Meeting, Mortar, Opposite, Placed, Rule, Slave, Tree};

/// Bytes of a slave node during a find: its rows, twice, and its partner; by mortar its rows have several nodes of the slave and of several
/// faces of the master.
const PER_NODE: usize = 4096;
const PER_NODE_BY_MORTAR: usize = 12288;

/// What a find has made of one pair.
struct Found {
    kept: Vec<u32>,
    met: Vec<Option<Met>>,
    adjusted: Option<Vec<f64>>,
    tied: Option<Arc<Tied>>,
    areas: Vec<f64>,
    held: (usize, f64),
    /// Contact rows or equality rows of a tie.
    rows: FoundRows,
    tangential: FoundRows,
}

/// Rows of one kind over the unknowns of all bodies; those that follow the table of unknowns also as they name its unknowns.
#[derive(Default)]
struct FoundRows {
    set: RowSet,
    tabled: TabledRows,
}

impl FoundRows {
    /// `follows`: which rows change with the table, if the rows are `given` over its unknowns.
    fn new(set: RowSet, given: Option<OwnedRows>, follows: impl Fn(usize) -> bool) -> Self {
        let mut tabled = TabledRows::default();
        for given in given.iter() {
            for row in (0..given.len()).filter(|row| follows(*row)) {
                tabled.push(row, given.row(row), given.rhs[row]);
            }
        }
        Self { set, tabled }
    }
}

impl Problem {
    /// Makes the rows of all pairs at the present positions, where u = 0: rows, gaps, tangential rows, areas and slips since the beginning of
    /// the step. Forces and states stay with their nodes and begin the next solve. A node without partner has the gap +infinity and no
    /// entries. The rows of a tie are found once: later finds measure what has opened since. An error changes nothing.
    pub fn pairs_find(&mut self) -> Result<()> {
        self.watched("find", f64::INFINITY, |problem, watch| {
            let interrupt = watch.stops.interrupt.clone();
            let mut all = interrupt.during(|| problem.found_pairs())?;
            let lines: Vec<String> =
                (0..all.len()).map(|pair| told(&problem.model, pair, &all[pair])).collect();
            problem.model.set_rows_of_pairs(rows_of(&problem.model, &mut all))?;
            for (pair, found) in problem.model.pairs.pairs.iter_mut().zip(all) {
                (pair.kept, pair.met, pair.areas) = (found.kept, found.met, found.areas);
                (pair.adjusted, pair.tied, pair.held) = (found.adjusted, found.tied, found.held);
            }
            lines.into_iter().try_for_each(|line| watch.log.say(LogLevel::Phase, || line))
        })
    }

    fn found_pairs(&self) -> Result<Vec<Found>> {
        let room = |pair: &Pair| match pair.method {
            PairMethod::NodeToFace => pair.nodes.len().saturating_mul(PER_NODE),
            PairMethod::Mortar => pair.nodes.len().saturating_mul(PER_NODE_BY_MORTAR),
        };
        let _room = headroom(self.model.pairs.pairs.iter().map(room).sum(), "rows of pairs")?;
        let normals = self.normals_of_surfaces()?;
        let pairs = self.model.pairs.pairs.iter().enumerate();
        pairs.map(|(number, pair)| Sides::of(&self.model, pair, &normals)?.found(number)).collect()
    }

    /// Outward normals of the nodes of all surfaces.
    fn normals_of_surfaces(&self) -> Result<Vec<Vec<Vector>>> {
        let normals = self.model.pairs.surfaces.iter().map(|surface| match surface {
            Geometry::Nodes { faces, x, .. } => faces.normals(x),
            Geometry::Rigid { .. } => Ok(Vec::new()),
        });
        normals.collect()
    }
}

/// A pair with its two surfaces.
struct Sides<'a> {
    model: &'a HostModel,
    pair: &'a Pair,
    slave: Slave<'a>,
    slave_normals: &'a [Vector],
    master: Opposite<'a>,
}

impl<'a> Sides<'a> {
    fn of(model: &'a HostModel, pair: &'a Pair, normals: &'a [Vec<Vector>]) -> Result<Self> {
        let surfaces = &model.pairs.surfaces;
        let Geometry::Nodes { faces, x, begin, .. } = &surfaces[pair.slave] else {
            return Err(Error::new(Kind::Internal, "a rigid slave"));
        };
        let slave = Slave { faces, x, begin };
        let master = match &surfaces[pair.master] {
            Geometry::Nodes { faces, x, begin, .. } => {
                Opposite::Faces(Placed { faces, x, normals: &normals[pair.master] }, begin)
            }
            Geometry::Rigid { now, begin } => Opposite::Rigid { found: now, now, begin },
        };
        Ok(Self { model, pair, slave, slave_normals: &normals[pair.slave], master })
    }

    fn threads(&self) -> usize {
        self.model.threads_for(self.pair.nodes.len())
    }

    fn rule(&self) -> Rule {
        let scalars = self.pair.laws.scalars;
        Rule { distance: scalars.distance, depth: scalars.depth, cosine: scalars.angle.to_radians().cos() }
    }

    /// Positions and normals of the nodes of the pair.
    fn nodes(&self) -> Vec<(Vector, Vector)> {
        let node = |&node: &u32| (self.slave.x[node as usize], self.slave_normals[node as usize]);
        self.pair.nodes.iter().map(node).collect()
    }

    fn master(&self) -> Result<Master<'a>> {
        Ok(match self.master {
            Opposite::Faces(placed, _) => Master::Faces(placed, Tree::new(placed.faces, placed.x)?),
            Opposite::Rigid { now, .. } => Master::Rigid(now),
        })
    }

    /// `kept` as in [`find`].
    fn meeting(&self, kept: &mut [u32], depth: Depth) -> Result<Meeting> {
        if !self.pair.laws.scalars.is_on {
            return Ok(Meeting::Feet(vec![None; self.pair.nodes.len()]));
        }
        let (threads, master, rule) = (self.threads(), self.master()?, self.rule());
        Ok(match self.pair.method {
            PairMethod::NodeToFace => Meeting::Feet(find(threads, &master, &rule, &self.nodes(), kept)?),
            PairMethod::Mortar => Meeting::Mortar(Mortar::find(threads, &self.slave, &master, &rule, depth)?),
        })
    }

    fn found(&self, number: usize) -> Result<Found> {
        let pair = self.pair;
        let mut kept = pair.kept.clone();
        let scalars = pair.laws.scalars;
        let depth = Depth { thickness: scalars.thickness, axisymmetric: scalars.axisymmetric };
        let whole = areas(self.slave.faces, self.slave.x, depth).map_err(|error| error.pair(number))?;
        let areas = |meeting: &Meeting| -> Vec<f64> {
            let area = |&node: &u32| match meeting {
                Meeting::Feet(_) => whole[node as usize],
                Meeting::Mortar(mortar) => mortar.area(node),
            };
            pair.nodes.iter().map(area).collect()
        };
        let assembly = Assembly::of(self.model, pair)?;
        if pair.is_tied {
            let tied = match &pair.tied {
                Some(tied) => tied.clone(),
                None => Arc::new(assembly.points(self, self.meeting(&mut kept, depth)?)),
            };
            let (made, met) = assembly.ties(self, &tied).map_err(|error| error.pair(number))?;
            let (mut set, areas) = (made.set, areas(&tied.meeting));
            // a row that has lost all its unknowns demands nothing
            let lost: Vec<bool> = (0..set.len()).map(|row| set.is_empty_row(row)).collect();
            set.rhs.iter_mut().zip(&lost).filter(|(_, lost)| **lost).for_each(|(h, _)| *h = 0.0);
            let rows = FoundRows::new(set, made.given, |row| !lost[row]);
            // points are found by the first find that is on
            let tied = (scalars.is_on || pair.tied.is_some()).then_some(tied);
            let (adjusted, held, tangential) = (None, (0, 0.0), FoundRows::default());
            return Ok(Found { kept, met, adjusted, tied, areas, held, rows, tangential });
        }
        let meeting = self.meeting(&mut kept, depth)?;
        let areas = areas(&meeting);
        let Contact { contact, tangential, met, adjusted } =
            assembly.contact(self, &meeting, pair.adjusted.as_deref()).map_err(|error| error.pair(number))?;
        let (mut rows, mut slips) = (contact.set, tangential.set);
        let held = self.switch_off(number, &mut rows, &mut slips)?;
        rows.set_compliance(0, &self.compliances(number, &areas)?)?;
        let closes: Vec<bool> = (0..rows.len()).map(|row| rows.is_finite(row)).collect();
        let rows = FoundRows::new(rows, contact.given, |row| closes[row]);
        let of_node = self.slave.faces.dim - 1;
        let tangential = FoundRows::new(slips, tangential.given, |row| closes[row / of_node]);
        let adjusted = (scalars.is_on || pair.adjusted.is_some()).then_some(adjusted);
        Ok(Found { kept, met, adjusted, tied: None, areas, held, rows, tangential })
    }

    /// 1/k of the rows. By mortar a node without area has no partner.
    fn compliances(&self, number: usize, areas: &[f64]) -> Result<Vec<f64>> {
        let (laws, is_mortar) = (&self.pair.laws, self.pair.method == PairMethod::Mortar);
        let of = |(k, c): (usize, &f64)| {
            let each = c / areas[k];
            if *c == 0.0 || (is_mortar && areas[k] == 0.0) {
                return Ok(0.0);
            }
            if each.is_finite() {
                return Ok(each);
            }
            let what = "the node has a compliance, length per pressure, and its faces have no area at these positions";
            let error = Error::new(Kind::State, what).pair(number).node(self.pair.nodes[k] as usize);
            Err(error.value(areas[k]))
        };
        laws.compliance.iter().enumerate().map(of).collect()
    }

    /// Rows that have lost all their unknowns never close, if they overlap by rounding at most. Their number, and the deepest overlap.
    fn switch_off(&self, number: usize, rows: &mut RowSet, tangential: &mut RowSet) -> Result<(usize, f64)> {
        let (mut held, each) = ((0, 0.0f64), self.slave.faces.dim - 1);
        let limit = OVERLAP * self.extent();
        for k in 0..rows.len() {
            if rows.rhs[k] == f64::INFINITY || !rows.is_empty_row(k) {
                continue;
            }
            if rows.rhs[k] < -limit {
                let what = format!(
                    "the node and the face that it has met cannot move, and they overlap by {:.1e}",
                    -rows.rhs[k]
                );
                let error =
                    Error::new(Kind::GapsContradict, what).pair(number).node(self.pair.nodes[k] as usize);
                return Err(error.value(rows.rhs[k]).limit(limit));
            }
            held = (held.0 + 1, held.1.max(-rows.rhs[k]));
            rows.rhs[k] = f64::INFINITY;
            // such a node slips by nothing
            tangential.rhs.iter_mut().skip(each * k).take(each).for_each(|s| *s = 0.0);
        }
        Ok(held)
    }

    /// Largest coordinate of the box of the slave, length.
    fn extent(&self) -> f64 {
        let x = self.slave.x;
        let (mut low, mut high) = ([f64::INFINITY; 3], [f64::NEG_INFINITY; 3]);
        for x in x {
            (0..3).for_each(|i| (low[i], high[i]) = (low[i].min(x[i]), high[i].max(x[i])));
        }
        if x.is_empty() {
            0.0
        } else {
            largest(minus(high, low))
        }
    }
}

/// The rows of all pairs, in their order.
fn rows_of(model: &HostModel, all: &mut [Found]) -> PairRows {
    let pairs = &model.pairs.pairs;
    let mut with_friction: Vec<usize> = (0..pairs.len()).filter(|&k| pairs[k].friction.is_some()).collect();
    with_friction.sort_by_key(|&k| pairs[k].friction);
    let mut rows = PairRows::default();
    for &k in &with_friction {
        let laws = &pairs[k].laws;
        rows.coefficient.extend(&laws.friction);
        rows.bound.extend(laws.cohesion.iter().zip(&all[k].areas).map(|(c, area)| c * area));
    }
    for kind in RowKind::ALL {
        let numbers: Vec<usize> = match kind {
            RowKind::Tangential => with_friction.clone(),
            _ => (0..pairs.len()).filter(|&k| pairs[k].kind() == kind).collect(),
        };
        let (mut sets, mut first) = (Vec::new(), 0);
        for k in numbers {
            let of = if kind == RowKind::Tangential { &mut all[k].tangential } else { &mut all[k].rows };
            rows.tabled[kind as usize].append(&of.tabled, first);
            first += of.set.len();
            sets.push(std::mem::take(&mut of.set));
        }
        rows.sets[kind as usize] = RowSet::joined(sets);
    }
    rows
}

/// The line of the log for one pair.
fn told(model: &HostModel, pair: usize, found: &Found) -> String {
    let (base, nodes) = (model.settings.index_base, &model.pairs.pairs[pair].nodes);
    let met: Vec<(u32, f64)> =
        nodes.iter().zip(&found.met).filter_map(|(node, met)| Some((*node, met.as_ref()?.gap))).collect();
    let deepest = met.iter().min_by(|a, b| a.1.total_cmp(&b.1)).filter(|(_, gap)| *gap < 0.0);
    let deepest = deepest.map_or(String::new(), |(node, gap)| {
        format!(", deepest node {}: {gap:.1e}", i64::from(*node) + base)
    });
    let without = nodes.len() - met.len();
    format!(
        "pair {}: {} nodes have met the master, {without} have not{deepest}",
        pair as i64 + base,
        met.len()
    )
}
