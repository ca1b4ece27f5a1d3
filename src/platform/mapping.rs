//! Memory pages mapped directly from the system.

use std::ptr::NonNull;

/// A multiple of the page size of all systems: Linux uses 4, 16 or 64 KiB.
pub const PAGE: usize = 64 << 10;

/// Fresh pages of this size. If they will be `used`, large pages are requested where the system has them: clearing small
/// pages at the first access takes a sixth of the time of a factorisation.
#[cfg(target_os = "linux")]
pub fn map(bytes: usize, used: bool) -> Option<NonNull<f64>> {
    let access = libc::PROT_READ | libc::PROT_WRITE;
    let kind = libc::MAP_PRIVATE | libc::MAP_ANONYMOUS;
    // SAFETY: new pages at an address that the system chooses.
    let start = unsafe { libc::mmap(std::ptr::null_mut(), bytes, access, kind, -1, 0) };
    if start == libc::MAP_FAILED {
        return None;
    }
    if used {
        // SAFETY: the pages just mapped; the advice does not change their content. If it is refused, nothing changes.
        unsafe { libc::madvise(start, bytes, libc::MADV_HUGEPAGE) };
    }
    NonNull::new(start.cast())
}

/// # Safety
/// Whole pages of a block from `map`, not in use.
#[cfg(target_os = "linux")]
pub unsafe fn unmap(start: NonNull<f64>, bytes: usize) {
    libc::munmap(start.as_ptr().cast(), bytes);
}

#[cfg(not(target_os = "linux"))]
pub fn map(_: usize, _: bool) -> Option<NonNull<f64>> {
    None
}

#[cfg(not(target_os = "linux"))]
pub unsafe fn unmap(_: NonNull<f64>, _: usize) {}

/// True if the system could give this memory now.
#[cfg(target_os = "linux")]
pub fn could_have(bytes: usize) -> bool {
    let Some(bytes) = bytes.checked_next_multiple_of(PAGE) else { return false };
    // SAFETY: the pages just mapped.
    map(bytes, false).map(|start| unsafe { unmap(start, bytes) }).is_some()
}

/// True if the allocator could give this memory now. The memory must be used, otherwise the optimiser may remove the
/// allocation and treat it as successful.
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

    #[test]
    fn what_no_machine_has_could_not_be_had() {
        assert!(!could_have(usize::MAX) && !could_have(1 << 60) && could_have(1 << 20));
    }
}
