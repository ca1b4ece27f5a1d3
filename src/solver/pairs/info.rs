//! Sums over the nodes of a pair.

use crate::error::Result;
use crate::model::Geometry;
use crate::solver::pairs::Sides;
use crate::solver::problem::Problem;
use crate::surface::vector::{cross, plus, Vector};
use crate::surface::NONE;

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
        facts.deepest = self.deepest(pair)?;
        Ok(facts)
    }

    fn deepest(&self, pair: usize) -> Result<Option<(usize, f64)>> {
        let of = self.model.pairs.pair(pair)?;
        let normals = self.normals_of_surfaces()?;
        let partners = Sides::of(&self.model, of, &normals)?.partners(&mut vec![NONE; of.nodes.len()])?;
        let depth = |(k, partner): (usize, &Option<crate::surface::Partner>)| {
            let depth = of.laws.offset[k] - partner.as_ref()?.gap();
            (depth > 0.0).then_some((of.nodes[k] as usize, depth))
        };
        let all = partners.iter().enumerate().filter_map(depth);
        Ok(all.fold(
            None,
            |most: Option<(usize, f64)>, of| {
                if most.is_none_or(|most| of.1 > most.1) {
                    Some(of)
                } else {
                    most
                }
            },
        ))
    }
}
