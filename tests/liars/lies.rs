//! Wrong answers made from a right one, each as small as a user would still mind: 1e-5 of what a body has.

use decks::dense::{singular, solve};
use decks::random::Random;
use decks::varied::{orthonormal, Varied};
use decks::yardstick::{Answer, Yardstick};
use decks::{Deck, Rows};

/// Size of a lie.
const PART: f64 = 1e-5;
/// A rigid motion v is resisted where one row feels s_i |b_i v| above this part of |v|_D.
const RESISTED: f64 = 0.1;

pub struct Lie {
    pub name: &'static str,
    pub body: usize,
    pub answer: Answer,
}

/// Makes the lies about one case.
struct Liar<'a> {
    deck: &'a Deck,
    case: &'a Varied,
    yardstick: &'a Yardstick<'a>,
    random: Random,
    lies: Vec<Lie>,
}

pub fn all(seed: u64, case: &Varied, yardstick: &Yardstick) -> Vec<Lie> {
    let random = Random::new(!seed);
    let mut liar = Liar { deck: &case.deck, case, yardstick, random, lies: Vec::new() };
    for p in 0..case.deck.bodies.len() {
        liar.scales_forces(p);
        liar.moves(p);
        liar.moves_rigidly(p);
        liar.spoils_single_forces(p);
    }
    liar.moves_supports();
    liar.forgets_all_forces();
    liar.lies
}

