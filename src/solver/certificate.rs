//! The certificate: how well an answer (u, lambda, mu) satisfies the optimality conditions of (10)-(11),
//! computed from the host's own matrices. Every figure is relative: the same in any units and for any
//! scaling of the rows. C = diag(1/k) is the compliance of the rows, S = (B D^-1 B' + C)^-1/2.

use crate::body::Stiffness;
use crate::constraints::{row_scales, RowSet};
use crate::error::Result;
use crate::linalg::vector::{dot, ratio, weighted_norm};
use crate::linalg::Matrix;

/// One condition: its relative figure, at most the limit where it holds, its ratio to what is allowed, and where it is
/// worst.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Entry {
    pub figure: f64,
    /// The condition holds when this is at most 1.
    pub ratio: f64,
    pub place: Option<usize>,
}

#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Certificate {
    /// Largest figure allowed.
    pub limit: f64,
    /// `|K u - f + B'lambda + H'mu|`, worst body.
    pub equilibrium: Entry,
    /// `|R'(f - B'lambda - H'mu)|`, worst body.
    pub balance: Entry,
    /// `|(B u - c - C lambda)_+|`, worst row.
    pub penetration: Entry,
    /// `|H u - h - C mu|`, worst row.
    pub equality: Entry,
    /// `|lambda_-|`, worst row.
    pub negative_force: Entry,
    /// `sum |lambda_i| |c_i + C_i lambda_i - b_i u|`, worst row.
    pub complementarity: Entry,
    /// `|u'K u - f'u + c'lambda + h'mu + lambda'C lambda + mu'C mu|`
    pub duality_gap: Entry,
    /// `1/2 u'K u - f'u + 1/2 lambda'C lambda + 1/2 mu'C mu`, force x length: what is minimised, springs of compliant rows
    /// included.
    pub energy: f64,
}

impl Certificate {
    pub fn entries(&self) -> [Entry; 7] {
        [
            self.equilibrium,
            self.balance,
            self.penetration,
            self.equality,
            self.negative_force,
            self.complementarity,
            self.duality_gap,
        ]
    }

    /// Largest ratio of an entry to what is allowed.
    pub fn worst(&self) -> f64 {
        self.entries().iter().fold(0.0, |worst, entry| {
            if entry.ratio > worst || entry.ratio.is_nan() {
                entry.ratio
            } else {
                worst
            }
        })
    }

    /// The worst entries of two, the energy of both.
    pub fn worse(&self, other: &Self) -> Self {
        let worse = |a: Entry, b: Entry| if b.ratio > a.ratio || b.ratio.is_nan() { b } else { a };
        Self {
            limit: self.limit,
            equilibrium: worse(self.equilibrium, other.equilibrium),
            balance: worse(self.balance, other.balance),
            penetration: worse(self.penetration, other.penetration),
            equality: worse(self.equality, other.equality),
            negative_force: worse(self.negative_force, other.negative_force),
            complementarity: worse(self.complementarity, other.complementarity),
            duality_gap: worse(self.duality_gap, other.duality_gap),
            energy: self.energy + other.energy,
        }
    }

    /// Forces and equilibrium pass, a gap or an energy does not: rounding of the loads may have moved it.
    pub fn only_motions_fail(&self) -> bool {
        let forces = [self.equilibrium, self.balance, self.negative_force];
        !self.passed() && forces.iter().all(|entry| entry.ratio <= 1.0)
    }

    /// A figure that is not a number fails.
    pub fn passed(&self) -> bool {
        self.entries().iter().all(|entry| entry.ratio <= 1.0)
    }
}

/// The problem as the host gave it.
#[derive(Clone)]
pub struct Data<'a> {
    /// Per body: stiffness, load, null space.
    pub bodies: Vec<BodyData<'a>>,
    pub contact: &'a RowSet,
    pub equalities: &'a RowSet,
    /// Metric of dofs without stiffness, force / length.
    pub without: f64,
    pub limit: f64,
    /// Work that the loads would do on each body alone, once it has been asked for, force x length.
    pub work_of_loads: Option<f64>,
}

#[derive(Clone)]
pub struct BodyData<'a> {
    pub start: usize,
    pub stiffness: Stiffness<'a>,
    /// Zero when absent.
    pub load: Option<&'a [f64]>,
    /// `R_p` with `R'DR = unit`, D = diag K.
    pub null_space: &'a Matrix,
    pub unit: f64,
}

