//! The bodies that are solved: pieces, with the data of the host's body restricted to them.

use std::sync::Arc;

use crate::body::{check_diagonal, Body};
use crate::error::{Error, Kind, Result};
use crate::mesh::{Mesh, Piece};
use crate::model::{GivenBody, Model, Part, Parts};
use crate::platform::memory::{copied, filled, reserved, zeros};

use super::copies::Copies;

const WHAT: &str = "the pieces of bodies";

/// The parts of all bodies, without loads, and their relation to the bodies.
pub fn parts(host: &Model) -> Result<(Vec<GivenBody>, Parts)> {
    let (mut bodies, mut all) = (Vec::new(), Parts::default());
    all.offsets.clone_from(&host.offsets);
    all.starts.push(0);
    for (body, given) in host.bodies.iter().enumerate() {
        all.first.push(bodies.len());
        all.assembled.push(given.body.assembled.clone());
        let pieces = given.mesh.as_ref().and_then(Mesh::pieces).filter(|_| given.body.assembled.is_some());
        let made = match pieces {
            Some(pieces) => pieces_of(given, body, pieces).map_err(|e| e.body(body))?,
            None => vec![(whole(given)?, Part { body, piece: None })],
        };
        for (own, part) in made {
            all.starts.push(all.starts.last().copied().unwrap_or(0) + own.order);
            all.parts.push(part);
            bodies.push(GivenBody { body: own, revisions: given.revisions, ..GivenBody::default() });
        }
    }
    all.first.push(bodies.len());
    Ok((bodies, all))
}

/// A body that is not cut: its matrix and functions are shared, not copied.
fn whole(given: &GivenBody) -> Result<Body> {
    let Body { order, stiffness, operator, null_space, coordinates, soft_coordinates, fixing, .. } =
        &given.body;
    Ok(Body {
        order: *order,
        stiffness: stiffness.clone(),
        operator: operator.clone(),
        null_space: null_space.clone(),
        coordinates: coordinates.clone(),
        soft_coordinates: *soft_coordinates,
        fixing: fixing.clone(),
        ..Body::default()
    })
}

fn pieces_of(given: &GivenBody, body: usize, pieces: &[Piece]) -> Result<Vec<(Body, Part)>> {
    let mut copies = filled(given.body.order, 0u32, WHAT)?;
    pieces.iter().flat_map(|piece| piece.dofs.iter()).for_each(|&dof| copies[dof as usize] += 1);
    let first_of = |number| given.mesh.as_ref().and_then(|mesh| mesh.first_of(number));
    let named = |number, mut error: Error| {
        if error.kind == Kind::Memory {
            error.place.element = first_of(number);
        }
        error
    };
    let made = pieces.iter().enumerate();
    made.map(|(k, piece)| piece_of(given, body, piece, &copies).map_err(|e| named(k, e))).collect()
}

/// A piece: its null space comes from the coordinates of its unknowns, or from its matrix; the null space of the body is
/// not used. The weight of a copy is its part of the stiffness at the unknown; without stiffness all copies have equal
/// weights.
fn piece_of(given: &GivenBody, body: usize, piece: &Piece, copies: &[u32]) -> Result<(Body, Part)> {
    let Piece { dofs, stiffness } = piece;
    check_diagonal(stiffness).map_err(|e| match e.place.dof {
        Some(i) => e.dof(dofs[i] as usize),
        None => e,
    })?;
    let coordinates = given.body.coordinates.as_ref().map(|all| all.of(dofs)).transpose()?;
    let own = Body {
        order: dofs.len(),
        stiffness: Some(Arc::clone(stiffness)),
        coordinates,
        soft_coordinates: given.body.soft_coordinates,
        ..Body::default()
    };
    let mut shares = reserved(dofs.len(), WHAT)?;
    let all = |dof: u32| given.body.assembled.as_ref().map_or(0.0, |all| all.diagonal(dof as usize));
    let share = |(i, &dof): (usize, &u32)| match (stiffness.diagonal(i), all(dof)) {
        (own, all) if all > 0.0 => own / all,
        _ => 1.0 / f64::from(copies[dof as usize]),
    };
    shares.extend(dofs.iter().enumerate().map(share));
    Ok((own, Part { body, piece: Some((Arc::clone(dofs), shares)) }))
}

/// Distributes the loads of the host to the parts: each copy gets its weight, the last copy the rest.
pub fn loads(host: &Model, parts: &Parts, copies: &[Option<Copies>], model: &mut Model) -> Result<()> {
    for (body, given) in host.bodies.iter().enumerate() {
        let Some(load) = &given.body.load else {
            parts.of(body).for_each(|part| model.bodies[part].body.load = None);
            continue;
        };
        let Some(copies) = &copies[body] else {
            model.bodies[parts.first[body]].body.load = Some(copied(load, "a load")?);
            continue;
        };
        for part in parts.of(body) {
            model.bodies[part].body.load = Some(zeros(model.bodies[part].body.order, "a load")?);
        }
        for (dof, &force) in load.iter().enumerate().filter(|(_, force)| **force != 0.0) {
            let (mut left, mut all) = (force, copies.all(dof).iter().peekable());
            while let Some(&(part, place)) = all.next() {
                let part = part as usize;
                let i = place - parts.starts[part];
                let own = if all.peek().is_some() { force * parts.place(part, i).1 } else { left };
                left -= own;
                model.bodies[part].body.load.iter_mut().for_each(|load| load[i] = own);
            }
        }
    }
    Ok(())
}
