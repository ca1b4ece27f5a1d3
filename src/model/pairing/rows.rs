//! The rows that a find has made take the place of those before.

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
        let contact = contact.with_first(&rows.contact, end, WHAT)?;
        let equalities = equalities.with_first(&rows.equalities, end, WHAT)?;
        let mut all = friction.copied(WHAT)?;
        all.rows = all.rows.with_first(&rows.tangential, end, WHAT)?;
        for (node, (coefficient, bound)) in all.nodes.iter_mut().zip(rows.coefficient.iter().zip(&rows.bound))
        {
            (node.coefficient, node.bound) = (*coefficient, *bound);
        }
        let is_new = !(self.contact.same_but_rhs(&contact)
            && self.equalities.same_but_rhs(&equalities)
            && self.friction.same_but_law(&self.contact, &all, &contact));
        (self.contact, self.equalities, self.friction) = (contact, equalities, all);
        self.revisions.laws += u64::from(is_new);
        Ok(())
    }
}
