//! Memory is reserved before it is used: Rust ends the process on a failed allocation, a host must not.

use crate::error::{Error, Kind, Result};

/// `len` zeros, or `Kind::Memory` naming `what` they were for.
pub fn zeros(len: usize, what: &str) -> Result<Vec<f64>> {
    let mut values = reserved(len, what)?;
    values.resize(len, 0.0);
    Ok(values)
}

/// An empty vector with room for exactly `len` entries.
pub fn reserved<T>(len: usize, what: &str) -> Result<Vec<T>> {
    let mut values = Vec::new();
    values.try_reserve_exact(len).map_err(|_| refusal(len.saturating_mul(size_of::<T>()), what))?;
    Ok(values)
}

/// A copy of the host's array.
pub fn copied<T: Copy>(values: &[T], what: &str) -> Result<Vec<T>> {
    let mut copy = reserved(values.len(), what)?;
    copy.extend_from_slice(values);
    Ok(copy)
}

/// Checks that `bytes` could be had now, without keeping them: foreign code is about to ask for them.
pub fn available(bytes: usize, what: &str) -> Result<()> {
    reserved::<u8>(bytes, what).map(drop)
}

pub fn refusal(bytes: usize, what: &str) -> Error {
    Error::new(Kind::Memory, format!("{bytes} bytes for {what} could not be reserved")).value(bytes as f64)
}
