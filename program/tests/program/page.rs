//! What the documents say of the program is what it has.

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
