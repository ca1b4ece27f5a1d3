//! Bodies whose stiffness matrix and factorisation stay with the host.

use std::ffi::c_void;
use std::sync::Arc;

use crate::bodies::body::body_of_order;
use crate::boundary::fpu::Environment;
use crate::boundary::handle;
use crate::boundary::{call, enter, input, meaning, null};
use crate::header::types::{feti_operator_fn, feti_problem};
use crate::progress::User;
use feti_contact::error::{Error, Kind, Result};
use feti_contact::solver::{HostFunctions, HostProduct};

/// Registers the functions of the host that multiply by the stiffness K of a body and by a generalised inverse K+ of K.
///
/// The library sees only the diagonal of K, which it copies, and factorises nothing. K+ is any symmetric positive
/// semidefinite matrix with K K+ K = K. If K is not singular, K+ is its inverse. Otherwise K+ may be the inverse of K
/// with enough unknowns held (rows and columns of zeros in K+), or the inverse of K plus a regularisation that acts only
/// on the null space. The null space must be given by feti_body_null_space or feti_body_coordinates; with coordinates the
/// library treats the body as connected. feti_setup tests the functions with a few fixed vectors and refuses wrong
/// functions with a specific status: FETI_CALLBACK (K or K+ is not symmetric, K K+ K is not K, or a result is not
/// finite), FETI_INDEFINITE, or FETI_NULL_SPACE (K R is not 0, or R lacks a mode), with the measured value and its limit
/// in the error detail.
///
/// If a function returns a number other than 0, the call that needed it ends with FETI_CALLBACK, with the body and that
/// number in the error detail; the problem is unchanged. The functions run in the host's floating-point environment. With
/// `concurrent` = 0 they run only on the thread that called the library; with 1 several may run at once, also on threads
/// of the library. Inside them, calls on the same problem return FETI_BUSY, except feti_cancel and feti_problem_error.
/// The functions must not exit by longjmp or an exception, and must give bit-identical results for the same X.
///
/// Another call replaces the functions and everything computed with them; make this call whenever K has changed. A
/// stiffness matrix given later replaces the functions, and the functions replace a matrix given earlier.
///
/// | argument | in/out | shape | rule |
/// |---|---|---|---|
/// | `p` | in | scalar | the handle |
/// | `body` | in | scalar | number of the body, from 0 |
/// | `n` | in | scalar | unknowns of the body |
/// | `diag` | in | n | diagonal of K, >= 0, force per length; the library measures the body by it |
/// | `kplus` | in | scalar | Y = K+ X, X force, Y length |
/// | `k` | in | scalar | Y = K X, X length, Y force |
/// | `concurrent` | in | scalar | 0: only on the calling thread; 1: on any thread, several at once |
/// | `user` | in | scalar | passed to the functions unchanged; may be NULL |
///
/// # Safety
/// `diag` has the given shape; the functions may be called with `user` until they are replaced or the problem destroyed.
#[no_mangle]
pub unsafe extern "C" fn feti_body_operator(
    p: *mut feti_problem,
    body: i64,
    n: i64,
    diag: *const f64,
    kplus: feti_operator_fn,
    k: feti_operator_fn,
    concurrent: i32,
    user: *mut c_void,
) -> i32 {
    enter(p, call!(feti_body_operator(p, body, n, diag, kplus, k, concurrent, user)), |problem| {
        let (number, order) = body_of_order(problem, body, n)?;
        // SAFETY: the shape guaranteed by the caller.
        let diagonal = unsafe { input(diag, order, "diag") }?;
        let slot = handle::find(p).ok_or_else(|| Error::new(Kind::Internal, "a problem without handle"))?;
        let product = |function: feti_operator_fn, name| -> Result<HostProduct> {
            let function = function.ok_or_else(|| null(name).body(number))?;
            let host = Function { function, user: User(user), body, n };
            Ok(host.product(Arc::clone(&slot.shared)))
        };
        let (kplus, k) = (product(kplus, "kplus")?, product(k, "k")?);
        let concurrent = meaning(concurrent, "concurrent", &[(0, false), (1, true)], "neither 0 nor 1");
        let concurrent = concurrent.map_err(|error| error.body(number))?;
        problem.set_operator(number, diagonal, HostFunctions { kplus, k, concurrent })
    })
}

type Plain = unsafe extern "C" fn(*mut c_void, i64, i64, i64, *const f64, i64, *mut f64, i64) -> i32;

/// A function of the host and its arguments besides X and Y.
struct Function {
    function: Plain,
    user: User,
    body: i64,
    n: i64,
}

impl Function {
    fn product(self, environment: Arc<Environment>) -> HostProduct {
        Box::new(move |x, nrhs, y| {
            let Self { function, user, body, n } = &self;
            let (x, y) = (x.as_ptr(), y.as_mut_ptr());
            // SAFETY: the caller guarantees that the function may be called with `user`; X and Y are n x nrhs and apart.
            environment.within(|| unsafe { function(user.get(), *body, *n, nrhs as i64, x, *n, y, *n) })
        })
    }
}
