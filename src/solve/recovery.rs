//! From a point of the dual problem of one island to the answer in the units of the host (17), the residuals of loads and
//! gaps, and the certificate.

use std::sync::OnceLock;

use crate::certificate::{certify, BodyData, Candidate, Data, Judgement, NOISE};
use crate::constraints::RowKind;
use crate::error::Result;
use crate::linalg::twofold::Twofold;
use crate::linalg::vector::axpy;
use crate::linalg::ByBody;
use crate::model::SolvedModel;
use crate::numbers::linalg::WEAK;
use crate::platform::interrupt;
use crate::platform::memory::zeros;
use crate::qp::{Direct, Qp, Solution};
use crate::setup::{Island, Ready};
use crate::solve::case::Case;
use crate::solve::scaled::Scaled;
use crate::solve::sparse_face::SparseFaces;

/// Displacements and multipliers in the units of the host.
#[derive(Clone)]
pub struct Recovered {
    pub u: ByBody,
    pub lambda: Vec<f64>,
    pub mu: Vec<f64>,
    /// Tangential forces.
    pub tangential: Vec<f64>,
}

impl Recovered {
    pub fn view(&self) -> Candidate<'_> {
        Candidate { u: &self.u, lambda: &self.lambda, mu: &self.mu, tangential: &self.tangential }
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
    pub deformed: ByBody,
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
        let (mut data, ready) = (case.data()?, case.ready);
        if let Some(load) = scaled.unheld.as_ref().and_then(|taken| taken.load.as_ref()) {
            data.bodies.iter_mut().zip(load.each()).for_each(|(body, load)| body.load = Some(load));
        }
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
    pub fn recover(&self, deformed: &ByBody, x: &[f64], alpha: &[f64]) -> Recovered {
        let mut u = self.ready.rigid_motion(&self.ready.dual.balanced(x, alpha));
        u.add(1.0, deformed);
        self.with_forces(u, &[x])
    }

    /// `K+ (f - B'x)`
    pub fn deformed(&self, x: &[f64]) -> Result<ByBody> {
        let mut load = self.scaled.load.copied("a displacement")?;
        self.ready.take_forces(x, &mut load);
        self.inverse(&load)
    }

    /// `K+ f`
    pub fn inverse(&self, load: &ByBody) -> Result<ByBody> {
        self.ready.displacement(self.threads, load)
    }

    /// The answer with displacements u and forces of x, the sum of `parts`: L'^-1 may leave a small difference of large x.
    pub fn with_forces(&self, u: ByBody, parts: &[&[f64]]) -> Recovered {
        let [mut lambda, mut mu, mut tangential] = self.forces_of_host(parts[0]);
        for x in &parts[1..] {
            let more = self.forces_of_host(x);
            [&mut lambda, &mut mu, &mut tangential]
                .into_iter()
                .zip(&more)
                .for_each(|(sum, part)| axpy(1.0, part, sum));
        }
        Recovered { u, lambda, mu, tangential }
    }

    /// `lambda = 2^p S L'^-1 x`, mu and lambda_t, on the rows that carry the multipliers of their groups.
    pub fn forces_of_host(&self, x: &[f64]) -> [Vec<f64>; 3] {
        let rows = &self.ready.rows;
        let mut lambda = rows.scaling.forces_to_host(x, &self.scaled.gaps.share);
        let mut mu = lambda.split_off(rows.contact);
        let tangential = mu.split_off(self.data.equalities.len());
        [lambda, mu, tangential]
    }

    /// `f - K u - B'lambda - H'mu - T'lambda_t` in units of 2^p; u is the sum of `motions`, x that of `forces`.
    pub fn load_left(&self, motions: &[&ByBody], forces: &[&[f64]]) -> Result<ByBody> {
        let (Island { unit, touched, .. }, data) = (&*self.ready.island, &self.data);
        let mut left = self.scaled.load.map(Twofold::from);
        for (p, body) in data.bodies.iter().enumerate() {
            for u in motions {
                body.stiffness.add_twofold(-1.0 / unit, u.on(p), left.on_mut(p))?;
            }
        }
        touched.change(&mut left, |left| {
            let forces = forces.iter().flat_map(|x| RowKind::ALL.into_iter().zip(self.forces_of_host(x)));
            for (kind, forces) in forces {
                let rows = data.rows(kind);
                for (i, force) in forces.iter().enumerate().filter(|(_, force)| **force != 0.0) {
                    rows.matrix.row(i).for_each(|(j, v)| left[j].add_product(-v, force / unit));
                }
            }
        });
        Ok(left.map(Twofold::value))
    }

