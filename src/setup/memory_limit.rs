//! Whether factors and dual operators fit into memory.

use crate::error::{Error, Kind, Result};
use crate::model::Settings;
use crate::platform::memory::available;

/// Option memory_limit, bytes.
pub fn memory_limit(settings: &Settings) -> Option<usize> {
    usize::try_from(settings.memory_limit).ok().filter(|limit| *limit > 0)
}

/// Checks existing bytes plus `more` against the limit of the host; against the memory of the system `more` without what is `on_others`,
/// other ranks.
pub fn check_memory(settings: &Settings, kept: usize, more: usize, on_others: usize) -> Result<()> {
    let needed = kept.saturating_add(more);
    if let Some(limit) = memory_limit(settings).filter(|limit| needed > *limit) {
        let what = format!("factors and dual operators take {needed} bytes, but memory_limit is {limit}");
        return Err(Error::new(Kind::Memory, what).value(needed as f64).limit(limit as f64));
    }
    available(more.saturating_sub(on_others), "factors and dual operators")
}
