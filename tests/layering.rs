//! The arrows between the layers, and what no source of the library may contain:
//!
//! ```text
//! error <- linalg <- body, constraints <- dual <- solver <- ffi
//!          linalg <- qp <- solver
//!          body, constraints <- certificate <- solver
//! ```
//!
//! faer is known to linalg only; nothing prints; nothing panics but the fault a host may ask for; no file is
//! longer than 400 lines.

use std::collections::BTreeSet;
use std::fs;
use std::path::{Path, PathBuf};

/// What each layer may name; every layer may name itself.
const ALLOWED: [(&str, &[&str]); 9] = [
    ("error", &[]),
    ("linalg", &["error"]),
    ("body", &["error", "linalg"]),
    ("constraints", &["error", "linalg"]),
    ("dual", &["error", "linalg", "body", "constraints"]),
    ("qp", &["error", "linalg"]),
    ("certificate", &["error", "linalg", "body", "constraints"]),
    ("solver", &["error", "linalg", "body", "constraints", "dual", "qp", "certificate"]),
    ("ffi", &["error", "solver"]),
];

const FORBIDDEN: [&str; 11] = [
    "println!",
    "print!",
    "eprintln!",
    "eprint!",
    "dbg!",
    "panic!",
    "todo!",
    "unimplemented!",
    "unreachable!",
    ".unwrap()",
    ".expect(",
];

/// The one panic outside the tests: the option `fault_injection`.
const INJECTED: (&str, &str) = ("ffi/solve.rs", "panic!");

const LONGEST: usize = 400;

/// All faults of one source; `path` is relative to src.
fn faults(path: &str, text: &str) -> Vec<String> {
    let code = without_text(text);
    let mut found = Vec::new();
    let mut report =
        |at: usize, what: String| found.push(format!("src/{path}:{}: {what}", line_of(&code, at)));
    let layer = layer_of(path);
    for (at, named) in paths_from_root(&code) {
        if !may_name(layer, &named) {
            report(at, format!("{layer} must not use crate::{named}"));
        }
    }
    for (at, supers, named) in paths_through_super(&code) {
        if supers >= depth_at(path, &code, at) && !may_name(layer, &named) {
            report(at, format!("{layer} must not use {named}, reached through super"));
        }
    }
    if layer != "linalg" {
        words(&code, "faer").for_each(|at| report(at, "faer outside linalg".into()));
    }
    let tests = test_ranges(&code);
    for token in FORBIDDEN {
        let calls = occurrences(&code, token).filter(|&at| !tests.iter().any(|range| range.contains(&at)));
        let allowed = usize::from((path, token) == INJECTED);
        calls.skip(allowed).for_each(|at| report(at, format!("{token} outside the tests")));
    }
    let lines = text.lines().count();
    if lines > LONGEST {
        found.push(format!("src/{path}:{lines}: longer than {LONGEST} lines"));
    }
    found
}

/// `ffi/solve.rs` -> `ffi`, `error.rs` -> `error`.
fn layer_of(path: &str) -> &str {
    path.split('/').next().unwrap_or(path).trim_end_matches(".rs")
}

/// Names that are no layer, `*` and `self` among them, may be used by nobody: they would hide what is meant.
fn may_name(layer: &str, named: &str) -> bool {
    let allowed = ALLOWED.iter().find(|(name, _)| *name == layer);
    allowed.is_some_and(|(own, below)| *own == named || below.contains(&named))
}

fn line_of(code: &str, at: usize) -> usize {
    1 + code[..at].matches('\n').count()
}

fn is_word(c: u8) -> bool {
    c.is_ascii_alphanumeric() || c == b'_'
}

/// Positions of `token` that do not continue a longer word to the left.
fn occurrences<'a>(code: &'a str, token: &'a str) -> impl Iterator<Item = usize> + 'a {
    let free =
        move |at: &usize| !is_word(token.as_bytes()[0]) || *at == 0 || !is_word(code.as_bytes()[at - 1]);
    code.match_indices(token).map(|(at, _)| at).filter(free)
}

