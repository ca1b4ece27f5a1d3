//! The host's table of unknowns.

use crate::boundary::{base_of, count, enter, input, input_or_none, numbers, term_pointers, twins};
use crate::header::types::feti_problem;
use feti_contact::solver::DofTableInput;

twins! {
    /// Names the unknowns of the host that its matrices do not have, with 32-bit indices: supports, prescribed values, multi-point constraints.
    ///
    /// Give the table if the host eliminates unknowns before it assembles K: usually one entry for every node and direction. An eliminated
    /// unknown is `u_i = constant_i + sum_k coefficient_k u_term(k)`; terms may be eliminated themselves. Afterwards rows whose `body` is NULL
    /// (feti_rows_add_i32, feti_friction_add_i32) name unknowns of the table, and the library eliminates what K does not have from their
    /// entries, gaps and slips. Arrays with FETI_ALL have an entry for each unknown of the table: feti_body_load takes loads on all of
    /// them, feti_displacement gives them all, and feti_reaction gives -B'lambda on all of them, also on eliminated ones, which is what a
    /// Newton loop subtracts from its residual. The forces of the supports stay with the host. In an increment, `constant` is what is left to
    /// go: the prescribed minus the present value.
    ///
    /// Another call replaces the table: the rows follow, also those of pairs of surfaces. With other constants alone, only right-hand sides change. FETI_STATE from
    /// feti_body_add and feti_body_numbering_i32 after this call. On several ranks the table names unknowns of its rank.
    ///
    /// | argument | in/out | shape | rule |
    /// |---|---|---|---|
    /// | `p` | in | scalar | the handle |
    /// | `n` | in | scalar | unknowns of the host |
    /// | `number` | in | n | number of the unknown of K, counted from `base`: that of feti_body_numbering_i32 or, without such numbers, through all bodies; below `base`: eliminated. No number occurs twice |
    /// | `ptr` | in | n + 1 | unknown i has the terms `ptr[i]` to `ptr[i + 1] - 1`; starts with `base`; NULL: no unknown has terms |
    /// | `term` | in | `ptr[n] - base` | unknown of the host, counted from `base` |
    /// | `coefficient` | in | `ptr[n] - base` | factor of each term |
    /// | `constant` | in | n | length; 0 for unknowns of K; NULL: zeros |
    /// | `base` | in | scalar | 0 or 1: what `number`, `ptr` and `term` count from |
    ///
    /// # Safety
    /// The arrays have the given shapes.
    fn feti_dof_table_i32, feti_dof_table_i64(
        p: *mut feti_problem, n: i64, number: *const I, ptr: *const I, term: *const I, coefficient: *const f64, constant: *const f64,
        base: i32,
    ) |call| {
        enter(p, call, |problem| {
            let (n, base) = (count(n, "n")?, base_of(base)?);
            // SAFETY: n numbers guaranteed by the caller.
            let number = unsafe { numbers(number, n, base, "number") }?;
            let given = (!ptr.is_null()).then_some(ptr);
            // SAFETY: n + 1 positions guaranteed by the caller.
            let ptr = given.map(|ptr| unsafe { term_pointers(ptr, n, base) }).transpose()?;
            let terms = ptr.as_ref().and_then(|ptr| ptr.last().copied()).unwrap_or(0);
            let _room = problem.headroom_for_rows(n, terms)?;
            // SAFETY: the last position is the number of terms.
            let (term, coefficient) =
                unsafe { (numbers(term, terms, base, "term")?, input(coefficient, terms, "coefficient")?) };
            // SAFETY: NULL or n numbers guaranteed by the caller.
            let constant = unsafe { input_or_none(constant, n, "constant") }?;
            let table =
                DofTableInput { number: &number, ptr: ptr.as_deref(), term: &term, coefficient, constant };
            problem.set_dof_table(table).map_err(|error| error.index_from(base))
        })
    }
}
