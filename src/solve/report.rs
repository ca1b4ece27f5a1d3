//! The report of a solve to the host.

use crate::certificate::Certificate;
use crate::dual::Dual;
use crate::error::{Kind, Result};
use crate::linalg::Operator;
use crate::model::{Sizes, SolvedModel};
use crate::progress::PhaseReport;
use crate::qp;
use crate::setup::{Duals, Prepared, Work};
use crate::solve::slides::Slide;

/// How a solve ended with an answer; with several groups of bodies, the outcome that comes last in this list.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub enum Outcome {
    /// The certificate holds.
    Solved,
    /// Nothing holds a small part of the load, a body slides far along rows that hardly resist it, or moves so far that its
    /// strain is lost in the rounding of its displacement.
    Marginal,
    /// The dual is solved up to rounding, but the certificate does not hold.
    Inaccurate,
    /// The method could not improve an answer whose certificate does not hold.
    Stalled,
    /// The limit of steps was reached first.
    Iterations,
    /// The time limit was reached first.
    Time,
    Cancelled,
}

impl Outcome {
    /// The name of its status in C.
    pub fn status(&self) -> &'static str {
        self.named().0
    }

    /// What to do, as [`Kind::cure`].
    pub fn cure(&self) -> &'static str {
        self.named().1
    }

    fn named(&self) -> (&'static str, &'static str) {
        match self {
            Self::Solved => ("FETI_OK", ""),
            Self::Marginal => {
                ("FETI_MARGINAL", "go on; the log says which. data_accuracy is how small a resistance counts")
            }
            Self::Inaccurate => (
                "FETI_INACCURATE",
                "the certificate names the worst place (feti_check, feti_check_friction); K may be nearly singular or \
                 have few digits",
            ),
            Self::Stalled => (
                "FETI_STALLED",
                "smaller steps, another start, a larger direct_limit; then send a problem file",
            ),
            Self::Iterations => ("FETI_ITERATIONS", "raise max_steps"),
            Self::Time => (Kind::TimeOver.status(), Kind::TimeOver.cure()),
            Self::Cancelled => (Kind::Cancelled.status(), Kind::Cancelled.cure()),
        }
    }
}

#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum RowState {
    /// The gap is open, no force.
    Open,
    /// In contact, with a force.
    Closed,
    /// The gap is closed without a force, up to rounding.
    Weak,
    /// The bodies of the row are in a group that has no answer.
    Unknown,
}

#[derive(Debug, Clone, PartialEq)]
pub struct Report {
    pub outcome: Outcome,
    /// If there are several groups of bodies and not all are solved: the first body of the group with this outcome.
    pub body: Option<usize>,
    pub certificate: Certificate,
    pub sizes: Sizes,
    /// Dimension of the null spaces of all bodies.
    pub floating_modes: usize,
    /// Contact rows that are closed.
    pub active: usize,
    /// Nodes with friction that stick, and nodes that slip.
    pub sticking: usize,
    pub slipping: usize,
    /// Newton steps for friction, and the number of starts; 0 without friction.
    pub newton: usize,
    pub starts: usize,
    /// Rigid motions that no closed row resists: u is one of many.
    pub undetermined: usize,
    /// The largest share of the load that nothing holds, over the groups of bodies that move together: |resultant| /
    /// |load|, no unit.
    pub unheld: f64,
    /// The body that slides farthest, along a motion that rows with a force hardly resist.
    pub slide: Option<Slide>,
    /// A body that moves so far that its strain is lost in the rounding of its displacement.
    pub travelled: Option<usize>,
    /// Work of the methods on all islands.
    pub counts: qp::Counts,
    /// The second tries made.
    pub tries: qp::Tries,
    /// The direct finish (option `finish`) ran and its answer was kept.
    pub finished: bool,
    /// `|S|B||u|| + |S c|` at the first feasible forces, to which the tolerance of the dual is relative, `(force x
    /// length)^1/2`.
    pub gap_scale: f64,
    /// Work of all setups so far.
    pub work: Work,
    /// `1/2 u'K u - f'u + 1/2 lambda'C lambda + 1/2 mu'C mu`, force x length.
    pub energy: f64,
    pub seconds_setup: f64,
    pub seconds_solve: f64,
    /// Bodies whose dual operator is assembled, and bodies whose dual operator is applied matrix-free.
    pub explicit_operators: usize,
    pub implicit_operators: usize,
    /// Bytes of the factors, largest size of the work arrays of their computation, bytes of the assembled operators.
    pub factor_bytes: usize,
    pub operator_bytes: usize,
    /// Time and memory of every phase, in order.
    pub phases: Vec<PhaseReport>,
}

impl Report {
    /// The report before any island is solved.
    pub fn new(model: &SolvedModel, prepared: &Prepared) -> Result<Self> {
        let duals = prepared.done(model)?;
        let sum = |of: fn(&Dual) -> usize| duals.islands.iter().map(|ready| of(&ready.dual)).sum();
        Ok(Self {
            outcome: Outcome::Solved,
            body: None,
            certificate: Certificate::default(),
            sizes: model.sizes(),
            floating_modes: sum(Dual::modes),
            active: 0,
            sticking: 0,
            slipping: 0,
            newton: 0,
            starts: 0,
            undetermined: 0,
            unheld: 0.0,
            slide: None,
            travelled: None,
            counts: qp::Counts::default(),
            tries: qp::Tries::default(),
            finished: false,
            gap_scale: 0.0,
            work: Work::default(),
            energy: 0.0,
            seconds_setup: 0.0,
            seconds_solve: 0.0,
            explicit_operators: 0,
            implicit_operators: 0,
            factor_bytes: duals.operators.factor_bytes,
            operator_bytes: 0,
            phases: Vec::new(),
        })
    }

    /// Takes the work so far, and the dual operators, which solves may assemble.
    pub fn take_operators(&mut self, prepared: &Prepared, duals: &Duals) {
        let sum = |of: fn(&Dual) -> usize| duals.islands.iter().map(|ready| of(&ready.dual)).sum();
        self.work = prepared.work();
        self.explicit_operators = sum(Dual::explicit_bodies);
        self.implicit_operators = sum(Dual::implicit_bodies);
        self.operator_bytes = sum(Dual::bytes_kept);
    }
}
