//! What a call reports to the host, and how the host ends it: steps, lines of text, times, cancellation, time limit.

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
