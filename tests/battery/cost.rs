//! How many answers end and what they cost, in one line for each battery: `tools/mutants/vary.py` compares them.

use decks::{battery, hard, varied};
use feti_contact::solver::{Outcome, Problem};

use crate::battery::seeds;
use crate::coulomb;
use crate::support::hand_over;

/// Whether it is solved, and its products with F.
fn cost(problem: &mut Problem) -> (bool, usize) {
    problem.solve().map_or((false, 0), |report| (report.outcome == Outcome::Solved, report.counts.products))
}

#[test]
#[ignore]
fn what_many_answers_cost() {
    let hard = seeds().map(|seed| {
        let case = hard::mixed(seed, &hard::MIXTURE);
        crate::battery::hard::problem(&case.deck, case.given)
    });
    let varied = seeds().map(|seed| hand_over::problem(&varied::case(seed).deck));
    let known = battery::cases(seeds()).map(|case| hand_over::problem(&case.deck));
    let rubbing =
        seeds().map(|seed| hand_over::problem(&coulomb::drawn::case(seed, coulomb::battery::sizes()).deck));
    let all: [(&str, Vec<_>); 4] = [
        ("hard", hard.collect()),
        ("varied", varied.collect()),
        ("known", known.collect()),
        ("friction", rubbing.collect()),
    ];
    println!();
    for (name, problems) in all {
        let costs: Vec<_> = problems
            .into_iter()
            .map(|given| given.map_or((false, 0), |mut problem| cost(&mut problem)))
            .collect();
        let solved = costs.iter().filter(|cost| cost.0).count();
        println!(
            "{name}: {} problems, {solved} solved, {} products",
            costs.len(),
            costs.iter().map(|cost| cost.1).sum::<usize>()
        );
        assert!(solved > 0, "none of {name} is solved");
    }
}
