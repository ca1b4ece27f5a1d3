//! What the documents say of the program is what it has.

use feti_contact::error::Kind;
use feti_contact::solver::Outcome;

use crate::show::{Spoilt, SPOILT};
use crate::support::said;

const COMMANDS: [&str; 4] = ["solve", "check", "show", "convert"];

fn read(path: &str) -> String {
    std::fs::read_to_string(format!("{}/../{path}", env!("CARGO_MANIFEST_DIR"))).unwrap()
}

#[test]
fn the_manual_page_has_every_command_and_every_option() {
    let page = read("program/feti-contact.1").replace("\\-", "-");
    let version = env!("CARGO_PKG_VERSION").rsplit_once('.').unwrap().0;
    assert!(page.contains(&format!("\"feti-contact {version}\"")), "the version of the page");
    for command in COMMANDS {
        assert!(page.contains(&format!("\n.B {command}\n")), "{command}");
        let synopsis = page
            .lines()
            .skip_while(|line| !line.contains(&format!("feti-contact {command}")))
            .take(2)
            .collect::<String>();
        let (help, _, _) = said(&[command, "--help"]);
        let lines = help
            .lines()
            .filter_map(|line| line.trim_start().strip_prefix("-h, ").or(Some(line.trim_start())));
        let words =
            lines.filter_map(|line| line.split([' ', '[', '=']).next()).filter(|word| word.starts_with("--"));
        for option in words {
            assert!(page.contains(option), "{command} {option}");
            assert!(option == "--help" || synopsis.contains(option), "{command} {option} in the synopsis");
        }
    }
}

#[test]
fn every_spoilt_file_of_the_test_is_a_row_of_the_table() {
    let document = read("docs/program.md");
    let row = |(name, _, place, _): &Spoilt| format!("| {name} | {place}:");
    let missing: Vec<_> = SPOILT.iter().map(row).filter(|row| !document.contains(row)).collect();
    assert!(missing.is_empty(), "docs/program.md has no row for {missing:?}");
}

/// The page adds links and the marks of code; a link in brackets at the end of a cure is of the page alone.
#[test]
fn the_cures_of_the_page_are_those_that_the_library_has() {
    let outcomes = [
        Outcome::Solved,
        Outcome::Marginal,
        Outcome::Inaccurate,
        Outcome::Stalled,
        Outcome::Iterations,
        Outcome::Time,
        Outcome::Cancelled,
    ];
    let own = [Kind::Argument("")].into_iter().chain(Kind::ALL).map(|kind| (kind.status(), kind.cure()));
    let page = read("docs/statuses.md");
    for (status, cure) in own.chain(outcomes.map(|outcome| (outcome.status(), outcome.cure()))) {
        let row = page.lines().find(|line| line.starts_with(&format!("| `{status}` |"))).unwrap();
        let cell = row.trim_end_matches([' ', '|']).rsplit("| ").next().unwrap().replace('`', "");
        assert!(cure.is_empty() || plain(&cell) == cure, "{status}: {}\n{cure}", plain(&cell));
    }
}

/// Without links: `[text](page)` is its text, a bracket at the end that is a link alone is nothing.
fn plain(cell: &str) -> String {
    let cell = cell.split_once(" ([").filter(|(_, rest)| rest.ends_with("))")).map_or(cell, |of| of.0);
    let mut parts = cell.split('[');
    let mut text = parts.next().unwrap_or_default().to_owned();
    for part in parts {
        let (shown, rest) = part.split_once("](").unwrap();
        text += shown;
        text += rest.split_once(')').unwrap().1;
    }
    text
}
