//! When an answer is wrong: errors of u and of the forces of each body against a known answer.
//!
//! An error counts where it exceeds 1e-6 of the body's own size and 100 times what the certificate allows (sections 3, 6 of
//! the certificate's definitions). Everything comes from the host's data and the known answer; grounded unknowns (penalty
//! supports) are left out of all sizes and judged singly. D = diag K, r = B'lambda + H'mu, s_i = (b_i D^-1 b_i' + C_i)^-1/2.

use crate::dense::{orthonormal, remove, singular};
use crate::vector::axpy;
use crate::{Csr, Deck, Rows};

/// Tolerance of the certificate.
const TOLERANCE: f64 = 1e-8;
/// Rounding of a sum of terms.
const NOISE: f64 = 64.0 * f64::EPSILON;
/// Accuracy of the data: on a body without load forces below this part of all forces are none.
const ACCURACY: f64 = 1e-10;
/// An error is none below this part of the body's own.
const OWN: f64 = 1e-6;
/// Nor below this many times what the certificate allows.
const SHARE: f64 = 100.0;

/// u over all unknowns, forces of contact and equality rows.
#[derive(Clone, Debug)]
pub struct Answer {
    pub u: Vec<f64>,
    pub lambda: Vec<f64>,
    pub mu: Vec<f64>,
}

/// The error of one body over what is allowed, of u and of the forces.
#[derive(Clone, Copy, Debug, Default)]
pub struct Ratio {
    pub u: f64,
    pub forces: f64,
}

impl Ratio {
    pub fn worst(self) -> f64 {
        if self.u.is_nan() || self.forces.is_nan() {
            return f64::INFINITY;
        }
        self.u.max(self.forces)
    }
}

/// Sizes of a body.
#[derive(Clone, Copy, Debug)]
pub struct Size {
    /// |u - Z a|_D, Z the rigid motions of floating bodies that rigid equality rows between bodies leave.
    pub deformation: f64,
    /// |r|_{D^-1}
    pub forces: f64,
    /// |(error of u)|_D and |(error of r)|_{D^-1} that the certificate may overlook, (force x length)^1/2.
    pub overlooked: f64,
}

pub struct Yardstick<'a> {
    deck: &'a Deck,
    answer: &'a Answer,
    /// Rigid motions of floating bodies are not to be compared.
    undetermined: bool,
    diagonal: Vec<f64>,
    pub grounded: Vec<bool>,
    /// B'lambda + H'mu of the answer.
    reaction: Vec<f64>,
    pub sizes: Vec<Size>,
    /// Error of each grounded unknown that the certificate may overlook, length.
    single: Vec<f64>,
    /// `sum_k |K_jk| D_k^-1/2 / K_jj` over its neighbours, length / (force x length)^1/2: it follows their errors.
    following: Vec<f64>,
}

/// K_jj > 1e3 T_j, T_j = sum_{i != j} K_ij^2 / K_ii > 0: an unknown whose displacement is all but given.
fn grounded(stiffness: &Csr) -> Vec<bool> {
    let diagonal = stiffness.diagonal();
    let neighbours = |j: usize| -> f64 {
        stiffness.row(j).filter(|&(i, _)| i != j).map(|(i, k)| k * k / diagonal[i]).sum()
    };
    (0..stiffness.rows)
        .map(|j| {
            let around = neighbours(j);
            around > 0.0 && diagonal[j] > 1e3 * around
        })
        .collect()
}

/// Which unknowns of all bodies are grounded.
pub fn all_grounded(deck: &Deck) -> Vec<bool> {
    deck.bodies.iter().flat_map(|body| grounded(&body.stiffness)).collect()
}

