//! The linear solve that contact is measured against: the same bodies, glue and preconditioner, with the rows
//! in contact as equalities and no others.

use decks::Rows;
use feti_contact::solver::{Problem, RowKind, RowsInput};

use crate::solved::solved;

/// The certificate must not ask for more than the residual that stops the linear solve.
const ANY_CERTIFICATE: f64 = 1e-2;

/// Products with F of preconditioned conjugate gradients on the face of the rows with `multipliers` above zero:
/// start PROJ_face(0), stop |P_F g| <= `residual`. One per step and one for the start gradient; that which
/// confirms the last residual is not part of the method. The problem loses its `contact` rows.
pub fn products(
    problem: &mut Problem,
    contact: &Rows,
    multipliers: &[f64],
    residual: f64,
) -> Result<usize, String> {
    let text = |error: feti_contact::error::Error| format!("linear: {error}");
    let closed = closed(contact, multipliers);
    problem.clear_rows(RowKind::Inequality);
    add_equalities(problem, &closed).map_err(text)?;
    problem.set_f64("certificate_tolerance", ANY_CERTIFICATE).map_err(text)?;
    let scale = scale(problem).map_err(text)?;
    problem.set_f64("tolerance", residual / scale).map_err(text)?;
    Ok(solved(problem, "linear")?.counts.conjugate_gradient + 1)
}

/// The scale w that tolerances of this problem are relative to: known after one step.
fn scale(problem: &mut Problem) -> feti_contact::error::Result<f64> {
    let steps = problem.get_i64("max_steps")?;
    problem.set_i64("max_steps", 1)?;
    let scale = problem.solve()?.gap_scale;
    problem.set_i64("max_steps", steps)?;
    Ok(scale)
}

/// The rows with a multiplier above zero, as compliant as they are in contact.
fn closed(contact: &Rows, multipliers: &[f64]) -> Rows {
    let mut closed = Rows::none(contact.matrix.cols);
    for (i, _) in multipliers.iter().enumerate().filter(|(_, multiplier)| **multiplier > 0.0) {
        let entries: Vec<_> = contact.matrix.row(i).collect();
        closed.push_compliant(&entries, contact.rhs[i], contact.compliance[i]);
    }
    closed
}

fn add_equalities(problem: &mut Problem, rows: &Rows) -> feti_contact::error::Result<()> {
    let dof: Vec<i64> = rows.matrix.col.iter().map(|&j| j as i64).collect();
    let (ptr, val) = (&rows.matrix.ptr, &rows.matrix.val);
    let input = RowsInput { ptr, body: None, dof: &dof, val, rhs: Some(&rows.rhs) };
    let first = problem.add_rows(RowKind::Equality, input)?;
    problem.set_compliance(RowKind::Equality, first, &rows.compliance)
}
