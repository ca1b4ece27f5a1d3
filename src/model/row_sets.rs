//! Contact rows and equality rows: added, changed, removed.

use std::sync::Arc;

use crate::constraints::{entries, Friction, FrictionInput, OwnedRows, RowKind, RowsInput};
use crate::error::{Error, Proof, Result};
use crate::model::contents::{Counted, SolvedModel};
use crate::model::host::HostModel;
use crate::model::tables::WITH_NAMED;
use crate::platform::memory::{self, Headroom};

/// Bytes per entry of B and H: the host's rows, the scaled rows and the rows by bodies, with room for growth.
pub const PER_ENTRY: usize = 128;

impl HostModel {
    pub fn add_rows(&mut self, kind: RowKind, rows: RowsInput<'_>) -> Result<usize> {
        let given = rows;
        let (resolved, places) = self.named(given)?;
        let rows = resolved.as_ref().map_or(given, OwnedRows::input);
        let rows = RowsInput { dof: places.as_deref().unwrap_or(rows.dof), ..rows };
        let (all, end, is_named) = ([0, usize::MAX], self.sizes().dofs, self.has_others && places.is_some());
        let offsets = std::mem::take(&mut self.offsets);
        let set = self.rows_mut(kind);
        let added = set.add(kind, rows, if is_named { &all } else { &offsets });
        if let Some(first) = added.iter().copied().find(|_| is_named) {
            set.name(first);
            Arc::make_mut(&mut set.matrix).cols = end;
        }
        self.offsets = offsets;
        let first = added?;
        self.keep_tabled(kind, first, given, resolved.is_some());
        self.revisions.rows += 1;
        Ok(first)
    }

    pub fn set_rhs(&mut self, kind: RowKind, first: usize, rhs: &[f64]) -> Result<()> {
        let by_table = self.by_table(kind, first, rhs);
        if self.rows_mut(kind).set_rhs(kind, first, by_table.as_deref().unwrap_or(rhs))? {
            self.revisions.laws += 1;
        }
        self.keep_right_hand_sides(kind, first, rhs);
        Ok(())
    }

    pub fn set_compliance(&mut self, kind: RowKind, first: usize, inv_k: &[f64]) -> Result<()> {
        self.rows_mut(kind).set_compliance(first, inv_k)?;
        self.revisions.laws += 1;
        Ok(())
    }

    pub fn clear_rows(&mut self, kind: RowKind) {
        if kind != RowKind::Tangential {
            let own = self.rows_of_pairs(kind);
            self.rows_mut(kind).keep_first(own);
            self.forget_tabled(kind, own);
        }
        if kind != RowKind::Equality {
            self.clear_friction();
        }
        self.revisions.rows += 1;
    }

    pub fn add_friction(&mut self, input: FrictionInput) -> Result<usize> {
        self.add_nodes(input, true)
    }

    /// Nodes of a problem file, whose rows a table may have changed: they tell nothing of factors.
    pub fn add_friction_of_file(&mut self, input: FrictionInput) -> Result<usize> {
        self.add_nodes(input, false)
    }

    fn add_nodes(&mut self, input: FrictionInput, are_given: bool) -> Result<usize> {
        let given = input.rows;
        let (resolved, places) = self.named(given)?;
        let rows = resolved.as_ref().map_or(given, OwnedRows::input);
        let rows = RowsInput { dof: places.as_deref().unwrap_or(rows.dof), ..rows };
        let (all, end, is_named) = ([0, usize::MAX], self.sizes().dofs, self.has_others && places.is_some());
        let SolvedModel { friction, contact, offsets, .. } = &mut self.contents;
        let of = if is_named { &all[..] } else { &offsets[..] };
        // before the table takes entries from the rows, which then tell nothing of factors
        match self.table.as_ref().filter(|_| resolved.is_some()) {
            _ if !are_given => {}
            Some(table) => {
                Friction::check_factors(input, |row| table.entries(RowKind::Inequality, row), &WITH_NAMED)?;
            }
            None => {
                Friction::check_factors(FrictionInput { rows, ..input }, |row| entries(contact, row), of)?;
            }
        }
        let first = friction.add(FrictionInput { rows, ..input }, contact, of)?;
        if is_named {
            friction.rows.name(first * friction.dim);
            Arc::make_mut(&mut friction.rows.matrix).cols = end;
        }
        self.keep_tabled(RowKind::Tangential, first * input.dim, given, resolved.is_some());
        self.revisions.rows += 1;
        Ok(first)
    }

