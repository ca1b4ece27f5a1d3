//! Bodies: stiffness, load, coordinates.

use super::arrays::{column_major, count, id, input, same, Output};
use super::guard::{call, enter, Call};
use super::indices::{base, numbers, pointers, Index};
use super::types::{feti_problem, FETI_COPY, FETI_FULL, FETI_LOWER, FETI_UPPER};
use crate::error::{Error, Result};
use crate::solver::{Problem, SparseInput, Storage};

/// Adds a body with `n` unknowns.
///
/// Bodies are numbered from 0 in the order in which they are added. After a failure nothing is added.
///
/// | argument | in/out | shape | rule |
/// |---|---|---|---|
/// | `p` | in | scalar | the handle |
/// | `n` | in | scalar | unknowns of the body, > 0 |
/// | `body` | out | scalar | number of the body |
///
/// # Safety
/// `body` has room for one number.
#[no_mangle]
pub unsafe extern "C" fn feti_body_add(p: *mut feti_problem, n: i64, body: *mut i64) -> i32 {
    enter(p, call!(feti_body_add(p, n, body)), |problem| {
        // SAFETY: the caller gives room for one number.
        let number = unsafe { Output::new(body, 1, "body") }?;
        number.set(problem.add_body(count(n, "n")?)? as i64);
        Ok(())
    })
}

/// Gives the stiffness matrix K of a body by rows, with 32-bit indices.
///
/// The matrix is copied; calling again replaces pattern and values. Columns of a row may come in any order, none twice.
/// With FETI_FULL K must be symmetric within option symmetry_tolerance and is averaged. After a failure the body keeps
/// the matrix it had.
///
/// | argument | in/out | shape | rule |
/// |---|---|---|---|
/// | `p` | in | scalar | the handle |
/// | `body` | in | scalar | number of the body, from 0 |
/// | `n` | in | scalar | unknowns of the body |
/// | `row_ptr` | in | n + 1 | row i holds the entries row_ptr[i] to row_ptr[i + 1] - 1; starts with `base` |
/// | `col` | in | row_ptr[n] - base | columns, counted from `base` |
/// | `val` | in | row_ptr[n] - base | entries of K, force per length |
/// | `base` | in | scalar | 0 or 1: what `row_ptr` and `col` count from |
/// | `storage` | in | scalar | FETI_FULL, FETI_LOWER or FETI_UPPER |
/// | `flags` | in | scalar | FETI_COPY |
///
/// # Safety
/// The arrays have the given shapes.
#[no_mangle]
pub unsafe extern "C" fn feti_body_stiffness_i32(
    p: *mut feti_problem,
    body: i64,
    n: i64,
    row_ptr: *const i32,
    col: *const i32,
    val: *const f64,
    base: i32,
    storage: i32,
    flags: i32,
) -> i32 {
    let call = call!(feti_body_stiffness_i32(p, body, n, row_ptr, col, val, base, storage, flags));
    let matrix = SparseMatrix { n, row_ptr, col, val, base, storage, flags };
    // SAFETY: shapes by the caller's word.
    unsafe { matrix.give(p, call, body) }
}

