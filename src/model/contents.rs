//! Bodies, rows and options as setup and solve read them. Nothing is computed here; results stored elsewhere keep the
//! revisions of the data from which they were computed.

use std::borrow::Cow;
use std::ops::Range;
use std::sync::Arc;

use crate::body::{Body, Form};
use crate::constraints::{Friction, RowKind, RowSet};
use crate::error::{Error, Place, Result};
use crate::mesh::Mesh;
use crate::model::parts::Parts;
use crate::model::settings::Settings;
use crate::platform::threads;

/// Bodies, rows and options of the problem that is solved: that of the host, or that of the parts of its bodies.
pub struct SolvedModel {
    pub settings: Settings,
    pub bodies: Vec<GivenBody>,
    /// First unknown of every body among all unknowns, and their end, at most i64::MAX.
    pub offsets: Vec<usize>,
    pub contact: RowSet,
    pub equalities: RowSet,
    /// Nodes of contact rows with friction, and their tangential rows.
    pub friction: Friction,
    pub revisions: Revisions,
    /// If the bodies are pieces: the bodies of the host to which they belong.
    pub parts: Option<Arc<Parts>>,
    /// If several ranks have given bodies and rows.
    pub given_by: Option<Arc<GivenBy>>,
}

/// Of everything in the problem of all ranks the rank that has given it, and its number there.
#[derive(Debug, Default)]
pub struct GivenBy {
    pub bodies: Vec<(usize, usize)>,
    /// Contact, equality and tangential rows.
    pub rows: [Vec<(usize, usize)>; 3],
    pub nodes: Vec<(usize, usize)>,
}

/// What hosts count.
#[derive(Debug, Clone, Copy)]
pub enum Counted {
    Body,
    Row(RowKind),
    Node,
}

/// Increased by every call that sets the named data, even if the data do not change.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct Revisions {
    /// Matrices, null spaces, coordinates and fixing dofs of any body.
    pub bodies: u64,
    /// Set of bodies and rows: multipliers belong to it.
    pub rows: u64,
    /// Compliances of rows, and which of them may close.
    pub laws: u64,
}

/// Increased if the named data change in any bit.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct BodyRevisions {
    /// The pattern of K, and the dofs held: the input of the analysis.
    pub analysed: u64,
    /// K itself.
    pub stiffness: u64,
    /// The null space or the coordinates.
    pub motions: u64,
}

/// What a call changes in a body.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Change {
    /// The data are unchanged.
    Nothing,
    Motions,
    Fixing,
    Values,
    Pattern,
}

/// A body as the host has given it.
#[derive(Default)]
pub struct GivenBody {
    pub body: Body,
    /// Its elements, if given by elements.
    pub mesh: Option<Box<Mesh>>,
    /// How the host gave its matrix.
    pub form: Option<Box<Form>>,
    /// The host has overwritten borrowed values, and they were refused: there is no valid matrix.
    pub spoiled: bool,
    /// The host's numbers of its unknowns.
    pub numbers: Option<Box<[usize]>>,
    pub revisions: BodyRevisions,
}

/// Sizes of a problem.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub struct Sizes {
    pub bodies: usize,
    /// Unknowns of all bodies.
    pub dofs: usize,
    pub rows: usize,
    pub equalities: usize,
    /// Nodes with friction.
    pub nodes: usize,
    /// Tangential rows of all nodes.
    pub tangential: usize,
    /// Tangential rows of a node, 0 without nodes.
    pub dim: usize,
}

impl Sizes {
    /// Number of rows of one kind.
    pub fn of(&self, kind: RowKind) -> usize {
        match kind {
            RowKind::Inequality => self.rows,
            RowKind::Equality => self.equalities,
            RowKind::Tangential => self.tangential,
        }
    }
}

impl SolvedModel {
    pub fn new() -> Self {
        Self {
            settings: Settings::new(),
            bodies: Vec::new(),
            offsets: vec![0],
            contact: RowSet::default(),
            equalities: RowSet::default(),
            friction: Friction::default(),
            revisions: Revisions::default(),
            parts: None,
            given_by: None,
        }
    }

    pub fn sizes(&self) -> Sizes {
        Sizes {
            bodies: self.bodies.len(),
            dofs: self.offsets[self.bodies.len()],
            rows: self.contact.len(),
            equalities: self.equalities.len(),
            nodes: self.friction.len(),
            tangential: self.friction.rows.len(),
            dim: if self.friction.len() == 0 { 0 } else { self.friction.dim },
        }
    }

    /// Number of unknowns of a body.
    pub fn order(&self, body: usize) -> Result<usize> {
        self.given(body).map(|given| given.body.order)
    }

    pub fn rows(&self, kind: RowKind) -> &RowSet {
        match kind {
            RowKind::Inequality => &self.contact,
            RowKind::Equality => &self.equalities,
            RowKind::Tangential => &self.friction.rows,
        }
    }

    pub fn rows_mut(&mut self, kind: RowKind) -> &mut RowSet {
        match kind {
            RowKind::Inequality => &mut self.contact,
            RowKind::Equality => &mut self.equalities,
            RowKind::Tangential => &mut self.friction.rows,
        }
    }

