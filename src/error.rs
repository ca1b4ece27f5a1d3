//! The one error type: what was wrong, where, and by how much.

use std::fmt;

/// What kind of failure; the C ABI gives every kind its own status.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Kind {
    /// The named argument of the called function was refused.
    Argument(&'static str),
    /// Memory could not be reserved, or the memory limit would be exceeded.
    Memory,
    /// Something the call needs has not been given yet.
    State,
    /// The load has a component that no contact force can balance: the dual (12) is infeasible.
    LoadNotHeld,
    /// Bodies slide steadily: friction holds a part of the load, and no rest was found.
    Slides,
    /// Rows of `B u <= c`, `H u = h` contradict each other.
    GapsContradict,
    /// A given null space is not one, or is incomplete.
    NullSpace,
    /// A stiffness matrix is not positive definite on its range.
    Indefinite,
    /// A number does not fit the index type.
    Overflow,
    /// A result of the library contradicts itself; never the host's fault.
    Internal,
    /// The request is valid but not available.
    Unsupported,
    /// The host cancelled before there was an answer.
    Cancelled,
    /// The time was over before there was an answer.
    TimeOver,
    /// A function of the host reported a failure.
    Callback,
    /// A file could not be read or written, or it is damaged.
    Io,
    /// Another rank cannot be reached, or runs another build of the library.
    Communication,
}

impl Kind {
    /// All that have no argument.
    pub const ALL: [Self; 15] = [
        Self::Memory,
        Self::State,
        Self::LoadNotHeld,
        Self::Slides,
        Self::GapsContradict,
        Self::NullSpace,
        Self::Indefinite,
        Self::Overflow,
        Self::Internal,
        Self::Unsupported,
        Self::Cancelled,
        Self::TimeOver,
        Self::Callback,
        Self::Io,
        Self::Communication,
    ];

    /// The name of its status in C.
    pub fn status(&self) -> &'static str {
        self.named().0
    }

    /// What to do; docs/statuses.md has these texts, with links.
    pub fn cure(&self) -> &'static str {
        self.named().1
    }

    fn named(&self) -> (&'static str, &'static str) {
        match self {
            Self::Argument(_) => (
                "FETI_ARGUMENT",
                "the text names the entry. NaN or infinity in K, f or gaps: the loop diverges, cut the step",
            ),
            Self::Memory => {
                ("FETI_MEMORY", "end, or set memory_limit: dual operators that do not fit become implicit")
            }
            Self::State => ("FETI_STATE", "order of calls; the text says what is missing"),
            Self::LoadNotHeld => (
                "FETI_LOAD_NOT_HELD",
                "usually a pair is missing, or its normal has the wrong sign: give rows to all pairs that could close, \
                 not only to closed ones. Or reduce the load, or add a support",
            ),
            Self::Slides => ("FETI_SLIDES", "cut the step, support the body, or add the missing pressure"),
            Self::GapsContradict => (
                "FETI_GAPS_CONTRADICT",
                "check gaps and their signs; cut the step; make rows compliant (feti_rows_compliance)",
            ),
            Self::NullSpace => (
                "FETI_NULL_SPACE",
                "correct the motions; a basis of an old position has to be given anew. K with stress or curvature terms: soft \
                 motions. In doubt give coordinates, or nothing",
            ),
            Self::Indefinite => (
                "FETI_INDEFINITE",
                "check the elements at this place; cut the step. If a body floats, give soft motions. If it stays \
                 however small the step is, the equilibrium is unstable. With friction another rest is not excluded",
            ),
            Self::Overflow => {
                ("FETI_OVERFLOW", "check the sizes; functions for 64-bit indices end in _i64")
            }
            Self::Internal => ("FETI_INTERNAL", "feti_problem_destroy; please send a problem file"),
            Self::Unsupported => ("FETI_UNSUPPORTED", "the text says what is"),
            Self::Cancelled => (
                "FETI_CANCELLED",
                "end the loop; feti_displacement returns FETI_STATE if there was no step yet",
            ),
            Self::TimeOver => {
                ("FETI_TIME", "raise time_limit; the next call uses the factors that are complete")
            }
            Self::Callback => ("FETI_CALLBACK", "the text says what your function returned"),
            Self::Io => ("FETI_IO", "the text has path and reason"),
            Self::Communication => ("FETI_COMMUNICATION", "end"),
        }
    }
}

/// What proves that there is no solution; `margin`, above 0 and at most 1, says how clearly.
#[derive(Debug, Clone, PartialEq)]
pub enum Proof {
    /// A rigid motion of all bodies that opens or keeps every row while the load does work on it; largest
    /// entry 1. The margin is the share of the resultant of the load that nothing holds.
    Motion { margin: f64, v: Vec<f64> },
    /// Weights w of rows, contact rows before equality rows, w >= 0 on contact rows: `w'[B; H] = 0` and
    /// `w'[c; h] < 0`. The margin is `|w'c| / |w|'|c|`.
    Rows { margin: f64, weights: Vec<(usize, f64)>, heaviest: usize },
}

/// Where it happened. Numbers count from 0 inside the library; `base` is what texts count from.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Place {
    pub base: i64,
    /// The rank that has it, if the host has given its problem on several.
    pub rank: Option<usize>,
    pub body: Option<usize>,
    pub component: Option<usize>,
    pub element: Option<usize>,
    /// Pair of surfaces.
    pub pair: Option<usize>,
    /// Face of a surface.
    pub face: Option<usize>,
    pub dof: Option<usize>,
    /// Node with friction; with a pair or a face node of a surface.
    pub node: Option<usize>,
    pub row: Option<usize>,
    /// The kind of the row: 0, 1, 2 for contact, equality, tangential rows.
    pub kind: Option<usize>,
    pub entry: Option<usize>,
    /// Position in a text or a file.
    pub byte: Option<usize>,
    /// The number found if it is an index, from 0; texts ([`INDEX`]) and details show it in the host's counting.
    pub index: Option<i64>,
    /// The base of `index` if the arrays of the call define it; otherwise `base` of the texts.
    pub index_base: Option<i64>,
    /// The number found ...
    pub value: Option<f64>,
    /// ... and the number it had to stay within.
    pub limit: Option<f64>,
}

