//! What the host has registered. Every call checks first and keeps all or nothing.

use std::ops::Range;
use std::sync::Arc;

use crate::body::{
    same_vectors, Body, Coordinates, Form, GeneralizedInverse, Modes, NullSpaceInput, Symbolic,
};
use crate::constraints::{RowKind, RowSet, RowsInput};
use crate::dual::Kept;
use crate::error::{Error, Kind, Result};
use crate::linalg::vector::first_non_finite;
use crate::linalg::Matrix;
use crate::platform::memory::copied;
use crate::solver::findings::Findings;
use crate::solver::numbering::Numbering;
use crate::solver::phases::Phases;
use crate::solver::report::{Counts, Report, Work};
use crate::solver::results::{Answer, Asked};
use crate::solver::setup::Setup;
use crate::solver::state::History;
use crate::solver::watch::Host;
use crate::solver::Settings;

/// Bodies, rows and options of one contact problem, its factors, and the answer of its last solve.
pub struct Problem {
    pub(super) settings: Settings,
    pub(super) bodies: Vec<BodySlot>,
    /// First unknown of every body among all, and their end, at most i64::MAX.
    pub(super) offsets: Vec<usize>,
    pub(super) contact: RowSet,
    pub(super) equalities: RowSet,
    pub(super) numbering: Numbering,
    pub(super) ready: Option<Setup>,
    pub(super) answer: Option<Arc<Answer>>,
    pub(super) findings: Option<Findings>,
    pub(super) asked: Asked,
    /// Bodies have operators of the rows before, of use for some of their rows.
    operators_kept: bool,
    pub(super) history: History,
    pub(super) host: Host,
    pub(super) work: Work,
    pub(super) phases: Phases,
}

/// A body with its factors, as long as they belong to its matrix.
#[derive(Default)]
pub(super) struct BodySlot {
    pub body: Body,
    /// How its matrix was given.
    pub form: Option<Form>,
    /// The host has rewritten the values it keeps, and they were refused: there is no matrix.
    pub spoiled: bool,
    /// The host's numbers of its unknowns.
    pub numbers: Option<Vec<usize>>,
    pub inverse: Option<Inverse>,
    /// The last analysis of a matrix with the pattern of this one.
    pub symbolic: Option<Arc<Symbolic>>,
    /// Keys of pattern and values, once they have been asked for.
    pub keys: Option<[u64; 2]>,
}

/// `K_p+` of the matrix divided by `unit`, the power of two below its largest diagonal entry, and the bytes it takes;
/// equal bodies have one.
pub(super) struct Inverse {
    pub unit: f64,
    pub kplus: Arc<GeneralizedInverse>,
    /// Unknowns of the matrix that the certificate measures by themselves, ascending.
    pub grounded: Arc<[u32]>,
    pub bytes: usize,
    /// `F_p` of the rows before the present ones, while there is no dual problem.
    pub operator: Option<Kept>,
}

impl Problem {
    pub fn new() -> Self {
        Self {
            settings: Settings::new(),
            bodies: Vec::new(),
            offsets: vec![0],
            contact: RowSet::default(),
            equalities: RowSet::default(),
            numbering: Numbering::default(),
            ready: None,
            answer: None,
            findings: None,
            asked: Asked::default(),
            operators_kept: false,
            history: History::default(),
            host: Host::default(),
            work: Work::default(),
            phases: Phases::default(),
        }
    }

    pub fn settings(&self) -> &Settings {
        &self.settings
    }

    pub fn set_f64(&mut self, name: &str, value: f64) -> Result<()> {
        self.settings.set_f64(name, value)
    }

    pub fn set_i64(&mut self, name: &str, value: i64) -> Result<()> {
        self.settings.set_i64(name, value)
    }

    pub fn set_str(&mut self, name: &str, value: &str) -> Result<()> {
        self.settings.set_str(name, value)
    }

    /// Sets options by a text such as `tolerance=1e-8 threads=4`: all of them or none.
    pub fn set_text(&mut self, text: &str) -> Result<()> {
        self.settings.set_text(text)
    }

    pub fn get_f64(&self, name: &str) -> Result<f64> {
        self.settings.get_f64(name)
    }

    pub fn get_i64(&self, name: &str) -> Result<i64> {
        self.settings.get_i64(name)
    }

    pub fn get_str(&self, name: &str) -> Result<String> {
        self.settings.get_str(name)
    }

    /// Adds a body with `n` unknowns and returns its number.
    pub fn add_body(&mut self, n: usize) -> Result<usize> {
        if n == 0 {
            return Err(Error::argument("n", "a body has at least one unknown").value(0.0).limit(1.0));
        }
        let first = self.counts().dofs;
        let most = i64::MAX as usize - first;
        if n > most {
            let what = "the unknowns of all bodies together exceed 64 bits";
            return Err(Error::new(Kind::Overflow, what)
                .body(self.bodies.len())
                .value(n as f64)
                .limit(most as f64));
        }
        self.rows_changed();
        self.offsets.push(first + n);
        self.bodies.push(BodySlot { body: Body { order: n, ..Body::default() }, ..BodySlot::default() });
        Ok(self.bodies.len() - 1)
    }

