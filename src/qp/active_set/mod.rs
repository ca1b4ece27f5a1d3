//! Primal-dual active sets: the minimum on a face by a direct method, then rows with `x_i < 0` join the active set and
//! active rows with `r_i < 0` leave it, until nothing changes. The method is fast, and as accurate as rounding allows if
//! it ends. It need not end (rows may be exchanged for ever, a face may have no minimum), and then gives up. Steps A1 to
//! A5 of docs/method.md.

mod face;

use crate::error::{Kind, Result};
use crate::linalg::vector::{axpy, dot, norm};
use crate::linalg::Entries;
use crate::qp::coarse::Coarse;
use crate::qp::projection::project;
use crate::qp::{AcceptanceTest, Counts, Qp, Solution, Verdict};

pub use face::Face;

/// Limit of faces.
const FACES: usize = 30;
/// Limit of corrections of the solution on a face by the residual of A itself.
const REFINEMENTS: usize = 5;
/// The conditions of a face are met if they hold to this part of their terms.
const MET: f64 = 1e-10;
/// A projected gradient is zero if it is below this part of the scale of the acceptance test.
const ZERO: f64 = 1e-12;

/// Number of square matrices over all free rows and modes in memory, here and in `proximal`.
const MATRICES: usize = 8;

/// Data for the direct method in addition to the problem.
#[derive(Clone, Copy)]
pub struct Direct<'a> {
    pub entries: &'a dyn Entries,
    /// Limit of the total number of free rows and modes: memory and work grow with its second and third power.
    pub limit: usize,
}

impl Direct<'_> {
    /// Largest number of bytes for this total number of free rows and modes.
    pub fn bytes(order: usize) -> usize {
        order.saturating_mul(order).saturating_mul(MATRICES * size_of::<f64>())
    }
}

/// Continues from `from` and its active set: solved if the point is accepted, otherwise stalled with the given point.
pub fn active_set(
    qp: Qp,
    direct: Direct,
    from: &Solution,
    judge: &mut dyn AcceptanceTest,
) -> Result<Solution> {
    let mut run = Run::new(qp, direct, from)?;
    let (settled, ended) = match run.settle() {
        Ok(settled) => (settled, Verdict::Stalled),
        Err(error) if error.kind == Kind::Memory => (false, Verdict::Stalled),
        Err(error) => (false, Verdict::of_refusal(error)?),
    };
    let open = run.coarse.on(&qp.at_bound(&run.x)).map(|face| face.deficiency());
    let (undetermined, ended) = ended.with(open, 0)?;
    let counts = Counts {
        coarse_solves: run.coarse.solves,
        coarse_factorisations: run.coarse.factorisations,
        ..run.counts
    };
    if settled && judge.accepts(&run.x, &run.alpha)? {
        let verdict = Verdict::Solved;
        return Ok(Solution { x: run.x, alpha: run.alpha, undetermined, scale: from.scale, verdict, counts });
    }
    Ok(Solution { verdict: ended, counts, ..from.clone() })
}

struct Run<'a> {
    qp: Qp<'a>,
    direct: Direct<'a>,
    coarse: Coarse<'a>,
    x: Vec<f64>,
    alpha: Vec<f64>,
    active: Vec<bool>,
    /// `r = A x - b - G'alpha`
    r: Vec<f64>,
    /// `|A x| + |b| + |G'alpha|`, row by row.
    terms: Vec<f64>,
    /// A length that counts as zero, without rounding.
    small: f64,
    counts: Counts,
}

impl<'a> Run<'a> {
    fn new(qp: Qp<'a>, direct: Direct<'a>, from: &Solution) -> Result<Self> {
        Ok(Self {
            coarse: Coarse::of(&qp)?,
            active: qp.at_bound(&from.x),
            x: from.x.clone(),
            alpha: from.alpha.clone(),
            r: vec![0.0; from.x.len()],
            terms: vec![0.0; from.x.len()],
            small: ZERO * from.scale,
            counts: Counts::default(),
            qp,
            direct,
        })
    }

    /// A1: goes from face to face; false if no face is confirmed by its own solution.
    fn settle(&mut self) -> Result<bool> {
        let mut visited: Vec<Vec<bool>> = Vec::new();
        while visited.len() < FACES && !visited.contains(&self.active) {
            let rows: Vec<usize> = (0..self.x.len()).filter(|&i| !self.active[i]).collect();
            if rows.len() + self.alpha.len() > self.direct.limit {
                return Ok(false);
            }
            let Some(face) = self.solve_on(rows)? else { return Ok(false) };
            let next = self.next_set(&face)?;
            if next == self.active {
                return Ok(true);
            }
            visited.push(std::mem::replace(&mut self.active, next));
        }
        Ok(false)
    }

