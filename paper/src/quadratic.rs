//! The quadratic function under the bounds. (20): theta(x) = 1/2 x'A x - b'x. Section 5, corrected:
//!
//! ```text
//! L(x, mu, rho) = theta(x) + mu'(D x - d) + rho/2 |D x - d|^2
//! g(x, mu, rho) = A x - b + D'(mu + rho (D x - d)) = H x - c,   H = A + rho D'D,   c = b - D'mu + rho D'd
//! ```
//!
//! Without equalities H = A and c = b.

use feti_contact::error::Result;
use feti_contact::linalg::vector::{axpy, dot, norm};
use feti_contact::qp::Qp;

pub struct Quadratic<'a> {
    /// A, b, D' (m x r), d.
    pub qp: Qp<'a>,
    pub rho: f64,
    /// c = b - D'(mu - rho d)
    c: Vec<f64>,
    /// Products with A.
    pub products: usize,
}

impl<'a> Quadratic<'a> {
    /// theta of (20).
    pub fn theta(qp: Qp<'a>) -> Self {
        Self { qp, rho: 0.0, c: qp.b.to_vec(), products: 0 }
    }

    /// Changes the function to `L(., mu, rho)`.
    pub fn augment(&mut self, mu: &[f64], rho: f64) {
        self.rho = rho;
        self.c.copy_from_slice(self.qp.b);
        let shifted: Vec<f64> = mu.iter().zip(self.qp.e).map(|(mu, d)| mu - rho * d).collect();
        self.spread_add(-1.0, &shifted);
    }

    /// Py: the nearest point with y_i >= 0 (i bounded).
    pub fn projection(&self, mut y: Vec<f64>) -> Vec<f64> {
        let bounded = y.iter_mut().zip(self.qp.bounded).filter(|(y, bounded)| **bounded && **y < 0.0);
        bounded.for_each(|(y, _)| *y = 0.0);
        y
    }

    fn spread_add(&mut self, a: f64, y: &[f64]) {
        let d_transposed = self.qp.g_transposed;
        self.c.iter_mut().enumerate().for_each(|(i, c)| *c += a * d_transposed.row_dot(i, y));
    }

    /// `H v = A v + rho D'(D v)`
    pub fn product(&mut self, v: &[f64]) -> Result<Vec<f64>> {
        let mut image = vec![0.0; v.len()];
        self.qp.a.try_apply(v, &mut image)?;
        self.products += 1;
        if self.rho != 0.0 {
            let dv = self.equalities(v);
            for (i, image) in image.iter_mut().enumerate() {
                *image += self.rho * self.qp.g_transposed.row_dot(i, &dv);
            }
        }
        Ok(image)
    }

    /// `g = H x - c`
    pub fn gradient(&mut self, x: &[f64]) -> Result<Vec<f64>> {
        let mut g = self.product(x)?;
        axpy(-1.0, &self.c, &mut g);
        Ok(g)
    }

    /// `1/2 x'H x - c'x` from the gradient at x: (20), and L up to a constant.
    pub fn value(&self, x: &[f64], g: &[f64]) -> f64 {
        0.5 * (dot(x, g) - dot(x, &self.c))
    }

    /// theta(x) of (20) from the gradient of L at x.
    pub fn energy(&self, x: &[f64], g: &[f64]) -> f64 {
        let dx = self.equalities(x);
        0.5 * (dot(x, g) + dot(x, &self.c) - self.rho * dot(&dx, &dx)) - dot(x, self.qp.b)
    }

    /// `D v`
    pub fn equalities(&self, v: &[f64]) -> Vec<f64> {
        let mut image = vec![0.0; self.qp.e.len()];
        self.qp.g_transposed.mul_transposed_add(1.0, v, &mut image);
        image
    }

    /// `D x - d`
    pub fn violation(&self, x: &[f64]) -> Vec<f64> {
        let mut violation = self.equalities(x);
        axpy(-1.0, self.qp.e, &mut violation);
        violation
    }

    /// Rounding of the gradient at x: 4 eps (|H x| + |c|).
    pub fn noise(&self, g: &[f64]) -> f64 {
        4.0 * f64::EPSILON * (norm(g) + 2.0 * norm(&self.c))
    }
}