/// Placeholder in a text for the index that was found.
pub const INDEX: &str = "{index}";

/// Placeholder in a text for a further index, from 0.
pub fn number(index: i64) -> String {
    format!("{{index {index}}}")
}

impl Place {
    /// The index found, in the host's counting.
    pub fn given_index(&self) -> Option<i64> {
        self.index.map(|index| index.saturating_add(self.index_base.unwrap_or(self.base)))
    }
}

impl fmt::Display for Place {
    fn fmt(&self, out: &mut fmt::Formatter<'_>) -> fmt::Result {
        let parts = [
            ("body", self.body),
            ("component", self.component),
            ("element", self.element),
            ("pair", self.pair),
            ("face", self.face),
            ("dof", self.dof),
            ("node", self.node),
            ("row", self.row),
            ("entry", self.entry),
            ("byte", self.byte),
        ];
        let mut separator = "";
        if let Some(rank) = self.rank {
            write!(out, "rank {rank}")?;
            separator = ", ";
        }
        for (name, number) in parts {
            let Some(number) = number else { continue };
            let number = i64::try_from(number).unwrap_or(i64::MAX).saturating_add(self.base);
            write!(out, "{separator}{name} {number}")?;
            separator = ", ";
        }
        out.write_str(if separator.is_empty() { "" } else { ": " })
    }
}

/// A failure with its place. `Display` reads "body 3, row 7: the text of what was wrong".
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[error("{place}{}", self.told())]
pub struct Error {
    pub kind: Kind,
    pub what: String,
    pub place: Box<Place>,
    pub proof: Option<Box<Proof>>,
}

/// A method for each of these fields of [`Place`] that sets it in an error.
macro_rules! with_places {
    ($($(#[$doc:meta])* $field:ident: $number:ty),+ $(,)?) => {$(
        $(#[$doc])*
        pub fn $field(mut self, $field: $number) -> Self {
            self.place.$field = Some($field);
            self
        }
    )+};
}

pub type Result<T> = std::result::Result<T, Error>;

impl Error {
    pub fn new(kind: Kind, what: impl Into<String>) -> Self {
        Self { kind, what: what.into(), place: Box::default(), proof: None }
    }

    /// `argument` is the name the argument has in the C signature.
    pub fn argument(argument: &'static str, what: impl Into<String>) -> Self {
        Self::new(Kind::Argument(argument), what)
    }

    with_places! {
        body: usize,
        rank: usize,
        component: usize,
        element: usize,
        pair: usize,
        face: usize,
        dof: usize,
        node: usize,
        row: usize,
        kind: usize,
        entry: usize,
        byte: usize,
        /// The number found is the index `index`, from 0.
        index: i64,
        value: f64,
        limit: f64,
    }

    /// Sets the base of index arrays of this call.
    pub fn index_from(mut self, base: i64) -> Self {
        self.place.index_base = Some(base);
        self
    }

    /// The text with the indices in the host's counting.
    fn told(&self) -> String {
        let text = match self.place.given_index() {
            Some(index) => self.what.replace(INDEX, &index.to_string()),
            None => self.what.clone(),
        };
        let base = self.place.index_base.unwrap_or(self.place.base);
        let mut parts = text.split("{index ");
        let mut told = parts.next().unwrap_or_default().to_owned();
        for part in parts {
            let (index, rest) = part.split_once('}').unwrap_or((part, ""));
            match index.parse::<i64>() {
                Ok(index) => told.push_str(&index.saturating_add(base).to_string()),
                Err(_) => told.push_str(index),
            }
            told.push_str(rest);
        }
        told
    }

    pub fn proved_by(mut self, proof: Proof) -> Self {
        self.proof = Some(Box::new(proof));
        self
    }

    /// The error with a text that counts from `base` (1 for Fortran hosts).
    pub fn counted_from(mut self, base: i64) -> Self {
        self.place.base = base;
        self
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_text_names_the_place_in_the_numbering_of_the_host() {
        let error = Error::argument("val", "not a number").body(2).row(7);
        assert_eq!(error.to_string(), "body 2, row 7: not a number");
        assert_eq!(error.counted_from(1).to_string(), "body 3, row 8: not a number");
        assert_eq!(Error::new(Kind::State, "no load").to_string(), "no load");
    }

    #[test]
    fn an_index_is_told_as_the_host_gave_it() {
        let error = Error::argument("col", format!("column {INDEX} is outside")).row(1).index(8);
        assert_eq!(error.to_string(), "row 1: column 8 is outside");
        assert_eq!(error.clone().counted_from(1).to_string(), "row 2: column 9 is outside");
        assert_eq!(error.clone().index_from(1).to_string(), "row 1: column 9 is outside");
        let fortran = error.index_from(1).counted_from(1);
        assert_eq!(
            (fortran.to_string().as_str(), fortran.place.given_index()),
            ("row 2: column 9 is outside", Some(9))
        );
        let further = format!("{INDEX} is not between {} and {}", number(3), number(4));
        let further = Error::argument("node", further).face(0).index(8).index_from(1);
        assert_eq!(further.to_string(), "face 0: 9 is not between 4 and 5");
    }
}
