//! Every crate that is linked into the library may be used under MIT, BSD, ISC, Zlib, 0BSD or the Unlicense: a host that is
//! GPL-2-only can take no other (Apache-2.0 alone is refused). docs/licences.md holds the table; `make licences` writes it.

use std::collections::BTreeSet;
use std::env;
use std::fs;
use std::path::Path;
use std::process::Command;

const FREE: [&str; 7] = ["MIT", "BSD-2-Clause", "BSD-3-Clause", "ISC", "Zlib", "0BSD", "Unlicense"];
const BEGIN: &str = "<!-- begin: written by make licences -->\n";
const END: &str = "<!-- end -->\n";

/// Licences under which an SPDX expression lets us use the work, `None` where every alternative asks for another one.
/// expression = term { OR term }, term = factor { AND factor }, factor = ( expression ) | name [ WITH exception ]; OR was
/// once written as a slash.
fn used_under(expression: &str) -> Option<String> {
    let spaced = expression.replace('(', " ( ").replace(')', " ) ").replace('/', " OR ");
    let words: Vec<&str> = spaced.split_whitespace().collect();
    let mut at = 0;
    let used = alternatives(&words, &mut at);
    assert_eq!(at, words.len(), "licence expression {expression:?} cannot be read");
    used
}

fn alternatives(words: &[&str], at: &mut usize) -> Option<String> {
    let mut found = Vec::new();
    loop {
        found.extend(together(words, at));
        if words.get(*at) != Some(&"OR") {
            break;
        }
        *at += 1;
    }
    let rank = |used: &String| FREE.iter().position(|name| name == used).unwrap_or(FREE.len());
    found.into_iter().min_by_key(rank)
}

fn together(words: &[&str], at: &mut usize) -> Option<String> {
    let mut all = Some(BTreeSet::new());
    loop {
        let one = factor(words, at);
        all = all.zip(one).map(|(mut names, name)| {
            names.insert(name);
            names
        });
        if words.get(*at) != Some(&"AND") {
            break;
        }
        *at += 1;
    }
    all.map(|names| names.into_iter().collect::<Vec<_>>().join(" and "))
}

fn factor(words: &[&str], at: &mut usize) -> Option<String> {
    let word = words[*at];
    *at += 1;
    if word == "(" {
        let inner = alternatives(words, at);
        assert_eq!(words.get(*at), Some(&")"), "unbalanced brackets in a licence expression");
        *at += 1;
        return inner;
    }
    if words.get(*at) == Some(&"WITH") {
        *at += 2;
        return None;
    }
    FREE.contains(&word).then(|| word.to_string())
}

/// (name, version, licence expression) of what is linked: dependencies of the library on a target, by default this one, their
/// dependencies, without those that run only while the library is built.
fn linked_crates(target: &[&str]) -> BTreeSet<(String, String, String)> {
    let tree = Command::new(env!("CARGO"))
        .args([
            "tree",
            "--locked",
            "--offline",
            "--edges",
            "no-build,no-dev,no-proc-macro",
            "--prefix",
            "none",
        ])
        .args([
            "--no-dedupe",
            "--format",
            "{p}|{l}",
            "--manifest-path",
            concat!(env!("CARGO_MANIFEST_DIR"), "/Cargo.toml"),
        ])
        .args(target)
        .output()
        .expect("cargo tree");
    assert!(tree.status.success(), "{}", String::from_utf8_lossy(&tree.stderr));
    let text = String::from_utf8(tree.stdout).expect("names of crates");
    let lines = text.lines().filter(|line| !line.is_empty() && !line.starts_with("feti-contact "));
    lines
        .map(|line| {
            let (package, licence) = line.split_once('|').expect("name, version and licence");
            let mut words = package.split(' ');
            let mut word = || words.next().expect("name and version").trim_start_matches('v').to_string();
            (word(), word(), licence.to_string())
        })
        .collect()
}

fn table() -> String {
    let mut lines = String::from("| crate | version | licence | used under |\n|---|---|---|---|\n");
    for (name, version, licence) in linked_crates(&["--target", "x86_64-unknown-linux-gnu"]) {
        let used = used_under(&licence).unwrap_or_else(|| "none of ours".into());
        lines += &format!("| {name} | {version} | {licence} | {used} |\n");
    }
    lines
}

#[test]
fn every_linked_crate_may_be_used_in_a_gpl_2_only_host() {
    let crates = linked_crates(&[]);
    assert!(crates.iter().any(|(name, ..)| name == "faer"), "faer is linked, but was not found");
    let refused: Vec<_> = crates.iter().filter(|(_, _, licence)| used_under(licence).is_none()).collect();
    assert!(refused.is_empty(), "licences without an alternative among {FREE:?}: {refused:?}");
}

#[test]
fn the_table_of_the_documents_is_that_of_the_lock_file() {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("docs/licences.md");
    let text = fs::read_to_string(&path).expect("docs/licences.md");
    let (head, rest) = text.split_once(BEGIN).expect("the mark before the table");
    let (old, tail) = rest.split_once(END).expect("the mark after the table");
    let new = table();
    if env::var_os("LICENCES").is_some_and(|wish| wish == "write") {
        fs::write(&path, format!("{head}{BEGIN}{new}{END}{tail}")).expect("docs/licences.md");
        return;
    }
    assert_eq!(old, new, "docs/licences.md is out of date: make licences");
}

#[test]
fn an_expression_is_used_under_one_of_its_free_alternatives_only() {
    let cases = [
        ("MIT", Some("MIT")),
        ("Zlib OR Apache-2.0 OR MIT", Some("MIT")),
        ("Apache-2.0/BSD-3-Clause", Some("BSD-3-Clause")),
        ("(MIT OR Apache-2.0) AND Zlib", Some("MIT and Zlib")),
        ("Apache-2.0", None),
        ("Apache-2.0 WITH LLVM-exception OR ISC", Some("ISC")),
        ("Apache-2.0 WITH LLVM-exception", None),
        ("MIT AND Apache-2.0", None),
        ("MPL-2.0", None),
        ("(MIT AND MPL-2.0) OR GPL-2.0-only", None),
    ];
    for (expression, used) in cases {
        assert_eq!(used_under(expression).as_deref(), used, "{expression}");
    }
}
