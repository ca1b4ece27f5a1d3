//! Equilibrium and rigid balance of every body, `res = K u - f + r`.

use crate::certificate::deformation::Deformation;
use crate::certificate::energy::Energies;
use crate::certificate::field::Field;
use crate::certificate::{positive, share, BodyData, Certificate, Entry, NOISE};
use crate::constraints::{RowKind, RowSet};
use crate::error::Result;
use crate::linalg::twofold::Twofold;
use crate::linalg::vector::{ratio, weighted_norm};
use crate::linalg::Matrix;
use crate::numbers::certificate::EXCUSED;
use crate::platform::memory::filled;

/// Measures of the forces.
pub(super) struct Forces {
    /// `|f|_{D^-1} + |r|_{D^-1}` of every body without its grounded unknowns, force; none if all its unknowns are
    /// grounded.
    sizes: Vec<Option<f64>>,
    /// `||f| + |B'||lambda| + |H'||mu||_{D^-1}` of every body without its grounded unknowns, force.
    terms: Vec<f64>,
    /// The same in D^.
    led: Vec<f64>,
    /// Bodies without load, except on grounded unknowns; a load below 64 eps of the forces of the island is none.
    unloaded: Vec<bool>,
    /// The load of every body if it is rounding of the load of the host's body, force; otherwise 0.
    noise: Vec<f64>,
    /// `(|f|^2 + |r|^2)^1/2` of all bodies without loads on grounded unknowns, force. If there is no such load, the
    /// forces for the prescribed motion (`asked`) are added.
    everywhere: f64,
    /// Deformation of every body, `U |delta|_D` without grounded unknowns, force.
    strains: Vec<f64>,
    /// The same of the island without carried unknowns, whose deformation follows from the forces of rows, also of those that cancel.
    strain: f64,
    /// The largest `(|f| + |r|)_{D^-1} / |delta|_D` of a body and `(|f_j| + |r_j|) / |D_j u_j|` of a grounded unknown, no unit.
    pub leverage: f64,
    /// Some force is not 0.
    acting: bool,
}

impl Forces {
    pub fn new(field: &Field, deformation: &Deformation) -> Self {
        let (mut sizes, mut terms, mut led) = (Vec::new(), Vec::new(), Vec::new());
        let (mut loads, mut pushes) = (Vec::new(), Vec::new());
        for p in 0..field.data.bodies.len() {
            let load = field.size(p, &field.free(p, |j| field.load(p, j)));
            let (own, own_terms) = (field.push.on(p), field.push_terms.on(p));
            let push = field.size(p, &field.free(p, |j| own[j]));
            let all = field.grounded.on(p).iter().all(|grounded| *grounded);
            sizes.push((!all).then_some(load + push));
            let given = field.free(p, |j| field.load(p, j).abs() + own_terms[j]);
            terms.push(field.size(p, &given));
            led.push(field.led_size(p, &given));
            loads.push(load);
            pushes.push(field.size(p, own));
        }
        let forces = norm_of([loads.as_slice(), pushes.as_slice()].concat());
        let moved = if loads.iter().all(|load| *load == 0.0) { asked(field) } else { 0.0 };
        let strains = (0..field.data.bodies.len()).map(|p| {
            let (own, u, metric) = (deformation.own.on(p), field.answer.u.on(p), field.metric.on(p));
            let mut strain = field.free(p, |j| positive(own[j] - NOISE * u[j].abs()));
            let all = field.unit * weighted_norm(&strain, |j| metric[j]);
            let touched = field.data.touched;
            let carried: Vec<usize> = touched.range(p).filter(|j| field.at.carried[*j]).collect();
            if carried.is_empty() {
                return (all, all);
            }
            carried.into_iter().for_each(|j| strain[touched.dof(j)] = 0.0);
            (all, field.unit * weighted_norm(&strain, |j| metric[j]))
        });
        let (strains, of_bodies): (Vec<f64>, Vec<f64>) = strains.unzip();
        let of_body = |(size, strain): (&Option<f64>, &f64)| ratio(size.unwrap_or(0.0), *strain);
        let leverage = sizes.iter().zip(&strains).map(of_body).fold(of_grounded(field), f64::max);
        let strain = weighted_norm(&of_bodies, |_| 1.0);
        let unloaded = loads.iter().map(|load| *load <= NOISE * forces).collect();
        let noise = loads.iter().zip(&field.data.bodies);
        let noise =
            noise.map(|(load, body)| if body.is_noise(load / field.unit.sqrt()) { *load } else { 0.0 });
        let noise = noise.collect();
        Self {
            sizes,
            terms,
            led,
            unloaded,
            noise,
            everywhere: forces + moved,
            strains,
            strain,
            leverage,
            acting: forces > 0.0,
        }
    }

