//! Sums over the nodes of a pair.

use crate::error::Result;
use crate::model::{Geometry, Pair};
use crate::solver::pairs::Sides;
use crate::solver::problem::Problem;
use crate::surface::vector::{cross, plus, Vector};
use crate::surface::{between_walls, find, Master, Opposite, Partner, Placed, Tree, NONE};

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
    /// The slave node deepest in the master, and its penetration below the offset, length > 0.
    pub deepest: Option<(usize, f64)>,
    /// The node of the master deepest in the slave, and its penetration, length > 0.
    pub deepest_of_master: Option<(usize, f64)>,
    /// Nodes that lie between two walls of the master and have a row with one of them only, and the first of these nodes.
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
        let x = match &self.model.pairs.surfaces[of.slave] {
            Geometry::Nodes { x, .. } => &x[..],
            Geometry::Rigid { .. } => &[],
        };
        if let Ok(answer) = self.answer() {
            for result in self.results_of(of, Some(answer)) {
                let force = plus(result.shear, -result.force, result.met.normal);
                facts.force = plus(facts.force, 1.0, force);
                facts.moment = plus(facts.moment, 1.0, cross(x[result.node as usize], force));
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
        let normals = self.normals_of_surfaces()?;
        let sides = Sides::of(&self.model, pair, &normals)?;
        let partners = sides.partners(&mut vec![NONE; pair.nodes.len()])?;
        facts.deepest = deepest(&pair.nodes, &partners, |k| pair.laws.offset[k]);
        let Opposite::Faces(placed, _) = sides.master else { return Ok(()) };
        let (threads, rule, nodes) = (sides.threads(), sides.rule(), sides.nodes());
        let tree = Tree::new(placed.faces, placed.x)?;
        let between = between_walls(threads, &placed, &tree, &rule, &nodes, &partners)?;
        facts.between_walls = between.iter().filter(|between| **between).count();
        facts.first_between = between.iter().position(|between| *between).map(|k| pair.nodes[k] as usize);
        if sides.slave.faces.len() > 0 && pair.laws.scalars.is_on {
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
