//! A case in the order it is drawn: bodies, deformation, rows, forces, travel; then gaps and loads follow.

use crate::dd::{self, Dd};
use crate::dense::{inner, orthonormal, remove};
use crate::random::Random;
use crate::varied::bodies::{self, Spread};
use crate::varied::{condition, rounded, rounded_to, Class, Varied};
use crate::vector::axpy;
use crate::yardstick::{all_grounded, body_of};
use crate::{Deck, Rows};

pub(crate) struct Draft {
    pub random: Random,
    pub classes: Vec<Class>,
    pub deck: Deck,
    /// Group of each body.
    pub group: Vec<usize>,
    /// Size of lengths in each group.
    pub length: Vec<f64>,
    /// D = diag K over all unknowns.
    pub diagonal: Vec<f64>,
    /// Unknowns that no row may touch: their forces would not be felt.
    pub grounded: Vec<bool>,
    penalties: Vec<usize>,
    /// u without travel, then with it.
    pub u: Vec<f64>,
    /// |K u|_{D^-1} of each body, its share of one row.
    pub strength: Vec<f64>,
    /// Bodies that hardly deform.
    pub idle: Vec<bool>,
    pub lambda: Vec<f64>,
    pub mu: Vec<f64>,
    /// Slack of each contact row over the length of its group; 0 where it is closed.
    pub slack: Vec<f64>,
}

impl Draft {
    pub fn is(&self, class: Class) -> bool {
        self.classes.contains(&class)
    }

    /// Of at most so many unknowns, but for the last body.
    pub fn new(classes: Vec<Class>, unknowns: usize, mut random: Random) -> Draft {
        let has = |class: Class| classes.contains(&class);
        let groups = if has(Class::Groups) { 2 + random.below(2) } else { 1 };
        let (mut list, mut group, mut length, mut penalties) = (vec![], vec![], vec![], vec![]);
        let mut room = unknowns;
        for g in 0..groups {
            let stiffness = random.decades(-8.0, 8.0);
            length.push(random.decades(-4.0, 1.0));
            let count = 1 + random.below(6 / groups);
            for _ in 0..if has(Class::StiffOnSoft) || has(Class::Glue) { count.max(2) } else { count } {
                let contrast = if has(Class::StiffOnSoft) { 6.0 } else { 1.0 };
                let decades = if has(Class::Moduli) { random.between(1.0, 9.0) } else { 0.0 };
                let spread = Spread { stiffness: stiffness * random.decades(-contrast, contrast), decades };
                let held = random.chance(0.35);
                let is_single = has(Class::Springs) && random.chance(0.3);
                let mut body = if is_single || has(Class::Pilots) && random.chance(0.4) {
                    bodies::single(spread, &mut random)
                } else if room < 4 {
                    continue;
                } else {
                    bodies::draw(room.min(unknowns / 2), held, spread, &mut random)
                };
                if has(Class::Penalty) && body.dofs() > 3 {
                    let first = unknowns - room;
                    penalties.extend(bodies::support(&mut body, &mut random).iter().map(|dof| first + dof));
                }
                room = room.saturating_sub(body.dofs());
                list.push(body);
                group.push(g);
            }
        }
        let deck = Deck::new("varied", list);
        let diagonal: Vec<f64> = deck.bodies.iter().flat_map(|body| body.stiffness.diagonal()).collect();
        let grounded = all_grounded(&deck);
        let (u, strength, idle) = (vec![0.0; diagonal.len()], vec![], vec![]);
        let (lambda, mu, slack) = (vec![], vec![], vec![]);
        Draft {
            random,
            classes,
            deck,
            group,
            length,
            diagonal,
            grounded,
            penalties,
            u,
            strength,
            idle,
            lambda,
            mu,
            slack,
        }
    }

    pub fn round_rows(&mut self) {
        if self.is(Class::Printed) {
            let digits = 8 + self.random.below(7);
            for rows in [&mut self.deck.contact, &mut self.deck.equalities] {
                rows.matrix.val.iter_mut().for_each(|v| *v = rounded_to(*v, digits));
            }
        }
        if self.is(Class::Rounded) {
            for rows in [&mut self.deck.contact, &mut self.deck.equalities] {
                let values = rows.matrix.val.iter_mut().chain(&mut rows.compliance);
                values.for_each(|v| *v = rounded(*v));
            }
        }
    }

    pub fn round_stiffness(&mut self) {
        if self.is(Class::Rounded) {
            for body in &mut self.deck.bodies {
                body.stiffness.val.iter_mut().for_each(|v| *v = rounded(*v));
            }
            self.diagonal.iter_mut().for_each(|v| *v = rounded(*v));
        }
    }

