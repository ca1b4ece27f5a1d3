//! Rows over nodes of surfaces become rows over the unknowns of bodies.

use crate::error::Result;
use crate::model::{Geometry, HostModel, Met, Pair, Tied};
use crate::platform::threads::run;
use crate::solver::pairs::Sides;
use crate::surface::vector::{times, Vector, ZERO};
use crate::surface::{rows, tie, Opposite, Partner, Row};

/// Nodes of one task.
const TOGETHER: usize = 512;

/// Rows over the unknowns of all bodies.
#[derive(Default)]
pub struct Assembled {
    pub ptr: Vec<usize>,
    pub dof: Vec<i64>,
    pub val: Vec<f64>,
    pub rhs: Vec<f64>,
    /// 1/k, length / force; none if all rows are rigid.
    pub compliance: Vec<f64>,
    /// Rows of a node.
    each: usize,
}

impl Assembled {
    fn new(each: usize) -> Self {
        Self { ptr: vec![0], each, ..Self::default() }
    }

    pub fn len(&self) -> usize {
        self.rhs.len()
    }

    pub fn is_empty(&self, row: usize) -> bool {
        self.ptr[row] == self.ptr[row + 1]
    }

    /// The rows of node k slip by nothing.
    pub fn clear(&mut self, k: usize) {
        let own = k * self.each..(k + 1) * self.each;
        self.rhs.get_mut(own).into_iter().flatten().for_each(|s| *s = 0.0);
    }

    fn empty(&mut self, rhs: f64) {
        self.ptr.push(self.dof.len());
        self.rhs.push(rhs);
    }

    fn append(&mut self, more: &Self) {
        let start = self.dof.len();
        self.ptr.extend(more.ptr[1..].iter().map(|end| start + end));
        self.dof.extend(&more.dof);
        self.val.extend(&more.val);
        self.rhs.extend(&more.rhs);
    }
}

/// The unknowns of both surfaces.
pub struct Assembly {
    dim: usize,
    slave: Vec<i64>,
    /// None: a master without unknowns.
    master: Option<Vec<i64>>,
    has_friction: bool,
}

impl Assembly {
    pub fn of(model: &HostModel, pair: &Pair) -> Result<Self> {
        let places = |surface: usize| match &model.pairs.surfaces[surface] {
            Geometry::Nodes { unknowns: Some(unknowns), .. } => model.places_of_surface(unknowns).map(Some),
            _ => Ok(None),
        };
        let (slave, master) = (places(pair.slave)?.unwrap_or_default(), places(pair.master)?);
        Ok(Self { dim: model.pairs.dim(pair), slave, master, has_friction: pair.friction.is_some() })
    }

    fn push(&self, to: &mut Assembled, row: &Row, node: u32, rhs: f64) {
        let mut add = |places: &[i64], node: u32, values: Vector| {
            for i in 0..self.dim {
                let place = places[self.dim * node as usize + i];
                if place >= 0 && values[i] != 0.0 {
                    to.dof.push(place);
                    to.val.push(values[i]);
                }
            }
        };
        add(&self.slave, node, row.slave);
        if let Some(master) = &self.master {
            row.master().for_each(|(node, values)| add(master, node, values));
        }
        to.empty(rhs);
    }

    /// Contact rows and tangential rows of all nodes, and what they have met.
    pub fn contact(
        &self,
        sides: &Sides,
        partners: &[Option<Partner>],
        adjusted: &[f64],
    ) -> Result<(Assembled, Assembled, Vec<Option<Met>>)> {
        let (nodes, laws, tangents) = (&sides.pair.nodes, &sides.pair.laws, self.dim - 1);
        let of_task = run(sides.threads(), nodes.len().div_ceil(TOGETHER), |task| {
            let (mut contact, mut tangential) = (Assembled::new(1), Assembled::new(tangents));
            let mut met = Vec::new();
            for k in TOGETHER * task..nodes.len().min(TOGETHER * (task + 1)) {
                let of = partners[k].as_ref().and_then(|of| rows(&sides.slave, &sides.master, nodes[k], of));
                match &of {
                    Some(of) => {
                        self.push(&mut contact, &of.contact, nodes[k], of.gap - laws.offset[k] - adjusted[k])
                    }
                    None => contact.empty(f64::INFINITY),
                }
                for a in (0..tangents).filter(|_| self.has_friction) {
                    match &of {
                        Some(of) => self.push(&mut tangential, &of.tangential[a], nodes[k], of.s_old[a]),
                        None => tangential.empty(0.0),
                    }
                }
                met.push(of.map(|of| Met { normal: of.normal, tangents: of.tangents, gap: of.gap }));
            }
            Ok((contact, tangential, met))
        })?;
        let (mut contact, mut tangential, mut met) =
            (Assembled::new(1), Assembled::new(tangents), Vec::new());
        for (of_contact, of_tangential, of_met) in of_task {
            contact.append(&of_contact);
            tangential.append(&of_tangential);
            met.extend(of_met);
        }
        Ok((contact, tangential, met))
    }

    /// The points of ties.
    pub fn points(&self, sides: &Sides, partners: &[Option<Partner>]) -> Vec<Option<Tied>> {
        let point = |(node, partner): (&u32, &Option<Partner>)| {
            let partner = (*partner)?;
            Some((partner, tie(&sides.slave, &here(sides), *node, &partner)?.1))
        };
        sides.pair.nodes.iter().zip(partners).map(point).collect()
    }

    /// Equality rows along the normal and along the face, with what has opened since the points were found.
    /// `master` as in [`tie`].
    pub fn ties(
        &self,
        sides: &Sides,
        master: &Opposite,
        points: &[Option<Tied>],
    ) -> Result<(Assembled, Vec<Option<Met>>)> {
        let order = [2, 0, 1];
        let (mut all, mut met) = (Assembled::new(self.dim), Vec::new());
        for (node, point) in sides.pair.nodes.iter().zip(points) {
            let point = point.as_ref().filter(|_| sides.pair.laws.scalars.is_on);
            let of =
                point.and_then(|(partner, then)| Some((tie(&sides.slave, master, *node, partner)?, then)));
            for direction in &order[..self.dim] {
                match &of {
                    Some(((rows, now), then)) => {
                        self.push(&mut all, &rows[*direction], *node, then[*direction] - now[*direction]);
                        // a row that has lost all its unknowns demands nothing
                        let row = all.len() - 1;
                        all.rhs[row] = if all.is_empty(row) { 0.0 } else { all.rhs[row] };
                    }
                    None => all.empty(0.0),
                }
            }
            met.push(of.map(|((rows, now), _)| {
                let [e_1, e_2, n] = rows.map(|row| row.slave);
                let second = if self.dim == 3 { e_2 } else { ZERO };
                Met { normal: times(-1.0, n), tangents: [e_1, second], gap: now[2] }
            }));
        }
        Ok((all, met))
    }
}

/// A rigid master where it is.
fn here<'a>(sides: &Sides<'a>) -> Opposite<'a> {
    match sides.master {
        Opposite::Rigid(now, _) => Opposite::Rigid(now, now),
        master => master,
    }
}
