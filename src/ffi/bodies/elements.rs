//! Bodies by their elements: connectivity first, then the matrix of every element, pass by pass.

use crate::error::Result;
use crate::ffi::bodies::body::body_of_order;
use crate::ffi::boundary::{
    base, call, column_major, count, element_pointers, enter, id, input, meaning, numbers, same, Call, Index,
    Output,
};
use crate::ffi::header::types::{feti_problem, FETI_FULL, FETI_LOWER, FETI_UPPER};
use crate::platform::memory::zeros;
use crate::solver::{ElementStorage, Problem};

/// Says which unknowns the elements of a body join, with 32-bit indices: the first step of giving K by elements.
///
/// The matrices follow, by feti_body_element or feti_body_elements, each element once: all of K, in elements of any size
/// (springs to ground, penalties and multi-point constraints are small ones). Nothing is kept of an element: its matrix is
/// added to that of the body or, where the body is cut, to that of its piece. Loads, rows, results, certificate and diagnosis
/// are those of the body; the pieces show in feti_body_info and feti_body_pieces alone.
///
/// What the cut depends on comes before the first matrix: option `pieces` and the coordinates (feti_body_coordinates);
/// without coordinates it goes by the elements that unknowns share. Null spaces of pieces come from the coordinates or are
/// sought in K; a given null space of the whole body (feti_body_null_space) does not serve them. Of a body that is cut
/// feti_body_kplus, feti_body_fixing, feti_dual_apply and feti_dual_rhs are FETI_STATE.
///
/// A number below `base` is a held unknown, as equation numbers of older codes have it: row and column are left out of K, and
/// `base` - 1 - k is the held unknown k (with base 0: -1, -2, ...; with base 1: 0, -1, ...). All may have one number where
/// nobody asks for feti_body_held_forces. Where values are prescribed for them the host moves ke u0 to the load.
///
/// A matrix or functions given before are replaced. The same connectivity again begins a new pass on the old pattern and
/// cut. FETI_OVERFLOW beyond 2^32 - 1 unknowns and held ones. FETI_STATE from feti_setup and feti_solve where elements are
/// missing, with the first of them. After a failure the body keeps what it had.
///
/// | argument | in/out | shape | rule |
/// |---|---|---|---|
/// | `p` | in | scalar | the handle |
/// | `body` | in | scalar | number of the body, from 0 |
/// | `elements` | in | scalar | number of elements, > 0 |
/// | `ptr` | in | elements + 1 | element e joins the entries `ptr[e]` to `ptr[e + 1] - 1` of `dof`; starts with `base` |
/// | `dof` | in | `ptr[elements] - base` | unknowns in the order of the rows of the matrices, counted from `base`; below it: held |
/// | `base` | in | scalar | 0 or 1: what `ptr` and `dof` count from |
///
/// # Safety
/// The arrays have the given shapes.
#[no_mangle]
pub unsafe extern "C" fn feti_body_mesh_i32(
    p: *mut feti_problem,
    body: i64,
    elements: i64,
    ptr: *const i32,
    dof: *const i32,
    base: i32,
) -> i32 {
    let call = call!(feti_body_mesh_i32(p, body, elements, ptr, dof, base));
    // SAFETY: shapes by the caller's word.
    unsafe { give(p, call, body, (elements, ptr, dof, base)) }
}