/// An answer over all unknowns, contact rows, equality rows.
#[derive(Clone, Copy)]
pub struct Answer<'a> {
    pub u: &'a [f64],
    pub lambda: &'a [f64],
    pub mu: &'a [f64],
}

/// Rounding errors of a sum of these terms.
const NOISE: f64 = 64.0 * f64::EPSILON;
/// What rounding may excuse in the equilibrium of one body, in units of the limit, against the forces on all bodies: where
/// a body has moved so far that its strain is lost to rounding, the answer is not known.
const EXCUSED: f64 = 100.0;

/// What the sums over all bodies need besides their own entries.
#[derive(Default)]
struct Totals {
    /// `|f|_{D^-1}`
    load: f64,
    /// `u'K u`, `f'u`, `|u|'(|K||u| + |f| + |B'||lambda| + |H'||mu|)`
    strain: f64,
    work: f64,
    terms: f64,
    /// `||f| + |B'||lambda| + |H'||mu||_{D^-1}^2`: f - r is known to rounding of its terms, so u is known to rounding of
    /// what each of them would move.
    forces: f64,
    /// There are forces.
    acting: bool,
}

/// Fails where the host does, that has the products with K.
pub fn certify(data: &Data, answer: Answer) -> Result<Certificate> {
    let mut certificate = Certificate { limit: data.limit, ..Certificate::default() };
    let metric = metric(data, answer.u.len());
    let totals = forces(data, answer, &metric, &mut certificate)?;
    let gaps = gaps(data, answer, &metric, &totals, &mut certificate);
    let size = totals.work.abs() + gaps.constrained_size;
    let noise = NOISE * (totals.terms + totals.forces.max(data.work_of_loads.unwrap_or(0.0)) + gaps.stored);
    // energies of forces whose squares underflow are not known
    let noise = if totals.acting && !noise.is_normal() { f64::NAN } else { noise };
    let energies = |part: f64, whole: f64, place| entry(part, whole, noise, data.limit, place);
    certificate.complementarity = energies(gaps.complementarity, size, gaps.worst_pair);
    let gap = totals.strain - totals.work + gaps.constrained;
    certificate.duality_gap = energies(gap.abs(), totals.strain.abs() + size, None);
    certificate.energy = 0.5 * totals.strain - totals.work + 0.5 * gaps.stored;
    Ok(certificate)
}

/// What is measured against infinity is not known.
fn entry(part: f64, whole: f64, noise: f64, limit: f64, place: Option<usize>) -> Entry {
    let allowed = limit * whole + noise;
    Entry {
        figure: ratio(part, whole + noise / limit),
        ratio: if allowed.is_finite() { ratio(part, allowed) } else { f64::NAN },
        place: place.filter(|_| part > 0.0),
    }
}

/// `D = diag K` over all unknowns.
pub fn metric(data: &Data, unknowns: usize) -> Vec<f64> {
    let mut metric = vec![data.without; unknowns];
    for body in &data.bodies {
        (0..body.stiffness.order())
            .for_each(|i| metric[body.start + i] = body.stiffness.metric(i, data.without));
    }
    metric
}

