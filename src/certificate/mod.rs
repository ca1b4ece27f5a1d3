//! The certificate: how well an answer (u, lambda, mu, lambda_t) of one island satisfies the optimality conditions of (10)-(11),
//! computed from the host's own matrices. An island is a set of bodies with all the rows among them. Every measure is
//! local, of one body, one row or one node with friction: large values elsewhere do not hide an error. The result does
//! not depend on units or on the scaling of the rows.
//!
//! C = diag(1/k) is the compliance of the rows, D = diag K, r = B'lambda + H'mu + T'lambda_t, `s_i = (b_i D^-1 b_i' + C_i)^-1/2`, tol the
//! limit. Forces are measured by `|f|_{D^-1}`, lengths by `|u|_D`. All three are kept in units of U, the power of two below
//! max D: `(sum U/D f^2)^1/2` is a force, `(sum D/U u^2)^1/2` a length, `s_i / U^1/2` a number that keeps every
//! bit in units that differ by powers of two.

mod carried;
mod clusters;
mod deformation;
mod energy;
mod entry;
mod field;
mod forces;
mod friction;
mod part;
mod row;
mod rows;
mod way;

use std::borrow::Cow;
use std::sync::Arc;

use crate::body::{wire_struct, Kept, Locals, Seen};
use crate::constraints::{FrictionNode, RowKind, RowSet, Touched};
use crate::error::Result;
use crate::linalg::vector::power_of_two_below;
use crate::platform::memory::zeros;

pub use crate::linalg::vector::NOISE;
pub use carried::{led, Metric};
pub use clusters::{Beside, Couple, Coupled, Trace};
use deformation::{free_motions, Deformation};
use energy::Energies;
pub use entry::{Certificate, Entry};
use field::Field;
use forces::{Forces, Given};
pub use part::{Fit, Largest, Lend, LoadOf, Measure, SizeOfLoad};
use rows::JudgedRows;
pub use way::Way;

/// One island in terms of the host's data.
#[derive(Clone)]
pub struct Data<'a> {
    pub bodies: Locals<'a>,
    pub loads: Kept<Load>,
    /// The unknowns that rows touch, t.
    pub touched: &'a Touched,
    /// `B u <= c`, m x t. A gap of +infinity never closes.
    pub contact: &'a RowSet,
    /// `H u = h`, q x t.
    pub equalities: &'a RowSet,
    /// T of nodes with friction, with s_old as right-hand sides.
    pub tangential: &'a RowSet,
    /// Their laws, with row numbers of this island.
    pub nodes: &'a [FrictionNode],
    /// tol, no unit: limit of every entry.
    pub limit: f64,
    /// `data_accuracy`, no unit.
    pub accuracy: f64,
    /// The metric where no body has stiffness, force / length.
    pub unit: Option<f64>,
}

impl<'a> Data<'a> {
    /// The metric of unknowns of a body without stiffness, force / length.
    fn without(&self, body: &Seen) -> f64 {
        self.unit.unwrap_or(body.unit())
    }

    pub fn rows(&self, kind: RowKind) -> &'a RowSet {
        match kind {
            RowKind::Inequality => self.contact,
            RowKind::Equality => self.equalities,
            RowKind::Tangential => self.tangential,
        }
    }

    /// Where nothing has stiffness, no force deforms anything, and D may be any number: then it is the force by the way, of the
    /// unknowns, of rows with a force and of slips so far, so that gaps are relative to this way.
    fn measured_by(&self, answer: Candidate) -> Result<Cow<'_, Self>> {
        if self.bodies.iter().any(|body| body.stiffest() > 0.0) {
            return Ok(Cow::Borrowed(self));
        }
        let largest = self.bodies.ask(|_| Largest, (answer.u, &self.loads))?.into_iter();
        let (mut way, mut force) =
            largest.fold((0.0, 0.0), |most: (f64, f64), (way, force)| (most.0.max(way), most.1.max(force)));
        for kind in RowKind::ALL {
            let rows = self.rows(kind);
            for (i, f) in answer.forces(kind).iter().enumerate() {
                let b = rows.matrix.row(i).fold(0.0, |most: f64, (_, b)| most.max(b.abs()));
                if b > 0.0 && (*f != 0.0 || kind == RowKind::Tangential) {
                    force = force.max(b * f.abs());
                    way = way.max(rows.rhs[i].abs() / b);
                }
            }
        }
        let unit = power_of_two_below((force / way).min(2f64.powi(500)));
        Ok(Cow::Owned(Self { unit: Some(unit), ..self.clone() }))
    }
}

