//! Every island is solved by itself, several at a time where there are threads.

use std::cmp::Reverse;

use crate::error::{Error, Kind, Result};
use crate::model::Model;
use crate::platform::threads::{self, TaskEvent, Tasks};
use crate::progress::{Told, Voice, Watch};
use crate::setup::Prepared;
use crate::solve::case::Case;
use crate::solve::island::{solve_island, Ends, Solved};
use crate::solve::start::Start;

/// Every island by itself: several at a time where there are threads, each with the bits it has alone.
pub fn solve_islands(model: &Model, prepared: &Prepared, start: &Start, watch: &mut Watch) -> Result<Ends> {
    let islands = &prepared.done(model)?.islands;
    let (stops, threads) = (watch.stops.clone(), model.threads());
    let solve = |k: usize, voice: &mut dyn Voice| {
        let case = Case { model, prepared, ready: &islands[k] };
        stops.interrupt.during(|| solve_island(case, k, start.scaled(case.ready)?, &stops, voice))
    };
    if islands.len() == 1 || threads == 1 {
        return (0..islands.len()).map(|k| of_itself(solve(k, watch))).collect();
    }
    let bodies = |k: usize| islands[k].island.bodies.iter().map(|&p| &model.bodies[p].body);
    let on_caller = |k: usize| bodies(k).any(|body| body.k().is_some_and(|k| k.on_caller()));
    let mut order: Vec<usize> = (0..islands.len()).collect();
    order.sort_by_key(|&k| Reverse(islands[k].dual.product_work()));
    let mut ends: Vec<Option<_>> = islands.iter().map(|_| None).collect();
    let mut told = Ok(());
    let solve = |k: usize, say: &dyn Fn(Message)| Ok(solve(k, &mut Apart { say }));
    let tasks = Tasks { threads, order: &order, on_caller: &on_caller };
    threads::run_telling(tasks, solve, &mut |heard| match heard {
        TaskEvent::Done(k, end) => ends[k] = Some(end),
        TaskEvent::Said(message) if told.is_ok() => {
            told = message.pass_on(watch);
            if told.is_err() {
                stops.cancel();
            }
        }
        _ => {}
    })?;
    if let Err(error) = told {
        if error.kind != Kind::Cancelled {
            return Err(error);
        }
    }
    ends.into_iter().flatten().map(of_itself).collect()
}

/// A reason why one island has no answer leaves the others theirs; any other failure is one of the whole call.
fn of_itself(end: Result<Solved>) -> Result<std::result::Result<Solved, Error>> {
    match end {
        Err(error) if !is_of_itself(&error) => Err(error),
        end => Ok(end),
    }
}

fn is_of_itself(error: &Error) -> bool {
    use Kind::{Cancelled, GapsContradict, Indefinite, LoadNotHeld, TimeOver};
    matches!(error.kind, LoadNotHeld | GapsContradict | Indefinite | Cancelled | TimeOver)
}

/// What an island says to the thread that listens to all.
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

/// The voice of an island on a thread of its own: the host's answer comes by way of `Stops`.
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
