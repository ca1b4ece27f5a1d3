//! The host's table of unknowns: arrays over all unknowns of the table, and rows that name them.

use std::sync::Arc;

use crate::constraints::{
    DofTable, DofTableInput, Friction, FrictionInput, OwnedRows, RowKind, RowSet, RowsInput, Table,
};
use crate::error::{Error, Kind, Result};
use crate::linalg::vector::first_non_finite;
use crate::model::host::HostModel;
use crate::platform::memory::zeros;

impl HostModel {
    pub fn set_dof_table(&mut self, input: DofTableInput<'_>) -> Result<()> {
        let is_numbered = self.is_numbered()?;
        let place = |number: usize| match is_numbered {
            true => self.unknowns.get(&number).map(|(body, dof)| self.offsets[*body] + dof),
            false => Some(number).filter(|number| *number < self.sizes().dofs),
        };
        let dofs = DofTable::resolve(input, place)?;
        self.pairs.check_table(dofs.len())?;
        let old = self.table.as_deref();
        let has_other_terms = old.is_some_and(|old| old.dofs.terms != dofs.terms);
        let table = Table::new(dofs, old)?;
        let contact = self.rows_by(&table, RowKind::Inequality)?;
        let equalities = self.rows_by(&table, RowKind::Equality)?;
        let friction = self.friction_by(&table, &contact)?;
        let contents = &mut self.contents;
        if has_other_terms {
            (contents.contact, contents.equalities, contents.friction) = (contact, equalities, friction);
            self.revisions.rows += 1;
        } else {
            let turned = [
                contents.contact.set_rhs(RowKind::Inequality, 0, &contact.rhs)?,
                contents.equalities.set_rhs(RowKind::Equality, 0, &equalities.rhs)?,
                contents.friction.set_reference(0, friction.len(), friction.dim, &friction.rows.rhs)?,
            ];
            self.revisions.laws += u64::from(turned.contains(&true));
        }
        self.table = Some(Arc::new(table));
        Ok(())
    }

    /// The rows of a kind by another table.
    fn rows_by(&self, table: &Table, kind: RowKind) -> Result<RowSet> {
        let (rows, mut fresh) = (self.rows(kind), RowSet::default());
        fresh.add(kind, resolved(table, rows, kind).input(), &WITH_NAMED)?;
        self.take_over(rows, &mut fresh, |row| !table.has(kind, row));
        Ok(fresh)
    }

    fn friction_by(&self, table: &Table, contact: &RowSet) -> Result<Friction> {
        let (own, mut fresh) = (&self.friction, Friction::default());
        if own.len() == 0 {
            return Ok(fresh);
        }
        let normal: Vec<i64> =
            own.nodes.iter().map(|node| node.normal.map_or(-1, |row| row as i64)).collect();
        let coefficient: Vec<f64> = own.nodes.iter().map(|node| node.coefficient).collect();
        let bound: Vec<f64> = own.nodes.iter().map(|node| node.bound).collect();
        let rows = resolved(table, &own.rows, RowKind::Tangential);
        let (coefficient, bound) = (Some(&coefficient[..]), Some(&bound[..]));
        let input = FrictionInput { dim: own.dim, normal: &normal, rows: rows.input(), coefficient, bound };
        fresh.add(input, contact, &WITH_NAMED)?;
        self.take_over(&own.rows, &mut fresh.rows, |row| !table.has(RowKind::Tangential, row));
        Ok(fresh)
    }

    /// Compliances of rows, and what was taken from them.
    fn take_over(&self, of: &RowSet, fresh: &mut RowSet, is_same: impl Fn(usize) -> bool) {
        fresh.compliance = Arc::clone(&of.compliance);
        fresh.keep_taken(of, is_same);
        Arc::make_mut(&mut fresh.matrix).cols = self.sizes().dofs;
    }

    /// Refuses changes of the unknowns that the table names.
    pub(super) fn check_no_table(&self) -> Result<()> {
        match self.table {
            None => Ok(()),
            Some(_) => {
                let what = "the table of unknowns counts those of the bodies: add bodies and set numbers before feti_dof_table";
                Err(Error::new(Kind::State, what))
            }
        }
    }

    /// Rows without bodies over the unknowns of all bodies: whole rows if there is a table, otherwise places if there are numbers.
    pub(super) fn named(&self, rows: RowsInput<'_>) -> Result<(Option<OwnedRows>, Option<Vec<i64>>)> {
        match (rows.body, &self.table) {
            (Some(_), _) => Ok((None, None)),
            (None, Some(table)) => Ok((Some(table.resolved(rows)?), None)),
            (None, None) => Ok((None, self.places_of(rows.ptr, rows.dof)?)),
        }
    }

