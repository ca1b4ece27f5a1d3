//! Problems as files, for programs that read them.

use std::path::Path;

use decks::{hard, varied};

use crate::support::hand_over;

/// `make mpi`: so many problems of both batteries (BATTERY), below folder PROBLEMS.
#[test]
#[ignore]
fn problems_as_files() {
    let folder = std::env::var("PROBLEMS").expect("PROBLEMS: a folder");
    let mut count = 0;
    let mut write = |problem: feti_contact::error::Result<feti_contact::solver::Problem>, name: String| {
        // some are refused as they are given
        let Ok(mut problem) = problem else { return };
        problem.write_file(&Path::new(&folder).join(name)).unwrap();
        count += 1;
    };
    for seed in crate::battery::seeds() {
        let case = hard::mixed(seed, &hard::MIXTURE);
        write(crate::battery::hard::problem(&case.deck, case.given), format!("hard{seed}.feti"));
        write(hand_over::problem(&varied::case(seed).deck), format!("varied{seed}.feti"));
    }
    assert!(count > 0);
}
