//! Motions that K drives, S = S+ - S-: geometric stiffness of pressed bodies, rounding of K. The dual of K itself is not concave.
//! That of K + S- is, with `e + S- a` for e, and its answer has the amplitudes a of the next round. On one face F the way from a to the
//! next is affine,
//!
//! ```text
//! b -> P b + p,   b = S-^1/2 a,   P = S-^1/2 (S+ + G_F F_FF^-1 G_F')^-1 S-^1/2
//! ```
//!
//! over the driven motions alone, so that one step of Newton ends it: `b + (I - P)^-1 (P b + p - b)`. The largest eigenvalue rho of P
//! is below 1 exactly where the answer is a minimum among those with the rows F closed. Where the face is too large for dense
//! factors the rounds go on by themselves, and rho is their rate.

use crate::error::{Error, Kind, Proof, Result};
use crate::linalg::dense::spectrum::symmetric_eigen;
use crate::linalg::vector::{norm, norm_max};
use crate::linalg::Matrix;
use crate::model::Settings;
use crate::progress::Steps;
use crate::qp::{AnswerFace, Counts, Face, Qp, Solution, Verdict};
use crate::solve::case::Case;
use crate::solve::certifier::Certifier;
use crate::solve::fallback::MethodOptions;
use crate::solve::near::{or_last, solve_near};

/// Rounds at most.
const ROUNDS: usize = 60;
/// `tolerance` of the first round, which has to find the rows: another one follows.
const ROUGH: f64 = 1e-5;
/// Rounds after which an answer that passes is the last, though its amplitudes still change.
const STRICT: usize = 3;
/// The same without a step of Newton.
const STRICT_ALONE: usize = 20;
/// A part of a free motion that is more than rounding.
const PART: f64 = 1e-6;
/// Rounds that come no nearer to each other have no end.
const PATIENCE: usize = 4;

/// The driven motions of an island: modes, and the roots of what drives them.
struct Driven {
    modes: Vec<usize>,
    roots: Vec<f64>,
}

/// What the driven motions of one face do to each other.
struct Feedback<'a> {
    face: Face<'a>,
    /// Eigenvalues of P, ascending, and its eigenvectors.
    rates: Vec<f64>,
    vectors: Matrix,
    /// `(S+ + G_F F_FF^-1 G_F')^-1 S-^1/2`, r x d.
    motions: Matrix,
}

