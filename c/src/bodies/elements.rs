//! Bodies given by elements: first the connectivity, then the matrices of all elements, in passes.

use crate::bodies::body::body_of_order;
use crate::boundary::{
    base_of, call, column_major, count, element_pointers, enter, id, input, meaning, numbers, same, twins,
    Output,
};
use crate::header::types::{feti_problem, FETI_FULL, FETI_LOWER, FETI_UPPER};
use feti_contact::error::Result;
use feti_contact::solver::{ElementStorage, Problem};

twins! {
    /// Gives the connectivity of the elements of a body, with 32-bit indices: the first step of giving K by elements.
    ///
    /// Then give the element matrices with feti_body_element or feti_body_elements, each element once. Together they must
    /// form all of K; elements may have any size (springs to ground, penalties and multi-point constraints are small
    /// elements). The library adds each element matrix to the matrix of the body or, if the body is cut, of its piece, and
    /// keeps nothing else of the element. Loads, rows, results, certificate and diagnosis refer to the body; only
    /// feti_body_info and feti_body_pieces show the pieces.
    ///
    /// Before the first matrix, give what the cut depends on: option `pieces` and the coordinates (feti_body_coordinates).
    /// Without coordinates the library cuts the body by its connectivity. The null spaces of the pieces come from the
    /// coordinates or are computed from K; a null space of the whole body (feti_body_null_space) is not used for them. If a
    /// body is cut, feti_body_kplus, feti_body_fixing, feti_dual_apply and feti_dual_rhs return FETI_STATE.
    ///
    /// A number below `base` means a held unknown, as in the equation numbers of older codes: its row and column are left out
    /// of K. The number `base` - 1 - k means held unknown k (with base 0: -1, -2, ...; with base 1: 0, -1, ...). If
    /// feti_body_held_forces is not used, all held unknowns may have the same number. If held unknowns have prescribed values
    /// u0, the host subtracts ke u0 from the load.
    ///
    /// The call replaces a matrix or functions given before. Another call with the same connectivity begins a new pass
    /// with the same pattern and the same cut. FETI_OVERFLOW if there are more than 2^32 - 1 unknowns and held
    /// unknowns. FETI_STATE from feti_setup and feti_solve if elements are missing; the error detail names the first
    /// missing element.
    ///
    /// | argument | in/out | shape | rule |
    /// |---|---|---|---|
    /// | `p` | in | scalar | the handle |
    /// | `body` | in | scalar | number of the body, from 0 |
    /// | `elements` | in | scalar | number of elements, > 0 |
    /// | `ptr` | in | elements + 1 | element e joins the entries `ptr[e]` to `ptr[e + 1] - 1` of `dof`; starts with `base` |
    /// | `dof` | in | `ptr[elements] - base` | unknowns in the order of the rows of the element matrices, counted from `base`; below `base`: held |
    /// | `base` | in | scalar | 0 or 1: what `ptr` and `dof` count from |
    ///
    /// # Safety
    /// The arrays have the given shapes.
    fn feti_body_mesh_i32, feti_body_mesh_i64(
        p: *mut feti_problem, body: i64, elements: i64, ptr: *const I, dof: *const I, base: i32,
    ) |call| {
        enter(p, call, |problem| {
            let body = id(body, "body")?;
            problem.order(body)?;
            let (elements, base) = (count(elements, "elements")?, base_of(base)?);
            // SAFETY: elements + 1 positions guaranteed by the caller.
            let ptr = unsafe { element_pointers(ptr, elements, base) }?;
            let entries = ptr.last().copied().unwrap_or(0);
            // SAFETY: the last position is the number of entries.
            let dof = unsafe { numbers(dof, entries, base, "dof") }?;
            problem.set_mesh(body, &ptr, &dof).map_err(|error| error.index_from(base))
        })
    }
}

