//! The typed Fortran modules: generic names, sizes from arrays, numbers from 1, `stat` and `errmsg`, from typed/table.
//! What has logic of its own is written by hand in typed/*.f90, which become parts of these modules, and in modules of
//! include/fortran.

use std::collections::BTreeMap;
use std::fmt::Write;
use std::path::Path;

use crate::doc::wrap;
use crate::fortran::{continued, write_doc, LINE_WIDTH};
use crate::model::Api;
use crate::order;
use crate::procedure::{self, Kind};
use crate::rules;

const TABLE: &str = include_str!("typed/table");
const WHOLE: &str = include_str!("typed/whole.f90");
const PARTS: [(&str, &str); 6] = [
    ("bodies", include_str!("typed/bodies.f90")),
    ("elements", include_str!("typed/elements.f90")),
    ("options", include_str!("typed/options.f90")),
    ("results", include_str!("typed/results.f90")),
    ("states", include_str!("typed/states.f90")),
    ("stiffness", include_str!("typed/stiffness.f90")),
];

/// A procedure of the table.
#[derive(Clone, Debug, Default)]
pub struct Entry {
    pub module: &'static str,
    pub generic: &'static str,
    /// The name in module feti_contact, if it is not feti_ and the generic name.
    face: Option<&'static str>,
    pub name: &'static str,
    pub by_hand: bool,
    pub arguments: Vec<&'static str>,
    pub function: &'static str,
    pub note: &'static str,
    /// (argument of C, condition, text)
    pub checks: Vec<(&'static str, &'static str, &'static str)>,
    /// (argument of C, value)
    pub given: Vec<(&'static str, &'static str)>,
    /// What describes a generic in place of the summary and the arguments of C.
    described: Option<&'static str>,
    paragraphs: Vec<&'static str>,
}

impl Entry {
    fn outside(&self) -> String {
        self.face.map_or(format!("feti_{}", self.generic), str::to_string)
    }

    /// The specific procedures: for integers of 4 and 8 bytes, or one.
    pub fn specifics(&self) -> Vec<(String, Option<Kind>)> {
        match self.name.strip_suffix('*') {
            Some(stem) => {
                [Kind::Int32, Kind::Int64].map(|kind| (format!("{stem}{}", kind.name()), Some(kind))).to_vec()
            }
            None => vec![(self.name.to_string(), None)],
        }
    }

    /// `NAME`, `WORD NAME`, both with or without arguments, before the function of C.
    fn read(module: &'static str, line: &'static str) -> Self {
        let (head, note) = line.split_once(": ").unwrap_or((line, ""));
        let (head, function) = head.rsplit_once(' ').expect("a line names a function of C");
        let (names, arguments) = head.split_once('(').unwrap_or((head, ""));
        let by_hand = names.ends_with(" by hand");
        let names = names.trim_end_matches(" by hand");
        let (generic, name) = names.split_once(' ').unwrap_or((names, names));
        let face = generic.split_once('=').map(|(_, face)| face);
        let plain = |name: &'static str| name.split('=').next().unwrap_or(name);
        let (generic, name) = (plain(generic), plain(name));
        let arguments = arguments.strip_suffix(')').unwrap_or(arguments).split(", ").collect();
        Entry { module, generic, face, name, by_hand, arguments, function, note, ..Entry::default() }
    }
}

/// The modules of the table, each with what it is about, and its procedures.
fn modules() -> Vec<(&'static str, &'static str, Vec<Entry>)> {
    let mut modules: Vec<(_, _, Vec<Entry>)> = Vec::new();
    for line in TABLE.lines().filter(|line| !line.is_empty() && !line.starts_with(['#', ':', '+'])) {
        if let Some(heading) = line.strip_prefix("module ") {
            let (name, about) =
                heading.split_once(": ").unwrap_or((heading.trim_end_matches(" by hand"), ""));
            modules.push((name, about, Vec::new()));
            continue;
        }
        let Some((module, _, entries)) = modules.last_mut() else { continue };
        let last = entries.last_mut();
        match (line.get(..4), last) {
            (Some("  ? "), Some(entry)) => {
                let (condition, text) = line[4..].split_once(": ").expect("condition and text");
                let (k, condition) = condition.split_once(' ').expect("number and condition");
                entry.checks.push((k, condition, text));
            }
            (Some("  = "), Some(entry)) => entry.given.extend(line[4..].split_once(' ')),
            (Some("  < "), Some(entry)) => entry.described = Some(&line[4..]),
            (Some("  > "), Some(entry)) => entry.paragraphs.push(&line[4..]),
            _ => entries.push(Entry::read(module, line)),
        }
    }
    modules
}

/// The members of a struct that count from 0 in C.
pub fn counted(structure: &str) -> Vec<&'static str> {
    let mut lists = TABLE.lines().filter_map(|line| line.strip_prefix(": ")?.split_once(' '));
    lists.find(|(name, _)| *name == structure).map_or(Vec::new(), |(_, members)| members.split(' ').collect())
}

