use super::*;

mod by_hand;
mod lies;
mod model;
