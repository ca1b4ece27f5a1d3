//! Null spaces of the bodies: the columns of R span all u with K u = 0.

use crate::bodies::body::{body_of_order, modes};
use crate::boundary::{call, column_major, count, enter, id, input, numbers, same, Output};
use crate::header::types::feti_problem;
use feti_contact::error::{Error, INDEX};
use feti_contact::platform::memory::reserved;
use feti_contact::solver::Modes;

/// Gives a basis of the null space of a body, candidates for the null space, or motions that K resists weakly.
///
/// Another call replaces the basis. If you do not call this function, the coordinates of the unknowns give candidates
/// (feti_body_coordinates); without coordinates the library finds the null space from K. feti_setup checks that `K R =
/// 0` holds. With FETI_SOFT this equation need not hold: weak springs, rounding of the entries of K and geometric
/// stiffness may give the motions a positive or negative stiffness, and diagonal entries of K may be negative. The
/// columns then only choose the fixing unknowns; the library computes the motions and their stiffness from K and takes
/// them into account exactly. If K is still indefinite or singular with these unknowns fixed, the library fixes up to
/// six more, each with its own column in feti_body_null_space_get. FETI_UNSUPPORTED from feti_setup if the host
/// provides K+ (feti_body_operator); FETI_INDEFINITE from feti_setup if K has negative stiffness along more motions
/// than that, and from feti_solve if the contact does not restrain a motion with negative stiffness.
///
/// | argument | in/out | shape | rule |
/// |---|---|---|---|
/// | `p` | in | scalar | the handle |
/// | `body` | in | scalar | number of the body, from 0 |
/// | `r` | in | scalar | columns; 0 with FETI_EXACT claims that K is not singular, as feti_body_no_null_space does |
/// | `n` | in | scalar | unknowns of the body |
/// | `basis` | in | ldr * r | column-major: R_ij is basis[i + ldr j]; may be NULL when r = 0 |
/// | `ldr` | in | scalar | >= n |
/// | `flags` | in | scalar | FETI_EXACT, FETI_CANDIDATES or FETI_SOFT |
///
/// # Safety
/// The array has the given shape.
#[no_mangle]
pub unsafe extern "C" fn feti_body_null_space(
    p: *mut feti_problem,
    body: i64,
    r: i64,
    n: i64,
    basis: *const f64,
    ldr: i64,
    flags: i32,
) -> i32 {
    enter(p, call!(feti_body_null_space(p, body, r, n, basis, ldr, flags)), |problem| {
        let (body, n) = body_of_order(problem, body, n)?;
        let r = count(r, "r")?;
        let modes = modes(flags)?;
        let (entries, ldr) = column_major(n, r, ldr, "ldr")?;
        // SAFETY: ldr (r - 1) + n entries guaranteed by the caller.
        problem.set_null_space(body, n, r, unsafe { input(basis, entries, "basis") }?, ldr, modes)
    })
}

/// Says that a body has no null space: its supports hold it, K is not singular.
///
/// As feti_body_null_space with no columns and FETI_EXACT; that K is not singular is checked in feti_setup. Calling
/// feti_body_null_space afterwards replaces it.
///
/// | argument | in/out | shape | rule |
/// |---|---|---|---|
/// | `p` | in | scalar | the handle |
/// | `body` | in | scalar | number of the body, from 0 |
#[no_mangle]
pub extern "C" fn feti_body_no_null_space(p: *mut feti_problem, body: i64) -> i32 {
    enter(p, call!(feti_body_no_null_space(p, body)), |problem| {
        let body = id(body, "body")?;
        let n = problem.order(body)?;
        problem.set_null_space(body, n, 0, &[], n, Modes::Exact)
    })
}

