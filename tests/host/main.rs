//! The library does no harm to the process of its host (memory for files and for many parts, stack), and says what it knows.

mod counted;
mod files;
#[path = "../support/hand_over.rs"]
mod hand_over;
mod parts;
#[cfg(target_os = "linux")]
mod stack;
mod texts;
