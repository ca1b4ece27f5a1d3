//! Friction from loads to answers, through the whole library.

pub mod battery;
mod by_hand;
mod cut;
pub mod drawn;
mod driven;
mod enumeration;
mod equal_rows;
mod idle;
mod invariance;
mod judge;
mod last_iterations;
mod slides;
mod space;
mod steps;
mod struck_out;
mod tied;
mod tresca;
