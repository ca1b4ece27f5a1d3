//! Plans and analyses that another rank keeps: what is asked about them, and what rank 0 knows.

use std::sync::{Arc, Mutex, PoisonError};

use crate::body::elsewhere::{Asking, BodyElsewhere, Elsewhere, Name};
use crate::body::layout::{Layout, Symbolic};
use crate::body::plan::Plan;
use crate::body::planning::Planning;
use crate::body::rounded::Precision;
use crate::body::Body;
use crate::error::{Error, Kind, Result};
use crate::ranks::{wire_struct, Token};

/// Keeps the plan of a body. Answer: `Planned`.
pub(super) struct PlanBody {
    pub plan: u64,
    pub body: u64,
    pub with: Planning,
}

/// What rank 0 knows of a plan.
pub struct Planned {
    pub layout: Arc<Layout>,
    /// The null space is known.
    pub is_known: bool,
}

/// Takes over the first of these layouts that suits. Answer: which.
pub(super) struct Follow {
    pub plan: u64,
    pub layouts: Vec<Arc<Layout>>,
}

/// Keeps the analysis for the layout of a plan. Answer: `Analysis`.
pub(super) struct Analyse {
    pub plan: u64,
    pub symbolic: u64,
}

/// What rank 0 knows of a symbolic analysis.
#[derive(Clone, Copy)]
pub struct Analysis {
    /// Of the factor.
    pub entries: usize,
    pub bytes: usize,
}

/// Makes K+ by a plan: with the factor of the K+ `of` if given; otherwise by this analysis, with a factor of its own.
/// `further`: the name of the analysis if it has to be another. Answer: `Made`.
pub(super) struct Factorise {
    pub kplus: u64,
    pub plan: u64,
    pub symbolic: u64,
    pub further: u64,
    pub of: Option<u64>,
    pub precision: Precision,
}

wire_struct!(PlanBody { plan, body, with });
wire_struct!(Planned { layout, is_known });
wire_struct!(Follow { plan, layouts });
wire_struct!(Analyse { plan, symbolic });
wire_struct!(Analysis { entries, bytes });
wire_struct!(Factorise { kplus, plan, symbolic, further, of, precision });

/// A plan that another rank keeps.
pub struct PlanAway {
    name: Arc<Token>,
    pub of: Planned,
}

/// A K+ that another rank makes: its name, and that of a further analysis.
pub struct NewKplus {
    pub kplus: Arc<Token>,
    pub further: Arc<Token>,
}

/// A plan where its body is, until it is executed.
pub(super) struct PlanHere {
    pub body: Arc<Body>,
    plan: Mutex<Option<Plan>>,
}

impl From<&Symbolic> for Analysis {
    fn from(of: &Symbolic) -> Self {
        Self { entries: of.analysis.entries(), bytes: of.analysis.bytes() }
    }
}

impl From<&Plan> for Planned {
    fn from(plan: &Plan) -> Self {
        Self { layout: plan.layout(), is_known: plan.is_known() }
    }
}

impl BodyElsewhere {
    /// The question for the plan of the body, and its name.
    pub fn planning(&self, with: Planning) -> (Asking, Arc<Token>) {
        let token = Arc::new(self.token());
        let of = PlanBody { plan: token.number, body: self.name.number, with };
        (Asking::new(token.rank, Name::Plan, of), token)
    }
}

impl PlanAway {
    pub fn new(name: Arc<Token>, of: Planned) -> Self {
        Self { name, of }
    }

    pub fn following(&self, layouts: Vec<Arc<Layout>>) -> Asking {
        Asking::new(self.name.rank, Name::Follow, Follow { plan: self.name.number, layouts })
    }

    /// With the name of the analysis.
    pub fn analysing(&self) -> (Asking, Arc<Token>) {
        let token = self.token();
        let of = Analyse { plan: self.name.number, symbolic: token.number };
        (Asking::new(self.name.rank, Name::Analyse, of), token)
    }

    /// `of`: with the factor of this K+.
    pub fn factorising(
        &self,
        symbolic: &Token,
        of: Option<&Elsewhere>,
        precision: Precision,
    ) -> (Asking, NewKplus) {
        let new = NewKplus { kplus: self.token(), further: self.token() };
        let [kplus, further] = [&new.kplus, &new.further].map(|token| token.number);
        let (plan, symbolic, of) = (self.name.number, symbolic.number, of.map(Elsewhere::number));
        let of = Factorise { kplus, plan, symbolic, further, of, precision };
        (Asking::new(self.name.rank, Name::Factorise, of), new)
    }

    fn token(&self) -> Arc<Token> {
        Arc::new(self.name.ranks.token(self.name.rank))
    }
}

impl PlanHere {
    pub fn new(body: Arc<Body>, plan: Plan) -> Self {
        Self { body, plan: Mutex::new(Some(plan)) }
    }

    pub fn with<T>(&self, work: impl FnOnce(&mut Plan) -> Result<T>) -> Result<T> {
        let mut plan = self.plan.lock().unwrap_or_else(PoisonError::into_inner);
        work(plan.as_mut().ok_or_else(executed)?)
    }

    pub fn take(&self) -> Result<Plan> {
        self.plan.lock().unwrap_or_else(PoisonError::into_inner).take().ok_or_else(executed)
    }
}

fn executed() -> Error {
    Error::new(Kind::Internal, "a plan was executed before")
}