/// Positions of `word` as a whole word.
fn words<'a>(code: &'a str, word: &'a str) -> impl Iterator<Item = usize> + 'a {
    let ends = move |at: &usize| code.as_bytes().get(at + word.len()).is_none_or(|&c| !is_word(c));
    occurrences(code, word).filter(ends)
}

/// The names that follow `::` at the start of `rest`: one, or the heads of a `{...}` list.
fn heads(rest: &str) -> Vec<String> {
    let Some(rest) = rest.trim_start().strip_prefix("::") else { return Vec::new() };
    let rest = rest.trim_start();
    let head = |text: &str| -> String {
        let text = text.trim_start();
        let name: String = text.chars().take_while(|c| c.is_alphanumeric() || *c == '_').collect();
        if name.is_empty() {
            text.chars().take(1).collect()
        } else {
            name
        }
    };
    let Some(list) = rest.strip_prefix('{') else { return vec![head(rest)] };
    let (mut depth, mut start, mut names) = (0, 0, Vec::new());
    for (at, c) in list.char_indices() {
        match c {
            '{' => depth += 1,
            '}' if depth > 0 => depth -= 1,
            ',' | '}' if depth == 0 => {
                names.push(head(&list[start..at]));
                start = at + 1;
                if c == '}' {
                    break;
                }
            }
            _ => {}
        }
    }
    names.retain(|name| !name.is_empty() && name != "}" && name != ",");
    names
}

/// Every `crate::name`, with what `crate::{a, b}` names.
fn paths_from_root(code: &str) -> Vec<(usize, String)> {
    let of = |at: usize| heads(&code[at + 5..]).into_iter().map(move |name| (at, name));
    words(code, "crate").flat_map(of).collect()
}

/// Every `super::...::name`, with the number of `super`.
fn paths_through_super(code: &str) -> Vec<(usize, usize, String)> {
    let mut found = Vec::new();
    for at in words(code, "super").filter(|&at| !code[..at].trim_end().ends_with("super::")) {
        let (mut supers, mut rest) = (1, &code[at + 5..]);
        while let Some(next) = rest.strip_prefix("::super") {
            (supers, rest) = (supers + 1, next);
        }
        found.extend(heads(rest).into_iter().map(|name| (at, supers, name)));
    }
    found
}

/// Modules between the root and the code at `at`: those of the path and those opened with `mod name {`.
fn depth_at(path: &str, code: &str, at: usize) -> usize {
    let of_file = path.split('/').count() - usize::from(path.ends_with("/mod.rs"));
    let inline = words(code, "mod").filter(|&start| {
        let header = code[start..].find(['{', ';']).map(|offset| start + offset);
        header.is_some_and(|open| code.as_bytes()[open] == b'{' && open < at && at < closing(code, open))
    });
    of_file + inline.count()
}

/// Position after the brace that closes the one at `open`.
fn closing(code: &str, open: usize) -> usize {
    let mut depth = 0usize;
    for (at, c) in code[open..].bytes().enumerate() {
        match c {
            b'{' => depth += 1,
            b'}' => depth -= 1,
            _ => continue,
        }
        if depth == 0 {
            return open + at + 1;
        }
    }
    code.len()
}

/// What `#[cfg(test)]` covers in this file.
fn test_ranges(code: &str) -> Vec<std::ops::Range<usize>> {
    let item = |at: usize| match code[at..].find(['{', ';']) {
        Some(offset) if code.as_bytes()[at + offset] == b'{' => at..closing(code, at + offset),
        Some(offset) => at..at + offset,
        None => at..code.len(),
    };
    occurrences(code, "#[cfg(test)]").map(item).collect()
}

/// Modules `mod name;` that exist in tests only.
fn test_modules(code: &str) -> Vec<String> {
    let items = test_ranges(code).into_iter().map(|range| code[range].to_owned());
    let name = |item: String| item.rsplit_once("mod ").map(|(_, name)| name.trim().to_owned());
    items.filter(|item| !item.contains('{')).filter_map(name).collect()
}

