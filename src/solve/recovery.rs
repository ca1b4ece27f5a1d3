//! From a point of the dual problem of one island to the answer in the units of the host (17), the residuals of loads and
//! gaps, and the certificate.

use std::sync::{Arc, OnceLock};

use crate::body::{Distributed, Kept};
use crate::certificate::{certify, Candidate, Data, Judgement};
use crate::constraints::RowKind;
use crate::error::Result;
use crate::linalg::twofold::Twofold;
use crate::linalg::vector::axpy;
use crate::model::SolvedModel;
use crate::numbers::linalg::WEAK;
use crate::platform::interrupt;
use crate::qp::{Direct, Qp, Solution};
use crate::setup::Ready;
use crate::solve::case::Case;
use crate::solve::local::{Displace, Point, Strained, Turn};
use crate::solve::scaled::Scaled;
use crate::solve::sparse_face::SparseFaces;

/// Displacements and multipliers in the units of the host.
#[derive(Clone)]
pub struct Recovered {
    pub u: Arc<Distributed>,
    pub lambda: Vec<f64>,
    pub mu: Vec<f64>,
    /// Tangential forces.
    pub tangential: Vec<f64>,
}

impl Recovered {
    pub fn view(&self) -> Candidate<'_> {
        let Self { u, lambda, mu, tangential } = self;
        Candidate { u: &u.of, at_rows: &u.at_rows, lambda, mu, tangential }
    }
}

/// What solutions on faces of the dual need.
pub struct Faces<'a> {
    pub qp: Qp<'a>,
    pub direct: Direct<'a>,
    /// Sparse factors, once asked for; none if the island has none.
    sparse: OnceLock<Option<SparseFaces<'a>>>,
}

impl<'a> Faces<'a> {
    pub fn new(qp: Qp<'a>, direct: Direct<'a>) -> Self {
        Self { qp, direct, sparse: OnceLock::new() }
    }

    /// Multiplications of a sparse factorisation, once known; infinite if there is none.
    pub fn sparse_work(&self) -> Option<f64> {
        Some(self.sparse.get()?.as_ref().map_or(f64::INFINITY, SparseFaces::work))
    }
}

/// The end of a solve.
pub struct Ending {
    pub solution: Solution,
    /// u without its motion by R, length.
    pub deformed: Arc<Distributed>,
    pub recovered: Recovered,
    pub judgement: Judgement,
}

/// Recovers and judges the answers of one island.
pub struct Recovery<'a> {
    model: &'a SolvedModel,
    pub ready: &'a Ready,
    pub scaled: &'a Scaled,
    pub data: Data<'a>,
    pub threads: usize,
    pub faces: Faces<'a>,
    /// K+ of some body amplifies rounding by more than 1 / `WEAK`.
    pub soft: bool,
    /// Some node has friction: slips distinguish one answer from another.
    pub friction: bool,
}

/// Name of the certificate in the log.
const CERTIFICATE: &str = "certificate";

impl<'a> Recovery<'a> {
    pub fn new(case: Case<'a>, scaled: &'a Scaled, faces: Faces<'a>) -> Result<Self> {
        let ready = case.ready;
        let taken = scaled.unheld.as_ref().and_then(|taken| taken.loads.as_ref());
        let data = case.data(taken.unwrap_or(&scaled.loads).clone())?;
        let is_soft = |p: &usize| {
            let inverse = case.prepared.inverse(case.model, *p);
            inverse.is_some_and(|inverse| inverse.kplus.softness < WEAK)
        };
        let soft = ready.island.bodies.iter().any(is_soft);
        Ok(Self {
            model: case.model,
            ready,
            scaled,
            data,
            threads: case.threads(),
            faces,
            soft,
            friction: case.has_friction(),
        })
    }

