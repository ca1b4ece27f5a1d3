//! The energies of an island: the duality gap, and the functional that is minimised.

use crate::certificate::field::Field;
use crate::certificate::part::Measured;
use crate::certificate::{share, Entry, NOISE};
use crate::constraints::RowKind;

/// Sums over the island, force x length.
#[derive(Default)]
pub(super) struct Energies {
    /// `u'K u`
    strain: f64,
    /// `f'u`
    work: f64,
    /// `|u|'(|K||u| + |f| + |B'||lambda| + |H'||mu|)`
    terms: f64,
    /// `||f| + |B'||lambda| + |H'||mu||_{D^-1}^2`: f - r is known up to rounding of its terms, so u is known up to the
    /// effect of this rounding.
    forces: f64,
    /// `lambda'C lambda + mu'C mu + lambda_t'C_t lambda_t`, twice the energy of the compliant rows.
    stored: f64,
    /// `c'lambda + h'mu + s_old'lambda_t`, twice the energy of the compliant rows and `b |s|` of the nodes with friction;
    /// and the sum of the absolute values of these terms.
    constrained: f64,
    constrained_size: f64,
    /// The same of what was taken from right-hand sides as rounding.
    rounding: f64,
    /// Some force is not 0.
    acting: bool,
}

impl Energies {
    /// Adds a body.
    pub fn add_body(&mut self, field: &Field, body: &Measured) {
        self.strain += body.stored;
        self.work += body.work;
        self.terms += body.terms;
        self.forces += body.forces * (body.forces / field.unit);
        self.acting |= body.forces > 0.0;
    }

    /// Adds the rows. A row without force does no work even if its gap is infinite: 0 x infinity counts as 0.
    pub fn add_rows(&mut self, field: &Field) {
        for (kind, forces) in RowKind::ALL.map(|kind| (kind, field.answer.forces(kind))) {
            let rows = field.rows(kind);
            for (i, force) in forces.iter().enumerate().filter(|(_, force)| **force != 0.0) {
                let (work, stored) = (force * rows.rhs[i], rows.compliance[i] * force * force);
                self.stored += stored;
                self.constrained += work + stored;
                self.constrained_size += work.abs() + stored;
                self.rounding += force.abs() * rows.rounding(i);
            }
        }
    }

    /// Adds the dissipation of the nodes with friction, force x length.
    pub fn add_slips(&mut self, dissipated: impl Iterator<Item = f64>) {
        for work in dissipated {
            self.constrained += work;
            self.constrained_size += work.abs();
        }
    }

    /// `|u'K u - f'u + c'lambda + h'mu + lambda'C lambda + mu'C mu|`, with friction and `s_old'lambda_t + lambda_t'C_t
    /// lambda_t + b |s|` of every node, relative to `tol` times the sum of the sizes of its terms plus rounding.
    pub fn entry(&self, limit: f64) -> Entry {
        let noise = NOISE * (self.terms + self.forces + self.stored) + self.rounding;
        // if the squares of forces underflow, the energies are not known
        let noise = if self.acting && !noise.is_normal() { f64::NAN } else { noise };
        let size = self.strain.abs() + self.work.abs() + self.constrained_size;
        let gap = self.strain - self.work + self.constrained;
        Entry::new(share(gap.abs(), limit * size + noise), limit, None)
    }

    /// `1/2 u'K u - f'u + 1/2 lambda'C lambda + 1/2 mu'C mu + 1/2 lambda_t'C_t lambda_t`, without the dissipation of
    /// friction.
    pub fn minimised(&self) -> f64 {
        0.5 * self.strain - self.work + 0.5 * self.stored
    }
}