/// (path, text) of every generated module.
pub fn print(api: &Api) -> Vec<(String, String)> {
    let generated = modules().into_iter().filter(|(_, about, _)| !about.is_empty());
    let texts = generated.map(|(name, about, entries)| {
        let known = entries
            .into_iter()
            .filter(|entry| api.functions.iter().any(|f| f.name == entry.function))
            .collect();
        (format!("include/fortran/feti_contact_{name}.f90"), module(api, name, about, known))
    });
    let whole = ("include/fortran/feti_contact.f90".to_string(), whole(api));
    texts.chain([whole]).collect()
}

/// Module feti_contact: what hosts use of the others, by their names.
fn whole(api: &Api) -> String {
    let constants = order::groups(api)
        .into_iter()
        .flat_map(|group| group.constants)
        .map(|constant| constant.name.clone());
    let versions = api.version_constants().map(|(name, _)| name.to_string());
    let mut lists = vec![("c", constants.chain(versions).collect::<Vec<_>>())];
    for (name, _, entries) in modules() {
        let known = known(api, entries);
        let mut names = procedure::types(api, &known);
        for entry in known {
            let name = format!("{} => {}", entry.outside(), entry.generic);
            if !names.contains(&name) {
                names.push(name);
            }
        }
        let more = TABLE.lines().skip_while(|line| !line.starts_with(&format!("module {name}"))).nth(1);
        names.extend(more.and_then(|line| line.strip_prefix("+ ")).map(str::to_string));
        lists.push((name, names));
    }
    let mut out =
        format!("! Generated by tools/bindgen from c/src and tools/bindgen/src/typed. Do not edit.\n{WHOLE}");
    for (module, names) in lists.iter().filter(|(_, names)| !names.is_empty()) {
        // A name stays with its arrow.
        let list = names.join(", ").replace(" => ", "=>");
        out.push_str(
            &continued("  ", &format!("use feti_contact_{module}, only: {list}")).replace("=>", " => "),
        );
    }
    out + "  implicit none\n  public\nend module\n"
}

fn known(api: &Api, entries: Vec<Entry>) -> Vec<Entry> {
    entries.into_iter().filter(|entry| api.functions.iter().any(|f| f.name == entry.function)).collect()
}

fn module(api: &Api, name: &str, about: &str, entries: Vec<Entry>) -> String {
    let mut out = format!(
        "! Generated by tools/bindgen from c/src and tools/bindgen/src/typed. Do not edit.\n\
         !> {about}, of module feti_contact. A host uses feti_contact, not this module.\n!>\n\
         !> feti_contact.h says more on each function. Everything counts from 1, sizes are taken from the arrays, and a failed call\n\
         !> changes nothing. `stat` and `errmsg`: see feti_contact_base.\n\
         module feti_contact_{name}\n  use, intrinsic :: iso_c_binding\n  \
         use, intrinsic :: iso_fortran_env, only: int32, int64, real64\n  use feti_contact_base\n  \
         use feti_contact_c, c_error_detail => feti_error_detail, c_option => feti_option, c_phase => feti_phase\n  implicit none\n  private\n"
    );
    let mut generics: Vec<&str> = Vec::new();
    for entry in &entries {
        if !generics.contains(&entry.generic) {
            generics.push(entry.generic);
        }
    }
    let types = procedure::types(api, &entries);
    let public: Vec<_> = generics.iter().copied().chain(types.iter().map(String::as_str)).collect();
    for line in wrap("  public :: ", "  public :: ", &public.join(", "), LINE_WIDTH) {
        let _ = writeln!(out, "{}", line.trim_end_matches(','));
    }
    let part = PARTS.iter().find(|(module, _)| *module == name).map_or("", |(_, text)| *text);
    let (specification, procedures) = part.split_once("contains\n").unwrap_or(("", part));
    out.push_str(specification);
    for generic in &generics {
        let of: Vec<_> = entries.iter().filter(|entry| entry.generic == *generic).collect();
        if of[0].name != *generic {
            write_interface(&mut out, api, generic, &of);
        }
    }
    out.push_str("\ncontains\n");
    for entry in entries.iter().filter(|entry| !entry.by_hand) {
        for (specific, kind) in entry.specifics() {
            out.push('\n');
            out.push_str(&procedure::text(api, entry, &specific, kind));
        }
    }
    if !procedures.is_empty() {
        let _ = write!(out, "\n{procedures}");
    }
    out + "\nend module\n"
}

