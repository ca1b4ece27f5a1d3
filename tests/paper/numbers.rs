//! From a numbered equation of the paper to the line that computes it: by searching for its number.

use std::fs;
use std::path::{Path, PathBuf};

/// Number and file where a reader must find it; 5 to 9 are conditions on functions, which the host discretises: the
/// model problems show how.
const NUMBERS: [(&str, &str); 27] = [
    ("(1)", "decks/src/elements.rs"),
    ("(2)", "decks/src/elements.rs"),
    ("(3)", "decks/src/elements.rs"),
    ("(4)", "src/body/generalized_inverse.rs"),
    ("(5)", "decks/src/blocks.rs"),
    ("(6)", "decks/src/lib.rs"),
    ("(7)", "decks/src/lib.rs"),
    ("(8)", "decks/src/lib.rs"),
    ("(9)", "decks/src/lib.rs"),
    ("(10)", "src/solver/solve.rs"),
    ("(11)", "src/solver/solve.rs"),
    ("(12)", "src/dual/mod.rs"),
    ("(13)", "src/dual/mod.rs"),
    ("(14)", "src/body/generalized_inverse.rs"),
    ("(15)", "src/body/generalized_inverse.rs"),
    ("(16)", "src/dual/mod.rs"),
    ("(17)", "src/dual/mod.rs"),
    ("(18)", "src/qp/paper/augmented_lagrangian.rs"),
    ("(19)", "src/qp/paper/bound.rs"),
    ("(20)", "src/qp/paper/quadratic.rs"),
    ("(21)", "src/qp/paper/bound.rs"),
    ("(22)", "src/qp/paper/bound.rs"),
    ("(23)", "src/qp/paper/bound.rs"),
    ("(24)", "src/qp/paper/augmented_lagrangian.rs"),
    ("(25)", "src/qp/paper/augmented_lagrangian.rs"),
    ("(26)", "tests/paper/theorem_4.rs"),
    ("(27)", "tests/paper/theorem_4.rs"),
];

const ALGORITHMS: [(&str, &str); 4] = [
    ("Algorithm 1", "src/qp/paper/bound.rs"),
    ("Algorithm 3", "src/qp/paper/augmented_lagrangian.rs"),
    ("Theorem 2", "tests/paper/theorem_2.rs"),
    ("Theorem 4", "tests/paper/theorem_4.rs"),
];

fn text(path: &str) -> String {
    let path: PathBuf = Path::new(env!("CARGO_MANIFEST_DIR")).join(path);
    fs::read_to_string(&path).unwrap_or_else(|e| panic!("{}: {e}", path.display()))
}

#[test]
fn every_number_of_the_paper_stands_in_a_comment_where_it_is_computed() {
    for (number, path) in NUMBERS.into_iter().chain(ALGORITHMS) {
        let text = text(path);
        let mut comments = text.lines().filter_map(|line| line.split_once("//").map(|(_, comment)| comment));
        assert!(comments.any(|comment| comment.contains(number)), "{path} does not name {number}");
    }
}

#[test]
fn the_handbook_names_every_number_with_its_file() {
    let handbook = text("docs/paper.md");
    for (number, path) in NUMBERS.into_iter().chain(ALGORITHMS) {
        let named = handbook.lines().any(|line| line.contains(number) && line.contains(path));
        assert!(named, "docs/paper.md has no line with {number} and {path}");
    }
}