    /// `part` of the forces of the island, force, if body p has neither a load nor larger forces; otherwise its load if that is
    /// rounding. Without a load forces below the accuracy of the data are zero: answers of other solvers carry 1e-13.
    fn idle(&self, p: usize, size: f64, part: f64) -> f64 {
        let most = part * self.everywhere;
        if self.unloaded[p] && size <= most {
            most
        } else {
            self.noise[p]
        }
    }

    /// Rounding of the forces on a body that a row touches, if they deform it no more than that, and of those of the island on
    /// a body without load and forces, (force x length)^1/2.
    pub fn rounding_at(&self, field: &Field, kind: RowKind, i: usize) -> f64 {
        let idle = |p: usize| self.idle(p, self.sizes[p].unwrap_or(0.0), NOISE);
        let of = |p: usize| {
            let rounding = NOISE * self.led[p];
            idle(p).max(if self.strains[p] <= rounding { rounding } else { 0.0 })
        };
        field.touched(field.rows(kind), i).map(of).fold(0.0, f64::max) / field.unit.sqrt()
    }

    /// The smallest deformation among the bodies that a row touches: `|delta|_D`, or the deformation by the body's forces
    /// if that is larger; length with the metric D / U. Infinite if all their unknowns are grounded.
    pub fn least_deformation(&self, field: &Field, kind: RowKind, i: usize) -> f64 {
        let of = |p: usize| Some(self.strains[p].max(self.sizes[p]?) / field.unit);
        field.touched(field.rows(kind), i).filter_map(of).fold(f64::INFINITY, f64::min)
    }

    /// Below this a force of a row counts as zero: `tol Lambda_i` with `Lambda_i = s_i min (|f| + |r|)_{D^-1}` over the
    /// bodies it touches, force. If it touches only grounded unknowns of a body, the forces on these are added.
    pub fn limit_of(&self, field: &Field, kind: RowKind, i: usize) -> f64 {
        let rows = field.rows(kind);
        let allowed = |p: usize| {
            let size = self.sizes[p].unwrap_or(0.0) + at_grounded(field, rows, i, p);
            (field.data.limit * size).max(self.idle(p, size, field.data.accuracy))
        };
        match field.touched(rows, i).map(allowed).reduce(smaller) {
            Some(least) => field.scales[kind as usize][i] * least,
            None => field.data.limit * rows.force_without_entries(kind, i).abs(),
        }
    }
}

/// The largest `(|f_j| + |r_j|) / |D_j u_j|` of a grounded unknown, no unit.
fn of_grounded(field: &Field) -> f64 {
    let of = |p: usize, j: usize| {
        let acting = field.load(p, j).abs() + field.push.on(p)[j].abs();
        ratio(acting / field.unit, field.metric.on(p)[j] * field.answer.u.on(p)[j].abs())
    };
    let own = |p: usize| field.dofs(p).filter(move |j| field.grounded.on(p)[*j]).map(move |j| of(p, j));
    (0..field.data.bodies.len()).flat_map(own).fold(0.0, f64::max)
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
    if !own.iter().all(|&j| at.grounded[j]) {
        return 0.0;
    }
    let size = |of: &dyn Fn(usize) -> f64| {
        let forces: Vec<f64> = own.iter().map(|&j| of(j)).collect();
        weighted_norm(&forces, |k| 1.0 / at.metric[own[k]])
    };
    size(&|j| at.load[j]) + size(&|j| at.push[j])
}

