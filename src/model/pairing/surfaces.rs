//! Surfaces of the host: positions, faces, unknowns.

use std::sync::Arc;

use crate::error::{Error, Kind, Result, INDEX};
use crate::linalg::vector::first_non_finite;
use crate::model::host::HostModel;
use crate::model::numbering::NAMED;
use crate::model::pairs::{copied, Geometry, Pair, SurfaceSizes, Unknowns};
use crate::numbers::body::LARGEST;
use crate::platform::memory::refusal;
use crate::surface::vector::{Vector, ZERO};
use crate::surface::{Faces, Rigid, RigidShape, Shape};

impl HostModel {
    pub fn surface_add(
        &mut self,
        body: Option<usize>,
        dim: usize,
        x: &[f64],
        ldx: usize,
        dof: Option<(&[i64], usize)>,
    ) -> Result<usize> {
        let x = positions(dim, x, ldx)?;
        let faces = Faces::new(dim, x.len())?;
        let unknowns = dof.map(|dof| self.unknowns_of(body, dim, x.len(), dof)).transpose()?.map(Arc::new);
        let begin = Arc::new(copied(x.iter().copied())?);
        self.push_surface(Geometry::Nodes { faces: Arc::new(faces), x, begin, unknowns })
    }

    pub fn surface_rigid(&mut self, dim: usize, shape: RigidShape, data: &[f64]) -> Result<usize> {
        let now = Rigid::new(dim, shape, data)?;
        self.push_surface(Geometry::Rigid { now, begin: now })
    }

    pub fn surface_sizes(&self, surface: usize) -> Result<SurfaceSizes> {
        Ok(self.pairs.surface(surface, "surface")?.sizes())
    }

    fn push_surface(&mut self, surface: Geometry) -> Result<usize> {
        let surfaces = &mut self.pairs.surfaces;
        surfaces.try_reserve(1).map_err(|_| refusal(size_of::<Geometry>(), "a surface"))?;
        surfaces.push(surface);
        Ok(surfaces.len() - 1)
    }

    pub fn surface_faces(&mut self, surface: usize, shape: Shape, node: &[i64]) -> Result<usize> {
        let (faces, x) = self.faces_before_pairs(surface)?;
        let first = faces.len();
        *faces = Arc::new(faces.with(shape, node, x)?);
        Ok(first)
    }

    pub fn surface_points(&mut self, surface: usize, node: &[i64]) -> Result<()> {
        let (faces, _) = self.faces_before_pairs(surface)?;
        *faces = Arc::new(faces.with_points(node)?);
        Ok(())
    }

    /// The faces of a surface that no pair has, and its positions.
    fn faces_before_pairs(&mut self, surface: usize) -> Result<(&mut Arc<Faces>, &[Vector])> {
        self.pairs.surface(surface, "surface")?;
        let used = |pair: &Pair| pair.slave == surface || pair.master == surface;
        if self.pairs.pairs.iter().any(used) {
            let what = "a pair has this surface: faces come before pairs";
            return Err(Error::new(Kind::State, what).index(surface as i64));
        }
        match &mut self.pairs.surfaces[surface] {
            Geometry::Nodes { faces, x, .. } => Ok((faces, x)),
            Geometry::Rigid { .. } => Err(Error::argument("surface", "a rigid surface has no faces")),
        }
    }

    pub fn surface_move(&mut self, surface: usize, x: &[f64], ldx: usize) -> Result<()> {
        self.pairs.surface(surface, "surface")?;
        match &mut self.pairs.surfaces[surface] {
            Geometry::Nodes { faces, x: present, .. } => {
                let moved = positions(faces.dim, x, ldx)?;
                if moved.len() != faces.nodes {
                    let what = format!("the surface has {} nodes, not {}", faces.nodes, moved.len());
                    return Err(Error::argument("x", what)
                        .value(moved.len() as f64)
                        .limit(faces.nodes as f64));
                }
                *present = moved;
            }
            Geometry::Rigid { now, .. } => {
                let moved = Rigid::new(now.dim, now.shape, x);
                *now = moved.map_err(|error| Error { kind: Kind::Argument("x"), ..error })?;
            }
        }
        Ok(())
    }

