//! Questions about bodies on their way to other ranks, and the answers that are owed.

use std::sync::Arc;

use crate::body::boundary::Inside;
use crate::error::Result;
use crate::ranks::{damaged, value, wire_enum, wire_struct, Asked, Put, Ranks, Request, Wire};

/// Requests of this number are lists of questions about bodies; the answer is the list of answers, each perhaps an error.
pub const ABOUT_BODIES: u32 = 1;

/// Lists the names once, for their numbers and their texts.
macro_rules! names {
    ($($(#[$doc:meta])* $name:ident),+ $(,)?) => {
        /// What rank 0 asks about a body: a closed list.
        #[derive(Debug, Clone, Copy, PartialEq, Eq)]
        pub enum Name {
            $($(#[$doc])* $name),+
        }

        wire_enum!(Name { $($name),+ });

        impl Name {
            pub const ALL: &[Self] = &[$(Self::$name),+];
        }
    };
}

names! {
    /// `Give`: keep a body. Answer: nothing.
    Give,
    /// `GiveLoad`: keep the load of a body. Answer: nothing.
    GiveLoad,
    /// `Enter`: keep a body in an island. Answer: `Entered`.
    Enter,
    /// `PlanBody`: keep the plan of K+ of a body. Answer: `Planned`.
    Plan,
    /// `Follow`: take over a layout. Answer: which of those offered.
    Follow,
    /// `Analyse`: keep a symbolic analysis. Answer: `Analysis`.
    Analyse,
    /// `Factorise`: keep a K+. Answer: `Made`.
    Factorise,
    /// `Boundary`: keep S_b. Answer: nothing.
    Boundary,
    /// `Multiply`. Answer: `B K+ B' x`, or `S_b x`.
    Multiply,
    /// `Entries`. Answer: the entries of `B K+ B'` in these rows and columns.
    Entries,
    /// `Solve`. Answer: `K+ x`.
    Solve,
    /// `NullSpace`. Answer: `R_p`.
    NullSpace,
    /// `Join`: keep the part of a body in the dual problem of its island, and its dual operator. Answer: its part of G. The
    /// names below are questions about a body of an island (`local::Question`).
    Join,
    Put,
    Bring,
    Section,
    Couple,
    Fit,
    Measure,
    Largest,
    SizeOfLoad,
    Way,
    Lend,
    LoadOf,
    Scale,
    FromLoad,
    Take,
    Loaded,
    Displace,
    Turn,
    Slide,
    Begin,
    Shift,
    Strained,
    Residual,
    Correct,
    Added,
    PointAtRows,
    Displacement,
    Deformation,
    Rigid,
    Basis,
    Split,
    Along,
    FreeMotions,
    Place,
    Energy,
    Negate,
    Sizes,
    Left,
    Proof,
    Work,
}

/// S_b of a body whose K+ is there, times `scale`, of these dofs.
pub struct Boundary {
    pub kplus: u64,
    pub form: u64,
    pub inside: Inside,
    pub scale: f64,
    pub dofs: Vec<usize>,
}

/// Without a share of a whole: by the factor alone, which may be rounded.
pub struct Multiply {
    pub form: u64,
    pub share: Option<f64>,
    pub x: Vec<f64>,
}

pub struct Entries {
    pub form: u64,
    pub rows: Vec<usize>,
}

/// Not `exact`: by the factor alone, which may be rounded.
pub struct Solve {
    pub kplus: u64,
    pub exact: bool,
    pub x: Vec<f64>,
}

wire_struct!(Boundary { kplus, form, inside, scale, dofs });
wire_struct!(Multiply { form, share, x });
wire_struct!(Entries { form, rows });
wire_struct!(Solve { kplus, exact, x });
wire_struct!(NullSpace { kplus });

pub struct NullSpace {
    pub kplus: u64,
}

/// A question to one rank.
pub struct Asking {
    rank: usize,
    put: Put,
}

impl Asking {
    pub fn new(rank: usize, name: Name, of: impl Wire + 'static) -> Self {
        let put = move |to: &mut Vec<u8>| {
            name.put(to);
            of.put(to);
        };
        Self { rank, put: Box::new(put) }
    }
}

/// The answers that ranks owe: of each rank the bodies asked about, in the order of the questions.
pub struct Owed {
    asked: Option<Asked>,
    bodies: Vec<Vec<usize>>,
}

/// Asks these questions about these bodies, one request to each rank.
pub fn ask(ranks: &Arc<Ranks>, questions: Vec<(usize, Asking)>) -> Result<Owed> {
    let mut of_rank: Vec<(Vec<usize>, Vec<Put>)> = (0..ranks.size).map(|_| Default::default()).collect();
    for (body, Asking { rank, put }) in questions {
        of_rank[rank].0.push(body);
        of_rank[rank].1.push(put);
    }
    let (mut requests, mut bodies) = (Vec::new(), Vec::new());
    for (rank, (own, questions)) in of_rank.into_iter().enumerate().filter(|(_, of)| !of.0.is_empty()) {
        let put = |to: &mut Vec<u8>| {
            questions.len().put(to);
            questions.into_iter().for_each(|put| put(to));
        };
        requests.push(Request { rank, question: ABOUT_BODIES, put: Box::new(put) });
        bodies.push(own);
    }
    let asked = if requests.is_empty() { None } else { Some(ranks.ask(requests)?) };
    Ok(Owed { asked, bodies })
}

impl Owed {
    /// No rank owes anything.
    pub fn nothing() -> Self {
        Self { asked: None, bodies: Vec::new() }
    }

    /// Every body with its answer, rank after rank.
    pub fn answers<T: Wire>(self) -> Result<Vec<(usize, Result<T>)>> {
        let answers = self.asked.map_or(Ok(Vec::new()), Asked::answers)?;
        let mut all = Vec::new();
        for (bodies, answer) in self.bodies.into_iter().zip(answers) {
            let own: Vec<Result<T>> = value(&answer?)?;
            if own.len() != bodies.len() {
                return Err(damaged());
            }
            all.extend(bodies.into_iter().zip(own));
        }
        Ok(all)
    }
}