    /// `c + C x - B u` of the rows of the dual, u being the sum of `motions`, x that of `forces`; 0 for springs of bodies,
    /// which are part of K.
    pub fn gaps_left(&self, motions: &[&ByBody], forces: &[&[f64]]) -> Vec<f64> {
        let (rows, order) = (&self.ready.rows, forces[0].len());
        let forces: Vec<_> = forces.iter().map(|x| self.forces_of_host(x)).collect();
        let motions: Vec<_> = motions.iter().map(|u| self.data.touched.at(u)).collect();
        let mut left = rows.scaling.lengths_to_dual(&self.scaled.gaps.holder, |holder| {
            let (kind, i) = self.ready.island.kind_and_place(holder);
            let set = self.data.rows(kind);
            let mut left = Twofold::from(set.rhs[i]);
            forces.iter().for_each(|x| left.add_product(set.compliance[i], x[kind as usize][i]));
            for u in &motions {
                set.matrix.row(i).for_each(|(j, v)| left.add_product(-v, u[j]));
            }
            left.value()
        });
        left.resize(order, 0.0);
        left
    }

    /// Per body: whether a motion is larger than v by a factor, and K resists it by rounding alone.
    pub fn travels(&self, motion: &ByBody, v: &ByBody, factor: f64) -> Result<Vec<bool>> {
        let travels = |(p, body): (usize, &BodyData)| {
            let (motion, v) = (motion.on(p), v.on(p));
            Ok(self.ready.length(p, motion) > factor * self.ready.length(p, v)
                && is_unresisted(body, motion)?)
        };
        self.data.bodies.iter().enumerate().map(travels).collect()
    }

    /// R'D u of body p.
    pub fn rigid_part(&self, p: usize, u: &[f64]) -> Vec<f64> {
        let (body, metric) = (&self.data.bodies[p], self.ready.metric.on(p));
        let by = self.ready.island.unit / body.unit;
        let weighted: Vec<f64> = u.iter().zip(metric).map(|(u, d)| by * d * u).collect();
        body.null_space.mul_transposed(&weighted)
    }

    /// Amplitudes over the modes of the dual of the rigid part of u.
    pub fn amplitudes(&self, u: &ByBody) -> Vec<f64> {
        let dual = &self.ready.dual;
        let mut all = vec![0.0; dual.modes()];
        for (p, u) in u.each().enumerate() {
            let own = self.rigid_part(p, u);
            all[dual.modes_of(p)].iter_mut().zip(own).for_each(|(a, own)| *a = own * dual.size_of(p));
        }
        all
    }

    /// The judgement of an answer.
    pub fn judged(&self, answer: &Recovered) -> Result<Judgement> {
        self.judged_on(&self.data, answer)
    }

    /// The judgement by data with other loads; only rounding of the loads may differ. If bodies are cut, the answer of the uncut
    /// bodies is judged.
    pub fn judged_on(&self, data: &Data, answer: &Recovered) -> Result<Judgement> {
        interrupt::part(CERTIFICATE, || match &self.ready.whole {
            Some(whole) => whole.judged(self.model, data, answer.view()),
            None => certify(data, answer.view()),
        })
    }

    /// The answer of a solution.
    pub fn ending(&self, solution: Solution) -> Result<Ending> {
        let deformed = self.deformed(&solution.x)?;
        let recovered = self.recover(&deformed, &solution.x, &solution.alpha);
        let judgement = self.judged(&recovered)?;
        Ok(Ending { solution, deformed, recovered, judgement })
    }
}

/// `|K w|_j <= 64 eps (|K||w|)_j`
fn is_unresisted(body: &BodyData, w: &[f64]) -> Result<bool> {
    let (mut image, mut terms) = (zeros(w.len(), "a motion")?, zeros(w.len(), "a motion")?);
    body.stiffness.mul_with_terms(w, &mut image, &mut terms)?;
    Ok(image.iter().zip(&terms).all(|(image, terms)| image.abs() <= NOISE * terms))
}

#[cfg(test)]
mod tests {
    use crate::linalg::ByBody;
    use crate::solve::certifier::tests::two_springs;

    /// Springs 1 and 1 pushed by 3 and 1 against walls at 1 and 2.
    #[test]
    fn what_is_left_keeps_its_digits_where_large_numbers_cancel() {
        two_springs(0.0, |judge, _| {
            let of = |u: [f64; 2]| ByBody::of(&judge.recovery.ready.island.ranges, u.to_vec());
            let left = judge.recovery.load_left(&[&of([1e16, 0.0])], &[&[-1e16, 0.0]]).unwrap();
            assert_eq!(left, of([3.0, 1.0]));
            let motions = [of([1e16, 1.0]), of([-1e16, 0.0])];
            assert_eq!(judge.recovery.gaps_left(&motions.each_ref(), &[&[0.0; 2]]), [1.0, 1.0]);
        });
    }
}