/// The source with comments, strings and characters blanked, every line in its place.
fn without_text(text: &str) -> String {
    let bytes = text.as_bytes();
    let (mut out, mut at) = (bytes.to_vec(), 0);
    while at < bytes.len() {
        let end = at + length_of_text(&bytes[at..], at > 0 && is_word(bytes[at - 1]));
        if end == at {
            at += 1;
            continue;
        }
        out[at..end].iter_mut().filter(|c| **c != b'\n').for_each(|c| *c = b' ');
        at = end;
    }
    String::from_utf8_lossy(&out).into_owned()
}

/// Length of the comment, string or character that starts here, 0 for none.
fn length_of_text(rest: &[u8], inside_word: bool) -> usize {
    let until = |start: usize, end: &[u8]| {
        let found = rest[start..].windows(end.len()).position(|window| window == end);
        found.map_or(rest.len(), |at| start + at + end.len())
    };
    match rest {
        [b'/', b'/', ..] => rest.iter().position(|c| *c == b'\n').unwrap_or(rest.len()),
        [b'/', b'*', ..] => block_comment(rest),
        [b'"', ..] => quoted(rest, b'"'),
        [b'r', b'#' | b'"', ..] | [b'b' | b'c', b'r', b'#' | b'"', ..] if !inside_word => {
            let start = rest.iter().position(|c| *c == b'r').unwrap_or(0) + 1;
            let hashes = rest[start..].iter().take_while(|c| **c == b'#').count();
            if rest.get(start + hashes) != Some(&b'"') {
                return 0;
            }
            until(start + hashes + 1, &[b"\"".as_slice(), &vec![b'#'; hashes]].concat())
        }
        [b'\'', b'\\', ..] => quoted(rest, b'\''),
        [b'\'', c, tail @ ..] if tail.first() == Some(&b'\'') || !c.is_ascii() => quoted(rest, b'\''),
        _ => 0,
    }
}

fn block_comment(rest: &[u8]) -> usize {
    let (mut depth, mut at) = (0, 0);
    while at < rest.len() {
        match &rest[at..] {
            [b'/', b'*', ..] => (depth, at) = (depth + 1, at + 2),
            [b'*', b'/', ..] => (depth, at) = (depth - 1, at + 2),
            _ => at += 1,
        }
        if depth == 0 {
            break;
        }
    }
    at
}

fn quoted(rest: &[u8], quote: u8) -> usize {
    let mut at = 1;
    while at < rest.len() && rest[at] != quote {
        at += if rest[at] == b'\\' { 2 } else { 1 };
    }
    (at + 1).min(rest.len())
}

/// All sources below `folder`, by name.
fn sources(folder: &Path) -> Vec<PathBuf> {
    let mut files = Vec::new();
    for entry in fs::read_dir(folder).unwrap() {
        let path = entry.unwrap().path();
        if path.is_dir() {
            files.extend(sources(&path));
        } else if path.extension().is_some_and(|extension| extension == "rs") {
            files.push(path);
        }
    }
    files.sort();
    files
}

#[test]
fn the_sources_keep_to_their_layers() {
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("src");
    let (mut all, mut only_tests) = (Vec::new(), BTreeSet::new());
    for file in sources(&root) {
        let path = file.strip_prefix(&root).unwrap().to_str().unwrap().replace('\\', "/");
        let text = fs::read_to_string(&file).unwrap();
        let folder = path.strip_suffix("/mod.rs").or_else(|| path.strip_suffix(".rs")).unwrap_or(&path);
        only_tests
            .extend(test_modules(&without_text(&text)).iter().map(|name| format!("{folder}/{name}.rs")));
        all.push((path, text));
    }
    assert!(all.len() > 30, "only {} sources were found", all.len());
    // whatever lies below a module of tests is one
    let is_test = |path: &str| {
        path.match_indices('/').any(|(at, _)| only_tests.contains(&format!("{}.rs", &path[..at])))
            || only_tests.contains(path)
    };
    let exempt = |path: &str, fault: &String| is_test(path) && fault.ends_with("outside the tests");
    let found: Vec<String> = (all.iter().filter(|(path, _)| path != "lib.rs"))
        .flat_map(|(path, text)| faults(path, text).into_iter().filter(|fault| !exempt(path, fault)))
        .collect();
    assert!(found.is_empty(), "{}", found.join("\n"));
}

