//! Processor time and peak memory of this process, as the system counts them.

use std::fs;
use std::time::Instant;

/// What clock_gettime fills in on 64-bit Linux.
#[repr(C)]
#[derive(Default)]
struct TimeSpec {
    seconds: i64,
    nanoseconds: i64,
}

extern "C" {
    fn clock_gettime(clock: i32, time: *mut TimeSpec) -> i32;
    fn malloc_trim(pad: usize) -> i32;
}

const CLOCK_PROCESS_CPUTIME_ID: i32 = 2;

/// Seconds of wall and processor time (all threads together) between two moments.
#[derive(Clone, Copy)]
pub struct Lap {
    pub wall: f64,
    pub cpu: f64,
}

impl std::ops::Add for Lap {
    type Output = Self;

    fn add(self, other: Self) -> Self {
        Self { wall: self.wall + other.wall, cpu: self.cpu + other.cpu }
    }
}

pub struct Clock {
    wall: Instant,
    cpu: f64,
}

impl Clock {
    pub fn start() -> Self {
        Self { wall: Instant::now(), cpu: processor_time() }
    }

    /// Since the start.
    pub fn lap(&self) -> Lap {
        Lap { wall: self.wall.elapsed().as_secs_f64(), cpu: processor_time() - self.cpu }
    }
}

fn processor_time() -> f64 {
    let mut time = TimeSpec::default();
    // SAFETY: `time` has the layout of struct timespec on 64-bit Linux, and lives through the call.
    unsafe { clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &mut time) };
    time.seconds as f64 + 1e-9 * time.nanoseconds as f64
}

/// Gives free memory back to the system and lets the peak begin at what is resident now.
pub fn restart_peak() {
    // SAFETY: no argument but a number; frees nothing that is in use.
    unsafe { malloc_trim(0) };
    // Where the system refuses, the peak is that of the whole process.
    let _ = fs::write("/proc/self/clear_refs", "5");
}

/// VmHWM: peak of the resident memory, bytes.
pub fn peak() -> f64 {
    bytes("/proc/self/status", "VmHWM:").map_or(f64::NAN, |bytes| bytes as f64)
}

/// Bytes that a line `key` of a file of the system gives in kB.
pub fn bytes(path: &str, key: &str) -> Option<usize> {
    let text = fs::read_to_string(path).ok()?;
    let value = text.lines().find_map(|line| line.strip_prefix(key))?;
    Some(1024 * value.trim().trim_end_matches(" kB").parse::<usize>().ok()?)
}
