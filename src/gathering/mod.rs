//! One problem of what all ranks have given: bodies and rows in the order of the host's numbers. Bodies of other ranks are known by facts.

mod numbers;
mod order;
mod places;
mod told;

pub use numbers::{shared, SECTION};
pub use places::{copies, At, Copies, Places};
pub use told::{is_numbered, Revised, Told, Values};

use std::collections::{HashMap, HashSet};
use std::sync::Arc;

use crate::body::{Body, GivenThere, OtherForm};
use crate::constraints::{Friction, FrictionNode, RowKind, RowSet, Taken};
use crate::error::{Error, Kind, Result};
use crate::linalg::Csr;
use crate::model::{GivenBody, GivenBy, HostModel, Revisions};
use crate::platform::memory::reserved;

const WHAT: &str = "the problem of all ranks";

/// Where bodies, rows and nodes of the problem of all ranks come from.
#[derive(Default, PartialEq)]
pub struct Order {
    pub bodies: Vec<At>,
    pub rows: [Vec<At>; 3],
    pub nodes: Vec<At>,
    /// First unknown of every body among all unknowns, and their end.
    pub offsets: Vec<usize>,
    pub is_numbered: bool,
}

impl Order {
    pub fn of(told: &[Told]) -> Result<Self> {
        let is_numbered = told.iter().any(|of| of.is_numbered);
        let without = |of: &Told| of.bodies.iter().position(|body| body.numbers.is_none());
        let missing = told.iter().enumerate().find_map(|(rank, of)| Some((rank, without(of)?)));
        if let Some((rank, body)) = missing.filter(|_| is_numbered) {
            let what =
                "other ranks have numbers of the host, this body has none: give them by feti_body_numbering";
            return Err(Error::new(Kind::State, what).rank(rank).body(body));
        }
        let bodies = order::bodies(told);
        let mut offsets = reserved(bodies.len() + 1, WHAT)?;
        offsets.push(0);
        for at in &bodies {
            let order = told[at.rank].bodies[at.number].order;
            let end: usize = offsets.last().copied().unwrap_or(0);
            let end = end.checked_add(order).filter(|end| *end <= i64::MAX as usize).ok_or_else(|| {
                let what = "the unknowns of all bodies together exceed 64 bits";
                Error::new(Kind::Overflow, what).rank(at.rank).body(at.number)
            })?;
            offsets.push(end);
        }
        let [contact, equalities] = [0, 1].map(|kind| order::rows(told, kind, is_numbered));
        let number_of: HashMap<At, usize> = contact.iter().copied().zip(0..).collect();
        let normal = |at: At| number_of.get(&at).copied().unwrap_or(usize::MAX);
        let nodes = order::nodes(told, is_numbered, normal);
        let of_node = |at: &At| {
            let rank = at.rank;
            told[rank].nodes[at.number].rows().map(move |number| At { rank, number })
        };
        let tangential = nodes.iter().flat_map(of_node).collect();
        Ok(Self { bodies, rows: [contact, equalities, tangential], nodes, offsets, is_numbered })
    }

    /// The number here of every body of every rank.
    pub fn number_of_bodies(&self) -> HashMap<At, usize> {
        self.bodies.iter().copied().zip(0..).collect()
    }

    /// The bodies rank by rank in the order of their numbers there, each with its number here.
    pub fn by_ranks(&self) -> Vec<(At, usize)> {
        let mut bodies: Vec<(At, usize)> = self.bodies.iter().copied().zip(0..).collect();
        bodies.sort_unstable();
        bodies
    }

    /// Of every body its first unknown among those of its rank.
    pub fn starts(&self) -> Vec<usize> {
        let (mut starts, mut end) = (vec![0; self.bodies.len()], (0, 0));
        for (at, body) in self.by_ranks() {
            let start = if at.rank == end.0 { end.1 } else { 0 };
            starts[body] = start;
            end = (at.rank, start + self.offsets[body + 1] - self.offsets[body]);
        }
        starts
    }

    /// Numbers that rows name without a body, ascending.
    pub fn named(told: &[Told]) -> Vec<usize> {
        let all = told.iter().flat_map(|of| &of.rows).flat_map(|rows| &rows.entries);
        let mut named: Vec<usize> = all.filter(|of| of.body.is_none()).map(|of| of.number).collect();
        named.sort_unstable();
        named.dedup();
        named
    }
}

/// A body of the problem of all ranks.
pub enum GivenAt {
    /// On rank 0, with its load.
    Here(Body),
    There(GivenThere),
}