/// Solves the dual of (10)-(11) with the motions that K drives, if there are any.
pub fn solve_driven(
    case: Case,
    means: &MethodOptions,
    qp: Qp,
    start: &[f64],
    judge: &mut Certifier,
    steps: &mut Steps,
) -> Result<Solution> {
    let driven = Driven::of(case);
    if driven.modes.is_empty() {
        return solve_near(means, qp, start, judge, steps);
    }
    let rough = Settings { tolerance: means.settings.tolerance.max(ROUGH), ..means.settings.clone() };
    let (mut b, mut start, mut counts) = (vec![0.0; driven.modes.len()], start.to_vec(), Counts::default());
    let (mut last, mut before, mut suspect, mut changes) = (None, None, None, Vec::<f64>::new());
    let mut dense = means.direct.limit > 0;
    loop {
        let is_rough = changes.is_empty() && dense;
        let means = MethodOptions { settings: if is_rough { &rough } else { means.settings }, ..*means };
        let e = driven.resultants(qp.e, &b);
        judge.drive = driven.amplitudes(&b);
        let strict = if dense { STRICT } else { STRICT_ALONE };
        (judge.is_rough, judge.is_strict) = (is_rough, changes.len() < strict);
        let found = solve_near(&means, Qp { e: &e, ..qp }, &start, judge, steps);
        let solution = or_last(found, before.take())?;
        counts = counts + solution.counts;
        let solution = Solution { counts, ..solution };
        if let Verdict::StepLimit | Verdict::TimeLimit | Verdict::Cancelled = solution.verdict {
            return Ok(solution);
        }
        let held = qp.at_bound(&solution.x);
        let known = Feedback::of(&means, qp, &held, &driven).and_then(|feedback| {
            let falling = driven.unstable(qp, &held, feedback.as_ref())?;
            Ok((feedback, falling))
        });
        let (feedback, falling) = match known {
            Ok(known) => known,
            Err(error) => return Ok(Solution { verdict: Verdict::of_refusal(error)?, ..solution }),
        };
        dense = feedback.is_some();
        match &solution.verdict {
            Verdict::Solved if !judge.astray || last.as_ref() == Some(&held) => {
                if let Some((v, rate)) = falling {
                    return Err(indefinite(case, &v, rate));
                }
            }
            Verdict::Solved => suspect = falling,
            // what drives the motions further than rows hold them, unless the load alone does
            _ => match falling.or(suspect).filter(|_| !changes.is_empty()) {
                Some((v, rate)) => return Err(indefinite(case, &v, rate)),
                None => return Ok(solution),
            },
        }
        let next = driven.forced(&solution.alpha);
        let change: Vec<f64> = next.iter().zip(&b).map(|(next, b)| next - b).collect();
        changes.push(norm(&change));
        if !judge.astray {
            return Ok(solution);
        }
        if changes.len() == ROUNDS {
            return Ok(Solution { verdict: Verdict::Stalled, ..solution });
        }
        if let Some(rate) = endless(&changes).filter(|_| last.as_ref() == Some(&held)) {
            return Err(indefinite(case, &solution.alpha, rate));
        }
        match feedback.filter(|feedback| feedback.rate() < 1.0) {
            Some(feedback) => {
                b = feedback.settled(&b, &change);
                start = feedback.point(qp, &driven.resultants(qp.e, &b))?;
            }
            None => (b, start) = (next, solution.x.clone()),
        }
        (last, before) = (Some(held), Some(solution));
    }
}

/// The rate of rounds that come no nearer to each other. On one face that proves that the energy falls: the displacements of two
/// rounds differ by a motion v that keeps its rows closed, `v'K v = d_k+1'd_k - |d_k+1|^2`, d the changes of b.
fn endless(changes: &[f64]) -> Option<f64> {
    let of = |pair: &[f64]| pair[1] / pair[0];
    let least = changes.windows(2).rev().take(PATIENCE).map(of).fold(f64::INFINITY, f64::min);
    (changes.len() > PATIENCE && least >= 1.0).then_some(least)
}

impl Driven {
    fn of(case: Case) -> Self {
        let driven = &case.ready.dual.driven;
        let modes = driven.iter().map(|(mode, _)| *mode).collect();
        Self { modes, roots: driven.iter().map(|(_, stiffness)| (-stiffness).sqrt()).collect() }
    }

    /// `S-^1/2 a`
    fn forced(&self, alpha: &[f64]) -> Vec<f64> {
        self.modes.iter().zip(&self.roots).map(|(&mode, root)| root * alpha[mode]).collect()
    }

    /// `S-^-1/2 b`
    fn amplitudes(&self, b: &[f64]) -> Vec<f64> {
        b.iter().zip(&self.roots).map(|(b, root)| b / root).collect()
    }

    /// `e + S-^1/2 b`
    fn resultants(&self, e: &[f64], b: &[f64]) -> Vec<f64> {
        let mut all = e.to_vec();
        self.modes.iter().zip(self.roots.iter().zip(b)).for_each(|(&mode, (root, b))| all[mode] += root * b);
        all
    }

    /// A motion along which the energy falls while the rows of a face stay closed, with its rate.
    fn unstable(
        &self,
        qp: Qp,
        held: &[bool],
        feedback: Option<&Feedback>,
    ) -> Result<Option<(Vec<f64>, f64)>> {
        let free = AnswerFace::new(qp.g_transposed, qp.blocks, held, qp.rounding)?.undetermined()?;
        for j in 0..free.cols {
            let v = free.col(j);
            if self.modes.iter().any(|&mode| v[mode].abs() > PART * norm_max(v)) {
                return Ok(Some((v.to_vec(), f64::INFINITY)));
            }
        }
        Ok(feedback
            .filter(|feedback| feedback.rate() >= 1.0)
            .map(|feedback| (feedback.motion(), feedback.rate())))
    }
}