    /// A rough deformation of every body, lengths alike or forces alike, free of rigid motions; zero where supported.
    pub fn deform(&mut self) {
        let alike = self.random.chance(0.5);
        let largest = self.diagonal.iter().zip(&self.grounded).filter(|(_, &g)| !g).map(|(d, _)| *d);
        let largest = largest.fold(f64::MIN_POSITIVE, f64::max);
        for p in 0..self.deck.bodies.len() {
            let range = self.deck.offset(p)..self.deck.offset(p + 1);
            let length = self.length[self.group[p]];
            let body = &self.deck.bodies[p];
            let own = &self.diagonal[range.clone()];
            let soft = if alike { 0.0 } else { 1.0 };
            let groups = self.length.len() > 1;
            let mut u: Vec<f64> = own
                .iter()
                .map(|d| {
                    let factor = if groups { 1.0 } else { (largest / d).powf(soft).min(1e6) };
                    length * self.random.normal() * factor
                })
                .collect();
            remove(&orthonormal(body.modes(), own), own, &mut u);
            for (i, dof) in range.clone().enumerate() {
                if self.penalties.contains(&dof) {
                    u[i] = if self.random.chance(0.3) { 0.0 } else { length * self.random.normal() };
                }
            }
            let mut force = body.stiffness.times(&u);
            (0..force.len()).for_each(|i| force[i] *= f64::from(u8::from(!self.grounded[range.start + i])));
            let weights: Vec<f64> = own.iter().map(|d| 1.0 / d).collect();
            let size = inner(&force, &weights, &force).sqrt();
            let idle = self.is(Class::Idle) && self.random.chance(0.4);
            let share = if idle { self.random.decades(-22.0, -14.0) } else { 1.0 };
            u.iter_mut().for_each(|u| *u *= share);
            self.idle.push(idle);
            self.strength.push(share * if size > 0.0 { size } else { length * own[0].sqrt() });
            self.u[range].copy_from_slice(&u);
        }
    }

    /// u := u + R a: floating bodies move, each by its own motion or all of a case alike.
    pub fn travel(&mut self) {
        let share = if self.is(Class::Travel) { self.random.decades(0.0, 8.0) } else { 1.0 };
        for p in 0..self.deck.bodies.len() {
            let range = self.deck.offset(p)..self.deck.offset(p + 1);
            let own = &self.diagonal[range.clone()];
            let size = inner(&self.u[range.clone()], own, &self.u[range.clone()]).sqrt();
            let share = share * self.random.between(-1.0, 1.0);
            for mode in orthonormal(self.deck.bodies[p].modes(), own) {
                axpy(share * size * self.random.normal(), &mode, &mut self.u[range.clone()]);
            }
        }
    }

    /// A penalty load is P u0, P the penalised diagonal: u_i = u0 - (sum_{j != i} K_ij u_j) / K_ii; no row touches it.
    pub fn prescribe(&mut self) {
        let given: Vec<f64> = self.penalties.iter().map(|&dof| self.u[dof]).collect();
        for _ in 0..4 {
            for (&dof, &u0) in self.penalties.iter().zip(&given) {
                let p = (0..self.group.len()).find(|&p| dof < self.deck.offset(p + 1)).expect("a body");
                let (first, stiffness) = (self.deck.offset(p), &self.deck.bodies[p].stiffness);
                let others = stiffness.row(dof - first).filter(|entry| entry.0 + first != dof);
                let pull = dd::dot(others.map(|(j, k)| (k, self.u[first + j])));
                self.u[dof] = (Dd::from(u0) - pull / Dd::from(self.diagonal[dof])).value();
            }
        }
    }