/// The problem of all ranks. Without loads, options, and numbers.
pub fn gathered(
    told: &[Told],
    order: &Order,
    places: &Places,
    given: impl IntoIterator<Item = GivenAt>,
    revisions: Revisions,
) -> Result<HostModel> {
    let mut model = HostModel::new();
    model.contents.offsets.clone_from(&order.offsets);
    for (at, given) in order.bodies.iter().zip(given) {
        let of = &told[at.rank].bodies[at.number];
        let body = match given {
            GivenAt::Here(body) => body,
            GivenAt::There(there) => {
                let other = Some(Box::new(OtherForm::Given(Box::new(there))));
                Body { order: of.order, other, ..Body::default() }
            }
        };
        model.contents.bodies.push(GivenBody { body, revisions: of.revisions, ..GivenBody::default() });
    }
    let number_of = order.number_of_bodies();
    let mut sets = Vec::with_capacity(3);
    for kind in RowKind::ALL {
        sets.push(rows(told, order, places, &number_of, kind)?);
    }
    let [contact, equalities, tangential] = <[RowSet; 3]>::try_from(sets).map_err(|_| damaged())?;
    (model.contents.contact, model.contents.equalities) = (contact, equalities);
    model.contents.friction = friction(told, order, tangential)?;
    model.contents.revisions = revisions;
    model.joined = Some(places.joints());
    let by = |all: &[At]| all.iter().map(|at| (at.rank, at.number)).collect();
    let (bodies, nodes) = (by(&order.bodies), by(&order.nodes));
    let rows = order.rows.each_ref().map(|rows| by(rows));
    model.contents.given_by = Some(Arc::new(GivenBy { bodies, rows, nodes }));
    Ok(model)
}

fn damaged() -> Error {
    Error::new(Kind::Internal, "rows of several ranks do not fit together")
}

/// The rows of one kind over all unknowns.
fn rows(
    told: &[Told],
    order: &Order,
    places: &Places,
    number_of: &HashMap<At, usize>,
    kind: RowKind,
) -> Result<RowSet> {
    let all = &order.rows[kind as usize];
    let unknowns = order.offsets.last().copied().unwrap_or(0);
    let entries = told.iter().map(|of| of.rows[kind as usize].entries.len()).sum();
    let mut matrix = Csr::with_room(unknowns, all.len(), entries);
    let (mut rhs, mut compliance) = (reserved(all.len(), WHAT)?, reserved(all.len(), WHAT)?);
    let lost: Vec<HashSet<usize>> =
        told.iter().map(|of| of.rows[kind as usize].cancelled.iter().copied().collect()).collect();
    let mut cancelled = Vec::new();
    for (i, at) in all.iter().enumerate() {
        let own = &told[at.rank].rows[kind as usize];
        let mut row = Vec::with_capacity(own.row(at.number).len());
        for (entry, of) in own.row(at.number).iter().enumerate() {
            let place = match of.body {
                Some((number, dof)) => {
                    let body = number_of.get(&At { rank: at.rank, number });
                    body.map(|body| order.offsets[*body] + dof)
                }
                None => places.first(of.number),
            };
            let nobody = || {
                let what = format!("no unknown of any rank has the number {}", crate::error::INDEX);
                let error = Error::argument("dof", what).rank(at.rank).row(at.number).entry(entry);
                error.kind(kind as usize).index(of.number as i64)
            };
            row.push((place.ok_or_else(nobody)?, of.value));
        }
        row.sort_by_key(|entry| entry.0);
        matrix.push_row(row);
        rhs.push(own.rhs[at.number]);
        compliance.push(own.compliance[at.number]);
        if lost[at.rank].contains(&at.number) {
            cancelled.push(i);
        }
    }
    let taken = (!cancelled.is_empty()).then(|| Box::new(Taken { entries: cancelled, ..Taken::default() }));
    Ok(RowSet { matrix: Arc::new(matrix), rhs, compliance: Arc::new(compliance), taken })
}

/// The nodes, whose tangential rows follow each other.
fn friction(told: &[Told], order: &Order, rows: RowSet) -> Result<Friction> {
    let dims = told.iter().enumerate().filter(|(_, of)| !of.nodes.is_empty());
    let dim = dims.clone().map(|(_, of)| of.dim).next().unwrap_or(0);
    if let Some((rank, of)) = dims.clone().find(|(_, of)| of.dim != dim) {
        let what = format!("the nodes of another rank have {dim} tangential rows each");
        return Err(Error::argument("dim", what).rank(rank).value(of.dim as f64));
    }
    let number_of: HashMap<At, usize> = order.rows[0].iter().copied().zip(0..).collect();
    let node = |(k, at): (usize, &At)| {
        let own = &told[at.rank].nodes[at.number];
        let normal = own.normal.and_then(|number| number_of.get(&At { rank: at.rank, number }).copied());
        FrictionNode { normal, first: k * dim, ..*own }
    };
    Ok(Friction { dim, nodes: order.nodes.iter().enumerate().map(node).collect(), rows })
}

/// Takes over what changes without a new setup.
pub fn refresh(model: &mut HostModel, order: &Order, values: &[Values]) {
    for kind in RowKind::ALL {
        let all = &order.rows[kind as usize];
        let rows = model.contents.rows_mut(kind);
        let own = all.iter().map(|at| values[at.rank].rhs[kind as usize][at.number]);
        rows.rhs.iter_mut().zip(own).for_each(|(to, from)| *to = from);
    }
    for (node, at) in model.contents.friction.nodes.iter_mut().zip(&order.nodes) {
        (node.coefficient, node.bound) = values[at.rank].laws[at.number];
    }
}
