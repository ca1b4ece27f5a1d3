//! Rows whose gaps no displacement satisfies: combinations of rows are tested on the data of the host.

use std::cell::{Cell, OnceCell};
use std::collections::HashMap;

use crate::body::Seen;
use crate::certificate::{led, Trace, NOISE};
use crate::constraints::RowKind;
use crate::error::{Error, Kind, Result};
use crate::linalg::twofold::Twofold;
use crate::linalg::vector::{norm, norm_max, ratio, weighted_norm};
use crate::linalg::Csr;
use crate::model::{contradiction, proof_of_rows};
use crate::numbers::linalg::ROOT;
use crate::numbers::solve::{BEYOND, TRAVELLED};
use crate::qp::{nearest_point, Polyhedron};
use crate::solve::case::Case;
use crate::solve::gaps::Gaps;
use crate::solve::work::work_of_loads;

/// Limit of multiplications of a finite search.
const WORK: usize = 10_000_000_000;

/// A combination of rows of the island, contact rows first, each with its weight times the scaled row `s_i b_i u <= s_i c_i`.
pub type Weights = Vec<(usize, f64)>;

/// Looks for proofs that the rows of an island contradict each other.
pub struct Contradictions<'a> {
    case: Case<'a>,
    gaps: &'a Gaps,
    /// V of the loads, force x length, if already computed.
    work: Cell<Option<f64>>,
    metric: OnceCell<Vec<f64>>,
}

/// Groups of rows that may contradict each other.
pub struct Among {
    pub groups: Vec<usize>,
    /// The unknowns that these groups touch, numbered from 0.
    place: HashMap<usize, usize>,
}

impl<'a> Contradictions<'a> {
    pub fn new(case: Case<'a>, gaps: &'a Gaps) -> Self {
        Self { case, gaps, work: Cell::new(None), metric: OnceCell::new() }
    }

    /// The error that names contradictory rows, if a combination w of the groups of the dual, or a search among its rows,
    /// proves the contradiction. Compliant rows contradict nothing.
    pub fn proved(&self, w: &[f64]) -> Result<Option<Error>> {
        let compliance = &self.case.ready.dual.compliance;
        let negligible = ROOT * norm_max(w);
        let counts = |group: &usize| compliance[*group] == 0.0 && w[*group].abs() > negligible;
        let groups: Vec<usize> = (0..w.len()).filter(counts).collect();
        let weights = groups.iter().map(|&group| (self.gaps.holder[group], w[group])).collect();
        match self.proof(weights)? {
            Some(error) => Ok(Some(error)),
            None => self.proved_among(&self.among(groups)),
        }
    }

    /// As `proved`, by a finite method for all of these groups, if they touch few unknowns: it finds the displacement of
    /// least |u|_D that satisfies the rows, or rows that no displacement satisfies.
    pub fn proved_among(&self, among: &Among) -> Result<Option<Error>> {
        let (rows, Among { groups, place }) = (&self.case.ready.rows, among);
        if among.work() > WORK {
            return Ok(None);
        }
        let (mut matrix, mut gap, mut of) = (Csr::empty(place.len()), Vec::new(), Vec::new());
        for &group in groups {
            let both = if self.gaps.bounded[group] { &[1.0][..] } else { &[1.0, -1.0] };
            for sign in both {
                let row = rows.scaled.row(group).map(|(j, v)| (place[&j], sign * v / rows.metric[j].sqrt()));
                matrix.push_row(row);
                gap.push(sign * self.gaps.value[group]);
                of.push((self.gaps.holder[group], *sign));
            }
        }
        let noise: Vec<f64> = gap.iter().map(|c| NOISE * c.abs()).collect();
        let target = vec![0.0; place.len()];
        let found = nearest_point(Polyhedron {
            rows: &matrix,
            gap: &gap,
            target: &target,
            noise: &noise,
            rounding: 0.0,
        });
        let found = match found {
            Ok(found) => found,
            Err(error) if error.kind == Kind::Internal => return Ok(None),
            Err(error) => return Err(error),
        };
        let of_rows = |w: Vec<(usize, f64)>| w.into_iter().map(|(k, w)| (of[k].0, of[k].1 * w)).collect();
        // the forces l of the nearest point u prove its distance best: B'l = -u, c'l = -|u|^2
        let far = norm(&found.point) > BEYOND * self.demand()?;
        let forces = found.forces.into_iter().enumerate().filter(|(_, force)| *force > 0.0);
        let forces = far.then(|| forces.collect());
        let mut proofs = found.contradictions.into_iter().chain(forces).map(|w| self.proof(of_rows(w)));
        proofs.find_map(Result::transpose).transpose()
    }

    /// These groups and the unknowns that they touch.
    pub fn among(&self, groups: Vec<usize>) -> Among {
        let mut place = HashMap::new();
        for (j, _) in groups.iter().flat_map(|&group| self.case.ready.rows.scaled.row(group)) {
            let next = place.len();
            place.entry(j).or_insert(next);
        }
        Among { groups, place }
    }

