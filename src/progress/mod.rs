//! Progress of a call: steps, lines of text and times for the host, cancelling, time limit.

mod listener;
mod log;
mod phases;
mod steps;
mod stops;
mod watch;

pub use listener::{Listener, Progress, Reply};
pub use log::{Log, LogLevel, LogListener};
pub use phases::{Phase, PhaseReport, Phases};
pub use steps::{Steps, Told, Voice};
pub use stops::Stops;
pub use watch::{Host, SetupPart, Watch};
