//! Large arrays in pages of their own: zeros that the system makes when they are touched first, given back to it when they
//! are dropped. What the allocator keeps of an array that is gone would add to the peak of what comes after it.

use std::ops::{Deref, DerefMut};
use std::ptr::NonNull;
use std::slice::{from_raw_parts, from_raw_parts_mut};

use crate::error::Result;
use crate::linalg::memory::{ensure_spare, refusal, zeros};

/// Smaller arrays come from the allocator.
const SMALL: usize = 256 << 10;
/// Arrays from this size on get large pages, where the system has them on request: clearing pages of 4 KiB one by one when
/// they are touched first takes a sixth of a factorisation.
#[cfg(target_os = "linux")]
const LARGE_PAGES: usize = 8 << 20;
/// A multiple of the pages of all systems: those of Linux have 4, 16 or 64 KiB.
const PAGE: usize = 64 << 10;

/// An array of doubles.
pub struct Pages {
    start: NonNull<f64>,
    len: usize,
    /// Bytes of the pages; 0 where the allocator gave so many doubles.
    mapped: usize,
    boxed: usize,
}

// SAFETY: it owns its doubles as a `Vec` does.
unsafe impl Send for Pages {}
// SAFETY: it owns its doubles as a `Vec` does.
unsafe impl Sync for Pages {}

impl Pages {
    /// `len` zeros, or `Kind::Memory` naming `what` they were for.
    pub fn zeros(len: usize, what: &str) -> Result<Self> {
        let bytes = len.saturating_mul(size_of::<f64>());
        if bytes < SMALL || !cfg!(target_os = "linux") {
            return zeros(len, what).map(Self::of);
        }
        let mapped = bytes.checked_next_multiple_of(PAGE).ok_or_else(|| refusal(bytes, what))?;
        let start = map(mapped).ok_or_else(|| refusal(bytes, what))?;
        advise_large_pages(start, mapped);
        let pages = Self { start, len, mapped, boxed: 0 };
        ensure_spare(bytes, what).map(|()| pages)
    }

    fn of(values: Vec<f64>) -> Self {
        let values = values.into_boxed_slice();
        let len = values.len();
        // SAFETY: a box is never null.
        let start = unsafe { NonNull::new_unchecked(Box::into_raw(values).cast()) };
        Self { start, len, mapped: 0, boxed: len }
    }

    /// The first `len` values; what pages they do not need goes back to the system.
    pub fn truncated(mut self, len: usize) -> Self {
        self.len = len.min(self.len);
        let kept = (self.len * size_of::<f64>()).next_multiple_of(PAGE).max(PAGE);
        if kept < self.mapped {
            // SAFETY: whole pages of this array behind those that are kept.
            unsafe { unmap(self.start.byte_add(kept), self.mapped - kept) };
            self.mapped = kept;
        }
        self
    }
}

impl Deref for Pages {
    type Target = [f64];

    fn deref(&self) -> &[f64] {
        // SAFETY: `len` doubles that belong to this array; all bits of a fresh page are zero, which is the double 0.
        unsafe { from_raw_parts(self.start.as_ptr(), self.len) }
    }
}

impl DerefMut for Pages {
    fn deref_mut(&mut self) -> &mut [f64] {
        // SAFETY: as for `deref`, and nobody else sees them.
        unsafe { from_raw_parts_mut(self.start.as_ptr(), self.len) }
    }
}

impl Drop for Pages {
    fn drop(&mut self) {
        if self.mapped > 0 {
            // SAFETY: the pages of this array, mapped by `map`.
            unsafe { unmap(self.start, self.mapped) };
        } else {
            let values = std::ptr::slice_from_raw_parts_mut(self.start.as_ptr(), self.boxed);
            // SAFETY: it came from a box of as many doubles.
            drop(unsafe { Box::from_raw(values) });
        }
    }
}

/// Fresh pages of so many bytes.
#[cfg(target_os = "linux")]
fn map(bytes: usize) -> Option<NonNull<f64>> {
    let access = libc::PROT_READ | libc::PROT_WRITE;
    let kind = libc::MAP_PRIVATE | libc::MAP_ANONYMOUS;
    // SAFETY: new pages at an address that the system chooses.
    let start = unsafe { libc::mmap(std::ptr::null_mut(), bytes, access, kind, -1, 0) };
    if start == libc::MAP_FAILED {
        return None;
    }
    NonNull::new(start.cast())
}

/// Asks for large pages; where the system has none, nothing happens.
#[cfg(target_os = "linux")]
fn advise_large_pages(start: NonNull<f64>, bytes: usize) {
    if bytes >= LARGE_PAGES {
        // SAFETY: pages that `map` gave; the advice does not change what they hold.
        unsafe { libc::madvise(start.as_ptr().cast(), bytes, libc::MADV_HUGEPAGE) };
    }
}

/// # Safety
/// Whole pages of a block that `map` gave, used by nobody.
#[cfg(target_os = "linux")]
unsafe fn unmap(start: NonNull<f64>, bytes: usize) {
    libc::munmap(start.as_ptr().cast(), bytes);
}

#[cfg(not(target_os = "linux"))]
fn map(_: usize) -> Option<NonNull<f64>> {
    None
}

#[cfg(not(target_os = "linux"))]
fn advise_large_pages(_: NonNull<f64>, _: usize) {}

#[cfg(not(target_os = "linux"))]
unsafe fn unmap(_: NonNull<f64>, _: usize) {}

/// True when the system would give so many bytes now.
#[cfg(target_os = "linux")]
pub fn could_have(bytes: usize) -> bool {
    let Some(bytes) = bytes.checked_next_multiple_of(PAGE) else { return false };
    // SAFETY: the pages just mapped.
    map(bytes).map(|start| unsafe { unmap(start, bytes) }).is_some()
}

/// True when the allocator would give so many bytes now. The optimiser must see a use: it may leave out an allocation that
/// has none, and count it as successful.
#[cfg(not(target_os = "linux"))]
pub fn could_have(bytes: usize) -> bool {
    let mut block: Vec<u8> = Vec::new();
    let had = block.try_reserve_exact(bytes).is_ok();
    std::hint::black_box(block.as_ptr());
    had
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::error::Kind;

    #[test]
    fn arrays_of_all_sizes_are_zero_and_keep_what_is_written_when_cut() {
        for len in [0, 1, 511, 512, SMALL / 8 - 1, SMALL / 8, 3 * SMALL / 8 + 5, 2 << 20] {
            let mut pages = Pages::zeros(len, "a body").unwrap();
            assert!(pages.len() == len && pages.iter().all(|v| *v == 0.0));
            pages.iter_mut().enumerate().for_each(|(i, v)| *v = i as f64);
            for cut in [len, len / 2, len / 1000, 0] {
                pages = pages.truncated(cut);
                assert!(pages.len() == cut && pages.iter().enumerate().all(|(i, v)| *v == i as f64));
            }
        }
    }

    #[test]
    fn what_no_machine_has_is_refused_with_its_size() {
        for len in [1 << 57, usize::MAX] {
            let error = Pages::zeros(len, "a body").err().unwrap();
            assert_eq!(error.kind, Kind::Memory);
        }
        assert!(!could_have(usize::MAX) && !could_have(1 << 60) && could_have(1 << 20));
    }
}
