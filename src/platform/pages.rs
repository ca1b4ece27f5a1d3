//! Large arrays in separate pages, initially zero, that are returned to the system when they are dropped. Memory of freed
//! arrays that the allocator keeps would add to the peak of later allocations.

use std::alloc::{alloc_zeroed, dealloc, Layout};
use std::ops::{Deref, DerefMut};
use std::ptr::NonNull;
use std::slice::{from_raw_parts, from_raw_parts_mut};
use std::sync::Arc;

use crate::error::Result;
use crate::platform::mapping::{map, unmap, PAGE};
use crate::platform::memory::{ensure_spare, refusal, LARGE};

/// Smaller arrays come from the allocator, which reuses memory: this is faster than fresh pages, by a fifth of the time
/// of the factorisation of pieces.
const SMALL: usize = 8 << 20;
/// Fewer bytes are not returned before the array is dropped.
const FEW: usize = 256 << 10;

/// A number that is 0 if all its bits are 0.
pub trait Number: Copy + Send + Sync + 'static {}

impl Number for f64 {}
impl Number for f32 {}

/// An array of numbers, by default doubles.
pub struct Pages<T: Number = f64> {
    start: NonNull<T>,
    len: usize,
    /// Bytes of the pages, 0 if the array comes from the allocator.
    mapped: usize,
    /// Layout for the allocator.
    layout: Layout,
    /// The array of which it is a part.
    whole: Option<Arc<Pages>>,
}

// SAFETY: it owns its numbers as a `Vec` does.
unsafe impl<T: Number> Send for Pages<T> {}
// SAFETY: it owns its numbers as a `Vec` does.
unsafe impl<T: Number> Sync for Pages<T> {}

impl<T: Number> Pages<T> {
    /// `len` zeros, or `Kind::Memory` with their purpose `what`.
    pub fn zeros(len: usize, what: &str) -> Result<Self> {
        let bytes = len.saturating_mul(size_of::<T>());
        let refused = || refusal(bytes, what);
        let layout = Layout::array::<T>(len).map_err(|_| refused())?;
        let apart = bytes >= SMALL && cfg!(target_os = "linux");
        let mapped = if apart { bytes.checked_next_multiple_of(PAGE).ok_or_else(refused)? } else { 0 };
        let start = match bytes {
            0 => NonNull::dangling(),
            _ if apart => map(mapped, true).ok_or_else(refused)?.cast(),
            // SAFETY: the size is not 0. All bits zero is the number 0.
            _ => NonNull::new(unsafe { alloc_zeroed(layout) }.cast()).ok_or_else(refused)?,
        };
        let pages = Self { start, len, mapped, layout, whole: None };
        if bytes >= LARGE {
            ensure_spare(bytes, what)?;
        }
        Ok(pages)
    }

    /// `len` numbers of `whole` from byte `at` on; `whole` lives at least as long as they do.
    ///
    /// # Safety
    /// They lie in `whole`, are aligned, and are not used elsewhere.
    pub(super) unsafe fn part_of(whole: &Arc<Pages>, at: usize, len: usize) -> Self {
        // SAFETY: within `whole`, as the caller promises
        let start = unsafe { whole.start.byte_add(at) }.cast();
        Self { start, len, mapped: 0, layout: Layout::new::<()>(), whole: Some(Arc::clone(whole)) }
    }

    /// Keeps the first `len` values; if many pages become free, they are returned to the system.
    pub fn truncate(&mut self, len: usize) {
        self.len = len.min(self.len);
        let kept = (self.len * size_of::<T>()).next_multiple_of(PAGE).max(PAGE);
        if kept + FEW <= self.mapped {
            // SAFETY: whole pages of this array after those that are kept.
            unsafe { unmap(self.start.cast::<f64>().byte_add(kept), self.mapped - kept) };
            self.mapped = kept;
        }
    }
}

impl<T: Number> Deref for Pages<T> {
    type Target = [T];

    fn deref(&self) -> &[T] {
        // SAFETY: `len` numbers that belong to this array; all bits of a fresh page are zero, which is the number 0.
        unsafe { from_raw_parts(self.start.as_ptr(), self.len) }
    }
}

impl<T: Number> DerefMut for Pages<T> {
    fn deref_mut(&mut self) -> &mut [T] {
        // SAFETY: as for `deref`, with exclusive access.
        unsafe { from_raw_parts_mut(self.start.as_ptr(), self.len) }
    }
}

impl<T: Number> Drop for Pages<T> {
    fn drop(&mut self) {
        if self.whole.is_some() {
            return;
        }
        if self.mapped > 0 {
            // SAFETY: the pages of this array, mapped by `map`.
            unsafe { unmap(self.start.cast(), self.mapped) };
        } else if self.layout.size() > 0 {
            // SAFETY: allocated with this layout.
            unsafe { dealloc(self.start.as_ptr().cast(), self.layout) };
        }
    }
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
                pages.truncate(cut);
                assert!(pages.len() == cut && pages.iter().enumerate().all(|(i, v)| *v == i as f64));
            }
        }
    }

    #[test]
    fn what_no_machine_has_is_refused_with_its_size() {
        for len in [1 << 57, usize::MAX] {
            let error = Pages::<f64>::zeros(len, "a body").err().unwrap();
            assert_eq!(error.kind, Kind::Memory);
        }
    }
}
