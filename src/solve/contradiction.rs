//! The search for rows that contradict each other, before any product with F.

use crate::constraints::RowKind;
use crate::error::{Error, Result};
use crate::linalg::vector::{dot, norm, norm_max};
use crate::linalg::{Csr, Operator};
use crate::numbers::rounding;
use crate::numbers::solve::{BEYOND, MAY_CONTRADICT};
use crate::platform::interrupt;
use crate::qp::{minimise, AcceptanceTest, Limits, Observer, Qp, StepReport};
use crate::solve::case::Case;
use crate::solve::diagnosis::Contradictions;
use crate::solve::gaps::Gaps;

/// Limit of multiplications for the finite method; above it, the method for many rows comes first.
const SMALL: usize = 100_000_000;
/// Limit of multiplications of the search for contradictions.
const WORK: usize = 200_000_000;

/// `min |D^-1/2 B'w|^2 + (1 + c'w)^2` over w >= 0 on contact rows is zero exactly if rows contradict each other (c scaled
/// to largest entry 1, far rows left out). B has unit rows without the compliant rows, which contradict no other row. The
/// search needs no product with F.
pub fn contradiction(case: Case, gaps: &Gaps) -> Result<Option<Error>> {
    let (rows, compliance) = (&case.ready.rows, &case.ready.dual.compliance);
    let demand =
        |group: usize| if gaps.bounded[group] { -gaps.value[group] } else { gaps.value[group].abs() };
    let rigid = |group: &usize| compliance[*group] == 0.0 && rows.kind(*group) != RowKind::Tangential;
    let size = (0..gaps.value.len()).filter(rigid).map(demand).fold(0.0, f64::max);
    let near = |group: &usize| gaps.value[*group] <= BEYOND * size;
    let rigid: Vec<usize> = (0..gaps.value.len()).filter(rigid).filter(near).collect();
    if size == 0.0 {
        return Ok(None); // u = 0 satisfies them all
    }
    let claims = Contradictions::new(case, gaps);
    let rigid = claims.among(rigid);
    if rigid.work() <= SMALL {
        return claims.proved_among(&rigid);
    }
    let bounded: Vec<bool> = rigid.groups.iter().map(|&group| gaps.bounded[group]).collect();
    let mut c: Vec<f64> = rigid.groups.iter().map(|&group| gaps.value[group]).collect();
    let size = norm_max(&c);
    c.iter_mut().for_each(|c| *c /= size);
    let mut matrix = Csr::empty(rows.scaled.cols);
    rigid.groups.iter().for_each(|&group| matrix.push_row(rows.scaled.row(group)));
    let a = Alternative { matrix: &matrix, metric: &rows.metric, c: &c };
    let b: Vec<f64> = c.iter().map(|c| -c).collect();
    let none = Csr { ptr: vec![0; c.len() + 1], ..Csr::default() };
    let qp = Qp::plain(&a, &b, &none, &[], &bounded);
    let steps = (WORK / (4 * matrix.val.len() + c.len() + 1)).clamp(1000, 200_000);
    let limits = Limits { tolerance: rounding::SUM, gamma: 1.0, steps };
    let mut judge = Unjudged { scale: norm(&b) };
    let solution = minimise(qp, &vec![0.0; c.len()], limits, &mut judge, &mut Unheard)?;
    interrupt::check()?;
    if left(&a, &solution.x) > MAY_CONTRADICT {
        return Ok(None);
    }
    let mut w = vec![0.0; gaps.value.len()];
    rigid.groups.iter().zip(&solution.x).for_each(|(&group, x)| w[group] = *x);
    match claims.proved(&w)? {
        Some(error) => Ok(Some(error)),
        None => claims.proved_among(&rigid),
    }
}

/// `w -> B D^-1 B'w + c (c'w)`
struct Alternative<'a> {
    matrix: &'a Csr,
    metric: &'a [f64],
    c: &'a [f64],
}

impl Operator for Alternative<'_> {
    fn order(&self) -> usize {
        self.c.len()
    }

    fn apply(&self, w: &[f64], y: &mut [f64]) {
        let mut v = vec![0.0; self.metric.len()];
        self.matrix.mul_transposed_add(1.0, w, &mut v);
        v.iter_mut().zip(self.metric).for_each(|(v, d)| *v /= d);
        self.matrix.mul(&v, y);
        let demanded = dot(self.c, w);
        y.iter_mut().zip(self.c).for_each(|(y, c)| *y += c * demanded);
    }
}

/// `|D^-1/2 B'w|^2 + (1 + c'w)^2`, 1 / (1 + |u|_D^2 / max |c|^2) for the shortest u that satisfies the rows.
fn left(a: &Alternative, w: &[f64]) -> f64 {
    let mut image = vec![0.0; w.len()];
    a.apply(w, &mut image);
    dot(w, &image) + 2.0 * dot(a.c, w) + 1.0
}

/// Accepts no point: the combination found is tested afterwards.
struct Unjudged {
    scale: f64,
}

impl AcceptanceTest for Unjudged {
    fn scale(&mut self, _: &[f64], _: &[f64]) -> Result<f64> {
        Ok(self.scale)
    }

    fn accepts(&mut self, _: &[f64], _: &[f64]) -> Result<bool> {
        Ok(true)
    }
}

/// Reports no steps of this search to the host, only its progress.
struct Unheard;

impl Observer for Unheard {
    fn step(&mut self, now: &StepReport) -> Result<()> {
        interrupt::reached("steps", now.counts.steps())
    }
}
