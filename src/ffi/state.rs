//! Start values, and states of a problem to come back to.

use crate::ffi::boundary::{call, enter, id, input, same, Output};
use crate::ffi::header::types::feti_problem;
use crate::ffi::rows::multiplier_kind;

/// Gives start values for the next solve.
///
/// That solve starts from these multipliers, whatever option start says, and uses them up, whatever it comes to; every
/// other solve starts as the option says. Rows with a zero start without force, so that the contact state of an earlier
/// answer is carried over. A kind that is not given starts from zero. A change of rows or bodies drops the values. After a
/// failure earlier values stay.
///
/// | argument | in/out | shape | rule |
/// |---|---|---|---|
/// | `p` | in | scalar | the handle |
/// | `kind` | in | scalar | FETI_INEQUALITY, FETI_EQUALITY or FETI_TANGENTIAL |
/// | `rows` | in | scalar | number of rows of the kind; of tangential ones dim for each node |
/// | `lambda` | in | rows | force; a negative one of an inequality counts as zero |
///
/// # Safety
/// The array has the given shape.
#[no_mangle]
pub unsafe extern "C" fn feti_start_from(
    p: *mut feti_problem,
    kind: i32,
    rows: i64,
    lambda: *const f64,
) -> i32 {
    enter(p, call!(feti_start_from(p, kind, rows, lambda)), |problem| {
        let kind = multiplier_kind(kind)?;
        let expected = problem.rows(kind).len();
        let rows = same(rows, expected, "rows", "the number of rows of this kind is")?;
        // SAFETY: one number per row by the caller's word.
        problem.start_from(kind, unsafe { input(lambda, rows, "lambda") }?)
    })
}

/// Saves loads, rows, friction, multipliers and the contact state under a number.
///
/// Of nodes with friction the laws, the compliances and s_old. Factors are not copied and the entries of the rows are shared, so that it costs no more than the vectors. States live until they are dropped or the problem is
/// destroyed; numbers are never used again. After a failure nothing is saved.
///
/// | argument | in/out | shape | rule |
/// |---|---|---|---|
/// | `p` | in | scalar | the handle |
/// | `id` | out | scalar | number of the state, from 0 |
///
/// # Safety
/// `id` has room for one number.
#[no_mangle]
pub unsafe extern "C" fn feti_state_save(p: *mut feti_problem, id: *mut i64) -> i32 {
    enter(p, call!(feti_state_save(p, id)), |problem| {
        // SAFETY: the caller gives room for one number.
        let number = unsafe { Output::new(id, 1, "id") }?;
        number.set(problem.save_state()? as i64);
        Ok(())
    })
}

/// Goes back to a saved state: after a load step that was rejected.
///
/// Loads and rows, with right-hand sides and compliances, and nodes with friction, with laws and s_old, are as they were, and so is the answer unless a matrix or the
/// rows have changed since; with option start = previous the next solve continues from the saved multipliers, with
/// start = cold it gives the bits it would have given then. Matrices, null spaces and options stay as they are now; start
/// values that were not used yet are dropped. The state stays saved. FETI_STATE when bodies were added since; after a
/// failure nothing is changed.
///
/// | argument | in/out | shape | rule |
/// |---|---|---|---|
/// | `p` | in | scalar | the handle |
/// | `id` | in | scalar | number of the state |
#[no_mangle]
pub extern "C" fn feti_state_restore(p: *mut feti_problem, id: i64) -> i32 {
    enter(p, call!(feti_state_restore(p, id)), |problem| problem.restore_state(self::id(id, "id")?))
}

/// Drops a saved state. After a failure nothing is dropped.
///
/// | argument | in/out | shape | rule |
/// |---|---|---|---|
/// | `p` | in | scalar | the handle |
/// | `id` | in | scalar | number of the state |
#[no_mangle]
pub extern "C" fn feti_state_drop(p: *mut feti_problem, id: i64) -> i32 {
    enter(p, call!(feti_state_drop(p, id)), |problem| problem.drop_state(self::id(id, "id")?))
}