    pub fn given(&self, body: usize) -> Result<&GivenBody> {
        self.bodies.get(body).ok_or_else(|| no_body(body, self.bodies.len()))
    }

    /// The body, to be given new data.
    pub fn change(&mut self, body: usize, change: Change) -> Result<&mut GivenBody> {
        let bodies = self.bodies.len();
        let given = self.bodies.get_mut(body).ok_or_else(|| no_body(body, bodies))?;
        self.revisions.bodies += 1;
        let of = &mut given.revisions;
        of.motions += u64::from(change == Change::Motions);
        of.stiffness += u64::from(matches!(change, Change::Values | Change::Pattern));
        of.analysed += u64::from(matches!(change, Change::Fixing | Change::Pattern));
        Ok(given)
    }

    pub fn check_length(&self, body: usize, argument: &'static str, n: usize) -> Result<()> {
        let order = self.order(body)?;
        if n == order {
            return Ok(());
        }
        Err(Error::argument(argument, format!("the body has {order} unknowns, not {n}"))
            .body(body)
            .value(n as f64)
            .limit(order as f64))
    }

    /// The host's number of a body or of the body to which a piece belongs.
    pub fn name(&self, body: usize) -> usize {
        self.parts.as_ref().map_or(body, |parts| parts.parts[body].body)
    }

    /// The rank that has given it, and its number there; none on one rank.
    fn given_at(&self, of: Counted, number: usize) -> Option<(usize, usize)> {
        let by = self.given_by.as_ref()?;
        let all = match of {
            Counted::Body => &by.bodies,
            Counted::Row(kind) => &by.rows[kind as usize],
            Counted::Node => &by.nodes,
        };
        all.get(number).copied()
    }

    /// The number of the host's body, row or node as texts have it: "3", or "3 of rank 1".
    pub fn number_of(&self, of: Counted, number: usize) -> String {
        let base = self.settings.index_base;
        match self.given_at(of, number) {
            Some((rank, number)) => format!("{} of rank {rank}", number as i64 + base),
            None => (number as i64 + base).to_string(),
        }
    }

    /// A place in the numbers of the rank that has given its body, row or node.
    pub fn set_rank(&self, place: &mut Place) {
        let kind = place.kind.and_then(|kind| RowKind::ALL.get(kind).copied());
        let (of, number) = match (place.body, place.row.zip(kind), place.node) {
            (Some(body), ..) => (Counted::Body, body),
            (_, Some((row, kind)), _) => (Counted::Row(kind), row),
            (_, _, Some(node)) => (Counted::Node, node),
            _ => return,
        };
        let Some((rank, number)) = self.given_at(of, number).filter(|_| place.rank.is_none()) else { return };
        place.rank = Some(rank);
        match of {
            Counted::Body => place.body = Some(number),
            Counted::Row(_) => place.row = Some(number),
            Counted::Node => place.node = Some(number),
        }
    }

    /// Whether the body is a piece of one of the host.
    pub fn is_piece(&self, body: usize) -> bool {
        self.parts.as_ref().is_some_and(|parts| parts.is_cut(parts.parts[body].body))
    }

    /// The load at unknown j among all unknowns, force.
    pub fn load(&self, j: usize) -> f64 {
        let body = self.offsets[1..].partition_point(|end| *end <= j);
        self.bodies[body].body.load.as_ref().map_or(0.0, |load| load[j - self.offsets[body]])
    }

    /// Range of the unknowns of a body among all unknowns.
    pub fn range(&self, body: usize) -> Range<usize> {
        self.offsets[body]..self.offsets[body + 1]
    }

    /// First value of every body in vectors over the unknowns of bodies, and their end; bodies that the host has given on other ranks have
    /// none.
    pub fn starts(&self) -> Cow<'_, [usize]> {
        let stays = |given: &GivenBody| given.body.is_given_there();
        if !self.bodies.iter().any(stays) {
            return Cow::Borrowed(&self.offsets);
        }
        let own = self.bodies.iter().map(|given| if stays(given) { 0 } else { given.body.order });
        let ends = own.scan(0, |end, own| {
            *end += own;
            Some(*end)
        });
        std::iter::once(0).chain(ends).collect()
    }

    /// Threads for work on all bodies, limited by the number of unknowns: waking a thread for a few unknowns costs more
    /// than it saves.
    pub fn threads(&self) -> usize {
        self.threads_for(self.sizes().dofs)
    }

    /// The same for work on unknowns or nodes of this number.
    pub fn threads_for(&self, count: usize) -> usize {
        const FOR_EACH: usize = 500;
        threads::count(self.settings.threads, count / FOR_EACH)
    }

    /// Which of these bodies must be processed on the thread that calls the library.
    pub fn on_caller(&self, bodies: &[usize]) -> Vec<bool> {
        let on_caller = |p: &usize| self.bodies[*p].body.k().is_some_and(|k| k.on_caller());
        bodies.iter().map(on_caller).collect()
    }
}

fn no_body(body: usize, bodies: usize) -> Error {
    Error::argument("body", format!("there are {bodies} bodies")).body(body).index(body as i64)
}
