//! Modules of one folder that import each other in a circle. A name that a folder hands on (`pub use`) counts as the module it comes
//! from; what stands in `mod.rs` itself is a module of the folder, too; tests are left out.

use std::collections::{BTreeMap, BTreeSet};

use crate::layering::source::{expanded, module_of, paths, test_ranges, words, Named, Renamed};

/// Of every folder the names it hands on, each with the module it comes from.
type HandedOn = BTreeMap<Vec<String>, BTreeMap<String, Vec<String>>>;

/// Of every folder the modules in circles: `solver: log watch`.
pub fn circles(sources: &[(String, String)]) -> Vec<String> {
    let modules: BTreeSet<Vec<String>> = sources.iter().map(|(path, _)| module_of(path)).collect();
    let parents: BTreeSet<&[String]> =
        modules.iter().filter(|m| !m.is_empty()).map(|m| &m[..m.len() - 1]).collect();
    let handed_on: HandedOn = sources
        .iter()
        .map(|(path, code)| (module_of(path), handed_on(&module_of(path), code, &modules)))
        .collect();
    let mut found = Vec::new();
    for folder in parents {
        let arrows = arrows(folder, &modules, &handed_on, sources);
        found.extend(knots(&arrows).iter().map(|knot| format!("{}: {}", folder.join("/"), knot.join(" "))));
    }
    found
}

/// Which module of the folder names which others of it.
fn arrows(
    folder: &[String],
    modules: &BTreeSet<Vec<String>>,
    handed_on: &HandedOn,
    sources: &[(String, String)],
) -> BTreeMap<String, BTreeSet<String>> {
    let mut arrows: BTreeMap<String, BTreeSet<String>> = BTreeMap::new();
    for (path, code) in sources {
        let module = module_of(path);
        let Some(rest) = module.strip_prefix(folder) else { continue };
        let from = rest.first().map_or("mod", String::as_str);
        let named = named(path, code, !rest.is_empty()).filter_map(|path| {
            let path = resolved(path, modules, handed_on);
            let name = path.strip_prefix(folder)?.first()?.clone();
            Some(if modules.contains(&path[..=folder.len()]) { name } else { "mod".into() })
        });
        arrows.entry(from.to_owned()).or_default().extend(named.filter(|to| to != from));
    }
    arrows
}

/// The path with the modules in it that hand the name on from one to the next.
fn resolved(mut path: Vec<String>, modules: &BTreeSet<Vec<String>>, handed_on: &HandedOn) -> Vec<String> {
    for at in 0.. {
        let Some(name) = path.get(at) else { break };
        let from = handed_on.get(&path[..at]).and_then(|names| names.get(name));
        if let Some(from) = from.filter(|_| !modules.contains(&path[..=at])).cloned() {
            path.splice(at..at, from);
        }
    }
    path
}

/// Where the names come from that the folder has by `use child::...`.
fn handed_on(
    folder: &[String],
    code: &str,
    modules: &BTreeSet<Vec<String>>,
) -> BTreeMap<String, Vec<String>> {
    let mut names = BTreeMap::new();
    for path in uses(code) {
        let from = usize::from(path.first().is_some_and(|first| first == "self"));
        if let [through @ .., name] = &path[from..] {
            if !through.is_empty() && modules.contains(&[folder, &through[..1]].concat()) {
                names.insert(name.clone(), through.to_vec());
            }
        }
    }
    names
}

/// All paths outside the tests, from the root. The names a folder hands on are no arrows of its own: where `own_uses` is not wanted,
/// `use` is left out.
fn named(file: &str, code: &str, own_uses: bool) -> impl Iterator<Item = Vec<String>> {
    let tests = test_ranges(code);
    let of_use: Vec<_> = words(code, "use").map(|at| at..end_of_use(code, at)).collect();
    let outside = move |named: &Named| {
        !named.of_library
            && !tests.iter().any(|range| range.contains(&named.at))
            && (own_uses || !of_use.iter().any(|range| range.contains(&named.at)))
    };
    paths(file, code).into_iter().filter(outside).map(|named| named.path)
}

