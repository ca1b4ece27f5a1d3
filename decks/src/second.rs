//! A second solver for small problems, in double-double arithmetic and by other means than the library: a proximal method of
//! multipliers whose strictly convex steps are solved by principal pivoting.
//!
//! Step k: K := K + delta D, f := f + delta D u_k, C := C + epsilon, c := c - epsilon lambda_k (epsilon per row over
//! b D^-1 b'). Where u_k and lambda_k stand still they solve the problem itself, also with undetermined motions and
//! dependent rows.

use crate::dd::Dd;
use crate::yardstick::Answer;
use crate::{Body, Deck};

/// delta and epsilon: K + delta D stays regular in 32 digits, the step is nearly that of Newton.
const SHIFT: f64 = 1e-11;
/// A force below this part of the largest is zero, and so is a gap below this part of the motions along its row.
const ZERO: f64 = 1e-17;
/// A sum of these terms is known to this part of the largest.
const ROUNDING: f64 = 1e-28;
/// The error falls by delta times the condition in each step; undetermined motions and forces of rows that agree only to
/// rounding drift, and need no end.
const STEPS: usize = 8;
/// Changes of the closed rows in one step at most.
const PIVOTS: usize = 2000;

/// A symmetric positive definite matrix as L L', by rows.
struct Cholesky {
    n: usize,
    l: Vec<Dd>,
}

impl Cholesky {
    fn new(mut a: Vec<Dd>, n: usize) -> Option<Cholesky> {
        for j in 0..n {
            for i in j..n {
                let mut rest = a[i * n + j];
                (0..j).for_each(|k| rest = rest - a[i * n + k] * a[j * n + k]);
                if i == j && rest.value() <= 0.0 {
                    return None;
                }
                a[i * n + j] = if i == j { rest.sqrt() } else { rest / a[j * n + j] };
            }
        }
        Some(Cholesky { n, l: a })
    }

    /// L^-1 b
    fn forward(&self, b: &mut [Dd]) {
        for i in 0..self.n {
            let mut rest = b[i];
            (0..i).for_each(|k| rest = rest - self.l[i * self.n + k] * b[k]);
            b[i] = rest / self.l[i * self.n + i];
        }
    }

    /// L'^-1 b
    fn backward(&self, b: &mut [Dd]) {
        for i in (0..self.n).rev() {
            let mut rest = b[i];
            (i + 1..self.n).for_each(|k| rest = rest - self.l[k * self.n + i] * b[k]);
            b[i] = rest / self.l[i * self.n + i];
        }
    }
}

/// Rows of contact, then of equalities.
struct Second<'a> {
    deck: &'a Deck,
    diagonal: Vec<f64>,
    factors: Vec<Cholesky>,
    rows: Vec<Vec<(usize, f64)>>,
    /// epsilon of each row.
    shift: Vec<f64>,
    compliance: Vec<f64>,
    gaps: Vec<f64>,
    contact: usize,
    /// Y = L^-1 B', one column per row.
    columns: Vec<Vec<Dd>>,
    /// M = Y'Y + C + epsilon, the compliance that the rows feel.
    matrix: Vec<Dd>,
}

/// The answer; `None` where pivoting does not end, K is not semi-definite, or the last
/// step still takes a force that counts: bodies held by springs 1e11 times softer than they are. Rows with an infinite gap stay open.
pub fn solve(deck: &Deck) -> Option<Answer> {
    solve_with(deck, without_motions)
}

/// With K to its last digit: what it resists of a far rigid motion by rounding counts as any other stiffness.
pub fn solve_to_the_letter(deck: &Deck) -> Option<Answer> {
    solve_with(deck, entries)
}

fn solve_with(deck: &Deck, of_body: fn(&Body) -> Vec<Dd>) -> Option<Answer> {
    let mut second = Second::new(deck, of_body)?;
    second.set_matrix();
    let (n, m) = (deck.dofs(), second.rows.len());
    let (mut u, mut forces) = (vec![Dd::ZERO; n], vec![Dd::ZERO; m]);
    let mut closed: Vec<bool> = (0..m).map(|i| i >= second.contact).collect();
    for k in 1..=STEPS {
        let (next, pushes) = second.step(&u, &forces, &mut closed)?;
        if k == STEPS && !second.stands(&next, &u) {
            return None;
        }
        (u, forces) = (next, pushes);
    }
    let values = |v: &[Dd]| v.iter().map(|v| v.value()).collect();
    let (lambda, mu) = forces.split_at(second.contact);
    Some(Answer { u: values(&u), lambda: values(lambda), mu: values(mu) })
}

