//! Results of a pair at the nodes of its slave.

use crate::certificate::{Certificate, FrictionState};
use crate::constraints::RowKind;
use crate::error::{number, Error, Kind, Result};
use crate::model::{Met, Pair};
use crate::platform::memory::zeros;
use crate::solve::{Answer, RowState};
use crate::solver::problem::Problem;
use crate::surface::vector::{plus, times, unit, Vector, ZERO};

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
    /// On the slave, about the origin.
    pub moment: Vector,
    pub gap: f64,
    pub slip: Vector,
    pub closed: f64,
}

impl Problem {
    /// How many values `pair_field` returns.
    pub fn pair_field_len(&self, pair: usize, field: PairField) -> Result<usize> {
        let of = self.model.pairs.pair(pair)?;
        let nodes = self.model.pairs.surfaces[of.slave].len();
        Ok(if field.is_vector() { self.model.pairs.dim(of) * nodes } else { nodes })
    }

    /// Slave nodes of a pair that have a row, and the dimensions of its surfaces.
    #[doc(hidden)]
    pub fn pair_rows(&self, pair: usize) -> Result<(usize, usize)> {
        let of = self.model.pairs.pair(pair)?;
        Ok((of.nodes.len(), self.model.pairs.dim(of)))
    }

    /// Values at the nodes of the slave surface as given, `values` with `1` or `dim` numbers for each; 0 where a node has no partner.
    pub fn pair_field(&self, pair: usize, field: PairField) -> Result<Vec<f64>> {
        let of = self.model.pairs.pair(pair)?;
        let count = if field.is_vector() { self.model.pairs.dim(of) } else { 1 };
        let mut values = zeros(self.pair_field_len(pair, field)?, "a field of a pair")?;
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
                PairField::Normal => unit(result.met.normal).unwrap_or(ZERO),
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
                moment: ZERO,
                gap: met.gap,
                slip: ZERO,
                closed: 0.0,
            };
            let Some(answer) = answer else { return Some(result) };
            let sum = |of: &[Vector], values: &[f64], first: usize, factor: f64| {
                (0..dim - 1).fold(ZERO, |sum, a| plus(sum, factor * values[first + a], of[a]))
            };
            let along = |values: &[f64], first: usize, factor: f64| sum(&met.tangents, values, first, factor);
            let moment = |values: &[f64], first: usize| sum(&met.moments[1..], values, first, -1.0);
            if pair.is_tied {
                let first = pair.first + dim * k;
                (result.force, result.shear) = (-answer.mu[first], along(&answer.mu, first + 1, -1.0));
                result.moment = plus(moment(&answer.mu, first + 1), -result.force, met.moments[0]);
                result.closed = 2.0;
                return Some(result);
            }
            let row = pair.first + k;
            (result.force, result.gap) = (answer.lambda[row], answer.gaps[row]);
            result.moment = times(-result.force, met.moments[0]);
            let is_closed = matches!(answer.states[row], RowState::Closed | RowState::Weak);
            result.closed = if is_closed { 1.0 } else { 0.0 };
            if let Some(friction) = pair.friction.map(|first| first + k) {
                let first = (dim - 1) * friction;
                result.shear = along(&answer.tangential, first, -1.0);
                let directions = met.tangents.map(|t| unit(t).unwrap_or(ZERO));
                result.slip = sum(&directions, &answer.slips, first, 1.0);
                result.moment = plus(result.moment, 1.0, moment(&answer.tangential, first));
                result.closed = match answer.friction[friction] {
                    FrictionState::Stick | FrictionState::Weak if is_closed => 2.0,
                    FrictionState::Slip if is_closed => 3.0,
                    _ => result.closed,
                };
            }
            Some(result)
        })
    }

    /// The error with pair and slave node of the row that it names; if a load is not held, also with a pair that has met nothing.
    pub(in crate::solver) fn with_pair(&self, mut error: Error) -> Error {
        let kind = error.place.kind.and_then(|kind| RowKind::ALL.get(kind).copied());
        if let (Some(row), Some(kind)) = (error.place.row, kind) {
            let dim = self.model.friction.dim.max(1);
            let row = if kind == RowKind::Tangential { row / dim } else { row };
            if let Some((pair, node)) = self.model.pairs.of_row(kind, row) {
                (error.place.pair, error.place.node) = (Some(pair), Some(node));
            }
        }
        if error.kind == Kind::LoadNotHeld {
            error.what.push_str(&self.pair_without_partners());
        }
        error
    }

    /// Names the first pair of which no node has a partner, if there is one that is on.
    fn pair_without_partners(&self) -> String {
        let is_alone = |pair: &Pair| pair.laws.scalars.is_on && pair.met.iter().all(Option::is_none);
        let pairs = &self.model.pairs.pairs;
        let Some(first) = pairs.iter().position(is_alone) else { return String::new() };
        let (pair, name) = (&pairs[first], number(first as i64));
        if pair.adjusted.is_none() && pair.tied.is_none() {
            return format!("; pair {name}: no find has made its rows yet");
        }
        format!(
            "; pair {name}: none of its {} nodes has a partner: do the faces run the wrong way round, or is distance too small?",
            pair.nodes.len()
        )
    }

    /// Pair and slave node of the row, or of the node with friction, that is worst in a certificate; none if it belongs to no pair.
    pub fn worst_pair(&self, certificate: &Certificate) -> Option<(usize, usize)> {
        let entries = certificate.entries();
        let (k, worst) = entries.iter().enumerate().max_by(|(_, a), (_, b)| a.ratio.total_cmp(&b.ratio))?;
        let kind = match Certificate::NAMES[k].1 {
            "contact row" => RowKind::Inequality,
            "equality row" => RowKind::Equality,
            "node" => RowKind::Tangential,
            _ => return None,
        };
        self.model.pairs.of_row(kind, worst.place?)
    }
}