    /// Number of unknowns of a body.
    pub fn order(&self, body: usize) -> Result<usize> {
        self.slot(body).map(|slot| slot.body.order)
    }

    /// R, n x r column-major with leading dimension `ldr`; r = 0 and exact claims that K is not singular.
    pub fn set_null_space(
        &mut self,
        body: usize,
        n: usize,
        r: usize,
        basis: &[f64],
        ldr: usize,
        modes: Modes,
    ) -> Result<()> {
        self.check_length(body, "n", n)?;
        if r > n {
            return Err(Error::argument("r", format!("{r} null vectors of {n} unknowns"))
                .body(body)
                .value(r as f64)
                .limit(n as f64));
        }
        if r > 0 {
            check_ld("ldr", ldr, n).map_err(|e| e.body(body))?;
        }
        let mut vectors = Matrix::zeros(n, r)?;
        for j in 0..r {
            let column = &basis[j * ldr..j * ldr + n];
            if let Some(dof) = first_non_finite(column) {
                let what = "the entry is not a finite number";
                return Err(Error::argument("basis", what).body(body).dof(dof).entry(j * ldr + dof));
            }
            vectors.col_mut(j).copy_from_slice(column);
        }
        let given = NullSpaceInput { vectors, modes };
        let old = self.slot(body)?.body.null_space.as_ref();
        let unchanged = old.is_some_and(|old| same_vectors(old, &given));
        self.changed(body, unchanged)?.body.null_space = Some(given);
        Ok(())
    }

    /// The dofs held in K+ of (15) instead of those the library would choose; none: its own choice again. They
    /// change neither forces nor displacements, only the course of the methods in paper units.
    pub fn set_fixing(&mut self, body: usize, dofs: Option<&[usize]>) -> Result<()> {
        let order = self.order(body)?;
        let beyond = dofs.into_iter().flatten().enumerate().find(|(_, dof)| **dof >= order);
        if let Some((entry, &dof)) = beyond {
            let what = format!("the dof is outside the {order} unknowns");
            return Err(Error::argument("dof", what)
                .body(body)
                .entry(entry)
                .index(dof as i64)
                .limit(order as f64));
        }
        let unchanged = self.slot(body)?.body.fixing.as_deref() == dofs;
        let slot = self.changed(body, unchanged)?;
        slot.body.fixing = dofs.map(<[usize]>::to_vec);
        slot.symbolic.take_if(|_| !unchanged);
        Ok(())
    }

    /// Node, direction and position of every dof; `xyz[k + ld i]` is coordinate k < dim of dof i.
    pub fn set_coordinates(
        &mut self,
        body: usize,
        dim: usize,
        node: &[i32],
        dir: &[i32],
        xyz: &[f64],
        ld: usize,
    ) -> Result<()> {
        self.check_length(body, "n", node.len())?;
        if !(1..=3).contains(&dim) {
            return Err(Error::argument("dim", "space has 1, 2 or 3 dimensions")
                .body(body)
                .value(dim as f64));
        }
        check_ld("ld", ld, dim).map_err(|e| e.body(body))?;
        let coordinates = Coordinates::new(dim, dir, xyz, ld).map_err(|e| e.body(body))?;
        let old = self.slot(body)?.body.coordinates.as_ref();
        let unchanged = old.is_some_and(|old| old.same(&coordinates));
        self.changed(body, unchanged)?.body.coordinates = Some(coordinates);
        Ok(())
    }

    /// `f_p`, length n, force.
    pub fn set_load(&mut self, body: usize, f: &[f64]) -> Result<()> {
        self.check_length(body, "n", f.len())?;
        if let Some(dof) = first_non_finite(f) {
            return Err(Error::argument("f", "the entry is not a finite number").body(body).entry(dof));
        }
        self.bodies[body].body.load = Some(copied(f, "a load")?);
        Ok(())
    }

    /// Adds rows and returns the number of the first among those of its kind. Without `body` they go by the host's numbers
    /// of the unknowns, where there are some.
    pub fn add_rows(&mut self, kind: RowKind, rows: RowsInput<'_>) -> Result<usize> {
        let places = match rows.body {
            Some(_) => None,
            None => self.places_of(rows.ptr, rows.dof)?,
        };
        let rows = RowsInput { dof: places.as_deref().unwrap_or(rows.dof), ..rows };
        let present = match kind {
            RowKind::Inequality => &mut self.contact,
            RowKind::Equality => &mut self.equalities,
        };
        let first = present.add(kind, rows, &self.offsets)?;
        self.rows_changed();
        Ok(first)
    }

