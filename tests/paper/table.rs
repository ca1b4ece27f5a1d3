//! The table of docs/paper.md: the runs of `make paper` by the paper's method, and what the handbook says of them.

use crate::paper::problems::{Figure, Problem, PROBLEMS};
use crate::paper::run::by_paper;

fn counts(problem: &Problem) -> [(&'static str, &Figure); 5] {
    let f = &problem.figures;
    [
        ("outer", &f.outer),
        ("inner", &f.inner),
        ("products", &f.products),
        ("unknowns", &f.unknowns),
        ("duals", &f.duals),
    ]
}

#[test]
fn the_counts_of_problems_1_2_and_3_fall_into_their_ranges() {
    for problem in &PROBLEMS {
        let run = by_paper(problem).unwrap();
        let ours = [run.outer, run.inner, run.products, run.unknowns, run.duals];
        for ((quantity, figure), ours) in counts(problem).into_iter().zip(ours) {
            assert!(figure.holds(ours as f64), "{} {quantity} {ours}", problem.name);
        }
        // p2_B2: what rounding leaves of the gradient at rho = 10^6
        let accurate = problem.figures.accuracy.holds(run.accuracy);
        assert!(accurate || problem.name == "p2_B2" && run.accuracy < 3e-4, "{}", problem.name);
    }
}

#[test]
fn every_row_of_the_table_says_ok_exactly_where_its_own_figure_is_in_the_range() {
    let path = concat!(env!("CARGO_MANIFEST_DIR"), "/docs/paper.md");
    let handbook = std::fs::read_to_string(path).unwrap();
    for problem in &PROBLEMS {
        let accuracy = ("accuracy", &problem.figures.accuracy);
        for (quantity, figure) in counts(problem).into_iter().chain([accuracy]) {
            let head = format!("| {} | {quantity} |", problem.name);
            let row = handbook.lines().find_map(|line| line.strip_prefix(&head)).expect(&head);
            let cells: Vec<&str> = row.split('|').map(str::trim).collect();
            let printed = cells[0].parse().ok();
            assert_eq!(printed, figure.printed, "{head}");
            let word = if figure.holds(cells[1].parse().unwrap()) { "ok" } else { "differs" };
            assert_eq!(cells[3], word, "{head}");
        }
    }
}
