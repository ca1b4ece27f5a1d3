//! Stiffness matrices of bodies: by rows, with a separate diagonal, dense.

use crate::bodies::body::body_of_order;
use crate::boundary::{
    base_of, borrowed, call, column_major, enter, input, meaning, numbers, pointers, twins, Call, Index,
};
use crate::header::types::{feti_problem, FETI_BORROW, FETI_COPY, FETI_FULL, FETI_LOWER, FETI_UPPER};
use feti_contact::error::{Error, Result};
use feti_contact::solver::{Columns, Problem, SparseInput, Storage};

twins! {
    /// Gives the stiffness matrix K of a body by rows, with 32-bit indices.
    ///
    /// Another call replaces pattern and values. The columns of a row may come in any order, but none twice. With
    /// FETI_FULL, K must be symmetric within option symmetry_tolerance; the library averages K_ij and K_ji. A diagonal
    /// entry that is negative, or 0 in a row with other entries, is refused by feti_setup, unless the motions of the
    /// body are FETI_SOFT (feti_body_null_space).
    ///
    /// With FETI_BORROW the library does not copy the values, nor 32-bit columns counted from 0, if storage is FETI_LOWER,
    /// columns ascend and every row ends with its diagonal entry. Otherwise it copies everything (see `borrowed` of
    /// feti_body_info). Borrowed arrays must stay readable and unchanged until the matrix is replaced or the problem is
    /// destroyed. There is one exception: the host may rewrite the values between two calls if its next call is
    /// feti_body_values with the same array.
    ///
    /// | argument | in/out | shape | rule |
    /// |---|---|---|---|
    /// | `p` | in | scalar | the handle |
    /// | `body` | in | scalar | number of the body, from 0 |
    /// | `n` | in | scalar | unknowns of the body |
    /// | `row_ptr` | in | n + 1 | row i holds the entries `row_ptr[i]` to `row_ptr[i + 1] - 1`; starts with `base` |
    /// | `col` | in | `row_ptr[n] - base` | columns, counted from `base` |
    /// | `val` | in | `row_ptr[n] - base` | entries of K, force per length |
    /// | `base` | in | scalar | 0 or 1: what `row_ptr` and `col` count from |
    /// | `storage` | in | scalar | FETI_FULL, FETI_LOWER or FETI_UPPER |
    /// | `flags` | in | scalar | FETI_COPY or FETI_BORROW |
    ///
    /// # Safety
    /// The arrays have the given shapes.
    fn feti_body_stiffness_i32, feti_body_stiffness_i64(
        p: *mut feti_problem, body: i64, n: i64, row_ptr: *const I, col: *const I, val: *const f64, base: i32,
        storage: i32, flags: i32,
    ) |call| {
        let matrix = SparseMatrix { n, row_ptr, col, val, base, storage, flags };
        // SAFETY: shapes guaranteed by the caller.
        unsafe { matrix.give(p, call, body, None) }
    }
}

twins! {
    /// Gives the stiffness matrix K of a body by rows with a separate diagonal, with 32-bit indices.
    ///
    /// For codes that store the diagonal in a separate array. Another call replaces pattern and values. The columns of
    /// a row may come in any order, but none twice. With FETI_FULL, K must be symmetric within option
    /// symmetry_tolerance; the library averages K_ij and K_ji. A diagonal entry that is negative, or 0 in a row with
    /// other entries, is refused by feti_setup, unless the motions of the body are FETI_SOFT (feti_body_null_space).
    ///
    /// | argument | in/out | shape | rule |
    /// |---|---|---|---|
    /// | `p` | in | scalar | the handle |
    /// | `body` | in | scalar | number of the body, from 0 |
    /// | `n` | in | scalar | unknowns of the body |
    /// | `diag` | in | n | K_ii, force per length |
    /// | `row_ptr` | in | n + 1 | row i holds the entries `row_ptr[i]` to `row_ptr[i + 1] - 1`; starts with `base` |
    /// | `col` | in | `row_ptr[n] - base` | columns, counted from `base`; never the diagonal entry |
    /// | `val` | in | `row_ptr[n] - base` | off-diagonal entries of K, force per length |
    /// | `base` | in | scalar | 0 or 1: what `row_ptr` and `col` count from |
    /// | `storage` | in | scalar | FETI_FULL, FETI_LOWER or FETI_UPPER |
    /// | `flags` | in | scalar | FETI_COPY, or FETI_BORROW, which also copies: the library cannot use a matrix in this form directly |
    ///
    /// # Safety
    /// The arrays have the given shapes.
    fn feti_body_stiffness_split_i32, feti_body_stiffness_split_i64(
        p: *mut feti_problem, body: i64, n: i64, diag: *const f64, row_ptr: *const I, col: *const I,
        val: *const f64, base: i32, storage: i32, flags: i32,
    ) |call| {
        let matrix = SparseMatrix { n, row_ptr, col, val, base, storage, flags };
        // SAFETY: shapes guaranteed by the caller.
        unsafe { matrix.give(p, call, body, Some(diag)) }
    }
}