#[test]
fn an_upward_or_sideways_import_is_named_with_its_line() {
    let upward = "//! crate::solver in a comment\nuse crate::error::Result;\nuse crate::solver::Problem;\n";
    assert_eq!(faults("qp/steps.rs", upward), ["src/qp/steps.rs:3: qp must not use crate::solver"]);
    let list = "use crate::{\n    error::{Error, Kind},\n    linalg::Csr,\n    constraints,\n};\n";
    assert_eq!(faults("body/mod.rs", list), ["src/body/mod.rs:1: body must not use crate::constraints"]);
    let inline = "fn f() {\n    let x = crate :: dual::Dual::new();\n}\n";
    assert_eq!(faults("ffi/solve.rs", inline), ["src/ffi/solve.rs:2: ffi must not use crate::dual"]);
    assert_eq!(faults("error.rs", "use crate::*;"), ["src/error.rs:1: error must not use crate::*"]);
    assert!(faults("solver/solve.rs", "use crate::{qp, dual::Dual};").is_empty());
    assert!(
        faults("qp/mod.rs", "/* crate::ffi /* nested */ */ const A: &str = r#\"crate::ffi\"#;").is_empty()
    );
}

#[test]
fn a_way_around_through_super_is_seen() {
    let around = ["src/qp/steps.rs:1: qp must not use dual, reached through super"];
    assert_eq!(faults("qp/steps.rs", "use super::super::dual::Dual;"), around);
    assert!(faults("qp/steps.rs", "use super::dual;").is_empty(), "a module qp::dual");
    assert_eq!(faults("qp/mod.rs", "use super::{body, linalg};").len(), 1);
    assert!(faults("qp/mod.rs", "mod tests {\n    use super::body;\n}").is_empty(), "a module qp::body");
    assert_eq!(faults("qp/mod.rs", "mod tests {\n    use super::super::body;\n}").len(), 1);
}

#[test]
fn faer_prints_panics_and_long_files_are_seen() {
    assert_eq!(faults("body/mod.rs", "use faer::Mat;"), ["src/body/mod.rs:1: faer outside linalg"]);
    assert!(faults("linalg/spd.rs", "use faer::Mat;").is_empty());
    assert!(faults("body/mod.rs", "fn f() {} // faer").is_empty());
    for call in FORBIDDEN {
        let line = format!("fn f<'a>(x: &'a str) {{ let c = '\"'; {call}); }}\n");
        assert_eq!(faults("dual/mod.rs", &line), [format!("src/dual/mod.rs:1: {call} outside the tests")]);
        let tested = format!("fn f() {{}}\n#[cfg(test)]\nmod tests {{ fn g() {{ {call}); }} }}\n");
        assert!(faults("dual/mod.rs", &tested).is_empty(), "{call}");
        assert_eq!(faults("dual/mod.rs", &format!("{tested}fn h() {{ {call}); }}")).len(), 1, "{call}");
    }
    let fault = "fn f() { panic!(\"on request\"); }";
    assert!(faults("ffi/solve.rs", fault).is_empty());
    assert_eq!(faults("ffi/solve.rs", &format!("{fault}\n{fault}")).len(), 1);
    assert_eq!(faults("ffi/rows.rs", fault).len(), 1);
    assert!(faults("qp/mod.rs", &"\n".repeat(400)).is_empty());
    assert_eq!(faults("qp/mod.rs", &"\n".repeat(401)).len(), 1);
}
