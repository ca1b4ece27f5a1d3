//! Sums over the nodes of a pair.

use crate::error::Result;
use crate::model::{Pair, PairMethod};
use crate::platform::memory::headroom;
use crate::solver::pairs::Sides;
use crate::solver::problem::Problem;
use crate::surface::vector::{plus, Vector};
use crate::surface::{between_walls, find, Master, Partner, Placed, Tree, NONE};

/// Bytes of a node of either surface: its partner, twice, and its position.
const PER_NODE: usize = 512;

/// What a pair carries and where it is closed, by the last answer; where it overlaps, at the present positions.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct PairFacts {
    /// Slave nodes with a row, and those of them without partner.
    pub rows: usize,
    pub without: usize,
    pub closed: usize,
    pub sticking: usize,
    pub slipping: usize,
    /// Force on the slave, and its moment about the origin: force, force x length.
    pub force: Vector,
    pub moment: Vector,
    /// length^2
    pub closed_area: f64,
    /// Largest pressure and its node; none without areas or forces.
    pub largest_pressure: Option<(usize, f64)>,
    /// The closed node whose normal differs most from that of the master, and the angle, radian > 0: mortar is for faces that lie on each other.
    pub largest_angle: Option<(usize, f64)>,
    /// The slave node deepest in the master, and its penetration below the offset, length > 0.
    pub deepest: Option<(usize, f64)>,
    /// The node of the master deepest in the slave, and its penetration, length > 0.
    pub deepest_of_master: Option<(usize, f64)>,
    /// Nodes that lie between two walls of the master and have a row with one of them only, and the first of these nodes; by mortar none.
    pub between_walls: usize,
    pub first_between: Option<usize>,
    /// Rows of the last find whose unknowns are all held, and the deepest overlap there, length.
    pub held: usize,
    pub held_overlap: f64,
}

impl Problem {
    /// Counts, resultant and extremes of a pair. Forces are those of the last answer, 0 without one; penetration is that of the present positions.
    pub fn pair_info(&self, pair: usize) -> Result<PairFacts> {
        let of = self.model.pairs.pair(pair)?;
        let mut facts = PairFacts { rows: of.nodes.len(), ..PairFacts::default() };
        facts.without = of.met.iter().filter(|met| met.is_none()).count();
        if let Ok(answer) = self.answer() {
            for result in self.results_of(of, Some(answer)) {
                facts.force = plus(facts.force, 1.0, plus(result.shear, -result.force, result.met.normal));
                facts.moment = plus(facts.moment, 1.0, result.moment);
                if result.closed > 0.0 && result.met.angle > facts.largest_angle.map_or(0.0, |most| most.1) {
                    facts.largest_angle = Some((result.node as usize, result.met.angle));
                }
                facts.closed += usize::from(result.closed > 0.0);
                facts.sticking += usize::from(result.closed == 2.0);
                facts.slipping += usize::from(result.closed == 3.0);
                facts.closed_area += if result.closed > 0.0 { result.area } else { 0.0 };
                let pressure = result.force / result.area;
                if result.area > 0.0 && pressure > facts.largest_pressure.map_or(0.0, |most| most.1) {
                    facts.largest_pressure = Some((result.node as usize, pressure));
                }
            }
        }
        (facts.held, facts.held_overlap) = of.held;
        self.overlaps(of, &mut facts)?;
        Ok(facts)
    }

    fn overlaps(&self, pair: &Pair, facts: &mut PairFacts) -> Result<()> {
        let nodes = pair.nodes.len() + self.model.pairs.surfaces[pair.master].len();
        let _room = headroom(nodes.saturating_mul(PER_NODE), "facts on a pair")?;
        if !pair.laws.scalars.is_on {
            return Ok(());
        }
        let normals = self.normals_of_surfaces()?;
        let sides = Sides::of(&self.model, pair, &normals)?;
        let (threads, rule, nodes, master) = (sides.threads(), sides.rule(), sides.nodes(), sides.master()?);
        let partners = find(threads, &master, &rule, &nodes, &mut vec![NONE; nodes.len()])?;
        facts.deepest = deepest(&pair.nodes, &partners, |k| pair.laws.offset[k]);
        let Master::Faces(placed, tree) = &master else { return Ok(()) };
        if pair.method == PairMethod::NodeToFace {
            let between = between_walls(threads, placed, tree, &rule, &nodes, &partners)?;
            facts.between_walls = between.iter().filter(|between| **between).count();
            facts.first_between = between.iter().position(|between| *between).map(|k| pair.nodes[k] as usize);
        }
        if sides.slave.faces.len() > 0 {
            let of_master: Vec<u32> = placed.faces.used().collect();
            let at: Vec<_> =
                of_master.iter().map(|&k| (placed.x[k as usize], placed.normals[k as usize])).collect();
            let slave = Placed { faces: sides.slave.faces, x: sides.slave.x, normals: sides.slave_normals };
            let opposite = Master::Faces(slave, Tree::new(slave.faces, slave.x)?);
            let partners = find(threads, &opposite, &rule, &at, &mut vec![NONE; at.len()])?;
            facts.deepest_of_master = deepest(&of_master, &partners, |_| 0.0);
        }
        Ok(())
    }
}

/// The node that is deepest below its offset, and by how much.
fn deepest(
    nodes: &[u32],
    partners: &[Option<Partner>],
    offset: impl Fn(usize) -> f64,
) -> Option<(usize, f64)> {
    let depth = |(k, partner): (usize, &Option<Partner>)| {
        let depth = offset(k) - partner.as_ref()?.gap();
        (depth > 0.0).then_some((nodes[k] as usize, depth))
    };
    let all = partners.iter().enumerate().filter_map(depth);
    all.fold(
        None,
        |most: Option<(usize, f64)>, of| if most.is_none_or(|most| of.1 > most.1) { Some(of) } else { most },
    )
}
