//! Every crate that is linked into the library may be used under MIT, BSD, ISC, Zlib, 0BSD or the Unlicense: a host that is
//! GPL-2-only can take no other (Apache-2.0 alone is refused). docs/licences.md holds the table, LICENSE-THIRD-PARTY the
//! texts, which whoever hands on a binary must hand on too; `make licences` writes both.

use std::collections::{BTreeMap, BTreeSet};
use std::env;
use std::fs;
use std::path::{Path, PathBuf};
use std::process::Command;

const FREE: [&str; 7] = ["MIT", "BSD-2-Clause", "BSD-3-Clause", "ISC", "Zlib", "0BSD", "Unlicense"];
const BEGIN: &str = "<!-- begin: written by make licences -->\n";
const END: &str = "<!-- end -->\n";
/// The processor whose crates are listed: it has most.
const TARGET: &str = "x86_64-unknown-linux-gnu";

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

/// (name, version, licence expression) of what is linked: dependencies of the library and of the program on a target, by default this one, their
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
        .args(["--package", "feti-contact-c", "--package", "feti-contact-program"])
        .args(target)
        .output()
        .expect("cargo tree");
    assert!(tree.status.success(), "{}", String::from_utf8_lossy(&tree.stderr));
    let text = String::from_utf8(tree.stdout).expect("names of crates");
    let lines = text.lines().filter(|line| !line.is_empty() && !line.starts_with("feti-contact"));
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
    for (name, version, licence) in linked_crates(&["--target", TARGET]) {
        let used = used_under(&licence).unwrap_or_else(|| "none of ours".into());
        lines += &format!("| {name} | {version} | {licence} | {used} |\n");
    }
    lines
}

/// Folders of the sources of all crates by name and version.
fn folders() -> BTreeMap<(String, String), PathBuf> {
    let metadata = Command::new(env!("CARGO"))
        .args(["metadata", "--locked", "--offline", "--format-version", "1", "--filter-platform", TARGET])
        .args(["--manifest-path", concat!(env!("CARGO_MANIFEST_DIR"), "/Cargo.toml")])
        .output()
        .expect("cargo metadata");
    assert!(metadata.status.success(), "{}", String::from_utf8_lossy(&metadata.stderr));
    let text = String::from_utf8(metadata.stdout).expect("paths");
    let manifests = text.split("\"manifest_path\":\"").skip(1).map(|rest| rest.split('"').next().unwrap());
    manifests
        .map(|manifest| {
            let folder = Path::new(manifest).parent().expect("a folder").to_path_buf();
            // ours may have the version of the workspace
            let value = |key| stated(&folder, key).next().unwrap_or_default();
            ((value("name = "), value("version = ")), folder)
        })
        .collect()
}

/// Values of lines of the manifest that begin with `key`.
fn stated(folder: &Path, key: &'static str) -> impl Iterator<Item = String> {
    let manifest = fs::read_to_string(folder.join("Cargo.toml")).expect("a manifest");
    let values = manifest.lines().filter_map(|line| line.strip_prefix(key));
    values.map(|value| value.trim_matches(['[', ']', '"']).to_string()).collect::<Vec<_>>().into_iter()
}

/// Licences and notices that a crate carries, without those that are not made use of.
fn texts(folder: &Path) -> Vec<String> {
    let is_wanted = |name: &str| {
        ["LICENSE", "LICENCE", "COPYING", "NOTICE"].iter().any(|begin| name.starts_with(begin))
            && !["APACHE", "ZLIB"].iter().any(|other| name.contains(other))
    };
    let entries = fs::read_dir(folder).expect("the sources of a crate");
    let mut files: Vec<PathBuf> = entries.map(|entry| entry.expect("a file").path()).collect();
    files.retain(|file| is_wanted(&file.file_name().unwrap_or_default().to_string_lossy().to_uppercase()));
    files.sort();
    let read = |file: &PathBuf| fs::read_to_string(file).expect("a licence").replace('\r', "");
    files.iter().map(read).map(|text| text.trim_matches('\n').to_string()).collect()
}

/// Every text once, after the crates that carry it; those without one, with their authors, at the end.
fn notices() -> String {
    let folders = folders();
    let (mut order, mut carriers) = (Vec::new(), BTreeMap::<String, Vec<String>>::new());
    let mut silent = String::new();
    for (name, version, licence) in linked_crates(&["--target", TARGET]) {
        let folder = &folders[&(name.clone(), version.clone())];
        let own = texts(folder);
        // What faer carries are the licences of others.
        if own.is_empty() || name == "faer" {
            let authors = stated(folder, "authors = ").next().unwrap_or_default();
            silent += &format!(
                "* {name} {version}, {licence}, {}\n",
                if authors.is_empty() { "its authors" } else { &authors }
            );
        }
        for text in own {
            let crates = carriers.entry(text.clone()).or_default();
            if crates.is_empty() {
                order.push(text);
            }
            crates.push(format!("{name} {version}"));
        }
    }
    let rule = "=".repeat(80);
    let mut all = String::from(HEAD);
    for text in order {
        all += &format!("{rule}\n{}\n{rule}\n\n{text}\n\n", carriers[&text].join(", "));
    }
    format!("{all}{rule}\n{WITHOUT}{rule}\n\n{silent}")
}

const HEAD: &str = "\
Licences of what is linked into libfeti_contact and feti-contact besides their own sources (written by make licences).
Part of every copy of the library in binary form, with LICENSE-MIT or LICENSE-APACHE. What is used under
which licence, and the source of the part under MPL-2.0: docs/licences.md.

The library also holds parts of the standard library of Rust, copyright The Rust Project Contributors, MIT OR
Apache-2.0: the text of MIT is below.

";
const WITHOUT: &str = "\
Crates that name their licence but carry no text of it: MIT as above, copyright by their authors
";

#[test]
fn the_texts_of_all_licences_are_those_of_the_crates() {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("LICENSE-THIRD-PARTY");
    let new = notices();
    if env::var_os("LICENCES").is_some_and(|wish| wish == "write") {
        fs::write(&path, new).expect("LICENSE-THIRD-PARTY");
        return;
    }
    let old = fs::read_to_string(&path).expect("LICENSE-THIRD-PARTY");
    assert!(old == new, "LICENSE-THIRD-PARTY is out of date: make licences");
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
