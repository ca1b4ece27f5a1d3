//! A body in the dual problem of an island on its way to the rank that has its K+.

use std::sync::Arc;

use crate::body::elsewhere::asking::{Asking, Name};
use crate::body::elsewhere::{Elsewhere, FormElsewhere};
use crate::linalg::Csr;
use crate::ranks::{wire_struct, Token};

/// What an island makes of a body of n unknowns, of which rows touch t.
pub struct InIsland {
    /// Those of the touched unknowns that rows carry, ascending.
    pub carried: Vec<u32>,
    /// `D~ / 2^p` where rows touch, t.
    pub metric: Vec<f64>,
    /// 2^p, force / length.
    pub island: f64,
    /// R is divided by the size of G_p.
    pub balanced: bool,
}

wire_struct!(InIsland { carried, metric, island, balanced });

/// The question for such a body, which has entered the island: keep its part of the dual problem, with its dual operator.
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

/// A body that joins a dual problem. Answer: its part of G.
pub struct Joining {
    pub asking: Asking,
    pub form: Option<Arc<FormElsewhere>>,
}

impl Elsewhere {
    /// `form`: the dual operator is to be made, assembled or not, for these of the rows.
    pub fn joining(
        &self,
        member: &Token,
        rows: &Arc<Csr>,
        form: Option<(bool, Option<Vec<usize>>)>,
        by: f64,
        of: InIsland,
    ) -> Joining {
        let (new, form) = match form {
            None => (None, None),
            Some((explicit, of)) => {
                let token = self.kplus.ranks.token(self.rank());
                let order = of.as_ref().map_or(rows.rows(), Vec::len);
                let new = NewForm { name: token.number, explicit, rows: of };
                (Some(new), Some(Arc::new(FormElsewhere { token, order, explicit })))
            }
        };
        let (member, kplus) = (member.number, self.number());
        let join = Join { member, kplus, form: new, rows: Arc::clone(rows), by, of };
        Joining { asking: Asking::new(self.rank(), Name::Join, join), form }
    }
}
