//! What a user sees and keeps while the library works: a bar on a terminal, the log.

use std::io::{self, IsTerminal, Write};
use std::sync::{Arc, Mutex};
use std::time::{Duration, Instant};

use feti_contact::solver::{LogLevel, Problem, Progress, Reply};

/// Time between two pictures of the bar.
const STEP: Duration = Duration::from_millis(100);
const WIDTH: usize = 30;

/// The lines of the log, with their levels.
pub type Book = Arc<Mutex<Vec<(LogLevel, String)>>>;

/// Keeps the log up to `kept`; up to `told` it goes to standard error, too.
pub fn log(problem: &mut Problem, kept: LogLevel, told: Option<LogLevel>) -> Book {
    let book = Book::default();
    let lines = Arc::clone(&book);
    let tell = move |level: LogLevel, line: &str| {
        if told.is_some_and(|most| level <= most) {
            let _ = writeln!(io::stderr(), "{line}");
        }
        if let (true, Ok(mut lines)) = (level <= kept, lines.lock()) {
            lines.push((level, line.to_owned()));
        }
        0
    };
    problem.on_log(Some((told.map_or(kept, |most| most.max(kept)), Box::new(tell))));
    book
}

/// Warnings and notes of the log.
pub fn notes(book: &Book) -> Vec<String> {
    let is_kept = |line: &String| line.starts_with("warning: ") || line.starts_with("note: ");
    let lines = book.lock().map(|lines| lines.clone()).unwrap_or_default();
    lines.into_iter().map(|(_, line)| line).filter(is_kept).collect()
}

/// A bar on standard error, if that is a terminal.
pub fn bar(problem: &mut Problem) {
    if !io::stderr().is_terminal() {
        return;
    }
    let mut last = Instant::now();
    let draw = move |now: &Progress| {
        if last.elapsed() >= STEP {
            last = Instant::now();
            let _ = write!(io::stderr(), "\r\x1b[K{}", picture(now));
        }
        Reply::Continue
    };
    problem.on_progress(Some(Box::new(draw)));
}

/// Takes the bar off the terminal.
pub fn end_bar() {
    if io::stderr().is_terminal() {
        let _ = write!(io::stderr(), "\r\x1b[K");
    }
}

/// The part of a setup that is complete, or where the steps of the method are.
fn picture(now: &Progress) -> String {
    if now.step.is_some() {
        return format!(
            "step {}: {} closed, residual {:.1e}, {:.0} s",
            now.steps, now.active, now.residual, now.seconds
        );
    }
    let filled = (now.fraction.clamp(0.0, 1.0) * WIDTH as f64) as usize;
    let bar = "#".repeat(filled) + &" ".repeat(WIDTH - filled);
    format!("setup [{bar}] {:3.0} %, {:.0} s", 100.0 * now.fraction, now.seconds)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_bar_grows_with_the_setup_and_never_leaves_its_width() {
        let half = Progress { step: None, fraction: 0.5, ..never() };
        assert!(picture(&half).starts_with(&format!("setup [{}{}]  50 %", "#".repeat(15), " ".repeat(15))));
        assert!(picture(&Progress { fraction: f64::NAN, ..half }).contains(&" ".repeat(WIDTH)));
        assert!(picture(&Progress { fraction: 2.0, ..half }).contains(&format!("[{}]", "#".repeat(WIDTH))));
    }

    fn never() -> Progress {
        let nan = f64::NAN;
        Progress {
            step: None,
            fraction: 0.0,
            steps: 0,
            products: 0,
            active: 0,
            residual: nan,
            free: nan,
            chopped: nan,
            theta: nan,
            seconds: 0.0,
        }
    }
}
