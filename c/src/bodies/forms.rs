//! Stiffness matrices of bodies by their profile and by triplets, which the library converts to rows.

use crate::bodies::body::body_of_order;
use crate::bodies::stiffness::{borrows, storage_of};
use crate::boundary::{
    base_of, column_pointers, count, enter, input, input_or_none, meaning, numbers, twins,
};
use crate::header::types::{feti_problem, FETI_SKYLINE_DOWN, FETI_SKYLINE_UP};
use feti_contact::solver::{Direction, SkylineInput, TripletInput};

twins! {
    /// Gives the stiffness matrix K of a body by its profile (skyline), with 32-bit indices.
    ///
    /// Column j of the upper triangle has all values between its first entry and the diagonal. With FETI_SKYLINE_DOWN and
    /// without `diag` they go from the first entry down to the diagonal, with FETI_SKYLINE_UP from the diagonal up; with
    /// `diag` the diagonal entry is not among them. COLSOL of Bathe has FETI_SKYLINE_UP, base 1, MAXA as `ptr` and A as `val`.
    /// FEAP has FETI_SKYLINE_DOWN, AD as `diag`, AU as `val`, and as `ptr` with base 0 a zero before JP(1) to JP(n).
    ///
    /// Another call replaces pattern and values. Zeros of the profile beside the diagonal are no entries of K; K is the matrix
    /// that has its other entries by rows. feti_body_values gives new values, or feti_body_values_split with `diag`. A diagonal
    /// entry that is negative, or 0 in a column with other entries, is refused by feti_setup, unless the motions of the body are
    /// FETI_SOFT (feti_body_null_space).
    ///
    /// | argument | in/out | shape | rule |
    /// |---|---|---|---|
    /// | `p` | in | scalar | the handle |
    /// | `body` | in | scalar | number of the body, from 0 |
    /// | `n` | in | scalar | unknowns of the body |
    /// | `diag` | in | n | K_ii, force per length; NULL: the columns contain the diagonal |
    /// | `ptr` | in | n + 1 | column j has the values `ptr[j]` to `ptr[j + 1] - 1`; starts with `base` |
    /// | `val` | in | `ptr[n] - base` | entries of K, force per length |
    /// | `base` | in | scalar | 0 or 1: what `ptr` counts from |
    /// | `direction` | in | scalar | FETI_SKYLINE_DOWN or FETI_SKYLINE_UP |
    /// | `flags` | in | scalar | FETI_COPY, or FETI_BORROW, which also copies: the library cannot use a matrix in this form directly |
    ///
    /// # Safety
    /// The arrays have the given shapes.
    fn feti_body_stiffness_skyline_i32, feti_body_stiffness_skyline_i64(
        p: *mut feti_problem, body: i64, n: i64, diag: *const f64, ptr: *const I, val: *const f64, base: i32,
        direction: i32, flags: i32,
    ) |call| {
        enter(p, call, |problem| {
            let (body, n) = body_of_order(problem, body, n)?;
            let base = base_of(base)?;
            let known = [(FETI_SKYLINE_DOWN, Direction::Down), (FETI_SKYLINE_UP, Direction::Up)];
            let direction = meaning(direction, "direction", &known, "neither FETI_SKYLINE_DOWN nor FETI_SKYLINE_UP")?;
            borrows(flags)?;
            // SAFETY: n numbers or NULL, guaranteed by the caller.
            let diag = unsafe { input_or_none(diag, n, "diag") }?;
            // SAFETY: n + 1 positions guaranteed by the caller.
            let ptr = unsafe { column_pointers(ptr, n, base) }?;
            // SAFETY: the last position is the number of values.
            let val = unsafe { input(val, ptr.last().copied().unwrap_or(0), "val") }?;
            let given = problem.set_stiffness_skyline(body, diag, SkylineInput { ptr: &ptr, val, direction });
            given.map_err(|error| error.index_from(base))
        })
    }
}

twins! {
    /// Gives the stiffness matrix K of a body by triplets of row, column and value, with 32-bit indices.
    ///
    /// The triplets may come in any order. Values at one place are added in their order: a host may pass the entries of its
    /// element matrices one after the other. Another call replaces pattern and values; feti_body_values gives new values in the
    /// same order. With FETI_FULL both triangles are given, and K must be symmetric within option symmetry_tolerance; the library
    /// averages K_ij and K_ji. A diagonal entry that is negative, or 0 in a row with other entries, is refused by feti_setup,
    /// unless the motions of the body are FETI_SOFT (feti_body_null_space).
    ///
    /// | argument | in/out | shape | rule |
    /// |---|---|---|---|
    /// | `p` | in | scalar | the handle |
    /// | `body` | in | scalar | number of the body, from 0 |
    /// | `n` | in | scalar | unknowns of the body |
    /// | `nnz` | in | scalar | number of triplets |
    /// | `row` | in | nnz | rows, counted from `base` |
    /// | `col` | in | nnz | columns, counted from `base` |
    /// | `val` | in | nnz | values, force per length |
    /// | `base` | in | scalar | 0 or 1: what `row` and `col` count from |
    /// | `storage` | in | scalar | FETI_FULL, FETI_LOWER or FETI_UPPER |
    /// | `flags` | in | scalar | FETI_COPY, or FETI_BORROW, which also copies: the library cannot use a matrix in this form directly |
    ///
    /// # Safety
    /// The arrays have the given shapes.
    fn feti_body_stiffness_triplets_i32, feti_body_stiffness_triplets_i64(
        p: *mut feti_problem, body: i64, n: i64, nnz: i64, row: *const I, col: *const I, val: *const f64, base: i32,
        storage: i32, flags: i32,
    ) |call| {
        enter(p, call, |problem| {
            let (body, n) = body_of_order(problem, body, n)?;
            let nnz = count(nnz, "nnz")?;
            let (base, storage) = (base_of(base)?, storage_of(storage)?);
            borrows(flags)?;
            // SAFETY: nnz numbers each, guaranteed by the caller.
            let (row, col, val) = unsafe {
                (numbers(row, nnz, base, "row")?, numbers(col, nnz, base, "col")?, input(val, nnz, "val")?)
            };
            let given = problem.set_stiffness_triplets(body, n, TripletInput { row: &row, col: &col, val, storage });
            given.map_err(|error| error.index_from(base))
        })
    }
}