impl<'a> Second<'a> {
    fn new(deck: &'a Deck, of_body: fn(&Body) -> Vec<Dd>) -> Option<Second<'a>> {
        let diagonal: Vec<f64> = deck.bodies.iter().flat_map(|body| body.stiffness.diagonal()).collect();
        let mut factors = Vec::new();
        for body in &deck.bodies {
            let n = body.dofs();
            let mut dense = of_body(body);
            for i in 0..n {
                dense[i * n + i] = dense[i * n + i] + Dd::product(SHIFT, body.stiffness.get(i, i));
            }
            factors.push(Cholesky::new(dense, n)?);
        }
        let sets = [&deck.contact, &deck.equalities];
        let rows: Vec<Vec<_>> =
            sets.iter().flat_map(|rows| (0..rows.len()).map(|i| rows.matrix.row(i).collect())).collect();
        let local = |row: &Vec<(usize, f64)>| row.iter().map(|&(j, v)| v * v / diagonal[j]).sum::<f64>();
        Some(Second {
            deck,
            shift: rows.iter().map(|row| SHIFT * local(row)).collect(),
            factors,
            rows,
            compliance: sets.iter().flat_map(|rows| rows.compliance.clone()).collect(),
            gaps: sets.iter().flat_map(|rows| rows.rhs.clone()).collect(),
            contact: deck.contact.len(),
            columns: Vec::new(),
            matrix: Vec::new(),
            diagonal,
        })
    }

    fn set_matrix(&mut self) {
        let m = self.rows.len();
        for row in &self.rows {
            let mut column = vec![Dd::ZERO; self.deck.dofs()];
            row.iter().for_each(|&(j, v)| column[j] = Dd::from(v));
            self.of_bodies(&mut column, Cholesky::forward);
            self.columns.push(column);
        }
        self.matrix = vec![Dd::ZERO; m * m];
        for i in 0..m {
            for j in 0..m {
                self.matrix[i * m + j] = dot(&self.columns[i], &self.columns[j]);
            }
            let own = Dd::from(self.compliance[i]) + Dd::from(self.shift[i]);
            self.matrix[i * m + i] = self.matrix[i * m + i] + own;
        }
    }

    fn of_bodies(&self, v: &mut [Dd], work: fn(&Cholesky, &mut [Dd])) {
        for (p, factor) in self.factors.iter().enumerate() {
            work(factor, &mut v[self.deck.offset(p)..self.deck.offset(p + 1)]);
        }
    }

    /// One proximal step: u = K^-1 (f - B'lambda), M lambda - d = w, lambda and w of contact rows complementary,
    /// d = B K^-1 f - c.
    fn step(&self, u: &[Dd], forces: &[Dd], closed: &mut [bool]) -> Option<(Vec<Dd>, Vec<Dd>)> {
        let load = self.deck.load();
        let shifted = |j: usize| Dd::from(load[j]) + Dd::product(SHIFT, self.diagonal[j]) * u[j];
        let mut rest: Vec<Dd> = (0..load.len()).map(shifted).collect();
        self.of_bodies(&mut rest, Cholesky::forward);
        let d: Vec<Dd> = (0..self.rows.len())
            .map(|i| {
                let gap = Dd::from(if self.gaps[i].is_finite() { self.gaps[i] } else { 1e30 });
                dot(&self.columns[i], &rest) - gap + Dd::from(self.shift[i]) * forces[i]
            })
            .collect();
        let forces = self.pivot(&d, &rest, closed)?;
        Some((self.displacement(&rest, &forces), forces))
    }

    /// u for these forces; `loads`: L^-1 of those without them.
    fn displacement(&self, loads: &[Dd], forces: &[Dd]) -> Vec<Dd> {
        let mut u = loads.to_vec();
        for (column, &force) in self.columns.iter().zip(forces) {
            u.iter_mut().zip(column).for_each(|(u, y)| *u = *u - *y * force);
        }
        self.of_bodies(&mut u, Cholesky::backward);
        u
    }

    /// delta |u - v|_D <= 1e-10 |f|_{D^-1} on every body that has a load.
    fn stands(&self, u: &[Dd], v: &[Dd]) -> bool {
        let load = self.deck.load();
        (0..self.deck.bodies.len()).all(|p| {
            let range = self.deck.offset(p)..self.deck.offset(p + 1);
            let moved = range.clone().map(|j| (u[j] - v[j]).value().powi(2) * self.diagonal[j]).sum::<f64>();
            let loads = range.map(|j| load[j] * load[j] / self.diagonal[j]).sum::<f64>();
            loads == 0.0 || SHIFT * moved.sqrt() <= 1e-10 * loads.sqrt()
        })
    }

    /// Principal pivoting: all wrong rows change sides while their number falls, else the last wrong one (Murty).
    fn pivot(&self, d: &[Dd], loads: &[Dd], closed: &mut [bool]) -> Option<Vec<Dd>> {
        let (mut fewest, mut patience) = (usize::MAX, 8);
        for _ in 0..PIVOTS {
            let forces = self.forces(d, closed)?;
            let wrong = self.wrong(d, &self.displacement(loads, &forces), closed, &forces);
            if wrong.is_empty() {
                return Some(forces);
            }
            (fewest, patience) =
                if wrong.len() < fewest { (wrong.len(), 8) } else { (fewest, patience.max(1) - 1) };
            let from = if patience > 0 { 0 } else { wrong.len() - 1 };
            wrong[from..].iter().for_each(|&i| closed[i] = !closed[i]);
        }
        None
    }

    /// M_FF lambda_F = d_F on the closed rows.
    fn forces(&self, d: &[Dd], closed: &[bool]) -> Option<Vec<Dd>> {
        let m = closed.len();
        let face: Vec<usize> = (0..m).filter(|&i| closed[i]).collect();
        let dense = face.iter().flat_map(|&i| face.iter().map(move |&j| self.matrix[i * m + j])).collect();
        let factor = Cholesky::new(dense, face.len())?;
        let mut part: Vec<Dd> = face.iter().map(|&i| d[i]).collect();
        factor.forward(&mut part);
        factor.backward(&mut part);
        let mut forces = vec![Dd::ZERO; m];
        face.iter().zip(part).for_each(|(&i, force)| forces[i] = force);
        Some(forces)
    }

    /// Closed rows that pull, open rows that penetrate. The terms of a gap are those of u: along floating bodies those of forces are
    /// larger by 1 / delta.
    fn wrong(&self, d: &[Dd], u: &[Dd], closed: &[bool], forces: &[Dd]) -> Vec<usize> {
        let m = closed.len();
        let is_wrong = |&i: &usize| {
            let row = &self.matrix[i * m..(i + 1) * m];
            let terms = row.iter().zip(forces).map(|(a, b)| (*a * *b).value().abs());
            let size = terms.fold(d[i].value().abs(), f64::max);
            if closed[i] {
                (forces[i] * row[i]).value() < -ZERO * size
            } else {
                let along = self.rows[i].iter().map(|&(j, v)| (v * u[j].value()).abs());
                let own = along.fold(self.gaps[i].abs(), f64::max);
                (dot(row, forces) - d[i]).value() < -(ZERO * own).max(ROUNDING * size)
            }
        };
        (0..self.contact).filter(is_wrong).collect()
    }
}

/// K, n x n.
fn entries(body: &Body) -> Vec<Dd> {
    let n = body.dofs();
    let mut dense = vec![Dd::ZERO; n * n];
    for i in 0..n {
        body.stiffness.row(i).for_each(|(j, k)| dense[i * n + j] = Dd::from(k));
    }
    dense
}

/// P'K P, P = I - R R'D with R'DR = I: K as the host gives it resists rigid motions to rounding, which a body that travels
/// far would feel. R is that of the host without its noise, R - (K + delta D)^-1 K R, which such a body would feel as well.
fn without_motions(body: &Body) -> Vec<Dd> {
    let n = body.dofs();
    let mut dense = entries(body);
    let diagonal: Vec<Dd> = body.stiffness.diagonal().into_iter().map(Dd::from).collect();
    let weighted = |v: &[Dd]| -> Vec<Dd> { v.iter().zip(&diagonal).map(|(v, d)| *v * *d).collect() };
    let mut basis: Vec<(Vec<Dd>, Vec<Dd>)> = Vec::new();
    let mut shifted = dense.clone();
    (0..n).for_each(|i| shifted[i * n + i] = shifted[i * n + i] + Dd::from(SHIFT) * diagonal[i]);
    let factor = Cholesky::new(shifted, n);
    for mode in body.modes() {
        let mut r: Vec<Dd> = mode.iter().copied().map(Dd::from).collect();
        if let Some(factor) = &factor {
            let mut noise: Vec<Dd> = (0..n).map(|i| dot(&dense[i * n..(i + 1) * n], &r)).collect();
            factor.forward(&mut noise);
            factor.backward(&mut noise);
            r.iter_mut().zip(noise).for_each(|(r, noise)| *r = *r - noise);
        }
        for (earlier, pull) in &basis {
            let part = dot(pull, &r);
            r.iter_mut().zip(earlier).for_each(|(r, e)| *r = *r - part * *e);
        }
        let length = dot(&r, &weighted(&r)).sqrt();
        r.iter_mut().for_each(|r| *r = *r / length);
        let pull = weighted(&r);
        basis.push((r, pull));
    }
    for (r, pull) in &basis {
        let left: Vec<Dd> = (0..n).map(|i| dot(&dense[i * n..(i + 1) * n], r)).collect();
        let own = dot(&left, r);
        for i in 0..n {
            for j in 0..n {
                let taken = left[i] * pull[j] + pull[i] * left[j] - own * pull[i] * pull[j];
                dense[i * n + j] = dense[i * n + j] - taken;
            }
        }
    }
    dense
}

fn dot(a: &[Dd], b: &[Dd]) -> Dd {
    a.iter().zip(b).fold(Dd::ZERO, |sum, (a, b)| sum + *a * *b)
}

#[cfg(test)]
mod tests {
    use super::solve;
    use crate::small::{FacingSprings, GluedBar, Obstacle, SpringAndBlock};
    use crate::varied::{self, Class};
    use crate::yardstick::{reaction, Answer, Yardstick};