/// The load of a body, and that of the body of the host of which it is a part.
#[derive(Debug, Clone, Default)]
pub struct Load {
    /// f_p, n_p, force; zero if absent.
    pub own: Option<Arc<[f64]>>,
    /// 0 if the body is no part.
    pub whole: LoadOfWhole,
}

/// The load of a body of the host that has several parts, without grounded unknowns.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct LoadOfWhole {
    /// `(f'D~^-1 f)^1/2`, (force x length)^1/2.
    pub size: f64,
    /// The largest entry, force.
    pub largest: f64,
}

wire_struct!(Load { own, whole });
wire_struct!(LoadOfWhole { size, largest });

impl Load {
    /// `f_j`, force.
    pub fn at(&self, j: usize) -> f64 {
        self.own.as_ref().map_or(0.0, |f| f[j])
    }

    /// n_p.
    pub fn everywhere(&self, n: usize) -> Result<Vec<f64>> {
        let mut all = zeros(n, "the loads")?;
        all.iter_mut().zip(self.entries()).for_each(|(all, f)| *all = *f);
        Ok(all)
    }

    /// n_p, or none.
    pub fn entries(&self) -> &[f64] {
        self.own.as_ref().map_or(&[], |f| f)
    }

    /// A load with this `(f'D~^-1 f)^1/2` is rounding of the load of the whole: a soft part, or one with a large load, makes it
    /// none alone.
    pub fn is_noise(&self, size: f64, grounded: &[u32]) -> bool {
        if !(self.whole.size > 0.0 && size <= NOISE * self.whole.size) {
            return false;
        }
        let largest = acting(self.entries(), grounded).fold(0.0, |most: f64, (_, f)| most.max(f.abs()));
        largest <= NOISE * self.whole.largest
    }
}

/// The entries of a load that are not 0, without grounded unknowns.
fn acting<'a>(load: &'a [f64], grounded: &'a [u32]) -> impl Iterator<Item = (usize, f64)> + 'a {
    let entries = load.iter().copied().enumerate();
    entries.filter(|(i, f)| *f != 0.0 && grounded.binary_search(&(*i as u32)).is_err())
}

/// An answer on the bodies, contact rows, equality rows of the island.
#[derive(Clone, Copy)]
pub struct Candidate<'a> {
    /// Length.
    pub u: &'a Kept,
    /// The same where rows touch.
    pub at_rows: &'a [f64],
    /// m, force.
    pub lambda: &'a [f64],
    /// q, force.
    pub mu: &'a [f64],
    /// t, force.
    pub tangential: &'a [f64],
}

impl<'a> Candidate<'a> {
    pub fn forces(&self, kind: RowKind) -> &'a [f64] {
        match kind {
            RowKind::Inequality => self.lambda,
            RowKind::Equality => self.mu,
            RowKind::Tangential => self.tangential,
        }
    }
}

/// The result of the certificate for one answer.
#[derive(Debug, Clone, Default)]
pub struct Judgement {
    pub certificate: Certificate,
    /// Nothing fails but that a body has moved so far that its strain is lost in the rounding of its displacement.
    pub travelled: bool,
    /// One per body.
    pub bodies: Vec<BodyJudgement>,
    /// One per contact row.
    pub contact: Vec<RowJudgement>,
    /// One per node with friction.
    pub nodes: Vec<FrictionState>,
    /// The largest `(|f| + |r|)_{D^-1} / |delta|_D` of a body or of a grounded unknown, no unit: the certificate cannot detect
    /// relative errors of a deformation below this multiple of tol.
    pub leverage: f64,
    /// The largest `s_i (|b_i| delta + ..)` of a row with a force, relative to `max(|delta|_D, (|f| + |r|)_{D^-1})` of a
    /// body that it touches, no unit: the certificate cannot detect relative errors of the deformation of this body below
    /// this multiple of tol.
    pub unevenness: f64,
}

