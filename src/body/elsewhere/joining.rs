//! A body in the dual problem of an island on its way to the rank that has its K+, and what rank 0 knows of it.

use std::sync::Arc;

use crate::body::coarse::Coarse;
use crate::body::elsewhere::asking::{Asking, Name};
use crate::body::elsewhere::{Elsewhere, FormElsewhere};
use crate::linalg::Csr;
use crate::ranks::{wire_struct, Token};

/// What an island makes of a body of n unknowns.
pub struct InIsland {
    /// The t unknowns that rows touch, ascending, and those of them that rows carry.
    pub touched: Vec<u32>,
    pub carried: Vec<u32>,
    /// `D~ / 2^p` where rows touch, t.
    pub metric: Vec<f64>,
    /// The metric of dofs without stiffness, and 2^p, force / length.
    pub unit: f64,
    pub island: f64,
    /// R is divided by the size of G_p.
    pub balanced: bool,
}

wire_struct!(InIsland { touched, carried, metric, unit, island, balanced });

/// The question for such a body: keep it, with its dual operator.
pub struct Join {
    pub member: u64,
    pub kplus: u64,
    pub form: Option<NewForm>,
    /// B_p, m_p x n.
    pub rows: Arc<Csr>,
    /// Power of two by which K+ is multiplied.
    pub by: f64,
    pub of: InIsland,
}

wire_struct!(Join { member, kplus, form, rows, by, of });

/// `B K+ B'`, assembled if `explicit`; otherwise K+ and B are kept.
pub struct NewForm {
    pub name: u64,
    pub explicit: bool,
    /// The rows of B among those of the body; none: all.
    pub rows: Option<Vec<usize>>,
}

wire_struct!(NewForm { name, explicit, rows });

/// The answer: what rank 0 has to know of the body.
pub struct Joined {
    pub coarse: Coarse,
    /// Of K.
    pub entries: usize,
    /// D where rows touch, t, 0 without stiffness; the largest D of the body; force / length.
    pub diagonal: Vec<f64>,
    pub stiffest: f64,
}

wire_struct!(Joined { coarse, entries, diagonal, stiffest });

/// A body of an island on another rank.
pub struct Away {
    pub name: Token,
    /// Number of unknowns n, and of entries of K.
    pub order: usize,
    pub entries: usize,
    /// The metric of dofs without stiffness, force / length.
    pub unit: f64,
    /// As in `Joined`.
    pub diagonal: Vec<f64>,
    pub stiffest: f64,
}

/// A body that joins an island.
pub struct Joining {
    /// Until it is asked.
    pub asking: Option<Asking>,
    pub form: Option<Arc<FormElsewhere>>,
    name: Token,
    order: usize,
    unit: f64,
}

impl Elsewhere {
    /// `form`: the dual operator is to be made, assembled or not, for these of the rows.
    pub fn joining(
        &self,
        rows: &Arc<Csr>,
        form: Option<(bool, Option<Vec<usize>>)>,
        by: f64,
        of: InIsland,
    ) -> Joining {
        let token = || self.kplus.ranks.token(self.rank());
        let (name, order, unit) = (token(), rows.cols, of.unit);
        let (new, form) = match form {
            None => (None, None),
            Some((explicit, of)) => {
                let (token, order) = (token(), of.as_ref().map_or(rows.rows(), Vec::len));
                let new = NewForm { name: token.number, explicit, rows: of };
                (Some(new), Some(Arc::new(FormElsewhere { token, order, explicit })))
            }
        };
        let (member, kplus) = (name.number, self.name());
        let join = Join { member, kplus, form: new, rows: Arc::clone(rows), by, of };
        Joining { asking: Some(Asking::new(self.rank(), Name::Join, join)), form, name, order, unit }
    }
}

impl Away {
    /// From the answer; and its part of G.
    pub fn of(joining: Joining, Joined { coarse, entries, diagonal, stiffest }: Joined) -> (Self, Coarse) {
        let Joining { name, order, unit, .. } = joining;
        (Self { name, order, entries, unit, diagonal, stiffest }, coarse)
    }
}
