//! Solves every island separately, and in parallel if there are threads.

use std::cmp::Reverse;
use std::collections::BTreeMap;
use std::sync::mpsc::channel;
use std::sync::Arc;

use crate::error::{Error, Kind, Result};
use crate::model::SolvedModel;
use crate::platform::threads::{self, TaskEvent, Tasks};
use crate::progress::{LogLevel, Told, Voice, Watch};
use crate::setup::Prepared;
use crate::solve::answer::Ends;
use crate::solve::case::Case;
use crate::solve::island::{solve_island, Solved};
use crate::solve::method::DualMethod;
use crate::solve::start::Start;

/// Solves every island, in parallel if there are threads; the number of threads does not change any bit of the answers.
pub fn solve_islands<'a>(
    model: &'a SolvedModel,
    prepared: &'a Prepared,
    method: Option<&dyn DualMethod>,
    start: &Start,
    watch: &mut Watch,
) -> Result<Ends<'a>> {
    let mut ends = Ends::new(model, prepared)?;
    let islands = &prepared.done(model)?.islands;
    islands.iter().for_each(|ready| ready.dual.begin());
    let (stops, threads) = (watch.stops.clone(), model.threads());
    let (is_heard, count) = (watch.log.is_heard(LogLevel::Phase), islands.len());
    let solve = |k: usize, say: &Say, voice: &mut dyn Voice| {
        let case = Case { model, prepared, ready: &islands[k], method };
        let (say, of) = (
            Arc::clone(say),
            if count == 1 { String::new() } else { format!("group {} of {count}, ", k + 1) },
        );
        let interrupt = match is_heard {
            true => stops.heard(move |line| say(format!("{of}{line}"))),
            false => stops.interrupt.clone(),
        };
        interrupt.during(|| solve_island(case, k, start.scaled(case.ready)?, &stops, voice))
    };
    if count == 1 || threads == 1 {
        let log = watch.log.clone();
        let say: Say = Arc::new(move |line| log.say(LogLevel::Phase, || line));
        for k in 0..count {
            ends.take_in(of_itself(solve(k, &say, watch))?);
        }
        return Ok(ends);
    }
    let is_on_caller = |p: &usize| prepared.inverse(model, *p).is_some_and(|of| of.kplus.on_caller());
    let on_caller = |k: usize| islands[k].island.bodies.iter().any(is_on_caller);
    let mut order: Vec<usize> = (0..islands.len()).collect();
    order.sort_by_key(|&k| Reverse(islands[k].dual.product_work()));
    // answers are combined in the order of the islands
    let (mut waiting, mut next) = (BTreeMap::new(), 0);
    let (mut told, mut taken) = (Ok(()), Ok(()));
    let (sender, lines) = channel();
    let line: Say = Arc::new(move |line| {
        drop(sender.send(line));
        Ok(())
    });
    let solve = |k: usize, say: &dyn Fn(Message)| Ok(solve(k, &line, &mut Apart { say }));
    let tasks = Tasks { threads, order: &order, on_caller: &on_caller };
    threads::run_telling(tasks, solve, &mut |heard| {
        let mut heard_of = lines.try_iter().map(Message::Line).collect::<Vec<_>>();
        match heard {
            TaskEvent::Done(k, end) => {
                waiting.insert(k, end);
                while let Some(end) = waiting.remove(&next).filter(|_| taken.is_ok()) {
                    taken = of_itself(end).map(|end| ends.take_in(end));
                    next += 1;
                }
            }
            TaskEvent::Said(message) => heard_of.push(message),
            TaskEvent::Nothing => {}
        }
        for message in heard_of {
            if told.is_ok() {
                told = message.pass_on(watch);
                if told.is_err() {
                    stops.cancel();
                }
            }
        }
    })?;
    if let Err(error) = told {
        if error.kind != Kind::Cancelled {
            return Err(error);
        }
    }
    taken.map(|()| ends)
}

/// Receives lines on the progress of the loops of an island.
type Say = Arc<dyn Fn(String) -> Result<()> + Send + Sync>;

/// Errors that concern one island leave the answers of the others; any other error is an error of the call.
fn of_itself(end: Result<Solved>) -> Result<std::result::Result<Solved, Error>> {
    match end {
        Err(error) if !is_of_itself(&error) => Err(error),
        end => Ok(end),
    }
}

fn is_of_itself(error: &Error) -> bool {
    use Kind::{Cancelled, GapsContradict, Indefinite, LoadNotHeld, Slides, TimeOver};
    matches!(error.kind, LoadNotHeld | Slides | GapsContradict | Indefinite | Cancelled | TimeOver)
}

/// A message of an island to the thread that reports to the host.
enum Message {
    Step(Told),
    Line(String),
}

impl Message {
    fn pass_on(self, voice: &mut dyn Voice) -> Result<()> {
        match self {
            Self::Step(told) => voice.step(told),
            Self::Line(text) => voice.line(text),
        }
    }
}

/// The progress messages of an island on its own thread; the answer of the host arrives through `Stops`.
struct Apart<'a> {
    say: &'a dyn Fn(Message),
}

impl Voice for Apart<'_> {
    fn step(&mut self, told: Told) -> Result<()> {
        (self.say)(Message::Step(told));
        Ok(())
    }

    fn line(&mut self, text: String) -> Result<()> {
        (self.say)(Message::Line(text));
        Ok(())
    }
}