/// Gives the stiffness matrix K of a body by rows, with 64-bit indices.
///
/// The matrix is copied; calling again replaces pattern and values. Columns of a row may come in any order, none twice.
/// With FETI_FULL K must be symmetric within option symmetry_tolerance and is averaged. After a failure the body keeps
/// the matrix it had.
///
/// | argument | in/out | shape | rule |
/// |---|---|---|---|
/// | `p` | in | scalar | the handle |
/// | `body` | in | scalar | number of the body, from 0 |
/// | `n` | in | scalar | unknowns of the body |
/// | `row_ptr` | in | n + 1 | row i holds the entries row_ptr[i] to row_ptr[i + 1] - 1; starts with `base` |
/// | `col` | in | row_ptr[n] - base | columns, counted from `base` |
/// | `val` | in | row_ptr[n] - base | entries of K, force per length |
/// | `base` | in | scalar | 0 or 1: what `row_ptr` and `col` count from |
/// | `storage` | in | scalar | FETI_FULL, FETI_LOWER or FETI_UPPER |
/// | `flags` | in | scalar | FETI_COPY |
///
/// # Safety
/// The arrays have the given shapes.
#[no_mangle]
pub unsafe extern "C" fn feti_body_stiffness_i64(
    p: *mut feti_problem,
    body: i64,
    n: i64,
    row_ptr: *const i64,
    col: *const i64,
    val: *const f64,
    base: i32,
    storage: i32,
    flags: i32,
) -> i32 {
    let call = call!(feti_body_stiffness_i64(p, body, n, row_ptr, col, val, base, storage, flags));
    let matrix = SparseMatrix { n, row_ptr, col, val, base, storage, flags };
    // SAFETY: shapes by the caller's word.
    unsafe { matrix.give(p, call, body) }
}

/// Arguments of the two functions above.
struct SparseMatrix<I> {
    n: i64,
    row_ptr: *const I,
    col: *const I,
    val: *const f64,
    base: i32,
    storage: i32,
    flags: i32,
}

impl<I: Index> SparseMatrix<I> {
    /// # Safety
    /// The arrays have the documented shapes.
    unsafe fn give(&self, p: *mut feti_problem, call: Call, body: i64) -> i32 {
        enter(p, call, |problem| {
            let (body, n) = body_of_order(problem, body, self.n)?;
            let (base, storage) = (base(self.base)?, storage_of(self.storage)?);
            copy_only(self.flags)?;
            // SAFETY: n + 1 positions by the caller's word.
            let ptr = unsafe { pointers(self.row_ptr, n, base) }?;
            let entries = ptr.last().copied().unwrap_or(0);
            // SAFETY: the last position is the number of entries.
            let (col, val) =
                unsafe { (numbers(self.col, entries, base, "col")?, input(self.val, entries, "val")?) };
            problem.set_stiffness(body, SparseInput { ptr: &ptr, col: &col, val, storage })
        })
    }
}

/// Gives the stiffness matrix K of a body as a dense matrix, for boundary elements and condensed bodies.
///
/// The matrix is copied; calling again replaces it. With FETI_LOWER and FETI_UPPER the other triangle is not read. After a
/// failure the body keeps the matrix it had.
///
/// | argument | in/out | shape | rule |
/// |---|---|---|---|
/// | `p` | in | scalar | the handle |
/// | `body` | in | scalar | number of the body, from 0 |
/// | `n` | in | scalar | unknowns of the body |
/// | `k` | in | ld * n | column-major: K_ij is k[i + ld j], force per length |
/// | `ld` | in | scalar | >= n |
/// | `storage` | in | scalar | FETI_FULL, FETI_LOWER or FETI_UPPER |
/// | `flags` | in | scalar | FETI_COPY |
///
/// # Safety
/// The array has the given shape.
#[no_mangle]
pub unsafe extern "C" fn feti_body_stiffness_dense(
    p: *mut feti_problem,
    body: i64,
    n: i64,
    k: *const f64,
    ld: i64,
    storage: i32,
    flags: i32,
) -> i32 {
    enter(p, call!(feti_body_stiffness_dense(p, body, n, k, ld, storage, flags)), |problem| {
        let (body, n) = body_of_order(problem, body, n)?;
        let storage = storage_of(storage)?;
        copy_only(flags)?;
        let (entries, ld) = column_major(n, n, ld, "ld")?;
        // SAFETY: ld (n - 1) + n entries by the caller's word.
        problem.set_stiffness_dense(body, n, unsafe { input(k, entries, "k") }?, ld, storage)
    })
}

