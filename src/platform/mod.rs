//! Services of the machine: memory, threads, locks, interruption.

pub mod files;
mod fork;
pub mod interrupt;
mod mapping;
pub mod memory;
pub mod pages;
mod pools;
pub mod shortage;
pub mod slabs;
pub mod stopwatch;
mod sync;
pub mod tally;
pub mod threads;

pub use fork::instant;
pub use interrupt::Interrupt;
