//! K+ and dual operators that another rank keeps: their names, and what rank 0 knows and asks of them.

mod asking;

pub use asking::{ask, Asking, Assemble, Entries, Multiply, Name, Owed, Solve, ABOUT_BODIES};

use std::sync::Arc;

use crate::error::{Error, Kind, Result};
use crate::linalg::{Csr, Packed};
use crate::ranks::{damaged, Token, Wire};

/// A K+ that another rank keeps, with its corrections for carried motions.
#[derive(Clone)]
pub struct Elsewhere {
    pub(super) kplus: Arc<Token>,
    /// Name of the K+ whose factor it uses: equal for all that share the factor.
    pub factor: u64,
    pub(super) entries: usize,
    pub(super) is_rounded: bool,
    pub(super) carried: usize,
    pub(super) bytes_saved: usize,
}

/// `B K+ B'` that another rank keeps.
pub struct FormElsewhere {
    token: Token,
    order: usize,
    /// It is assembled there.
    pub explicit: bool,
}

impl Elsewhere {
    /// `x <- K+ x`; not `exact`: by the factor alone, which may be rounded.
    pub fn solve(&self, exact: bool, x: &mut [f64]) -> Result<()> {
        let solution: Vec<f64> = alone(&self.kplus, self.solving(exact, x.to_vec()))?;
        if x.len() != solution.len() {
            return Err(damaged());
        }
        x.copy_from_slice(&solution);
        Ok(())
    }

    /// `B K+ B'`, brought here.
    pub fn inverse_form(&self, rows: &Csr) -> Result<Packed> {
        let (asking, form) = self.operator(&Arc::new(rows.clone()), false);
        alone::<()>(&self.kplus, asking)?;
        form.block((0..rows.rows()).collect())
    }

    /// The rank that keeps it.
    pub fn rank(&self) -> usize {
        self.kplus.rank
    }

    pub(super) fn name(&self) -> u64 {
        self.kplus.number
    }

    /// The question for `B K+ B'`, to be kept there, and what stands for it here; assembled if `explicit`.
    pub fn operator(&self, rows: &Arc<Csr>, explicit: bool) -> (Asking, FormElsewhere) {
        let (token, order) = (self.kplus.ranks.token(self.rank()), rows.rows());
        let of = Assemble { kplus: self.name(), form: token.number, explicit, rows: Arc::clone(rows) };
        (Asking::new(self.rank(), Name::Assemble, &of), FormElsewhere { token, order, explicit })
    }

    /// The question for `K+ x`; not `exact`: by the factor alone.
    pub fn solving(&self, exact: bool, x: Vec<f64>) -> Asking {
        Asking::new(self.rank(), Name::Solve, &Solve { kplus: self.name(), exact, x })
    }

    /// Asks questions about several bodies.
    pub fn ask(&self, questions: Vec<(usize, Asking)>) -> Result<Owed> {
        ask(&self.kplus.ranks, questions)
    }
}

impl FormElsewhere {
    pub fn order(&self) -> usize {
        self.order
    }

    /// The question for the product with x; not `exact`: by a rounded factor alone.
    pub fn multiplying(&self, exact: bool, x: Vec<f64>) -> Asking {
        Asking::new(self.token.rank, Name::Multiply, &Multiply { form: self.token.number, exact, x })
    }

    /// The entries of these rows and columns.
    pub fn block(&self, rows: Vec<usize>) -> Result<Packed> {
        let of = Entries { form: self.token.number, rows };
        alone(&self.token, Asking::new(self.token.rank, Name::Entries, &of))
    }
}

/// One question, and its answer.
fn alone<T: Wire>(of: &Token, asking: Asking) -> Result<T> {
    let missing = || Error::new(Kind::Internal, "a rank did not answer");
    ask(&of.ranks, vec![(0, asking)])?.answers()?.pop().ok_or_else(missing)?.1
}
