//! Exported functions of bodies.

mod body;
mod body_info;
mod elements;
mod forms;
mod null_space;
mod numbering;
mod operator;
mod stiffness;
mod values;

pub use body::*;
pub use body_info::*;
pub use elements::*;
pub use forms::*;
pub use null_space::*;
pub use numbering::*;
pub use operator::*;
pub use stiffness::*;
pub use values::*;
