//! The rows that a find has made take the place of those before.

use std::sync::Arc;

use crate::constraints::RowKind;
use crate::error::Result;
use crate::model::contents::SolvedModel;
use crate::model::host::HostModel;
use crate::model::pairs::PairRows;

impl HostModel {
    /// Replaces the rows of pairs. Numbers of rows stay, and so do the forces from which the next solve starts.
    pub fn set_rows_of_pairs(&mut self, rows: PairRows) -> Result<()> {
        const WHAT: &str = "rows of pairs";
        let end = self.sizes().dofs;
        let SolvedModel { contact, equalities, friction, .. } = &**self;
        let [of_contact, of_equalities, of_tangential] = &rows.sets;
        let contact = contact.with_first(of_contact, end, WHAT)?;
        let equalities = equalities.with_first(of_equalities, end, WHAT)?;
        let mut all = friction.copied(WHAT)?;
        all.rows = all.rows.with_first(of_tangential, end, WHAT)?;
        for (node, (coefficient, bound)) in all.nodes.iter_mut().zip(rows.coefficient.iter().zip(&rows.bound))
        {
            (node.coefficient, node.bound) = (*coefficient, *bound);
        }
        let is_new = !(self.contact.same_but_rhs(&contact)
            && self.equalities.same_but_rhs(&equalities)
            && self.friction.same_but_law(&self.contact, &all, &contact));
        (self.contact, self.equalities, self.friction) = (contact, equalities, all);
        self.revisions.laws += u64::from(is_new);
        if let Some(table) = self.table.as_mut().map(Arc::make_mut) {
            for (kind, tabled) in RowKind::ALL.into_iter().zip(rows.tabled) {
                table.replace_before(kind, rows.sets[kind as usize].len(), tabled);
            }
        }
        Ok(())
    }
}
