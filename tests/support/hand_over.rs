//! Hands a deck to the solver as a host would.

use decks::{Body, Csr, Deck, Friction, Rows};
use feti_contact::error::Result;
use feti_contact::solver::{FrictionInput, Modes, Problem, RowKind, RowsInput, SparseInput, Storage};

/// Registers stiffness, exact null space and load of every body, then both kinds of rows.
pub fn problem(deck: &Deck) -> Result<Problem> {
    with_motions(deck, Modes::Exact)
}

/// The same with the rigid motions given as these.
pub fn with_motions(deck: &Deck, given: Modes) -> Result<Problem> {
    let mut problem = without_null_spaces(deck)?;
    for (p, body) in deck.bodies.iter().enumerate() {
        let (n, modes) = (body.dofs(), body.modes());
        problem.set_null_space(p, n, modes.len(), &modes.concat(), n, given)?;
    }
    Ok(problem)
}

/// The same without null spaces.
pub fn without_null_spaces(deck: &Deck) -> Result<Problem> {
    let mut problem = Problem::new();
    problem.offer_method(&paper::Paper);
    for body in &deck.bodies {
        let p = problem.add_body(body.dofs())?;
        set_body(&mut problem, p, body)?;
    }
    add_rows(&mut problem, RowKind::Inequality, &deck.contact)?;
    add_rows(&mut problem, RowKind::Equality, &deck.equalities)?;
    add_friction(&mut problem, &deck.friction)?;
    Ok(problem)
}

/// Stiffness and load of body p.
pub fn set_body(problem: &mut Problem, p: usize, body: &Body) -> Result<()> {
    let (k, col) = (&body.stiffness, columns(&body.stiffness));
    let input = SparseInput { ptr: &k.ptr, col: &col, val: &k.val, storage: Storage::Full };
    problem.set_stiffness(p, input)?;
    problem.set_load(p, &body.load)
}

pub fn add_rows(problem: &mut Problem, kind: RowKind, rows: &Rows) -> Result<()> {
    let (matrix, dof) = (&rows.matrix, columns(&rows.matrix));
    let input = RowsInput { ptr: &matrix.ptr, body: None, dof: &dof, val: &matrix.val, rhs: Some(&rows.rhs) };
    let first = problem.add_rows(kind, input)?;
    if rows.compliance.iter().any(|inv_k| *inv_k > 0.0) {
        problem.set_compliance(kind, first, &rows.compliance)?;
    }
    Ok(())
}

pub fn add_friction(problem: &mut Problem, nodes: &Friction) -> Result<()> {
    if nodes.normal.is_empty() {
        return Ok(());
    }
    let normal: Vec<i64> = nodes.normal.iter().map(|row| row.map_or(-1, |row| row as i64)).collect();
    let (matrix, dof) = (&nodes.rows.matrix, columns(&nodes.rows.matrix));
    let rows = RowsInput { ptr: &matrix.ptr, body: None, dof: &dof, val: &matrix.val, rhs: None };
    let (coefficient, bound) = (Some(&nodes.coefficient[..]), Some(&nodes.bound[..]));
    let first =
        problem.add_friction(FrictionInput { dim: nodes.dim, normal: &normal, rows, coefficient, bound })?;
    let of_nodes: Vec<f64> = nodes.rows.compliance.iter().step_by(nodes.dim).copied().collect();
    if of_nodes.iter().any(|inv_kt| *inv_kt > 0.0) {
        problem.set_friction_compliance(first, &of_nodes)?;
    }
    problem.set_friction_reference(first, normal.len(), nodes.dim, &nodes.rows.rhs)
}

/// Columns of a matrix in the integers of the interface.
fn columns(matrix: &Csr) -> Vec<i64> {
    matrix.col.iter().map(|&j| j as i64).collect()
}
