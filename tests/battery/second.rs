//! Small problems of the battery against a second solver, in double-double arithmetic.

use decks::battery::{self, Outcome as Expected};
use decks::second;
use decks::varied::condition;
use decks::yardstick::Yardstick;
use feti_contact::solver::Outcome;

use crate::battery::seeds;
use crate::battery::varied::{answer, CONDITION};
use crate::support::hand_over;

/// Unknowns of a problem at most.
const UNKNOWNS: usize = 60;
const LINES: usize = 60;

/// Motions are not compared: rows of the battery may leave some undetermined.
#[test]
fn small_problems_of_the_battery_have_the_answer_of_a_second_solver() {
    let (mut table, mut compared, mut unknown) = (Vec::new(), 0, 0);
    for seed in seeds().filter(|seed| seed % 4 < 2) {
        let case = battery::case(seed);
        if case.deck.dofs() > UNKNOWNS {
            continue;
        }
        let case = if seed % 2 == 1 { battery::compliant(case, seed) } else { case };
        assert_eq!(case.outcome(), Expected::Solvable);
        let Some(truth) = second::solve(&case.deck) else {
            unknown += 1;
            continue;
        };
        let mut problem = hand_over::problem(&case.deck).unwrap();
        let report = problem.solve().unwrap_or_else(|error| panic!("{}: {error}", case.deck.name));
        if report.outcome != Outcome::Solved {
            continue;
        }
        compared += 1;
        let yardstick = Yardstick::new(&case.deck, &truth, true);
        let (error, body) = yardstick.worst(&answer(&problem));
        if error > 1.0 && condition(&case.deck, &truth.lambda) <= CONDITION {
            table.push(format!("{}: error {error:.1e} of allowed at body {body}", case.deck.name));
        }
    }
    table.truncate(LINES);
    assert!(table.is_empty(), "of {compared} problems:\n{}", table.join("\n"));
    assert!(
        compared > 0 && unknown * 100 <= compared,
        "{compared} compared, {unknown} without a second answer"
    );
}