/// Arguments of the four functions above.
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
    /// `diag`: a separate array of the diagonal.
    ///
    /// # Safety
    /// The arrays have the documented shapes.
    unsafe fn give(&self, p: *mut feti_problem, call: Call, body: i64, diag: Option<*const f64>) -> i32 {
        enter(p, call, |problem| {
            let (body, n) = body_of_order(problem, body, self.n)?;
            let (base, storage) = (base_of(self.base)?, storage_of(self.storage)?);
            let of_call = |error: Error| error.index_from(base);
            let borrow = borrows(self.flags)? && diag.is_none() && storage == Storage::Lower;
            // SAFETY: n numbers guaranteed by the caller.
            let diag = diag.map(|diag| unsafe { input(diag, n, "diag") }).transpose()?;
            // SAFETY: n + 1 positions guaranteed by the caller.
            let ptr = unsafe { pointers(self.row_ptr, n, base) }?;
            let entries = ptr.last().copied().unwrap_or(0);
            // SAFETY: the last position is the number of entries; the arrays stay, guaranteed by the caller.
            if borrow && entries > 0 && unsafe { self.borrow(problem, body, &ptr, base) }.map_err(of_call)? {
                return Ok(());
            }
            // SAFETY: the last position is the number of entries.
            let (col, val) =
                unsafe { (numbers(self.col, entries, base, "col")?, input(self.val, entries, "val")?) };
            let k = SparseInput { ptr: &ptr, col: &col, val, storage };
            let given = match diag {
                None => problem.set_stiffness(body, k),
                Some(diag) => problem.set_stiffness_split(body, diag, k),
            };
            given.map_err(of_call)
        })
    }

    /// Returns false if the matrix does not have the stored form.
    ///
    /// # Safety
    /// The arrays have as many entries as `ptr` says, and stay as documented.
    unsafe fn borrow(&self, problem: &mut Problem, body: usize, ptr: &[usize], base: i64) -> Result<bool> {
        let entries = ptr.last().copied().unwrap_or(0);
        // SAFETY: guaranteed by the caller.
        let (val, col) = unsafe { (borrowed(self.val, entries, "val")?, input(self.col, entries, "col")?) };
        let column = |at: usize| col[at].wide().saturating_sub(base);
        let columns = match I::unsigned(self.col).filter(|_| base == 0) {
            // SAFETY: guaranteed by the caller.
            Some(col) => Columns::Kept(unsafe { borrowed(col, entries, "col") }?),
            None => Columns::Given(&column),
        };
        problem.borrow_stiffness(body, ptr, columns, val)
    }
}

/// Gives the stiffness matrix K of a body as a dense matrix, for boundary elements and condensed bodies.
///
/// Another call replaces the matrix. With FETI_LOWER and FETI_UPPER the other triangle is not read. A diagonal entry
/// that is negative, or 0 in a row with other entries, is refused by feti_setup, unless the motions of the body are
/// FETI_SOFT (feti_body_null_space).
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
        meaning(flags, "flags", &[(FETI_COPY, ())], "not FETI_COPY")?;
        let (entries, ld) = column_major(n, n, ld, "ld")?;
        // SAFETY: ld (n - 1) + n entries guaranteed by the caller.
        problem.set_stiffness_dense(body, n, unsafe { input(k, entries, "k") }?, ld, storage)
    })
}

/// Whether the host's arrays may be used in place.
pub fn borrows(flags: i32) -> Result<bool> {
    let known = [(FETI_COPY, false), (FETI_BORROW, true)];
    meaning(flags, "flags", &known, "neither FETI_COPY nor FETI_BORROW")
}

pub fn storage_of(storage: i32) -> Result<Storage> {
    let known = [(FETI_FULL, Storage::Full), (FETI_LOWER, Storage::Lower), (FETI_UPPER, Storage::Upper)];
    meaning(storage, "storage", &known, "none of FETI_FULL, FETI_LOWER, FETI_UPPER")
}
