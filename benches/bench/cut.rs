//! Contact solves of bodies that are handed over element by element, each in a process of its own.

use decks::{ByElements, Elements, Rows};
use feti_contact::error::Result as Solver;
use feti_contact::solver::{Problem, RowKind};

use crate::clock::{Clock, Lap};
use crate::hand_over::add_rows;
use crate::steps::{print_lap, set_options, text, timed, Steps};

/// One solve with option `pieces`, 0: as the library chooses.
pub fn run(model: ByElements, pieces: i64, threads: i64) -> Result<(), String> {
    first(model, pieces, threads).map(|_| ())
}

/// Load steps on one thread, the second started from the answer before, the third cold; then a linear solve on the
/// rows that the first ended on.
pub fn later(build: impl Fn() -> Result<ByElements, String>) -> Result<(), String> {
    let mut steps = first(build()?, 0, 1)?;
    let multipliers = steps.problem.multipliers(RowKind::Inequality).map_err(text)?.to_vec();
    for (name, start) in [("second", "previous"), ("third", "cold")] {
        steps.problem.set_str("start", start).map_err(text)?;
        steps.next(name)?;
    }
    drop(steps);
    linear(build()?, &multipliers)
}

/// The first solve, `whole` with the cut. What is left of `model` by then are its loads and gaps.
fn first(model: ByElements, pieces: i64, threads: i64) -> Result<Steps, String> {
    let taking = Clock::start();
    let (problem, cutting) = problem(&model, pieces).map_err(text)?;
    print_lap("hand_over", taking.lap());
    print_lap("cut", cutting);
    let mut steps = Steps::new(problem, model.deck, threads)?;
    drop(model.bodies);
    let (_, lap) = steps.first()?;
    print_lap("whole", cutting + lap);
    Ok(steps)
}

/// The problem, and the time that the library took to cut the bodies: until it had the first element of each.
fn problem(model: &ByElements, pieces: i64) -> Solver<(Problem, Lap)> {
    let mut problem = Problem::new();
    problem.set_i64("pieces", pieces)?;
    let mut cutting = Lap { wall: 0.0, cpu: 0.0 };
    for (elements, body) in model.bodies.iter().zip(&model.deck.bodies) {
        let p = problem.add_body(body.dofs())?;
        let places = body.coordinates.concat();
        problem.set_coordinates(p, 3, &body.node, &body.direction, &places, 3)?;
        cutting = cutting + give_elements(&mut problem, p, elements)?;
        problem.set_load(p, &body.load)?;
    }
    add_rows(&mut problem, RowKind::Inequality, &model.deck.contact)?;
    add_rows(&mut problem, RowKind::Equality, &model.deck.equalities)?;
    Ok((problem, cutting))
}

/// Connectivity, then one matrix after the other; gives the time of the first.
fn give_elements(problem: &mut Problem, p: usize, elements: &Elements) -> Solver<Lap> {
    let (count, order) = (elements.count(), elements.order());
    let ptr: Vec<usize> = (0..=count).map(|e| order * e).collect();
    problem.set_mesh(p, &ptr, &elements.connectivity())?;
    let mut matrix = vec![0.0; order * order];
    let mut give = |e: usize| {
        elements.stiffness(e, &mut matrix);
        problem.add_element(p, e, order, &matrix, order)
    };
    let cutting = Clock::start();
    give(0)?;
    let cutting = cutting.lap();
    (1..count).try_for_each(give)?;
    Ok(cutting)
}

/// Products with F where the rows with `multipliers` are equalities and there are no others.
fn linear(mut model: ByElements, multipliers: &[f64]) -> Result<(), String> {
    let none = Rows::none(model.deck.dofs());
    let rows = std::mem::replace(&mut model.deck.contact, none);
    for (i, _) in multipliers.iter().enumerate().filter(|(_, multiplier)| **multiplier > 0.0) {
        let entries: Vec<_> = rows.matrix.row(i).collect();
        model.deck.equalities.push(&entries, rows.rhs[i]);
    }
    let mut problem = problem(&model, 0).map_err(text)?.0;
    set_options(&mut problem, 1).map_err(text)?;
    let (report, _) = timed("linear", &mut problem)?;
    println!("linear_products {}", report.counts.products);
    Ok(())
}
