//! The bodies that are solved: connected components and pieces, with the data of the host's body restricted to them.

use std::borrow::Cow;
use std::sync::Arc;

use crate::body::{pattern_key, same_matrix, value_key, Body, GivenThere, OtherForm, PartThere};
use crate::error::{Error, Kind, Result};
use crate::linalg::hash::{hash, Shared};
use crate::linalg::Symmetric;
use crate::mesh::{Mesh, Piece};
use crate::model::{GivenBody, HostModel, Joint, Part, Parts, SolvedModel, NAMED};
use crate::platform::memory::{filled, reserved, zeros};

use super::components::{slight, Component, Components, Connected};
use super::copies::Copies;

const WHAT: &str = "the parts of bodies";

/// The parts of all bodies, without loads, and their relation to the bodies.
pub fn parts(
    host: &HostModel,
    connected: &Connected,
    held: &dyn Fn(usize) -> bool,
) -> Result<(Vec<GivenBody>, Parts)> {
    let (mut split_bodies, mut all, starts) = (Vec::new(), Parts::default(), host.starts());
    all.offsets.clone_from(&host.offsets);
    for (body, given) in host.bodies.iter().enumerate() {
        all.first.push(split_bodies.len());
        let assembled = given.body.assembled().map(|k| k.measured_without(slight));
        all.assembled.push(assembled.transpose().map_err(|e| e.body(body))?);
        let (held_from, first) = (starts[body], host.offsets[body]);
        let mut split = Split { given, body, held, held_from, first, loose: &mut all.loose };
        let pieces =
            given.mesh.as_deref().and_then(Mesh::pieces).filter(|_| given.body.assembled().is_some());
        let there = given.body.given_there();
        split_bodies.extend(match (pieces, connected.components(body), given.body.stiffness.as_deref()) {
            _ if there.is_some() => there.map(|there| split.there(there)).transpose()?.unwrap_or_default(),
            (Some(pieces), ..) => split.pieces(pieces).map_err(|e| e.body(body))?,
            (None, Some(components), Some(k)) => split.components(components, k).map_err(|e| e.body(body))?,
            _ => vec![split.whole()],
        });
    }
    all.first.push(split_bodies.len());
    let mut bodies = reserved(split_bodies.len(), WHAT)?;
    (all.parts, all.starts) = (reserved(bodies.capacity(), WHAT)?, reserved(bodies.capacity() + 1, WHAT)?);
    let listed = |made: &MadePart| made.dofs.as_ref().map_or(0, |dofs| dofs.len());
    all.dofs = reserved(split_bodies.iter().map(listed).sum(), WHAT)?;
    let mut end = 0;
    for MadePart { own, mut part, dofs, shares } in split_bodies {
        all.starts.push(end);
        if !shares.is_empty() {
            all.shares.resize(end, 1.0);
            all.shares.extend(shares);
        }
        end += own.order;
        part.first = all.dofs.len();
        dofs.iter().for_each(|dofs| all.dofs.extend_from_slice(dofs));
        all.parts.push(part);
        let revisions = host.bodies[part.body].revisions;
        bodies.push(GivenBody { body: own, revisions, ..GivenBody::default() });
    }
    all.starts.push(end);
    Ok((bodies, all))
}

/// A part with its unknowns within the body, if it has not all, and its weights there if others have copies.
struct MadePart {
    own: Body,
    part: Part,
    dofs: Option<Arc<[u32]>>,
    shares: Vec<f64>,
}

/// The unknowns that rows, joints or loads touch, of bodies that are not given elsewhere, one after the other.
pub fn touched(host: &HostModel, joints: &[Joint]) -> Result<Vec<bool>> {
    let starts = host.starts();
    let mut touched = filled(starts[host.bodies.len()], false, WHAT)?;
    let place = |j: usize| match starts {
        Cow::Borrowed(_) => Some(j),
        Cow::Owned(_) => {
            let body = host.offsets[1..].partition_point(|end| *end <= j);
            Some(starts[body] + j - host.offsets[body]).filter(|at| *at < starts[body + 1])
        }
    };
    for rows in [&host.contact, &host.equalities, &host.friction.rows] {
        let own = (0..rows.len()).flat_map(|i| rows.matrix.row(i)).map(|(j, _)| j);
        own.filter(|j| *j < NAMED).filter_map(place).for_each(|at| touched[at] = true);
    }
    joints.iter().flat_map(|joint| joint.ends).filter_map(place).for_each(|at| touched[at] = true);
    for (given, first) in host.bodies.iter().zip(&*starts) {
        let loads = given.body.load.iter().flatten().enumerate();
        loads.filter(|(_, f)| **f != 0.0).for_each(|(i, _)| touched[first + i] = true);
    }
    Ok(touched)
}

