//! The rows of the dual problem of an island, made from the host's rows: scaled, one for each group of parallel rows, decoupled.

use std::sync::Arc;

use crate::constraints::{row_scales, Decoupling, Grouping, RowKind, UnitRows};
use crate::error::Result;
use crate::linalg::hash::hash;
use crate::linalg::vector::NOISE;
use crate::linalg::Csr;
use crate::model::Lengths;
use crate::numbers::setup::UNEVEN_STIFFNESS;
use crate::setup::islands::{Island, Members};
use crate::setup::scaling::Scaling;

/// Rows of the dual, and their relation to the host's rows.
#[derive(PartialEq)]
pub struct DualRows {
    /// One row per group of parallel rows of `S [B; H]`.
    pub scaled: Arc<Csr>,
    /// B' of `scaled = L B'`, from which F and G are formed.
    pub matrix: Arc<Csr>,
    /// `D~ / 2^p` at the unknowns that rows touch.
    pub metric: Vec<f64>,
    pub scaling: Scaling,
    /// L = I: the rows are not decoupled.
    pub coupled: bool,
    /// Number of contact rows.
    pub contact: usize,
    /// The first tangential row of the stack.
    pub tangential: usize,
    /// Some row joins bodies with very different stiffnesses at the row, or some unknown is carried.
    pub uneven: bool,
}

/// Some row joins bodies whose parts of `b D^-1 b'` have a ratio above `UNEVEN_STIFFNESS`.
fn is_uneven(rows: &Csr, metric: &[f64], island: &Island) -> bool {
    (0..rows.rows()).any(|i| {
        let mut shares: Vec<(usize, f64)> = Vec::new();
        for (j, v) in rows.row(i) {
            let share = v * v / metric[j];
            let body = island.touched.body_of(j);
            match shares.last_mut() {
                Some(last) if last.0 == body => last.1 += share,
                _ => shares.push((body, share)),
            }
        }
        let most = shares.iter().map(|share| share.1).fold(0.0, f64::max);
        shares.iter().any(|share| UNEVEN_STIFFNESS * share.1 < most)
    })
}

/// `s_t = 1/rms(1/s_k)` for all rows of a node, so that discs of forces remain discs; that of its contact row if none of them
/// has entries.
fn one_scale(scales: &mut [f64], normal: Option<f64>) {
    // rows without entries have the length 0
    let squares = scales.iter().filter(|s| **s > 0.0).map(|s| s.powi(-2)).sum::<f64>();
    let own = (squares / scales.len() as f64).sqrt().recip();
    scales.fill(normal.filter(|_| squares == 0.0).unwrap_or(own));
}

impl DualRows {
    /// The rows of an island, and the diagonal of C' with `2^p S C S = L C'L'`: 1/k without unit, 0 for rigid rows; `metric`:
    /// D~ / 2^p at the unknowns that they touch. `coupled` rows are those of the host, only scaled.
    pub fn of(island: &Island, metric: Vec<f64>, coupled: bool) -> Result<(Self, Vec<f64>)> {
        let mut all = Csr::empty(metric.len());
        let (mut scale, mut compliances) = (Vec::new(), Vec::new());
        for kind in RowKind::ALL {
            let Members { numbers, rows } = island.members(kind);
            let mut scales = row_scales(rows, &metric, island.unit);
            rows.check_scales(kind, &scales).map_err(|e| match e.place.row {
                Some(row) => e.row(numbers[row]),
                None => e,
            })?;
            if kind == RowKind::Tangential {
                for node in &island.friction.nodes {
                    one_scale(&mut scales[node.rows()], node.normal.map(|row| scale[row]));
                }
            }
            for (i, s) in scales.iter().enumerate() {
                all.push_row(rows.matrix.row(i).map(|(j, v)| (j, s * v)));
                compliances.push(s * s * (island.unit * rows.compliance[i]));
            }
            scale.extend(scales);
        }
        let contact = island.contact.numbers.len();
        let tangential = contact + island.equalities.numbers.len();
        let grouping = Grouping::of(&all, (contact, tangential), &metric, |i| compliances[i] > 0.0);
        let entries = grouping.leaders.iter().map(|&leader| all.row(leader).count()).sum();
        let mut scaled = Csr::with_room(metric.len(), grouping.leaders.len(), entries);
        grouping.leaders.iter().for_each(|&leader| scaled.push_row(all.row(leader)));
        let compliance: Vec<f64> = grouping.leaders.iter().map(|&leader| compliances[leader]).collect();
        let first = grouping.led_before(tangential);
        let equalities = first - grouping.led_before(contact);
        let nodes = island.friction.nodes.iter().map(|node| first + node.first..first + node.rows().end);
        let nodes: Vec<_> = nodes.collect();
        let given =
            UnitRows { matrix: &scaled, equalities, nodes: &nodes, compliance: &compliance, metric: &metric };
        let (decoupling, matrix) =
            if coupled { (Decoupling::none(scaled.rows()), None) } else { Decoupling::of(given)? };
        let compliance = decoupling.compliance(&compliance);
        let uneven = is_uneven(&scaled, &metric, island);
        let scaled = Arc::new(scaled);
        let matrix = matrix.map_or_else(|| Arc::clone(&scaled), Arc::new);
        let scaling = Scaling { unit: island.unit, scale, grouping, decoupling };
        let rows = Self { scaled, matrix, metric, scaling, coupled, contact, tangential, uneven };
        Ok((rows, compliance))
    }

    /// Hash key of the rows.
    pub fn key(&self) -> u64 {
        hash(self.scaled.key(), self.metric.iter().map(|d| d.to_bits()))
    }

    /// Parallel contact rows whose gaps agree to the accuracy of the data have the tightest of these gaps: what is taken from the
    /// others is rounding.
    pub fn level_gaps(&self, island: &mut Island, lengths: &Lengths) {
        let Members { numbers, rows } = &mut island.contact;
        let mut tightest = vec![f64::INFINITY; self.groups()];
        let members = || {
            let contact = self.scaling.grouping.members().take_while(|(i, _)| *i < self.contact);
            contact.filter(|(_, (group, _))| self.kind(*group) == RowKind::Inequality)
        };
        let scale = &self.scaling.scale;
        for (i, (group, _)) in members() {
            tightest[group] = tightest[group].min(scale[i] * rows.rhs[i]);
        }
        for (i, (group, _)) in members() {
            let (given, level) = (rows.rhs[i], tightest[group] / scale[i]);
            let slack = || lengths.rounding(RowKind::Inequality, numbers[i]).max(NOISE * given.abs());
            if scale[i] * given != tightest[group] && given - level <= slack() {
                rows.rhs[i] = level;
                let taken = &mut rows.taken.get_or_insert_default().rhs;
                taken.resize(numbers.len(), 0.0);
                taken[i] += (given - level).abs();
            }
        }
    }

    /// The first group that is a tangential row; all groups after it are tangential rows.
    pub fn first_tangential(&self) -> usize {
        self.scaling.grouping.led_before(self.tangential)
    }

    pub fn groups(&self) -> usize {
        self.scaling.grouping.leaders.len()
    }

    /// Some group has several rows.
    pub fn some_are_parallel(&self) -> bool {
        self.groups() < self.scaling.scale.len()
    }

    /// Kind of the multiplier of a group.
    pub fn kind(&self, group: usize) -> RowKind {
        self.scaling.grouping.kind(group, self.contact, self.tangential)
    }
}
