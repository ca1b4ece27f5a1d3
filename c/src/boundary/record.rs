//! Result structs that start with `struct_size`: a host compiled with an older header has shorter structs.

use std::mem::MaybeUninit;

use crate::boundary::arrays::null;
use crate::header::types::{
    feti_body_facts, feti_certificate, feti_communicator, feti_error_detail, feti_findings, feti_info,
    feti_option, feti_pair_facts, feti_phase,
};
use feti_contact::error::{Error, Result};

/// The smallest struct: `struct_size` and the next eight bytes.
const LEAST_BYTES: usize = 16;
/// Bytes of `struct_size`, which is not changed.
const SIZE_BYTES: usize = size_of::<i64>();

/// A `repr(C)` struct whose first field is `struct_size: i64`.
pub trait StructSize: Copy {}

macro_rules! first_is_struct_size {
    ($($name:ty),+ $(,)?) => {$(
        impl StructSize for $name {}
        const _: () = assert!(std::mem::offset_of!($name, struct_size) == 0);
    )+};
}

first_is_struct_size!(
    feti_body_facts,
    feti_certificate,
    feti_communicator,
    feti_error_detail,
    feti_findings,
    feti_info,
    feti_option,
    feti_pair_facts,
    feti_phase,
);

/// The caller's struct, to be written once.
pub struct OutStruct<T> {
    to: *mut T,
    bytes: usize,
}

impl<T: StructSize> OutStruct<T> {
    /// # Safety
    /// `to` is NULL or leads to an i64 with the number of bytes that may be written from `to` on.
    pub unsafe fn new(to: *mut T, name: &'static str) -> Result<Self> {
        if to.is_null() {
            return Err(null(name));
        }
        // SAFETY: the first field is readable; it may be anywhere, so it is read unaligned.
        let size = unsafe { to.cast::<i64>().read_unaligned() };
        match usize::try_from(size) {
            Ok(bytes) if bytes >= LEAST_BYTES => Ok(Self { to, bytes: bytes.min(size_of::<T>()) }),
            _ => {
                let ours = size_of::<T>();
                let what =
                    format!("struct_size is {size}, set it to the size of the struct, {ours} bytes here");
                Err(Error::argument(name, what))
            }
        }
    }

    /// Writes as much of `value` as fits the caller's struct.
    pub fn write(&self, value: &T) {
        let from: *const MaybeUninit<u8> = std::ptr::from_ref(value).cast();
        // SAFETY: `bytes` is at least SIZE_BYTES, at most the size of T, and the caller's struct has that many.
        unsafe {
            let to = self.to.cast::<MaybeUninit<u8>>().add(SIZE_BYTES);
            std::ptr::copy_nonoverlapping(from.add(SIZE_BYTES), to, self.bytes - SIZE_BYTES);
        }
    }
}

/// A struct that the caller has filled, which must not be shorter than ours.
///
/// # Safety
/// `from` is NULL or leads to an i64 with the number of bytes that may be read from `from` on.
pub unsafe fn read_struct<T: StructSize>(from: *const T, name: &'static str) -> Result<T> {
    if from.is_null() {
        return Err(null(name));
    }
    let ours = size_of::<T>();
    // SAFETY: as in OutStruct::new.
    let size = unsafe { from.cast::<i64>().read_unaligned() };
    if !usize::try_from(size).is_ok_and(|bytes| bytes >= ours) {
        let what = format!("struct_size is {size}, set it to the size of the struct, {ours} bytes here");
        return Err(Error::argument(name, what));
    }
    // SAFETY: the caller's struct has as many bytes as it says.
    Ok(unsafe { from.read_unaligned() })
}

/// A number of a result struct; -1 if there is none.
pub fn known(number: Option<usize>) -> i64 {
    number.map_or(-1, |number| number as i64)
}

#[cfg(test)]
mod tests {
    use super::*;
    use feti_contact::error::Kind;

    const FULL: usize = size_of::<feti_certificate>();

    /// Writes to a struct filled with ones, 64 bytes longer than ours, with this `struct_size`; returns its bytes.
    fn written(struct_size: i64) -> Result<Vec<u8>> {
        let mut bytes = vec![1_u8; FULL + 64];
        bytes[..8].copy_from_slice(&struct_size.to_ne_bytes());
        // SAFETY: all zero is a valid value of numbers.
        let value: feti_certificate = unsafe { std::mem::zeroed() };
        // SAFETY: the buffer is as long as the largest size under test.
        unsafe { OutStruct::<feti_certificate>::new(bytes.as_mut_ptr().cast(), "out") }?.write(&value);
        Ok(bytes)
    }

    #[test]
    fn no_more_is_written_than_the_callers_struct_holds() {
        for size in [16, 24, 40, FULL, FULL + 64] {
            let bytes = written(size as i64).unwrap();
            let end = size.min(FULL);
            assert_eq!(bytes[..8], (size as i64).to_ne_bytes(), "struct_size stays");
            assert!(bytes[8..end].iter().all(|byte| *byte == 0));
            assert!(bytes[end..].iter().all(|byte| *byte == 1));
        }
    }

    #[test]
    fn a_size_that_cannot_be_is_refused() {
        for size in [i64::MIN, -1, 0, 8, 15] {
            assert_eq!(written(size).unwrap_err().kind, Kind::Argument("out"));
        }
    }
}
