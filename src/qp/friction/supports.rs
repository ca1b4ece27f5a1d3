//! Weak elastic supports of all motions: `G x + x_s = e`, `x_s = kappa a`. They hold what friction does not hold, and
//! their forces show how much that is. Each support is an additional free row, so no other module needs to know about
//! supports.

use crate::error::Result;
use crate::linalg::{Csr, Operator};
use crate::platform::memory::copied;
use crate::qp::friction::{Cones, Face, FacePreconditioner, FrictionProblem, OnFace};
use crate::qp::Qp;

/// A problem with a support for each motion; the last r of its m + r rows are x_s.
pub struct Supported<'a> {
    of: FrictionProblem<'a>,
    kappa: f64,
    b: Vec<f64>,
    g_transposed: Csr,
    cones: Cones,
}

impl<'a> Supported<'a> {
    /// kappa > 0, no unit: rows have the compliance 1, the modes of a body `|G_p| = 1`.
    pub fn new(of: FrictionProblem<'a>, kappa: f64) -> Result<Self> {
        let mut b = copied(of.qp.b, "supports")?;
        b.resize(of.qp.b.len() + of.qp.e.len(), 0.0);
        let mut g_transposed = of.qp.g_transposed.clone();
        (0..of.qp.e.len()).for_each(|k| g_transposed.push_row([(k, 1.0)]));
        let cones = Cones::new(b.len(), of.cones.nodes().to_vec())?;
        Ok(Self { of, kappa, b, g_transposed, cones })
    }

    pub fn problem(&self) -> FrictionProblem<'_> {
        FrictionProblem {
            qp: Qp { a: self, b: &self.b, g_transposed: &self.g_transposed, ..self.of.qp },
            cones: &self.cones,
            preconditioner: self.of.preconditioner.map(|_| self as &dyn FacePreconditioner),
        }
    }

    /// The part of e that the supports carry, r entries: 0 if friction and contact hold the load.
    pub fn unheld<'x>(&self, x: &'x [f64]) -> &'x [f64] {
        &x[self.of.qp.b.len()..]
    }
}

impl Operator for Supported<'_> {
    fn order(&self) -> usize {
        self.b.len()
    }

    /// y is NaN if there was no memory for the product.
    fn apply(&self, x: &[f64], y: &mut [f64]) {
        if self.try_apply(x, y).is_err() {
            y.fill(f64::NAN);
        }
    }

    fn try_apply(&self, x: &[f64], y: &mut [f64]) -> Result<()> {
        self.product(x, y, |f, x, y| f.try_apply(x, y))
    }

    fn approximate(&self, x: &[f64], y: &mut [f64]) -> Result<()> {
        self.product(x, y, |f, x, y| f.approximate(x, y))
    }

    fn has_approximation(&self) -> bool {
        self.of.qp.a.has_approximation()
    }
}

impl Supported<'_> {
    /// F and, for the supports, `1/kappa`.
    fn product(
        &self,
        x: &[f64],
        y: &mut [f64],
        of_rows: impl Fn(&dyn Operator, &[f64], &mut [f64]) -> Result<()>,
    ) -> Result<()> {
        let (rows, supports) = y.split_at_mut(self.of.qp.b.len());
        of_rows(self.of.qp.a, &x[..rows.len()], rows)?;
        supports.iter_mut().zip(&x[rows.len()..]).for_each(|(y, x)| *y = x / self.kappa);
        Ok(())
    }
}

/// M for the rows, and kappa for the supports.
impl FacePreconditioner for Supported<'_> {
    fn on<'b>(&'b self, face: &Face) -> Result<Box<dyn OnFace + 'b>> {
        let (count, kappa) = (self.of.qp.b.len(), self.kappa);
        let own = Face {
            coordinates: copied(&face.coordinates[..count], "a face")?,
            states: copied(&face.states, "a face")?,
            closed: copied(&face.closed, "a face")?,
            rho: face.rho,
        };
        let of_rows = self.of.preconditioner.map(|of_rows| of_rows.on(&own)).transpose()?;
        Ok(Box::new(move |q: &[f64], z: &mut [f64]| {
            let (rows, supports) = z.split_at_mut(count);
            supports.iter_mut().zip(&q[count..]).for_each(|(z, q)| *z = kappa * q);
            of_rows.as_ref().map_or(Ok(()), |of_rows| of_rows.apply(&q[..count], rows))
        }))
    }
}