impl<'a> Yardstick<'a> {
    pub fn new(deck: &'a Deck, answer: &'a Answer, undetermined: bool) -> Yardstick<'a> {
        Self::with_pilots(deck, answer, undetermined, &[])
    }

    /// As `new`, with another D at some unknowns: what rows give them in place of K.
    pub fn with_pilots(
        deck: &'a Deck,
        answer: &'a Answer,
        undetermined: bool,
        pilots: &[(usize, f64)],
    ) -> Yardstick<'a> {
        let mut diagonal: Vec<f64> = deck.bodies.iter().flat_map(|body| body.stiffness.diagonal()).collect();
        pilots.iter().for_each(|&(dof, given)| diagonal[dof] = given);
        let grounded = all_grounded(deck);
        let reaction = reaction(deck, answer);
        let (sizes, single, following) = (Vec::new(), Vec::new(), Vec::new());
        let mut yardstick =
            Yardstick { deck, answer, undetermined, diagonal, grounded, reaction, sizes, single, following };
        yardstick.measure();
        yardstick
    }

    /// |v|_{D^power} on the unknowns of body p that are not grounded, power 1 or -1.
    pub fn norm(&self, p: usize, v: &[f64], power: i32) -> f64 {
        let range = self.deck.offset(p)..self.deck.offset(p + 1);
        let free = range.filter(|&i| !self.grounded[i]);
        free.map(|i| v[i] * v[i] * self.diagonal[i].powi(power)).sum::<f64>().sqrt()
    }

    /// What section 3 allows, in the norms of D and D^-1:
    /// the larger of tol (|f| + |r| + |K u|) + 64 eps |t| and max_i s_i (tol L_i + 64 eps (|b_i||u| + |c_i| + C_i |lambda_i|))
    /// over the rows of the body that are closed, with a force or just touching, and its equality rows.
    fn measure(&mut self) {
        let (deformation, terms, strain) = (self.deformation(), self.terms(), self.strain());
        let load = self.deck.load();
        let delta: Vec<f64> = (0..deformation.len())
            .map(
                |j| if self.grounded[j] { self.reaction[j].abs() / self.diagonal[j] } else { deformation[j] },
            )
            .collect();
        let mut of_rows = vec![0.0; self.deck.bodies.len()];
        let sets = [
            (&self.deck.contact, &self.answer.lambda, false),
            (&self.deck.equalities, &self.answer.mu, true),
        ];
        for (rows, forces, all) in sets {
            for i in (0..rows.len()).filter(|&i| rows.rhs[i].is_finite()) {
                let error = self.row(rows, i, forces[i], &delta);
                if !all && forces[i] == 0.0 && self.open(rows, i) > SHARE * error {
                    continue;
                }
                for (p, worst) in of_rows.iter_mut().enumerate() {
                    if self.touches(rows, i, p) {
                        *worst = error.max(*worst);
                    }
                }
            }
        }
        let of_bodies = |v: &[f64]| -> Vec<f64> { (0..of_rows.len()).map(|p| self.norm(p, v, -1)).collect() };
        let loads = of_bodies(&load);
        let all = loads.iter().chain(&of_bodies(&self.reaction)).map(|size| size * size).sum::<f64>().sqrt();
        let idle = |p: usize| if loads[p] <= NOISE * all { ACCURACY * all } else { 0.0 };
        for (p, of_rows) in of_rows.iter().enumerate() {
            let norm = |v: &[f64]| self.norm(p, v, -1);
            let forces = norm(&self.reaction);
            let of_body = TOLERANCE * (norm(&load) + forces + norm(&strain)) + NOISE * norm(&terms);
            let overlooked = of_body.max(*of_rows).max(idle(p));
            self.sizes.push(Size { deformation: self.norm(p, &deformation, 1), forces, overlooked });
        }
        self.single = (0..terms.len())
            .map(|j| (TOLERANCE * (self.reaction[j].abs() + terms[j]) + NOISE * terms[j]) / self.diagonal[j])
            .collect();
        self.following = self.following();
    }

    fn following(&self) -> Vec<f64> {
        let bodies = self.deck.bodies.iter().enumerate();
        let of = |(p, body): (usize, &crate::Body)| {
            let own = &self.diagonal[self.deck.offset(p)..self.deck.offset(p + 1)];
            let grounded = &self.grounded[self.deck.offset(p)..self.deck.offset(p + 1)];
            let follows = |j: usize| {
                let neighbours = body.stiffness.row(j).filter(|&(k, _)| k != j && !grounded[k]);
                neighbours.map(|(k, v)| v.abs() / own[k].sqrt()).sum::<f64>() / own[j]
            };
            (0..body.dofs()).map(follows).collect::<Vec<_>>()
        };
        bodies.flat_map(of).collect()
    }

    /// s_i times what row i may be off, L_i = |b_i| delta + |lambda_i| / s_i^2.
    fn row(&self, rows: &Rows, i: usize, force: f64, delta: &[f64]) -> f64 {
        let sum = |of: &dyn Fn(usize, f64) -> f64| rows.matrix.row(i).map(|(j, v)| of(j, v)).sum::<f64>();
        let square = sum(&|j, v| v * v / self.diagonal[j]) + rows.compliance[i];
        let length = sum(&|j, v| v.abs() * delta[j].abs()) + force.abs() * square;
        let given = sum(&|j, v| (v * self.answer.u[j]).abs()) + rows.rhs[i].abs();
        let noise = NOISE * (given + rows.compliance[i] * force.abs());
        (TOLERANCE * length + noise) / square.sqrt()
    }

    /// s_i (c_i - b_i u) of a row without force.
    fn open(&self, rows: &Rows, i: usize) -> f64 {
        let square =
            rows.matrix.row(i).map(|(j, v)| v * v / self.diagonal[j]).sum::<f64>() + rows.compliance[i];
        let moved = rows.matrix.row(i).map(|(j, v)| v * self.answer.u[j]).sum::<f64>();
        (rows.rhs[i] - moved) / square.sqrt()
    }

    fn touches(&self, rows: &Rows, i: usize, p: usize) -> bool {
        let range = self.deck.offset(p)..self.deck.offset(p + 1);
        rows.matrix.row(i).any(|(j, _)| range.contains(&j))
    }

    /// |K||u| + |f| + |B'||lambda| + |H'||mu|
    fn terms(&self) -> Vec<f64> {
        let mut terms: Vec<f64> = self.deck.load().iter().map(|f| f.abs()).collect();
        for (p, body) in self.deck.bodies.iter().enumerate() {
            let first = self.deck.offset(p);
            for i in 0..body.dofs() {
                let row = body.stiffness.row(i).map(|(j, k)| (k * self.answer.u[first + j]).abs());
                terms[first + i] += row.sum::<f64>();
            }
        }
        for (rows, forces) in
            [(&self.deck.contact, &self.answer.lambda), (&self.deck.equalities, &self.answer.mu)]
        {
            for (i, force) in forces.iter().enumerate() {
                rows.matrix.row(i).for_each(|(j, v)| terms[j] += (v * force).abs());
            }
        }
        terms
    }

    fn strain(&self) -> Vec<f64> {
        let bodies = self.deck.bodies.iter().enumerate();
        let own = |(p, body): (usize, &crate::Body)| {
            body.stiffness.times(&self.answer.u[self.deck.offset(p)..self.deck.offset(p + 1)])
        };
        bodies.flat_map(own).collect()
    }

    /// u - Z a, cluster by cluster: bodies that rigid equality rows join.
    fn deformation(&self) -> Vec<f64> {
        let (deck, mut rest) = (self.deck, self.answer.u.clone());
        for cluster in clusters(deck) {
            let basis = self.motions(&cluster);
            remove(&basis, &self.diagonal, &mut rest);
            remove(&basis, &self.diagonal, &mut rest);
        }
        rest
    }

    /// Z'DZ = I: the rigid motions of a cluster that its joints leave, over all unknowns.
    fn motions(&self, cluster: &[usize]) -> Vec<Vec<f64>> {
        let deck = self.deck;
        let joints: Vec<usize> =
            joints(deck).filter(|&i| cluster.iter().any(|&p| self.touches(&deck.equalities, i, p))).collect();
        let mut modes = Vec::new();
        for &p in cluster {
            let range = deck.offset(p)..deck.offset(p + 1);
            for mode in orthonormal(deck.bodies[p].modes(), &self.diagonal[range.clone()]) {
                let mut whole = vec![0.0; deck.dofs()];
                whole[range.clone()].copy_from_slice(&mode);
                modes.push(whole);
            }
        }
        let felt = |mode: &Vec<f64>| -> Vec<f64> {
            let row = |&i: &usize| {
                let square: f64 = deck.equalities.matrix.row(i).map(|(j, v)| v * v / self.diagonal[j]).sum();
                deck.equalities.matrix.row(i).map(|(j, v)| v * mode[j]).sum::<f64>() / square.sqrt()
            };
            joints.iter().map(row).collect()
        };
        let felt = singular(modes.iter().map(felt).collect());
        let free = felt.right.iter().zip(&felt.values).filter(|(_, &value)| value <= 1e-10);
        free.map(|(a, _)| {
            let mut motion = vec![0.0; deck.dofs()];
            a.iter().zip(&modes).for_each(|(a, mode)| axpy(*a, mode, &mut motion));
            motion
        })
        .collect()
    }

    /// The error of every body over what is allowed: at most 1 where the answer is right.
    pub fn ratios(&self, other: &Answer) -> Vec<Ratio> {
        let mut moved: Vec<f64> = self.difference(&other.u, &self.answer.u);
        let forces = self.difference(&reaction(self.deck, other), &self.reaction);
        if self.undetermined {
            for (p, body) in self.deck.bodies.iter().enumerate() {
                let range = self.deck.offset(p)..self.deck.offset(p + 1);
                let own = &self.diagonal[range.clone()];
                remove(&orthonormal(body.modes(), own), own, &mut moved[range]);
            }
        }
        (0..self.sizes.len()).map(|p| self.ratio(p, &moved, &forces)).collect()
    }

    fn ratio(&self, p: usize, moved: &[f64], forces: &[f64]) -> Ratio {
        let size = self.sizes[p];
        let allowed = |own: f64| (OWN * own).max(SHARE * size.overlooked);
        let over = |error: f64, own: f64| ratio(error, allowed(own));
        let single = (self.deck.offset(p)..self.deck.offset(p + 1)).filter(|&j| self.grounded[j]);
        let single = single.map(|j| {
            let following = self.following[j] * allowed(size.deformation);
            ratio(moved[j].abs(), SHARE * self.single[j] + following)
        });
        let u = over(self.norm(p, moved, 1), size.deformation);
        Ratio {
            u: single.fold(u, |worst, ratio| if ratio > worst || ratio.is_nan() { ratio } else { worst }),
            forces: over(self.norm(p, forces, -1), size.forces),
        }
    }

    fn difference(&self, a: &[f64], b: &[f64]) -> Vec<f64> {
        a.iter().zip(b).map(|(a, b)| a - b).collect()
    }

    /// The worst ratio of all bodies, and its body.
    pub fn worst(&self, other: &Answer) -> (f64, usize) {
        let ratios = self.ratios(other).into_iter().map(Ratio::worst).enumerate();
        ratios.fold((0.0, 0), |worst, (p, ratio)| if ratio > worst.0 { (ratio, p) } else { worst })
    }

    /// D over all unknowns, force per length.
    pub fn metric(&self) -> &[f64] {
        &self.diagonal
    }
}

