//! Friction from loads to answers, through the whole library.

mod battery;
mod by_hand;
mod drawn;
mod enumeration;
#[path = "../support/hand_over.rs"]
mod hand_over;
mod invariance;
mod judge;
mod slides;
mod space;
mod tresca;