/// Equilibrium and rigid balance of every body.
fn forces(data: &Data, answer: Answer, metric: &[f64], certificate: &mut Certificate) -> Result<Totals> {
    let n = answer.u.len();
    let (mut reaction, mut reaction_terms) = (vec![0.0; n], vec![0.0; n]);
    for (rows, multipliers) in [(data.contact, answer.lambda), (data.equalities, answer.mu)] {
        rows.matrix.mul_transposed_add(1.0, multipliers, &mut reaction);
        rows.matrix.mul_transposed_abs_add(multipliers, &mut reaction_terms);
    }
    let (loads, pushes) = sizes(data, &reaction, metric);
    let mut totals = Totals { load: norm(&loads), ..Totals::default() };
    let everywhere = all_forces(data, metric, totals.load, norm(&pushes));
    for (p, body) in data.bodies.iter().enumerate() {
        let range = body.start..body.start + body.stiffness.order();
        let none = vec![0.0; if body.load.is_none() { range.len() } else { 0 }];
        let (u, f) = (&answer.u[range.clone()], body.load.unwrap_or(&none));
        let (push, push_terms) = (&reaction[range.clone()], &reaction_terms[range.clone()]);
        let weight = |i: usize| 1.0 / metric[body.start + i];
        let size = |v: &[f64]| weighted_norm(v, weight);
        let (mut strain, mut terms) = (vec![0.0; u.len()], vec![0.0; u.len()]);
        body.stiffness.mul_with_terms(u, &mut strain, &mut terms)?;
        let given: Vec<f64> = (0..u.len()).map(|i| f[i].abs() + push_terms[i]).collect();
        (0..u.len()).for_each(|i| terms[i] += given[i]);
        totals.strain += dot(u, &strain);
        totals.work += dot(f, u);
        totals.terms += u.iter().zip(&terms).map(|(u, t)| u.abs() * t).sum::<f64>();

        let loads = loads[p] + pushes[p];
        // forces of rows are known to rounding of the largest of all: a body may have no other
        let idle = if loads <= NOISE * everywhere { everywhere } else { 0.0 };
        let noise = (NOISE * (size(&terms) + idle)).min(EXCUSED * data.limit * everywhere);
        let left: Vec<f64> = (0..u.len()).map(|i| strain[i] - f[i] + push[i]).collect();
        let equilibrium = entry(size(&left), loads + size(&strain), noise, data.limit, Some(p));
        replace_if_worse(&mut certificate.equilibrium, equilibrium);
        let rest: Vec<f64> = (0..u.len()).map(|i| f[i] - push[i]).collect();
        let resultants = body.null_space.mul_transposed(&rest);
        let resultant = weighted_norm(&resultants, |_| 1.0 / body.unit);
        // u takes no part in it: however far a body has moved, its forces must balance
        let given = size(&given);
        totals.forces += given * given;
        totals.acting |= given > 0.0;
        let noise = NOISE * (given + idle);
        replace_if_worse(&mut certificate.balance, entry(resultant, loads, noise, data.limit, Some(p)));
    }
    Ok(totals)
}

fn norm(x: &[f64]) -> f64 {
    weighted_norm(x, |_| 1.0)
}

/// `|f|` and `|B'lambda + H'mu|` of every body, in the metric `D^-1`.
fn sizes(data: &Data, reaction: &[f64], metric: &[f64]) -> (Vec<f64>, Vec<f64>) {
    let of_body = |body: &BodyData| {
        let weight = |i: usize| 1.0 / metric[body.start + i];
        let push = &reaction[body.start..body.start + body.stiffness.order()];
        (weighted_norm(body.load.unwrap_or_default(), weight), weighted_norm(push, weight))
    };
    data.bodies.iter().map(of_body).unzip()
}

/// A: `(|f|^2 + |B'lambda + H'mu|^2)^1/2` in the metric `D^-1`, over all bodies. Without any load the forces that the motion
/// asked for by the rows would take at their own unknowns belong to it, `|S c_-| + |S_H h|`: a body that is moved, not
/// loaded, has no other measure of its strain.
fn all_forces(data: &Data, metric: &[f64], load: f64, push: f64) -> f64 {
    let forces = norm(&[load, push]);
    if load > 0.0 {
        return forces;
    }
    let asked = |rows: &RowSet, motion: fn(f64) -> f64| {
        let scale = row_scales(rows, metric, 1.0);
        norm(&(0..rows.len()).map(|i| scale[i] * motion(rows.rhs[i])).collect::<Vec<_>>())
    };
    forces + asked(data.contact, |c| c.min(0.0)) + asked(data.equalities, |h| h)
}

fn replace_if_worse(worst: &mut Entry, entry: Entry) {
    if worst.place.is_none() || entry.ratio > worst.ratio || entry.ratio.is_nan() {
        *worst = entry;
    }
}

/// What the energies need of the rows.
struct Gaps {
    /// `sum |lambda_i| |c_i + C_i lambda_i - b_i u|` and the row with the largest term.
    complementarity: f64,
    worst_pair: Option<usize>,
    /// `lambda'C lambda + mu'C mu`, twice the energy of the compliant rows.
    stored: f64,
    /// `c'lambda + h'mu + lambda'C lambda + mu'C mu`, and the same of absolute values.
    constrained: f64,
    constrained_size: f64,
}

