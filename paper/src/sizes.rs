//! Reference values of rho_0, M, eta_0 and Step 2 of Algorithm 3. The printed numbers are absolute: at E = 2.1e11 every
//! run with them fails. In units of |A| / |D|^2 the iteration does not depend on units or on the basis R.

use super::{Quadratic, Units};
use feti_contact::error::Result;
use feti_contact::linalg::random::scattered;
use feti_contact::linalg::vector::{axpy, norm};
use feti_contact::qp::AcceptanceTest;
use feti_contact::qp::Coarse;

pub struct PaperSizes {
    /// Unit of rho.
    pub penalty: f64,
    /// Unit of M.
    pub balance: f64,
    /// Unit of eta.
    pub violation: f64,
    /// Unit of mu^0.
    pub multiplier: f64,
    /// Step 2: references of `|g^P|` and `|D x - d|`.
    pub gradient: f64,
    pub equality: f64,
}

/// Limit of power iterations, and the change at which they end: they estimate sizes and give no bounds.
const ITERATIONS: usize = 10;
const CHANGE: f64 = 0.1;

impl PaperSizes {
    pub fn new(q: &mut Quadratic, units: Units, judge: &mut dyn AcceptanceTest) -> Result<Self> {
        match units {
            Units::Printed => Ok(Self::printed(q)),
            Units::Relative => Self::relative(q, judge),
        }
    }

    fn printed(q: &Quadratic) -> Self {
        let (gradient, equality) = (norm(q.qp.b), norm(q.qp.e));
        Self { penalty: 1.0, balance: 1.0, violation: 1.0, multiplier: 1.0, gradient, equality }
    }

    /// |A| and |D| by power iteration. The reference of the gradient is the scale of the gaps at l = D'(D D')+ d, which
    /// does not depend on K+; that of d is |d|, but at least the forces equivalent to such gaps.
    fn relative(q: &mut Quadratic, judge: &mut dyn AcceptanceTest) -> Result<Self> {
        let m = q.qp.b.len();
        let a = largest(m, &mut |v| q.product(v))?;
        let square = largest(m, &mut |v| {
            let dv = q.equalities(v);
            Ok((0..m).map(|i| q.qp.g_transposed.row_dot(i, &dv)).collect())
        })?;
        let d = square.sqrt();
        let gradient = reference(q, judge)?;
        let equality = norm(q.qp.e).max(d * gradient / a);
        Ok(Self {
            penalty: a / square,
            balance: a / d,
            violation: equality,
            multiplier: gradient / d,
            gradient,
            equality,
        })
    }
}

/// The scale of the gaps at `l = D'(D D')+ d`, with `alpha = argmin |A l - b - D'alpha|`.
fn reference(q: &mut Quadratic, judge: &mut dyn AcceptanceTest) -> Result<f64> {
    let mut coarse = Coarse::of(&q.qp)?;
    let all = vec![false; q.qp.b.len()];
    let y = coarse.on(&all)?.solve(q.qp.e)?;
    let l: Vec<f64> = (0..all.len()).map(|i| q.qp.g_transposed.row_dot(i, &y)).collect();
    let mut g = q.product(&l)?;
    axpy(-1.0, q.qp.b, &mut g);
    let image = coarse.image(&g);
    judge.scale(&l, &coarse.on(&all)?.solve(&image)?)
}

/// Lower estimate of the norm of a symmetric semidefinite map; 1 if it is 0.
fn largest(order: usize, map: &mut dyn FnMut(&[f64]) -> Result<Vec<f64>>) -> Result<f64> {
    let (mut x, mut estimate) = (scattered(order), 0.0);
    for _ in 0..ITERATIONS {
        let size = norm(&x);
        if size == 0.0 {
            break;
        }
        x.iter_mut().for_each(|v| *v /= size);
        x = map(&x)?;
        let last = std::mem::replace(&mut estimate, norm(&x));
        if (estimate - last).abs() <= CHANGE * estimate {
            break;
        }
    }
    Ok(if estimate > 0.0 { estimate } else { 1.0 })
}
