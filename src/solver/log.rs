//! What a call tells in words: its result, its phases, its steps.

use std::fmt::Write;

use crate::error::{Error, Kind, Result};
use crate::solver::phases::PhaseReport;
use crate::solver::problem::Problem;
use crate::solver::report::{Outcome, Report};
use crate::solver::setup::{Ready, Setup};
use crate::solver::watch::{Progress, Watch};
use crate::solver::words::Word;
use crate::solver::StepKind;

/// How much is told; each level tells what those before it tell.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub enum LogLevel {
    /// One line for each solve, and warnings.
    Result = 1,
    /// What is solved and how, and a line for each phase.
    Phase = 2,
    /// A line for each step.
    Step = 3,
}

/// Gets the level and the text of a line, without its end; 0 goes on, any other number ends the call.
pub type LogListener = Box<dyn FnMut(LogLevel, &str) -> i32 + Send + Sync>;

/// The host's function during a call.
#[derive(Default)]
pub(super) struct Log {
    pub host: Option<(LogLevel, LogListener)>,
    /// Phases that have been told.
    pub told: usize,
}

impl Log {
    pub fn say(&mut self, level: LogLevel, text: impl FnOnce() -> String) -> Result<()> {
        let Some((_, listener)) = self.host.as_mut().filter(|(most, _)| level <= *most) else {
            return Ok(());
        };
        match listener(level, &text()) {
            0 => Ok(()),
            number => {
                let what = format!("the log function of the host returned {number}");
                Err(Error::new(Kind::Callback, what).value(f64::from(number)))
            }
        }
    }

    /// Sizes and options, before anything is done.
    pub fn begin(&mut self, problem: &Problem, call: &str) -> Result<()> {
        self.told = 0;
        let counts = problem.counts();
        self.say(LogLevel::Phase, || {
            format!(
                "feti-contact {}: {call}: {} bodies, {} unknowns, {} contact rows, {} equality rows",
                env!("CARGO_PKG_VERSION"),
                counts.bodies,
                counts.dofs,
                counts.rows,
                counts.equalities
            )
        })?;
        self.say(LogLevel::Phase, || match problem.settings.changes() {
            changes if changes.is_empty() => "options: defaults".to_owned(),
            changes => format!("options: {changes}"),
        })
    }