/// Adds the stiffness matrix of one element; call it from the host's assembly loop.
///
/// The library adds the matrix at once and does not keep it. The matrix must be symmetric within option
/// symmetry_tolerance; the library averages ke_ij and ke_ji. An element matrix may be indefinite: feti_setup checks
/// only the assembled matrix. Elements may come in any order, each once. FETI_STATE if the element was given already,
/// and before feti_body_mesh. With the last element the matrix of the body is complete. The next element begins a new
/// pass: new values with the same pattern and cut, without a new analysis, as in a Newton loop. Until this pass is
/// complete the body has no matrix. If several threads assemble at the same time, such calls return FETI_BUSY: the
/// threads should collect blocks for feti_body_elements. The error detail names the element.
///
/// | argument | in/out | shape | rule |
/// |---|---|---|---|
/// | `p` | in | scalar | the handle |
/// | `body` | in | scalar | number of the body, from 0 |
/// | `e` | in | scalar | number of the element, from 0 |
/// | `n` | in | scalar | unknowns of the element, including held ones |
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
        // SAFETY: ld (n - 1) + n entries guaranteed by the caller.
        problem.add_element(body, e, n, unsafe { input(ke, entries, "ke") }?, ld)
    })
}

/// Adds the stiffness matrices of a block of elements, one after the other.
///
/// The call works like feti_body_element for each element. With FETI_FULL every matrix is n x n, column-major. With
/// FETI_LOWER it is the lower triangle column by column, as in the elemental format of MUMPS (this equals the upper
/// triangle row by row); with FETI_UPPER it is the upper triangle column by column. Each triangle has n (n + 1) / 2
/// numbers. The n of an element follows from feti_body_mesh; feti_body_elements_size returns how many numbers a block
/// has. FETI_STATE if an element was given already, and before feti_body_mesh. The error detail names the element and
/// the entry within its matrix.
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
        // SAFETY: as many entries guaranteed by the caller.
        problem.add_elements(body, first, count, unsafe { input(ke, entries, "ke") }?, storage)
    })
}

/// Returns how many numbers feti_body_elements expects for a block of elements.
///
/// FETI_STATE before feti_body_mesh.
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

/// Body, first element, number and storage of a block of existing elements.
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

/// Reads the forces on the held unknowns of a body in the last answer: K_hf u, their rows of K times the displacement.
///
/// Held unknowns have numbers below `base` in feti_body_mesh_i32 or _i64: held unknown k has the number `base` - 1 - k.
/// The result is the support reaction without two parts, which the host accounts for: the part of prescribed values
/// (the host moved ke u0 to the load), which must be added, and loads on the held unknowns themselves, which must be
/// subtracted. FETI_STATE if the body was not given by its elements, and if no solve has given an answer yet.
///
/// | argument | in/out | shape | rule |
/// |---|---|---|---|
/// | `p` | in | scalar | the handle |
/// | `body` | in | scalar | number of the body, from 0 |
/// | `n` | in | scalar | length of `r`: held unknowns 0 to n - 1 are read, also if the body has more or fewer; at most the number of its unknowns, or of its held ones |
/// | `r` | out | n | force; 0 for a held unknown that no element has |
///
/// # Safety
/// The array has the given shape.
#[no_mangle]
pub unsafe extern "C" fn feti_body_held_forces(p: *mut feti_problem, body: i64, n: i64, r: *mut f64) -> i32 {
    enter(p, call!(feti_body_held_forces(p, body, n, r)), |problem| {
        let (body, n) = (id(body, "body")?, count(n, "n")?);
        // SAFETY: room for n numbers guaranteed by the caller.
        let output = unsafe { Output::new(r, n, "r") }?;
        output.write(&problem.held_forces(body, n)?);
        Ok(())
    })
}

/// Reads the piece of every unknown of a body, for pictures and for choosing option `pieces`.
///
/// Pieces count from 0. An unknown that belongs to several pieces gets the first one. If the body is not cut, all
/// numbers are 0. FETI_STATE before the matrix of the body, or all of its elements, have been given.
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
        // SAFETY: room for n numbers guaranteed by the caller.
        let output = unsafe { Output::new(piece, n, "piece") }?;
        let pieces = problem.pieces(body)?;
        pieces.iter().enumerate().for_each(|(dof, piece)| output.write_at(dof, &[i64::from(*piece)]));
        Ok(())
    })
}
