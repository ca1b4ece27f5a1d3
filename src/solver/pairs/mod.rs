//! Contact between surfaces: a find makes the rows of all pairs from the present positions.

mod assembly;
mod fields;
mod info;

pub use fields::PairField;
pub use info::PairFacts;

use crate::constraints::{RowKind, RowSet, RowsInput};
use crate::error::{Error, Kind, Result};
use crate::model::{Geometry, HostModel, Met, Pair, PairMethod, PairRows, Tied};
use crate::numbers::surface::OVERLAP;
use crate::platform::memory::headroom;
use crate::progress::LogLevel;
use crate::solver::pairs::assembly::{Assembled, Assembly};
use crate::solver::problem::Problem;
use crate::surface::vector::{largest, minus, Vector};
use crate::surface::{areas, find, Depth, Master, Opposite, Partner, Placed, Rigid, Rule, Slave, Tree};

/// Bytes of a slave node during a find: its rows, twice, and its partner.
const PER_NODE: usize = 4096;

/// What a find has made of one pair.
struct Found {
    kept: Vec<u32>,
    met: Vec<Option<Met>>,
    adjusted: Option<Vec<f64>>,
    tied: Option<(Vec<Option<Tied>>, Option<Rigid>)>,
    areas: Vec<f64>,
    held: (usize, f64),
    /// Contact rows or equality rows of a tie.
    rows: Assembled,
    tangential: Assembled,
}

impl Problem {
    /// Makes the rows of all pairs at the present positions, where u = 0: rows, gaps, tangential rows, areas and slips since the beginning of
    /// the step. Forces and states stay with their nodes and begin the next solve. A node without partner has the gap +infinity and no
    /// entries. The rows of a tie are found once: later finds measure what has opened since. An error changes nothing.
    pub fn pairs_find(&mut self) -> Result<()> {
        self.watched("find", f64::INFINITY, |problem, watch| {
            let interrupt = watch.stops.interrupt.clone();
            let all = interrupt.during(|| problem.found_pairs())?;
            let lines: Vec<String> =
                (0..all.len()).map(|pair| told(&problem.model, pair, &all[pair])).collect();
            problem.model.set_rows_of_pairs(rows_of(&problem.model, &all)?)?;
            for (pair, found) in problem.model.pairs.pairs.iter_mut().zip(all) {
                (pair.kept, pair.met, pair.areas) = (found.kept, found.met, found.areas);
                (pair.adjusted, pair.tied, pair.held) = (found.adjusted, found.tied, found.held);
            }
            lines.into_iter().try_for_each(|line| watch.log.say(LogLevel::Phase, || line))
        })
    }