impl<'a> Feedback<'a> {
    /// None where the face is too large for dense factors.
    fn of(means: &MethodOptions<'a>, qp: Qp<'a>, held: &[bool], driven: &Driven) -> Result<Option<Self>> {
        let rows: Vec<usize> = (0..held.len()).filter(|&i| !held[i]).collect();
        if rows.len() + qp.e.len() > means.direct.limit {
            return Ok(None);
        }
        let n = rows.len();
        let Some(face) = Face::new(qp, means.direct.entries, rows)? else { return Ok(None) };
        let d = driven.modes.len();
        let mut motions = Matrix::zeros(qp.e.len(), d)?;
        for (j, (&mode, root)) in driven.modes.iter().zip(&driven.roots).enumerate() {
            let mut e = vec![0.0; qp.e.len()];
            e[mode] = *root;
            motions.col_mut(j).copy_from_slice(&face.solve(vec![0.0; n], &e)?.1);
        }
        let p = |i: usize, j: usize| driven.roots[i] * motions.get(driven.modes[i], j);
        let (rates, vectors) = symmetric_eigen(&Matrix::from_fn(d, d, |i, j| 0.5 * (p(i, j) + p(j, i)))?)?;
        Ok(Some(Self { face, rates, vectors, motions }))
    }

    /// rho
    fn rate(&self) -> f64 {
        self.rates.last().copied().unwrap_or(0.0)
    }

    /// The motion of rho.
    fn motion(&self) -> Vec<f64> {
        let mut v = vec![0.0; self.motions.rows];
        self.motions.mul_add(1.0, self.vectors.col(self.vectors.cols - 1), &mut v);
        v
    }

    /// `b + (I - P)^-1 (P b + p - b)`
    fn settled(&self, b: &[f64], change: &[f64]) -> Vec<f64> {
        let parts = self.vectors.mul_transposed(change);
        let parts: Vec<f64> = parts.iter().zip(&self.rates).map(|(part, rate)| part / (1.0 - rate)).collect();
        let mut settled = b.to_vec();
        self.vectors.mul_add(1.0, &parts, &mut settled);
        settled
    }

    /// x of the face for these resultants.
    fn point(&self, qp: Qp, e: &[f64]) -> Result<Vec<f64>> {
        let force = self.face.rows().iter().map(|&i| qp.b[i]).collect();
        let mut x = vec![0.0; qp.b.len()];
        self.face.rows().iter().zip(self.face.solve(force, e)?.0).for_each(|(&i, v)| {
            x[i] = if qp.bounded[i] { v.max(0.0) } else { v };
        });
        Ok(x)
    }
}

/// The error that names the motion R alpha, and the body that it moves most.
fn indefinite(case: Case, alpha: &[f64], rate: f64) -> Error {
    let (ready, model) = (case.ready, case.model);
    let own = ready.dual.rigid_motion(alpha, ready.island.unknowns());
    let mut v = vec![0.0; model.sizes().dofs];
    ready.island.scatter(model, &own, &mut v);
    let largest = norm_max(&v);
    v.iter_mut().for_each(|v| *v /= largest);
    let fastest = (0..v.len()).fold(0, |best, i| if v[i].abs() > v[best].abs() { i } else { best });
    let body = model.offsets[1..].partition_point(|end| *end <= fastest);
    let what = format!(
        "the answer is no minimum: K drives this motion, fastest at this dof, {rate:.1e} times as much as closed rows resist it"
    );
    let error = Error::new(Kind::Indefinite, what).body(body).dof(fastest - model.offsets[body]);
    error.value(rate).limit(1.0).proved_by(Proof::Motion { margin: 1.0 - 1.0 / rate, v })
}
