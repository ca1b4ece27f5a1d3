//! New values of stiffness matrices whose pattern stays.

use crate::ffi::bodies::body::body_of_order;
use crate::ffi::boundary::{borrowed, call, column_major, enter, id, input, same};
use crate::ffi::header::types::feti_problem;

/// Gives new values of a stiffness matrix on the pattern it was given with by feti_body_stiffness_i32 or _i64.
///
/// The values are copied and checked as the first were. The symbolic analysis is kept, and the next setup costs a
/// numeric factorisation of this body; values that are bit by bit those of before cost nothing. Storage is that of the
/// first call. FETI_STATE where the matrix has not been given, or in another form. FETI_INDEFINITE with the unknown of
/// a diagonal entry that is negative, or 0 beside others in its row. After a failure the body keeps the values it had.
///
/// Where the values are borrowed (FETI_BORROW) they are not copied: `val` is the array that was borrowed, rewritten by the
/// host, or another one in its place. They count as changed, also for other bodies that borrow the same array. After a failure
/// with the same array the body is without a matrix until it gets other values.
///
/// | argument | in/out | shape | rule |
/// |---|---|---|---|
/// | `p` | in | scalar | the handle |
/// | `body` | in | scalar | number of the body, from 0 |
/// | `nnz` | in | scalar | number of values, that of the first call |
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
            // SAFETY: nnz numbers that stay, by the caller's word.
            return problem.borrow_values(body, unsafe { borrowed(val, nnz, "val") }?);
        }
        // SAFETY: nnz numbers by the caller's word.
        problem.set_values(body, unsafe { input(val, nnz, "val") }?)
    })
}

/// Gives new values of a stiffness matrix that was given by feti_body_stiffness_split_i32 or _i64.
///
/// As feti_body_values, for a matrix with a diagonal of its own. FETI_STATE where the matrix has not been given, or in
/// another form. FETI_INDEFINITE with the unknown of a diagonal entry that is negative, or 0 beside others in its row.
/// After a failure the body keeps the values it had.
///
/// | argument | in/out | shape | rule |
/// |---|---|---|---|
/// | `p` | in | scalar | the handle |
/// | `body` | in | scalar | number of the body, from 0 |
/// | `n` | in | scalar | unknowns of the body |
/// | `diag` | in | n | K_ii, force per length |
/// | `nnz` | in | scalar | number of values beside the diagonal, that of the first call |
/// | `val` | in | nnz | entries of K beside the diagonal in the order of the first call, force per length |
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
        // SAFETY: n and nnz numbers by the caller's word.
        let (diag, val) = unsafe { (input(diag, n, "diag")?, input(val, nnz, "val")?) };
        problem.set_values_split(body, diag, val)
    })
}

/// Gives new values of a dense stiffness matrix.
///
/// The matrix is copied and checked as the first was, in the same storage. Where zeros stay zeros the symbolic analysis
/// is kept. FETI_STATE where the matrix has not been given, or in another form. FETI_INDEFINITE with the unknown of a
/// diagonal entry that is negative, or 0 beside others in its row. After a failure the body keeps the matrix it had.
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
        // SAFETY: ld (n - 1) + n entries by the caller's word.
        problem.set_values_dense(body, n, unsafe { input(k, entries, "k") }?, ld)
    })
}

const ENTRIES: &str = "the number of entries of the pattern is";
