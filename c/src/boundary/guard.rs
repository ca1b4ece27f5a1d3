//! The frame of every call: it saves the host's floating-point environment, looks up the handle, locks the problem
//! (or returns BUSY), catches and silences panics, and records a failure for the thread and for the problem.

use std::any::Any;
use std::cell::{Cell, RefCell};
use std::panic::{self, AssertUnwindSafe, PanicHookInfo};
use std::sync::Once;

use crate::boundary::call::Call;
use crate::boundary::error_store::Record;
use crate::boundary::fpu;
use crate::boundary::handle::{self, Refusal};
use crate::header::status::{FETI_BUSY, FETI_HANDLE, FETI_INACCURATE, FETI_INTERNAL, FETI_OK};
use crate::header::types::feti_problem;
use feti_contact::error::{Error, Kind, Result};
use feti_contact::platform::instant;
use feti_contact::platform::shortage::RunningCall;
use feti_contact::platform::threads::THREAD_NAME;
use feti_contact::solver::Problem;

/// Runs `work` on the problem behind `p` and returns the status of the call.
pub fn enter(p: *mut feti_problem, call: Call, work: impl FnOnce(&mut Problem) -> Result<()>) -> i32 {
    enter_with_status(p, call, |problem| work(problem).map(|()| FETI_OK))
}

/// As [`enter`], for work that returns a status; a status other than FETI_OK is recorded like a failure.
pub fn enter_with_status(
    p: *mut feti_problem,
    call: Call,
    work: impl FnOnce(&mut Problem) -> Result<i32>,
) -> i32 {
    let _running = RunningCall::begin();
    fpu::in_default_environment(|| {
        let Some(slot) = handle::find(p) else {
            return refuse(call, &Refusal::Gone);
        };
        let outcome = slot.with(|problem| {
            slot.shared.note();
            let outcome = caught(|| work(problem));
            let base = problem.settings().index_base;
            let why = |status| problem.shortfall().filter(|_| status == FETI_INACCURATE);
            outcome.map(|status| (status, why(status).map(|why| why.counted_from(base)))).map_err(|error| {
                if error.kind == Kind::Internal {
                    slot.mark_broken();
                    return error;
                }
                error.counted_from(base)
            })
        });
        let record = match outcome {
            Err(refusal) => return refuse(call, &refusal),
            Ok(Ok((FETI_OK, _))) => return FETI_OK,
            Ok(Ok((status, why))) => Record::of_status(call, status).because(why),
            Ok(Err(error)) => Record::of_error(call, &error),
        };
        slot.keep_error(record.clone());
        record.publish()
    })
}

/// Runs `work`, which needs no problem, and returns the status of the call.
pub fn without_problem(call: Call, work: impl FnOnce() -> Result<()>) -> i32 {
    let _running = RunningCall::begin();
    without_end(call, work)
}

/// As [`without_problem`], for a call that may last as long as the host runs: no shortage of memory lasts until its end.
pub fn without_end(call: Call, work: impl FnOnce() -> Result<()>) -> i32 {
    fpu::in_default_environment(|| match caught(work) {
        Ok(()) => FETI_OK,
        Err(error) => Record::of_error(call, &error).publish(),
    })
}

/// The status of a problem that is not available. The last error of the problem is unchanged: it belongs to another call.
pub fn refuse(call: Call, refusal: &Refusal) -> i32 {
    let status = match refusal {
        Refusal::Gone => FETI_HANDLE,
        Refusal::Busy => FETI_BUSY,
        Refusal::Broken => FETI_INTERNAL,
    };
    Record::of_status(call, status).publish()
}

thread_local! {
    /// Nesting depth of [`caught`] on this thread.
    static DEPTH: Cell<i32> = const { Cell::new(0) };
    /// Place of the last silenced panic of this thread.
    static PANIC_PLACE: RefCell<String> = const { RefCell::new(String::new()) };
}

