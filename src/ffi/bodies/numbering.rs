//! The host's own numbers of the unknowns.

use crate::ffi::bodies::body::body_of_order;
use crate::ffi::boundary::{base, call, enter, numbers, Call, Index};
use crate::ffi::header::types::feti_problem;

/// Gives the host's own numbers of the unknowns of a body, with 32-bit integers.
///
/// A host that numbers all unknowns through gives every body its share; a number names one unknown of all bodies. Then
/// FETI_ALL as body in feti_body_load, feti_displacement and feti_reaction means arrays in these numbers, and so do rows
/// whose bodies are NULL in feti_rows_add_i32 and _i64. All bodies have numbers then: FETI_STATE names one that has not.
/// The numbers are copied; calling again replaces them. Rows that are there stay on their unknowns. After a failure the body
/// keeps the numbers it had.
///
/// With option glue = 1, set before, unknowns of several bodies may have one number: they move together, by equality rows that
/// only the library sees. The host's rows, their multipliers and the counts stay what they are. With FETI_ALL a load on such a
/// number is that of its first body, a displacement that of all of them, and a reaction the sum over them; rows whose bodies are
/// NULL act on the first. The last answer goes with a change of such numbers.
///
/// | argument | in/out | shape | rule |
/// |---|---|---|---|
/// | `p` | in | scalar | the handle |
/// | `body` | in | scalar | number of the body, from 0 |
/// | `n` | in | scalar | unknowns of the body |
/// | `number` | in | n | number of each unknown, counted from `base`, none that of another unknown of the body, nor, without option glue, of another body |
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
    // SAFETY: n numbers by the caller's word.
    unsafe { give(p, call, body, (n, number, base)) }
}

/// Gives the host's own numbers of the unknowns of a body, with 64-bit integers.
///
/// A host that numbers all unknowns through gives every body its share; a number names one unknown of all bodies. Then
/// FETI_ALL as body in feti_body_load, feti_displacement and feti_reaction means arrays in these numbers, and so do rows
/// whose bodies are NULL in feti_rows_add_i32 and _i64. All bodies have numbers then: FETI_STATE names one that has not.
/// The numbers are copied; calling again replaces them. Rows that are there stay on their unknowns. After a failure the body
/// keeps the numbers it had.
///
/// With option glue = 1, set before, unknowns of several bodies may have one number: they move together, by equality rows that
/// only the library sees. The host's rows, their multipliers and the counts stay what they are. With FETI_ALL a load on such a
/// number is that of its first body, a displacement that of all of them, and a reaction the sum over them; rows whose bodies are
/// NULL act on the first. The last answer goes with a change of such numbers.
///
/// | argument | in/out | shape | rule |
/// |---|---|---|---|
/// | `p` | in | scalar | the handle |
/// | `body` | in | scalar | number of the body, from 0 |
/// | `n` | in | scalar | unknowns of the body |
/// | `number` | in | n | number of each unknown, counted from `base`, none that of another unknown of the body, nor, without option glue, of another body |
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
    // SAFETY: n numbers by the caller's word.
    unsafe { give(p, call, body, (n, number, base)) }
}

/// # Safety
/// `given` is as many numbers as it says, with their base.
unsafe fn give<I: Index>(p: *mut feti_problem, call: Call, body: i64, given: (i64, *const I, i32)) -> i32 {
    enter(p, call, |problem| {
        let (n, number, from) = given;
        let (body, n) = body_of_order(problem, body, n)?;
        let from = base(from)?;
        // SAFETY: n numbers by the caller's word.
        let numbers = unsafe { numbers(number, n, from, "number") }?;
        problem.set_numbering(body, &numbers).map_err(|error| error.index_from(from))
    })
}
