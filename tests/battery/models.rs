//! `make rungs`: what each second try saves on model problems, larger and more regular than random ones.

use decks::pieces::Pieces;
use decks::rubbing::Rubbing;
use decks::{masonry, Blocks, Cube, Deck, Stack};
use feti_contact::solver::Outcome;

use crate::support::hand_over;
use crate::support::rungs::{self, Ended};

fn models() -> Vec<Deck> {
    let heaps = (0..20).map(|seed| masonry::heap(40 + 10 * seed as usize, seed));
    let walls =
        [0.0, 1e-6, 1e-4, 1e-3].into_iter().flat_map(|scatter| [6, 9].map(|n| masonry::wall(n, scatter)));
    let cubes = [2, 3]
        .into_iter()
        .flat_map(|dimension| [4, 6].map(|elements| Cube { dimension, elements, ..Cube::default() }.build()));
    let pieces = [true, false].map(|held| Pieces { pieces: 4, elements: 6, held }.build());
    [masonry::tower(100), masonry::chain(200), masonry::apart(100), Stack::default().build()]
        .into_iter()
        .chain([6, 9].map(|elements| Blocks { elements, ..Blocks::default() }.build()))
        .chain(heaps.chain(walls).chain(cubes).chain(pieces))
        .chain(Rubbing::floating_36().iter().map(Rubbing::build))
        .collect()
}

#[test]
#[ignore]
fn what_each_second_try_saves() {
    let models = models();
    rungs::print("models", 0..models.len() as u64, |k, without| {
        let mut problem = hand_over::problem(&models[k as usize]).unwrap();
        problem.set_i64("without", without).unwrap();
        let report = problem.solve().ok();
        let solved = report.as_ref().is_some_and(|report| report.outcome == Outcome::Solved);
        Some(Ended { solved, wrong: false, report })
    });
}