/// Penetration, equality, sign of the contact forces; rows weighted by S.
fn gaps(data: &Data, answer: Answer, metric: &[f64], totals: &Totals, certificate: &mut Certificate) -> Gaps {
    let (contact, equalities) = (
        Violation::of(data.contact, answer.u, answer.lambda, metric, |v| v.max(0.0)),
        Violation::of(data.equalities, answer.u, answer.mu, metric, f64::abs),
    );
    let moved = totals.load.max(data.work_of_loads.unwrap_or(0.0).sqrt());
    certificate.penetration = contact.entry(data.limit, moved);
    certificate.equality = equalities.entry(data.limit, moved);
    let scaled = |i: usize, v: f64| if contact.scale[i] > 0.0 { v / contact.scale[i] } else { 0.0 };
    let force: Vec<f64> = (0..answer.lambda.len()).map(|i| scaled(i, answer.lambda[i])).collect();
    let negative: Vec<f64> = force.iter().map(|l| (-l).max(0.0)).collect();
    let whole = norm(&force) + totals.load;
    let place = largest(&negative);
    certificate.negative_force = entry(norm(&negative), whole, 0.0, data.limit, place);
    let pairs: Vec<f64> =
        (0..answer.lambda.len()).map(|i| (answer.lambda[i] * contact.open[i]).abs()).collect();
    let size = |l: &[f64], c: &[f64]| l.iter().zip(c).map(|(l, c)| (l * c).abs()).sum::<f64>();
    let stored = data.contact.stored(answer.lambda) + data.equalities.stored(answer.mu);
    Gaps {
        complementarity: pairs.iter().sum(),
        worst_pair: largest(&pairs),
        stored,
        constrained: dot(answer.lambda, &data.contact.rhs) + dot(answer.mu, &data.equalities.rhs) + stored,
        constrained_size: size(answer.lambda, &data.contact.rhs)
            + size(answer.mu, &data.equalities.rhs)
            + stored,
    }
}

/// By how much rows are violated.
struct Violation {
    /// s_i
    scale: Vec<f64>,
    /// `c_i + C_i lambda_i - b_i u`
    open: Vec<f64>,
    /// `s_i x` the violation of row i.
    violated: Vec<f64>,
    /// `|S|B||u|| + |S c| + |S C lambda|`, and what it would be if the rows moved like the mean dof: rows that
    /// hold a body in place (u = 0, h = 0) are measured against the movement of the bodies.
    size: f64,
}

impl Violation {
    fn of(rows: &RowSet, u: &[f64], multipliers: &[f64], metric: &[f64], excess: fn(f64) -> f64) -> Self {
        let scale = row_scales(rows, metric, 1.0);
        let open: Vec<f64> = (0..rows.len()).map(|i| rows.open_gap(i, u, multipliers[i])).collect();
        let violated: Vec<f64> = (0..rows.len()).map(|i| scale[i] * excess(-open[i])).collect();
        let size = |length: &dyn Fn(usize) -> f64| {
            norm(&(0..rows.len()).map(|i| scale[i] * length(i)).collect::<Vec<_>>())
        };
        let mean = weighted_norm(u, |i| metric[i]) * (rows.len() as f64 / u.len().max(1) as f64).sqrt();
        let size = size(&|i| rows.matrix.row_dot_abs(i, u))
            + size(&|i| rows.rhs[i])
            + size(&|i| rows.compliance[i] * multipliers[i])
            + mean;
        // rows that weigh nothing are not known to hold
        let size = if rows.without_scale(&scale).is_some() { f64::NAN } else { size };
        Self { scale, open, violated, size }
    }

    /// `moved`: what the loads would move by themselves, in the metric D; its rounding moves the rows as well. Forces do not
    /// count: where rows all but contradict each other they are as large as you like.
    fn entry(&self, limit: f64, moved: f64) -> Entry {
        let part = norm(&self.violated);
        entry(part, self.size, NOISE * (self.size + moved), limit, largest(&self.violated))
    }
}

/// Position of the largest entry, none of nothing.
fn largest(values: &[f64]) -> Option<usize> {
    (0..values.len()).reduce(|best, i| if values[i] > values[best] { i } else { best })
}

#[cfg(test)]
mod tests;
