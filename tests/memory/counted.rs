//! An allocator that notes the largest block a thread asks for, and the bytes in use.

use std::alloc::{GlobalAlloc, Layout, System};
use std::cell::Cell;
use std::sync::atomic::{AtomicIsize, Ordering};

static LIVE: AtomicIsize = AtomicIsize::new(0);

thread_local! {
    static LARGEST: Cell<usize> = const { Cell::new(0) };
}

struct Noting;

/// A block of `bytes` in place of one of `freed` bytes.
fn note(bytes: usize, freed: usize) {
    LIVE.fetch_add(bytes as isize - freed as isize, Ordering::Relaxed);
    let _ = LARGEST.try_with(|largest| largest.set(largest.get().max(bytes)));
}

// SAFETY: every call goes to the allocator of the system, unchanged.
unsafe impl GlobalAlloc for Noting {
    unsafe fn alloc(&self, layout: Layout) -> *mut u8 {
        note(layout.size(), 0);
        // SAFETY: as the caller's.
        unsafe { System.alloc(layout) }
    }

    unsafe fn alloc_zeroed(&self, layout: Layout) -> *mut u8 {
        note(layout.size(), 0);
        // SAFETY: as the caller's.
        unsafe { System.alloc_zeroed(layout) }
    }

    unsafe fn realloc(&self, block: *mut u8, layout: Layout, bytes: usize) -> *mut u8 {
        note(bytes, layout.size());
        // SAFETY: as the caller's.
        unsafe { System.realloc(block, layout, bytes) }
    }

    unsafe fn dealloc(&self, block: *mut u8, layout: Layout) {
        note(0, layout.size());
        // SAFETY: as the caller's.
        unsafe { System.dealloc(block, layout) }
    }
}

#[global_allocator]
static ALLOCATOR: Noting = Noting;

/// Bytes of the largest block that `work` asks for on this thread.
pub fn largest_block<T>(work: impl FnOnce() -> T) -> (usize, T) {
    LARGEST.set(0);
    let done = work();
    (LARGEST.get(), done)
}

/// Bytes in use by all threads.
pub fn live_bytes() -> isize {
    LIVE.load(Ordering::Relaxed)
}
