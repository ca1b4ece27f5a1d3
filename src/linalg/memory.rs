//! Memory is reserved before it is used: Rust ends the process on a failed allocation, a host must not.
//!
//! Large arrays are reserved one by one, with [`zeros`], [`reserved`] and [`copied`]. Where many small pieces or foreign
//! code allocate, [`room`] proves beforehand that there is enough, and keeps the large arrays of other threads from taking it.

use std::alloc::{alloc_zeroed, Layout};
use std::hint::black_box;
use std::sync::atomic::{AtomicUsize, Ordering};

use crate::error::{Error, Kind, Result};

/// Bytes that are always left for small pieces: texts, maps, the growth of the heap by the allocator.
const SPARE: usize = 2 << 20;
/// Reservations from this size on must leave what is spare.
const LARGE: usize = 4 << 10;
/// Arrays from this size on get large pages.
#[cfg(target_os = "linux")]
const LARGE_PAGES: usize = 8 << 20;
/// Work arrays of faer's products, made on the first product of every thread.
pub const PRODUCTS: usize = 5 << 20;

/// Sum of all rooms in use.
static PROMISED: AtomicUsize = AtomicUsize::new(0);

/// A part of the memory kept free for small pieces, until dropped.
#[derive(Debug)]
pub struct Room {
    bytes: usize,
}

/// Room for `bytes` in small pieces, or `Kind::Memory` naming `what` they were for.
pub fn room(bytes: usize, what: &str) -> Result<Room> {
    let mut promised = PROMISED.load(Ordering::Relaxed);
    loop {
        let with_this = promised.saturating_add(bytes);
        if !is_free(with_this) {
            return Err(refusal(bytes, what));
        }
        match PROMISED.compare_exchange(promised, with_this, Ordering::Relaxed, Ordering::Relaxed) {
            Ok(_) => return Ok(Room { bytes }),
            Err(changed) => promised = changed,
        }
    }
}

impl Drop for Room {
    fn drop(&mut self) {
        PROMISED.fetch_sub(self.bytes, Ordering::Relaxed);
    }
}

/// True when so many bytes could be had now besides what is spare. The optimiser must see a use: it may leave out an
/// allocation that has none, and count it as successful.
fn is_free(bytes: usize) -> bool {
    let mut block: Vec<u8> = Vec::new();
    let had = block.try_reserve_exact(bytes.saturating_add(SPARE)).is_ok();
    black_box(block.as_ptr());
    had
}

/// `len` zeros, or `Kind::Memory` naming `what` they were for.
pub fn zeros(len: usize, what: &str) -> Result<Vec<f64>> {
    let mut values = reserved(len, what)?;
    values.resize(len, 0.0);
    Ok(values)
}

/// As `zeros`, in memory that the system clears when it is touched first, not before.
pub fn untouched_zeros(len: usize, what: &str) -> Result<Vec<f64>> {
    let bytes = len.saturating_mul(size_of::<f64>());
    let layout = Layout::array::<f64>(len).map_err(|_| refusal(bytes, what))?;
    if bytes < LARGE {
        return zeros(len, what);
    }
    // SAFETY: the layout is that of `len` doubles, more than none, and what the allocator gives belongs to nobody else.
    // All bits zero is the double 0.
    let values = unsafe {
        let start = alloc_zeroed(layout).cast::<f64>();
        if start.is_null() {
            return Err(refusal(bytes, what));
        }
        Vec::from_raw_parts(start, len, len)
    };
    if is_free(PROMISED.load(Ordering::Relaxed)) {
        advise_large_pages(&values);
        return Ok(values);
    }
    drop(values);
    Err(refusal(bytes, what))
}

/// Asks for pages of 2 MiB, where the system has them on request: clearing pages of 4 KiB one by one when they are touched
/// first takes a sixth of a factorisation.
#[cfg(target_os = "linux")]
fn advise_large_pages(values: &[f64]) {
    const PAGE: usize = 4096;
    let range = values.as_ptr_range();
    let start = (range.start as usize).next_multiple_of(PAGE);
    let len = (range.end as usize).saturating_sub(start) / PAGE * PAGE;
    if len >= LARGE_PAGES {
        // SAFETY: whole pages inside the array; the advice does not change what they hold. Where it is refused nothing
        // happens.
        unsafe { libc::madvise(start as *mut libc::c_void, len, libc::MADV_HUGEPAGE) };
    }
}

#[cfg(not(target_os = "linux"))]
fn advise_large_pages(_: &[f64]) {}

/// An empty vector with room for exactly `len` entries.
pub fn reserved<T>(len: usize, what: &str) -> Result<Vec<T>> {
    let bytes = len.saturating_mul(size_of::<T>());
    let mut values = Vec::new();
    let had = values.try_reserve_exact(len).is_ok();
    if had && (bytes < LARGE || is_free(PROMISED.load(Ordering::Relaxed))) {
        return Ok(values);
    }
    drop(values);
    Err(refusal(bytes, what))
}

/// A copy of the host's array.
pub fn copied<T: Copy>(values: &[T], what: &str) -> Result<Vec<T>> {
    let mut copy = reserved(values.len(), what)?;
    copy.extend_from_slice(values);
    Ok(copy)
}

/// Checks that `bytes` could be had now, without keeping them.
pub fn available(bytes: usize, what: &str) -> Result<()> {
    room(bytes, what).map(drop)
}

pub fn refusal(bytes: usize, what: &str) -> Error {
    Error::new(Kind::Memory, format!("{bytes} bytes for {what} could not be reserved")).value(bytes as f64)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_no_machine_has_is_refused_with_its_size() {
        for error in [room(1 << 60, "a body").unwrap_err(), zeros(1 << 57, "a body").unwrap_err()] {
            assert_eq!((error.kind, error.place.value), (Kind::Memory, Some((1_u64 << 60) as f64)));
        }
        assert!(room(usize::MAX, "a body").is_err());
        assert!(room(1 << 20, "a body").is_ok());
    }

    #[test]
    fn a_room_is_promised_until_it_is_dropped_and_a_refused_one_is_not() {
        let large = 1 << 30;
        let kept = room(large, "a body").unwrap();
        assert!(PROMISED.load(Ordering::Relaxed) >= large);
        assert!(room(1 << 60, "a body").is_err());
        drop(kept);
        assert!(PROMISED.load(Ordering::Relaxed) < large);
    }
}
