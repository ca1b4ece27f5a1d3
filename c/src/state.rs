//! Start values, and saved states of a problem.

use crate::boundary::{call, enter, id, input, same, Output};
use crate::header::types::feti_problem;
use crate::rows::multiplier_kind;
use feti_contact::solver::Call;

/// Gives start values for the next solve.
///
/// The next solve starts from these multipliers, regardless of option start. They are used once, whatever the outcome;
/// every other solve starts as the option says. Rows with a zero start without a force, so the multipliers also carry
/// over the contact state of an earlier answer. A kind of rows without start values starts from zero. A change of rows
/// or bodies drops the start values.
///
/// | argument | in/out | shape | rule |
/// |---|---|---|---|
/// | `p` | in | scalar | the handle |
/// | `kind` | in | scalar | FETI_INEQUALITY, FETI_EQUALITY or FETI_TANGENTIAL |
/// | `rows` | in | scalar | number of rows of the kind; for tangential rows dim times the number of nodes |
/// | `lambda` | in | rows | force; a negative value for an inequality counts as zero |
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
        let expected = problem.sizes().of(kind);
        let rows = same(rows, expected, "rows", "the number of rows of this kind is")?;
        // SAFETY: one number per row guaranteed by the caller.
        problem.start_from(kind, unsafe { input(lambda, rows, "lambda") }?)
    })
}

/// Saves loads, rows, friction, multipliers and the contact state under a number.
///
/// Collective: all ranks that have a part of the problem make the call (feti_communicator_set), and get the same number.
///
/// For nodes with friction the state has the laws, the compliances and s_old. Of surfaces it has the positions, of pairs their numbers and what
/// the nodes have met. Factors are not copied and the entries of
/// the rows are shared, so a state costs no more memory than its vectors. A state exists until it is dropped or the
/// problem is destroyed; its number is never used again.
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
        let number = problem.checked_together(Call::SaveState, |_| unsafe { Output::new(id, 1, "id") })?;
        number.set(problem.save_state()? as i64);
        Ok(())
    })
}

/// Goes back to a saved state, for example after a rejected load step.
///
/// Collective: all ranks that have a part of the problem make the call (feti_communicator_set), with the same number.
///
/// The call restores loads, rows with right-hand sides and compliances, and nodes with friction with laws and s_old,
/// positions of surfaces and pairs. It also restores the answer unless a matrix or the rows have changed since the state was saved. With option start =
/// previous the next solve continues from the saved multipliers; with start = cold it gives the same bits as it would
/// have given at the time of saving. Matrices, null spaces and options keep their current values; unused start values are
/// dropped. The state stays saved. FETI_STATE if bodies, surfaces or pairs were added since the state was saved; after a failure nothing is
/// changed.
///
/// | argument | in/out | shape | rule |
/// |---|---|---|---|
/// | `p` | in | scalar | the handle |
/// | `id` | in | scalar | number of the state, from 0 |
#[no_mangle]
pub extern "C" fn feti_state_restore(p: *mut feti_problem, id: i64) -> i32 {
    enter(p, call!(feti_state_restore(p, id)), |problem| {
        let number = problem.checked_together(Call::RestoreState, |_| self::id(id, "id"))?;
        problem.restore_state(number)
    })
}

/// Drops a saved state.
///
/// | argument | in/out | shape | rule |
/// |---|---|---|---|
/// | `p` | in | scalar | the handle |
/// | `id` | in | scalar | number of the state, from 0 |
#[no_mangle]
pub extern "C" fn feti_state_drop(p: *mut feti_problem, id: i64) -> i32 {
    enter(p, call!(feti_state_drop(p, id)), |problem| problem.drop_state(self::id(id, "id")?))
}