/// Says which unknowns the elements of a body join, with 64-bit indices: the first step of giving K by elements.
///
/// The matrices follow, by feti_body_element or feti_body_elements, each element once: all of K, in elements of any size
/// (springs to ground, penalties and multi-point constraints are small ones). Nothing is kept of an element: its matrix is
/// added to that of the body or, where the body is cut, to that of its piece. Loads, rows, results, certificate and diagnosis
/// are those of the body; the pieces show in feti_body_info and feti_body_pieces alone.
///
/// What the cut depends on comes before the first matrix: option `pieces` and the coordinates (feti_body_coordinates);
/// without coordinates it goes by the elements that unknowns share. Null spaces of pieces come from the coordinates or are
/// sought in K; a given null space of the whole body (feti_body_null_space) does not serve them. Of a body that is cut
/// feti_body_kplus, feti_body_fixing, feti_dual_apply and feti_dual_rhs are FETI_STATE.
///
/// A number below `base` is a held unknown, as equation numbers of older codes have it: row and column are left out of K, and
/// `base` - 1 - k is the held unknown k (with base 0: -1, -2, ...; with base 1: 0, -1, ...). All may have one number where
/// nobody asks for feti_body_held_forces. Where values are prescribed for them the host moves ke u0 to the load.
///
/// A matrix or functions given before are replaced. The same connectivity again begins a new pass on the old pattern and
/// cut. FETI_OVERFLOW beyond 2^32 - 1 unknowns and held ones. FETI_STATE from feti_setup and feti_solve where elements are
/// missing, with the first of them. After a failure the body keeps what it had.
///
/// | argument | in/out | shape | rule |
/// |---|---|---|---|
/// | `p` | in | scalar | the handle |
/// | `body` | in | scalar | number of the body, from 0 |
/// | `elements` | in | scalar | number of elements, > 0 |
/// | `ptr` | in | elements + 1 | element e joins the entries `ptr[e]` to `ptr[e + 1] - 1` of `dof`; starts with `base` |
/// | `dof` | in | `ptr[elements] - base` | unknowns in the order of the rows of the matrices, counted from `base`; below it: held |
/// | `base` | in | scalar | 0 or 1: what `ptr` and `dof` count from |
///
/// # Safety
/// The arrays have the given shapes.
#[no_mangle]
pub unsafe extern "C" fn feti_body_mesh_i64(
    p: *mut feti_problem,
    body: i64,
    elements: i64,
    ptr: *const i64,
    dof: *const i64,
    base: i32,
) -> i32 {
    let call = call!(feti_body_mesh_i64(p, body, elements, ptr, dof, base));
    // SAFETY: shapes by the caller's word.
    unsafe { give(p, call, body, (elements, ptr, dof, base)) }
}

/// # Safety
/// `given` is a number of elements with their positions, unknowns and base, of the documented shapes.
unsafe fn give<I: Index>(
    p: *mut feti_problem,
    call: Call,
    body: i64,
    given: (i64, *const I, *const I, i32),
) -> i32 {
    enter(p, call, |problem| {
        let (elements, ptr, dof, from) = given;
        let body = id(body, "body")?;
        problem.order(body)?;
        let (elements, base) = (count(elements, "elements")?, base(from)?);
        // SAFETY: elements + 1 positions by the caller's word.
        let ptr = unsafe { element_pointers(ptr, elements, base) }?;
        let entries = ptr.last().copied().unwrap_or(0);
        // SAFETY: the last position is the number of entries.
        let dof = unsafe { numbers(dof, entries, base, "dof") }?;
        problem.set_mesh(body, &ptr, &dof).map_err(|error| error.index_from(base))
    })
}

