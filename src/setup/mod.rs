//! Data computed once from a model, for any load and gap: null spaces, factors, scaled rows, dual operators.

mod analysed;
mod analyses;
mod build;
mod execute;
mod factors;
mod given;
mod headroom;
mod host;
mod islands;
mod join;
mod lending;
mod lengths;
mod locals;
mod memory_limit;
mod operators;
mod plans;
mod preconditioner;
mod prepared;
mod ready;
mod rounding;
mod rounds;
mod rows;
mod scaling;
mod separate;
mod whole;

pub use islands::{Island, Members};
pub use prepared::{Duals, Inverse, Prepared, Work};
pub use ready::Ready;
pub use whole::Whole;
