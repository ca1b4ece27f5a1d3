//! The figures with their goals.

use crate::programs::Program;
use crate::runs::Runs;

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

    /// `bench <deck> <figure> <value> goal <g> ok|short`; `goal -` alone for information.
    pub fn line(&self) -> String {
        let word = if self.is_short() { "short" } else { "ok" };
        let head = format!("bench {} {} {:.3}", self.deck, self.name, self.value);
        match self.goal {
            Goal::Most(goal) | Goal::Least(goal) => format!("{head} goal {goal:.2} {word}"),
            Goal::None => format!("{head} goal -"),
        }
    }
}

const ONE: Program = Program::Ours(1);
const TWO: Program = Program::Ours(2);

/// A quantity of one program over one of another.
type Ratio = (&'static str, (Program, &'static str), (Program, &'static str));

/// Of bodies that are handed over by their elements.
const OF_CUT: [Ratio; 10] = [
    ("cut/CHOLMOD,1_thread_cpu", (Program::Cut(1), "whole_cpu"), (Program::Cholmod(1), "cpu")),
    ("cut/CHOLMOD,2_threads_wall", (Program::Cut(2), "whole_wall"), (Program::Cholmod(2), "wall")),
    ("cut/uncut,1_thread_cpu", (Program::Cut(1), "whole_cpu"), (ONE, "first_cpu")),
    ("cut,2_threads/1_thread,wall", (Program::Cut(2), "whole_wall"), (Program::Cut(1), "whole_wall")),
    ("cut,peak_memory/CHOLMOD", (Program::Cut(1), "peak"), (Program::Cholmod(1), "peak")),
    ("cut,peak_memory/CHOLMOD", (Program::Cut(2), "peak"), (Program::Cholmod(2), "peak")),
    ("cut,second_step/first,cpu", (Program::Later, "second_cpu"), (Program::Later, "first_cpu")),
    ("cut,cold_step/first,cpu", (Program::Later, "third_cpu"), (Program::Later, "first_cpu")),
    ("cut,contact/linear,products", (Program::Later, "products"), (Program::Later, "linear_products")),
    (
        "cut,dual_solve,1458_pieces/432,wall",
        (Program::Pieces(729), "first_dual_solve_wall"),
        (Program::Pieces(216), "first_dual_solve_wall"),
    ),
];

/// Figures of one deck, as far as its runs give them.
pub fn of(deck: &'static str, runs: &Runs) -> Vec<Figure> {
    let cholmod = |quantity| (Program::Cholmod(1), quantity);
    let parts = |quantity| (Program::Parts, quantity);
    let faer = |threads, quantity| (Program::Faer(threads), quantity);
    let first = (ONE, "first_cpu");
    let wall = (TWO, "first_wall");
    let figures = [
        ("solve/CHOLMOD,1_thread_cpu", first, cholmod("cpu")),
        ("solve/CHOLMOD,2_threads_wall", wall, (Program::Cholmod(2), "wall")),
        ("2_threads/1_thread,wall", wall, (ONE, "first_wall")),
        ("F/factorisation", parts("dual_operator_cpu"), parts("factorisation_cpu")),
        ("second_step/first,cpu", (ONE, "second_cpu"), first),
        ("peak_memory/CHOLMOD", (ONE, "peak"), cholmod("peak")),
        ("few_steps,solve/CHOLMOD,1_thread_cpu", (Program::Few(1), "first_cpu"), cholmod("cpu")),
        ("few_steps,peak_memory/CHOLMOD", (Program::Few(1), "peak"), cholmod("peak")),
        ("few_steps,solve/solve,cpu", (Program::Few(1), "first_cpu"), first),
        ("few_steps,second_step/first,cpu", (Program::Few(1), "second_cpu"), (Program::Few(1), "first_cpu")),
        ("factorisation/faer's,1_thread_cpu", (Program::Factor(1), "cpu"), faer(1, "cpu")),
        ("factorisation/faer's,2_threads_wall", (Program::Factor(2), "wall"), faer(2, "wall")),
        ("first_factorisation/faer's,1_thread_cpu", (Program::Factor(1), "first_cpu"), faer(1, "first_cpu")),
        ("entries_of_L/faer's", (Program::Factor(1), "entries"), faer(1, "entries")),
        ("memory_of_factorisation/faer's", (Program::Factor(1), "memory"), faer(1, "memory")),
        ("friction/frictionless,1_thread_cpu", first, (Program::Frictionless, "first_cpu")),
        ("host_loop/solve,1e-6,cpu", (Program::HostLoop(6), "cpu"), first),
        ("host_loop/solve,1e-9,cpu", (Program::HostLoop(9), "cpu"), first),
        ("Clarabel/solve,cpu", (Program::Clarabel, "cpu"), first),
        ("OSQP/solve,cpu", (Program::Osqp, "cpu"), first),
        ("F_product/triad", (Program::Bandwidth, "product"), (Program::Bandwidth, "triad")),
    ];
    let figure = |(name, over, under)| {
        let value = runs.ratio(deck, over, under)?;
        Some(Figure { deck, name, value, goal: goal(name, deck) })
    };
    figures.into_iter().chain(OF_CUT).filter_map(figure).collect()
}

/// Up to which value a figure is good enough, or from which on.
fn goal(name: &str, deck: &str) -> Goal {
    use Goal::{Least, Most};
    match (name, deck) {
        ("solve/CHOLMOD,1_thread_cpu", "4k") => Most(1.2),
        ("solve/CHOLMOD,1_thread_cpu", "13k") => Most(1.0),
        ("solve/CHOLMOD,1_thread_cpu", "40k") => Most(0.8),
        ("solve/CHOLMOD,1_thread_cpu" | "solve/CHOLMOD,2_threads_wall", "144k") => Most(0.9),
        ("2_threads/1_thread,wall", "144k") => Most(0.60),
        ("2_threads/1_thread,wall", "one_body") => Most(0.65),
        ("F/factorisation", "40k") => Most(0.15),
        ("F/factorisation", "144k") => Most(0.18),
        ("second_step/first,cpu", "40k" | "144k") => Most(0.08),
        ("peak_memory/CHOLMOD", "4k" | "13k" | "40k" | "144k") => Most(1.1),
        ("few_steps,solve/CHOLMOD,1_thread_cpu", "144k") => Most(0.46),
        ("few_steps,peak_memory/CHOLMOD", "144k") => Most(0.65),
        ("factorisation/faer's,1_thread_cpu" | "factorisation/faer's,2_threads_wall", _) => Most(1.0),
        ("host_loop/solve,1e-6,cpu" | "host_loop/solve,1e-9,cpu", _) => Least(8.0),
        ("Clarabel/solve,cpu", _) => Least(15.0),
        ("OSQP/solve,cpu", _) => Least(25.0),
        ("friction/frictionless,1_thread_cpu", _) => Most(1.3),
        ("F_product/triad", _) => Least(0.7),
        ("solve/CHOLMOD,2_threads_wall", "300k_cut") => Most(1.0),
        ("solve/CHOLMOD,2_threads_wall", "578k_cut") => Most(1.1),
        _ => goal_of_cut(name, deck),
    }
}

/// Of bodies that are handed over by their elements.
fn goal_of_cut(name: &str, deck: &str) -> Goal {
    let most = match (name, deck) {
        ("cut/CHOLMOD,1_thread_cpu", "144k_cut") => 0.35,
        ("cut/CHOLMOD,2_threads_wall", "300k_cut") => 0.30,
        ("cut/CHOLMOD,2_threads_wall", "578k_cut") => 0.18,
        ("cut/uncut,1_thread_cpu", "140k_cut") => 0.12,
        ("cut,2_threads/1_thread,wall", "144k_cut") => 0.62,
        ("cut,peak_memory/CHOLMOD", "144k_cut") => 0.38,
        ("cut,peak_memory/CHOLMOD", "578k_cut") => 0.27,
        ("cut,second_step/first,cpu", "140k_cut") => 0.4,
        ("cut,contact/linear,products", "144k_cut") => 1.4,
        ("cut,dual_solve,1458_pieces/432,wall", _) => 1.5,
        _ => return Goal::None,
    };
    Goal::Most(most)
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

/// A find between 1e5 nodes and 1e5 faces; different bits count as a time without end.
pub fn of_surfaces(deck: &'static str, runs: &Runs) -> Vec<Figure> {
    let of = |threads, quantity| runs.median(deck, Program::Surfaces(threads), quantity);
    let over =
        |quantity| runs.ratio(deck, (Program::Surfaces(2), quantity), (Program::Surfaces(1), quantity));
    let bits: Vec<f64> = [1, 2].map(|threads| runs.values(deck, Program::Surfaces(threads), "bits")).concat();
    let same = bits.iter().all(|sum| *sum == bits[0]);
    let seconds = |quantity| of(2, quantity).map(|wall| if same { wall } else { f64::NAN });
    let figure = |name, value: Option<f64>, goal| Some(Figure { deck, name, value: value?, goal });
    [
        figure("find,2_threads,seconds", seconds("nodes_wall"), Goal::Most(0.5)),
        figure("find,2_threads/1_thread,wall", over("nodes_wall"), Goal::None),
        figure("mortar,9_points,2_threads,seconds", seconds("mortar_9_points_wall"), Goal::Most(3.0)),
        figure("mortar,16_points,2_threads,seconds", seconds("mortar_16_points_wall"), Goal::Most(5.0)),
        figure("mortar,16_points,2_threads/1_thread,wall", over("mortar_16_points_wall"), Goal::None),
        figure("memory_per_face,bytes", of(1, "bytes_per_face"), Goal::Most(200.0)),
    ]
    .into_iter()
    .flatten()
    .collect()
}

/// How time and memory of bodies by their elements grow.
pub fn of_growth(runs: &Runs) -> Vec<Figure> {
    const GIGABYTE: f64 = 1e9;
    const DECK: &str = "989k_cut";
    let of = |deck, quantity| runs.median(deck, Program::Cut(2), quantity);
    let per_dof = |deck, quantity| Some(of(deck, quantity)? / of(deck, "dofs")?);
    let growth = |quantity| Some(per_dof(DECK, quantity)? / per_dof("300k_cut", quantity)?);
    let figure = |name, value: Option<f64>, goal| Some(Figure { deck: DECK, name, value: value?, goal });
    [
        figure("cut,time_per_dof/300k's,2_threads_wall", growth("whole_wall"), Goal::Most(1.2)),
        figure("cut,peak_memory_per_dof/300k's", growth("peak"), Goal::None),
        figure("cut,peak_memory,GB", of(DECK, "peak").map(|bytes| bytes / GIGABYTE), Goal::Most(3.5)),
    ]
    .into_iter()
    .flatten()
    .collect()
}
