//! The floating-point environment: hosts trap (`-ffpe-trap`) or flush denormal numbers (`-Ofast`). The library computes in
//! the default environment and restores the host's, also after a panic. Threads started inside inherit the default;
//! functions of the host run in the host's environment.

use std::cell::Cell;
use std::sync::atomic::{AtomicU32, Ordering};

/// Runs `work` with all traps masked, rounding to nearest, denormal numbers kept.
pub fn in_default_environment<T>(work: impl FnOnce() -> T) -> T {
    let _host = HostEnvironment::replace();
    apart(work)
}

/// Within [`in_default_environment`]: runs a function of the host in the environment of the host. Changes that the
/// function makes to the environment remain.
pub fn in_host_environment<T>(work: impl FnOnce() -> T) -> T {
    let _ours = DefaultEnvironment::suspend();
    apart(work)
}

/// Prevents the compiler from moving arithmetic of `work` across the change of the environment.
#[inline(never)]
fn apart<T>(work: impl FnOnce() -> T) -> T {
    work()
}

thread_local! {
    /// The host's control and status word while the library runs on this thread; none on a thread of the library.
    static HOST: Cell<Option<u32>> = const { Cell::new(None) };
}

/// The environment of the host in the call on a problem, for the host's functions on threads of the library.
pub struct Environment {
    mxcsr: AtomicU32,
}

impl Environment {
    pub fn new() -> Self {
        Self { mxcsr: AtomicU32::new(mxcsr::DEFAULT) }
    }

    /// Stores the environment of the call on this thread.
    pub fn note(&self) {
        self.mxcsr.store(HOST.get().unwrap_or(mxcsr::DEFAULT), Ordering::Relaxed);
    }

    /// Runs a function of the host in the environment of the host, on any thread.
    pub fn within<T>(&self, work: impl FnOnce() -> T) -> T {
        if HOST.get().is_some() {
            return in_host_environment(work);
        }
        HOST.set(Some(self.mxcsr.load(Ordering::Relaxed)));
        let result = in_host_environment(work);
        HOST.set(None);
        result
    }
}

/// Restores the host's word when dropped; calls may be nested through functions of the host.
struct HostEnvironment {
    /// The previous value of HOST.
    outer: Option<u32>,
}

impl HostEnvironment {
    fn replace() -> Self {
        let outer = HOST.replace(Some(mxcsr::read()));
        mxcsr::write(mxcsr::DEFAULT);
        Self { outer }
    }
}

impl Drop for HostEnvironment {
    fn drop(&mut self) {
        HOST.replace(self.outer).into_iter().for_each(mxcsr::write);
    }
}

/// Restores the library's word when dropped.
struct DefaultEnvironment {
    mxcsr: u32,
}

impl DefaultEnvironment {
    fn suspend() -> Self {
        let ours = Self { mxcsr: mxcsr::read() };
        HOST.get().into_iter().for_each(mxcsr::write);
        ours
    }
}

impl Drop for DefaultEnvironment {
    fn drop(&mut self) {
        HOST.set(Some(mxcsr::read()));
        mxcsr::write(self.mxcsr);
    }
}

/// Processors whose environment is not changed.
#[cfg(not(target_arch = "x86_64"))]
mod mxcsr {
    pub const DEFAULT: u32 = 0;

    pub fn read() -> u32 {
        DEFAULT
    }

    pub fn write(_: u32) {}
}

#[cfg(target_arch = "x86_64")]
mod mxcsr {
    use std::arch::asm;

    /// All six exceptions masked, round to nearest, neither flush-to-zero nor denormals-are-zero, no exception flag.
    pub const DEFAULT: u32 = 0x1F80;

    pub fn read() -> u32 {
        let mut value = 0_u32;
        // SAFETY: stmxcsr stores four bytes at the address of a local variable of four bytes.
        unsafe { asm!("stmxcsr [{}]", in(reg) &mut value, options(nostack, preserves_flags)) };
        value
    }

    pub fn write(value: u32) {
        // SAFETY: `value` is DEFAULT or was read by stmxcsr, so that no reserved bit is set.
        unsafe { asm!("ldmxcsr [{}]", in(reg) &value, options(nostack, preserves_flags)) };
    }
}

#[cfg(all(test, target_arch = "x86_64"))]
mod tests {
    use super::*;
    use std::hint::black_box;
    use std::panic;

    /// Trap on division by zero, flush to zero, denormals are zero, and a sticky flag of an inexact result.
    const HOST_WORD: u32 = (mxcsr::DEFAULT & !0x0200) | 0x8040 | 0x0020;

    #[test]
    fn traps_are_masked_and_denormals_kept_inside_and_the_host_gets_its_word_back() {
        let before = mxcsr::read();
        mxcsr::write(HOST_WORD);
        let (inside, infinite, denormal) = in_default_environment(|| {
            (mxcsr::read(), black_box(1.0) / black_box(0.0), black_box(f64::MIN_POSITIVE) / black_box(4.0))
        });
        let after = mxcsr::read();
        mxcsr::write(before);
        assert_eq!(inside, mxcsr::DEFAULT);
        assert!(infinite == f64::INFINITY && denormal > 0.0);
        assert_eq!(after, HOST_WORD);
    }

    #[test]
    fn the_host_gets_its_word_back_after_a_panic() {
        let before = mxcsr::read();
        mxcsr::write(HOST_WORD);
        let outcome = panic::catch_unwind(|| in_default_environment(|| panic::resume_unwind(Box::new(7))));
        let after = mxcsr::read();
        mxcsr::write(before);
        assert!(outcome.is_err());
        assert_eq!(after, HOST_WORD);
    }

    #[test]
    fn a_function_of_the_host_runs_in_its_environment_and_may_change_it() {
        let before = mxcsr::read();
        mxcsr::write(HOST_WORD);
        let changed = HOST_WORD & !0x8000;
        let seen = in_default_environment(|| {
            let in_function = in_host_environment(|| {
                let nested = in_default_environment(mxcsr::read);
                let own = mxcsr::read();
                mxcsr::write(changed);
                (nested, own)
            });
            (in_function, mxcsr::read())
        });
        let after = mxcsr::read();
        mxcsr::write(before);
        assert_eq!(seen, ((mxcsr::DEFAULT, HOST_WORD), mxcsr::DEFAULT));
        assert_eq!(after, changed);
    }

    #[test]
    fn a_function_of_the_host_on_a_thread_of_the_library_runs_in_its_environment() {
        let (before, environment) = (mxcsr::read(), Environment::new());
        mxcsr::write(HOST_WORD);
        let seen = in_default_environment(|| {
            environment.note();
            let elsewhere = std::thread::scope(|scope| {
                let work = || (environment.within(mxcsr::read), mxcsr::read(), HOST.get());
                scope.spawn(work).join()
            });
            (elsewhere.ok(), environment.within(mxcsr::read), mxcsr::read())
        });
        mxcsr::write(before);
        let elsewhere = Some((HOST_WORD, mxcsr::DEFAULT, None));
        assert_eq!(seen, (elsewhere, HOST_WORD, mxcsr::DEFAULT));
    }

    #[test]
    fn a_thread_started_inside_has_the_default_environment() {
        let before = mxcsr::read();
        mxcsr::write(HOST_WORD);
        let inside = in_default_environment(|| std::thread::spawn(mxcsr::read).join());
        mxcsr::write(before);
        assert!(matches!(inside, Ok(mxcsr::DEFAULT)));
    }
}
