//! What the header declares besides the functions.

mod constants;
mod findings;
pub mod status;
pub mod types;
