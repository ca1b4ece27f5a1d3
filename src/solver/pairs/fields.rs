//! Results of a pair at the nodes of its slave.

use crate::certificate::FrictionState;
use crate::constraints::RowKind;
use crate::error::{Error, Result};
use crate::model::{Geometry, Met, Pair};
use crate::platform::memory::zeros;
use crate::solve::{Answer, RowState};
use crate::solver::problem::Problem;
use crate::surface::vector::{plus, Vector, ZERO};

/// What `pair_field` returns, with the numbers of a node.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum PairField {
    /// 1: contact force, force; of a tie its part along the normal, above 0 under pressure.
    Force,
    /// 1: force / area.
    Pressure,
    /// dim: tangential traction on the slave, force / area.
    Shear,
    /// 1: open gap, length.
    Gap,
    /// dim: slip of the step, length.
    Slip,
    /// 1: length^2.
    Area,
    /// dim: from slave to master, no unit.
    Normal,
    /// 1: 0 open, 1 closed, 2 sticks, 3 slips.
    Closed,
}

impl PairField {
    fn is_vector(self) -> bool {
        matches!(self, Self::Shear | Self::Slip | Self::Normal)
    }

    fn needs_answer(self) -> bool {
        !matches!(self, Self::Area | Self::Normal)
    }
}

/// One node of a pair with its forces and states.
pub(super) struct NodeResult {
    pub node: u32,
    pub met: Met,
    pub area: f64,
    /// Above 0 under pressure.
    pub force: f64,
    /// Tangential force on the slave.
    pub shear: Vector,
    pub gap: f64,
    pub slip: Vector,
    pub closed: f64,
}

impl Problem {
    /// Values at the nodes of the slave surface as given, `values` with `1` or `dim` numbers for each; 0 where a node has no partner.
    pub fn pair_field(&self, pair: usize, field: PairField) -> Result<Vec<f64>> {
        let of = self.model.pairs.pair(pair)?;
        let nodes = match &self.model.pairs.surfaces[of.slave] {
            Geometry::Nodes { x, .. } => x.len(),
            Geometry::Rigid { .. } => 0,
        };
        let count = if field.is_vector() { self.model.pairs.dim(of) } else { 1 };
        let mut values = zeros(count * nodes, "a field of a pair")?;
        let answer = field.needs_answer().then(|| self.answer()).transpose()?;
        for result in self.results_of(of, answer) {
            let per_area = if result.area > 0.0 { result.area.recip() } else { 0.0 };
            let numbers = match field {
                PairField::Force => [result.force, 0.0, 0.0],
                PairField::Pressure => [result.force * per_area, 0.0, 0.0],
                PairField::Shear => result.shear.map(|v| v * per_area),
                PairField::Gap => [result.gap, 0.0, 0.0],
                PairField::Slip => result.slip,
                PairField::Area => [result.area, 0.0, 0.0],
                PairField::Normal => result.met.normal,
                PairField::Closed => [result.closed, 0.0, 0.0],
            };
            let node = result.node as usize;
            values[count * node..count * (node + 1)].copy_from_slice(&numbers[..count]);
        }
        Ok(values)
    }

    /// The nodes of a pair that have a partner.
    pub(super) fn results_of<'a>(
        &'a self,
        pair: &'a Pair,
        answer: Option<&'a Answer>,
    ) -> impl Iterator<Item = NodeResult> + 'a {
        let dim = self.model.pairs.dim(pair);
        pair.nodes.iter().enumerate().filter_map(move |(k, &node)| {
            let (met, area) = (pair.met[k]?, pair.areas[k]);
            let mut result = NodeResult {
                node,
                met,
                area,
                force: 0.0,
                shear: ZERO,
                gap: met.gap,
                slip: ZERO,
                closed: 0.0,
            };
            let Some(answer) = answer else { return Some(result) };
            let along = |values: &[f64], first: usize, factor: f64| {
                (0..dim - 1).fold(ZERO, |sum, a| plus(sum, factor * values[first + a], met.tangents[a]))
            };
            if pair.is_tied {
                let first = pair.first + dim * k;
                (result.force, result.shear) = (-answer.mu[first], along(&answer.mu, first + 1, -1.0));
                result.closed = 2.0;
                return Some(result);
            }
            let row = pair.first + k;
            (result.force, result.gap) = (answer.lambda[row], answer.gaps[row]);
            let is_closed = matches!(answer.states[row], RowState::Closed | RowState::Weak);
            result.closed = if is_closed { 1.0 } else { 0.0 };
            if let Some(friction) = pair.friction.map(|first| first + k) {
                let first = (dim - 1) * friction;
                result.shear = along(&answer.tangential, first, -1.0);
                result.slip = along(&answer.slips, first, 1.0);
                result.closed = match answer.friction[friction] {
                    FrictionState::Stick | FrictionState::Weak if is_closed => 2.0,
                    FrictionState::Slip if is_closed => 3.0,
                    _ => result.closed,
                };
            }
            Some(result)
        })
    }

    /// The error with pair and slave node of the row that it names.
    pub(in crate::solver) fn with_pair(&self, mut error: Error) -> Error {
        let kind = error.place.kind.and_then(|kind| RowKind::ALL.get(kind).copied());
        if let (Some(row), Some(kind)) = (error.place.row, kind) {
            let dim = self.model.friction.dim.max(1);
            let row = if kind == RowKind::Tangential { row / dim } else { row };
            if let Some((pair, node)) = self.model.pairs.of_row(kind, row) {
                (error.place.pair, error.place.node) = (Some(pair), Some(node));
            }
        }
        error
    }
}
