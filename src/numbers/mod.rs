//! Every threshold of the library that is not a small multiple of eps, with its meaning, to what it is relative, and its reason.
//! None has a unit. `tests/documents` refuses any other and writes docs/numbers.md from here.

pub mod body;
pub mod certificate;
pub mod cut;
pub mod data;
pub mod dual;
pub mod friction;
pub mod linalg;
pub mod qp;
pub mod rounding;
pub mod rows;
pub mod setup;
pub mod solve;
pub mod surface;