    /// The first `until` phases, each once; those that had nothing to do are left out.
    pub fn phases(&mut self, phases: &[PhaseReport], until: usize) -> Result<()> {
        let until = until.min(phases.len());
        while self.told < until {
            let phase = phases[self.told];
            self.told += 1;
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

    pub fn step(&mut self, now: &Progress) -> Result<()> {
        let Some(kind) = now.step else { return Ok(()) };
        let kind = match kind {
            StepKind::ConjugateGradient => "conjugate gradients",
            StepKind::Expansion => "expansion",
            StepKind::Release => "release",
        };
        self.say(LogLevel::Step, || {
            format!(
                "step {}: {kind}, residual {:.3e} (free {:.3e}, chopped {:.3e}), {} active, {} products, theta {:.9e}",
                now.steps, now.residual, now.free, now.chopped, now.active, now.products, now.theta
            )
        })
    }

    /// One line on an answer, and warnings.
    pub fn result(&mut self, report: &Report) -> Result<()> {
        self.say(LogLevel::Result, || result_line(report))?;
        if report.outcome == Outcome::Marginal {
            let what = "warning: a small part of the load, below 1e-7 of it, is held by no row";
            self.say(LogLevel::Result, || what.to_owned())?;
        }
        if report.undetermined > 0 {
            self.say(LogLevel::Result, || {
                format!(
                    "warning: {} motions are left open: neither rows nor loads determine them",
                    report.undetermined
                )
            })?;
        }
        Ok(())
    }

    /// One line on a call that gave no answer. What the function says to this changes nothing.
    pub fn failure(&mut self, call: &str, error: &Error, base: i64) {
        if error.kind != Kind::Callback {
            let error = error.clone().counted_from(base);
            let _ = self.say(LogLevel::Result, || format!("{call} failed: {error}"));
        }
    }
}

fn result_line(report: &Report) -> String {
    let ended = match report.outcome {
        Outcome::Solved => "solved",
        Outcome::Iterations => "ended at the limit of steps",
        Outcome::Time => "ended at the limit of time",
        Outcome::Cancelled => "cancelled by the host",
        Outcome::Stalled => "stalled",
        Outcome::Inaccurate => "inaccurate",
        Outcome::Marginal => "marginal",
    };
    let certificate = &report.certificate;
    let figures = [
        ("equilibrium", &certificate.equilibrium),
        ("balance", &certificate.balance),
        ("penetration", &certificate.penetration),
        ("equality", &certificate.equality),
        ("negative force", &certificate.negative_force),
        ("complementarity", &certificate.complementarity),
        ("duality gap", &certificate.duality_gap),
    ];
    let mut line = format!(
        "{ended}: {} steps, {} products, {} of {} contact rows closed; certificate",
        report.steps, report.dual_applications, report.active, report.counts.rows
    );
    for (name, entry) in figures {
        let _ = write!(line, " {name} {:.1e},", entry.figure);
    }
    let _ = write!(
        line,
        " limit {:.1e}; setup {:.6} seconds, solve {:.6} seconds",
        certificate.limit, report.seconds_setup, report.seconds_solve
    );
    line
}

impl Problem {
    /// The function that gets lines of text up to a level from now on.
    pub fn on_log(&mut self, listener: Option<(LogLevel, LogListener)>) {
        self.host.log = Log { host: listener, told: 0 };
    }

    /// The outcome of a call, told: the phases that are left, or the failure.
    pub(super) fn logged<T>(&self, call: &str, done: Result<T>, watch: &mut Watch) -> Result<T> {
        match &done {
            Ok(_) => watch.log.phases(&self.phases(), usize::MAX)?,
            Err(error) => watch.log.failure(call, error, self.settings.index_base),
        }
        done
    }

    /// What rounding of the entries leaves open about the null spaces of these bodies.
    pub(super) fn tell_doubts(&self, bodies: &[usize], log: &mut Log) -> Result<()> {
        for &p in bodies {
            let number = p as i64 + self.settings.index_base;
            let misfit = self.bodies[p].inverse.as_ref().and_then(|of| of.kplus.misfit);
            if let Some(misfit) = misfit {
                let text = || format!("warning: body {number}: {misfit}; its null space was sought in K");
                log.say(LogLevel::Result, text)?;
            }
            for doubt in self.bodies[p].inverse.iter().flat_map(|of| &of.kplus.doubts) {
                log.say(LogLevel::Result, || format!("warning: body {number}: {doubt}"))?;
            }
        }
        Ok(())
    }

    /// How the dual is going to be solved.
    pub(super) fn log_method(&self, log: &mut Log, started: &str) -> Result<()> {
        let Setup { islands, operators, .. } = self.ready()?;
        let of_island = |ready: &Ready| ready.preconditioning().word().to_string_lossy();
        let mut preconditioners: Vec<_> = islands.iter().map(of_island).collect();
        preconditioners.sort_unstable();
        preconditioners.dedup();
        log.say(LogLevel::Phase, || {
            let implicit = operators.implicit.iter().filter(|implicit| **implicit).count();
            let groups = match islands.len() {
                1 => String::new(),
                count => format!("{count} groups of bodies apart from each other, "),
            };
            format!(
                "method: {}, preconditioner {}, start {started}; {groups}{} multipliers, {} floating modes, \
                 {} explicit and {implicit} implicit dual operators",
                self.settings.method.word().to_string_lossy(),
                preconditioners.join(" and "),
                islands.iter().map(|ready| ready.rows.groups()).sum::<usize>(),
                islands.iter().map(|ready| ready.dual.modes()).sum::<usize>(),
                operators.implicit.len() - implicit
            )
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::solver::{Modes, RowKind, RowsInput, SparseInput, Storage};
    use std::sync::{Arc, Mutex};

    /// A spring 2 pushed by 6 against a wall at 1, and a mass that nothing holds or pushes where `floats`.
    fn spring(floats: bool) -> Problem {
        let mut problem = Problem::new();
        let body = problem.add_body(1).unwrap();
        let k = SparseInput { ptr: &[0, 1], col: &[0], val: &[2.0], storage: Storage::Lower };
        problem.set_stiffness(body, k).unwrap();
        problem.set_null_space(body, 1, 0, &[], 1, Modes::Exact).unwrap();
        problem.set_load(body, &[6.0]).unwrap();
        if floats {
            let body = problem.add_body(1).unwrap();
            let k = SparseInput { ptr: &[0, 0], col: &[], val: &[], storage: Storage::Lower };
            problem.set_stiffness(body, k).unwrap();
        }
        let rows = RowsInput { ptr: &[0, 1], body: None, dof: &[0], val: &[1.0], rhs: Some(&[1.0]) };
        problem.add_rows(RowKind::Inequality, rows).unwrap();
        problem
    }

    type Lines = Arc<Mutex<Vec<(LogLevel, String)>>>;

    /// Keeps the lines, and answers `reply` to line `when`.
    fn listen(problem: &mut Problem, most: LogLevel, when: usize, reply: i32) -> Lines {
        let lines = Lines::default();
        let book = Arc::clone(&lines);
        let tell = move |level: LogLevel, text: &str| {
            let mut book = book.lock().unwrap();
            book.push((level, text.to_owned()));
            if book.len() == when + 1 {
                reply
            } else {
                0
            }
        };
        problem.on_log(Some((most, Box::new(tell))));
        lines
    }

    fn told(lines: &Lines) -> Vec<(LogLevel, String)> {
        std::mem::take(&mut *lines.lock().unwrap())
    }

    #[test]
    fn a_solve_tells_its_result_in_one_line() {
        let mut problem = spring(false);
        let lines = listen(&mut problem, LogLevel::Result, 0, 0);
        problem.solve().unwrap();
        let told = told(&lines);
        assert_eq!(told.len(), 1, "{told:?}");
        assert!(told[0].1.starts_with("solved: "), "{told:?}");
        for part in ["1 of 1 contact rows closed", "penetration 0.0e0,", "limit 1.0e-8", "seconds"] {
            assert!(told[0].1.contains(part), "{told:?} lacks {part}");
        }
    }

    #[test]
    fn warnings_and_failures_are_results() {
        let mut problem = spring(true);
        let lines = listen(&mut problem, LogLevel::Result, 0, 0);
        assert_eq!(problem.solve().unwrap().undetermined, 1);
        assert!(told(&lines)[1].1.starts_with("warning: 1 motions are left open"));
        problem.set_load(1, &[1.0]).unwrap();
        problem.set_i64("index_base", 1).unwrap();
        let error = problem.solve().unwrap_err().counted_from(1);
        assert_eq!(told(&lines), [(LogLevel::Result, format!("solve failed: {error}"))]);
        assert!(error.to_string().starts_with("body 2"), "{error}");
    }

    #[test]
    fn phases_come_in_their_order_between_what_is_solved_and_the_result() {
        let mut problem = spring(false);
        problem.set_text("tolerance=1e-11 start=previous").unwrap();
        let lines = listen(&mut problem, LogLevel::Phase, 0, 0);
        problem.solve().unwrap();
        let told: Vec<String> = told(&lines).into_iter().map(|line| line.1).collect();
        let version = env!("CARGO_PKG_VERSION");
        let sizes = "solve: 1 bodies, 1 unknowns, 1 contact rows, 0 equality rows";
        assert_eq!(told[0], format!("feti-contact {version}: {sizes}"));
        assert_eq!(told[1], "options: tolerance=1e-11 start=previous");
        let at = |name: &str| told.iter().position(|line| line.starts_with(name)).unwrap_or(usize::MAX);
        let order = [
            "rows: ",
            "factorisation: ",
            "dual operators: ",
            "method: ",
            "dual solve: ",
            "recovery: ",
            "solved: ",
        ];
        assert!(order.windows(2).all(|pair| at(pair[0]) < at(pair[1])), "{told:?}");
        assert!(told[at("factorisation: ")].ends_with(" bytes"), "{told:?}");
        let method =
            "method: proportioning, preconditioner none, start cold; 1 multipliers, 0 floating modes, \
                      1 explicit and 0 implicit dual operators";
        assert_eq!(told[at("method: ")], method);
        problem.solve().unwrap();
        let again: Vec<String> = super::tests::told(&lines).into_iter().map(|line| line.1).collect();
        assert!(!again.iter().any(|line| line.starts_with("factorisation: ")), "{again:?}");
        assert!(again.iter().any(|line| line.contains("start previous")), "{again:?}");
    }

    #[test]
    fn every_step_is_a_line_of_its_own_level() {
        let mut problem = spring(false);
        let lines = listen(&mut problem, LogLevel::Step, 0, 0);
        let report = problem.solve().unwrap();
        let steps: Vec<_> = told(&lines).into_iter().filter(|line| line.0 == LogLevel::Step).collect();
        assert_eq!(steps.len(), report.steps);
        assert!(steps.iter().enumerate().all(|(k, line)| line.1.starts_with(&format!("step {}: ", k + 1))));
    }

    #[test]
    fn a_function_that_fails_ends_the_call_at_any_line_and_the_next_solve_is_as_ever() {
        let mut problem = spring(false);
        let lines = listen(&mut problem, LogLevel::Step, usize::MAX, 0);
        problem.solve().unwrap();
        let all = told(&lines).len();
        for when in 0..all - 3 {
            let mut problem = spring(false);
            let lines = listen(&mut problem, LogLevel::Step, when, -7);
            let error = problem.solve().unwrap_err();
            assert_eq!((error.kind, error.place.value), (Kind::Callback, Some(-7.0)));
            assert_eq!(told(&lines).len(), when + 1);
            assert!(problem.report().is_none());
            problem.on_log(None);
            assert_eq!(problem.solve().unwrap().outcome, Outcome::Solved);
        }
    }
}
