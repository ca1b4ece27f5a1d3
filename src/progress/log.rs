//! Lines of text for the host: phases, steps, and lines of other modules.

use std::fs::{File, OpenOptions};
use std::io::Write;
use std::path::Path;
use std::sync::atomic::{AtomicUsize, Ordering};
use std::sync::{Arc, Mutex, PoisonError};

use crate::error::{Error, Kind, Result};
use crate::platform::files::{failed, regular};
use crate::platform::interrupt;
use crate::progress::listener::Progress;
use crate::progress::phases::PhaseReport;
use crate::qp::StepKind;

/// Amount of output; each level includes the previous ones.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub enum LogLevel {
    /// One line per solve, and warnings.
    Result = 1,
    /// What is solved and how, and one line per phase.
    Phase = 2,
    /// One line per step.
    Step = 3,
}

/// Receives the level and the text of a line, without line end; a result other than 0 ends the call.
pub type LogListener = Box<dyn FnMut(LogLevel, &str) -> i32 + Send + Sync>;

/// The host's log function and its log file; clones share them.
#[derive(Clone, Default)]
pub struct Log {
    host: Arc<Mutex<Option<(LogLevel, LogListener)>>>,
    file: Option<(LogLevel, Arc<File>)>,
    /// Number of phases already reported.
    told: Arc<AtomicUsize>,
}

impl Log {
    /// The function that receives the lines from now on.
    pub fn tell_host(&mut self, host: Option<(LogLevel, LogListener)>) {
        self.host = Arc::new(Mutex::new(host));
    }

    /// The file to the end of which the lines go from now on; without a path none.
    pub fn tell_file(&mut self, path: &str, most: LogLevel) -> Result<()> {
        let open = |path: &Path| {
            regular(path)?;
            let file = OpenOptions::new().append(true).create(true).open(path);
            Ok((most, Arc::new(file.map_err(|e| failed(path, "open", &e))?)))
        };
        self.file = (!path.is_empty()).then(|| open(Path::new(path))).transpose()?;
        Ok(())
    }

    /// Begins a call: no phase has been reported.
    pub fn begin(&self) {
        self.told.store(0, Ordering::Relaxed);
    }

    fn file(&self, level: LogLevel) -> Option<&File> {
        self.file.as_ref().filter(|(most, _)| level <= *most).map(|(_, file)| &**file)
    }

    /// Whether the host wants lines of this level.
    pub fn is_heard(&self, level: LogLevel) -> bool {
        self.file(level).is_some()
            || self.host.lock().is_ok_and(|host| host.as_ref().is_some_and(|(most, _)| level <= *most))
    }

    pub fn say(&self, level: LogLevel, text: impl FnOnce() -> String) -> Result<()> {
        let mut host = self.host.lock().unwrap_or_else(PoisonError::into_inner);
        let listener = host.as_mut().filter(|(most, _)| level <= *most);
        let file = self.file(level);
        if file.is_none() && listener.is_none() {
            return Ok(());
        }
        let text = text();
        if let Some(mut file) = file {
            // one write for a line: it is with the system at once, and no line of another problem comes between; a full disk ends no solve
            let _ = file.write_all(format!("{text}\n").as_bytes());
        }
        let Some((_, listener)) = listener else { return Ok(()) };
        match interrupt::never(|| listener(level, &text)) {
            0 => Ok(()),
            number => {
                let what = format!("the log function of the host returned {number}");
                Err(Error::new(Kind::Callback, what).value(f64::from(number)))
            }
        }
    }

    /// Reports the first `until` phases, each once, without phases that had no work.
    pub fn phases(&self, phases: &[PhaseReport], until: usize) -> Result<()> {
        let until = until.min(phases.len());
        for phase in &phases[self.told.fetch_max(until, Ordering::Relaxed).min(until)..until] {
            if phase.seconds == 0.0 {
                continue;
            }
            self.say(LogLevel::Phase, || {
                let bytes = if phase.bytes > 0 { format!(", {} bytes", phase.bytes) } else { String::new() };
                format!("{}: {:.6} seconds{bytes}", phase.name.to_string_lossy(), phase.seconds)
            })?;
        }
        Ok(())
    }

    pub fn step(&self, now: &Progress) -> Result<()> {
        let Some(kind) = now.step else { return Ok(()) };
        let kind = match kind {
            StepKind::ConjugateGradient => "conjugate gradients",
            StepKind::Expansion => "expansion",
            StepKind::Proportioning => "release",
            StepKind::Newton => "newton",
        };
        self.say(LogLevel::Step, || {
            format!(
                "step {}: {kind}, residual {:.3e} (free {:.3e}, chopped {:.3e}), {} active, {} products, theta {:.9e}",
                now.steps, now.residual, now.free, now.chopped, now.active, now.products, now.theta
            )
        })
    }

    /// One line about a call that gave no answer. The result of the host's function is ignored.
    pub fn failure(&self, call: &str, error: &Error, base: i64) {
        if error.kind != Kind::Callback {
            let error = error.clone().counted_from(base);
            let _ = self.say(LogLevel::Result, || format!("{call} failed: {error}"));
        }
    }
}
