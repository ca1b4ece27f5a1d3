//! From a model that is set up to its answer: presolve, the methods on the dual, recovery of displacements, diagnosis.

mod answer;
mod case;
mod certifier;
mod contradiction;
mod diagnosis;
mod driven;
mod every_island;
mod fallback;
mod feedback;
mod finish;
mod friction;
mod gaps;
mod held;
mod interruptible;
mod island;
mod near;
mod paper;
mod presolve;
mod recovery;
mod report;
mod response;
mod rest;
mod rigid;
mod scaled;
mod sliding;
mod start;
mod travel;

pub use answer::{named, Answer};
pub use case::Case;
pub use every_island::solve_islands;
pub use held::without_force;
pub use island::Solved;
pub use report::{Outcome, Report, RowState};
pub use response::ByInverse;
pub use start::Start;