impl Liar<'_> {
    fn truth(&self) -> Answer {
        let case = self.case;
        Answer { u: case.displacement.clone(), lambda: case.forces.clone(), mu: case.equality_forces.clone() }
    }

    fn tell(&mut self, name: &'static str, body: usize, answer: Answer) {
        self.lies.push(Lie { name, body, answer });
    }

    fn range(&self, p: usize) -> std::ops::Range<usize> {
        self.deck.offset(p)..self.deck.offset(p + 1)
    }

    fn touches(&self, rows: &Rows, i: usize, p: usize) -> bool {
        let range = self.range(p);
        rows.matrix.row(i).any(|(j, _)| range.contains(&j))
    }

    /// Lie 1: the forces of all rows at body p times 1 + 1e-5.
    fn scales_forces(&mut self, p: usize) {
        let mut answer = self.truth();
        for i in 0..answer.lambda.len() {
            answer.lambda[i] *= 1.0 + PART * f64::from(u8::from(self.touches(&self.deck.contact, i, p)));
        }
        for i in 0..answer.mu.len() {
            answer.mu[i] *= 1.0 + PART * f64::from(u8::from(self.touches(&self.deck.equalities, i, p)));
        }
        if answer.lambda != self.case.forces || answer.mu != self.case.equality_forces {
            self.tell("1 forces of a body scaled", p, answer);
        }
    }

    /// Lie 2: u_p + v, |v|_D = 1e-5 of the deformation, at random and in the stiffest unknown.
    fn moves(&mut self, p: usize) {
        let size = PART * self.yardstick.sizes[p].deformation;
        let free: Vec<usize> = self.range(p).filter(|&i| !self.yardstick.grounded[i]).collect();
        let diagonal = self.yardstick.metric();
        let Some(&stiffest) = free.iter().max_by(|&&i, &&j| diagonal[i].total_cmp(&diagonal[j])) else {
            return;
        };
        let steps: Vec<f64> = free.iter().map(|_| self.random.normal()).collect();
        let length = steps.iter().map(|step| step * step).sum::<f64>().sqrt();
        let mut answer = self.truth();
        free.iter()
            .zip(&steps)
            .for_each(|(&i, step)| answer.u[i] += size * step / length / diagonal[i].sqrt());
        self.tell("2 a body moved at random", p, answer);
        let mut answer = self.truth();
        answer.u[stiffest] += size / diagonal[stiffest].sqrt();
        self.tell("2 the stiffest unknown moved", p, answer);
    }

    /// Lie 2 on a penalty support: u0 (1 + 1e-5).
    fn moves_supports(&mut self) {
        for &dof in &self.case.penalties {
            let body = (0..self.deck.bodies.len()).find(|&p| dof < self.deck.offset(p + 1)).unwrap();
            let mut answer = self.truth();
            answer.u[dof] *= 1.0 + PART;
            if answer.u[dof].abs() > 1e-3 * self.largest(body) {
                self.tell("2 a penalty support moved", body, answer);
            }
        }
    }

    /// max |u| of a body.
    fn largest(&self, p: usize) -> f64 {
        self.case.displacement[self.range(p)].iter().fold(0.0, |largest, u| largest.max(u.abs()))
    }

    /// Lies 3 and 4: one force left out, or with the wrong sign, where it is at least 1e-5 of its body's forces.
    fn spoils_single_forces(&mut self, p: usize) {
        let least = PART * self.yardstick.sizes[p].forces;
        let rows = &self.deck.contact;
        let force = |i: usize| {
            let mut own = vec![0.0; self.deck.dofs()];
            rows.matrix.row(i).for_each(|(j, v)| own[j] = v * self.case.forces[i]);
            self.yardstick.norm(p, &own, -1)
        };
        let felt: Vec<usize> = (0..rows.len()).filter(|&i| force(i) > least).collect();
        for i in felt {
            let mut answer = self.truth();
            answer.lambda[i] = 0.0;
            self.tell("3 a force left out", p, answer);
            let mut answer = self.truth();
            answer.lambda[i] = -answer.lambda[i];
            self.tell("4 a force with the wrong sign", p, answer);
        }
        for i in 0..self.case.equality_forces.len() {
            if self.touches(&self.deck.equalities, i, p) && self.case.equality_forces[i] != 0.0 {
                let mut answer = self.truth();
                answer.mu[i] = 0.0;
                self.tell("3 a glue force left out", p, answer);
            }
        }
    }

    /// Lie 5: u_p + R a of 1e-5 of the deformation, a the motion that closed and equality rows resist most, and a random one.
    fn moves_rigidly(&mut self, p: usize) {
        let (range, diagonal) = (self.range(p), self.yardstick.metric());
        let modes = orthonormal(self.deck.bodies[p].modes(), &diagonal[range.clone()]);
        let rows = [(&self.deck.contact, Some(&self.case.forces)), (&self.deck.equalities, None)];
        let felt = |mode: &Vec<f64>| -> Vec<f64> {
            let mut felt = Vec::new();
            for (rows, forces) in rows {
                for i in (0..rows.len()).filter(|&i| forces.is_none_or(|forces| forces[i] > 0.0)) {
                    let square: f64 = rows.matrix.row(i).map(|(j, v)| v * v / diagonal[j]).sum();
                    let own = rows.matrix.row(i).filter(|(j, _)| range.contains(j));
                    let moved: f64 = own.map(|(j, v)| v * mode[j - range.start]).sum();
                    felt.push(moved / (square + rows.compliance[i]).sqrt());
                }
            }
            felt
        };
        let resisted = singular(modes.iter().map(felt).collect());
        let Some(most) = resisted.right.first() else { return };
        let random: Vec<f64> = modes.iter().map(|_| self.random.normal()).collect();
        let size = PART * self.yardstick.sizes[p].deformation;
        for (name, a) in [("5 moved as rows resist most", most), ("5 moved rigidly at random", &random)] {
            let length = a.iter().map(|a| a * a).sum::<f64>().sqrt();
            let mut motion = vec![0.0; range.len()];
            for (a, mode) in a.iter().zip(&modes) {
                motion.iter_mut().zip(mode).for_each(|(v, r)| *v += a * r / length);
            }
            if felt(&motion).iter().fold(0.0f64, |most, v| most.max(v.abs())) > RESISTED {
                let mut answer = self.truth();
                range.clone().zip(&motion).for_each(|(i, v)| answer.u[i] += size * v);
                self.tell(name, p, answer);
            }
        }
    }

    /// Lie 6: no forces at all, held bodies as their loads alone would move them.
    fn forgets_all_forces(&mut self) {
        let mut answer = self.truth();
        answer.lambda.iter_mut().for_each(|force| *force = 0.0);
        answer.mu.iter_mut().for_each(|force| *force = 0.0);
        let mut forgotten = None;
        for (p, body) in self.deck.bodies.iter().enumerate() {
            if !body.modes().is_empty() {
                continue;
            }
            let n = body.dofs();
            let mut dense = vec![0.0; n * n];
            (0..n).for_each(|i| body.stiffness.row(i).for_each(|(j, k)| dense[i * n + j] = k));
            if let Some(u) = solve(dense, body.load.clone()) {
                answer.u[self.range(p)].copy_from_slice(&u);
                forgotten = Some(p);
            }
        }
        if let Some(p) = forgotten {
            self.tell("6 all forces forgotten", p, answer);
        }
    }
}
