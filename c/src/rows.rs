//! Rows of `B u <= c` and `H u = h`, numbered per kind from 0.

use crate::boundary::{
    base_of, call, count, enter, id, input, input_or_none, meaning, numbers, pointers, twins, Output,
};
use crate::header::types::{feti_problem, FETI_EQUALITY, FETI_INEQUALITY, FETI_TANGENTIAL};
use feti_contact::error::{Error, Result};
use feti_contact::solver::{RowKind, RowsInput};

twins! {
    /// Adds rows of `B u <= c` or `H u = h`, with 32-bit indices.
    ///
    /// The rows are numbered after the existing rows of the same kind. If a pair of body and unknown occurs twice in a
    /// row, the entries are summed. A contact row with c = +infinity never closes: it carries no force and joins no
    /// bodies, but it keeps its number, and feti_rows_rhs can turn it on. FETI_STATE if `body` is NULL and some bodies
    /// have numbers of the host while others have none.
    ///
    /// | argument | in/out | shape | rule |
    /// |---|---|---|---|
    /// | `p` | in | scalar | the handle |
    /// | `kind` | in | scalar | FETI_INEQUALITY or FETI_EQUALITY |
    /// | `rows` | in | scalar | number of rows, 0 adds none |
    /// | `row_ptr` | in | rows + 1 | row i holds the entries `row_ptr[i]` to `row_ptr[i + 1] - 1`; starts with `base` |
    /// | `body` | in | `row_ptr[rows] - base` | body of each entry, counted from `base`; NULL: `dof` is an unknown of the table (feti_dof_table_i32) or, without a table, the host's number of the unknown (feti_body_numbering_i32) or, without such numbers, counts the unknowns of all bodies consecutively |
    /// | `dof` | in | `row_ptr[rows] - base` | unknown of each entry, counted from `base` |
    /// | `val` | in | `row_ptr[rows] - base` | entries of B or H |
    /// | `base` | in | scalar | 0 or 1: what `row_ptr`, `body` and `dof` count from |
    /// | `rhs` | in | rows | c or h, length; c may be +infinity; NULL: zeros |
    /// | `first` | out | scalar | number of the first row added, from 0; may be NULL |
    ///
    /// # Safety
    /// The arrays have the given shapes.
    fn feti_rows_add_i32, feti_rows_add_i64(
        p: *mut feti_problem, kind: i32, rows: i64, row_ptr: *const I, body: *const I, dof: *const I,
        val: *const f64, base: i32, rhs: *const f64, first: *mut i64,
    ) |call| {
        enter(p, call, |problem| {
            let kind = row_kind(kind, "feti_friction_add_i32 or _i64 adds them with these")?;
            let (rows, base) = (count(rows, "rows")?, base_of(base)?);
            // SAFETY: NULL or room for one number guaranteed by the caller.
            let first = unsafe { Output::optional(first, 1, "first") }?;
            // SAFETY: rows + 1 positions guaranteed by the caller.
            let ptr = unsafe { pointers(row_ptr, rows, base) }?;
            let entries = ptr.last().copied().unwrap_or(0);
            let _room = problem.headroom_for_rows(rows, entries)?;
            let given = (!body.is_null()).then_some(body);
            // SAFETY: the last position is the number of entries.
            let body = given.map(|body| unsafe { numbers(body, entries, base, "body") }).transpose()?;
            // SAFETY: the last position is the number of entries.
            let (dof, val) =
                unsafe { (numbers(dof, entries, base, "dof")?, input(val, entries, "val")?) };
            // SAFETY: NULL or one number per row guaranteed by the caller.
            let rhs = unsafe { input_or_none(rhs, rows, "rhs") }?;
            let given = RowsInput { ptr: &ptr, body: body.as_deref(), dof: &dof, val, rhs };
            first.set(problem.add_rows(kind, given).map_err(|error| error.index_from(base))? as i64);
            Ok(())
        })
    }
}

