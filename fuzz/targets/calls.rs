#![no_main]

use std::sync::atomic::Ordering;

use feti_contact_fuzz::calls::{run, CERTIFIED, SEQUENCES};
use libfuzzer_sys::fuzz_target;

/// Written to the log from time to time, and at the end.
extern "C" fn report() {
    let (all, certified) = (SEQUENCES.load(Ordering::Relaxed), CERTIFIED.load(Ordering::Relaxed));
    let share = 100.0 * certified as f64 / all.max(1) as f64;
    eprintln!("certified {certified} of {all} sequences, {share:.1} %");
}

fuzz_target!(init: {
    // SAFETY: the function neither unwinds nor touches what is gone by then.
    unsafe { libc::atexit(report) };
}, |data: &[u8]| {
    run(data);
    if SEQUENCES.load(Ordering::Relaxed) % 100_000 == 0 {
        report();
    }
});