/// A body of the host that is split into parts.
struct Split<'a> {
    given: &'a GivenBody,
    body: usize,
    /// Rows, joints or loads touch this unknown, as `touched` counts them.
    held: &'a dyn Fn(usize) -> bool,
    /// First unknown of the body among these, and among all unknowns of the host.
    held_from: usize,
    first: usize,
    /// Unknowns that are left out of all parts.
    loose: &'a mut Vec<usize>,
}

impl Split<'_> {
    /// A body that is its only part: its matrix and functions are shared, not copied.
    fn whole(&self) -> MadePart {
        let part = Part { body: self.body, piece: 0, whole: true, first: 0 };
        MadePart { own: self.given.body.without_load(), part, dofs: None, shares: Vec::new() }
    }

    /// A body on another rank, where its parts have been made.
    fn there(&mut self, GivenThere { parts, loose }: &GivenThere) -> Result<Vec<MadePart>> {
        self.loose.extend(loose.iter().map(|dof| self.first + *dof as usize));
        let made = parts.iter().map(|PartThere { order, dofs, there }| {
            let other = Some(Box::new(OtherForm::Elsewhere(there.clone())));
            let own = Body { order: *order, other, ..Body::default() };
            let part = Part { body: self.body, piece: 0, whole: dofs.is_none(), first: 0 };
            MadePart { own, part, dofs: dofs.clone(), shares: Vec::new() }
        });
        Ok(made.collect())
    }

    /// A body of several components. At least one part remains.
    fn components(&mut self, components: &Components, k: &Symmetric) -> Result<Vec<MadePart>> {
        let first_loose = self.loose.len();
        let empty = components.empty(k)?.filter(|&i| !(self.held)(self.held_from + i));
        let mut loose: Vec<usize> = empty.collect();
        loose.truncate(components.count - 1);
        self.loose.extend(loose.iter().map(|i| self.first + i));
        let left_out = &self.loose[first_loose..];
        let blocks = components.blocks(k, |i| left_out.binary_search(&(self.first + i)).is_ok())?;
        let mut made = reserved(blocks.len(), WHAT)?;
        let mut known = Shared::default();
        for Component { dofs, stiffness } in blocks {
            let key = hash(pattern_key(&stiffness), std::iter::once(value_key(&stiffness)));
            let stiffness = known.share(key, stiffness, same_matrix);
            let null_space = self.given.body.null_space.as_ref();
            let null_space = null_space.map(|given| given.on(&dofs, &stiffness).map(Box::new)).transpose()?;
            let own = Body { null_space, ..self.part_of(&dofs, stiffness)? };
            let part = Part { body: self.body, piece: 0, whole: false, first: 0 };
            made.push(MadePart { own, part, dofs: Some(dofs), shares: Vec::new() });
        }
        Ok(made)
    }

    /// The body with these unknowns alone: coordinates and dofs held are those of the body.
    fn part_of(&self, dofs: &[u32], stiffness: Arc<Symmetric>) -> Result<Body> {
        let Body { coordinates, coordinate_modes, fixing, .. } = &self.given.body;
        let own = |dof: &usize| dofs.binary_search(&(*dof as u32)).ok();
        Ok(Body {
            order: dofs.len(),
            stiffness: Some(stiffness),
            coordinates: coordinates.as_ref().map(|all| all.of(dofs).map(Box::new)).transpose()?,
            coordinate_modes: *coordinate_modes,
            fixing: fixing.as_ref().map(|fixing| fixing.iter().filter_map(own).collect()),
            ..Body::default()
        })
    }

    fn pieces(&mut self, pieces: &[Piece]) -> Result<Vec<MadePart>> {
        let given = self.given;
        let mut copies = filled(given.body.order, 0u32, WHAT)?;
        pieces.iter().flat_map(|piece| piece.dofs.iter()).for_each(|&dof| copies[dof as usize] += 1);
        let first_of = |number| given.mesh.as_deref().and_then(|mesh| mesh.first_of(number));
        let mut made = reserved(pieces.len(), WHAT)?;
        for (number, piece) in pieces.iter().enumerate() {
            let own = self.piece(number, piece, &copies).map_err(|mut error: Error| {
                if error.kind == Kind::Memory {
                    error.place.element = first_of(number);
                }
                error
            })?;
            made.extend(own);
        }
        Ok(made)
    }

    /// The parts of a piece: their null spaces come from the coordinates of their unknowns, or from their matrices; the
    /// null space of the body is not used. The weight of a copy is its part of the stiffness at the unknown; without
    /// stiffness all copies have equal weights.
    fn piece(&mut self, number: usize, piece: &Piece, copies: &[u32]) -> Result<Vec<MadePart>> {
        let Piece { dofs, stiffness } = piece;
        let Some(components) = Components::of(stiffness)? else {
            return Ok(vec![self.of_piece(number, Arc::clone(dofs), Arc::clone(stiffness), copies)?]);
        };
        let mut loose = reserved(components.count, WHAT)?;
        let is_loose =
            |i: &usize| copies[dofs[*i] as usize] == 1 && !(self.held)(self.held_from + dofs[*i] as usize);
        loose.extend(components.empty(stiffness)?.filter(is_loose));
        loose.truncate(components.count - 1);
        self.loose.extend(loose.iter().map(|&i| self.first + dofs[i] as usize));
        let mut made = reserved(components.count, WHAT)?;
        for block in components.blocks(stiffness, |i| loose.binary_search(&i).is_ok())? {
            let own: Arc<[u32]> = block.dofs.iter().map(|&i| dofs[i as usize]).collect();
            made.push(self.of_piece(number, own, Arc::new(block.stiffness), copies)?);
        }
        Ok(made)
    }

    fn of_piece(
        &self,
        piece: usize,
        dofs: Arc<[u32]>,
        stiffness: Arc<Symmetric>,
        copies: &[u32],
    ) -> Result<MadePart> {
        let mut shares = reserved(dofs.len(), WHAT)?;
        let all = |dof: u32| self.given.body.assembled().map_or(0.0, |all| all.diagonal(dof as usize));
        let share = |(i, &dof): (usize, &u32)| match (stiffness.diagonal(i), all(dof)) {
            (own, all) if all > 0.0 => own / all,
            _ => 1.0 / f64::from(copies[dof as usize]),
        };
        shares.extend(dofs.iter().enumerate().map(share));
        let own = Body { fixing: None, ..self.part_of(&dofs, stiffness)? };
        let part = Part { body: self.body, piece: piece as u32, whole: false, first: 0 };
        Ok(MadePart { own, part, dofs: Some(dofs), shares })
    }
}