    fn found_pairs(&self) -> Result<Vec<Found>> {
        let nodes: usize = self.model.pairs.pairs.iter().map(|pair| pair.nodes.len()).sum();
        let _room = headroom(nodes.saturating_mul(PER_NODE), "rows of pairs")?;
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
            Geometry::Rigid { now, begin } => Opposite::Rigid(now, begin),
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

    /// The partners of all nodes of the pair; `kept` as in [`find`].
    fn partners(&self, kept: &mut [u32]) -> Result<Vec<Option<Partner>>> {
        if !self.pair.laws.scalars.is_on {
            return Ok(vec![None; self.pair.nodes.len()]);
        }
        let master = match self.master {
            Opposite::Faces(placed, _) => Master::Faces(placed, Tree::new(placed.faces, placed.x)?),
            Opposite::Rigid(rigid, _) => Master::Rigid(rigid),
        };
        match self.pair.method {
            PairMethod::NodeToFace => find(self.threads(), &master, &self.rule(), &self.nodes(), kept),
        }
    }

    fn found(&self, number: usize) -> Result<Found> {
        let pair = self.pair;
        let mut kept = pair.kept.clone();
        let scalars = pair.laws.scalars;
        let depth = Depth { thickness: scalars.thickness, axisymmetric: scalars.axisymmetric };
        let all = areas(self.slave.faces, self.slave.x, depth).map_err(|error| error.pair(number))?;
        let areas: Vec<f64> = pair.nodes.iter().map(|&node| all[node as usize]).collect();
        let assembly = Assembly::of(self.model, pair)?;
        if pair.is_tied {
            let rigid = if let Opposite::Rigid(now, _) = self.master { Some(*now) } else { None };
            let tied = match &pair.tied {
                Some(tied) => tied.clone(),
                None => (assembly.points(self, &self.partners(&mut kept)?), rigid),
            };
            let master = match (self.master, &tied.1) {
                (Opposite::Rigid(now, _), Some(found)) => Opposite::Rigid(found, now),
                (master, _) => master,
            };
            let (rows, met) = assembly.ties(self, &master, &tied.0)?;
            // points are found by the first find that is on
            let tied = (scalars.is_on || pair.tied.is_some()).then_some(tied);
            let (adjusted, held, tangential) = (None, (0, 0.0), Assembled::default());
            return Ok(Found { kept, met, adjusted, tied, areas, held, rows, tangential });
        }
        let partners = self.partners(&mut kept)?;
        let adjusted = pair.adjusted.clone().unwrap_or_else(|| self.adjusted(&partners));
        let (mut rows, mut tangential, met) = assembly.contact(self, &partners, &adjusted)?;
        let held = self.switch_off(number, &mut rows, &mut tangential)?;
        rows.compliance = pair
            .laws
            .compliance
            .iter()
            .zip(&areas)
            .map(|(c, area)| if *c > 0.0 { c / area } else { 0.0 })
            .collect();
        let adjusted = (scalars.is_on || pair.adjusted.is_some()).then_some(adjusted);
        Ok(Found { kept, met, adjusted, tied: None, areas, held, rows, tangential })
    }

    /// Gaps of the first find that count as 0.
    fn adjusted(&self, partners: &[Option<Partner>]) -> Vec<f64> {
        let laws = &self.pair.laws;
        let of = |(k, partner): (usize, &Option<Partner>)| {
            let gap = partner.as_ref().map_or(0.0, |partner| partner.gap() - laws.offset[k]);
            if gap.abs() <= laws.scalars.adjust {
                gap
            } else {
                0.0
            }
        };
        partners.iter().enumerate().map(of).collect()
    }

    /// Rows whose unknowns are all held never close, if they overlap by rounding at most. Their number, and the deepest overlap.
    fn switch_off(
        &self,
        number: usize,
        rows: &mut Assembled,
        tangential: &mut Assembled,
    ) -> Result<(usize, f64)> {
        let mut held = (0, 0.0f64);
        for k in 0..rows.len() {
            if rows.rhs[k] == f64::INFINITY || !rows.is_empty(k) {
                continue;
            }
            let limit = OVERLAP * self.extent();
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
            tangential.clear(k);
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
fn rows_of(model: &HostModel, all: &[Found]) -> Result<PairRows> {
    let pairs = &model.pairs.pairs;
    let mut rows = PairRows::default();
    for (pair, found) in pairs.iter().zip(all) {
        let set = if pair.is_tied { &mut rows.equalities } else { &mut rows.contact };
        append(model, set, pair.kind(), &found.rows)?;
    }
    let mut with_friction: Vec<usize> = (0..pairs.len()).filter(|&k| pairs[k].friction.is_some()).collect();
    with_friction.sort_by_key(|&k| pairs[k].friction);
    for k in with_friction {
        append(model, &mut rows.tangential, RowKind::Tangential, &all[k].tangential)?;
        let laws = &pairs[k].laws;
        rows.coefficient.extend(&laws.friction);
        rows.bound.extend(laws.cohesion.iter().zip(&all[k].areas).map(|(c, area)| c * area));
    }
    Ok(rows)
}

fn append(model: &HostModel, set: &mut RowSet, kind: RowKind, of: &Assembled) -> Result<()> {
    let input = RowsInput { ptr: &of.ptr, body: None, dof: &of.dof, val: &of.val, rhs: Some(&of.rhs) };
    let first = set.add(kind, input, &model.offsets)?;
    if of.compliance.is_empty() {
        return Ok(());
    }
    set.set_compliance(first, &of.compliance)
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
