//! Bodies given by elements: first the connectivity, then the element matrices in passes.

use std::sync::Arc;

use crate::body::{Assembled, Form, OtherForm};
use crate::error::{Error, Kind, Result};
use crate::mesh::{cut, pieces_for, Connectivity, ElementMatrix, ElementStorage, Elements, Mesh, Piece};
use crate::model::bodies::check_ld;
use crate::model::contents::{Change, GivenBody};
use crate::model::host::HostModel;
use crate::platform::memory::{filled, reserved};

const WHAT: &str = "the elements of a body";

impl HostModel {
    pub fn set_mesh(&mut self, body: usize, ptr: &[usize], dof: &[i64]) -> Result<()> {
        let order = self.order(body)?;
        if ptr.len() < 2 {
            let what = "a body has at least one element";
            return Err(Error::argument("elements", what).body(body).value(0.0).limit(1.0));
        }
        let wanted = self.settings.pieces;
        let serves = |mesh: &Mesh| {
            mesh.has_elements() && mesh.wanted() == Some(wanted) && mesh.connectivity().is(order, ptr, dof)
        };
        if self.bodies[body].mesh.as_deref().is_some_and(serves) {
            self.bodies[body].mesh.as_deref_mut().map_or(Ok(()), Mesh::begin).map_err(|e| e.body(body))?;
            self.bodies[body].without_matrix();
            return Ok(());
        }
        let connectivity = Connectivity::new(order, ptr, dof).map_err(|e| e.body(body))?;
        let given = self.change(body, Change::Pattern)?;
        given.without_matrix();
        let entries = ptr.windows(2).map(|pair| (pair[1] - pair[0]).pow(2)).sum();
        given.form = Some(Box::new(Form::Elements(entries)));
        given.spoiled = false;
        given.mesh = Some(Box::new(Mesh::new(connectivity)));
        Ok(())
    }

    pub fn add_element(&mut self, body: usize, e: usize, n: usize, ke: &[f64], ld: usize) -> Result<()> {
        check_ld("ld", ld, n).map_err(|error| error.body(body).element(e))?;
        let matrix = ElementMatrix { values: ke, n, ld, storage: ElementStorage::Full };
        self.add(body, e, std::iter::once(matrix))
    }

    pub fn add_elements(
        &mut self,
        body: usize,
        first: usize,
        count: usize,
        ke: &[f64],
        storage: ElementStorage,
    ) -> Result<()> {
        let expected = self.values_of_elements(body, first, count, storage)?;
        if ke.len() != expected {
            let what = format!("the elements have {expected} entries, not {}", ke.len());
            return Err(Error::argument("nnz", what)
                .body(body)
                .value(ke.len() as f64)
                .limit(expected as f64));
        }
        let sizes = sizes(self.mesh(body)?, first, count).map_err(|e| e.body(body).element(first))?;
        let mut begin = 0;
        let matrices = sizes.iter().map(move |&n| {
            let values = &ke[begin..begin + storage.len(n)];
            begin += values.len();
            ElementMatrix { values, n, ld: n, storage }
        });
        self.add(body, first, matrices)
    }

    pub fn values_of_elements(
        &self,
        body: usize,
        first: usize,
        count: usize,
        storage: ElementStorage,
    ) -> Result<usize> {
        let sizes = sizes(self.mesh(body)?, first, count).map_err(|e| e.body(body).element(first))?;
        Ok(sizes.iter().map(|n| storage.len(*n)).sum())
    }

    pub fn size_of_element(&self, body: usize, e: usize) -> Result<usize> {
        self.check_element(body, e, "e")?;
        Ok(self.mesh(body)?.connectivity().size(e))
    }

    pub fn check_first_element(&self, body: usize, first: usize) -> Result<()> {
        self.check_element(body, first, "first")
    }

    fn check_element(&self, body: usize, e: usize, argument: &'static str) -> Result<()> {
        let elements = self.mesh(body)?.connectivity().elements();
        if e < elements {
            return Ok(());
        }
        let what = format!("the body has {elements} elements");
        Err(Error::argument(argument, what).body(body).index(e as i64).limit(elements as f64))
    }

    fn mesh(&self, body: usize) -> Result<&Mesh> {
        let missing = || {
            let what = "the elements have not been given: call feti_body_mesh before their matrices";
            Error::new(Kind::State, what).body(body)
        };
        self.given(body)?.mesh.as_deref().filter(|mesh| mesh.has_elements()).ok_or_else(missing)
    }

