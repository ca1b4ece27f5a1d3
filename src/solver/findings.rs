//! What the last solve, or the last failed setup, has found about the problem, in more detail than the text of the error.

use crate::constraints::RowKind;
use crate::error::{Error, Kind, Place, Proof};
use crate::model::{kind_and_row, HostModel, SolvedModel};
use crate::setup::{Duals, Prepared};
use crate::solve::{Outcome, Report};

#[derive(Debug, Clone, PartialEq)]
pub struct Findings {
    /// The outcome with an answer, or the error kind without one.
    pub end: std::result::Result<Outcome, Kind>,
    /// Place of the failure.
    pub place: Place,
    /// Kind of the row of `place`, if a proof names it.
    pub kind: Option<RowKind>,
    /// Why there is no solution.
    pub proof: Option<Proof>,
    /// The motion of the proof on its body, for bodies with coordinates: velocity of the origin (length) and
    /// rotation about the axes.
    pub motion: Option<[f64; 6]>,
    /// Rigid motions that no closed row resists.
    pub undetermined: usize,
    /// The largest share of the load that nothing holds, over the groups of bodies that move together: |resultant| /
    /// |load|, no unit. If there is an answer, this share was treated as rounding of the load.
    pub unheld: f64,
    /// Part of the load along the motion of a slide that friction holds, no unit.
    pub capacity: Option<f64>,
    /// Rows that repeat the direction of another row, contact rows before equality rows, each with the factor from that
    /// row.
    pub redundant: Vec<(usize, f64)>,
    /// Bodies that no row touches.
    pub untouched: Vec<usize>,
    /// Bodies with motions whose resistance may be only rounding of the entries of K: `doubts` of their facts.
    pub doubtful: Vec<usize>,
    /// Bodies with motions of small positive or negative stiffness.
    pub soft: Vec<usize>,
    /// Number of contact rows.
    pub(super) contact: usize,
}

impl Findings {
    pub fn of_report(host: &HostModel, model: &SolvedModel, prepared: &Prepared, report: &Report) -> Self {
        let mut findings = Self::new(host, model, prepared, Ok(report.outcome));
        (findings.undetermined, findings.unheld) = (report.undetermined, report.unheld);
        findings.place.body = report.travelled.or(report.body);
        findings
    }

    /// `model` is the problem that was solved; `error` refers to the bodies of the host.
    pub fn of_error(host: &HostModel, model: &SolvedModel, prepared: &Prepared, error: &Error) -> Self {
        let mut findings = Self::new(host, model, prepared, Err(error.kind));
        findings.place = *error.place;
        findings.proof = error.proof.as_deref().cloned();
        match &findings.proof {
            Some(Proof::Rows { heaviest, .. }) => {
                findings.kind = Some(kind_and_row(*heaviest, findings.contact).0);
            }
            Some(Proof::Motion { v, .. }) => {
                let value = |kind| error.place.value.filter(|_| error.kind == kind);
                findings.unheld = value(Kind::LoadNotHeld).unwrap_or(0.0);
                findings.capacity = value(Kind::Slides);
                findings.motion = error.place.body.and_then(|body| rigid_motion(host, body, v));
            }
            None => {}
        }
        findings
    }

    fn new(
        host: &HostModel,
        model: &SolvedModel,
        prepared: &Prepared,
        end: std::result::Result<Outcome, Kind>,
    ) -> Self {
        let duals = prepared.duals(model);
        Self {
            end,
            place: Place::default(),
            kind: None,
            proof: None,
            motion: None,
            undetermined: 0,
            unheld: 0.0,
            capacity: None,
            redundant: duals.map(|duals| redundant(model, duals)).unwrap_or_default(),
            untouched: duals.map(|_| untouched(host)).unwrap_or_default(),
            doubtful: doubtful(model, prepared),
            soft: soft(model, prepared),
            contact: model.contact.len(),
        }
    }