/// Runs `work`; a panic becomes an error of kind Internal. Data that `work` was changing must not be used afterwards.
pub fn caught<T>(work: impl FnOnce() -> Result<T>) -> Result<T> {
    install_hook();
    let go_deeper = |by: i32| DEPTH.try_with(|depth| depth.set(depth.get() + by));
    let _ = go_deeper(1);
    let outcome = panic::catch_unwind(AssertUnwindSafe(work));
    let _ = go_deeper(-1);
    outcome.unwrap_or_else(|payload| Err(Error::new(Kind::Internal, panic_text(payload.as_ref()))))
}

fn panic_text(payload: &(dyn Any + Send)) -> String {
    let literal = payload.downcast_ref::<&str>().copied();
    let message =
        literal.or_else(|| payload.downcast_ref::<String>().map(String::as_str)).unwrap_or("no message");
    let place = PANIC_PLACE.try_with(RefCell::take).unwrap_or_default();
    format!("the library contradicts itself, please report this: {message}{place}")
}

/// True if a panic of this thread belongs to the library: within [`caught`], or on one of its own threads, which are all
/// named [`THREAD_NAME`].
fn is_ours() -> bool {
    let inside = DEPTH.try_with(|depth| depth.get() > 0).unwrap_or(false);
    inside || std::thread::current().name().is_some_and(|name| name.starts_with(THREAD_NAME))
}

/// Installs the hook once: panics of the library print nothing, panics of a host written in Rust reach the previous hook.
fn install_hook() {
    static HOOK: Once = Once::new();
    // the hook cannot be exchanged during a panic; the next call installs it
    if HOOK.is_completed() || std::thread::panicking() {
        return;
    }
    let install = || {
        let previous = panic::take_hook();
        panic::set_hook(Box::new(move |info| if is_ours() { note_place(info) } else { previous(info) }));
    };
    instant(|| HOOK.call_once(install));
}

fn note_place(info: &PanicHookInfo<'_>) {
    let place = info.location().map(|at| format!(" ({}:{})", at.file(), at.line())).unwrap_or_default();
    let _ = PANIC_PLACE.try_with(|kept| kept.replace(place));
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_panic_becomes_an_error_with_its_text_and_place() {
        let error = caught(|| -> Result<()> { panic!("row {} is nowhere", 7) }).unwrap_err();
        assert_eq!(error.kind, Kind::Internal);
        assert!(
            error.what.contains("row 7 is nowhere (") && error.what.contains("guard.rs:"),
            "{}",
            error.what
        );
    }

    #[test]
    fn only_panics_of_the_library_are_silenced() {
        assert!(!is_ours());
        let inside = caught(|| Ok((is_ours(), caught(|| Ok(is_ours())), is_ours()))).unwrap();
        assert!(matches!(inside, (true, Ok(true), true)));
        assert!(caught(|| -> Result<()> { panic!("again") }).is_err());
        assert!(!is_ours());
        let on = |name: &str| std::thread::Builder::new().name(name.to_string()).spawn(is_ours);
        assert!(on("feti-contact 3").unwrap().join().unwrap());
        assert!(!on("host").unwrap().join().unwrap());
    }

    /// The output of the process for a panic of the library and for a panic of its host.
    #[test]
    #[ignore = "run by the test below, in a process of its own"]
    fn panics_of_library_and_host() {
        assert!(caught(|| -> Result<()> { panic!("of the library") }).is_err());
        assert!(panic::catch_unwind(|| panic!("of the host")).is_err());
    }

    #[test]
    fn a_panic_of_the_library_prints_nothing_and_one_of_the_host_as_before() {
        let test = std::env::current_exe().unwrap();
        let name = format!("{}::panics_of_library_and_host", module_path!().split_once("::").unwrap().1);
        let mut child = std::process::Command::new(test);
        let output = child.args([&name, "--exact", "--ignored", "--nocapture"]).output().unwrap();
        let printed =
            format!("{}{}", String::from_utf8_lossy(&output.stdout), String::from_utf8_lossy(&output.stderr));
        assert!(output.status.success() && printed.contains("1 passed"), "{printed}");
        assert!(printed.contains("of the host") && !printed.contains("of the library"), "{printed}");
    }
}
