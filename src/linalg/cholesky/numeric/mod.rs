//! The numeric factorisation.

pub mod front;
pub mod multifrontal;
pub mod updates;
