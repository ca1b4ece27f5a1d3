//! The quadratic programs of the dual on small dense matrices, without a body.

mod active_set;
mod certificates;
mod dense;
mod enumeration;
mod preconditioned;
mod program;
mod proximal;
mod scaling;
mod smalbe;
mod traps;
mod watched;