/// Reads the null space that the library uses for a body.
///
/// Runs feti_setup when it is due; on several ranks as feti_body_kplus. If K is not connected, the columns are those of
/// one connected part after the other, zero on all other parts. Unknowns without stiffness that no row and no load touches have no column.
///
/// | argument | in/out | shape | rule |
/// |---|---|---|---|
/// | `p` | in | scalar | the handle |
/// | `body` | in | scalar | number of the body, from 0 |
/// | `n` | in | scalar | unknowns of the body |
/// | `r` | in/out | scalar | in: columns that fit in `basis`, ignored without `basis`; out: dimension of the null space |
/// | `basis` | out | ldr * r | column-major; NULL: only the dimension is returned |
/// | `ldr` | in | scalar | >= n; ignored without `basis` |
///
/// # Safety
/// The arrays have the given shapes.
#[no_mangle]
pub unsafe extern "C" fn feti_body_null_space_get(
    p: *mut feti_problem,
    body: i64,
    n: i64,
    r: *mut i64,
    basis: *mut f64,
    ldr: i64,
) -> i32 {
    enter(p, call!(feti_body_null_space_get(p, body, n, r, basis, ldr)), |problem| {
        let (body, n) = body_of_order(problem, body, n)?;
        // SAFETY: `r` leads to one number guaranteed by the caller.
        let dimension = unsafe { Output::new(r, 1, "r") }?;
        let _room = problem.setup_headroom()?;
        let (found, columns) = problem.null_space(body)?;
        if !basis.is_null() {
            // SAFETY: as above; checked by Output::new, and set by the caller where there is a basis.
            let room = unsafe { r.read() };
            if room < found as i64 {
                let text = format!("room for {room} columns, the null space has {found}");
                return Err(Error::argument("r", text).body(body).value(room as f64).limit(found as f64));
            }
            let (entries, ldr) = column_major(n, found, ldr, "ldr")?;
            // SAFETY: room for as many entries, since at least `found` columns fit.
            let output = unsafe { Output::new(basis, entries, "basis") }?;
            for (k, column) in columns.chunks_exact(n.max(1)).enumerate() {
                output.write_at(k * ldr, column);
            }
        }
        dimension.set(found as i64);
        Ok(())
    })
}

/// Reads the fixing unknowns of a body: with them fixed, K has full rank.
///
/// Runs feti_setup when it is due; on several ranks as feti_body_kplus. FETI_UNSUPPORTED if the host provides K+
/// (feti_body_operator). FETI_STATE if the body is cut into pieces (feti_body_mesh_i32 or _i64).
///
/// | argument | in/out | shape | rule |
/// |---|---|---|---|
/// | `p` | in | scalar | the handle |
/// | `body` | in | scalar | number of the body, from 0 |
/// | `r` | in | scalar | dimension of the null space of the body |
/// | `dof` | out | r | unknowns of the body, from 0 |
///
/// # Safety
/// The array has the given shape.
#[no_mangle]
pub unsafe extern "C" fn feti_body_fixing(p: *mut feti_problem, body: i64, r: i64, dof: *mut i64) -> i32 {
    enter(p, call!(feti_body_fixing(p, body, r, dof)), |problem| {
        let body = id(body, "body")?;
        let _room = problem.setup_headroom()?;
        let fixing = problem.fixing_dofs(body)?;
        same(r, fixing.len(), "r", "the dimension of the null space is").map_err(|error| error.body(body))?;
        // SAFETY: r numbers guaranteed by the caller.
        let output = unsafe { Output::new(dof, fixing.len(), "dof") }?;
        for (k, number) in fixing.iter().enumerate() {
            output.write_at(k, &[*number as i64]);
        }
        Ok(())
    })
}

/// Chooses the fixing unknowns of a body; otherwise the library chooses them.
///
/// The choice affects the iterations of the paper's methods in printed units, but neither forces nor displacements.
/// There must be as many fixing unknowns as the null space has dimensions, and they must hold every motion of the null
/// space; feti_setup checks both. Another call replaces them.
///
/// | argument | in/out | shape | rule |
/// |---|---|---|---|
/// | `p` | in | scalar | the handle |
/// | `body` | in | scalar | number of the body, from 0 |
/// | `r` | in | scalar | dimension of the null space of the body; 0: the library chooses again |
/// | `dof` | in | r | unknowns of the body, from 0; may be NULL when r = 0 |
///
/// # Safety
/// The array has the given shape.
#[no_mangle]
pub unsafe extern "C" fn feti_body_fixing_set(
    p: *mut feti_problem,
    body: i64,
    r: i64,
    dof: *const i64,
) -> i32 {
    enter(p, call!(feti_body_fixing_set(p, body, r, dof)), |problem| {
        let (body, r) = (id(body, "body")?, count(r, "r")?);
        // SAFETY: r numbers guaranteed by the caller.
        let given = unsafe { numbers(dof, r, 0, "dof") }?;
        let mut dofs = reserved(r, "an index array")?;
        for (entry, &number) in given.iter().enumerate() {
            dofs.push(usize::try_from(number).map_err(|_| {
                let text = format!("unknown {INDEX} is below the first one");
                Error::argument("dof", text).body(body).entry(entry).index(number)
            })?);
        }
        problem.set_fixing(body, Some(dofs.as_slice()).filter(|dofs| !dofs.is_empty()))
    })
}