/// Replaces right-hand sides: c of `B u <= c` or h of `H u = h`.
///
/// c = +infinity turns a contact row off, and a finite c turns it on again. Either change drops the last answer; the
/// factors of the bodies stay valid.
///
/// | argument | in/out | shape | rule |
/// |---|---|---|---|
/// | `p` | in | scalar | the handle |
/// | `kind` | in | scalar | FETI_INEQUALITY or FETI_EQUALITY |
/// | `first` | in | scalar | first row to change, from 0 |
/// | `rows` | in | scalar | number of rows to change |
/// | `rhs` | in | rows | c or h, length; c may be +infinity |
///
/// # Safety
/// The array has the given shape.
#[no_mangle]
pub unsafe extern "C" fn feti_rows_rhs(
    p: *mut feti_problem,
    kind: i32,
    first: i64,
    rows: i64,
    rhs: *const f64,
) -> i32 {
    enter(p, call!(feti_rows_rhs(p, kind, first, rows, rhs)), |problem| {
        let kind = row_kind(kind, "their s_old is given by feti_friction_reference")?;
        let (first, rows) = (id(first, "first")?, count(rows, "rows")?);
        // SAFETY: one number per row guaranteed by the caller.
        problem.set_rhs(kind, first, unsafe { input(rhs, rows, "rhs") }?)
    })
}

/// Makes rows compliant: each becomes a spring, `B u - c <= lambda/k` or `H u - h = mu/k`.
///
/// A contact row then carries the force k (B u - c) if this value is positive, which is a linear law of pressure and
/// overclosure. A compliant equality row is an elastic support or a cohesive bond. Newly added rows are rigid, 1/k = 0.
/// If a row is multiplied by t, its compliance is multiplied by t^2. The numbers stay with their rows until they are
/// replaced or the rows are cleared. The factors of the bodies stay valid; the last answer is dropped.
///
/// | argument | in/out | shape | rule |
/// |---|---|---|---|
/// | `p` | in | scalar | the handle |
/// | `kind` | in | scalar | FETI_INEQUALITY or FETI_EQUALITY |
/// | `first` | in | scalar | first row to change, from 0 |
/// | `rows` | in | scalar | number of rows to change |
/// | `inv_k` | in | rows | 1/k >= 0, length / force; 0: rigid |
///
/// # Safety
/// The array has the given shape.
#[no_mangle]
pub unsafe extern "C" fn feti_rows_compliance(
    p: *mut feti_problem,
    kind: i32,
    first: i64,
    rows: i64,
    inv_k: *const f64,
) -> i32 {
    enter(p, call!(feti_rows_compliance(p, kind, first, rows, inv_k)), |problem| {
        let kind = row_kind(kind, "theirs are given by feti_friction_compliance")?;
        let (first, rows) = (id(first, "first")?, count(rows, "rows")?);
        // SAFETY: one number per row guaranteed by the caller.
        problem.set_compliance(kind, first, unsafe { input(inv_k, rows, "inv_k") }?)
    })
}

/// Removes all rows of a kind.
///
/// Rows of pairs (feti_pair_add) stay; the numbering of that kind starts again behind them, at 0 without pairs. Removing the inequality rows also removes all nodes with friction
/// (feti_friction_clear), because they refer to contact rows. The factors of the bodies stay valid.
///
/// | argument | in/out | shape | rule |
/// |---|---|---|---|
/// | `p` | in | scalar | the handle |
/// | `kind` | in | scalar | FETI_INEQUALITY or FETI_EQUALITY |
#[no_mangle]
pub extern "C" fn feti_rows_clear(p: *mut feti_problem, kind: i32) -> i32 {
    enter(p, call!(feti_rows_clear(p, kind)), |problem| {
        problem.clear_rows(row_kind(kind, "feti_friction_clear removes their nodes")?);
        Ok(())
    })
}

/// A kind of rows that can be set by row number; for tangential rows, the text names the function to call `instead`.
pub(super) fn row_kind(kind: i32, instead: &str) -> Result<RowKind> {
    if kind == FETI_TANGENTIAL {
        let what = format!("FETI_TANGENTIAL: tangential rows belong to nodes with friction, {instead}");
        return Err(Error::argument("kind", what).value(f64::from(kind)));
    }
    let known = [(FETI_INEQUALITY, RowKind::Inequality), (FETI_EQUALITY, RowKind::Equality)];
    meaning(kind, "kind", &known, "neither FETI_INEQUALITY nor FETI_EQUALITY")
}

/// A kind of rows that have multipliers.
pub(super) fn multiplier_kind(kind: i32) -> Result<RowKind> {
    let known = [
        (FETI_INEQUALITY, RowKind::Inequality),
        (FETI_EQUALITY, RowKind::Equality),
        (FETI_TANGENTIAL, RowKind::Tangential),
    ];
    meaning(kind, "kind", &known, "none of FETI_INEQUALITY, FETI_EQUALITY and FETI_TANGENTIAL")
}
