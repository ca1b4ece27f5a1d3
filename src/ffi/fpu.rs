//! The floating-point environment: hosts trap (`-ffpe-trap`) or flush denormal numbers (`-Ofast`); the library computes in
//! the default environment and gives the host's back, also after a panic. Threads started inside inherit the default.

/// Runs `work` with all traps masked, rounding to nearest, denormal numbers kept.
pub(super) fn in_default_environment<T>(work: impl FnOnce() -> T) -> T {
    let _host = HostEnvironment::replace();
    apart(work)
}

/// Keeps the compiler from moving arithmetic of `work` over the switch of the environment.
#[inline(never)]
fn apart<T>(work: impl FnOnce() -> T) -> T {
    work()
}

/// The host's control and status word, put back when dropped.
struct HostEnvironment {
    #[cfg(target_arch = "x86_64")]
    mxcsr: u32,
}

#[cfg(target_arch = "x86_64")]
impl HostEnvironment {
    fn replace() -> Self {
        let host = Self { mxcsr: mxcsr::read() };
        mxcsr::write(mxcsr::DEFAULT);
        host
    }
}

#[cfg(target_arch = "x86_64")]
impl Drop for HostEnvironment {
    fn drop(&mut self) {
        mxcsr::write(self.mxcsr);
    }
}

/// Processors whose environment is left as it is.
#[cfg(not(target_arch = "x86_64"))]
impl HostEnvironment {
    fn replace() -> Self {
        Self {}
    }
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
    const HOST: u32 = (mxcsr::DEFAULT & !0x0200) | 0x8040 | 0x0020;

    #[test]
    fn traps_are_masked_and_denormals_kept_inside_and_the_host_gets_its_word_back() {
        let before = mxcsr::read();
        mxcsr::write(HOST);
        let (inside, infinite, denormal) = in_default_environment(|| {
            (mxcsr::read(), black_box(1.0) / black_box(0.0), black_box(f64::MIN_POSITIVE) / black_box(4.0))
        });
        let after = mxcsr::read();
        mxcsr::write(before);
        assert_eq!(inside, mxcsr::DEFAULT);
        assert!(infinite == f64::INFINITY && denormal > 0.0);
        assert_eq!(after, HOST);
    }

    #[test]
    fn the_host_gets_its_word_back_after_a_panic() {
        let before = mxcsr::read();
        mxcsr::write(HOST);
        let outcome = panic::catch_unwind(|| in_default_environment(|| panic::resume_unwind(Box::new(7))));
        let after = mxcsr::read();
        mxcsr::write(before);
        assert!(outcome.is_err());
        assert_eq!(after, HOST);
    }

    #[test]
    fn a_thread_started_inside_has_the_default_environment() {
        let before = mxcsr::read();
        mxcsr::write(HOST);
        let inside = in_default_environment(|| std::thread::spawn(mxcsr::read).join());
        mxcsr::write(before);
        assert!(matches!(inside, Ok(mxcsr::DEFAULT)));
    }
}