    /// The final face: closed contact rows and equality rows.
    pub(super) fn face(&self) -> condition::Face<'_> {
        condition::Face::of(&self.deck, |i| self.slack[i] == 0.0)
    }

    pub fn finish(mut self, seed: u64) -> Varied {
        let rounding = self.is(Class::Rounded);
        let face = self.face();
        let (undetermined, condition) = (face.undetermined, face.condition());
        let pilots = if self.is(Class::Pilots) { self.soften() } else { Vec::new() };
        self.set_gaps();
        self.set_loads();
        if rounding {
            let deck = &mut self.deck;
            let loads = deck.bodies.iter_mut().flat_map(|body| &mut body.load);
            let gaps = deck.contact.rhs.iter_mut().chain(&mut deck.equalities.rhs);
            loads.chain(gaps).for_each(|value| *value = rounded(*value));
        }
        self.spoil_null_spaces();
        let mut case = Varied {
            deck: self.deck,
            classes: self.classes,
            displacement: self.u,
            forces: self.lambda,
            equality_forces: self.mu,
            undetermined,
            penalties: self.penalties,
            pilots,
            condition,
        };
        case.deck.name = format!("varied_{seed}_{}", case.kind());
        case
    }

    /// Bodies of one unknown that closed or equality rows join to larger ones become pilots.
    fn soften(&mut self) -> Vec<(usize, f64)> {
        let mut pilots = Vec::new();
        let singles: Vec<usize> =
            (0..self.deck.bodies.len()).filter(|&p| self.deck.bodies[p].dofs() == 1).collect();
        for p in singles {
            let dof = self.deck.offset(p);
            let given = self.given(dof);
            if given > 0.0 {
                pilots.push((dof, given));
                let kp = self.diagonal[dof] * self.random.decades(-20.0, 0.0);
                self.deck.bodies[p].stiffness.val[0] = kp;
            }
        }
        pilots
    }

    /// `sum_i b_ij^2 / (sum_l b_il^2 / D_l + C_i)`, l other than j: what closed and equality rows to larger bodies give a pilot.
    fn given(&self, dof: usize) -> f64 {
        let mut given = 0.0;
        for (rows, forces) in [(&self.deck.contact, Some(&self.lambda)), (&self.deck.equalities, None)] {
            let holds = |i: &usize| forces.is_none_or(|forces| forces[*i] > 0.0);
            for i in (0..rows.len()).filter(holds) {
                let yields = |(j, b): (usize, f64)| b * b / self.diagonal[j];
                let own: f64 = rows.matrix.row(i).filter(|(j, _)| *j == dof).map(|(_, b)| b * b).sum();
                let others = || rows.matrix.row(i).filter(|(j, _)| *j != dof);
                let elastic = others().all(|(j, _)| self.deck.bodies[body_of(&self.deck, j)].dofs() > 1);
                let others: f64 = others().map(yields).sum();
                given += if elastic && others > 0.0 { own / (others + rows.compliance[i]) } else { 0.0 };
            }
        }
        given
    }

    /// c_i = b_i u - C_i lambda_i + slack, h_i = h_i u - C_i mu_i.
    fn set_gaps(&mut self) {
        for i in 0..self.deck.contact.len() {
            let moved = moved(&self.deck.contact, i, &self.u, self.lambda[i]);
            let infinite = self.slack[i] == f64::INFINITY;
            let gap = if infinite { self.slack[i] } else { (moved + Dd::from(self.slack[i])).value() };
            self.deck.contact.rhs[i] = gap;
        }
        for i in 0..self.deck.equalities.len() {
            self.deck.equalities.rhs[i] = moved(&self.deck.equalities, i, &self.u, self.mu[i]).value();
        }
    }

    /// f = K (u - R a) + B'lambda + H'mu, R a what a floating body has travelled: K R is rounding only, and would be a load.
    fn set_loads(&mut self) {
        let mut sums = vec![Dd::ZERO; self.u.len()];
        for (rows, forces) in [(&self.deck.contact, &self.lambda), (&self.deck.equalities, &self.mu)] {
            for (i, &force) in forces.iter().enumerate() {
                for (j, value) in rows.matrix.row(i) {
                    sums[j] = sums[j] + Dd::product(value, force);
                }
            }
        }
        for p in 0..self.deck.bodies.len() {
            let range = self.deck.offset(p)..self.deck.offset(p + 1);
            let (own, mut u) = (&self.diagonal[range.clone()], self.u[range.clone()].to_vec());
            let body = &mut self.deck.bodies[p];
            remove(&orthonormal(body.modes(), own), own, &mut u);
            for i in 0..u.len() {
                let sum = sums[range.start + i] + dd::dot(body.stiffness.row(i).map(|(j, k)| (k, u[j])));
                body.load[i] = sum.value();
            }
        }
    }

    /// R := R M with M random, or R (1 + 1e-13 noise).
    fn spoil_null_spaces(&mut self) {
        let (mixed, noisy) = (self.is(Class::Mixed), self.is(Class::Noisy));
        for body in &mut self.deck.bodies {
            let Some(modes) = &mut body.null_space else { continue };
            if mixed {
                let old = modes.clone();
                for mode in modes.iter_mut() {
                    mode.iter_mut().for_each(|value| *value = 0.0);
                    old.iter().for_each(|other| axpy(self.random.normal(), other, mode));
                }
            }
            if noisy {
                let size = modes.iter().flatten().fold(0.0f64, |a, b| a.max(b.abs()));
                modes.iter_mut().flatten().for_each(|v| *v += 1e-13 * size * self.random.normal());
            }
        }
    }
}

/// b_i u - C_i force.
fn moved(rows: &Rows, i: usize, u: &[f64], force: f64) -> Dd {
    let terms = rows.matrix.row(i).map(|(j, value)| (value, u[j]));
    dd::dot(terms.chain([(-rows.compliance[i], force)]))
}
