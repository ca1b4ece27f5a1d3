//! What the header declares besides the functions.

mod constants;
pub mod status;
pub mod types;