    fn add<'a>(
        &mut self,
        body: usize,
        first: usize,
        matrices: impl Iterator<Item = ElementMatrix<'a>> + Clone,
    ) -> Result<()> {
        let named = |e: Error| e.body(body).element(first);
        let cut = match self.mesh(body)?.wanted() {
            Some(_) => None,
            None => Some(self.cut_of(body).map_err(named)?),
        };
        let (tolerance, wanted) = (self.settings.symmetry_tolerance, self.settings.pieces);
        let Some(mesh) = self.bodies[body].mesh.as_deref_mut() else { return Ok(()) };
        if let Some(piece_of) = cut {
            mesh.cut(piece_of, wanted).map_err(named)?;
        }
        // checked before the pass is complete, so that a refused element may be given again
        let completes = mesh.is_complete_with(matrices.clone().count());
        let room = if completes { self.bodies[body].room_for_matrix().map_err(named)? } else { Vec::new() };
        let Some(mesh) = self.bodies[body].mesh.as_deref_mut() else { return Ok(()) };
        mesh.add(first, matrices, tolerance).map_err(|e| e.body(body))?;
        if completes {
            self.change(body, Change::Values)?.assemble(room);
        } else {
            self.bodies[body].without_matrix();
        }
        Ok(())
    }

    /// The piece of every element, by the options and coordinates at this time.
    fn cut_of(&self, body: usize) -> Result<Vec<u32>> {
        let mesh = self.mesh(body)?.connectivity();
        let pieces = match usize::try_from(self.settings.pieces) {
            Ok(0) | Err(_) if self.stays_whole => 1,
            Ok(0) | Err(_) => pieces_for(mesh.unknowns(), usize::try_from(self.settings.steps).unwrap_or(0)),
            Ok(wanted) => wanted,
        };
        if pieces <= 1 {
            return filled(mesh.elements(), 0, WHAT);
        }
        let free = (0..mesh.elements()).map(|e| mesh.free(e).count()).sum();
        let (mut ptr, mut dof) = (reserved(mesh.elements() + 1, WHAT)?, reserved(free, WHAT)?);
        ptr.push(0);
        for e in 0..mesh.elements() {
            dof.extend(mesh.free(e));
            ptr.push(dof.len());
        }
        let elements = Elements { ptr: &ptr, dof: &dof, unknowns: mesh.unknowns() };
        let places = self.bodies[body].body.coordinates.as_ref().map(|all| all.places());
        let centres = places.map(|places| centres(&elements, places)).transpose()?;
        cut(&elements, centres.as_deref(), pieces)
    }

    /// Bodies that have been cut become one matrix.
    pub fn make_whole(&mut self) -> Result<()> {
        for body in 0..self.bodies.len() {
            let Some(k) = self.bodies[body].body.assembled() else { continue };
            let whole = k.sum().map_err(|e| e.body(body))?;
            let given = self.change(body, Change::Values)?;
            (given.body.stiffness, given.body.other) = (Some(Arc::new(whole)), None);
        }
        Ok(())
    }
}

impl GivenBody {
    /// Drops the matrix of the body.
    pub fn without_matrix(&mut self) {
        (self.body.stiffness, self.body.other) = (None, None);
    }

    /// Memory for the matrix of a body in addition to those of its pieces.
    pub fn room_for_matrix(&self) -> Result<Vec<f64>> {
        if self.mesh.as_deref().is_some_and(Mesh::is_cut) {
            return Assembled::room_for(self.body.order);
        }
        Ok(Vec::new())
    }

    /// Completes a pass: the matrix of the body is that of its only piece, or the sum over all pieces, stored in `room`.
    pub fn assemble(&mut self, room: Vec<f64>) {
        self.without_matrix();
        match self.mesh.as_deref().and_then(Mesh::pieces) {
            Some([whole]) => self.body.stiffness = Some(Arc::clone(&whole.stiffness)),
            Some(pieces) => {
                let parts =
                    pieces.iter().map(|Piece { dofs, stiffness }| (Arc::clone(dofs), Arc::clone(stiffness)));
                let k = Arc::new(Assembled::new(room, parts));
                self.body.other = Some(Box::new(OtherForm::Assembled(k)));
            }
            None => {}
        }
    }
}

/// Sizes of `count` elements, which must exist.
fn sizes(mesh: &Mesh, first: usize, count: usize) -> Result<Vec<usize>> {
    let all = mesh.connectivity();
    if first.checked_add(count).is_none_or(|end| end > all.elements()) {
        let what = format!("the body has {} elements", all.elements());
        return Err(Error::argument("count", what).value(count as f64).limit(all.elements() as f64));
    }
    let mut sizes = reserved(count, WHAT)?;
    sizes.extend((first..first + count).map(|e| all.size(e)));
    Ok(sizes)
}

/// Mean position of the unknowns of each element, length.
fn centres(elements: &Elements, places: &[[f64; 3]]) -> Result<Vec<[f64; 3]>> {
    let mut centres = reserved(elements.ptr.len() - 1, WHAT)?;
    for range in elements.ptr.windows(2) {
        let dofs = &elements.dof[range[0]..range[1]];
        let share = 1.0 / dofs.len().max(1) as f64;
        let along = |axis: usize| dofs.iter().map(|&dof| share * places[dof as usize][axis]).sum();
        centres.push(std::array::from_fn(along));
    }
    Ok(centres)
}
