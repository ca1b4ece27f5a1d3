//! Operators that the host can verify: null spaces, K+, F, d.

use std::borrow::Cow;

use crate::constraints::RowKind;
use crate::error::{Error, Kind, Result};
use crate::linalg::{Matrix, Operator};
use crate::platform::memory::zeros;
use crate::setup::Island;
use crate::solve::local::{FromLoad, Scale};
use crate::solve::Case;
use crate::solver::decomposed::null_space_of;
use crate::solver::joined::Role;
use crate::solver::made::MadePart;
use crate::solver::problem::Problem;

impl Problem {
    /// The parts of a body and their K+, after a setup; a body that is cut is refused. Of a problem of several ranks only a call of all
    /// makes the setup.
    fn set_up_parts(&mut self, body: usize) -> Result<Vec<MadePart<'_>>> {
        self.check_whole_body(body)?;
        if self.check_alone().is_ok() {
            self.setup()?;
        }
        let made = self.made(body);
        if made.is_empty() {
            let what = "K+ of this body has not been made on this rank: feti_setup, on all ranks, makes it";
            return Err(Error::new(Kind::State, what).body(body));
        }
        Ok(made)
    }

    /// Sets up what only a rank that has the whole problem can give.
    fn set_up_alone(&mut self) -> Result<()> {
        self.check_alone()?;
        self.setup()?;
        self.check_alone()
    }

    /// Dimension r of the null space of a body and its basis as the library uses it: n x r column-major, part after part,
    /// and orthonormal in the metric of diag K / 2^p of each part.
    pub fn null_space(&mut self, body: usize) -> Result<(usize, Cow<'_, [f64]>)> {
        let order = self.model.order(body)?;
        if self.model.bodies[body].body.assembled().is_some() {
            self.set_up_alone()?;
            let basis = self.parts().and_then(|parts| null_space_of(&self.prepared, parts, body));
            let missing = || Error::new(Kind::Internal, "the setup left a body without null space");
            return basis.map(|basis| (basis.cols, Cow::from(&basis.data))).ok_or_else(missing);
        }
        let parts = self.set_up_parts(body)?;
        let mut all = Matrix::zeros(order, 0)?;
        for part in &parts {
            let own = part.kplus().bring_null_space()?;
            if own.rows == order {
                let own = own.into_owned();
                return Ok((own.cols, Cow::from(own.data)));
            }
            for j in 0..own.cols {
                let mut column = zeros(order, "a null space")?;
                own.col(j).iter().enumerate().for_each(|(i, v)| column[part.place(i)] = *v);
                all.push_col(&column);
            }
        }
        Ok((all.cols, Cow::from(all.data)))
    }

    /// Gap of a null space that the library found: ratio of the softest other motion to its stiffest in the metric of
    /// diag K, both at least 1e-14 of the largest, the least of all parts; none if the host gave vectors or coordinates.
    pub fn null_space_gap(&mut self, body: usize) -> Result<Option<f64>> {
        if self.model.given(body)?.body.assembled().is_some() {
            return Ok(None);
        }
        let parts = self.set_up_parts(body)?;
        Ok(parts.iter().filter_map(|part| part.kplus().gap).reduce(f64::min))
    }

    /// The r dofs held in K+ of (14)-(15), part after part; not known for a K+ of the host.
    pub fn fixing_dofs(&mut self, body: usize) -> Result<Vec<usize>> {
        if self.model.given(body)?.body.operator().is_some() {
            let what = "K+ of this body is given by the host: its fixing dofs are not known";
            return Err(Error::new(Kind::Unsupported, what).body(body));
        }
        let parts = self.set_up_parts(body)?;
        let held = |part: &MadePart| part.kplus().fixing.iter().map(|&i| part.place(i)).collect::<Vec<_>>();
        Ok(parts.iter().flat_map(held).collect())
    }

    /// `y = K_p+ x`, x force, y length; 0 at unknowns without stiffness that belong to no part.
    pub fn kplus(&mut self, body: usize, x: &[f64], y: &mut [f64]) -> Result<()> {
        self.model.check_length(body, "n", x.len())?;
        self.model.check_length(body, "n", y.len())?;
        let parts = self.set_up_parts(body)?;
        let mut all = zeros(y.len(), "a product with K+")?;
        for part in &parts {
            let places = || (0..part.kplus().order()).map(|i| part.place(i));
            let mut own: Vec<f64> = places().map(|i| x[i]).collect();
            part.kplus().apply_in_place(&mut own)?;
            places().zip(&own).for_each(|(i, v)| all[i] = v / part.inverse.unit);
        }
        y.copy_from_slice(&all);
        Ok(())
    }

    /// `y = F x` of (12), including the compliance of the rows, contact rows first; x force, y length. y = 0 for rows
    /// that never close, and their x is ignored. Tangential rows are not included.
    pub fn dual_apply(&mut self, x: &[f64], y: &mut [f64]) -> Result<()> {
        self.check_rows(x.len())?;
        self.check_rows(y.len())?;
        self.check_nothing_cut()?;
        self.set_up_alone()?;
        if let Some((all, rows)) = self.in_order() {
            let own: Vec<f64> = rows.iter().map(|row| x[*row]).collect();
            let mut image = zeros(own.len(), "a product with F")?;
            all.dual_apply(&own, &mut image)?;
            rows.into_iter().zip(image).for_each(|(row, v)| y[row] = v);
            return Ok(());
        }
        let compliance = self.model.contact.compliance.iter().chain(&*self.model.equalities.compliance);
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
        self.set_up_alone()?;
        if let Some((all, rows)) = self.in_order() {
            let mut lengths = zeros(rows.len(), "the load of the dual problem")?;
            all.dual_rhs(&mut lengths)?;
            rows.into_iter().zip(lengths).for_each(|(row, v)| d[row] = v);
            return Ok(());
        }
        let gaps = self.model.contact.rhs.iter().chain(&self.model.equalities.rhs);
        d.iter_mut().zip(gaps).for_each(|(d, c)| *d = -c);
        let contact = self.model.contact.len();
        for ready in &self.prepared.done(&self.model)?.islands {
            let case = Case { model: self.solved(), prepared: &self.prepared, ready, method: None };
            let bodies = case.locals()?;
            let (_, load) = bodies.make(|_| Scale, &case.loads()?)?;
            let moved: Vec<_> = bodies.ask(|_| FromLoad, &load)?.into_iter().map(|of| of.moved).collect();
            let moved = ready.dual.rhs(&moved, &vec![0.0; ready.rows.groups()]);
            for (i, length) in ready.rows.scaling.lengths_to_host(&moved) {
                in_stack(&ready.island, contact, i).into_iter().for_each(|at| d[at] += length);
            }
        }
        Ok(())
    }

    /// The problem in the order of several ranks, if the only one solves it so, and for each row there its number here, contact rows first.
    fn in_order(&mut self) -> Option<(&mut Self, Vec<usize>)> {
        let Some(Role::Leads(leader)) = self.joined.as_deref().map(|joined| &joined.role) else {
            return None;
        };
        leader.told.as_ref()?;
        let (contact, [inequalities, equalities, _]) = (self.model.contact.len(), &leader.order.rows);
        let equalities = equalities.iter().map(|at| contact + at.number);
        let rows = inequalities.iter().map(|at| at.number).chain(equalities).collect();
        Some((self.all.as_deref_mut()?, rows))
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
