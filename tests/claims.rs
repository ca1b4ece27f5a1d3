//! Claims about answers, subject by subject, each proved within seconds: `make quick` runs nearly all. docs/tests.md.

mod compliance;
mod decoupling;
mod invariance;
mod mesh;
mod null_space;
mod operator;
mod paper;
mod parts;
mod pilots;
mod proofs;
mod qp;
mod reference;
mod reuse;
mod single;
mod tables;
mod texts;

mod support {
    pub mod hand_over;
    pub mod warnings;
}