/// Adds the stiffness matrix of one element, from the host's own assembly loop.
///
/// The matrix is added at once and not kept. It must be symmetric within option symmetry_tolerance and is averaged; it may be
/// indefinite, only what has been added up is judged, by feti_setup. Elements come in any order, each once: FETI_STATE for one
/// that has come already, and before feti_body_mesh. With the last one the matrix of the body is complete, and the next
/// element begins a new pass: new values on the old pattern and cut, with no analysis, as in a Newton loop. Until that pass
/// is complete the body has no matrix. Threads that assemble side by side meet FETI_BUSY: they hand over blocks, by
/// feti_body_elements. An error names the element. After a failure nothing of the element is added.
///
/// | argument | in/out | shape | rule |
/// |---|---|---|---|
/// | `p` | in | scalar | the handle |
/// | `body` | in | scalar | number of the body, from 0 |
/// | `e` | in | scalar | number of the element, from 0 |
/// | `n` | in | scalar | unknowns that the element joins, held ones included |
/// | `ke` | in | ld * n | column-major: ke_ij is ke[i + ld j], force per length |
/// | `ld` | in | scalar | >= n |
///
/// # Safety
/// The array has the given shape.
#[no_mangle]
pub unsafe extern "C" fn feti_body_element(
    p: *mut feti_problem,
    body: i64,
    e: i64,
    n: i64,
    ke: *const f64,
    ld: i64,
) -> i32 {
    enter(p, call!(feti_body_element(p, body, e, n, ke, ld)), |problem| {
        let (body, e) = (id(body, "body")?, id(e, "e")?);
        let size = problem.size_of_element(body, e)?;
        let n = same(n, size, "n", "the number of unknowns of the element is")
            .map_err(|error| error.body(body).element(e))?;
        let (entries, ld) = column_major(n, n, ld, "ld").map_err(|error| error.body(body).element(e))?;
        // SAFETY: ld (n - 1) + n entries by the caller's word.
        problem.add_element(body, e, n, unsafe { input(ke, entries, "ke") }?, ld)
    })
}

/// Adds the stiffness matrices of a block of elements, one after the other.
///
/// As feti_body_element for each of them. With FETI_FULL every matrix is n x n, column-major. With FETI_LOWER it is the lower
/// triangle column by column, as in the elemental format of MUMPS (the upper triangle row by row is the same), with FETI_UPPER
/// the upper triangle column by column: n (n + 1) / 2 numbers. The n of an element is that of feti_body_mesh;
/// feti_body_elements_size tells how many numbers a block has. FETI_STATE for an element that has come already, and before
/// feti_body_mesh. An error names the element; its entry counts within the matrix of that element. After a failure none of the
/// block is added.
///
/// | argument | in/out | shape | rule |
/// |---|---|---|---|
/// | `p` | in | scalar | the handle |
/// | `body` | in | scalar | number of the body, from 0 |
/// | `first` | in | scalar | number of the first element, from 0 |
/// | `count` | in | scalar | number of elements |
/// | `ke` | in | sum of n^2 or n (n + 1) / 2 | entries of the matrices, force per length |
/// | `storage` | in | scalar | FETI_FULL, FETI_LOWER or FETI_UPPER |
///
/// # Safety
/// The array has the given shape.
#[no_mangle]
pub unsafe extern "C" fn feti_body_elements(
    p: *mut feti_problem,
    body: i64,
    first: i64,
    count: i64,
    ke: *const f64,
    storage: i32,
) -> i32 {
    enter(p, call!(feti_body_elements(p, body, first, count, ke, storage)), |problem| {
        let (body, first, count, storage) = block(problem, body, first, count, storage)?;
        let entries = problem.values_of_elements(body, first, count, storage)?;
        // SAFETY: as many entries by the caller's word.
        problem.add_elements(body, first, count, unsafe { input(ke, entries, "ke") }?, storage)
    })
}

/// Tells how many numbers the matrices of a block of elements take in feti_body_elements.
///
/// FETI_STATE before feti_body_mesh. After a failure nothing is written.
///
/// | argument | in/out | shape | rule |
/// |---|---|---|---|
/// | `p` | in | scalar | the handle |
/// | `body` | in | scalar | number of the body, from 0 |
/// | `first` | in | scalar | number of the first element, from 0 |
/// | `count` | in | scalar | number of elements |
/// | `storage` | in | scalar | FETI_FULL, FETI_LOWER or FETI_UPPER |
/// | `nnz` | out | scalar | sum of n^2, or of n (n + 1) / 2 for the triangles |
///
/// # Safety
/// `nnz` has room for one number.
#[no_mangle]
pub unsafe extern "C" fn feti_body_elements_size(
    p: *mut feti_problem,
    body: i64,
    first: i64,
    count: i64,
    storage: i32,
    nnz: *mut i64,
) -> i32 {
    enter(p, call!(feti_body_elements_size(p, body, first, count, storage, nnz)), |problem| {
        let (body, first, count, storage) = block(problem, body, first, count, storage)?;
        // SAFETY: the caller gives room for one number.
        let number = unsafe { Output::new(nnz, 1, "nnz") }?;
        number.set(problem.values_of_elements(body, first, count, storage)? as i64);
        Ok(())
    })
}

