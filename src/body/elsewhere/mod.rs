//! K+ and dual operators that another rank keeps: their names, and what rank 0 knows and asks of them.

mod asking;
mod body;
mod given;
mod joining;

pub use asking::{ask, Asking, Boundary, Entries, Multiply, Name, NullSpace, Owed, Solve, ABOUT_BODIES};
pub use body::{Away, BodyElsewhere, Enter, Entered, Facts, Give, GiveLoad, HostLoad};
pub use given::{BodyThere, GivenThere, LoadThere, PartThere};
pub use joining::{InIsland, Join, Joining};

use std::sync::Arc;

use crate::body::boundary::Inside;
use crate::error::{Error, Kind, Result};
use crate::linalg::{Matrix, Packed};
use crate::ranks::{damaged, Ranks, Token, Wire};

/// A K+ that another rank keeps, with its corrections for carried motions.
#[derive(Clone)]
pub struct Elsewhere {
    pub(super) kplus: Arc<Token>,
    /// Name of the K+ whose factor it uses: equal for all that share the factor.
    pub factor: u64,
    pub(super) motions: usize,
    pub(super) entries: usize,
    pub(super) is_rounded: bool,
    pub(super) carried: usize,
    pub(super) bytes_saved: usize,
}

/// `B K+ B'`, or S_b, that another rank keeps.
pub struct FormElsewhere {
    pub(super) token: Token,
    pub(super) order: usize,
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

    /// `R_p`, n x r.
    pub fn null_space(&self) -> Result<Matrix> {
        let of = NullSpace { kplus: self.number() };
        alone(&self.kplus, Asking::new(self.rank(), Name::NullSpace, of))
    }

    /// The rank that keeps it.
    pub fn rank(&self) -> usize {
        self.kplus.rank
    }

    /// Its name there.
    pub fn number(&self) -> u64 {
        self.kplus.number
    }

    /// The question for S_b of these dofs, to be kept there, and what stands for it here.
    pub fn boundary(&self, inside: Inside, scale: f64, dofs: Vec<usize>) -> (Asking, FormElsewhere) {
        let (token, order) = (self.kplus.ranks.token(self.rank()), dofs.len());
        let of = Boundary { kplus: self.number(), form: token.number, inside, scale, dofs };
        (Asking::new(self.rank(), Name::Boundary, of), FormElsewhere { token, order, explicit: true })
    }

    /// The question for `K+ x`; not `exact`: by the factor alone.
    pub fn solving(&self, exact: bool, x: Vec<f64>) -> Asking {
        Asking::new(self.rank(), Name::Solve, Solve { kplus: self.number(), exact, x })
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

    /// The question for the product with x, a share of a whole; without it, by a rounded factor alone.
    pub fn multiplying(&self, share: Option<f64>, x: Vec<f64>) -> Asking {
        Asking::new(self.token.rank, Name::Multiply, Multiply { form: self.token.number, share, x })
    }

    /// The product, which must have its length.
    pub fn image(&self, answer: Vec<f64>) -> Result<Vec<f64>> {
        Some(answer).filter(|image| image.len() == self.order).ok_or_else(damaged)
    }

    /// The ranks that answer.
    pub fn ranks(&self) -> &Arc<Ranks> {
        &self.token.ranks
    }

    /// The entries of these rows and columns.
    pub fn block(&self, rows: Vec<usize>) -> Result<Packed> {
        let of = Entries { form: self.token.number, rows };
        alone(&self.token, Asking::new(self.token.rank, Name::Entries, of))
    }
}

/// One question, and its answer.
fn alone<T: Wire>(of: &Token, asking: Asking) -> Result<T> {
    let missing = || Error::new(Kind::Internal, "a rank did not answer");
    ask(&of.ranks, vec![(0, asking)])?.answers()?.pop().ok_or_else(missing)?.1
}
