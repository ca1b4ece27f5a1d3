//! New values of stiffness matrices with an unchanged pattern.

use crate::bodies::body::body_of_order;
use crate::boundary::{borrowed, call, column_major, enter, id, input, same};
use crate::header::types::feti_problem;

/// Gives new values for a stiffness matrix that was given by rows, by its profile or by triplets.
///
/// The values are copied and checked like the first ones. The library keeps the symbolic analysis, so the next setup
/// costs only a numeric factorisation of this body; bit-identical values cost nothing. The storage is the one of the
/// first call. If a value of a profile was 0 and is not any more, K has a new entry: the next setup makes a new analysis, and the
/// log reports it. A value of a profile that becomes 0 stays an entry. FETI_STATE if the matrix has not been given, or was given in
/// another form.
///
/// Borrowed values (FETI_BORROW) are not copied: `val` is either the borrowed array, which the host has rewritten, or
/// another array that replaces it. The values count as changed, also for other bodies that borrow the same array. After a
/// failure with the same array the body has no matrix until it gets other values.
///
/// | argument | in/out | shape | rule |
/// |---|---|---|---|
/// | `p` | in | scalar | the handle |
/// | `body` | in | scalar | number of the body, from 0 |
/// | `nnz` | in | scalar | number of values, as in the first call |
/// | `val` | in | nnz | entries of K in the order of the first call, force per length |
///
/// # Safety
/// The array has the given shape.
#[no_mangle]
pub unsafe extern "C" fn feti_body_values(p: *mut feti_problem, body: i64, nnz: i64, val: *const f64) -> i32 {
    enter(p, call!(feti_body_values(p, body, nnz, val)), |problem| {
        let body = id(body, "body")?;
        let nnz =
            same(nnz, problem.values(body, false)?, "nnz", ENTRIES).map_err(|error| error.body(body))?;
        if problem.is_borrowed(body) {
            // SAFETY: nnz numbers that stay, guaranteed by the caller.
            return problem.borrow_values(body, unsafe { borrowed(val, nnz, "val") }?);
        }
        // SAFETY: nnz numbers guaranteed by the caller.
        problem.set_values(body, unsafe { input(val, nnz, "val") }?)
    })
}

/// Gives new values for a stiffness matrix that was given by rows or by its profile with a separate diagonal.
///
/// The call works like feti_body_values, for a matrix with a separate diagonal. FETI_STATE if the matrix has not been
/// given, or was given in another form.
///
/// | argument | in/out | shape | rule |
/// |---|---|---|---|
/// | `p` | in | scalar | the handle |
/// | `body` | in | scalar | number of the body, from 0 |
/// | `n` | in | scalar | unknowns of the body |
/// | `diag` | in | n | K_ii, force per length |
/// | `nnz` | in | scalar | number of off-diagonal values, as in the first call |
/// | `val` | in | nnz | off-diagonal values of the first call, in its order, force per length |
///
/// # Safety
/// The arrays have the given shapes.
#[no_mangle]
pub unsafe extern "C" fn feti_body_values_split(
    p: *mut feti_problem,
    body: i64,
    n: i64,
    diag: *const f64,
    nnz: i64,
    val: *const f64,
) -> i32 {
    enter(p, call!(feti_body_values_split(p, body, n, diag, nnz, val)), |problem| {
        let (body, n) = body_of_order(problem, body, n)?;
        let nnz = same(nnz, problem.values(body, true)?, "nnz", ENTRIES).map_err(|error| error.body(body))?;
        // SAFETY: n and nnz numbers guaranteed by the caller.
        let (diag, val) = unsafe { (input(diag, n, "diag")?, input(val, nnz, "val")?) };
        problem.set_values_split(body, diag, val)
    })
}

/// Gives new values for a dense stiffness matrix.
///
/// The matrix is copied and checked like the first one, in the same storage. If all zeros stay zero, the library keeps
/// the symbolic analysis. FETI_STATE if the matrix has not been given, or was given in another form.
///
/// | argument | in/out | shape | rule |
/// |---|---|---|---|
/// | `p` | in | scalar | the handle |
/// | `body` | in | scalar | number of the body, from 0 |
/// | `n` | in | scalar | unknowns of the body |
/// | `k` | in | ld * n | column-major: K_ij is k[i + ld j], force per length |
/// | `ld` | in | scalar | >= n |
///
/// # Safety
/// The array has the given shape.
#[no_mangle]
pub unsafe extern "C" fn feti_body_values_dense(
    p: *mut feti_problem,
    body: i64,
    n: i64,
    k: *const f64,
    ld: i64,
) -> i32 {
    enter(p, call!(feti_body_values_dense(p, body, n, k, ld)), |problem| {
        let (body, n) = body_of_order(problem, body, n)?;
        problem.dense_storage(body)?;
        let (entries, ld) = column_major(n, n, ld, "ld")?;
        // SAFETY: ld (n - 1) + n entries guaranteed by the caller.
        problem.set_values_dense(body, n, unsafe { input(k, entries, "k") }?, ld)
    })
}

const ENTRIES: &str = "the number of entries of the pattern is";
