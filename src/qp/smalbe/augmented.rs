//! The Hessian `H = P A P + rho Q` of the augmented Lagrangian, applied matrix-free, with `Q = G'W+G`, `P = I - Q`,
//! `W = G G'` over all rows, and the distance of a point from `G x = e`.

use crate::error::Result;
use crate::linalg::random::scattered;
use crate::linalg::vector::{axpy, norm};
use crate::qp::coarse::Coarse;
use crate::qp::smalbe::mprgp::Hessian;
use crate::qp::{Counts, Qp};

/// rho in units of lambda_max(P A P).
const PENALTY: f64 = 3.0;
/// Limit of power iterations, and the change at which they end.
const ITERATIONS: usize = 100;
const CHANGE: f64 = 1e-3;
/// Safety factor: the power iteration converges from below.
const MARGIN: f64 = 1.05;
/// P A P counts as zero if P leaves less than this part of A.
const NOTHING: f64 = 1e-8;

pub struct Augmented<'a> {
    pub qp: Qp<'a>,
    pub coarse: Coarse<'a>,
    /// No row is held: P and Q act on all rows.
    none: Vec<bool>,
    pub rho: f64,
    /// lambda_max(P A P)
    pub largest: f64,
    pub counts: Counts,
}

/// `s = W+(G x - e)`, `G's` and `|G's|`, the distance of x from `G x = e`.
#[derive(Default)]
pub struct Violation {
    pub s: Vec<f64>,
    pub way: Vec<f64>,
    pub length: f64,
}

impl<'a> Augmented<'a> {
    pub fn new(qp: Qp<'a>, coarse: Coarse<'a>) -> Result<Self> {
        let (none, counts) = (vec![false; qp.b.len()], Counts::default());
        let mut new = Self { qp, coarse, none, rho: 0.0, largest: 0.0, counts };
        new.largest = new.largest_eigenvalue()?;
        new.rho = PENALTY * new.largest;
        Ok(new)
    }

    /// lambda_max(P A P) by power iteration; |A| if P A P counts as zero, 1 if A is 0.
    fn largest_eigenvalue(&mut self) -> Result<f64> {
        let mut x = scattered(self.none.len());
        self.project(&mut x)?;
        let (mut estimate, mut whole) = (0.0, 0.0_f64);
        for _ in 0..ITERATIONS {
            let size = norm(&x);
            if size == 0.0 {
                break;
            }
            x.iter_mut().for_each(|v| *v /= size);
            x = self.image(&x)?;
            whole = whole.max(norm(&x));
            self.project(&mut x)?;
            let last = std::mem::replace(&mut estimate, norm(&x));
            if (estimate - last).abs() <= CHANGE * estimate {
                break;
            }
        }
        let largest = if estimate > NOTHING * whole { MARGIN * estimate } else { whole };
        Ok(if largest > 0.0 { largest } else { 1.0 })
    }

    /// `A v`, counted.
    pub fn image(&mut self, v: &[f64]) -> Result<Vec<f64>> {
        let mut image = vec![0.0; v.len()];
        self.qp.a.try_apply(v, &mut image)?;
        self.counts.products += 1;
        Ok(image)
    }

    /// `v <- P v`
    pub fn project(&mut self, v: &mut [f64]) -> Result<()> {
        self.coarse.project(&self.none, v)
    }

    /// `W+ y`
    pub fn solve(&mut self, y: &[f64]) -> Result<Vec<f64>> {
        self.coarse.on(&self.none)?.solve(y)
    }

    /// `G'y`
    pub fn spread(&self, y: &[f64]) -> Vec<f64> {
        (0..self.none.len()).map(|i| self.qp.g_transposed.row_dot(i, y)).collect()
    }

    pub fn violation(&mut self, x: &[f64]) -> Result<Violation> {
        let mut rest = self.coarse.image(x);
        axpy(-1.0, self.qp.e, &mut rest);
        let s = self.solve(&rest)?;
        let way = self.spread(&s);
        let length = norm(&way);
        Ok(Violation { s, way, length })
    }
}

impl Hessian for Augmented<'_> {
    /// `H p = A P p - G'a`, m entries, then `a = W+G (A P p - rho p)`, r entries.
    fn product(&mut self, p: &[f64]) -> Result<Vec<f64>> {
        let mut inside = p.to_vec();
        self.project(&mut inside)?;
        let mut image = self.image(&inside)?;
        let mut outside = image.clone();
        axpy(-self.rho, p, &mut outside);
        let outside = self.coarse.image(&outside);
        let a = self.solve(&outside)?;
        axpy(-1.0, &self.spread(&a), &mut image);
        image.extend(a);
        Ok(image)
    }

    /// `P M_F P r + Q r / rho` on the face, with the preconditioner M_F of A; r itself without one.
    fn precondition(&mut self, held: &[bool], r: &[f64]) -> Result<Vec<f64>> {
        let Some(preconditioner) = self.qp.preconditioner else { return Ok(r.to_vec()) };
        let mut inside = r.to_vec();
        self.project(&mut inside)?;
        let mut z = vec![0.0; r.len()];
        preconditioner.apply(held, &inside, &mut z)?;
        self.counts.preconditioned += 1;
        self.project(&mut z)?;
        for i in 0..r.len() {
            z[i] = if held[i] { 0.0 } else { z[i] + (r[i] - inside[i]) / self.rho };
        }
        Ok(z)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::linalg::{Csr, Packed};

    #[test]
    fn the_largest_eigenvalue_is_that_on_the_kernel_of_g() {
        // A = diag(1 ... 6) and a large entry that P removes
        let (m, mut g_transposed) = (7, Csr::empty(1));
        let mut a = Packed::zeros(m).unwrap();
        for i in 0..m {
            a.add(i, i, if i == 3 { 1e6 } else { 1.0 + i as f64 });
            g_transposed.push_row((i == 3).then_some((0, 5.0)));
        }
        let (b, bounded) = (vec![0.0; m], vec![true; m]);
        let qp = Qp {
            a: &a,
            b: &b,
            g_transposed: &g_transposed,
            blocks: &[],
            rounding: 1e-14,
            e: &[1.0],
            bounded: &bounded,
            preconditioner: None,
            kept: None,
        };
        let augmented = Augmented::new(qp, Coarse::of(&qp).unwrap()).unwrap();
        assert!((7.0..=1.05 * 7.0).contains(&augmented.largest), "{}", augmented.largest);
        assert!(augmented.counts.products < ITERATIONS);
    }

    /// Eigenvalues 1 ... 30: after three power iterations the estimate is a tenth too small, and steps of fixed length
    /// diverge.
    #[test]
    fn three_power_iterations_are_not_enough_and_not_the_last() {
        let (m, mut g_transposed) = (30, Csr::empty(0));
        let mut a = Packed::zeros(m).unwrap();
        for i in 0..m {
            a.add(i, i, 1.0 + i as f64);
            g_transposed.push_row([]);
        }
        let (b, bounded) = (vec![0.0; m], vec![true; m]);
        let qp = Qp {
            a: &a,
            b: &b,
            g_transposed: &g_transposed,
            blocks: &[],
            rounding: 1e-14,
            e: &[],
            bounded: &bounded,
            preconditioner: None,
            kept: None,
        };
        let largest = Augmented::new(qp, Coarse::of(&qp).unwrap()).unwrap().largest;
        assert!((30.0..=1.05 * 30.0).contains(&largest), "{largest}");
    }
}
