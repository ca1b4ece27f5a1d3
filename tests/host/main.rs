//! The library does no harm to the process of its host: memory, stack.

mod counted;
mod files;
