//! The library does no harm to the process of its host: memory for files, stack.

mod counted;
mod files;
#[cfg(target_os = "linux")]
#[path = "../support/hand_over.rs"]
mod hand_over;
#[cfg(target_os = "linux")]
mod stack;
