//! The quadratic programs of the dual on small dense matrices, without a body.

mod certificates;
pub mod dense;
mod enumeration;
mod preconditioned;
mod program;
mod scaling;
mod traps;
mod watched;
