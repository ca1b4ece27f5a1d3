use super::*;

mod by_hand;
mod friction;
mod friction_lies;
mod lies;
mod model;
mod nodes;