#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct BodyJudgement {
    /// `eta_p = |S v|_p / |S^-1 lambda|_p` over the rows that touch the body, no unit: estimated relative error of its
    /// forces; 0 without forces and violations. v is `min(g_i, lambda_i / s_i^2)` of a contact row with the open gap g_i, the
    /// error of an equality row, and `(lambda_t - P_b(lambda_t + s_i^2 s)) / s_i^2` of a node with friction, P_b being the projection
    /// on the disc of its forces.
    pub force_error: f64,
}

/// The values that count as zero at one row.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct RowJudgement {
    /// Gaps below this count as zero: `tol L_i` plus rounding, length.
    pub gap: f64,
    /// Forces below this count as zero: `tol Lambda_i`, force.
    pub force: f64,
}

/// The state of a node with friction.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum FrictionState {
    /// Its bound is 0: it carries no tangential force.
    Open,
    /// Its force is below its bound and it does not slip.
    Stick,
    /// It slips, and its force is at its bound.
    Slip,
    /// It does not slip and its force is at its bound, up to rounding.
    Weak,
    /// The bodies of the node are in a group that has no answer.
    Unknown,
}

/// The judgement of an answer. Fails if the host's products with K fail.
pub fn certify(data: &Data, answer: Candidate) -> Result<Judgement> {
    let data = &*data.measured_by(answer)?;
    let (field, felt) = Field::new(data, answer)?;
    let (given, free) = (Given::new(&field), free_motions(&field)?);
    let measure =
        |p: usize| Measure { free: free[p].clone(), limit: data.limit, idle: given.nothing(&field, p) };
    let measured = data.bodies.ask(measure, (&felt, answer.u, &data.loads))?;
    let deformation = Deformation::new(&field, &measured);
    let forces = Forces::new(&field, given, &measured);
    let rows = JudgedRows::new(&field, &deformation, &forces);
    let mut certificate = Certificate { limit: data.limit, ..Certificate::default() };
    let (mut lost, mut energies) = (Entry::default(), Energies::default());
    for (p, body) in measured.iter().enumerate() {
        forces.judge(p, body, &mut certificate, &mut lost);
        energies.add_body(&field, body);
    }
    energies.add_rows(&field);
    energies.add_slips(rows.dissipated());
    rows.judge(data.limit, &mut certificate);
    certificate.duality_gap = energies.entry(data.limit);
    certificate.energy = energies.minimised();
    let travelled = certificate.passed() && lost.ratio > 1.0;
    certificate.equilibrium.replace_if_worse(lost);
    let bodies = rows.force_errors(&field);
    let leverage = forces.leverage;
    let unevenness = rows.unevenness();
    let nodes = rows.states();
    let contact = rows.limits();
    Ok(Judgement { certificate, travelled, bodies, contact, nodes, leverage, unevenness })
}

/// `(x)_+`; NaN stays NaN.
fn positive(x: f64) -> f64 {
    if x <= 0.0 {
        0.0
    } else {
        x
    }
}

/// The larger of the two; NaN wins.
fn worse(a: f64, b: f64) -> f64 {
    if a >= b || a.is_nan() {
        a
    } else {
        b
    }
}

/// `part / allowed`; 0 / 0 counts as 0, and an infinite limit gives NaN.
fn share(part: f64, allowed: f64) -> f64 {
    if part == 0.0 && !allowed.is_nan() {
        0.0
    } else if allowed < f64::INFINITY {
        part / allowed
    } else {
        f64::NAN
    }
}

#[cfg(test)]
mod tests;