fn write_interface(out: &mut String, api: &Api, generic: &str, entries: &[&Entry]) {
    out.push('\n');
    let parts = PARTS.iter().find(|(module, _)| *module == entries[0].module).map_or("", |(_, text)| *text);
    let described = entries[0].described;
    write_doc(
        out,
        "  ",
        &described.map_or_else(|| procedure::summary(api, entries[0].function), str::to_string),
    );
    out.push_str("  !>\n");
    for entry in entries {
        let dummies = match entry.by_hand {
            true => statement(parts, entry.name).map(|line| between(&line).to_string()).unwrap_or_default(),
            false => procedure::dummies(entry).join(", ") + ", stat, errmsg",
        };
        let call = format!(
            "call {}({}): {}",
            entry.outside(),
            dummies.trim_end_matches(", stat, errmsg"),
            entry.note
        );
        for line in wrap("  !> ", "  !>   ", &call, LINE_WIDTH) {
            let _ = writeln!(out, "{line}");
        }
    }
    let arguments = rules::described(api, entries).filter(|_| described.is_none());
    for paragraph in
        arguments.iter().map(String::as_str).chain(entries.iter().flat_map(|e| e.paragraphs.iter().copied()))
    {
        out.push_str("  !>\n");
        write_doc(out, "  ", paragraph);
    }
    let names: Vec<_> = entries.iter().flat_map(|entry| entry.specifics()).map(|(name, _)| name).collect();
    let _ =
        writeln!(out, "  interface {generic}\n    module procedure {}\n  end interface", names.join(", "));
}

/// The statement that begins a procedure of a source, `recursive subroutine name(...)`, continued lines joined.
fn statement(text: &str, name: &str) -> Option<String> {
    let at =
        ["subroutine ", "function "].iter().find_map(|keyword| text.find(&format!("{keyword}{name}(")))?;
    let start = text[..at].rfind('\n').map_or(0, |end| end + 1);
    let end = start + text[start..].find('\n')?;
    Some(text[start..end].trim().trim_start_matches("recursive ").to_string())
}

fn between(statement: &str) -> &str {
    statement.split_once('(').map_or("", |(_, rest)| rest.split(')').next().unwrap_or(""))
}

/// A subroutine or function as the host sees it: the statement and the declarations of its arguments, a line each.
pub type Signature = Vec<String>;

/// For every function of C the procedures that call it. `root` has the modules that are written by hand.
pub fn signatures(api: &Api, root: &Path) -> BTreeMap<String, Vec<Signature>> {
    let mut found: BTreeMap<String, Vec<Signature>> = BTreeMap::new();
    let read = |module: &str| {
        std::fs::read_to_string(root.join(format!("include/fortran/feti_contact_{module}.f90")))
    };
    let base = read("base").unwrap_or_default();
    for (module, _, entries) in modules() {
        let Ok(text) = read(module) else { continue };
        for entry in known(api, entries) {
            for (specific, kind) in entry.specifics() {
                let function = match kind {
                    Some(Kind::Int64) => entry.function.replace("_i32", "_i64"),
                    _ => entry.function.to_string(),
                };
                let mut shown = signature(&text, &entry, &specific).unwrap_or_default();
                let taken =
                    shown.iter().find_map(|line| line.trim().strip_prefix("procedure(")?.split(')').next());
                if let Some(interface) = taken.and_then(|name| abstract_interface(&base, name)) {
                    shown.push(String::new());
                    shown.extend(interface);
                }
                found.entry(function).or_default().push(shown);
            }
        }
    }
    found
}

/// The head of a procedure up to its first empty line, without what is local.
fn signature(text: &str, entry: &Entry, specific: &str) -> Option<Signature> {
    let statement = statement(text, specific)?;
    let names: Vec<_> = between(&statement).split(", ").collect();
    let at = text
        .find(&format!("subroutine {specific}("))
        .or_else(|| text.find(&format!("function {specific}(")))?;
    let head =
        text[at..].lines().skip(1).take_while(|line| !line.is_empty() && !line.trim().starts_with("end "));
    let declared = head.filter(|line| {
        let first =
            line.split_once(":: ").map_or("", |(_, list)| list.split([',', '(', ' ']).next().unwrap_or(""));
        names.contains(&first)
    });
    let outside = statement.replacen(&format!("{specific}("), &format!("{}(", entry.outside()), 1);
    Some(std::iter::once(outside).chain(declared.map(|line| format!("  {}", line.trim()))).collect())
}

/// The interface of a function of the host.
fn abstract_interface(text: &str, name: &str) -> Option<Signature> {
    let start = text.find(&format!("integer function {name}("))?;
    let lines = text[start..].lines().map(str::trim).take_while(|line| !line.starts_with("end "));
    let lines = lines.filter(|line| !line.starts_with("import"));
    Some(lines.enumerate().map(|(k, line)| format!("{}{line}", if k > 0 { "  " } else { "" })).collect())
}
