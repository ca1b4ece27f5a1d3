//! The host's own numbers of the unknowns.

use crate::bodies::body::body_of_order;
use crate::boundary::{base, call, enter, numbers, Call, Index};
use crate::header::types::feti_problem;

/// Gives the host's own numbers of the unknowns of a body, with 32-bit integers.
///
/// Use this function if the host numbers the unknowns of all bodies consecutively; each number then names one unknown in
/// the whole problem. Arrays with FETI_ALL in feti_body_load, feti_displacement and feti_reaction then use these numbers,
/// and so do rows whose `body` is NULL in feti_rows_add_i32 and _i64. These calls need numbers for all bodies: otherwise
/// they return FETI_STATE and name a body without numbers. The numbers are copied; another call replaces them. Existing
/// rows stay on their unknowns. After a failure the body keeps its previous numbers.
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
#[no_mangle]
pub unsafe extern "C" fn feti_body_numbering_i32(
    p: *mut feti_problem,
    body: i64,
    n: i64,
    number: *const i32,
    base: i32,
) -> i32 {
    let call = call!(feti_body_numbering_i32(p, body, n, number, base));
    // SAFETY: n numbers guaranteed by the caller.
    unsafe { give(p, call, body, (n, number, base)) }
}

/// Gives the host's own numbers of the unknowns of a body, with 64-bit integers.
///
/// Use this function if the host numbers the unknowns of all bodies consecutively; each number then names one unknown in
/// the whole problem. Arrays with FETI_ALL in feti_body_load, feti_displacement and feti_reaction then use these numbers,
/// and so do rows whose `body` is NULL in feti_rows_add_i32 and _i64. These calls need numbers for all bodies: otherwise
/// they return FETI_STATE and name a body without numbers. The numbers are copied; another call replaces them. Existing
/// rows stay on their unknowns. After a failure the body keeps its previous numbers.
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
#[no_mangle]
pub unsafe extern "C" fn feti_body_numbering_i64(
    p: *mut feti_problem,
    body: i64,
    n: i64,
    number: *const i64,
    base: i32,
) -> i32 {
    let call = call!(feti_body_numbering_i64(p, body, n, number, base));
    // SAFETY: n numbers guaranteed by the caller.
    unsafe { give(p, call, body, (n, number, base)) }
}

/// # Safety
/// `given` is as many numbers as it says, with their base.
unsafe fn give<I: Index>(p: *mut feti_problem, call: Call, body: i64, given: (i64, *const I, i32)) -> i32 {
    enter(p, call, |problem| {
        let (n, number, from) = given;
        let (body, n) = body_of_order(problem, body, n)?;
        let from = base(from)?;
        // SAFETY: n numbers guaranteed by the caller.
        let numbers = unsafe { numbers(number, n, from, "number") }?;
        problem.set_numbering(body, &numbers).map_err(|error| error.index_from(from))
    })
}
