//! Every threshold of the library stands in src/numbers, and docs/numbers.md is their table, which `make numbers` writes.

use std::env;
use std::fmt::Write;
use std::fs;
use std::path::Path;

use crate::layering::crate_in;
use crate::layering::source::{is_word, line_of, test_ranges, without_text, words};

/// What an expression may have without a name: zeros, ones, halves and counts of a formula; the variance of rounding is 1 / 12,
/// a per cent 1 / 100, digits have the base 10.
const PLAIN: [f64; 9] = [0.0, 0.5, 1.0, 2.0, 3.0, 4.0, 10.0, 12.0, 100.0];

const ROOT: &str = env!("CARGO_MANIFEST_DIR");
const PAGE: &str = "docs/numbers.md";
/// What `make vary` has measured: a line `GROUP::NAME VALUE: TEXT` for ten times and for a tenth of each.
const VARIED: &str = "tools/mutants/varied.txt";

/// The sources of the library outside its tests, without comments and texts, and the files of src/numbers as they are, by group.
fn sources() -> (Vec<(String, String)>, Vec<(String, String)>) {
    let (all, tests) = crate_in("src");
    let (mut library, mut numbers) = (Vec::new(), Vec::new());
    for (path, text) in all.into_iter().filter(|(path, _)| !tests.contains(path)) {
        match path.strip_prefix("src/numbers/").and_then(|name| name.strip_suffix(".rs")) {
            Some(group) => numbers.push((group.to_owned(), text)),
            None => library.push((path, without_text(&text))),
        }
    }
    (library, numbers)
}

/// Real literals of the code with their positions: `1e-8`, `0.5`, `2.0`; not `0..3`, `x.0`, `1_u64`.
fn literals(code: &str) -> Vec<(usize, f64)> {
    let bytes = code.as_bytes();
    let is_part = |at: usize| {
        let c = bytes[at];
        let sign = (c == b'-' || c == b'+') && matches!(bytes[at - 1], b'e' | b'E');
        is_word(c) || sign || c == b'.' && bytes.get(at + 1).is_some_and(u8::is_ascii_digit)
    };
    let mut found = Vec::new();
    let mut at = 1;
    while at < bytes.len() {
        let begins = bytes[at].is_ascii_digit() && !is_word(bytes[at - 1]) && bytes[at - 1] != b'.';
        if !begins {
            at += 1;
            continue;
        }
        let start = at;
        while at < bytes.len() && (at == start || is_part(at)) {
            at += 1;
        }
        let text = code[start..at].replace('_', "").replace("f64", "");
        if !text.starts_with("0x") && (text.contains(['.', 'e']) || code[start..at].ends_with("f64")) {
            found.extend(text.parse().ok().map(|value| (start, value)));
        }
    }
    found
}

/// Literals that are thresholds without a name.
fn unnamed(code: &str) -> Vec<(usize, f64)> {
    let tests = test_ranges(code);
    let of_eps = |at: usize| {
        code[at..].chars().take(24).collect::<String>().contains("EPSILON")
            || code[..at].ends_with("EPSILON / ")
    };
    literals(code)
        .into_iter()
        .filter(|(at, value)| {
            !PLAIN.contains(value) && !of_eps(*at) && !tests.iter().any(|test| test.contains(at))
        })
        .map(|(at, value)| (line_of(code, at), value))
        .collect()
}

struct Entry {
    name: String,
    value: String,
    meaning: String,
}

/// The entries of one file of src/numbers, a comment and a constant each.
fn entries(text: &str) -> Vec<Entry> {
    let (mut found, mut meaning) = (Vec::new(), Vec::new());
    for line in text.lines() {
        if let Some(words) = line.strip_prefix("/// ") {
            meaning.push(words);
        } else if let Some((name, value)) =
            line.strip_prefix("pub const ").and_then(|line| line.split_once(": "))
        {
            let value = value.split_once(" = ").map_or(value, |typed| typed.1);
            let (name, value) = (name.to_owned(), value.trim_end_matches(';').to_owned());
            found.push(Entry { name, value, meaning: std::mem::take(&mut meaning).join(" ") });
        }
    }
    found
}

/// The files that use an entry, without `src/` and `.rs`.
fn users(group: &str, name: &str, library: &[(String, String)]) -> Vec<String> {
    let of_group = format!("use crate::numbers::{group}");
    let qualified = format!("{group}::{name}");
    let named = |code: &str| {
        let mut statements =
            code.split(';').filter(|statement| statement.trim_start().starts_with(&of_group));
        statements.any(|statement| words(statement, name).next().is_some())
            || words(code, group).any(|at| code[at..].starts_with(&qualified))
    };
    let users = library.iter().filter(|(_, code)| named(code));
    users.map(|(path, _)| path.trim_start_matches("src/").trim_end_matches(".rs").to_owned()).collect()
}