/// The paths of all `use` declarations, outside the tests.
fn uses(code: &str) -> Vec<Vec<String>> {
    let tests = test_ranges(code);
    let declared = words(code, "use").filter(|at| !tests.iter().any(|range| range.contains(at)));
    declared.flat_map(|at| expanded(code[at + 3..].trim_start(), Renamed::AsItIs)).collect()
}

fn end_of_use(code: &str, at: usize) -> usize {
    code[at..].find(';').map_or(code.len(), |end| at + end)
}

/// Sets of modules that reach each other.
fn knots(arrows: &BTreeMap<String, BTreeSet<String>>) -> Vec<Vec<String>> {
    let reached = |from: &String| {
        let (mut seen, mut next) = (BTreeSet::new(), vec![from]);
        while let Some(at) = next.pop() {
            next.extend(arrows.get(at).into_iter().flatten().filter(|to| seen.insert((*to).clone())));
        }
        seen
    };
    let all: BTreeMap<&String, BTreeSet<String>> = arrows.keys().map(|from| (from, reached(from))).collect();
    let together = |from: &String| -> Vec<String> {
        all[from].iter().filter(|to| all.get(to).is_some_and(|back| back.contains(from))).cloned().collect()
    };
    let knots: BTreeSet<Vec<String>> = arrows.keys().map(together).filter(|knot| knot.len() > 1).collect();
    knots.into_iter().collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn of(sources: &[(&str, &str)]) -> Vec<String> {
        let sources: Vec<_> =
            sources.iter().map(|(path, code)| (path.to_string(), code.to_string())).collect();
        circles(&sources)
    }

    #[test]
    fn a_circle_is_seen_however_it_is_written() {
        let a = ("qp/a.rs", "use crate::qp::b::{B, C};");
        for b in [
            "use crate::qp::a::A;",
            "use super::a::A;",
            "use super::{c, a};",
            "use crate::{error, qp::{a as x, d}};",
            "fn f() { crate::qp::a::f(); }",
            "use crate::qp::Handed;",
            "use crate::qp::Renamed;",
        ] {
            let folder =
                ("qp/mod.rs", "mod a; mod b; pub use a::Handed; pub(crate) use self::a::{Old as Renamed};");
            assert_eq!(of(&[folder, a, ("qp/b.rs", b)]), ["qp: a b"], "{b}");
        }
    }

    #[test]
    fn a_circle_of_three_through_folders_is_one() {
        let sources = [
            ("lib.rs", "mod x;"),
            ("x/mod.rs", "mod a; mod b; mod c;"),
            ("x/a/mod.rs", "mod inner;"),
            ("x/a/inner.rs", "use crate::x::b::B;"),
            ("x/b.rs", "use super::c;"),
            ("x/c.rs", "use crate::x::a::A;"),
        ];
        assert_eq!(of(&sources), ["x: a b c"]);
    }

    #[test]
    fn a_name_that_comes_through_several_folders_is_that_of_its_module() {
        let sources = [
            ("x/mod.rs", "mod y; mod c; pub use y::A; pub use y::b::B;"),
            ("x/y/mod.rs", "mod a; mod b; pub use a::A;"),
            ("x/y/a.rs", "use crate::x::B;"),
            ("x/y/b.rs", "use crate::x::{c, A};"),
            ("x/c.rs", ""),
        ];
        assert_eq!(of(&sources), ["x/y: a b"]);
    }

    #[test]
    fn what_stands_in_mod_rs_is_a_module_and_tests_are_none() {
        let parent = ("x/mod.rs", "mod a; pub struct P; fn f() { self::a::g(); }");
        assert_eq!(of(&[parent, ("x/a.rs", "use super::P;")]), ["x: a mod"]);
        let only_names = ("x/mod.rs", "mod a; pub use a::A; pub struct P;");
        assert!(of(&[only_names, ("x/a.rs", "use super::P;")]).is_empty());
        let tests = "use super::P;\n#[cfg(test)]\nmod tests { use crate::x::b::B; }";
        let sources = [only_names, ("x/a.rs", tests), ("x/b.rs", "use super::A;")];
        assert!(of(&sources).is_empty(), "only a test looks back");
    }

    #[test]
    fn one_way_is_no_circle() {
        assert!(of(&[("x/mod.rs", "mod a; mod b;"), ("x/a.rs", "use super::b;"), ("x/b.rs", "")]).is_empty());
    }
}
