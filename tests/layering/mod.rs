//! The arrows between the layers, and what no source of the library may contain:
//!
//! ```text
//! numbers, error <- platform <- ranks <- linalg <- mesh, surface, body, constraints <- dual, certificate <- model <- setup <- solve <- solver <- c
//!                      linalg <- qp <- progress <- setup
//! ```
//!
//! Layers are the folders of src; c and paper, which stands on qp and solver, are crates of their own.
//!
//! No modules of one folder import each other in a circle, in tests, benches, decks and tools either; faer is known to linalg
//! only; nothing prints; nothing panics but the fault a host may ask for; no file is longer than 400 lines.

mod circles;
pub mod source;

use std::collections::BTreeSet;
use std::fs;
use std::path::{Path, PathBuf};

use source::{line_of, occurrences, paths, test_modules, test_ranges, without_text, words, Named};

/// What each layer may name; every layer may name itself.
const ALLOWED: [(&str, &[&str]); 22] = [
    ("error", &[]),
    ("numbers", &[]),
    ("platform", &["error"]),
    ("ranks", &["error", "platform"]),
    ("linalg", &["error", "numbers", "platform", "ranks"]),
    ("mesh", &["error", "numbers", "platform", "linalg"]),
    ("surface", &["error", "numbers", "platform", "linalg"]),
    ("body", &["error", "numbers", "platform", "ranks", "linalg"]),
    ("serving", &["error", "platform", "ranks", "body", "certificate", "solve"]),
    ("constraints", &["error", "numbers", "platform", "linalg"]),
    ("dual", &["error", "numbers", "platform", "linalg", "body", "constraints"]),
    ("qp", &["error", "numbers", "platform", "linalg"]),
    ("certificate", &["error", "numbers", "platform", "linalg", "body", "constraints"]),
    ("model", &["error", "numbers", "platform", "linalg", "mesh", "surface", "body", "constraints"]),
    ("decomposition", &["error", "numbers", "platform", "linalg", "mesh", "body", "constraints", "model"]),
    ("gathering", &["error", "platform", "linalg", "body", "constraints", "model"]),
    ("progress", &["error", "numbers", "platform", "qp"]),
    (
        "setup",
        &[
            "error",
            "numbers",
            "platform",
            "linalg",
            "body",
            "constraints",
            "dual",
            "qp",
            "certificate",
            "model",
            "progress",
        ],
    ),
    (
        "solve",
        &[
            "error",
            "numbers",
            "platform",
            "linalg",
            "body",
            "constraints",
            "dual",
            "qp",
            "certificate",
            "model",
            "progress",
            "setup",
        ],
    ),
    (
        "solver",
        &[
            "error",
            "numbers",
            "platform",
            "linalg",
            "mesh",
            "surface",
            "body",
            "constraints",
            "dual",
            "qp",
            "certificate",
            "model",
            "decomposition",
            "gathering",
            "progress",
            "setup",
            "solve",
            "ranks",
            "serving",
        ],
    ),
    ("paper", &["error", "linalg", "qp", "solver"]),
    ("c", &["error", "platform", "solver"]),
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
const INJECTED: (&str, &str) = ("c/src/solve.rs", "panic!");

/// What makes one slice of the unknowns of an island, brings their values from the bodies, or reads K of the model, which another rank may
/// have: solve and certificate see the answers to questions, except where K of all bodies is factorised.
const OF_BODIES: [&str; 6] =
    ["in_sequence", "ByBody::of(", ".unknowns()", ".bring(", "].body.k()", "].body.stiffness"];
const IN_ONE_PLACE: &str = "src/solve/sparse_face.rs";
/// What is brought for the host: u of the answer, and motions that prove something.
const FOR_THE_HOST: [&str; 4] =
    ["src/solve/island.rs", "src/solve/case.rs", "src/solve/negative.rs", "src/solve/diagnosis/loads.rs"];

const LONGEST: usize = 400;

/// Where the crates have their sources.
const CRATES: [&str; 3] = ["src", "c/src", "paper/src"];

/// The sources of tools, decks and fuzz targets, the subjects of tests, and every folder of tests and benches that is a program.
fn others() -> Vec<String> {
    let root = Path::new(env!("CARGO_MANIFEST_DIR"));
    let folders = |of: &str| {
        fs::read_dir(root.join(of)).unwrap().map(|entry| entry.unwrap().path()).collect::<Vec<_>>()
    };
    let programs =
        ["benches", "tests"].into_iter().flat_map(folders).filter(|folder| folder.join("main.rs").exists());
    let tools = folders("tools").into_iter().map(|tool| tool.join("src")).filter(|src| src.exists());
    let named = ["decks/src", "fuzz/src", "tests"].map(|folder| root.join(folder));
    let relative = |path: PathBuf| path.strip_prefix(root).unwrap().to_str().unwrap().to_owned();
    programs.chain(tools).chain(named).map(relative).collect()
}

/// All faults of one source.
fn faults(path: &str, text: &str) -> Vec<String> {
    let code = without_text(text);
    let mut found = Vec::new();
    let mut report = |at: usize, what: String| found.push(format!("{path}:{}: {what}", line_of(&code, at)));
    let layer = layer_of(path);
    let is_crate = !path.starts_with("src/");
    for Named { at, through_super, path, .. } in
        paths(path, &code).into_iter().filter(|n| n.of_library == is_crate)
    {
        let named = path.first().map_or("*", String::as_str);
        if !may_name(layer, named) {
            report(
                at,
                match through_super {
                    true => format!("{layer} must not use {named}, reached through super"),
                    false => format!("{layer} must not use crate::{named}"),
                },
            );
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
    if ["solve", "certificate"].contains(&layer) && path != IN_ONE_PLACE {
        let told = |token: &str| token == ".bring(" && FOR_THE_HOST.contains(&path);
        for token in OF_BODIES.iter().filter(|token| !told(token)) {
            let outside = |at: &usize| !tests.iter().any(|range| range.contains(at));
            let found = occurrences(&code, token).filter(outside);
            found.for_each(|at| report(at, format!("{token}: what belongs to bodies, outside the tests")));
        }
    }
    let lines = text.lines().count();
    if lines > LONGEST {
        found.push(format!("{path}:{lines}: longer than {LONGEST} lines"));
    }
    // names of one list in braces
    found.dedup();
    found
}

/// `src/qp/face.rs` -> `qp`, `src/error.rs` -> `error`, `c/src/solve.rs` -> `c`.
fn layer_of(path: &str) -> &str {
    let path = path.strip_prefix("src/").unwrap_or(path);
    path.split('/').next().unwrap_or(path).trim_end_matches(".rs")
}

/// Names that are no layer, `*` and `self` among them, may be used by nobody: they would hide what is meant.
fn may_name(layer: &str, named: &str) -> bool {
    let allowed = ALLOWED.iter().find(|(name, _)| *name == layer);
    allowed.is_some_and(|(own, below)| *own == named || below.contains(&named))
}

/// All sources below `folder`, by name; folders in it that are programs or packages are left out.
fn sources(folder: &Path) -> Vec<PathBuf> {
    let mut files = Vec::new();
    for entry in fs::read_dir(folder).unwrap() {
        let path = entry.unwrap().path();
        if path.is_dir() {
            let apart = ["main.rs", "Cargo.toml"].iter().any(|file| path.join(file).exists());
            files.extend(if apart { Vec::new() } else { sources(&path) });
        } else if path.extension().is_some_and(|extension| extension == "rs") {
            files.push(path);
        }
    }
    files.sort();
    files
}

/// All sources of a crate by their path, and those that exist in tests only.
pub fn crate_in(folder: &str) -> (Vec<(String, String)>, BTreeSet<String>) {
    let root = Path::new(env!("CARGO_MANIFEST_DIR"));
    let (mut all, mut only_tests) = (Vec::new(), BTreeSet::new());
    for file in sources(&root.join(folder)) {
        let path = file.strip_prefix(root).unwrap().to_str().unwrap().replace('\\', "/");
        let text = fs::read_to_string(&file).unwrap();
        let folder =
            ["/mod.rs", "/lib.rs", ".rs"].iter().find_map(|end| path.strip_suffix(end)).unwrap_or(&path);
        only_tests
            .extend(test_modules(&without_text(&text)).iter().map(|name| format!("{folder}/{name}.rs")));
        all.push((path, text));
    }
    assert!(!all.is_empty(), "no sources were found in {folder}");
    // whatever lies below a module of tests is one
    let is_test = |path: &str| {
        path.match_indices('/').any(|(at, _)| only_tests.contains(&format!("{}.rs", &path[..at])))
            || only_tests.contains(path)
    };
    let tests = all.iter().map(|(path, _)| path).filter(|path| is_test(path)).cloned().collect();
    (all, tests)
}

#[test]
fn the_sources_keep_to_their_layers() {
    let (all, tests): (Vec<_>, Vec<_>) = CRATES.map(crate_in).into_iter().unzip();
    let exempt = |path: &String, fault: &String| {
        tests.iter().any(|tests| tests.contains(path)) && fault.ends_with("outside the tests")
    };
    let found: Vec<String> = (all.concat().iter().filter(|(path, _)| path != "src/lib.rs"))
        .flat_map(|(path, text)| faults(path, text).into_iter().filter(|fault| !exempt(path, fault)))
        .collect();
    assert!(found.is_empty(), "{}", found.join("\n"));
}

#[test]
fn no_modules_of_a_folder_import_each_other_in_a_circle() {
    let others = others();
    assert!(others.len() > 10 && crate_in("tests").0.len() > 100, "{others:?}");
    for folder in CRATES.into_iter().chain(others.iter().map(String::as_str)) {
        let (all, tests) = crate_in(folder);
        let all = all.into_iter().filter(|(path, _)| !tests.contains(path));
        let within = |path: String| path[folder.len() + 1..].to_owned();
        let all: Vec<_> = all.map(|(path, text)| (within(path), without_text(&text))).collect();
        assert_eq!(circles::circles(&all), [""; 0], "{folder}");
    }
}

/// docs/pictures/layers.svg has each layer by its name, at a height.
#[test]
fn the_picture_shows_every_layer_above_those_that_it_uses() {
    let picture = concat!(env!("CARGO_MANIFEST_DIR"), "/docs/pictures/layers.svg");
    let picture = fs::read_to_string(picture).unwrap();
    let height = |layer: &str| -> f64 {
        let named = format!(">{layer}</text>");
        let text =
            picture.lines().find(|line| line.ends_with(&named)).unwrap_or_else(|| panic!("no {layer}"));
        text.split("y=\"").nth(1).and_then(|rest| rest.split('"').next()).unwrap().parse().unwrap()
    };
    for (layer, below) in ALLOWED {
        for used in below {
            assert!(height(layer) < height(used), "{layer} is drawn below {used}");
        }
    }
}

#[test]
fn an_upward_or_sideways_import_is_named_with_its_line() {
    let upward = "//! crate::solver in a comment\nuse crate::error::Result;\nuse crate::solver::Problem;\n";
    assert_eq!(faults("src/qp/steps.rs", upward), ["src/qp/steps.rs:3: qp must not use crate::solver"]);
    let list = "use crate::{\n    error::{Error, Kind},\n    linalg::Csr,\n    constraints,\n};\n";
    assert_eq!(faults("src/body/mod.rs", list), ["src/body/mod.rs:1: body must not use crate::constraints"]);
    let inline = "fn f() {\n    let x = crate :: dual::Dual::new();\n}\n";
    assert_eq!(
        faults("src/certificate/entry.rs", inline),
        ["src/certificate/entry.rs:2: certificate must not use crate::dual"]
    );
    let of_c = "use crate::boundary::call;\nuse feti_contact::{solver::Problem, dual};\n";
    assert_eq!(faults("c/src/solve.rs", of_c), ["c/src/solve.rs:2: c must not use crate::dual"]);
    assert_eq!(faults("src/error.rs", "use crate::*;"), ["src/error.rs:1: error must not use crate::*"]);
    assert!(faults("src/solver/solve.rs", "use crate::{qp, dual::Dual};").is_empty());
    assert!(faults(
        "src/qp/mod.rs",
        "/* crate::solver /* nested */ */ const A: &str = r#\"crate::solver\"#;"
    )
    .is_empty());
}

#[test]
fn a_way_around_through_super_is_seen() {
    let around = ["src/qp/steps.rs:1: qp must not use dual, reached through super"];
    assert_eq!(faults("src/qp/steps.rs", "use super::super::dual::Dual;"), around);
    assert!(faults("src/qp/steps.rs", "use super::dual;").is_empty(), "a module qp::dual");
    assert_eq!(faults("src/qp/mod.rs", "use super::{body, linalg};").len(), 1);
    assert!(faults("src/qp/mod.rs", "mod tests {\n    use super::body;\n}").is_empty(), "a module qp::body");
    assert_eq!(faults("src/qp/mod.rs", "mod tests {\n    use super::super::body;\n}").len(), 1);
}

#[test]
fn what_belongs_to_bodies_is_seen_in_solve_and_certificate() {
    let slice = "fn f(u: &ByBody) -> f64 {\n    u.in_sequence()[3]\n}\n";
    let fault = "2: in_sequence: what belongs to bodies, outside the tests";
    for path in ["src/solve/held.rs", "src/certificate/field.rs"] {
        assert_eq!(faults(path, slice), [format!("{path}:{fault}")]);
    }
    assert!(faults(IN_ONE_PLACE, slice).is_empty() && faults("src/setup/ready.rs", slice).is_empty());
    let read = "fn f(model: &SolvedModel) {\n    model.bodies[0].body.k();\n}\n";
    assert_eq!(faults("src/solve/case.rs", read).len(), 1);
    let brought = "fn f() {\n    bodies.bring(&u)?;\n}\n";
    assert_eq!(faults("src/solve/held.rs", brought).len(), 1);
    assert!(FOR_THE_HOST.iter().all(|path| faults(path, brought).is_empty()));
}

#[test]
fn faer_prints_panics_and_long_files_are_seen() {
    assert_eq!(faults("src/body/mod.rs", "use faer::Mat;"), ["src/body/mod.rs:1: faer outside linalg"]);
    assert!(faults("src/linalg/dense/pivoted.rs", "use faer::Mat;").is_empty());
    assert!(faults("src/body/mod.rs", "fn f() {} // faer").is_empty());
    for call in FORBIDDEN {
        let line = format!("fn f<'a>(x: &'a str) {{ let c = '\"'; {call}); }}\n");
        assert_eq!(
            faults("src/dual/mod.rs", &line),
            [format!("src/dual/mod.rs:1: {call} outside the tests")]
        );
        let tested = format!("fn f() {{}}\n#[cfg(test)]\nmod tests {{ fn g() {{ {call}); }} }}\n");
        assert!(faults("src/dual/mod.rs", &tested).is_empty(), "{call}");
        assert_eq!(faults("src/dual/mod.rs", &format!("{tested}fn h() {{ {call}); }}")).len(), 1, "{call}");
    }
    let fault = "fn f() { panic!(\"on request\"); }";
    assert!(faults("c/src/solve.rs", fault).is_empty());
    assert_eq!(faults("c/src/solve.rs", &format!("{fault}\n{fault}")).len(), 1);
    assert_eq!(faults("c/src/rows.rs", fault).len(), 1);
    assert!(faults("src/qp/mod.rs", &"\n".repeat(400)).is_empty());
    assert_eq!(faults("src/qp/mod.rs", &"\n".repeat(401)).len(), 1);
}