    pub fn set_friction_law(
        &mut self,
        first: usize,
        count: usize,
        coefficient: Option<&[f64]>,
        bound: Option<&[f64]>,
    ) -> Result<()> {
        let SolvedModel { friction, contact, .. } = &mut self.contents;
        if friction.set_law(first, count, coefficient, bound, contact)? {
            self.revisions.laws += 1;
        }
        Ok(())
    }

    pub fn set_friction_compliance(&mut self, first: usize, inv_kt: &[f64]) -> Result<()> {
        self.friction.set_compliance(first, inv_kt)?;
        self.revisions.laws += 1;
        Ok(())
    }

    pub fn set_friction_reference(
        &mut self,
        first: usize,
        count: usize,
        dim: usize,
        s_old: &[f64],
    ) -> Result<()> {
        let row = first.saturating_mul(self.friction.dim);
        let by_table = self.by_table(RowKind::Tangential, row, s_old);
        if self.friction.set_reference(first, count, dim, by_table.as_deref().unwrap_or(s_old))? {
            self.revisions.laws += 1;
        }
        self.keep_right_hand_sides(RowKind::Tangential, row, s_old);
        Ok(())
    }

    pub fn check_friction_nodes(&self, first: usize, count: usize, dim: usize) -> Result<()> {
        self.friction.check_nodes(first, count)?;
        self.friction.check_dim(dim, count)
    }

    pub fn clear_friction(&mut self) {
        let own = self.rows_of_pairs(RowKind::Tangential);
        self.forget_tabled(RowKind::Tangential, own * self.friction.dim);
        self.friction.keep_first(own);
        self.revisions.rows += 1;
    }

    pub fn headroom_for_rows(&self, rows: usize, entries: usize) -> Result<Headroom> {
        let present = RowKind::ALL.iter().map(|kind| self.rows(*kind).matrix.col.len()).max().unwrap_or(0);
        let bytes = present.saturating_add(entries).saturating_mul(PER_ENTRY);
        memory::headroom(bytes.saturating_add(rows.saturating_mul(PER_ENTRY)), "constraint rows")
    }
}

/// Turns the error of a row without entries into a proof of contradiction; `first` is the position of its kind in the
/// stack.
pub fn empty_row_contradicts(error: Error, first: usize) -> Error {
    let (Some(row), Some(gap)) = (error.place.row, error.place.value) else { return error };
    error.proved_by(proof_of_rows(1.0, vec![(first + row, -gap)], first + row))
}

/// A proof with weights in the scaling of the host, largest weight 1, in the order of the rows.
pub fn proof_of_rows(margin: f64, mut weights: Vec<(usize, f64)>, heaviest: usize) -> Proof {
    let largest = weights.iter().fold(0.0, |largest: f64, (_, w)| largest.max(w.abs()));
    weights.iter_mut().for_each(|(_, w)| *w /= largest);
    weights.sort_by_key(|(row, _)| *row);
    Proof::Rows { margin, weights, heaviest }
}

/// The text of a proof: a row of this kind contradicts `others`, which have these numbers, and the glue of unknowns with these numbers.
pub fn contradiction(
    kind: RowKind,
    others: &[(RowKind, usize)],
    number: &dyn Fn(Counted, usize) -> String,
    glued: &[i64],
) -> String {
    let mut all = vec![format!("this {}", kind.name())];
    let name =
        |(kind, row): &(RowKind, usize)| format!("{} {}", kind.name(), number(Counted::Row(*kind), *row));
    match others {
        [] if !glued.is_empty() => {}
        [other] if glued.is_empty() => all.push(name(other)),
        [_] => all.push("another row".to_owned()),
        [first, .., last] if glued.is_empty() => {
            all.push(format!("{} others ({} and {} among them)", others.len(), name(first), name(last)));
        }
        _ => all.push(format!("{} others", others.len())),
    }
    match glued {
        [] => {}
        [number] => all.push(format!("the glue of the unknowns with number {number}")),
        [number, rest @ ..] => {
            all.push(format!(
                "the glue of the unknowns with number {number} and {} other numbers",
                rest.len()
            ));
        }
    }
    let last = all.pop().unwrap_or_default();
    format!("{} and {last} contradict each other: no displacement satisfies them", all.join(", "))
}

/// Kind and number of row i in the stack of all contact rows and all equality rows.
pub fn kind_and_row(i: usize, contact: usize) -> (RowKind, usize) {
    if i < contact {
        (RowKind::Inequality, i)
    } else {
        (RowKind::Equality, i - contact)
    }
}
