//! Memory that the machine has at hand. A virtual machine gives memory that has been free for some seconds back to its host, and the
//! program that touches it next pays up to 4 ms for 2 MB. All programs that are compared begin with as much memory at hand.

use std::ptr::null_mut;

use crate::clock;

/// Bytes for each unknown: what CHOLMOD takes for the largest deck.
pub const BYTES: usize = 16_000;

/// Touches as much memory as a solve with so many unknowns may take, at most half of what is available, and gives it back.
pub fn back_memory(unknowns: usize) {
    let available = clock::bytes("/proc/meminfo", "MemAvailable:").unwrap_or(0);
    let bytes = (BYTES * unknowns).min(available / 2);
    let access = libc::PROT_READ | libc::PROT_WRITE;
    // SAFETY: new pages, written within their bounds, given back at the end.
    unsafe {
        let start = libc::mmap(null_mut(), bytes, access, libc::MAP_PRIVATE | libc::MAP_ANONYMOUS, -1, 0);
        if start != libc::MAP_FAILED {
            libc::madvise(start, bytes, libc::MADV_HUGEPAGE);
            (0..bytes).step_by(4096).for_each(|at| start.cast::<u8>().add(at).write_volatile(1));
            libc::munmap(start, bytes);
        }
    }
}
