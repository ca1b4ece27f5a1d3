//! One contact solve in a process of its own, and a second one for new loads and gaps: bodies by their matrices.

use decks::Deck;

use crate::clock::Clock;
use crate::hand_over;
use crate::steps::{print_lap, text, Steps};

/// Prints lines `name value`. `expected`: option steps.
pub fn run(deck: Deck, threads: i64, expected: i64) -> Result<(), String> {
    let taking = Clock::start();
    let mut problem = hand_over::problem(&deck).map_err(text)?;
    problem.set_i64("steps", expected).map_err(text)?;
    print_lap("hand_over", taking.lap());
    let mut steps = Steps::new(problem, deck, threads)?;
    let (first, _) = steps.first()?;
    let second = steps.next("second")?;
    println!("second_factorisations {}", second.work.factorisations - first.work.factorisations);
    Ok(())
}