    /// `w'c + X |B'w|_{D^-1} + 64 eps (|w|'|c| + Y ||B|'|w||_{D^-1}) < 0` by the rows of the host: no displacement u with
    /// |u|_D < X satisfies them, even if c is the rounded B u of a displacement of size Y; X and Y are 10^6 and 10^3
    /// times the motion that rows demand and loads cause.
    pub fn proof(&self, mut weights: Weights) -> Result<Option<Error>> {
        let rows = &self.case.ready.rows;
        merge(&mut weights);
        let bounded = |i: usize| i < rows.contact;
        if weights.iter().any(|&(i, w)| bounded(i) && w < 0.0) {
            return Ok(None);
        }
        let unknowns = rows.scaled.cols;
        let (mut left, mut terms) = (vec![Twofold::default(); unknowns], vec![0.0; unknowns]);
        let (mut demanded, mut demands, mut taken) = (Twofold::default(), 0.0, 0.0);
        for &(i, w) in &weights {
            let (set, k) = self.case.ready.island.row(i);
            let weight = w * rows.scaling.scale[i];
            for (j, b) in set.matrix.row(k) {
                left[j].add_product(weight, b);
                terms[j] += (weight * b).abs();
            }
            demanded.add_product(weight, set.rhs[k]);
            demands += (weight * set.rhs[k]).abs();
            taken += (weight * set.rounding(k)).abs();
        }
        let left: Vec<f64> = left.into_iter().map(Twofold::value).collect();
        let metric = self.metric()?;
        let size = |x: &[f64]| weighted_norm(x, |j| 1.0 / metric[j]);
        let (left, terms, excess) = (size(&left), size(&terms), -demanded.value() - taken);
        let proves = |moved: f64| {
            excess > BEYOND * moved * left + NOISE * (demands + taken + TRAVELLED * moved * terms)
        };
        // the motion caused by the loads costs a product with K+
        let proved = proves(self.demand()?) && proves(self.moved()?);
        Ok(proved.then(|| self.named(&weights, excess, demands)))
    }

    /// V^1/2 of the loads, a length in the metric D / 2^p.
    fn moved(&self) -> Result<f64> {
        let work = match self.work.get() {
            Some(work) => work,
            None => work_of_loads(self.case)?,
        };
        self.work.set(Some(work));
        Ok((work / self.case.ready.island.unit).sqrt())
    }

    /// D^ of all rows, over U, where they touch.
    fn metric(&self) -> Result<&[f64]> {
        if let Some(metric) = self.metric.get() {
            return Ok(metric);
        }
        let (bodies, island) = (self.case.locals()?, self.case.island());
        let trace = Trace::of(&bodies, Seen::unit);
        let rows = RowKind::ALL.map(|kind| &island.members(kind).rows);
        let metric = led(&trace, rows, &|_, _| true, island.unit)?;
        Ok(self.metric.get_or_init(|| metric))
    }

    /// `|S c_-, S_H h|`: the motion that the rows demand, a length.
    fn demand(&self) -> Result<f64> {
        let (ready, metric) = (self.case.ready, self.metric()?);
        let of = |i: usize| {
            let (set, k) = ready.island.row(i);
            let c = if i < ready.rows.contact { (-set.rhs[k]).max(0.0) } else { set.rhs[k].abs() };
            ratio(c + set.rounding(k), set.yields(k, metric, ready.island.unit).sqrt())
        };
        let all: Vec<f64> = (0..ready.rows.scaling.scale.len()).map(of).collect();
        Ok(weighted_norm(&all, |_| 1.0))
    }

    fn named(&self, weights: &[(usize, f64)], excess: f64, demands: f64) -> Error {
        let Case { model, ready, .. } = self.case;
        let weight = |&(i, w): &(usize, f64)| (w * ready.rows.scaling.scale[i]).abs();
        let heavier = |best, at| if weight(at) >= weight(best) { at } else { best };
        let heaviest = weights.iter().fold(&weights[0], heavier).0;
        let (kind, row) = ready.island.kind_and_row(heaviest);
        let mut others: Vec<_> = weights.iter().map(|(i, _)| *i).filter(|i| *i != heaviest).collect();
        others.sort_unstable();
        let others: Vec<_> = others.into_iter().map(|i| ready.island.kind_and_row(i)).collect();
        let what = contradiction(kind, &others, &|of, row| model.number_of(of, row), &[]);
        let error =
            Error::new(Kind::GapsContradict, what).row(row).kind(kind as usize).value(-excess).limit(0.0);
        let place = |i: usize| ready.island.in_stack(model.contact.len(), i);
        let of_host = weights.iter().map(|&(i, w)| (place(i), w * ready.rows.scaling.scale[i])).collect();
        error.proved_by(proof_of_rows(excess / demands, of_host, place(heaviest)))
    }
}

impl Among {
    /// Multiplications of a finite search among them: for each row that joins or leaves, one rotation of the unknowns per
    /// active row.
    pub fn work(&self) -> usize {
        let (unknowns, active) = (self.place.len(), self.place.len().min(self.groups.len()));
        4usize.saturating_mul(unknowns).saturating_mul(active).saturating_mul(active)
    }
}

/// One weight per row, without zeros.
fn merge(weights: &mut Weights) {
    weights.sort_by_key(|(i, _)| *i);
    weights.dedup_by(|next, first| {
        let same = next.0 == first.0;
        first.1 += if same { next.1 } else { 0.0 };
        same
    });
    weights.retain(|(_, w)| *w != 0.0);
}
