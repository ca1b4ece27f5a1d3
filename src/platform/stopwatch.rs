//! Processor time of the thread that leads: without that of its own bodies, and without waiting.

use std::cell::Cell;

thread_local! {
    /// Seconds set aside so far; none while nothing is measured.
    static ASIDE: Cell<Option<f64>> = const { Cell::new(None) };
}

/// Processor seconds of this thread in `work`, but for what is set aside.
pub fn leading<T>(work: impl FnOnce() -> T) -> (T, f64) {
    let begun = processor();
    let before = ASIDE.replace(Some(0.0));
    let done = work();
    let aside = ASIDE.replace(before).unwrap_or(0.0);
    (done, processor() - begun - aside)
}

/// Sets aside the time of `work`.
pub fn aside<T>(work: impl FnOnce() -> T) -> T {
    // what is inside is set aside with it
    let Some(so_far) = ASIDE.take() else { return work() };
    let begun = processor();
    let done = work();
    ASIDE.set(Some(so_far + processor() - begun));
    done
}

#[cfg(target_os = "linux")]
fn processor() -> f64 {
    use std::time::Duration;

    let mut time = libc::timespec { tv_sec: 0, tv_nsec: 0 };
    // SAFETY: a valid place for the time
    unsafe { libc::clock_gettime(libc::CLOCK_THREAD_CPUTIME_ID, &mut time) };
    Duration::new(time.tv_sec as u64, time.tv_nsec as u32).as_secs_f64()
}

#[cfg(not(target_os = "linux"))]
fn processor() -> f64 {
    f64::NAN
}

#[cfg(test)]
mod tests {
    use super::*;

    fn works(seconds: f64) {
        let begun = processor();
        while processor() < begun + seconds {
            std::hint::spin_loop();
        }
    }

    #[test]
    fn what_is_set_aside_is_counted_once_and_a_thread_that_sleeps_not_at_all() {
        let (_, seconds) = leading(|| {
            works(0.02);
            aside(|| {
                works(0.03);
                aside(|| works(0.04));
            });
            std::thread::sleep(std::time::Duration::from_millis(30));
        });
        assert!((0.02..0.03).contains(&seconds), "{seconds}");
        assert_eq!(ASIDE.get(), None);
    }
}
