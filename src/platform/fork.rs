//! A child process of fork must not find a shared lock held by a thread that does not exist there.
//!
//! The locks that all threads share are held only briefly, while no thread waits and no function of the host runs. `fork`
//! waits until no such lock is held, and prevents new ones until parent and child are separate. It does not wait for
//! anything longer, such as a call on a problem: in the child that problem stays busy.

#[cfg(target_os = "linux")]
pub use watched::instant;

/// Runs `work`, which takes locks that all threads share.
#[cfg(not(target_os = "linux"))]
pub fn instant<T>(work: impl FnOnce() -> T) -> T {
    work()
}

#[cfg(target_os = "linux")]
mod watched {
    use std::cell::RefCell;
    use std::sync::atomic::{AtomicBool, Ordering};
    use std::sync::{PoisonError, RwLock, RwLockWriteGuard};

    use crate::platform::memory;

    /// Work in progress holds it as a reader, a fork as its writer.
    static INSTANTS: RwLock<()> = RwLock::new(());

    thread_local! {
        /// Taken before the fork of this thread, released after it in both processes.
        static FORKING: RefCell<Option<RwLockWriteGuard<'static, ()>>> = const { RefCell::new(None) };
    }

    /// Runs `work`, which takes locks that all threads share.
    pub fn instant<T>(work: impl FnOnce() -> T) -> T {
        hear_of_forks();
        let _goes_on = INSTANTS.read().unwrap_or_else(PoisonError::into_inner);
        work()
    }

    /// Registers the handlers once per process; child processes inherit them. No thread waits for the registration, since
    /// a child might have to.
    fn hear_of_forks() {
        static HEARD: AtomicBool = AtomicBool::new(false);
        if !HEARD.load(Ordering::Relaxed) && !HEARD.swap(true, Ordering::Relaxed) {
            // SAFETY: functions of the library, which is never unloaded. If the system has no memory to register them,
            // forks are not handled.
            unsafe { libc::pthread_atfork(Some(before), Some(after), Some(in_child)) };
        }
    }

    extern "C" fn before() {
        let none_goes_on = INSTANTS.write().unwrap_or_else(PoisonError::into_inner);
        // A thread that is being destroyed releases it at once.
        let _ = FORKING.try_with(|forking| forking.replace(Some(none_goes_on)));
    }

    extern "C" fn after() {
        let _ = FORKING.try_with(RefCell::take);
    }

    extern "C" fn in_child() {
        memory::keep_own_promises();
        after();
    }
}
