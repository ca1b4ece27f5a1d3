//! From a prepared model to its answer: presolve, the methods on the dual problem, recovery of displacements, diagnosis.

mod answer;
mod case;
mod certifier;
mod contradiction;
mod diagnosis;
mod every_island;
mod fallback;
mod feedback;
mod finish;
mod friction;
mod gaps;
mod held;
mod host_form;
mod interruptible;
mod island;
mod known;
pub mod local;
mod method;
mod near;
mod negative;
mod outcome;
mod pivots;
mod presolve;
mod recovery;
mod report;
mod rest;
mod rounds;
mod scaled;
mod slides;
mod sliding;
mod sparse_face;
mod split_point;
mod start;
mod travel;
mod work;

pub use answer::{named, Answer, OfOthers, Shown, Stays};
pub use case::Case;
pub use every_island::solve_islands;
pub use held::without_force;
pub use known::products_of_known_states;

pub use method::{DualMethod, HostForm};
pub use report::{Outcome, Report, RowState};
pub use slides::Slide;
pub use start::Start;