fn ratio(part: f64, whole: f64) -> f64 {
    if part == 0.0 {
        0.0
    } else {
        part / whole
    }
}

/// B'lambda + H'mu
pub fn reaction(deck: &Deck, answer: &Answer) -> Vec<f64> {
    let mut reaction = deck.contact.matrix.transpose_times(&answer.lambda);
    axpy(1.0, &deck.equalities.matrix.transpose_times(&answer.mu), &mut reaction);
    reaction
}

/// The body of an unknown.
pub fn body_of(deck: &Deck, dof: usize) -> usize {
    (0..deck.bodies.len()).find(|&p| dof < deck.offset(p + 1)).expect("a body")
}

/// Rigid equality rows that join two or more bodies.
fn joints(deck: &Deck) -> impl Iterator<Item = usize> + '_ {
    let rows = &deck.equalities;
    (0..rows.len()).filter(move |&i| {
        let mut bodies = rows.matrix.row(i).map(|(j, _)| body_of(deck, j));
        let first = bodies.next();
        rows.compliance[i] == 0.0 && bodies.any(|p| Some(p) != first)
    })
}

/// Bodies that joints connect.
fn clusters(deck: &Deck) -> Vec<Vec<usize>> {
    let mut label: Vec<usize> = (0..deck.bodies.len()).collect();
    for i in joints(deck) {
        let bodies: Vec<usize> =
            deck.equalities.matrix.row(i).map(|(j, _)| label[body_of(deck, j)]).collect();
        for &old in &bodies[1..] {
            let new = bodies[0];
            label.iter_mut().for_each(|l| *l = if *l == old { new } else { *l });
        }
    }
    let groups = (0..label.len()).map(|l| (0..label.len()).filter(|&p| label[p] == l).collect::<Vec<_>>());
    groups.filter(|group| !group.is_empty()).collect()
}

#[cfg(test)]
mod tests;
