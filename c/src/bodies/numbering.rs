//! The host's own numbers of the unknowns.

use crate::bodies::body::body_of_order;
use crate::boundary::{base_of, enter, numbers, twins};
use crate::header::types::feti_problem;

twins! {
    /// Gives the host's own numbers of the unknowns of a body, with 32-bit integers.
    ///
    /// Use this function if the host numbers the unknowns of all bodies consecutively; each number then names one
    /// unknown in the whole problem. Arrays with FETI_ALL in feti_body_load, feti_displacement and feti_reaction then
    /// use these numbers, and so do rows whose `body` is NULL in feti_rows_add_i32 and _i64. These calls need numbers
    /// for all bodies: otherwise they return FETI_STATE and name a body without numbers. Another call replaces the
    /// numbers. Existing rows stay on their unknowns.
    ///
    /// If option glue = 1 was set before, unknowns of several bodies may share one number. These unknowns then move together;
    /// the library joins them by internal equality rows, which change neither the host's rows and multipliers nor the counts.
    /// With FETI_ALL a load on a shared number acts on its first body, the displacement is the one of all its bodies, and the
    /// reaction is the sum over them. Rows whose `body` is NULL act on the first body. A change of shared numbers drops the
    /// last answer.
    ///
    /// | argument | in/out | shape | rule |
    /// |---|---|---|---|
    /// | `p` | in | scalar | the handle |
    /// | `body` | in | scalar | number of the body, from 0 |
    /// | `n` | in | scalar | unknowns of the body |
    /// | `number` | in | n | number of each unknown, counted from `base`; different for all unknowns of the body and, without option glue, of all bodies |
    /// | `base` | in | scalar | 0 or 1: what the numbers count from |
    ///
    /// # Safety
    /// The array has the given shape.
    fn feti_body_numbering_i32, feti_body_numbering_i64(
        p: *mut feti_problem, body: i64, n: i64, number: *const I, base: i32,
    ) |call| {
        enter(p, call, |problem| {
            let (body, n) = body_of_order(problem, body, n)?;
            let base = base_of(base)?;
            // SAFETY: n numbers guaranteed by the caller.
            let numbers = unsafe { numbers(number, n, base, "number") }?;
            problem.set_numbering(body, &numbers).map_err(|error| error.index_from(base))
        })
    }
}
