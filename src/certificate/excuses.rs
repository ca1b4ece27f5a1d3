//! Errors in gaps and energies that rounding of the loads explains.
//!
//! f - B'lambda - H'mu is known to rounding of its terms, and u to rounding of the displacement that each term would cause. If loads and
//! forces of the rows nearly cancel, as in the last increments of Newton's method or if loads act on held dofs alone,
//! this rounding is far more than u itself: gaps and energies of u are lost, although every force is correct to rounding.

use std::collections::HashSet;

use crate::certificate::energy::Energies;
use crate::certificate::field::Field;
use crate::certificate::forces::Forces;
use crate::certificate::rows::Measured;
use crate::certificate::{Certificate, Response, NOISE};
use crate::constraints::RowKind;
use crate::error::Result;

/// Judges again with larger limits: `64 eps (V phi_i)^1/2`, length, is added to the limits of gaps and slips that fail,
/// `64 eps A phi_i^1/2`, phi_i at least that of its own unknowns, if the row touches a body without load or forces, and `64 eps V` to the rounding of the energies.
/// The worst row or node comes first; the first that still fails ends the loop.
pub(super) fn by_rounding(
    field: &Field,
    forces: &Forces,
    energies: &Energies,
    rows: &mut Measured,
    response: &mut dyn Response,
    certificate: &mut Certificate,
) -> Result<()> {
    let (limit, work) = (field.data.limit, response.work_of_loads()?);
    certificate.duality_gap = energies.entry(limit, work);
    // motions prescribed by rows act like loads
    let work = work.max(energies.deforming);
    let mut failing = failing(rows);
    let mut asked = 0;
    for &(kind, i, _) in &failing {
        asked += 1;
        for row in rows.rows_of(kind, i) {
            let compliance = response.compliance_of(kind, row)?;
            // for forces that are zero the row's own unknowns will do: K+ of bodies that are cut is not known
            let idle = compliance.max(field.compliance(kind, row));
            rows.rows[kind as usize][row].gap_limit +=
                NOISE * (work * compliance).sqrt() + forces.idle_at(field, kind, row) * idle.sqrt();
        }
        if !(rows.gap_ratio(kind, i) <= 1.0) {
            break;
        }
    }
    // the limits after the first failure were not computed
    let skipped: HashSet<(RowKind, usize)> = failing.drain(asked..).map(|(kind, i, _)| (kind, i)).collect();
    rows.judge_gaps(limit, certificate, |kind, i| !skipped.contains(&(kind, i)));
    Ok(())
}

/// Rows whose gaps fail and nodes whose slips fail, with their ratios, the worst first.
fn failing(rows: &Measured) -> Vec<(RowKind, usize, f64)> {
    let ratios = rows.all().map(|(kind, i)| (kind, i, rows.gap_ratio(kind, i)));
    let mut failing: Vec<_> = ratios.filter(|(_, _, ratio)| !(*ratio <= 1.0)).collect();
    failing.sort_by(|a, b| b.2.total_cmp(&a.2));
    failing
}
