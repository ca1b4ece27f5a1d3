//! Sizes of the forces of an island and of its bodies, and what they allow.

use crate::certificate::field::Field;
use crate::certificate::part::{Measured, Sizes};
use crate::certificate::{share, Certificate, Entry, NOISE};
use crate::constraints::{RowKind, RowSet};
use crate::linalg::vector::{ratio, weighted_norm};
use crate::numbers::certificate::EXCUSED;

/// Sizes of the forces, known before the bodies are measured.
pub(super) struct Given {
    /// Bodies without load, except on grounded unknowns; a load below 64 eps of the forces of the island is none.
    unloaded: Vec<bool>,
    /// `(|f|^2 + |r|^2)^1/2` of all bodies without loads on grounded unknowns, force. If there is no such load, the
    /// forces for the prescribed motion (`asked`) are added.
    everywhere: f64,
    /// Some force is not 0.
    acting: bool,
}

impl Given {
    pub fn new(field: &Field) -> Self {
        let of = |of: fn(&Sizes) -> f64| field.fitted.iter().map(|fitted| of(&fitted.sizes)).collect();
        let (loads, pushes): (Vec<f64>, Vec<f64>) = (of(|sizes| sizes.load), of(|sizes| sizes.push));
        let forces = norm_of([loads.as_slice(), pushes.as_slice()].concat());
        let moved = if loads.iter().all(|load| *load == 0.0) { asked(field) } else { 0.0 };
        let unloaded = loads.iter().map(|load| *load <= NOISE * forces).collect();
        Self { unloaded, everywhere: forces + moved, acting: forces > 0.0 }
    }

    /// `part` of the forces of the island, force, if body p has neither a load nor larger forces; otherwise its load if that is
    /// rounding. Without a load forces below the accuracy of the data are zero: answers of other solvers carry 1e-13.
    fn idle(&self, field: &Field, p: usize, size: f64, part: f64) -> f64 {
        let most = part * self.everywhere;
        if self.unloaded[p] && size <= most {
            most
        } else {
            field.fitted[p].sizes.noise
        }
    }

    /// Forces on body p below this count as zero, force.
    pub fn nothing(&self, field: &Field, p: usize) -> f64 {
        self.idle(field, p, field.fitted[p].sizes.all.unwrap_or(0.0), field.data.accuracy)
    }
}

/// Measures of the forces.
pub(super) struct Forces {
    given: Given,
    /// Deformation of every body, `U |delta|_D` without grounded unknowns, force.
    strains: Vec<f64>,
    /// The same of the island without carried unknowns, whose deformation follows from the forces of rows, also of those that cancel.
    strain: f64,
    /// The largest `(|f| + |r|)_{D^-1} / |delta|_D` of a body and `(|f_j| + |r_j|) / |D_j u_j|` of a grounded unknown, no unit.
    pub leverage: f64,
}

impl Forces {
    pub fn new(field: &Field, given: Given, measured: &[Measured]) -> Self {
        let strains: Vec<f64> = measured.iter().map(|body| body.strain).collect();
        let strain = norm_of(measured.iter().map(|body| body.own_strain).collect());
        let of_grounded = measured.iter().map(|body| body.leverage).fold(0.0, f64::max);
        let of_body = |p: usize| ratio(field.fitted[p].sizes.all.unwrap_or(0.0), strains[p]);
        let leverage = (0..strains.len()).map(of_body).fold(of_grounded, f64::max);
        Self { given, strains, strain, leverage }
    }

    /// Equilibrium and balance of body p, and the strain that rounding excuses, `lost`.
    pub fn judge(&self, p: usize, body: &Measured, certificate: &mut Certificate, lost: &mut Entry) {
        let limit = certificate.limit;
        let everywhere = self.given.everywhere + self.strain;
        // redundant rows may distribute a force arbitrarily, but these forces must not be so large that their sum is lost
        let cancelled = share(body.cancelled, limit * everywhere);
        for share in [body.equilibrium, cancelled, body.grounded] {
            certificate.equilibrium.replace_if_worse(Entry::new(share, limit, Some(p)));
        }
        let excused = if self.given.acting { share(body.excused, EXCUSED * everywhere) } else { 0.0 };
        lost.replace_if_worse(Entry::new(excused, limit, Some(p)));
        certificate.balance.replace_if_worse(Entry::new(body.balance, limit, Some(p)));
    }

