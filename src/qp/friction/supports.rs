//! Weak elastic supports of all motions: `G x + x_s = e`, `x_s = kappa a`. They hold what friction does not, and what they carry says
//! what that is. Each is one more free row, so nothing else knows of them.

use crate::error::Result;
use crate::linalg::{Csr, Operator};
use crate::platform::memory::copied;
use crate::qp::friction::{Cones, Face, FacePreconditioner, FrictionProblem, OnFace};

/// A problem with a support of each motion; the last r of its m + r rows are x_s.
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
        let mut b = copied(of.b, "supports")?;
        b.resize(of.b.len() + of.e.len(), 0.0);
        let mut g_transposed = of.g_transposed.clone();
        (0..of.e.len()).for_each(|k| g_transposed.push_row([(k, 1.0)]));
        let cones = Cones::new(b.len(), of.cones.nodes().to_vec())?;
        Ok(Self { of, kappa, b, g_transposed, cones })
    }

    pub fn problem(&self) -> FrictionProblem<'_> {
        FrictionProblem {
            a: self,
            b: &self.b,
            g_transposed: &self.g_transposed,
            cones: &self.cones,
            preconditioner: self.of.preconditioner.map(|_| self as &dyn FacePreconditioner),
            ..self.of
        }
    }

    /// What the supports carry of e, r entries: 0 where friction and contact hold the load.
    pub fn unheld<'x>(&self, x: &'x [f64]) -> &'x [f64] {
        &x[self.of.b.len()..]
    }
}

impl Operator for Supported<'_> {
    fn order(&self) -> usize {
        self.b.len()
    }

    /// F and, for the supports, `1/kappa`.
    fn apply(&self, x: &[f64], y: &mut [f64]) {
        let (rows, supports) = y.split_at_mut(self.of.b.len());
        self.of.a.apply(&x[..rows.len()], rows);
        supports.iter_mut().zip(&x[rows.len()..]).for_each(|(y, x)| *y = x / self.kappa);
    }

    fn try_apply(&self, x: &[f64], y: &mut [f64]) -> Result<()> {
        let (rows, supports) = y.split_at_mut(self.of.b.len());
        self.of.a.try_apply(&x[..rows.len()], rows)?;
        supports.iter_mut().zip(&x[rows.len()..]).for_each(|(y, x)| *y = x / self.kappa);
        Ok(())
    }
}

/// M of the rows, and kappa for the supports.
struct OnSupported<'a> {
    rows: Box<dyn OnFace + 'a>,
    kappa: f64,
    count: usize,
}

impl FacePreconditioner for Supported<'_> {
    fn on<'b>(&'b self, face: &Face) -> Result<Box<dyn OnFace + 'b>> {
        let count = self.of.b.len();
        let own = Face {
            coordinates: copied(&face.coordinates[..count], "a face")?,
            states: copied(&face.states, "a face")?,
            closed: copied(&face.closed, "a face")?,
            rho: face.rho,
        };
        match self.of.preconditioner {
            Some(preconditioner) => {
                Ok(Box::new(OnSupported { rows: preconditioner.on(&own)?, kappa: self.kappa, count }))
            }
            None => Ok(Box::new(Identity)),
        }
    }
}

impl OnFace for OnSupported<'_> {
    fn apply(&self, q: &[f64], z: &mut [f64]) -> Result<()> {
        let (rows, supports) = z.split_at_mut(self.count);
        self.rows.apply(&q[..self.count], rows)?;
        supports.iter_mut().zip(&q[self.count..]).for_each(|(z, q)| *z = self.kappa * q);
        Ok(())
    }
}

struct Identity;

impl OnFace for Identity {
    fn apply(&self, q: &[f64], z: &mut [f64]) -> Result<()> {
        z.copy_from_slice(q);
        Ok(())
    }
}