/// What changes with ten times a threshold, and with a tenth.
fn changes(group: &str, Entry { name, value, .. }: &Entry, varied: &str) -> String {
    let of = format!("{group}::{name} ");
    let lines = varied.lines().filter_map(|line| line.strip_prefix(&of)?.split_once(": "));
    let (with, told): (Vec<&str>, Vec<&str>) = lines.unzip();
    let number = |text: &str| text.replace('_', "").parse::<f64>().unwrap_or(f64::NAN);
    let fits = |(with, factor): (&&str, f64)| (number(with) / (factor * number(value)) - 1.0).abs() < 1e-4;
    if !with.iter().zip([10.0, 0.1]).all(fits) {
        return "measured with another value".to_owned();
    }
    match told[..] {
        [] => "not varied".to_owned(),
        [more, less] if more == less => more.to_owned(),
        _ => told.join(" / "),
    }
}

fn page() -> String {
    let (library, numbers) = sources();
    let varied = fs::read_to_string(Path::new(ROOT).join(VARIED)).unwrap();
    let mut page = String::from(
        "# Numbers\n\nEvery threshold of the library that is not a small multiple of eps = 2^-52, from the files of `src/numbers`; \
         `make numbers` writes this\npage, and a test refuses any other. Every number is a ratio, a power of a ratio or a count: none \
         has a unit. P, J and S refer to [method.md](method.md).\n\n\
         The last column says what changes with ten times the number and with a tenth of it, as `make vary` measured on 150 problems of each \
         battery (hard,\nvaried, known outcome, friction): problems that are solved, products with F, and tests of the batteries that fail. \"nothing\" means nothing in the batteries: unit tests and\nclaims, which guard many numbers more closely, were not run.\n",
    );
    for (group, text) in numbers {
        let entries = entries(&text);
        if entries.is_empty() {
            continue;
        }
        let title = text.lines().take_while(|line| line.starts_with("//!"));
        let title: Vec<&str> = title.map(|line| line.trim_start_matches("//! ")).collect();
        writeln!(
            page,
            "\n## `{group}`\n\n{}\n\n| number | value | meaning | used in | ten times / a tenth |\n|---|---|---|---|---|",
            title.join(" ")
        )
        .unwrap();
        for entry in entries {
            let Entry { name, value, meaning } = &entry;
            let used = users(&group, name, &library)
                .iter()
                .map(|path| format!("`{path}`"))
                .collect::<Vec<_>>()
                .join(", ");
            let value = value.trim_end_matches(".0");
            let changes = changes(&group, &entry, &varied);
            writeln!(page, "| `{name}` | {value} | {} | {used} | {changes} |", meaning.replace('|', "\\|"))
                .unwrap();
        }
    }
    page
}

#[test]
fn every_threshold_has_a_name_and_a_reason_in_one_place() {
    let (library, numbers) = sources();
    let mut faults = Vec::new();
    // defaults and ranges of the options are in docs/options.md
    for (path, code) in library.iter().filter(|(path, _)| path != "src/model/settings.rs") {
        faults.extend(
            unnamed(code)
                .iter()
                .map(|(line, value)| format!("{path}:{line}: {value:e} has no name in src/numbers")),
        );
    }
    for (group, text) in numbers {
        for entry in entries(&text) {
            if entry.meaning.split(' ').count() < 3 {
                faults.push(format!("{group}::{} has no meaning", entry.name));
            }
            if users(&group, &entry.name, &library).is_empty() {
                faults.push(format!("nothing uses {group}::{}", entry.name));
            }
        }
    }
    assert!(faults.is_empty(), "{}", faults.join("\n"));
}

#[test]
fn the_page_of_numbers_is_that_of_the_sources() {
    let page = page();
    let path = Path::new(ROOT).join(PAGE);
    if env::var("NUMBERS").is_ok_and(|way| way == "write") {
        fs::write(&path, &page).unwrap();
    }
    assert!(
        fs::read_to_string(path).unwrap() == page,
        "{PAGE} differs from src/numbers: `make numbers` writes it"
    );
}

#[test]
fn a_threshold_in_an_expression_is_seen() {
    let seen = |line: &str| {
        unnamed(&without_text(&format!("fn f() {{ {line} }}")))
            .iter()
            .map(|found| found.1)
            .collect::<Vec<_>>()
    };
    assert_eq!(seen("x < 1e-8 * y || x > 0.3 || x < 2.5e+3"), [1e-8, 0.3, 2.5e3]);
    assert_eq!(seen("let x = 7_000f64;"), [7000.0]);
    assert_eq!(
        seen("x <= 64.0 * f64::EPSILON * 0.5 * y; a.0 .1; for i in 0..10 {} 1_u64; \"1e-8\" // 1e-8"),
        []
    );
}
