//! The library does no harm to the process of its host (stack), and says what it knows.

#[path = "../support/hand_over.rs"]
mod hand_over;
#[cfg(target_os = "linux")]
mod stack;
mod texts;