/// The forces that would cause the motion prescribed by rows and grounded unknowns, force: `|S c_-| + |S_H h|`, `|S_T
/// s_old|` of nodes with friction that may hold, and `|D^1/2 f_j / K_jj|` with the largest D of the body's unknowns that
/// are not grounded. For a body that is moved and not loaded there is no other measure of its strain.
fn asked(field: &Field) -> f64 {
    let by_rows = |kind: RowKind, motion: fn(f64) -> f64| {
        let (rows, scale) = (field.rows(kind), &field.scales[kind as usize]);
        field.unit * norm_of((0..rows.len()).map(|i| scale[i] * motion(rows.rhs[i])).collect())
    };
    let by_support = (0..field.data.bodies.len()).map(|p| {
        let (grounded, metric) = (field.grounded.on(p), field.metric.on(p));
        let softest = |free: f64, j: usize| if grounded[j] { free } else { metric[j].max(free) };
        let stiffness = field.dofs(p).fold(0.0, softest).sqrt();
        let moved = field.dofs(p).filter(|j| grounded[*j]);
        norm_of(moved.map(|j| stiffness * field.load(p, j) / metric[j]).collect())
    });
    let by_support = norm_of(by_support.collect());
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

/// Equilibrium and balance of body p, `lost` by the strain that rounding excuses; adds its part of the energies.
pub(super) fn judge(
    field: &Field,
    forces: &Forces,
    p: usize,
    (certificate, lost): (&mut Certificate, &mut Entry),
    energies: &mut Energies,
) -> Result<()> {
    let (u, limit) = (field.answer.u.on(p), field.data.limit);
    let (mut strain, mut terms) = (vec![0.0; u.len()], vec![0.0; u.len()]);
    field.data.bodies[p].stiffness.mul_with_terms(u, &mut strain, &mut terms)?;
    let shares = [
        equilibrium(field, forces, p, (&strain, &terms)),
        cancelled(field, forces, p, (&strain, &terms)),
        grounded(field, p, (&strain, &terms)),
    ];
    for share in shares {
        certificate.equilibrium.replace_if_worse(Entry::new(share, limit, Some(p)));
    }
    lost.replace_if_worse(Entry::new(excused(field, forces, p, (&strain, &terms)), limit, Some(p)));
    certificate.balance.replace_if_worse(Entry::new(balance(field, forces, p)?, limit, Some(p)));
    energies.add_body(field, p, (&strain, &terms));
    Ok(())
}

/// `res_j` of unknown j of body p, force, and 64 eps times its terms `t = |K||u| + |f| + |B'||lambda| + |H'||mu|`, from its `K u` and
/// `|K||u|`.
fn residual(field: &Field, p: usize, (strain, terms): (&[f64], &[f64]), j: usize) -> (f64, f64) {
    let f = field.load(p, j);
    (strain[j] - f + field.push.on(p)[j], NOISE * (terms[j] + f.abs() + field.push_terms.on(p)[j]))
}

/// `|(|res_j| - 64 eps t_j)_+|_{D^-1}` relative to `tol (|f| + |r| + |K u|)_{D^-1}`, without grounded unknowns; no unit.
fn equilibrium(field: &Field, forces: &Forces, p: usize, products: (&[f64], &[f64])) -> f64 {
    let Some(size) = forces.sizes[p] else { return 0.0 };
    let left = field.free(p, |j| {
        let (residual, noise) = residual(field, p, products, j);
        positive(residual.abs() - noise)
    });
    let strain = field.size(p, &field.free(p, |j| products.0[j]));
    share(
        field.size(p, &left),
        field.data.limit * (size + strain) + forces.idle(p, size, field.data.accuracy),
    )
}

/// The residual excused by rounding in `equilibrium`, relative to the largest that may be excused; no unit.
fn excused(field: &Field, forces: &Forces, p: usize, products: (&[f64], &[f64])) -> f64 {
    if !forces.acting {
        return 0.0;
    }
    let left = field.free(p, |j| {
        let (residual, noise) = residual(field, p, products, j);
        residual.abs().min(noise)
    });
    share(field.size(p, &left), EXCUSED * (forces.everywhere + forces.strain))
}

/// The residual excused by rounding of row forces that cancel, relative to `tol` times the forces of the island; no unit.
/// Redundant rows may distribute a force arbitrarily, but these forces must not be so large that their sum is lost.
fn cancelled(field: &Field, forces: &Forces, p: usize, products: (&[f64], &[f64])) -> f64 {
    let left = |j: usize| residual(field, p, products, j).0.abs().min(NOISE * field.push_terms.on(p)[j]);
    let left: Vec<f64> = field.dofs(p).map(left).collect();
    let allowed = field.data.limit * (forces.everywhere + forces.strain);
    share(field.size(p, &left), allowed)
}

/// `(|res_j| - 64 eps t_j)_+` relative to `tol (|r_j| + sum_k |K_jk||u_k|)`, the worst grounded unknown; no unit.
fn grounded(field: &Field, p: usize, products: (&[f64], &[f64])) -> f64 {
    let of = |j: usize| {
        let (residual, noise) = residual(field, p, products, j);
        let size = field.push.on(p)[j].abs() + products.1[j];
        share(positive(residual.abs() - noise), field.data.limit * size)
    };
    let worse = |worst: f64, share: f64| if share <= worst || worst.is_nan() { worst } else { share };
    field.dofs(p).filter(|j| field.grounded.on(p)[*j]).map(of).fold(0.0, worse)
}

/// `|R'(f - r)|` relative to `tol (|f| + |r|)_{D^-1} + 64 eps ||f| + |B'||lambda| + |H'||mu||_{D^-1}`, without grounded
/// unknowns; no unit. u has no influence: the forces of a body must balance however far it has moved. For soft motions
/// `(K R)'u` is part of the balance.
fn balance(field: &Field, forces: &Forces, p: usize) -> Result<f64> {
    let body = &field.data.bodies[p];
    let (motions, unit) = &field.motions[p];
    let Some(size) = forces.sizes[p].filter(|_| motions.cols > 0) else { return Ok(0.0) };
    let allowed =
        field.data.limit * size + NOISE * forces.terms[p] + forces.idle(p, size, field.data.accuracy);
    let push = field.push.on(p);
    // soft motions bend the body, and move grounded unknowns a little
    let felt = |value: &dyn Fn(usize) -> f64| -> Vec<f64> {
        if body.soft {
            field.dofs(p).map(value).collect()
        } else {
            field.free(p, value)
        }
    };
    let mut resultants = motions.mul_transposed(&felt(&|j| field.load(p, j) - push[j]));
    let weight = field.unit / unit;
    let of_grounded = if body.soft { terms_of_grounded(field, p) } else { 0.0 };
    let allowed = allowed + NOISE * of_grounded * weight.sqrt();
    let ratio = share(weighted_norm(&resultants, |_| weight), allowed);
    if ratio <= 1.0 && !body.soft {
        return Ok(ratio);
    }
    let u = felt(&|j| field.answer.u.on(p)[j]);
    let held =
        if body.soft { held_softly(body, motions, &u)? } else { resisted(field, p)?.mul_transposed(&u) };
    resultants.iter_mut().zip(held).for_each(|(left, held)| *left -= held);
    Ok(share(weighted_norm(&resultants, |_| weight), allowed))
}

/// `sum_j max_k |R_jk| (|f_j| + sum |b_j||lambda|)` over the grounded unknowns of body p.
fn terms_of_grounded(field: &Field, p: usize) -> f64 {
    let (motions, push_terms) = (&field.motions[p].0, field.push_terms.on(p));
    let of = |j: usize| {
        let fastest = |most: f64, k: usize| most.max(motions.get(j, k).abs());
        (0..motions.cols).fold(0.0, fastest) * (field.load(p, j).abs() + push_terms[j])
    };
    field.dofs(p).filter(|j| field.grounded.on(p)[*j]).map(of).sum()
}

/// `(K R)'u` of a body, r, in double-double arithmetic: for a weak spring the terms nearly cancel, and if K R is rounding
/// of R the sum is 0 for any u.
fn held_softly(body: &BodyData, motions: &Matrix, u: &[f64]) -> Result<Vec<f64>> {
    let by_motion = |k: usize| {
        let mut image = filled(u.len(), Twofold::default(), "the balance of a body")?;
        body.stiffness.add_twofold(1.0, motions.col(k), &mut image)?;
        let image: Vec<f64> = image.into_iter().map(Twofold::value).collect();
        Ok(Twofold::dot(&image, u))
    };
    (0..motions.cols).map(by_motion).collect()
}

/// `K R` of body p, n_p x r, force / length; 0 if it is rounding.
fn resisted(field: &Field, p: usize) -> Result<Matrix> {
    let (body, motions) = (&field.data.bodies[p], &field.motions[p].0);
    let (n, r) = (motions.rows, motions.cols);
    let (mut all, mut terms) = (Matrix::zeros(n, r)?, vec![0.0; n]);
    for k in 0..r {
        body.stiffness.mul_with_terms(motions.col(k), all.col_mut(k), &mut terms)?;
        let rounding = |(v, t): &(&mut f64, &f64)| v.abs() <= NOISE * **t;
        all.col_mut(k).iter_mut().zip(&terms).filter(rounding).for_each(|(v, _)| *v = 0.0);
    }
    Ok(all)
}