    /// A2 and A3: moves x and alpha to the minimum on the face; `None`: there is none. Its first product checks for a
    /// cancellation before the factorisation begins.
    fn solve_on(&mut self, rows: Vec<usize>) -> Result<Option<Face<'a>>> {
        self.x.iter_mut().zip(&self.active).filter(|(_, held)| **held).for_each(|(x, _)| *x = 0.0);
        self.refresh()?;
        let Some(face) = Face::new(self.qp, self.direct.entries, rows)? else { return Ok(None) };
        self.counts.direct += 1;
        let mut last = f64::INFINITY;
        for _ in 0..REFINEMENTS {
            let force = face.rows().iter().map(|&i| -self.r[i]).collect();
            let (step, turn) = face.solve(force, &self.qp.left(&self.x))?;
            face.rows().iter().zip(&step).for_each(|(&i, s)| self.x[i] += s);
            axpy(1.0, &turn, &mut self.alpha);
            self.refresh()?;
            let size = norm(&step);
            if size <= f64::EPSILON * norm(&self.x) || size > 0.5 * last {
                break;
            }
            last = size;
        }
        let force = face.rows().iter().map(|&i| self.r[i] * self.r[i]).sum::<f64>().sqrt();
        let mut terms = vec![0.0; self.alpha.len()];
        self.qp.g_transposed.mul_transposed_abs_add(&self.x, &mut terms);
        let balanced = norm(&self.qp.left(&self.x)) <= MET * (norm(self.qp.e) + norm(&terms));
        let size = face.rows().iter().map(|&i| self.terms[i] * self.terms[i]).sum::<f64>().sqrt();
        Ok((balanced && force <= MET * size).then_some(face))
    }

    /// Recomputes r of x and alpha.
    fn refresh(&mut self) -> Result<()> {
        let mut image = self.product(&self.x.clone())?;
        let coarse: Vec<f64> =
            (0..image.len()).map(|i| self.qp.g_transposed.row_dot(i, &self.alpha)).collect();
        let terms = image.iter().zip(self.qp.b).zip(&coarse);
        self.terms = terms.map(|((image, b), coarse)| image.abs() + b.abs() + coarse.abs()).collect();
        axpy(-1.0, self.qp.b, &mut image);
        axpy(-1.0, &coarse, &mut image);
        self.r = image;
        Ok(())
    }

    /// `A v`, counted.
    fn product(&mut self, v: &[f64]) -> Result<Vec<f64>> {
        let mut image = vec![0.0; v.len()];
        self.qp.a.try_apply(v, &mut image)?;
        self.counts.products += 1;
        Ok(image)
    }

    /// Rounding of row i of r.
    fn noise(&self, i: usize) -> f64 {
        64.0 * f64::EPSILON * self.terms[i]
    }

    /// A4: the active set by the signs of x and r.
    fn next_set(&mut self, face: &Face) -> Result<Vec<bool>> {
        let stays = |i: usize| if self.active[i] { self.r[i] >= -self.noise(i) } else { self.x[i] < 0.0 };
        let next: Vec<bool> = (0..self.x.len()).map(|i| self.qp.bounded[i] && stays(i)).collect();
        let only_leave = next.iter().zip(&self.active).all(|(next, active)| *active || !*next);
        if face.undetermined() > 0 && only_leave && next != self.active {
            return Ok(self.projected()?.unwrap_or(next));
        }
        Ok(next)
    }

    /// If the free rows do not determine alpha, gradient projection determines it: its multiplier confirms the point or
    /// shows which rows to free.
    fn projected(&mut self) -> Result<Option<Vec<bool>>> {
        // r of an open row is its gap and says nothing about A
        let pulls = |i: usize| !self.active[i] || self.r[i] < 0.0;
        let way: Vec<f64> = (0..self.r.len()).map(|i| if pulls(i) { self.r[i] } else { 0.0 }).collect();
        let image = self.product(&way)?;
        let curvature = dot(&image, &way);
        let step = if curvature > 0.0 { curvature / dot(&image, &image) } else { 1.0 };
        let mut y = self.x.clone();
        axpy(-step, &self.r, &mut y);
        let none = vec![false; y.len()];
        let Some(found) = project(&self.qp, &mut self.coarse, &y, &none)? else { return Ok(None) };
        let mut way = found.point.clone();
        axpy(-1.0, &self.x, &mut way);
        let noise =
            (0..way.len()).filter(|&i| way[i] != 0.0).map(|i| self.noise(i).powi(2)).sum::<f64>().sqrt();
        if norm(&way) <= step * (self.small + noise) {
            axpy(1.0 / step, &found.multiplier, &mut self.alpha);
            return Ok(Some(self.active.clone()));
        }
        Ok(Some(self.qp.at_bound(&found.point)))
    }
}