    /// The motion of a proof on its body, if this rank has it.
    pub fn own_motion(&self, host: &HostModel, rank: usize) -> Option<[f64; 6]> {
        let Some(Proof::Motion { v, .. }) = &self.proof else { return None };
        rigid_motion(host, self.place.body.filter(|_| self.place.rank == Some(rank))?, v)
    }

    /// How clearly the problem has no solution.
    pub fn margin(&self) -> Option<f64> {
        self.proof.as_ref().map(|proof| match proof {
            Proof::Motion { margin, .. } | Proof::Rows { margin, .. } => *margin,
        })
    }

    /// Contradictory rows with their weights; if there is no contradiction, the redundant rows with their factors.
    pub fn rows(&self, kind: RowKind) -> impl Iterator<Item = (usize, f64)> + '_ {
        let listed = match &self.proof {
            Some(Proof::Rows { weights, .. }) => weights,
            _ => &self.redundant,
        };
        listed.iter().filter_map(move |&(i, weight)| {
            let (of, row) = kind_and_row(i, self.contact);
            (of == kind).then_some((row, weight))
        })
    }

    /// Number of rows that contradict each other.
    pub fn contradicting(&self) -> usize {
        match &self.proof {
            Some(Proof::Rows { weights, .. }) => weights.len(),
            _ => 0,
        }
    }
}

/// All rows of a group except the leader, with the factor from the leader, in the order of the stack.
pub fn redundant(model: &SolvedModel, duals: &Duals) -> Vec<(usize, f64)> {
    let mut all = Vec::new();
    for ready in &duals.islands {
        let (scale, grouping) = (&ready.rows.scaling.scale, &ready.rows.scaling.grouping);
        let leaders = &grouping.leaders;
        let repeats = grouping.members().filter(|(i, (group, _))| leaders[*group] != *i);
        let row = |i: usize| ready.island.in_stack(model.contact.len(), i);
        all.extend(repeats.map(|(i, (group, sign))| (row(i), sign * scale[leaders[group]] / scale[i])));
    }
    all.sort_by_key(|(row, _)| *row);
    all
}

/// Bodies with doubts about their null spaces.
fn doubtful(model: &SolvedModel, prepared: &Prepared) -> Vec<usize> {
    let doubts = |p: &usize| prepared.inverse(model, *p).is_some_and(|of| of.kplus.doubt.is_some());
    (0..model.bodies.len()).filter(doubts).collect()
}

/// Bodies with soft motions.
fn soft(model: &SolvedModel, prepared: &Prepared) -> Vec<usize> {
    let soft = |p: &usize| prepared.inverse(model, *p).is_some_and(|of| of.kplus.is_soft());
    (0..model.bodies.len()).filter(soft).collect()
}

/// Bodies of the host without glue that no row touches, or only rows that never close.
fn untouched(host: &HostModel) -> Vec<usize> {
    let mut touched = vec![false; host.bodies.len()];
    for rows in [&host.contact, &host.equalities] {
        for (j, _) in (0..rows.len()).filter(|&i| rows.is_finite(i)).flat_map(|i| rows.matrix.row(i)) {
            touched[host.offsets[1..].partition_point(|end| *end <= j)] = true;
        }
    }
    let joints = host.joints().unwrap_or_default();
    for j in joints.iter().flat_map(|joint| joint.ends) {
        touched[host.offsets[1..].partition_point(|end| *end <= j)] = true;
    }
    (0..touched.len()).filter(|&body| !touched[body]).collect()
}

/// A motion of all unknowns on one body with coordinates: velocity of the origin (length) and rotation about the axes.
pub fn rigid_motion(model: &HostModel, body: usize, v: &[f64]) -> Option<[f64; 6]> {
    let coordinates = model.bodies.get(body)?.body.coordinates.as_ref()?;
    coordinates.rigid_motion(v.get(model.range(body))?)
}
