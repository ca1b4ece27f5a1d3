//! What a problem was given, as the library holds it, over all bodies.

use feti_contact::solver::{Digits, Friction, Given, Modes, Problem, RowKind, RowSet, Symmetric};

pub struct Contents<'a> {
    /// Those that differ from their defaults.
    pub options: String,
    pub bodies: Vec<Body<'a>>,
    /// First unknown of every body, and the number of all.
    pub starts: Vec<usize>,
    /// Contact rows, equality rows.
    pub rows: [&'a RowSet; 2],
    pub friction: &'a Friction,
}

pub struct Body<'a> {
    pub given: Given<'a>,
    pub load: Vec<f64>,
}

/// The word of a folder for what motions are.
pub fn word(modes: Modes) -> &'static str {
    match modes {
        Modes::Exact => "exact",
        Modes::Candidates => "candidates",
        Modes::Soft => "soft",
    }
}

impl<'a> Contents<'a> {
    pub fn of(problem: &'a Problem) -> Result<Self, String> {
        let given = (0..problem.sizes().bodies).map(|p| problem.given(p));
        let bodies: Vec<Body> = given
            .map(|given| given.map(Body::of))
            .collect::<Result<_, _>>()
            .map_err(|error| error.to_string())?;
        let mut starts = vec![0];
        bodies.iter().for_each(|body| starts.push(starts[starts.len() - 1] + body.n()));
        Ok(Self {
            options: problem.settings().changes(),
            bodies,
            starts,
            rows: [RowKind::Inequality, RowKind::Equality].map(|kind| problem.given_rows(kind)),
            friction: problem.given_friction(),
        })
    }

    /// Body of an unknown that counts through all bodies.
    pub fn body_of(&self, unknown: usize) -> usize {
        self.starts[1..].partition_point(|end| *end <= unknown)
    }

    /// What a folder of .mtx files cannot have.
    pub fn left_out(&self) -> String {
        let any = |has: fn(&Body) -> bool| self.bodies.iter().any(has);
        let kinds = [
            (any(|of| of.given.fixing.is_some()), "fixing unknowns"),
            (any(|of| of.given.numbered), "numbers of unknowns"),
            (
                any(|of| of.given.coordinates.is_some() && of.given.coordinate_modes != Modes::Candidates),
                "the kind of the motions of coordinates",
            ),
            (any(|of| of.given.pieces > 1), "the pieces of bodies (K is their sum)"),
        ];
        kinds.iter().filter(|(left, _)| *left).map(|(_, what)| *what).collect::<Vec<_>>().join(", ")
    }
}

impl<'a> Body<'a> {
    fn of(given: Given<'a>) -> Self {
        let load = given.load.map_or_else(|| vec![0.0; given.unknowns], <[f64]>::to_vec);
        Self { given, load }
    }

    pub fn n(&self) -> usize {
        self.given.unknowns
    }

    pub fn k(&self) -> Option<&Symmetric> {
        self.given.k.as_deref()
    }

    /// Number of motions that are declared; none: the library finds them.
    pub fn declared(&self) -> Option<usize> {
        self.given.motions.map(|(basis, _)| basis.len() / self.n().max(1))
    }

    /// The digits of K, if they are few by the library's measure.
    pub fn digits(&self) -> Option<Digits> {
        self.k().and_then(|k| Digits::of(k).ok().flatten())
    }

    pub fn diagonal(&self) -> Vec<f64> {
        self.k().map_or(Vec::new(), |k| (0..self.n()).map(|i| k.diagonal(i)).collect())
    }
}
