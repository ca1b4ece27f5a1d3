//! What a rank gets of an answer.

use crate::body::{wire_struct, Wire};
use crate::certificate::{Certificate, Entry, FrictionState};
use crate::constraints::RowKind;
use crate::error::{Kind, Proof, Result};
use crate::model::Sizes;
use crate::progress::PhaseReport;
use crate::qp::{Counts, Tries};
use crate::ranks::{damaged, wire_enum};
use crate::setup::Work;
use crate::solve::{Answer, OfOthers, Outcome, Report, RowState, Slide};
use crate::solver::findings::Findings;
use crate::solver::together::failure::{put_kind, take_kind};

/// The results of one rank.
pub struct Share {
    /// Of its own bodies and rows.
    pub answer: Option<Answer>,
    /// On ranks other than 0, what the displacements of its parts are called there; none: these have none.
    pub names: Vec<Option<u64>>,
    pub findings: Findings,
}

wire_struct!(Share { answer, names, findings });
wire_struct!(Answer {
    report,
    u,
    lambda,
    mu,
    tangential,
    slips,
    friction,
    alpha,
    gaps,
    states,
    force_errors,
    failed,
    cleaned,
    without,
    of_others
});
wire_struct!(OfOthers { of_rows, of_glue, reached });
wire_struct!(Report {
    outcome,
    body,
    certificate,
    sizes,
    floating_modes,
    active,
    sticking,
    slipping,
    newton,
    starts,
    undetermined,
    unheld,
    slide,
    travelled,
    counts,
    tries,
    finished,
    gap_scale,
    work,
    energy,
    seconds_setup,
    seconds_solve,
    explicit_operators,
    implicit_operators,
    factor_bytes,
    operator_bytes,
    phases,
});
wire_struct!(Certificate {
    limit,
    equilibrium,
    balance,
    penetration,
    equality,
    negative_force,
    complementarity,
    friction_cone,
    friction_work,
    friction_stick,
    duality_gap,
    energy,
});
wire_struct!(Entry { figure, ratio, place, rank });
wire_struct!(Sizes { bodies, dofs, rows, equalities, nodes, tangential, dim });
wire_struct!(Slide { resisted, travel, body, held });
wire_struct!(Work { analyses, factorisations, columns_computed, columns_kept });
wire_struct!(Counts {
    products,
    conjugate_gradient,
    expansions,
    releases,
    coarse_solves,
    coarse_factorisations,
    preconditioned,
    direct,
    outer,
    newton,
    starts,
});
wire_enum!(Outcome { Solved, Marginal, Inaccurate, Stalled, Iterations, Time, Cancelled });
wire_enum!(RowState { Open, Closed, Weak, Unknown });
wire_enum!(FrictionState { Open, Stick, Slip, Weak, Unknown });

impl Wire for Tries {
    fn put(&self, to: &mut Vec<u8>) {
        self.all().to_vec().put(to);
    }

    fn take(from: &mut &[u8]) -> Result<Self> {
        Self::from_all(&Vec::<u32>::take(from)?).ok_or_else(damaged)
    }
}

impl Wire for PhaseReport {
    fn put(&self, to: &mut Vec<u8>) {
        (self.place(), (self.seconds, self.bytes)).put(to);
    }

    fn take(from: &mut &[u8]) -> Result<Self> {
        let (place, (seconds, bytes)) = Wire::take(from)?;
        Self::at(place, seconds, bytes).ok_or_else(damaged)
    }
}

impl Wire for Proof {
    fn put(&self, to: &mut Vec<u8>) {
        match self {
            Self::Motion { margin, v } => (true, (*margin, v.clone())).put(to),
            Self::Rows { margin, weights, heaviest } => {
                (false, (*margin, (weights.clone(), *heaviest))).put(to);
            }
        }
    }

    fn take(from: &mut &[u8]) -> Result<Self> {
        Ok(match bool::take(from)? {
            true => {
                let (margin, v) = Wire::take(from)?;
                Self::Motion { margin, v }
            }
            false => {
                let (margin, (weights, heaviest)) = Wire::take(from)?;
                Self::Rows { margin, weights, heaviest }
            }
        })
    }
}

/// Motions are computed where the coordinates are.
impl Wire for Findings {
    fn put(&self, to: &mut Vec<u8>) {
        self.end.ok().put(to);
        put_kind(self.end.err().unwrap_or(Kind::Internal), to);
        self.place.put(to);
        self.kind.map(|kind| kind as usize).put(to);
        self.proof.put(to);
        ((self.undetermined, self.unheld), self.capacity).put(to);
        self.redundant.put(to);
        [&self.untouched, &self.doubtful, &self.soft].into_iter().for_each(|list| list.put(to));
        self.contact.put(to);
    }

    fn take(from: &mut &[u8]) -> Result<Self> {
        let ended: Option<Outcome> = Wire::take(from)?;
        let end = ended.ok_or(take_kind(from)?);
        let place = Wire::take(from)?;
        let kind: Option<usize> = Wire::take(from)?;
        Ok(Self {
            end,
            place,
            kind: kind.and_then(|kind| RowKind::ALL.get(kind).copied()),
            proof: Wire::take(from)?,
            motion: None,
            undetermined: Wire::take(from)?,
            unheld: Wire::take(from)?,
            capacity: Wire::take(from)?,
            redundant: Wire::take(from)?,
            untouched: Wire::take(from)?,
            doubtful: Wire::take(from)?,
            soft: Wire::take(from)?,
            contact: Wire::take(from)?,
        })
    }
}