/// Distributes the loads of the host to the parts: each copy gets its weight, the last copy the rest. `copies`: of the bodies that
/// are cut.
pub fn loads(
    host: &HostModel,
    parts: &Parts,
    copies: &[Option<Copies>],
    model: &mut SolvedModel,
) -> Result<()> {
    for (body, given) in host.bodies.iter().enumerate() {
        if let Some(GivenThere { parts: given, .. }) = given.body.given_there() {
            for (part, PartThere { there, .. }) in parts.of(body).zip(given) {
                model.bodies[part].body.other = Some(Box::new(OtherForm::Elsewhere(there.clone())));
            }
            continue;
        }
        let Some(load) = &given.body.load else {
            parts.of(body).for_each(|part| model.bodies[part].body.load = None);
            continue;
        };
        let Some(copies) = &copies[body] else {
            for part in parts.of(body) {
                let mut own = reserved(model.bodies[part].body.order, "a load")?;
                own.extend(parts.gather(part, load));
                model.bodies[part].body.load = Some(own.into());
            }
            continue;
        };
        for part in parts.of(body) {
            model.bodies[part].body.load = Some(zeros(model.bodies[part].body.order, "a load")?.into());
        }
        for (dof, &force) in load.iter().enumerate().filter(|(_, force)| **force != 0.0) {
            let (mut left, mut all) = (force, copies.all(dof).peekable());
            while let Some((part, i)) = all.next() {
                let own = if all.peek().is_some() { force * parts.place(part, i).1 } else { left };
                left -= own;
                model.bodies[part].body.load.iter_mut().for_each(|load| load[i] = own);
            }
        }
    }
    Ok(())
}
