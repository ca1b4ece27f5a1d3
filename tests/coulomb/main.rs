//! Friction from loads to answers, through the whole library.

mod by_hand;
#[path = "../support/hand_over.rs"]
mod hand_over;
