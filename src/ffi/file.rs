//! A problem as one file.

use std::ffi::c_char;

use crate::ffi::boundary::{call, enter, file_path};
use crate::ffi::header::types::feti_problem;

/// Writes all that the host has registered to one file: a bug report is a file.
///
/// Bodies with their matrices, null spaces, coordinates, fixing unknowns, loads and numbers of the host, rows of both kinds with right-hand
/// sides and compliances, and the options that differ from their defaults, bit by bit; not the answer, start values, saved states and
/// functions of the host. docs/file_format.md describes every byte. The file is written under another name in the same folder and
/// renamed when it is complete: after a failure an old file is as it was, and nothing else is left. FETI_IO with path,
/// operation and the words of the system; FETI_UNSUPPORTED with the body where functions of the host stand for a matrix
/// (feti_body_operator): no file holds them. Borrowed matrices are written as they are at that moment. Of a body that is cut
/// (feti_body_mesh_i32) the pieces are written, not the elements; FETI_STATE where elements of a body are missing.
///
/// | argument | in/out | shape | rule |
/// |---|---|---|---|
/// | `p` | in | scalar | the handle |
/// | `path` | in | text | name of the file; an old one is replaced |
///
/// # Safety
/// `path` is NUL terminated.
#[no_mangle]
pub unsafe extern "C" fn feti_problem_write(p: *mut feti_problem, path: *const c_char) -> i32 {
    enter(p, call!(feti_problem_write(p, path)), |problem| {
        // SAFETY: NUL terminated by the caller's word.
        problem.write_file(unsafe { file_path(path, "path") }?)
    })
}

/// Reads what feti_problem_write has written into an empty problem.
///
/// The same solve then gives the same bits. FETI_STATE when there are bodies or rows already. Options become those of the
/// file, all others their defaults, except index_base, which stays. Everything goes through the checks of the calls it stands
/// for. FETI_IO with path and the words of the system, or with the byte where a file is damaged (`entry` of
/// feti_last_error_detail); FETI_UNSUPPORTED when it holds what a later version has written. After a failure the problem is as it was.
///
/// Matrices come back by the rows of their lower triangle, columns ascending, with every diagonal entry, however they were
/// given: feti_body_values then expects the values in this order, and feti_body_values_split and feti_body_values_dense
/// return FETI_STATE until the matrix has been given again.
///
/// | argument | in/out | shape | rule |
/// |---|---|---|---|
/// | `p` | in | scalar | the handle |
/// | `path` | in | text | name of the file |
///
/// # Safety
/// `path` is NUL terminated.
#[no_mangle]
pub unsafe extern "C" fn feti_problem_read(p: *mut feti_problem, path: *const c_char) -> i32 {
    enter(p, call!(feti_problem_read(p, path)), |problem| {
        // SAFETY: NUL terminated by the caller's word.
        problem.read_file(unsafe { file_path(path, "path") }?)
    })
}
