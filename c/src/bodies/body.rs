//! Bodies: their size, coordinates and load.

use crate::boundary::{call, column_major, count, enter, id, input, meaning, same, Output};
use crate::header::types::{feti_problem, FETI_ALL, FETI_CANDIDATES, FETI_EXACT, FETI_SOFT};
use feti_contact::error::{Error, Result};
use feti_contact::solver::{Modes, Problem};

/// Adds a body with `n` unknowns.
///
/// Bodies are numbered from 0 in the order in which they are added. FETI_OVERFLOW if all bodies together would have
/// more than 2^63 - 1 unknowns.
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

/// Above this number of unknowns, ld = n means that the array is n x dim, and would be read beyond its end.
const FEW: usize = 12;

/// Gives position and direction of every unknown of a body; the library computes candidates for the null space from them.
///
/// Another call replaces the data. If you give neither coordinates nor a null space, the library finds the null space
/// from K. A null space given by feti_body_null_space takes precedence over the coordinates. If K has a small positive
/// or negative stiffness along the rigid body motions, see feti_body_coordinates_flags. Shells and beams list a node
/// again for its rotations.
///
/// | argument | in/out | shape | rule |
/// |---|---|---|---|
/// | `p` | in | scalar | the handle |
/// | `body` | in | scalar | number of the body, from 0 |
/// | `dim` | in | scalar | numbers per position, 1 to 3 |
/// | `n` | in | scalar | unknowns of the body |
/// | `node` | in | n | label of the node of each unknown: any number |
/// | `dir` | in | n | 1 to 3: displacement along that axis; 4 to 6: rotation about axis 1 to 3 |
/// | `xyz` | in | ld * n | coordinate k of unknown i is xyz[k + ld i], length |
/// | `ld` | in | scalar | >= dim: distance of the coordinates of one unknown from those of the next, dim in an array without gaps; n, beyond 12 unknowns, is refused |
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
        let dim = meaning(dim, "dim", &[(1, 1), (2, 2), (3, 3)], "not 1, 2 or 3")?;
        let (entries, ld) = column_major(dim, n, ld, "ld")?;
        if ld == n && n > FEW {
            let text = format!(
                "ld is {ld}, the number of unknowns: coordinates lie unknown by unknown, xyz[k + ld i], so that ld is {dim} in an \
                 array without gaps"
            );
            return Err(Error::argument("ld", text).body(body).value(ld as f64).limit(dim as f64));
        }
        // SAFETY: shapes guaranteed by the caller.
        let (node, dir) = unsafe { (input(node, n, "node")?, input(dir, n, "dir")?) };
        // SAFETY: ld (n - 1) + dim coordinates guaranteed by the caller.
        problem.set_coordinates(body, dim, node, dir, unsafe { input(xyz, entries, "xyz") }?, ld)
    })
}

/// The meaning of motions.
pub(super) fn modes(flags: i32) -> Result<Modes> {
    let known = [(FETI_EXACT, Modes::Exact), (FETI_CANDIDATES, Modes::Candidates), (FETI_SOFT, Modes::Soft)];
    meaning(flags, "flags", &known, "none of FETI_EXACT, FETI_CANDIDATES, FETI_SOFT")
}

/// Says how to use the rigid body motions that the coordinates give: as candidates for the null space, as the null space, or
/// as motions that K resists weakly.
///
/// The flag applies to all coordinates of the body (feti_body_coordinates), whether they are given before or after this
/// call; the default is FETI_CANDIDATES. With FETI_EXACT you declare that the body floats as a whole: feti_setup
/// refuses the body, and names the unknown, if K resists a rigid body motion by more than rounding, for example because
/// a coefficient is missing. With FETI_SOFT, weak springs, rounding of the entries of K, geometric stiffness and
/// supports may give the motions a positive or negative stiffness, and the motions need not be exact. The library
/// computes the motions and their stiffness from K and takes them into account exactly, as it does for motions given to
/// feti_body_null_space with FETI_SOFT. That function also describes what happens if K is indefinite or has further
/// null vectors. The flag has no effect without coordinates or if a null space was given. FETI_UNSUPPORTED from
/// feti_setup if the host provides K+ (feti_body_operator).
///
/// | argument | in/out | shape | rule |
/// |---|---|---|---|
/// | `p` | in | scalar | the handle |
/// | `body` | in | scalar | number of the body, from 0 |
/// | `flags` | in | scalar | FETI_EXACT, FETI_CANDIDATES or FETI_SOFT |
#[no_mangle]
pub extern "C" fn feti_body_coordinates_flags(p: *mut feti_problem, body: i64, flags: i32) -> i32 {
    enter(p, call!(feti_body_coordinates_flags(p, body, flags)), |problem| {
        problem.set_coordinate_modes(id(body, "body")?, modes(flags)?)
    })
}

/// Gives the load of a body.
///
/// The load stays valid until the next call replaces it; without a call the load of a body is zero. With FETI_ALL the
/// array holds the loads of all bodies. If the bodies have numbers of the host, the array uses these numbers, and
/// entries that belong to no unknown are ignored; otherwise it holds one body after the other. If several unknowns
/// share one number (option glue), the load acts on the unknown of the first body. FETI_STATE with FETI_ALL if some
/// bodies have numbers of the host and others have none.
///
/// | argument | in/out | shape | rule |
/// |---|---|---|---|
/// | `p` | in | scalar | the handle |
/// | `body` | in | scalar | number of the body, from 0, or FETI_ALL |
/// | `n` | in | scalar | unknowns of the body; with FETI_ALL at least those of the table (feti_dof_table_i32), or the largest number + 1, or without both the unknowns of all bodies |
/// | `f` | in | n | force |
///
/// # Safety
/// The array has the given shape.
#[no_mangle]
pub unsafe extern "C" fn feti_body_load(p: *mut feti_problem, body: i64, n: i64, f: *const f64) -> i32 {
    enter(p, call!(feti_body_load(p, body, n, f)), |problem| {
        if body == FETI_ALL {
            let n = whole(problem, n)?;
            // SAFETY: n numbers guaranteed by the caller.
            return problem.set_all_loads(unsafe { input(f, n, "f") }?);
        }
        let (body, n) = body_of_order(problem, body, n)?;
        // SAFETY: n numbers guaranteed by the caller.
        problem.set_load(body, unsafe { input(f, n, "f") }?)
    })
}

/// The length of an array over the unknowns of all bodies, after a check of `n`.
pub(crate) fn whole(problem: &Problem, n: i64) -> Result<usize> {
    let n = count(n, "n")?;
    problem.check_whole(n)?;
    Ok(n)
}

/// The body and its number of unknowns; `n` must be equal, so that no array is read with a wrong length.
pub(crate) fn body_of_order(problem: &Problem, body: i64, n: i64) -> Result<(usize, usize)> {
    let body = id(body, "body")?;
    let order = problem.order(body)?;
    same(n, order, "n", "the number of unknowns of the body is").map_err(|error| error.body(body))?;
    Ok((body, order))
}
