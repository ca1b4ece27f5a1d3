//! What a rank tells rank 0 of its part of the problem, without matrices.

use crate::body::wire_struct;
use crate::constraints::{FrictionNode, RowKind, RowSet};
use crate::error::{Error, Kind, Result};
use crate::model::{BodyRevisions, HostModel, Revisions, NAMED};

/// The part of a rank.
#[derive(Clone, Default)]
pub struct Told {
    pub bodies: Vec<BodyTold>,
    /// Contact, equality and tangential rows.
    pub rows: Vec<RowsTold>,
    pub dim: usize,
    pub nodes: Vec<FrictionNode>,
    /// Its bodies have numbers, or it has none and names unknowns by numbers.
    pub is_numbered: bool,
    pub glue: bool,
    pub revisions: Revised,
}

/// Revisions of the part of a rank.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct Revised {
    pub of: Revisions,
    pub numberings: u64,
}

#[derive(Clone)]
pub struct BodyTold {
    pub order: usize,
    /// Its least and its largest number.
    pub numbers: Option<(usize, usize)>,
    pub revisions: BodyRevisions,
}

/// Rows of one kind.
#[derive(Clone, Default)]
pub struct RowsTold {
    pub ptr: Vec<usize>,
    /// Of each row by ascending numbers.
    pub entries: Vec<Named>,
    pub rhs: Vec<f64>,
    pub compliance: Vec<f64>,
    /// Rows that lost all entries as rounding.
    pub cancelled: Vec<usize>,
}

/// An entry of a row.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Named {
    /// The number of its unknown; without numbers the unknown among those of the rank.
    pub number: usize,
    /// The body of this rank that was named; none: any body that has the number.
    pub body: Option<(usize, usize)>,
    pub value: f64,
}

/// What changes without a new setup.
#[derive(Clone)]
pub struct Values {
    /// Right-hand sides of the three kinds of rows, length.
    pub rhs: Vec<Vec<f64>>,
    /// Coefficient and bound of every node.
    pub laws: Vec<(f64, f64)>,
    /// Start values, if the host has given them.
    pub start: Vec<Option<Vec<f64>>>,
    /// How often slips were committed.
    pub commits: u64,
    /// Its options that differ from the defaults, without those that each rank has of its own.
    pub options: String,
}

/// Options that each rank has of its own; for all others those of rank 0 count.
const OF_EACH_RANK: [&str; 4] = ["threads", "pieces", "glue", "index_base"];

wire_struct!(Told { bodies, rows, dim, nodes, is_numbered, glue, revisions });
wire_struct!(Revised { of, numberings });
wire_struct!(BodyTold { order, numbers, revisions });
wire_struct!(RowsTold { ptr, entries, rhs, compliance, cancelled });
wire_struct!(Named { number, body, value });
wire_struct!(Values { rhs, laws, start, commits, options });
wire_struct!(Revisions { bodies, rows, laws });
wire_struct!(BodyRevisions { analysed, stiffness, motions });
wire_struct!(FrictionNode { normal, first, count, coefficient, bound });

impl Revised {
    pub fn of(model: &HostModel) -> Self {
        Self { of: model.revisions, numberings: model.numberings }
    }
}

impl Told {
    /// Of a rank that has no part.
    pub fn nothing() -> Self {
        Self {
            rows: vec![RowsTold { ptr: vec![0], ..RowsTold::default() }; 3],
            glue: true,
            ..Self::default()
        }
    }

    pub fn of(model: &HostModel) -> Result<Self> {
        let numbered = model.bodies.iter().filter(|given| given.numbers.is_some()).count();
        if numbered > 0 && numbered < model.bodies.len() {
            let body = model.bodies.iter().position(|given| given.numbers.is_none()).unwrap_or(0);
            let what =
                "other bodies have numbers of the host, this body has none: give them by feti_body_numbering";
            return Err(Error::new(Kind::State, what).body(body));
        }
        let body = |p: usize| {
            let given = &model.bodies[p];
            let numbers = given.numbers.as_deref().unwrap_or_default();
            let ends = numbers.iter().min().zip(numbers.iter().max());
            let numbers = ends.map(|(least, most)| (*least, *most));
            BodyTold { order: given.body.order, numbers, revisions: given.revisions }
        };
        Ok(Self {
            bodies: (0..model.bodies.len()).map(body).collect(),
            rows: RowKind::ALL.iter().map(|kind| rows(model, model.rows(*kind))).collect(),
            dim: model.friction.dim,
            nodes: model.friction.nodes.clone(),
            is_numbered: is_numbered(model),
            glue: model.settings.glue == 1,
            revisions: Revised::of(model),
        })
    }

    /// Takes over what has changed without a new setup: the order of equal rows depends on it.
    pub fn refresh(&mut self, values: &Values) {
        self.rows.iter_mut().zip(&values.rhs).for_each(|(rows, rhs)| rows.rhs.clone_from(rhs));
        for (node, law) in self.nodes.iter_mut().zip(&values.laws) {
            (node.coefficient, node.bound) = *law;
        }
    }
}

/// Bodies have numbers, or rows name unknowns by numbers.
pub fn is_numbered(model: &HostModel) -> bool {
    !model.unknowns.is_empty()
        || RowKind::ALL.iter().any(|kind| model.rows(*kind).matrix.col.iter().any(|j| *j >= NAMED))
}

fn rows(model: &HostModel, rows: &RowSet) -> RowsTold {
    let named = |i: usize, (j, value): (usize, f64)| match j.checked_sub(NAMED) {
        Some(number) => Named { number, body: None, value },
        None => {
            let body = model.offsets[1..].partition_point(|end| *end <= j);
            let dof = j - model.offsets[body];
            let number = model.bodies[body].numbers.as_ref().map_or(j, |numbers| numbers[dof]);
            Named { number, body: (!rows.is_named(i)).then_some((body, dof)), value }
        }
    };
    let row = |i: usize| {
        let mut row: Vec<Named> = rows.matrix.row(i).map(|of| named(i, of)).collect();
        row.sort_by_key(|of| of.number);
        row
    };
    RowsTold {
        ptr: rows.matrix.ptr.clone(),
        entries: (0..rows.len()).flat_map(row).collect(),
        rhs: rows.rhs.clone(),
        compliance: rows.compliance.to_vec(),
        cancelled: rows.cancelled().to_vec(),
    }
}

impl Values {
    /// Of a rank that has no part.
    pub fn nothing() -> Self {
        Self {
            rhs: vec![Vec::new(); 3],
            laws: Vec::new(),
            start: vec![None; 3],
            commits: 0,
            options: String::new(),
        }
    }

    /// `start`: start values of the host.
    pub fn of(model: &HostModel, start: Vec<Option<Vec<f64>>>, commits: u64) -> Self {
        Self {
            rhs: RowKind::ALL.iter().map(|kind| model.rows(*kind).rhs.clone()).collect(),
            laws: model.friction.nodes.iter().map(|node| (node.coefficient, node.bound)).collect(),
            start,
            commits,
            options: options(model),
        }
    }
}

fn options(model: &HostModel) -> String {
    let is_told = |option: &&str| !OF_EACH_RANK.contains(&option.split('=').next().unwrap_or_default());
    model.settings.changes().split_whitespace().filter(is_told).collect::<Vec<_>>().join(" ")
}

impl RowsTold {
    pub fn len(&self) -> usize {
        self.rhs.len()
    }

    pub fn row(&self, i: usize) -> &[Named] {
        &self.entries[self.ptr[i]..self.ptr[i + 1]]
    }
}