/// Body, first element, number and storage of a block, all of them there.
fn block(
    problem: &Problem,
    body: i64,
    first: i64,
    number: i64,
    storage: i32,
) -> Result<(usize, usize, usize, ElementStorage)> {
    let (body, first) = (id(body, "body")?, id(first, "first")?);
    let count = count(number, "count")?;
    problem.check_first_element(body, first)?;
    let known = [
        (FETI_FULL, ElementStorage::Full),
        (FETI_LOWER, ElementStorage::Lower),
        (FETI_UPPER, ElementStorage::Upper),
    ];
    let storage = meaning(storage, "storage", &known, "none of FETI_FULL, FETI_LOWER, FETI_UPPER")?;
    Ok((body, first, count, storage))
}

/// Reads what the held unknowns of a body take up in the last answer: K_hf u, their rows of K times the displacement.
///
/// Held unknowns are those with numbers below `base` in feti_body_mesh_i32 or _i64, k for the number `base` - 1 - k. The force
/// is that with which the supports hold the body, but for what prescribed values add (ke u0, which the host has moved to the
/// load) and for loads on the held unknowns themselves, which the host takes off. FETI_STATE for a body that was
/// not given by its elements, and before a solve has given an answer. After a failure nothing is written.
///
/// | argument | in/out | shape | rule |
/// |---|---|---|---|
/// | `p` | in | scalar | the handle |
/// | `body` | in | scalar | number of the body, from 0 |
/// | `n` | in | scalar | held unknowns that are asked for: 0 to n - 1 |
/// | `r` | out | n | force; 0 for a number that no element has |
///
/// # Safety
/// The array has the given shape.
#[no_mangle]
pub unsafe extern "C" fn feti_body_held_forces(p: *mut feti_problem, body: i64, n: i64, r: *mut f64) -> i32 {
    enter(p, call!(feti_body_held_forces(p, body, n, r)), |problem| {
        let (body, n) = (id(body, "body")?, count(n, "n")?);
        // SAFETY: room for n numbers by the caller's word.
        let output = unsafe { Output::new(r, n, "r") }?;
        let mut forces = zeros(n, "the forces of held unknowns")?;
        problem.held_forces(body, &mut forces)?;
        output.write(&forces);
        Ok(())
    })
}

/// Tells the piece of every unknown of a body, for pictures and for choosing option `pieces`.
///
/// Pieces count from 0; an unknown of several pieces has the first of them. All are 0 in a body that is not cut. FETI_STATE
/// before its matrix, or all of its elements, have been given. After a failure nothing is written.
///
/// | argument | in/out | shape | rule |
/// |---|---|---|---|
/// | `p` | in | scalar | the handle |
/// | `body` | in | scalar | number of the body, from 0 |
/// | `n` | in | scalar | unknowns of the body |
/// | `piece` | out | n | piece of each unknown, from 0 |
///
/// # Safety
/// The array has the given shape.
#[no_mangle]
pub unsafe extern "C" fn feti_body_pieces(p: *mut feti_problem, body: i64, n: i64, piece: *mut i64) -> i32 {
    enter(p, call!(feti_body_pieces(p, body, n, piece)), |problem| {
        let (body, n) = body_of_order(problem, body, n)?;
        // SAFETY: room for n numbers by the caller's word.
        let output = unsafe { Output::new(piece, n, "piece") }?;
        let pieces = problem.pieces(body)?;
        pieces.iter().enumerate().for_each(|(dof, piece)| output.write_at(dof, &[i64::from(*piece)]));
        Ok(())
    })
}