    /// Right-hand sides of rows from `first` on, for the unknowns of all bodies.
    pub(super) fn by_table(&self, kind: RowKind, first: usize, rhs: &[f64]) -> Option<Vec<f64>> {
        self.table.as_ref().map(|table| table.right_hand_sides(kind, first, rhs))
    }

    pub(super) fn keep_tabled(&mut self, kind: RowKind, first: usize, rows: RowsInput<'_>, is_tabled: bool) {
        if let Some(table) = self.table.as_mut().filter(|_| is_tabled) {
            Arc::make_mut(table).keep(kind, first, rows);
        }
    }

    pub(super) fn keep_right_hand_sides(&mut self, kind: RowKind, first: usize, rhs: &[f64]) {
        if let Some(table) = &mut self.table {
            Arc::make_mut(table).keep_right_hand_sides(kind, first, rhs);
        }
    }

    /// Rows of the kind from `first` on are gone.
    pub(super) fn forget_tabled(&mut self, kind: RowKind, first: usize) {
        if let Some(table) = &mut self.table {
            Arc::make_mut(table).keep_before(kind, first);
        }
    }

    /// Sets `T'f`, where f has the unknowns of the table.
    pub(super) fn set_loads_by(&mut self, table: &Table, f: &[f64]) -> Result<()> {
        let f = &f[..table.dofs.len()];
        if let Some(at) = first_non_finite(f) {
            return Err(Error::argument("f", "the entry is not a finite number").entry(at));
        }
        let mut loads = zeros(self.sizes().dofs, "the loads")?;
        table.dofs.terms.mul_transposed_add(1.0, f, &mut loads);
        for (body, given) in self.contents.bodies.iter_mut().enumerate() {
            given.body.load =
                Some(loads[self.contents.offsets[body]..self.contents.offsets[body + 1]].into());
        }
        Ok(())
    }

    /// s_old := `reached`, the slips in the unknowns of all bodies.
    pub fn commit_reference(&mut self, mut reached: Vec<f64>) -> Result<()> {
        let friction = &mut self.contents.friction;
        let turned = friction.set_reference(0, friction.len(), friction.dim, &reached)?;
        self.revisions.laws += u64::from(turned);
        if let Some(table) = &mut self.table {
            table.add_constants(RowKind::Tangential, &mut reached);
            Arc::make_mut(table).keep_right_hand_sides(RowKind::Tangential, 0, &reached);
        }
        Ok(())
    }

    /// Calls `to` with the position and the displacement of every unknown of the host; `u` is that of all bodies, one after the other.
    pub fn spread_displacement(&self, u: &[f64], mut to: impl FnMut(usize, f64)) -> Result<()> {
        match &self.table {
            None => self.spread(u, to),
            Some(table) => {
                (0..table.dofs.len()).for_each(|i| to(i, table.dofs.value(i, u)));
                Ok(())
            }
        }
    }

    /// Calls `to` with the position and the force on every unknown of the host: `push` acts on all bodies, one after the other; rows of the
    /// table that have these multipliers act on unknowns of the table.
    pub fn spread_reaction(
        &self,
        push: Vec<f64>,
        multipliers: &[(RowKind, &[f64])],
        mut to: impl FnMut(usize, f64),
    ) -> Result<()> {
        let mut push = self.summed(push)?;
        let Some(table) = &self.table else { return self.spread(&push, to) };
        let dofs = &table.dofs;
        let mut eliminated = zeros(dofs.len(), "a reaction")?;
        for (kind, multipliers) in multipliers {
            for (row, entries, _) in table.rows(*kind) {
                for (i, b) in entries.into_iter().filter(|(i, _)| dofs.places[*i].is_none()) {
                    eliminated[i] -= b * multipliers[row];
                    dofs.terms.row(i).for_each(|(place, t)| push[place] += b * t * multipliers[row]);
                }
            }
        }
        for (i, place) in dofs.places.iter().enumerate() {
            to(i, place.map_or(eliminated[i], |place| push[place]));
        }
        Ok(())
    }
}

/// Rows may name unknowns of other ranks.
pub(super) const WITH_NAMED: [usize; 2] = [0, usize::MAX];

/// All rows of a kind, those of the table by another one.
fn resolved(table: &Table, rows: &RowSet, kind: RowKind) -> OwnedRows {
    let mut all = OwnedRows::default();
    for row in 0..rows.len() {
        if !table.row(kind, row, &mut all) {
            all.push(rows.matrix.row(row), rows.rhs[row]);
        }
    }
    all
}
