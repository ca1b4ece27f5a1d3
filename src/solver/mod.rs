//! From what the host registers to the answer it gets: register, set up, solve, certify, report.

mod certificate;
mod diagnosis;
mod factors;
mod fallback;
mod findings;
mod finish;
mod operators;
mod paper;
mod phases;
mod pools;
mod presolve;
mod problem;
mod report;
mod results;
mod room;
mod rows;
mod settings;
mod setup;
mod solve;
mod state;
mod sync;
mod threads;
mod undetermined;
mod watch;

pub use crate::body::{Modes, SparseInput, Storage};
pub use crate::constraints::{RowKind, RowsInput};
pub use crate::error::Proof;
pub use crate::qp::StepKind;
pub use certificate::{Certificate, Entry};
pub use findings::Findings;
pub use phases::PhaseReport;
pub use problem::Problem;
pub use report::{Counts, Outcome, Report, RowState};
pub use settings::{options, OptionInfo, OptionValue, Settings};
pub use threads::THREAD_NAME;
pub use watch::{Listener, Progress, Reply};
