//! Memory is reserved before it is used: Rust ends the process on a failed allocation, but a host must survive it.
//!
//! Large arrays are reserved one by one, with [`zeros`], [`reserved`] and [`copied`], the largest with
//! [`Pages`](super::pages::Pages). If many small objects or other code allocate, [`headroom`] checks beforehand that
//! there is enough memory, and keeps it free from the large arrays of other threads.

use std::cell::Cell;
use std::marker::PhantomData;
use std::sync::atomic::{AtomicUsize, Ordering};

use crate::error::{Error, Kind, Result};
use crate::platform::mapping::could_have;
use crate::platform::shortage::is_short;

/// Bytes kept free for small objects: texts, maps, the growth of the heap by the allocator.
const SPARE: usize = 2 << 20;
/// Reservations of at least this size must leave the spare memory: the check takes two system calls, as long as filling a
/// smaller array.
pub const LARGE: usize = 32 << 10;
/// Work arrays of faer's products, allocated at the first product of every thread.
pub const PRODUCTS: usize = 5 << 20;
/// For an outer room within which many small matrices are made one after the other.
pub const SMALL_MATRICES: usize = PRODUCTS + (1 << 20);

/// Sum of all rooms in use.
static PROMISED: AtomicUsize = AtomicUsize::new(0);

thread_local! {
    /// Bytes of an outer room of this thread that inner rooms may use without another check, which costs two system
    /// calls.
    static INSIDE: Cell<usize> = const { Cell::new(0) };
    /// Sum of the rooms of this thread that were checked.
    static PROVED: Cell<usize> = const { Cell::new(0) };
}

/// Memory kept free for small objects of this thread, until dropped.
#[derive(Debug)]
pub struct Headroom {
    bytes: usize,
    /// It is part of an outer room of this thread.
    inner: bool,
    /// Bytes for inner rooms.
    inside: usize,
    thread: PhantomData<*const ()>,
}

/// Room for `bytes` in small objects, or `Kind::Memory` with their purpose `what`.
pub fn headroom(bytes: usize, what: &str) -> Result<Headroom> {
    if let Some(left) = INSIDE.get().checked_sub(bytes) {
        INSIDE.set(left);
        return Ok(Headroom { bytes, inner: true, inside: 0, thread: PhantomData });
    }
    proved(bytes, what)
}

/// A room with `inside` further bytes for inner rooms of this thread.
pub fn headroom_with(bytes: usize, inside: usize, what: &str) -> Result<Headroom> {
    let mut room = headroom(bytes.saturating_add(inside), what)?;
    room.inside = inside;
    INSIDE.set(INSIDE.get() + inside);
    Ok(room)
}

fn proved(bytes: usize, what: &str) -> Result<Headroom> {
    let mut promised = PROMISED.load(Ordering::Relaxed);
    loop {
        let with_this = promised.saturating_add(bytes);
        if !is_free(with_this) {
            return Err(refusal(bytes, what));
        }
        match PROMISED.compare_exchange(promised, with_this, Ordering::Relaxed, Ordering::Relaxed) {
            Ok(_) => {
                PROVED.set(PROVED.get() + bytes);
                return Ok(Headroom { bytes, inner: false, inside: 0, thread: PhantomData });
            }
            Err(changed) => promised = changed,
        }
    }
}

impl Drop for Headroom {
    fn drop(&mut self) {
        INSIDE.set(INSIDE.get() - self.inside);
        if self.inner {
            INSIDE.set(INSIDE.get() + self.bytes);
            return;
        }
        PROVED.set(PROVED.get() - self.bytes);
        PROMISED.fetch_sub(self.bytes, Ordering::Relaxed);
    }
}

/// In a child process of fork with this thread only: the rooms of other threads no longer exist.
pub fn keep_own_promises() {
    PROMISED.store(PROVED.try_with(Cell::get).unwrap_or(0), Ordering::Relaxed);
}

/// True if this memory is available in addition to the spare memory.
fn is_free(bytes: usize) -> bool {
    !is_short() && could_have(bytes.saturating_add(SPARE))
}

/// Checks that all rooms and the spare memory would still be available after `bytes` are taken.
pub fn ensure_spare(bytes: usize, what: &str) -> Result<()> {
    if is_free(PROMISED.load(Ordering::Relaxed)) {
        return Ok(());
    }
    Err(refusal(bytes, what))
}

/// `len` zeros, or `Kind::Memory` with their purpose `what`.
pub fn zeros(len: usize, what: &str) -> Result<Vec<f64>> {
    filled(len, 0.0, what)
}

/// `len` copies of one value.
pub fn filled<T: Clone>(len: usize, value: T, what: &str) -> Result<Vec<T>> {
    let mut values = reserved(len, what)?;
    values.resize(len, value);
    Ok(values)
}

/// An empty vector with room for exactly `len` entries.
pub fn reserved<T>(len: usize, what: &str) -> Result<Vec<T>> {
    let bytes = len.saturating_mul(size_of::<T>());
    let mut values = Vec::new();
    let had = values.try_reserve_exact(len).is_ok();
    if !had || is_short() {
        return Err(refusal(bytes, what));
    }
    if bytes >= LARGE {
        ensure_spare(bytes, what)?;
    }
    Ok(values)
}

/// A copy of the host's array.
pub fn copied<T: Copy>(values: &[T], what: &str) -> Result<Vec<T>> {
    let mut copy = reserved(values.len(), what)?;
    copy.extend_from_slice(values);
    Ok(copy)
}

/// Checks that `bytes` are available now, without keeping them.
pub fn available(bytes: usize, what: &str) -> Result<()> {
    headroom(bytes, what).map(drop)
}

pub fn refusal(bytes: usize, what: &str) -> Error {
    Error::new(Kind::Memory, format!("{bytes} bytes for {what} could not be reserved")).value(bytes as f64)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_no_machine_has_is_refused_with_its_size() {
        for error in [headroom(1 << 60, "a body").unwrap_err(), zeros(1 << 57, "a body").unwrap_err()] {
            assert_eq!((error.kind, error.place.value), (Kind::Memory, Some((1_u64 << 60) as f64)));
        }
        assert!(headroom(usize::MAX, "a body").is_err());
        assert!(headroom(1 << 20, "a body").is_ok());
    }

    #[test]
    fn rooms_inside_another_are_parts_of_it_and_larger_ones_are_proved() {
        let outer = headroom_with(1 << 20, 1 << 16, "a solve").unwrap();
        assert_eq!((outer.bytes, INSIDE.get()), ((1 << 20) + (1 << 16), 1 << 16));
        let (small, large) = (headroom(1 << 15, "a body").unwrap(), headroom(1 << 16, "a body").unwrap());
        assert!(small.inner && !large.inner && INSIDE.get() == 1 << 15);
        drop((small, large));
        let part = headroom_with(1 << 13, 1 << 14, "a body").unwrap();
        assert!(part.inner && INSIDE.get() == (1 << 16) - (1 << 13));
        drop(part);
        assert_eq!(INSIDE.get(), 1 << 16);
        drop(outer);
        assert_eq!(INSIDE.get(), 0);
    }

    #[test]
    fn a_room_is_promised_until_it_is_dropped_and_a_refused_one_is_not() {
        let large = 1 << 30;
        let kept = headroom(large, "a body").unwrap();
        assert!(PROMISED.load(Ordering::Relaxed) >= large);
        assert!(headroom(1 << 60, "a body").is_err());
        drop(kept);
        assert!(PROMISED.load(Ordering::Relaxed) < large);
    }
}
