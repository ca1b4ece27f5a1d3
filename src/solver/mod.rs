//! From what the host registers to the answer it gets: register, set up, solve, certify, report.

mod body_facts;
mod certificate;
mod diagnosis;
mod factors;
mod fallback;
mod file;
mod findings;
mod finish;
mod log;
mod numbering;
mod operators;
mod paper;
mod phases;
mod presolve;
mod problem;
mod report;
mod results;
mod room;
mod rounding;
mod rows;
mod settings;
mod settings_text;
mod setup;
mod solve;
mod state;
mod stiffness;
mod threads;
mod undetermined;
mod watch;

pub use crate::body::{Columns, Modes, SparseInput, Storage};
pub use crate::constraints::{RowKind, RowsInput};
pub use crate::error::Proof;
pub use crate::linalg::Borrowed;
pub use crate::qp::StepKind;
pub use body_facts::{BodyFacts, Factors, Origin};
pub use certificate::{Certificate, Entry};
pub use findings::Findings;
pub use log::{LogLevel, LogListener};
pub use phases::PhaseReport;
pub use problem::Problem;
pub use report::{Counts, Outcome, Report, RowState};
pub use settings::{options, OptionInfo, OptionValue, Settings};
pub use threads::THREAD_NAME;
#[cfg(test)]
pub(crate) use threads::{run as run_on_pool, run_heard};
pub use watch::{Listener, Progress, Reply};
