//! Information about one body.

use crate::body::{Assembled, Doubt, Modes};
use crate::decomposition::Components;
use crate::error::{Error, Kind, Result};
use crate::linalg::Symmetric;
use crate::mesh::Mesh;
use crate::platform::memory::{filled, headroom, zeros};
use crate::solver::decomposed::null_space_of;
use crate::solver::made::MadePart;
use crate::solver::problem::Problem;

/// Where the null space of a body comes from.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Origin {
    /// Vectors of the host that span the null space.
    Given,
    /// Selected by the library from vectors of the host.
    Candidates,
    /// Rigid motions from the coordinates of the host.
    Coordinates,
    /// Found from the matrix alone.
    Found,
}

/// A body as given by the host, and what the last setup computed for it.
#[derive(Debug, Clone, PartialEq)]
pub struct BodyFacts {
    pub unknowns: usize,
    /// Entries of K as the host gave them.
    pub entries: Option<usize>,
    /// Connected components of K.
    pub components: Option<usize>,
    /// Pieces into which the body is cut; 1 if it is not cut.
    pub pieces: usize,
    /// Bytes that the library keeps for K.
    pub matrix_bytes: usize,
    /// Values and columns of K remain in arrays of the host.
    pub borrowed: [bool; 2],
    pub origin: Origin,
    pub factors: Option<Factors>,
    /// Bytes of the assembled dual operator; none if it is applied matrix-free.
    pub operator: Option<Option<usize>>,
    /// Estimated relative error of the forces on the body in the last answer, no unit; none without an answer.
    pub force_error: Option<f64>,
}

/// Null space and factor of a body.
#[derive(Debug, Clone, PartialEq)]
pub struct Factors {
    /// Dimension of the null space.
    pub null_space: usize,
    /// If the null space was found by the library: ratio of the softest other motion to its stiffest.
    pub gap: Option<f64>,
    /// Motions whose resistance may be only rounding of the entries of K.
    pub doubts: Vec<Doubt>,
    pub entries: usize,
    pub bytes: usize,
    /// The first other body with this factor.
    pub shared_with: Option<usize>,
}

impl Factors {
    /// Number of motions whose resistance may be only rounding of the entries of K, treated as free or as supports.
    pub fn soft(&self, free: bool) -> usize {
        self.doubts.iter().filter(|doubt| doubt.free == free).map(|doubt| doubt.motions).sum()
    }
}

impl Problem {
    /// The connected component of every unknown of a body, numbered by first unknowns, and the number of components.
    /// Entries that are 0 connect nothing.
    pub fn components(&self, body: usize) -> Result<(Vec<usize>, usize)> {
        const PER_DOF: usize = 2 * size_of::<usize>();
        let missing = || Error::new(Kind::State, "the stiffness matrix has not been given").body(body);
        let given = &self.model.given(body)?.body;
        if let Some(k) = given.assembled() {
            let _room = headroom(k.order() * PER_DOF, "the connected parts of a body")?;
            return Ok(k.components());
        }
        let k = given.stiffness.as_ref().ok_or_else(missing)?;
        let Components { of, count, .. } = Components::all(k)?;
        Ok((of, count))
    }

    pub fn body_facts(&self, body: usize) -> Result<BodyFacts> {
        let given = self.model.given(body)?;
        let n = given.body.order;
        let (k, cut) = (given.body.stiffness.as_deref(), given.body.assembled().map(|k| &**k));
        let known = k.is_some() || cut.is_some();
        let components = known.then(|| self.components(body)).transpose()?.map(|(_, number)| number);
        let made = self.made(body);
        let origin = match (&given.body.null_space, &given.body.coordinates) {
            (Some(r), _) if r.modes == Modes::Candidates => Origin::Candidates,
            (Some(_), _) => Origin::Given,
            // coordinates were given that do not fit K
            (None, _) if made.iter().any(|of| of.kplus().misfit.is_some() && of.kplus().gap.is_some()) => {
                Origin::Found
            }
            (None, Some(_)) => Origin::Coordinates,
            (None, None) => Origin::Found,
        };
        Ok(BodyFacts {
            unknowns: n,
            entries: given.form.as_ref().map(|form| form.entries(n)),
            components,
            pieces: cut.map_or(1, |k| k.pieces().len()),
            matrix_bytes: k.map_or(0, Symmetric::bytes) + cut.map_or(0, Assembled::bytes),
            borrowed: k.map_or([false; 2], |k| [k.val.is_of_host(), k.col.is_of_host()]),
            origin,
            factors: self.factors_of(body),
            operator: self.operator_of(body),
            force_error: self.current().map(|current| current.answer.force_errors[body]),
        })
    }

    fn factors_of(&self, body: usize) -> Option<Factors> {
        let address =
            |p: usize| self.made(p).iter().map(|of| of.kplus().factor_address()).collect::<Vec<_>>();
        let (is_cut, own, made) =
            (self.model.bodies[body].body.assembled().is_some(), address(body), self.made(body));
        if own.is_empty() {
            return None;
        }
        let null_space = match is_cut {
            false => made.iter().map(|of| of.kplus().motions()).sum(),
            true => null_space_of(&self.prepared, self.parts()?, body)?.cols,
        };
        let others = 0..self.model.bodies.len();
        Some(Factors {
            null_space,
            gap: made.iter().filter_map(|of| of.kplus().gap.filter(|_| !is_cut)).reduce(f64::min),
            doubts: made.iter().filter_map(|of| of.kplus().doubt).collect(),
            entries: made.iter().map(|of| of.kplus().entries()).sum(),
            bytes: made.iter().map(MadePart::bytes).sum(),
            shared_with: others.clone().find(|&p| !is_cut && p != body && address(p) == own),
        })
    }

    /// The piece of every unknown of a body, the first if there are several; 0 in a body that is not cut.
    pub fn pieces(&self, body: usize) -> Result<Vec<u32>> {
        const WHAT: &str = "the pieces of unknowns";
        let missing = || Error::new(Kind::State, "the stiffness matrix has not been given").body(body);
        let given = self.model.given(body)?;
        if given.body.k().is_none() {
            return Err(missing());
        }
        let mut piece_of = filled(given.body.order, 0, WHAT)?;
        let pieces = given.mesh.as_deref().and_then(Mesh::pieces).unwrap_or_default();
        for (number, piece) in pieces.iter().enumerate().rev() {
            piece.dofs.iter().for_each(|&dof| piece_of[dof as usize] = number as u32);
        }
        Ok(piece_of)
    }

    /// Forces that hold the held unknowns 0, 1, ... of a body given by elements, `K_hf u`, force; 0 for an unknown
    /// without element. The host has to add the contributions of prescribed values and of loads on held unknowns. More
    /// forces than the body has unknowns, free or held, are refused: they would be written beyond the host's array.
    pub fn held_forces(&self, body: usize, n: usize) -> Result<Vec<f64>> {
        let given = self.model.given(body)?;
        let missing = || Error::new(Kind::State, "the body was not given by its elements").body(body);
        let mesh = given.mesh.as_deref().filter(|mesh| mesh.has_elements()).ok_or_else(missing)?;
        let (u, most) = (self.displacement(body)?, mesh.held_numbers().max(given.body.order));
        if n > most {
            let what = format!(
                "n is {n}, but the held unknowns of the body have numbers below {}",
                mesh.held_numbers()
            );
            return Err(Error::argument("n", what).body(body).value(n as f64).limit(most as f64));
        }
        let mut forces = zeros(n, "the forces of held unknowns")?;
        mesh.held_forces(u, &mut forces);
        Ok(forces)
    }
}
