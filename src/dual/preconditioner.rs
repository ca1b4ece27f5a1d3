//! Preconditioners of F on a face: `M_F = B_D S_b B_D'` with `B_D = (B_F D^-1 B_F')^-1 B_F D^-1`, rebuilt for the rows F
//! that are not held. S_b is the stiffness of the constrained dofs: lumped or Dirichlet. Compliant rows add C to both,
//! `M_F = W^-1 (B_F D^-1 S_b D^-1 B_F' + C_F) W^-1`, `W = B_F D^-1 B_F' + C_F`.

use std::sync::{Mutex, MutexGuard, PoisonError};

use crate::body::{ask, FormElsewhere, Owed};
use crate::constraints::Touched;
use crate::dual::coupling::{Coupling, FaceCoupling};
use crate::error::Result;
use crate::linalg::vector::LONG;
use crate::linalg::{Csr, Operator};
use crate::platform::threads::parts_of;
use crate::platform::{interrupt, stopwatch, tally};

/// The constrained dofs of one body.
pub struct Boundary {
    /// Numbers among all unknowns that rows touch, ascending.
    pub dofs: Vec<usize>,
    pub stiffness: BoundaryStiffness,
}

/// S_b, here or on another rank.
pub enum BoundaryStiffness {
    Own(Box<dyn Operator + Send>),
    Elsewhere(FormElsewhere),
}

pub struct Preconditioner {
    /// `B D^-1/2` over the constrained unknowns, body after body.
    rows: Csr,
    /// C, no unit.
    compliance: Vec<f64>,
    /// `D^-1/2` of the constrained unknowns.
    weight: Vec<f64>,
    /// S_b, body after body.
    stiffness: Vec<BoundaryStiffness>,
    coupling: Coupling,
    /// The last face.
    face: Mutex<Option<FaceCoupling>>,
}

impl BoundaryStiffness {
    fn order(&self) -> usize {
        match self {
            Self::Own(form) => form.order(),
            Self::Elsewhere(form) => form.order(),
        }
    }

    fn bytes_kept(&self) -> usize {
        match self {
            Self::Own(form) => form.bytes_kept(),
            Self::Elsewhere(_) => 0,
        }
    }
}

impl Preconditioner {
    /// `matrix`: B, `compliance`: the diagonal of C; `B D^-1 B' + C` has the diagonal 1. Every unknown with an entry in B
    /// must be in one of `boundaries`.
    pub fn new(
        matrix: &Csr,
        compliance: Vec<f64>,
        metric: &[f64],
        boundaries: Vec<Boundary>,
    ) -> Result<Self> {
        let (mut number, mut weight) = (vec![0; matrix.cols], Vec::new());
        for &dof in boundaries.iter().flat_map(|boundary| &boundary.dofs) {
            number[dof] = weight.len();
            weight.push(metric[dof].sqrt().recip());
        }
        let mut rows = Csr::empty(weight.len());
        for i in 0..matrix.rows() {
            rows.push_row(matrix.row(i).map(|(j, v)| (number[j], v * weight[number[j]])));
        }
        let coupling = Coupling::new(&rows.transposed()?, &compliance)?;
        let stiffness = boundaries.into_iter().map(|boundary| boundary.stiffness).collect();
        Ok(Self { rows, compliance, weight, stiffness, coupling, face: Mutex::new(None) })
    }

    /// `z = M_F r` on the rows that are not held, 0 on the others. On springs of bodies, the last rows, F and M_F are 1.
    pub fn apply(&self, held: &[bool], r: &[f64], z: &mut [f64]) -> Result<()> {
        // a new face needs new factors
        interrupt::check()?;
        tally::costly();
        let rows = self.compliance.len();
        let ((held, _), (r, springs)) = (held.split_at(rows), r.split_at(rows));
        let (z, rest) = z.split_at_mut(rows);
        rest.copy_from_slice(springs);
        z.fill(0.0);
        let selected = self.select(held)?;
        let Some(face) = selected.as_ref() else { return Ok(()) };
        z.copy_from_slice(r);
        face.solve(z)?;
        let mut moved = vec![0.0; self.weight.len()];
        self.rows.mul_transposed_add(1.0, z, &mut moved);
        let force = self.stiffened(moved)?;
        for (i, (z, c)) in z.iter_mut().zip(&self.compliance).enumerate() {
            *z = self.rows.row_dot(i, &force) + c * *z;
        }
        face.solve(z)
    }

    /// `D^-1/2 S_b D^-1/2 v` over the constrained unknowns.
    pub(super) fn stiffened(&self, mut moved: Vec<f64>) -> Result<Vec<f64>> {
        moved.iter_mut().zip(&self.weight).for_each(|(v, weight)| *v *= weight);
        let mut force = vec![0.0; moved.len()];
        let (mut from, mut to) = (&moved[..], &mut force[..]);
        let (mut bodies, mut elsewhere) = (Vec::with_capacity(self.stiffness.len()), Vec::new());
        for stiffness in &self.stiffness {
            let (own, rest) = from.split_at(stiffness.order());
            let (image, others) = to.split_at_mut(stiffness.order());
            match stiffness {
                BoundaryStiffness::Own(stiffness) => bodies.push((stiffness, own, image)),
                BoundaryStiffness::Elsewhere(form) => elsewhere.push((form, own, image)),
            }
            (from, to) = (rest, others);
        }
        let owed = match elsewhere.first() {
            None => Owed::nothing(),
            Some((form, ..)) => {
                let question = |(k, (form, own, _)): (usize, &(&FormElsewhere, &[f64], &mut [f64]))| {
                    (k, form.multiplying(Some(1.0), own.to_vec()))
                };
                ask(form.ranks(), elsewhere.iter().enumerate().map(question).collect())?
            }
        };
        if moved.len() < LONG {
            stopwatch::aside(|| {
                bodies.into_iter().for_each(|(stiffness, own, image)| stiffness.apply(own, image))
            });
        } else {
            stopwatch::aside(|| parts_of(bodies, |_, (stiffness, own, image)| stiffness.apply(own, image)));
        }
        for (k, answer) in owed.answers::<Vec<f64>>()? {
            let (form, _, image) = &mut elsewhere[k];
            image.copy_from_slice(&form.image(answer?)?);
        }
        force.iter_mut().zip(&self.weight).for_each(|(v, weight)| *v *= weight);
        Ok(force)
    }

    /// `B D^-1/2` over the constrained unknowns.
    pub(super) fn rows(&self) -> &Csr {
        &self.rows
    }

    pub(super) fn compliance(&self) -> &[f64] {
        &self.compliance
    }

    /// Bytes of the stiffness S_b of the bodies here.
    pub fn bytes_kept(&self) -> usize {
        self.stiffness.iter().map(|boundary| boundary.bytes_kept()).sum()
    }

    /// Inverts W for this face, unless it is the last face.
    fn select(&self, held: &[bool]) -> Result<MutexGuard<'_, Option<FaceCoupling>>> {
        let mut face = self.face.lock().unwrap_or_else(PoisonError::into_inner);
        if !face.as_ref().is_some_and(|known| known.is_of(held)) {
            *face = self.coupling.face(held, face.as_ref())?;
        }
        Ok(face)
    }
}

/// For each body its unknowns among all touched ones that some row constrains.
pub fn constrained(matrix: &Csr, touched: &Touched, bodies: usize) -> Vec<Vec<usize>> {
    let mut is_constrained = vec![false; touched.len()];
    matrix.col.iter().for_each(|&j| is_constrained[j] = true);
    (0..bodies).map(|p| touched.range(p).filter(|j| is_constrained[*j]).collect()).collect()
}