    #[test]
    fn problems_by_hand_are_solved() {
        let cases = [
            Obstacle { spring: 3.0, force: 4.0, gap: 0.5 }.build(),
            Obstacle { spring: 3.0, force: 1.0, gap: 0.5 }.build(),
            FacingSprings { springs: [2.0, 5.0], forces: [3.0, -1.0], gap: 0.1 }.build(),
            GluedBar { spring: 2.0, bar: 5.0, force: 3.0, gap: 0.1 }.build(),
            SpringAndBlock { spring: 2.0, force: 3.0, gap: 0.25, block: Some(6.0) }.build(),
        ];
        for case in cases {
            let found = solve(&case.deck).unwrap();
            let near = |a: &[f64], b: &[f64]| a.iter().zip(b).all(|(a, b)| (a - b).abs() < 1e-12);
            assert!(near(&found.u, &case.displacement), "{} {found:?}", case.deck.name);
            assert!(near(&found.lambda, &case.forces) && near(&found.mu, &case.equality_forces));
        }
    }

    /// Two ways to the same answer: drawn and solved.
    #[test]
    fn varied_cases_have_the_answer_they_were_made_of() {
        let mut solved = 0;
        for case in (0..400).map(varied::case) {
            if case.deck.dofs() > 90 || case.condition > 1e8 || case.classes.contains(&Class::Penalty) {
                continue;
            }
            let truth = Answer {
                u: case.displacement.clone(),
                lambda: case.forces.clone(),
                mu: case.equality_forces.clone(),
            };
            let found = solve(&case.deck).unwrap_or_else(|| panic!("{}", case.deck.name));
            let yardstick = Yardstick::new(&case.deck, &truth, case.undetermined > 0);
            let (worst, body) = yardstick.worst(&found);
            assert!(
                worst <= 1.0,
                "{}: {worst:e} at body {body}, condition {:e}",
                case.deck.name,
                case.condition
            );
            solved += 1;
        }
        assert!(solved > 50, "{solved}");
    }

    /// K u + B'lambda = f for the K of the host, up to 64 eps of the terms.
    #[test]
    fn a_body_that_travels_far_balances_whatever_noise_its_null_space_has() {
        let case = varied::mixed(132022655, &varied::SECOND_MIXTURE);
        assert!(case.classes.contains(&Class::Noisy) && case.classes.contains(&Class::Travel));
        let (deck, found) = (&case.deck, solve(&case.deck).unwrap());
        let (load, push) = (deck.load(), reaction(deck, &found));
        for (p, body) in deck.bodies.iter().enumerate() {
            let first = deck.offset(p);
            for i in 0..body.dofs() {
                let terms: Vec<f64> = body.stiffness.row(i).map(|(j, k)| k * found.u[first + j]).collect();
                let size = terms.iter().map(|term| term.abs()).sum::<f64>() + push[first + i].abs();
                let left = terms.iter().sum::<f64>() + push[first + i] - load[first + i];
                assert!(left.abs() <= 64.0 * f64::EPSILON * size, "{p} {i}: {left:e} of {size:e}");
            }
        }
    }
}
