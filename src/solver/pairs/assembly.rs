//! Rows over nodes of surfaces become rows over the unknowns that the surfaces name, and over those of bodies.

use crate::constraints::{OwnedRows, RowKind, RowSet, Table};
use crate::error::Result;
use crate::model::{HostModel, Met, Pair, Tied};
use crate::numbers::surface::IDLE;
use crate::platform::threads::run;
use crate::solver::pairs::Sides;
use crate::surface::vector::{cross, plus, times, ZERO};
use crate::surface::{Entry, Meeting, Opposite, Rows};

/// Nodes of one task.
const TOGETHER: usize = 512;

/// Rows of one kind over the unknowns of all bodies, and as they name unknowns of the table, if they do.
#[derive(Default)]
pub struct Made {
    pub set: RowSet,
    pub given: Option<OwnedRows>,
}

/// What a find has made of the nodes of a pair.
#[derive(Default)]
pub struct Contact {
    pub contact: Made,
    pub tangential: Made,
    pub met: Vec<Option<Met>>,
    /// Gaps that count as 0, length.
    pub adjusted: Vec<f64>,
}

/// The unknowns of both surfaces.
pub struct Assembly<'a> {
    dim: usize,
    slave: Vec<i64>,
    /// None: a master without unknowns.
    master: Option<Vec<i64>>,
    has_friction: bool,
    offsets: &'a [usize],
    /// Whose unknowns these are, if not those of all bodies.
    table: Option<&'a Table>,
}

impl<'a> Assembly<'a> {
    pub fn of(model: &'a HostModel, pair: &Pair) -> Result<Self> {
        let places = |surface: usize| {
            model.pairs.surfaces[surface].unknowns().map(|of| model.places_of_surface(of)).transpose()
        };
        let (slave, master) = (places(pair.slave)?.unwrap_or_default(), places(pair.master)?);
        let is_tabled = model.pairs.surfaces[pair.slave].unknowns().is_some_and(|of| of.is_tabled);
        let table = model.table.as_deref().filter(|_| is_tabled);
        let (dim, has_friction) = (model.pairs.dim(pair), pair.friction.is_some());
        Ok(Self { dim, slave, master, has_friction, offsets: &model.offsets, table })
    }

    /// The gradient of opening i as a row; of the contact, `b = -dg/du`, its negative.
    fn push(&self, to: &mut OwnedRows, rows: &Rows, i: usize, sign: f64, rhs: f64) {
        to.begin(rhs);
        let mut add = |places: &[i64], (node, of): &Entry| {
            for axis in 0..self.dim {
                let (place, value) = (places[self.dim * *node as usize + axis], of[i][axis]);
                if place >= 0 && value != 0.0 {
                    to.add(place as usize, sign * value);
                }
            }
        };
        rows.slave.iter().for_each(|entry| add(&self.slave, entry));
        if let Some(master) = &self.master {
            rows.master.iter().for_each(|entry| add(master, entry));
        }
        let moves =
            |place: usize| self.table.is_none_or(|table| table.dofs.terms.row(place).next().is_some());
        let last = to.len() - 1;
        if to.row(last).all(|(place, value)| value.abs() <= IDLE || !moves(place)) {
            to.retain_in_last(|place| !moves(place));
        }
    }

    fn made(&self, kind: RowKind, rows: OwnedRows) -> Result<Made> {
        let resolved = self.table.map(|table| table.resolved(rows.input())).transpose()?;
        let mut set = RowSet::default();
        set.add(kind, resolved.as_ref().unwrap_or(&rows).input(), self.offsets)?;
        Ok(Made { set, given: resolved.map(|_| rows) })
    }

