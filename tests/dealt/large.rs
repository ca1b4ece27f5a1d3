//! The decks of `make counts`, dealt out: minutes. Bodies large enough for single precision.

#[allow(dead_code)]
#[path = "../../benches/counts/table.rs"]
mod table;

use super::{compare_on, Motions};
use decks::rubbing::{push, with_friction};
use decks::Blocks;

/// `DECKS="cube slab"` picks those whose names contain one of the words.
#[test]
#[ignore]
fn all_decks_of_counts_dealt_out_to_two_and_three_ranks_have_the_bits_of_one_rank() {
    let wanted = std::env::var("DECKS").unwrap_or_default();
    let wants = |name: &str| wanted.is_empty() || wanted.split(' ').any(|part| name.contains(part));
    for case in table::cases().into_iter().filter(|case| wants(&case.name)) {
        let begin = std::time::Instant::now();
        let deck = case.model.build();
        compare_on([2, 3], &case.name, 1, &deck, (Motions::Exact, ""));
        println!("{}: {:.1} s", case.name, begin.elapsed().as_secs_f64());
    }
}

#[test]
fn factors_in_single_precision_on_other_ranks_give_the_bits_of_one_rank() {
    let mut deck = with_friction(Blocks { elements: 16, young: 1.0 }.build(), 0.3);
    push(&mut deck, 1, [1e-4, 0.0]);
    compare_on([2], "blocks_16", 1, &deck, (Motions::Exact, "steps=2"));
}
