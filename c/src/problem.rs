//! The life of a problem: creation, errors, destruction.

use std::ffi::c_char;
use std::ptr;

use crate::boundary::fpu;
use crate::boundary::handle::{self, Refusal};
use crate::boundary::{call, caught, check_text_room, copy_text, left, refuse, without_problem, Output};
use crate::header::status::{FETI_MEMORY, FETI_OK};
use crate::header::types::feti_problem;
use crate::ranks;
use feti_contact::solver::Problem;

/// Bytes of a problem without bodies, its entry in the registry, and data that the library keeps from its first call on,
/// rounded up.
const EMPTY: usize = 96 << 10;

/// Creates a problem without bodies and rows.
///
/// The handle is valid until feti_problem_destroy; its number is never used again. FETI_MEMORY, without an error text,
/// if there is not enough memory for an empty problem.
///
/// | argument | in/out | shape | rule |
/// |---|---|---|---|
/// | `p` | out | scalar | the handle |
///
/// # Safety
/// `p` has room for a pointer.
#[no_mangle]
pub unsafe extern "C" fn feti_problem_create(p: *mut *mut feti_problem) -> i32 {
    let call = call!(feti_problem_create(p));
    if p.is_null() {
        return refuse(call, &Refusal::Gone);
    }
    if !left(EMPTY) {
        return FETI_MEMORY;
    }
    without_problem(call, || {
        let mut problem = Problem::new();
        problem.offer_method(&paper::Paper);
        let handle = handle::register(problem)?;
        // SAFETY: the caller gives room for a pointer.
        unsafe { p.write_unaligned(handle) };
        Ok(())
    })
}

/// Destroys a problem with all it holds and sets the caller's handle to NULL.
///
/// FETI_BUSY while another call on the problem runs; the problem and the handle are then unchanged. From then on calls
/// with any other copy of the handle return FETI_HANDLE. At the end the library calls
/// feti_communicator.release, if the problem has such a table.
///
/// | argument | in/out | shape | rule |
/// |---|---|---|---|
/// | `p` | in/out | scalar | the handle |
///
/// # Safety
/// `p` points to a pointer.
#[no_mangle]
pub unsafe extern "C" fn feti_problem_destroy(p: *mut *mut feti_problem) -> i32 {
    let call = call!(feti_problem_destroy(p));
    if p.is_null() {
        return refuse(call, &Refusal::Gone);
    }
    fpu::in_default_environment(|| {
        // SAFETY: the caller's `p` leads to a pointer, which is only compared with the registry.
        let handle = unsafe { p.read_unaligned() };
        match handle::remove(handle) {
            Err(refusal) => refuse(call, &refusal),
            Ok(problem) => {
                let table = ranks::taken_from(handle);
                // SAFETY: as above.
                unsafe { p.write_unaligned(ptr::null_mut()) };
                // for the host the problem is destroyed, even if freeing its memory fails
                let _ = caught(|| {
                    drop(problem);
                    Ok(())
                });
                table.iter().for_each(ranks::Given::release);
                FETI_OK
            }
        }
    })
}

/// Text of the last error of the problem.
///
/// May be called while another call on the problem runs. The text is truncated to fit, and always NUL terminated if `cap`
/// > 0. It is empty if no error has occurred; a successful call does not clear it.
///
/// | argument | in/out | shape | rule |
/// |---|---|---|---|
/// | `p` | in | scalar | the handle |
/// | `buf` | out | text | room for `cap` characters; NULL with `cap` = 0 asks for the length |
/// | `cap` | in | scalar | characters in `buf`, >= 0 |
/// | `len` | out | scalar | full length without the terminating zero |
///
/// # Safety
/// `buf` has room for `cap` characters, `len` for one number.
#[no_mangle]
pub unsafe extern "C" fn feti_problem_error(
    p: *mut feti_problem,
    buf: *mut c_char,
    cap: i64,
    len: *mut i64,
) -> i32 {
    let call = call!(feti_problem_error(p, buf, cap, len));
    let Some(slot) = handle::find(p) else {
        return refuse(call, &Refusal::Gone);
    };
    without_problem(call, || {
        check_text_room(buf, cap)?;
        // SAFETY: the caller gives room for one number.
        let full_length = unsafe { Output::new(len, 1, "len") }?;
        let text = slot.error().map(|record| record.text).unwrap_or_default();
        // SAFETY: the caller gives room for `cap` characters.
        full_length.set(unsafe { copy_text(&text, buf, cap) });
        Ok(())
    })
}