    /// Rounding of the forces on a body that a row touches, if they deform it no more than that, and of those of the island on
    /// a body without load and forces, (force x length)^1/2.
    pub fn rounding_at(&self, field: &Field, kind: RowKind, i: usize) -> f64 {
        let sizes = |p: usize| &field.fitted[p].sizes;
        let idle = |p: usize| self.given.idle(field, p, sizes(p).all.unwrap_or(0.0), NOISE);
        let of = |p: usize| {
            let rounding = NOISE * sizes(p).led;
            idle(p).max(if self.strains[p] <= rounding { rounding } else { 0.0 })
        };
        field.touched(field.rows(kind), i).map(of).fold(0.0, f64::max) / field.unit.sqrt()
    }

    /// The smallest deformation among the bodies that a row touches: `|delta|_D`, or the deformation by the body's forces
    /// if that is larger; length with the metric D / U. Infinite if all their unknowns are grounded.
    pub fn least_deformation(&self, field: &Field, kind: RowKind, i: usize) -> f64 {
        let of = |p: usize| Some(self.strains[p].max(field.fitted[p].sizes.all?) / field.unit);
        field.touched(field.rows(kind), i).filter_map(of).fold(f64::INFINITY, f64::min)
    }

    /// Below this a force of a row counts as zero: `tol Lambda_i` with `Lambda_i = s_i min (|f| + |r|)_{D^-1}` over the
    /// bodies it touches, force. If it touches only grounded unknowns of a body, the forces on these are added.
    pub fn limit_of(&self, field: &Field, kind: RowKind, i: usize) -> f64 {
        let rows = field.rows(kind);
        let allowed = |p: usize| {
            let size = field.fitted[p].sizes.all.unwrap_or(0.0) + at_grounded(field, rows, i, p);
            (field.data.limit * size).max(self.given.idle(field, p, size, field.data.accuracy))
        };
        match field.touched(rows, i).map(allowed).reduce(smaller) {
            Some(least) => field.scales[kind as usize][i] * least,
            None => field.data.limit * rows.force_without_entries(kind, i).abs(),
        }
    }
}

/// The smaller of the two; NaN stays NaN.
fn smaller(a: f64, b: f64) -> f64 {
    if b >= a {
        a
    } else {
        b
    }
}

/// `|f|_{D^-1} + |r|_{D^-1}` over the unknowns of body p in row i, force; 0 unless all of these unknowns are grounded.
fn at_grounded(field: &Field, rows: &RowSet, i: usize, p: usize) -> f64 {
    let (range, at) = (field.data.touched.range(p), &field.at);
    let own: Vec<usize> = rows.matrix.row(i).map(|(j, _)| j).filter(|j| range.contains(j)).collect();
    if !own.iter().all(|&j| field.is_grounded(p, j)) {
        return 0.0;
    }
    let size = |of: &dyn Fn(usize) -> f64| {
        let forces: Vec<f64> = own.iter().map(|&j| of(j)).collect();
        weighted_norm(&forces, |k| 1.0 / at.metric[own[k]])
    };
    size(&|j| field.fitted[p].load[j - range.start]) + size(&|j| at.push[j])
}

/// The forces that would cause the motion prescribed by rows and grounded unknowns, force: `|S c_-| + |S_H h|`, `|S_T
/// s_old|` of nodes with friction that may hold, and those of the ground. For a body that is moved and not loaded there is no other
/// measure of its strain.
fn asked(field: &Field) -> f64 {
    let by_rows = |kind: RowKind, motion: fn(f64) -> f64| {
        let (rows, scale) = (field.rows(kind), &field.scales[kind as usize]);
        field.unit * norm_of((0..rows.len()).map(|i| scale[i] * motion(rows.rhs[i])).collect())
    };
    let by_support = norm_of(field.fitted.iter().map(|fitted| fitted.sizes.moved).collect());
    let contact = by_rows(RowKind::Inequality, |c| c.min(0.0));
    contact + by_rows(RowKind::Equality, |h| h) + by_support + by_friction(field)
}

/// `|S_T s_old|` of the nodes that may carry a tangential force.
fn by_friction(field: &Field) -> f64 {
    let kind = RowKind::Tangential;
    let (rows, scale) = (field.rows(kind), &field.scales[kind as usize]);
    let holding = field.data.nodes.iter().filter(|node| node.limit(field.answer.lambda) > 0.0);
    field.unit * norm_of(holding.flat_map(|node| node.rows()).map(|i| scale[i] * rows.rhs[i]).collect())
}

/// `|x|` without overflow or underflow.
fn norm_of(x: Vec<f64>) -> f64 {
    weighted_norm(&x, |_| 1.0)
}
