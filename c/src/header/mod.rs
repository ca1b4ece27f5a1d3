//! What the header declares besides the functions.

mod certificate;
mod communicator;
mod constants;
mod findings;
mod pairs;
pub mod status;
pub mod types;
