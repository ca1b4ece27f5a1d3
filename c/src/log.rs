//! The log of a call.

use std::ffi::{c_void, CString};

use crate::boundary::fpu;
use crate::boundary::{call, enter, meaning};
use crate::header::types::{
    feti_log_fn, feti_problem, FETI_LOG_NONE, FETI_LOG_PHASE, FETI_LOG_RESULT, FETI_LOG_STEP,
};
use crate::progress::User;
use feti_contact::error::Result;
use feti_contact::solver::{LogLevel, LogListener};

/// Registers the function that receives the log of setups and solves, line by line.
///
/// Level FETI_LOG_RESULT: one line for each solve, and warnings. FETI_LOG_PHASE: also sizes, options, method, fallbacks
/// and a line for each phase with its time and bytes; also the progress of a long first feasible point, projection,
/// nearest point or certificate, with the first line after a second at most and further lines whenever a tenth of the
/// time so far has passed. FETI_LOG_STEP: also a line for each step. The function runs on the thread that called the
/// library, in the floating-point environment of that thread, and stays registered until another function or NULL is
/// given. It returns 0 to continue; any other number ends the call with FETI_CALLBACK, the number in the error detail,
/// and no results. Inside the function, calls on the same problem return FETI_BUSY, except feti_cancel and
/// feti_problem_error. The function must not exit by longjmp or an exception.
///
/// | argument | in/out | shape | rule |
/// |---|---|---|---|
/// | `p` | in | scalar | the handle |
/// | `callback` | in | scalar | the function; NULL: none |
/// | `level` | in | scalar | FETI_LOG_NONE, FETI_LOG_RESULT, FETI_LOG_PHASE or FETI_LOG_STEP |
/// | `user` | in | scalar | passed to the function unchanged; may be NULL |
///
/// # Safety
/// `callback` may be called with `user` until it is replaced or the problem destroyed.
#[no_mangle]
pub unsafe extern "C" fn feti_on_log(
    p: *mut feti_problem,
    callback: feti_log_fn,
    level: i32,
    user: *mut c_void,
) -> i32 {
    enter(p, call!(feti_on_log(p, callback, level, user)), |problem| {
        let user = User(user);
        let level = log_level(level)?;
        let listener = level.zip(callback).map(|(most, callback)| -> (LogLevel, LogListener) {
            let tell = move |level: LogLevel, text: &str| {
                let text = CString::new(text).unwrap_or_default();
                // SAFETY: the caller guarantees that the function may be called with `user`; the text ends with NUL.
                fpu::in_host_environment(|| unsafe { callback(user.get(), level as i32, text.as_ptr()) })
            };
            (most, Box::new(tell))
        });
        problem.on_log(listener);
        Ok(())
    })
}

fn log_level(level: i32) -> Result<Option<LogLevel>> {
    let known = [
        (FETI_LOG_NONE, None),
        (FETI_LOG_RESULT, Some(LogLevel::Result)),
        (FETI_LOG_PHASE, Some(LogLevel::Phase)),
        (FETI_LOG_STEP, Some(LogLevel::Step)),
    ];
    let not = format!("no level: they go from {FETI_LOG_NONE} to {FETI_LOG_STEP}");
    meaning(level, "level", &known, &not).map_err(|error| error.limit(f64::from(FETI_LOG_STEP)))
}
