//! From a numbered equation of the paper to the line that computes it: by searching for its number.

use std::fs;
use std::path::{Path, PathBuf};

/// Number, file, and the line that computes it, with the number in a comment right there; (5) to (9) are conditions on
/// functions, which the host discretises: the model problems show how.
const NUMBERS: [(&str, &str, &str); 33] = [
    ("(1)", "decks/src/elements.rs", "pub fn elasticity"),
    ("(2)", "decks/src/elements.rs", "pub fn elasticity"),
    ("(3)", "decks/src/elements.rs", "fn gauss_gradients"),
    ("(4)", "src/body/known.rs", "pub fn execute"),
    ("(5)", "decks/src/blocks.rs", "deck.contact.push"),
    ("(6)", "decks/src/lib.rs", "pub struct Deck"),
    ("(7)", "decks/src/lib.rs", "pub struct Deck"),
    ("(8)", "decks/src/lib.rs", "pub struct Deck"),
    ("(9)", "decks/src/lib.rs", "pub struct Deck"),
    ("(10)", "src/solver/problem.rs", "pub fn solve"),
    ("(11)", "src/solver/problem.rs", "pub fn solve"),
    ("(12)", "src/solve/local/displaced.rs", "fn resultants"),
    ("(13)", "src/dual/mod.rs", "pub fn rhs"),
    ("(13)", "src/dual/operator.rs", "pub fn product"),
    ("(14)", "src/body/known.rs", "let mut held"),
    ("(15)", "src/body/generalized_inverse.rs", "pub fn apply"),
    ("(16)", "src/solve/local/displaced.rs", "fn displaced"),
    ("(17)", "src/solve/local/displaced.rs", "fn turn"),
    ("(18)", "paper/src/augmented_lagrangian.rs", "fn alpha"),
    ("(18)", "tests/paper/equations.rs", "let by_18"),
    ("(19)", "paper/src/bound.rs", "pub fn run"),
    ("(20)", "paper/src/quadratic.rs", "pub fn value"),
    ("(21)", "src/qp/gradient.rs", "fn at_bound"),
    ("(22)", "src/qp/gradient.rs", "fn update"),
    ("(23)", "src/qp/gradient.rs", "fn update"),
    ("(24)", "paper/src/augmented_lagrangian.rs", "pub fn algorithm_3"),
    ("(25)", "paper/src/augmented_lagrangian.rs", "fn inner"),
    ("(26)", "tests/paper/theorem_4.rs", "fn bounds_hold"),
    ("(27)", "tests/paper/theorem_4.rs", "fn bounds_hold"),
    ("Algorithm 1", "paper/src/bound.rs", "pub fn run"),
    ("Algorithm 3", "paper/src/augmented_lagrangian.rs", "fn run"),
    ("Theorem 2", "tests/paper/theorem_2.rs", ""),
    ("Theorem 4", "tests/paper/theorem_4.rs", ""),
];

fn text(path: &str) -> String {
    let path: PathBuf = Path::new(env!("CARGO_MANIFEST_DIR")).join(path);
    fs::read_to_string(&path).unwrap_or_else(|e| panic!("{}: {e}", path.display()))
}

/// A comment with the number in the 8 lines above the line, or in the 2 below its beginning.
fn leads_to(text: &str, number: &str, line: &str) -> bool {
    let lines: Vec<&str> = text.lines().collect();
    let comment =
        |at: &usize| lines[*at].split_once("//").is_some_and(|(_, comment)| comment.contains(number));
    let near = |at: usize| (at.saturating_sub(8)..(at + 3).min(lines.len())).any(|at| comment(&at));
    (0..lines.len()).any(|at| lines[at].contains(line) && near(at))
}

#[test]
fn every_number_of_the_paper_leads_to_the_line_that_computes_it() {
    for (number, path, line) in NUMBERS {
        assert!(leads_to(&text(path), number, line), "{path} does not name {number} at \"{line}\"");
    }
    let numbers: Vec<String> = (1..=27).map(|n| format!("({n})")).collect();
    assert!(numbers.iter().all(|n| NUMBERS.iter().any(|(number, ..)| n == number)), "(1) to (27)");
}

#[test]
fn the_handbook_names_every_number_with_its_file() {
    let handbook = text("docs/paper.md");
    for (number, path, _) in NUMBERS {
        let named = handbook.lines().any(|line| line.contains(number) && line.contains(path));
        assert!(named, "docs/paper.md has no line with {number} and {path}");
    }
}