    /// New right-hand sides c or h, length; a contact row whose gap is +infinity never closes.
    pub fn set_rhs(&mut self, kind: RowKind, first: usize, rhs: &[f64]) -> Result<()> {
        if self.rows_mut(kind).set_rhs(kind, first, rhs)? {
            self.forget_dual();
        }
        Ok(())
    }

    /// Rows from `first` on as springs, `B u - c <= lambda/k`, `H u - h = mu/k`: 1/k >= 0, length / force, 0 for
    /// rigid ones. The multipliers of the last solve still fit as a start.
    pub fn set_compliance(&mut self, kind: RowKind, first: usize, inv_k: &[f64]) -> Result<()> {
        self.rows_mut(kind).set_compliance(first, inv_k)?;
        self.forget_dual();
        Ok(())
    }

    /// Drops all rows of one kind.
    pub fn clear_rows(&mut self, kind: RowKind) {
        *self.rows_mut(kind) = RowSet::default();
        self.rows_changed();
    }

    pub fn counts(&self) -> Counts {
        Counts {
            bodies: self.bodies.len(),
            dofs: self.offsets[self.bodies.len()],
            rows: self.contact.len(),
            equalities: self.equalities.len(),
        }
    }

    /// Report of the last solve that gave an answer.
    pub fn report(&self) -> Option<&Report> {
        self.answer.as_ref().map(|answer| &answer.report)
    }

    pub(super) fn rows(&self, kind: RowKind) -> &RowSet {
        match kind {
            RowKind::Inequality => &self.contact,
            RowKind::Equality => &self.equalities,
        }
    }

    fn rows_mut(&mut self, kind: RowKind) -> &mut RowSet {
        match kind {
            RowKind::Inequality => &mut self.contact,
            RowKind::Equality => &mut self.equalities,
        }
    }

    pub(super) fn slot(&self, body: usize) -> Result<&BodySlot> {
        self.bodies.get(body).ok_or_else(|| no_body(body, self.bodies.len()))
    }

    /// The body, about to get new data: dual and answer no longer hold, nor do its factors, unless the data are those
    /// it has.
    pub(super) fn changed(&mut self, body: usize, unchanged: bool) -> Result<&mut BodySlot> {
        self.forget_dual();
        self.history.data_changed();
        if !unchanged && std::mem::take(&mut self.operators_kept) {
            let inverses = self.bodies.iter_mut().filter_map(|slot| slot.inverse.as_mut());
            inverses.filter_map(|inverse| inverse.operator.as_mut()).for_each(Kept::only_whole);
        }
        let bodies = self.bodies.len();
        let slot = self.bodies.get_mut(body).ok_or_else(|| no_body(body, bodies))?;
        slot.inverse.take_if(|_| !unchanged);
        Ok(slot)
    }

    /// What was computed for the rows is kept for those to come.
    pub(super) fn forget_dual(&mut self) {
        self.operators_kept |= self.ready.is_some();
        for ready in self.ready.take().into_iter().flat_map(|setup| setup.islands) {
            for (p, operator) in ready.island.bodies.into_iter().zip(ready.dual.into_operators()) {
                if let Some(inverse) = &mut self.bodies[p].inverse {
                    inverse.operator = operator;
                }
            }
        }
        self.answer = None;
        self.asked = Asked::default();
    }

    /// Takes over the bodies with their numbers, rows and options of another problem; texts count from what they did.
    pub(super) fn adopt(&mut self, other: Self) {
        self.rows_changed();
        let index_base = self.settings.index_base;
        self.settings = Settings { index_base, ..other.settings };
        (self.contact, self.equalities) = (other.contact, other.equalities);
        (self.bodies, self.offsets, self.numbering) = (other.bodies, other.offsets, other.numbering);
    }

    fn rows_changed(&mut self) {
        self.forget_dual();
        self.history.rows_changed();
    }

    pub(super) fn check_length(&self, body: usize, argument: &'static str, n: usize) -> Result<()> {
        let order = self.order(body)?;
        if n == order {
            return Ok(());
        }
        Err(Error::argument(argument, format!("the body has {order} unknowns, not {n}"))
            .body(body)
            .value(n as f64)
            .limit(order as f64))
    }

    /// Unknowns of a body among all.
    pub(super) fn range(&self, body: usize) -> Range<usize> {
        self.offsets[body]..self.offsets[body + 1]
    }
}

impl Default for Problem {
    fn default() -> Self {
        Self::new()
    }
}

fn no_body(body: usize, bodies: usize) -> Error {
    Error::argument("body", format!("there are {bodies} bodies")).body(body).index(body as i64)
}

pub(super) fn check_ld(name: &'static str, ld: usize, least: usize) -> Result<()> {
    if ld >= least {
        return Ok(());
    }
    Err(Error::argument(name, format!("the leading dimension {ld} is less than {least}"))
        .value(ld as f64)
        .limit(least as f64))
}
