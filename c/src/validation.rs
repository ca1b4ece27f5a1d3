//! The operators of the method, for comparison with other codes: contact rows first, then equality rows, in the host's
//! order and scaling; tangential rows of nodes with friction are left out.

use crate::bodies::body_of_order;
use crate::boundary::{call, check_finite, column_major, count, enter, finite_input, input, same, Output};
use crate::header::types::feti_problem;
use feti_contact::error::Result;
use feti_contact::platform::memory::zeros;
use feti_contact::solver::Problem;

/// Applies the generalised inverse of a body, `Y = K+ X`.
///
/// Runs feti_setup when it is due; a rank that shares the problem with others can ask for its own bodies, and gets FETI_STATE until all
/// have set up. X and Y may be the same array. FETI_STATE if the body is cut into pieces (feti_body_mesh_i32 or _i64).
///
/// | argument | in/out | shape | rule |
/// |---|---|---|---|
/// | `p` | in | scalar | the handle |
/// | `body` | in | scalar | number of the body, from 0 |
/// | `n` | in | scalar | unknowns of the body |
/// | `nrhs` | in | scalar | columns of X and Y |
/// | `x` | in | ldx * nrhs | column-major, force |
/// | `ldx` | in | scalar | >= n |
/// | `y` | out | ldy * nrhs | column-major, length |
/// | `ldy` | in | scalar | >= n |
///
/// # Safety
/// The arrays have the given shapes.
#[no_mangle]
pub unsafe extern "C" fn feti_body_kplus(
    p: *mut feti_problem,
    body: i64,
    n: i64,
    nrhs: i64,
    x: *const f64,
    ldx: i64,
    y: *mut f64,
    ldy: i64,
) -> i32 {
    enter(p, call!(feti_body_kplus(p, body, n, nrhs, x, ldx, y, ldy)), |problem| {
        let (body, n) = body_of_order(problem, body, n)?;
        let nrhs = count(nrhs, "nrhs")?;
        let (x_entries, ldx) = column_major(n, nrhs, ldx, "ldx")?;
        let (y_entries, ldy) = column_major(n, nrhs, ldy, "ldy")?;
        // SAFETY: shapes guaranteed by the caller.
        let (x, output) = unsafe { (input(x, x_entries, "x")?, Output::new(y, y_entries, "y")?) };
        (0..nrhs).try_for_each(|k| check_finite(&x[k * ldx..k * ldx + n], k * ldx, "x"))?;
        let _room = problem.setup_headroom()?;
        // At most y_entries, which column_major has bounded.
        let mut columns = zeros(n * nrhs, "a result")?;
        for (k, column) in columns.chunks_exact_mut(n.max(1)).enumerate() {
            problem.kplus(body, &x[k * ldx..k * ldx + n], column)?;
        }
        for (k, column) in columns.chunks_exact(n.max(1)).enumerate() {
            output.write_at(k * ldy, column);
        }
        Ok(())
    })
}

/// Applies the dual operator, `y = F x` with `F = [B; H] K+ [B; H]' + C`.
///
/// C = diag(1/k) is the compliance of the rows (feti_rows_compliance), 0 for rigid rows. F does not include the
/// tangential rows of nodes with friction. Runs feti_setup when it is due. `x` and `y` may be the same array.
/// FETI_STATE if a body is cut into pieces (feti_body_mesh_i32 or _i64) or unknowns are glued (option glue);
/// FETI_UNSUPPORTED if several ranks have a part of the problem.
///
/// | argument | in/out | shape | rule |
/// |---|---|---|---|
/// | `p` | in | scalar | the handle |
/// | `m` | in | scalar | inequality rows + equality rows |
/// | `x` | in | m | force |
/// | `y` | out | m | length |
///
/// # Safety
/// The arrays have the given shapes.
#[no_mangle]
pub unsafe extern "C" fn feti_dual_apply(p: *mut feti_problem, m: i64, x: *const f64, y: *mut f64) -> i32 {
    enter(p, call!(feti_dual_apply(p, m, x, y)), |problem| {
        let m = all_rows(problem, m)?;
        // SAFETY: shapes guaranteed by the caller.
        let (x, output) = unsafe { (finite_input(x, m, "x")?, Output::new(y, m, "y")?) };
        let _room = problem.working_headroom()?;
        let mut product = zeros(m, "a result")?;
        problem.dual_apply(x, &mut product)?;
        output.write(&product);
        Ok(())
    })
}

/// Reads the right-hand side of the dual problem, `d = [B; H] K+ f - [c; h]`.
///
/// Runs feti_setup when it is due. FETI_STATE if a body is cut into pieces (feti_body_mesh_i32 or _i64) or unknowns are
/// glued (option glue); FETI_UNSUPPORTED if several ranks have a part of the problem.
///
/// | argument | in/out | shape | rule |
/// |---|---|---|---|
/// | `p` | in | scalar | the handle |
/// | `m` | in | scalar | inequality rows + equality rows |
/// | `d` | out | m | length |
///
/// # Safety
/// The array has the given shape.
#[no_mangle]
pub unsafe extern "C" fn feti_dual_rhs(p: *mut feti_problem, m: i64, d: *mut f64) -> i32 {
    enter(p, call!(feti_dual_rhs(p, m, d)), |problem| {
        let m = all_rows(problem, m)?;
        // SAFETY: room for m numbers guaranteed by the caller.
        let output = unsafe { Output::new(d, m, "d") }?;
        let _room = problem.working_headroom()?;
        let mut rhs = zeros(m, "a result")?;
        problem.dual_rhs(&mut rhs)?;
        output.write(&rhs);
        Ok(())
    })
}

/// Number of rows of both kinds; `m` must be equal.
fn all_rows(problem: &Problem, m: i64) -> Result<usize> {
    let counts = problem.sizes();
    same(m, counts.rows + counts.equalities, "m", "the number of rows of both kinds is")
}
