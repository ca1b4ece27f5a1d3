//! Numbers of a matrix: stored by the library, or in the host's arrays.

use std::ops::{Deref, DerefMut};
use std::ptr::NonNull;
use std::slice;

/// Reads as a slice. Numbers of the host are copied before a change: the host's array never changes.
#[derive(Debug, Clone)]
pub struct Array<T> {
    own: Vec<T>,
    /// The host's numbers, used instead of `own` if `left`; never without a value, since loops test its length before `left`.
    host: Borrowed<T>,
    left: bool,
}

/// Numbers in the memory of the host, which may change them between two calls.
#[derive(Debug, Clone, Copy)]
pub struct Borrowed<T> {
    start: NonNull<T>,
    len: usize,
}

// SAFETY: the creator guarantees that every thread may read the numbers.
unsafe impl<T: Sync> Send for Borrowed<T> {}
// SAFETY: as above.
unsafe impl<T: Sync> Sync for Borrowed<T> {}

impl<T> Borrowed<T> {
    /// # Safety
    /// `start` is aligned and leads to `len` numbers, which every thread may read until the result and all its copies are
    /// dropped, and which do not change while a call of the library runs.
    pub unsafe fn new(start: NonNull<T>, len: usize) -> Self {
        Self { start, len }
    }

    fn none() -> Self {
        Self { start: NonNull::dangling(), len: 0 }
    }
}

impl<T> Deref for Borrowed<T> {
    type Target = [T];

    fn deref(&self) -> &[T] {
        // SAFETY: guaranteed by `new`; a new reference each time, since the numbers may have changed.
        unsafe { slice::from_raw_parts(self.start.as_ptr(), self.len) }
    }
}

impl<T> Array<T> {
    pub fn is_of_host(&self) -> bool {
        self.left
    }

    /// Bytes that the library keeps for it.
    pub fn bytes(&self) -> usize {
        self.own.capacity() * size_of::<T>()
    }
}

impl<T: Clone> Array<T> {
    /// The numbers in the library's own memory.
    pub fn to_mut(&mut self) -> &mut Vec<T> {
        if self.left {
            self.own = self.host.to_vec();
            (self.host, self.left) = (Borrowed::none(), false);
        }
        &mut self.own
    }

    pub fn push(&mut self, number: T) {
        self.to_mut().push(number);
    }
}

impl<T> Deref for Array<T> {
    type Target = [T];

    fn deref(&self) -> &[T] {
        if self.left {
            &self.host
        } else {
            &self.own
        }
    }
}

impl<T: Clone> DerefMut for Array<T> {
    fn deref_mut(&mut self) -> &mut [T] {
        self.to_mut()
    }
}

impl<T> From<Vec<T>> for Array<T> {
    fn from(own: Vec<T>) -> Self {
        Self { own, host: Borrowed::none(), left: false }
    }
}

impl<T> From<Borrowed<T>> for Array<T> {
    fn from(host: Borrowed<T>) -> Self {
        Self { own: Vec::new(), host, left: true }
    }
}

impl<T> AsRef<[T]> for Array<T> {
    fn as_ref(&self) -> &[T] {
        self
    }
}

impl<T: PartialEq, A: AsRef<[T]> + ?Sized> PartialEq<A> for Array<T> {
    fn eq(&self, other: &A) -> bool {
        **self == *other.as_ref()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_of_the_host_are_read_where_they_are_and_as_they_are() {
        let mut host = [1.0, 2.0, 3.0];
        let start = host.as_mut_ptr();
        // SAFETY: three numbers, changed between two reads.
        let array = Array::from(unsafe { Borrowed::new(NonNull::new_unchecked(start), 3) });
        assert!(array.is_of_host() && array.bytes() == 0 && array == [1.0, 2.0, 3.0]);
        // SAFETY: as above.
        unsafe { start.add(1).write(7.0) };
        assert!(array == [1.0, 7.0, 3.0] && array.clone().is_of_host());
        assert_eq!(std::thread::scope(|scope| scope.spawn(|| array[1]).join().unwrap()), 7.0);
    }

    #[test]
    fn numbers_of_the_host_are_copied_before_they_are_written_to() {
        let host = [1.0, 2.0, 3.0];
        // SAFETY: three numbers that stay valid.
        let mut array = Array::from(unsafe { Borrowed::new(NonNull::from(&host).cast(), 3) });
        array[0] = 9.0;
        array.push(4.0);
        assert!(!array.is_of_host() && array == [9.0, 2.0, 3.0, 4.0]);
        assert_eq!(host, [1.0, 2.0, 3.0]);
    }
}
