//! Hands a deck to the solver as a host would.

use decks::{Csr, Deck, Rows};
use feti_contact::error::Result;
use feti_contact::solver::{Modes, Problem, RowKind, RowsInput, SparseInput, Storage};

/// Columns of a matrix in the integers of the interface.
pub fn columns(matrix: &Csr) -> Vec<i64> {
    matrix.col.iter().map(|&j| j as i64).collect()
}

/// Registers stiffness, exact null space and load of every body, then both kinds of rows.
pub fn problem(deck: &Deck) -> Result<Problem> {
    let mut problem = Problem::new();
    for body in &deck.bodies {
        let n = body.dofs();
        let p = problem.add_body(n)?;
        let (k, col) = (&body.stiffness, columns(&body.stiffness));
        let input = SparseInput { ptr: &k.ptr, col: &col, val: &k.val, storage: Storage::Full };
        problem.set_stiffness(p, input)?;
        let modes = body.modes();
        problem.set_null_space(p, n, modes.len(), &modes.concat(), n, Modes::Exact)?;
        problem.set_load(p, &body.load)?;
    }
    add_rows(&mut problem, RowKind::Inequality, &deck.contact)?;
    add_rows(&mut problem, RowKind::Equality, &deck.equalities)?;
    Ok(problem)
}

fn add_rows(problem: &mut Problem, kind: RowKind, rows: &Rows) -> Result<()> {
    let (matrix, dof) = (&rows.matrix, columns(&rows.matrix));
    let input = RowsInput { ptr: &matrix.ptr, body: None, dof: &dof, val: &matrix.val, rhs: Some(&rows.rhs) };
    problem.add_rows(kind, input).map(|_| ())
}