    /// Checked against the numbers that there are now.
    fn unknowns_of(
        &self,
        body: Option<usize>,
        dim: usize,
        nodes: usize,
        (dof, ldd): (&[i64], usize),
    ) -> Result<Unknowns> {
        if ldd < dim || columns_of(dof.len(), dim, ldd) != Some(nodes) {
            let what = format!(
                "{nodes} nodes of {dim} unknowns do not fill {} numbers in columns of {ldd}",
                dof.len()
            );
            return Err(Error::argument("dof", what).value(dof.len() as f64));
        }
        let numbers = (0..dim * nodes).map(|i| dof[i / dim * ldd + i % dim].max(-1));
        let is_tabled = body.is_none() && self.table.is_some();
        let unknowns = Unknowns { body, is_tabled, dof: copied(numbers)? };
        self.places_of_surface(&unknowns).map_err(|error| match error.place.entry {
            Some(entry) => error.node(entry / dim).entry(entry / dim * ldd + entry % dim),
            None => error,
        })?;
        Ok(unknowns)
    }

    /// The unknowns among those of all bodies, or of the table; -1 for those held.
    pub fn places_of_surface(&self, unknowns: &Unknowns) -> Result<Vec<i64>> {
        let table = self.table.as_ref().filter(|_| unknowns.is_tabled);
        let (first, end) = match (unknowns.body, table) {
            (Some(body), _) => (self.offsets[..].get(body).copied().unwrap_or(0), self.order(body)?),
            (None, Some(table)) => (0, table.dofs.len()),
            (None, None) => (0, self.sizes().dofs),
        };
        let mut free: Vec<i64> = copied(unknowns.dof.iter().copied())?;
        free.retain(|dof| *dof >= 0);
        let numbered = match unknowns.body {
            _ if table.is_some() => None,
            Some(_) => None,
            None => self.places_of(&[0, free.len()], &free).map_err(|mut error| {
                // the position among all numbers
                let at = error
                    .place
                    .entry
                    .and_then(|at| (0..unknowns.dof.len()).filter(|i| unknowns.dof[*i] >= 0).nth(at));
                (error.place.entry, error.place.row) = (at, None);
                error
            })?,
        };
        let mut next = numbered.iter().flatten();
        let mut places = copied(unknowns.dof.iter().copied())?;
        for (entry, place) in places.iter_mut().enumerate().filter(|(_, place)| **place >= 0) {
            *place = match next.next() {
                Some(known) if (*known as usize) < NAMED => *known,
                Some(_) => {
                    let what = format!("no unknown of this rank has the number {INDEX}: a surface and its pairs are of one rank");
                    return Err(Error::new(Kind::Unsupported, what).entry(entry).index(*place));
                }
                None if (*place as usize) < end => first as i64 + *place,
                None => {
                    let what = format!("unknown {} is outside the {end} unknowns", INDEX);
                    let error = Error::argument("dof", what).entry(entry).index(*place);
                    return Err(unknowns.body.map_or(error.clone(), |body| error.body(body)));
                }
            };
        }
        Ok(places)
    }
}

/// Number of columns of `ld` numbers, of which the last may end after `dim` numbers.
fn columns_of(len: usize, dim: usize, ld: usize) -> Option<usize> {
    let rest = len % ld;
    (rest == 0 || rest >= dim).then_some(len.div_ceil(ld))
}

/// Finite positions from columns of `ldx` numbers; the third coordinate of the plane is 0.
fn positions(dim: usize, x: &[f64], ldx: usize) -> Result<Vec<Vector>> {
    if !(2..=3).contains(&dim) {
        return Err(Error::argument("dim", "a surface has 2 or 3 dimensions").value(dim as f64));
    }
    if ldx < dim || columns_of(x.len(), dim, ldx).is_none() {
        let what = format!("{} numbers are no columns of {ldx} with {dim} coordinates", x.len());
        return Err(Error::argument("x", what).value(x.len() as f64));
    }
    let all = x.chunks(ldx);
    if let Some((node, i)) =
        all.clone().enumerate().find_map(|(k, x)| Some((k, first_non_finite(&x[..dim])?)))
    {
        let error = Error::argument("x", "the coordinate is not a finite number");
        return Err(error.node(node).entry(node * ldx + i).value(x[node * ldx + i]));
    }
    if let Some(node) = all.clone().position(|x| x[..dim].iter().any(|v| v.abs() > LARGEST)) {
        return Err(Error::argument("x", "the square of the coordinate overflows")
            .node(node)
            .entry(node * ldx));
    }
    copied(all.map(|x| {
        let mut point = ZERO;
        point[..dim].copy_from_slice(&x[..dim]);
        point
    }))
}
