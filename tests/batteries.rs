//! Random problems by the hundred, lies about their answers, and large models: what takes longer than a claim. docs/tests.md.

mod battery;
mod coulomb;
mod dealt;
mod friction;
mod liars;
mod scales;
mod soft;

#[allow(dead_code)]
#[path = "reference/case.rs"]
mod reference;

mod support {
    pub mod asked;
    pub mod face;
    pub mod hand_over;
    pub mod linked;
    pub mod rungs;
    pub mod warnings;
}
