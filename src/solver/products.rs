//! Operators that the host can verify: null spaces, K+, F, d.

use crate::constraints::RowKind;
use crate::error::{Error, Kind, Result};
use crate::linalg::Operator;
use crate::platform::memory::zeros;
use crate::setup::{Inverse, Island};
use crate::solver::decomposed::null_space_of;
use crate::solver::problem::Problem;

impl Problem {
    fn inverse(&mut self, body: usize) -> Result<&Inverse> {
        self.check_whole_body(body)?;
        self.setup()?;
        let missing = || Error::new(Kind::Internal, "the setup left a body without factors");
        let part = self.only_part(body).ok_or_else(missing)?;
        self.prepared.inverse(self.solved(), part).ok_or_else(missing)
    }

    /// Dimension r of the null space of a body and its basis as the library uses it: n x r column-major,
    /// orthonormal in the metric of diag K / 2^p.
    pub fn null_space(&mut self, body: usize) -> Result<(usize, &[f64])> {
        if self.check_whole_body(body).is_err() {
            self.model.given(body)?;
            self.setup()?;
            let missing = || Error::new(Kind::Internal, "the setup left a body without null space");
            let basis = self
                .parts()
                .and_then(|parts| null_space_of(&self.prepared, parts, body))
                .ok_or_else(missing)?;
            return Ok((basis.cols, &basis.data));
        }
        let basis = &self.inverse(body)?.kplus.null_space;
        Ok((basis.cols, &basis.data))
    }

    /// Gap of a null space that the library found: ratio of the softest other motion to its stiffest in the metric of
    /// diag K, both at least 1e-14 of the largest; none if the host gave vectors or coordinates.
    pub fn null_space_gap(&mut self, body: usize) -> Result<Option<f64>> {
        if self.model.given(body)?.body.assembled.is_some() {
            return Ok(None);
        }
        Ok(self.inverse(body)?.kplus.gap)
    }

    /// The r dofs held in K+ of (14)-(15); not known for a K+ of the host.
    pub fn fixing_dofs(&mut self, body: usize) -> Result<&[usize]> {
        if self.model.given(body)?.body.operator.is_some() {
            let what = "K+ of this body is given by the host: its fixing dofs are not known";
            return Err(Error::new(Kind::Unsupported, what).body(body));
        }
        Ok(&self.inverse(body)?.kplus.fixing)
    }

    /// `y = K_p+ x`, x force, y length.
    pub fn kplus(&mut self, body: usize, x: &[f64], y: &mut [f64]) -> Result<()> {
        self.model.check_length(body, "n", x.len())?;
        self.model.check_length(body, "n", y.len())?;
        let inverse = self.inverse(body)?;
        inverse.kplus.apply(x, y)?;
        y.iter_mut().for_each(|y| *y /= inverse.unit);
        Ok(())
    }

    /// `y = F x` of (12), including the compliance of the rows, contact rows first; x force, y length. y = 0 for rows
    /// that never close, and their x is ignored. Tangential rows are not included.
    pub fn dual_apply(&mut self, x: &[f64], y: &mut [f64]) -> Result<()> {
        self.check_rows(x.len())?;
        self.check_rows(y.len())?;
        self.check_nothing_cut()?;
        self.setup()?;
        let compliance = self.model.contact.compliance.iter().chain(&self.model.equalities.compliance);
        y.iter_mut().zip(x).zip(compliance).for_each(|((y, x), c)| *y = c * x);
        let contact = self.model.contact.len();
        for ready in &self.prepared.done(&self.model)?.islands {
            let (scaling, place) = (&ready.rows.scaling, |i| in_stack(&ready.island, contact, i));
            let forces = scaling.forces_to_dual(|i| place(i).map_or(0.0, |at| x[at]))?;
            let mut image = zeros(forces.len(), "a product with F")?;
            ready.dual.try_apply(&forces, &mut image)?;
            for (i, length) in scaling.lengths_to_host(&image) {
                place(i).into_iter().for_each(|at| y[at] = length);
            }
        }
        Ok(())
    }

    /// `d = B K+ f - c` of (13), contact rows first, length; -infinity for rows that never close.
    pub fn dual_rhs(&mut self, d: &mut [f64]) -> Result<()> {
        self.check_rows(d.len())?;
        self.check_nothing_cut()?;
        self.setup()?;
        let gaps = self.model.contact.rhs.iter().chain(&self.model.equalities.rhs);
        d.iter_mut().zip(gaps).for_each(|(d, c)| *d = -c);
        let contact = self.model.contact.len();
        for ready in &self.prepared.done(&self.model)?.islands {
            let mut load = ready.island.loads(&self.model)?;
            load.iter_mut().for_each(|f| *f /= ready.island.unit);
            let moved = ready.moved(self.model.threads(), &load)?;
            let moved = ready.dual.rhs(&moved, &vec![0.0; ready.rows.groups()]);
            for (i, length) in ready.rows.scaling.lengths_to_host(&moved) {
                in_stack(&ready.island, contact, i).into_iter().for_each(|at| d[at] += length);
            }
        }
        Ok(())
    }

    /// F is not available if bodies are cut or glued: it would be F of the pieces, including rows of the glue.
    fn check_nothing_cut(&self) -> Result<()> {
        (0..self.model.bodies.len()).try_for_each(|body| self.check_whole_body(body))?;
        if self.model.shares_numbers() {
            let what = "unknowns with the same number are glued by internal rows: F would include these rows";
            return Err(Error::new(Kind::State, what));
        }
        Ok(())
    }

    fn check_rows(&self, m: usize) -> Result<()> {
        let expected = self.model.contact.len() + self.model.equalities.len();
        if m == expected {
            return Ok(());
        }
        let what = format!("the problem has {expected} rows, not {m}");
        Err(Error::argument("m", what).value(m as f64).limit(expected as f64))
    }
}

/// Index of row i of an island among all contact rows, then all equality rows of the host; none for a tangential row.
fn in_stack(island: &Island, contact: usize, i: usize) -> Option<usize> {
    (island.kind_and_row(i).0 != RowKind::Tangential).then(|| island.in_stack(contact, i))
}
