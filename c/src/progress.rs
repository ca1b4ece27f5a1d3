//! Progress and cancellation of a call.

use std::ffi::c_void;

use crate::boundary::fpu;
use crate::boundary::handle::{self, Refusal};
use crate::boundary::{call, enter, refuse};
use crate::header::status::FETI_OK;
use crate::header::types::{
    feti_problem, feti_progress, feti_progress_fn, FETI_PHASE_SETUP, FETI_PHASE_SOLVE,
    FETI_STEP_CONJUGATE_GRADIENT, FETI_STEP_EXPANSION, FETI_STEP_NEWTON, FETI_STEP_RELEASE,
};
use feti_contact::solver::{Listener, Progress, Reply, StepKind};

/// Cancels the setup or the solve that is running on the problem.
///
/// May be called from any thread and from a progress function, while another call on the problem runs. The running call
/// returns FETI_CANCELLED before the next product with the dual operator (in the setup: before the next body, and inside
/// the assembly of its dual operator). The results are those of the last step; there are none if the call was cancelled
/// before the first step. If no call is running, this function has no effect: it does not cancel later setups and solves.
/// In a signal handler, set a flag instead and let the progress function check it.
///
/// | argument | in/out | shape | rule |
/// |---|---|---|---|
/// | `p` | in | scalar | the handle |
#[no_mangle]
pub extern "C" fn feti_cancel(p: *mut feti_problem) -> i32 {
    let call = call!(feti_cancel(p));
    match handle::find(p).ok_or(Refusal::Gone).and_then(|slot| slot.cancel()) {
        Ok(()) => FETI_OK,
        Err(refusal) => refuse(call, &refusal),
    }
}

/// Registers the function that is called for every body in every part of a setup, and for every step of a solve.
///
/// During a setup on several threads the function is also called when half a second has passed without such an event. It
/// runs on the thread that called the library, in the floating-point environment of that thread, and stays registered
/// until another function or NULL is given. It returns 0 to continue. A number > 0 ends the call with FETI_CANCELLED and
/// the results of the last step; a number < 0 ends the call with FETI_CALLBACK, the number in the error detail, and no
/// results. Inside the function, calls on the same problem return FETI_BUSY, except feti_cancel and feti_problem_error;
/// other problems may be used. The function must not exit by longjmp or an exception.
///
/// | argument | in/out | shape | rule |
/// |---|---|---|---|
/// | `p` | in | scalar | the handle |
/// | `callback` | in | scalar | the function; NULL: none |
/// | `user` | in | scalar | passed to the function unchanged; may be NULL |
///
/// # Safety
/// `callback` may be called with `user` until it is replaced or the problem destroyed.
#[no_mangle]
pub unsafe extern "C" fn feti_on_progress(
    p: *mut feti_problem,
    callback: feti_progress_fn,
    user: *mut c_void,
) -> i32 {
    enter(p, call!(feti_on_progress(p, callback, user)), |problem| {
        let user = User(user);
        let listener = callback.map(|callback| -> Listener {
            Box::new(move |now| {
                let now = told(now);
                // SAFETY: the caller guarantees that the function may be called with `user`.
                match fpu::in_host_environment(|| unsafe { callback(user.get(), &now) }) {
                    0 => Reply::Continue,
                    1.. => Reply::Cancel,
                    number => Reply::Failed(number),
                }
            })
        });
        problem.on_progress(listener);
        Ok(())
    })
}

/// The host's pointer, which the library only passes back.
#[derive(Clone, Copy)]
pub(super) struct User(pub(super) *mut c_void);

// SAFETY: never dereferenced here; the host's function gets it on the thread on which the host calls the library, or, if
// the host permits it (`concurrent` of feti_body_operator), on any thread.
unsafe impl Send for User {}
// SAFETY: as above.
unsafe impl Sync for User {}

impl User {
    pub fn get(self) -> *mut c_void {
        self.0
    }
}

fn told(now: &Progress) -> feti_progress {
    feti_progress {
        struct_size: size_of::<feti_progress>() as i64,
        phase: if now.step.is_none() { FETI_PHASE_SETUP } else { FETI_PHASE_SOLVE },
        step: match now.step {
            None => 0,
            Some(StepKind::ConjugateGradient) => FETI_STEP_CONJUGATE_GRADIENT,
            Some(StepKind::Expansion) => FETI_STEP_EXPANSION,
            Some(StepKind::Proportioning) => FETI_STEP_RELEASE,
            Some(StepKind::Newton) => FETI_STEP_NEWTON,
        },
        steps: now.steps as i64,
        products: now.products as i64,
        active: now.active as i64,
        residual: now.residual,
        residual_free: now.free,
        residual_chopped: now.chopped,
        theta: now.theta,
        seconds: now.seconds,
        fraction: now.fraction,
    }
}
