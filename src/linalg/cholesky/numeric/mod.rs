//! The numeric factorisation.

mod front;
pub mod multifrontal;
pub mod updates;