    /// Contact rows and tangential rows of all nodes, and what they have met; `adjusted`: gaps that count as 0, none before the first find.
    pub fn contact(&self, sides: &Sides, meeting: &Meeting, adjusted: Option<&[f64]>) -> Result<Contact> {
        let (nodes, laws, tangents) = (&sides.pair.nodes, &sides.pair.laws, self.dim - 1);
        let of_task = run(sides.threads(), nodes.len().div_ceil(TOGETHER), |task| {
            let (mut contact, mut tangential) = (OwnedRows::default(), OwnedRows::default());
            let mut made = Contact::default();
            for k in TOGETHER * task..nodes.len().min(TOGETHER * (task + 1)) {
                let of = meeting.rows(&sides.slave, &sides.master, k, nodes[k]);
                let gap = of.as_ref().map_or(f64::INFINITY, |of| of.opening[2] - laws.offset[k]);
                let first = if gap.abs() <= laws.scalars.adjust { gap } else { 0.0 };
                let adjusted = adjusted.map_or(first, |adjusted| adjusted[k]);
                match &of {
                    Some(of) => self.push(&mut contact, of, 2, -1.0, gap - adjusted),
                    None => contact.begin(gap),
                }
                for a in (0..tangents).filter(|_| self.has_friction) {
                    match &of {
                        Some(of) => self.push(&mut tangential, of, a, 1.0, of.before[a] - of.opening[a]),
                        None => tangential.begin(0.0),
                    }
                }
                made.met.push(of.as_ref().map(|of| self.met(sides, of)));
                made.adjusted.push(adjusted);
            }
            made.contact = self.made(RowKind::Inequality, contact)?;
            made.tangential = self.made(RowKind::Tangential, tangential)?;
            Ok(made)
        })?;
        Ok(Contact::joined(of_task))
    }

    fn met(&self, sides: &Sides, rows: &Rows) -> Met {
        let moment = |i: usize| {
            rows.slave
                .iter()
                .fold(ZERO, |sum, (node, of)| plus(sum, 1.0, cross(sides.slave.x[*node as usize], of[i])))
        };
        let [t, second, of_master] = rows.directions;
        Met {
            normal: times(-1.0, of_master),
            tangents: [t, if self.dim == 3 { second } else { ZERO }],
            moments: [times(-1.0, moment(2)), moment(0), moment(1)],
            gap: rows.opening[2],
            angle: rows.angle,
        }
    }

    /// The points of a tie.
    pub fn points(&self, sides: &Sides, meeting: Meeting) -> Tied {
        let opening =
            |(k, node): (usize, &u32)| Some(meeting.tie(&sides.slave, &sides.master, k, *node)?.opening);
        let then = sides.pair.nodes.iter().enumerate().map(opening).collect();
        let rigid = if let Opposite::Rigid { now, .. } = sides.master { Some(*now) } else { None };
        Tied { meeting, then, rigid }
    }

    /// Equality rows along the normal and along the face, with what has opened since the points were found.
    pub fn ties(&self, sides: &Sides, tied: &Tied) -> Result<(Made, Vec<Option<Met>>)> {
        let master = match (sides.master, &tied.rigid) {
            (Opposite::Rigid { now, begin, .. }, Some(found)) => Opposite::Rigid { found, now, begin },
            (master, _) => master,
        };
        let (mut all, mut met) = (OwnedRows::default(), Vec::new());
        for (k, node) in sides.pair.nodes.iter().enumerate() {
            let then = tied.then[k].filter(|_| sides.pair.laws.scalars.is_on);
            let of = then.and_then(|then| Some((tied.meeting.tie(&sides.slave, &master, k, *node)?, then)));
            for direction in [2, 0, 1].into_iter().take(self.dim) {
                let Some((rows, then)) = &of else {
                    all.begin(0.0);
                    continue;
                };
                self.push(&mut all, rows, direction, 1.0, then[direction] - rows.opening[direction]);
            }
            met.push(of.as_ref().map(|(rows, _)| self.met(sides, rows)));
        }
        Ok((self.made(RowKind::Equality, all)?, met))
    }
}

impl Contact {
    /// The parts, one after the other.
    fn joined(parts: Vec<Self>) -> Self {
        let (mut contact, mut tangential) = (Vec::new(), Vec::new());
        let mut all = Self::default();
        for part in parts {
            contact.push(part.contact);
            tangential.push(part.tangential);
            all.met.extend(part.met);
            all.adjusted.extend(part.adjusted);
        }
        Self { contact: Made::joined(contact), tangential: Made::joined(tangential), ..all }
    }
}

impl Made {
    fn joined(parts: Vec<Self>) -> Self {
        let (sets, given): (Vec<_>, Vec<_>) = parts.into_iter().map(|part| (part.set, part.given)).unzip();
        let given = given.into_iter().flatten().reduce(|mut all, more| {
            all.append(&more);
            all
        });
        Self { set: RowSet::joined(sets), given }
    }
}
