//! The figures with their goals.

use crate::runs::{Program, Runs};

/// A figure is good enough below its goal, or above.
#[derive(Clone, Copy)]
pub enum Goal {
    Most(f64),
    Least(f64),
    /// For information.
    None,
}

pub struct Figure {
    pub deck: &'static str,
    pub name: &'static str,
    pub value: f64,
    pub goal: Goal,
}

impl Figure {
    pub fn is_short(&self) -> bool {
        match self.goal {
            Goal::Most(most) => self.value.is_nan() || self.value > most,
            Goal::Least(least) => self.value.is_nan() || self.value < least,
            Goal::None => false,
        }
    }

    /// `bench <deck> <figure> <value> goal <g> ok|short`
    pub fn line(&self) -> String {
        let word = if self.is_short() { "short" } else { "ok" };
        let head = format!("bench {} {} {:.3}", self.deck, self.name, self.value);
        match self.goal {
            Goal::Most(goal) | Goal::Least(goal) => format!("{head} goal {goal:.2} {word}"),
            Goal::None => format!("{head} goal - {word}"),
        }
    }
}

const ONE: Program = Program::Ours(1);
const TWO: Program = Program::Ours(2);

/// Figures of one deck, as far as its runs give them.
pub fn of(deck: &'static str, runs: &Runs) -> Vec<Figure> {
    use Goal::{Least, Most, None};
    let cholmod = (Program::Cholmod(1), "cpu");
    let by = |four: f64, thirteen: f64, forty: f64, large: f64| match deck {
        "4k" => Most(four),
        "13k" => Most(thirteen),
        "40k" => Most(forty),
        "144k" => Most(large),
        _ => None,
    };
    let of_large = |goal: Goal| if deck == "144k" { goal } else { None };
    let of_both = |forty: f64, large: f64| match deck {
        "40k" => Most(forty),
        "144k" => Most(large),
        _ => None,
    };
    let threads = if deck == "one_body" { Most(0.65) } else { of_large(Most(0.60)) };
    let ratio = |name, over, under, goal| {
        runs.ratio(deck, over, under).map(|value| Figure { deck, name, value, goal })
    };
    let figures = [
        ratio("solve/CHOLMOD,1_thread_cpu", (ONE, "first_cpu"), cholmod, by(1.2, 1.0, 0.8, 0.9)),
        ratio(
            "solve/CHOLMOD,2_threads_wall",
            (TWO, "first_wall"),
            (Program::Cholmod(2), "wall"),
            of_large(Most(0.9)),
        ),
        ratio("2_threads/1_thread,wall", (TWO, "first_wall"), (ONE, "first_wall"), threads),
        ratio(
            "F/factorisation",
            (Program::Parts, "dual_operator_cpu"),
            (Program::Parts, "factorisation_cpu"),
            of_both(0.15, 0.18),
        ),
        ratio("second_step/first,cpu", (ONE, "second_cpu"), (ONE, "first_cpu"), of_both(0.08, 0.08)),
        ratio(
            "peak_memory/CHOLMOD",
            (ONE, "peak"),
            (Program::Cholmod(1), "peak"),
            if cfg!(target_os = "linux") && by(0.0, 0.0, 0.0, 0.0).is_some() { Most(1.1) } else { None },
        ),
        ratio("Clarabel/solve,cpu", (Program::Clarabel, "cpu"), (ONE, "first_cpu"), Least(15.0)),
        ratio("OSQP/solve,cpu", (Program::Osqp, "cpu"), (ONE, "first_cpu"), Least(25.0)),
        ratio("F_product/triad", (Program::Bandwidth, "product"), (Program::Bandwidth, "triad"), Least(0.7)),
    ];
    figures.into_iter().flatten().collect()
}

impl Goal {
    fn is_some(self) -> bool {
        !matches!(self, Goal::None)
    }
}

/// Figures of two decks.
pub fn between(runs: &Runs) -> Vec<Figure> {
    let over = |deck| runs.ratio(deck, (ONE, "first_cpu"), (Program::Cholmod(1), "cpu"));
    let per_dof = |deck| Some(runs.median(deck, ONE, "first_cpu")? / runs.median(deck, ONE, "dofs")?);
    let growth = over("144k").zip(over("40k"));
    let bodies = per_dof("64_bodies").zip(per_dof("144k"));
    let figure = |deck, name, pair: (f64, f64), goal| Figure { deck, name, value: pair.0 / pair.1, goal };
    [
        growth.map(|pair| figure("144k/40k", "growth/CHOLMOD's,cpu", pair, Goal::Most(1.25))),
        bodies.map(|pair| figure("64_bodies/144k", "solve_per_dof,cpu", pair, Goal::Most(1.0))),
    ]
    .into_iter()
    .flatten()
    .collect()
}
