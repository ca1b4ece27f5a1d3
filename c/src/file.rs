//! A problem as one file.

use std::ffi::c_char;

use crate::boundary::{call, enter, file_path};
use crate::header::types::feti_problem;
use feti_contact::solver::Call;

/// Writes all input of the problem to one file, for example for a bug report.
///
/// Collective: all ranks that have a part of the problem make the call (feti_communicator_set). Rank 0 writes the file, under its own
/// `path`; one rank alone can read it.
///
/// The file has the bodies with their matrices, null spaces, coordinates, fixing unknowns, loads and numbers of the host,
/// rows of both kinds with right-hand sides and compliances, and the options that differ from their defaults, all bit by
/// bit. It does not have the answer, start values, saved states and functions of the host. docs/file_format.md describes
/// every byte. The library writes the file under another name in the same folder and renames it when it is complete:
/// after a failure an old file is unchanged, and no other file is left. FETI_IO with path, operation and the message of
/// the system; FETI_UNSUPPORTED if a body has functions of the host instead of a matrix (feti_body_operator), because no
/// file can hold them. Borrowed matrices are written with their current values. For a body that is cut
/// (feti_body_mesh_i32) the file has the pieces, not the elements; FETI_STATE if elements of a body are missing.
///
/// | argument | in/out | shape | rule |
/// |---|---|---|---|
/// | `p` | in | scalar | the handle |
/// | `path` | in | text | name of the file; an existing file is replaced |
///
/// # Safety
/// `path` is NUL terminated.
#[no_mangle]
pub unsafe extern "C" fn feti_problem_write(p: *mut feti_problem, path: *const c_char) -> i32 {
    enter(p, call!(feti_problem_write(p, path)), |problem| {
        // SAFETY: NUL terminated guaranteed by the caller.
        let path = problem.checked_together(Call::Write, |_| unsafe { file_path(path, "path") })?;
        problem.write_file(path)
    })
}

/// Reads a file of feti_problem_write into an empty problem.
///
/// FETI_UNSUPPORTED, on all ranks, if several make this call for a problem (feti_communicator_set).
///
/// A solve then gives the same bits as in the original problem. FETI_STATE if there are bodies or rows already. Options
/// get their values from the file and otherwise their defaults, except index_base, log_file and log_level, which are unchanged. All data pass
/// the same checks as in the corresponding calls. FETI_IO with path and the message of the system, or with the position
/// of the first wrong byte if the file is damaged (`entry` of feti_last_error_detail); FETI_UNSUPPORTED if the file has
/// contents of a later version.
///
/// Whatever their original form, matrices are read back as rows of the lower triangle, with ascending columns and every
/// diagonal entry. feti_body_values then expects the values in this order, and feti_body_values_split and
/// feti_body_values_dense return FETI_STATE until the matrix has been given again.
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
        // SAFETY: NUL terminated guaranteed by the caller.
        problem.read_file(unsafe { file_path(path, "path") }?)
    })
}
