//! What the host hears of a call, and how it ends one: steps, lines of text, times, its wish to cancel, its time limit.

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