    /// The sparse factors of faces; none if the island has none.
    pub fn sparse_faces(&self) -> Result<Option<&SparseFaces<'a>>> {
        if self.faces.sparse.get().is_none() {
            let made = SparseFaces::of(self.ready, &self.data)?;
            return Ok(self.faces.sparse.get_or_init(|| made).as_ref());
        }
        Ok(self.faces.sparse.get().and_then(Option::as_ref))
    }

    /// (17) and lambda = 2^p S L'^-1 x on the rows that carry the multipliers of their groups. `deformed`: u without its
    /// rigid motion.
    pub fn recover(&self, deformed: &Distributed, x: &[f64], alpha: &[f64]) -> Result<Recovered> {
        let a = self.ready.dual.balanced(x, alpha);
        let turn = |p: usize| Turn { a: self.of_modes(p, &a) };
        let u = Distributed::new(self.data.bodies.make(turn, &deformed.of)?);
        Ok(self.with_forces(u, &[x]))
    }

    /// `K+ (f - B'x)`
    pub fn deformed(&self, x: &[f64]) -> Result<Distributed> {
        let Distributed { of, at_rows } = &self.scaled.load;
        let left = self.ready.without_forces(x, at_rows.clone());
        let displace = |p: usize| Displace { at_rows: self.of_rows(p, &left) };
        Ok(Distributed::new(self.data.bodies.make(displace, of)?))
    }

    /// Of amplitudes over the modes of the dual those of body p.
    pub fn of_modes(&self, p: usize, a: &[f64]) -> Vec<f64> {
        a[self.ready.dual.modes_of(p)].to_vec()
    }

    /// Of values where rows touch those of body p.
    pub fn of_rows(&self, p: usize, at_rows: &[f64]) -> Vec<f64> {
        at_rows[self.data.touched.range(p)].to_vec()
    }

    /// The answer with displacements u and forces of x, the sum of `parts`: L'^-1 may leave a small difference of large x.
    pub fn with_forces(&self, u: Distributed, parts: &[&[f64]]) -> Recovered {
        let [mut lambda, mut mu, mut tangential] = self.forces_of_host(parts[0]);
        for x in &parts[1..] {
            let more = self.forces_of_host(x);
            [&mut lambda, &mut mu, &mut tangential]
                .into_iter()
                .zip(&more)
                .for_each(|(sum, part)| axpy(1.0, part, sum));
        }
        Recovered { u: Arc::new(u), lambda, mu, tangential }
    }

    /// `lambda = 2^p S L'^-1 x`, mu and lambda_t, on the rows that carry the multipliers of their groups.
    pub fn forces_of_host(&self, x: &[f64]) -> [Vec<f64>; 3] {
        let rows = &self.ready.rows;
        let mut lambda = rows.scaling.forces_to_host(x, &self.scaled.gaps.share);
        let mut mu = lambda.split_off(rows.contact);
        let tangential = mu.split_off(self.data.equalities.len());
        [lambda, mu, tangential]
    }

    /// `f - K v - B'lambda - H'mu - T'lambda_t` in units of 2^p; x is the sum of `forces`. What the dual takes from it is asked with its
    /// values where rows touch.
    pub fn load_left(&self, point: &Kept<Point>, forces: &[&[f64]]) -> Result<Distributed> {
        let (unit, data) = (self.ready.island.unit, &self.data);
        let (left, of) = data.bodies.make(|_| Strained, (&self.scaled.load.of, point))?;
        let mut left = left.concat();
        let forces = forces.iter().flat_map(|x| RowKind::ALL.into_iter().zip(self.forces_of_host(x)));
        for (kind, forces) in forces {
            let rows = data.rows(kind);
            for (i, force) in forces.iter().enumerate().filter(|(_, force)| **force != 0.0) {
                rows.matrix.row(i).for_each(|(j, v)| left[j].add_product(-v, force / unit));
            }
        }
        Ok(Distributed { of, at_rows: left.into_iter().map(Twofold::value).collect() })
    }

    /// `c + C x - B u` of the rows of the dual, u being the sum of `motions`, where rows touch, x that of `forces`; 0 for springs of
    /// bodies, which are part of K.
    pub fn gaps_left(&self, motions: &[&[f64]], forces: &[&[f64]]) -> Vec<f64> {
        let (rows, order) = (&self.ready.rows, forces[0].len());
        let forces: Vec<_> = forces.iter().map(|x| self.forces_of_host(x)).collect();
        let mut left = rows.scaling.lengths_to_dual(&self.scaled.gaps.holder, |holder| {
            let (kind, i) = self.ready.island.kind_and_place(holder);
            let set = self.data.rows(kind);
            let mut left = Twofold::from(set.rhs[i]);
            forces.iter().for_each(|x| left.add_product(set.compliance[i], x[kind as usize][i]));
            for u in motions {
                set.matrix.row(i).for_each(|(j, v)| left.add_product(-v, u[j]));
            }
            left.value()
        });
        left.resize(order, 0.0);
        left
    }

    /// The judgement of an answer.
    pub fn judged(&self, answer: &Recovered) -> Result<Judgement> {
        self.judged_on(&self.data, answer)
    }

    /// The judgement by data with other loads; only rounding of the loads may differ. If bodies are cut, the answer of the uncut
    /// bodies is judged.
    pub fn judged_on(&self, data: &Data, answer: &Recovered) -> Result<Judgement> {
        interrupt::part(CERTIFICATE, || match self.ready.whole() {
            Some(whole) => whole.judged(self.model, data, answer.view()),
            None => certify(data, answer.view()),
        })
    }

    /// The answer of a solution.
    pub fn ending(&self, solution: Solution) -> Result<Ending> {
        let deformed = self.deformed(&solution.x)?;
        let recovered = self.recover(&deformed, &solution.x, &solution.alpha)?;
        let judgement = self.judged(&recovered)?;
        Ok(Ending { solution, deformed: Arc::new(deformed), recovered, judgement })
    }
}

#[cfg(test)]
mod tests {
    use crate::body::Kept;
    use crate::solve::certifier::tests::two_springs;
    use crate::solve::local::Begin;

    /// Springs 1 and 1 pushed by 3 and 1 against walls at 1 and 2.
    #[test]
    fn what_is_left_keeps_its_digits_where_large_numbers_cancel() {
        two_springs(0.0, |judge, _| {
            let recovery = &judge.recovery;
            let point = |u: [f64; 2]| {
                recovery
                    .data
                    .bodies
                    .make(|_| Begin { at_rest: false }, &Kept::of(vec![u.to_vec()]))
                    .unwrap()
                    .1
            };
            let left = recovery.load_left(&point([1e16, 0.0]), &[&[-1e16, 0.0]]).unwrap();
            assert_eq!(left.at_rows, [3.0, 1.0]);
            assert_eq!(recovery.gaps_left(&[&[1e16, 1.0], &[-1e16, 0.0]], &[&[0.0; 2]]), [1.0, 1.0]);
        });
    }
}