/// Gives position and direction of every unknown of a body, from which candidates for its null space are made.
///
/// The data is copied; calling again replaces it. Never called, and no null space given: the library finds the null space
/// from K. Shells and beams repeat nodes with rotations. After a failure the body
/// keeps what it had.
///
/// | argument | in/out | shape | rule |
/// |---|---|---|---|
/// | `p` | in | scalar | the handle |
/// | `body` | in | scalar | number of the body, from 0 |
/// | `dim` | in | scalar | numbers per position, 1 to 3 |
/// | `n` | in | scalar | unknowns of the body |
/// | `node` | in | n | label of the node of each unknown, any number |
/// | `dir` | in | n | 1 to 3: displacement along that axis; 4 to 6: rotation about axis 1 to 3 |
/// | `xyz` | in | ld * n | coordinate k of unknown i is xyz[k + ld i], length |
/// | `ld` | in | scalar | >= dim |
///
/// # Safety
/// The arrays have the given shapes.
#[no_mangle]
pub unsafe extern "C" fn feti_body_coordinates(
    p: *mut feti_problem,
    body: i64,
    dim: i32,
    n: i64,
    node: *const i32,
    dir: *const i32,
    xyz: *const f64,
    ld: i64,
) -> i32 {
    enter(p, call!(feti_body_coordinates(p, body, dim, n, node, dir, xyz, ld)), |problem| {
        let (body, n) = body_of_order(problem, body, n)?;
        let dim = match dim {
            1..=3 => dim as usize,
            _ => return Err(Error::argument("dim", format!("{dim} is not 1, 2 or 3")).value(f64::from(dim))),
        };
        let (entries, ld) = column_major(dim, n, ld, "ld")?;
        // SAFETY: shapes by the caller's word.
        let (node, dir) = unsafe { (input(node, n, "node")?, input(dir, n, "dir")?) };
        // SAFETY: ld (n - 1) + dim coordinates by the caller's word.
        problem.set_coordinates(body, dim, node, dir, unsafe { input(xyz, entries, "xyz") }?, ld)
    })
}

/// Gives the load of a body.
///
/// The load is copied and holds until it is given again; a body without one has zero load. After a failure the body keeps
/// the load it had.
///
/// | argument | in/out | shape | rule |
/// |---|---|---|---|
/// | `p` | in | scalar | the handle |
/// | `body` | in | scalar | number of the body, from 0 |
/// | `n` | in | scalar | unknowns of the body |
/// | `f` | in | n | force |
///
/// # Safety
/// The array has the given shape.
#[no_mangle]
pub unsafe extern "C" fn feti_body_load(p: *mut feti_problem, body: i64, n: i64, f: *const f64) -> i32 {
    enter(p, call!(feti_body_load(p, body, n, f)), |problem| {
        let (body, n) = body_of_order(problem, body, n)?;
        // SAFETY: n numbers by the caller's word.
        problem.set_load(body, unsafe { input(f, n, "f") }?)
    })
}

/// The body and its number of unknowns, which `n` must be: no array is read with a wrong length.
pub(super) fn body_of_order(problem: &Problem, body: i64, n: i64) -> Result<(usize, usize)> {
    let body = id(body, "body")?;
    let order = problem.order(body)?;
    same(n, order, "n", "the number of unknowns of the body is").map_err(|error| error.body(body))?;
    Ok((body, order))
}

fn storage_of(storage: i32) -> Result<Storage> {
    match storage {
        FETI_FULL => Ok(Storage::Full),
        FETI_LOWER => Ok(Storage::Lower),
        FETI_UPPER => Ok(Storage::Upper),
        _ => {
            let text = format!("{storage} is none of FETI_FULL, FETI_LOWER, FETI_UPPER");
            Err(Error::argument("storage", text).value(f64::from(storage)))
        }
    }
}

fn copy_only(flags: i32) -> Result<()> {
    if flags == FETI_COPY {
        return Ok(());
    }
    Err(Error::argument("flags", format!("{flags} is not FETI_COPY")).value(f64::from(flags)))
}
