//! Reference pages in Markdown: one for every function, one for structs, constants and callbacks, and a list of all.
//! They link to statuses.md, which tools/reference writes.

use std::collections::BTreeMap;
use std::fmt::Write;

use crate::c_types::{declared, prototype};
use crate::doc::Direction;
use crate::fortran;
use crate::model::{Api, Argument, Function};
use crate::order;
use crate::statuses;
use crate::typed::Signature;

const WIDTH: usize = 100;

/// How Fortran calls a function of C, by its name.
#[derive(Default)]
pub struct Faces {
    /// Signatures of the typed module.
    pub typed: BTreeMap<String, Vec<Signature>>,
    /// Statements of FORTRAN 77.
    pub f77: BTreeMap<String, Vec<String>>,
}

/// (file name, text) of every page.
pub fn print(api: &Api, faces: &Faces) -> Vec<(String, String)> {
    let mut pages = vec![("functions.md".to_string(), list(api)), ("types.md".to_string(), types(api))];
    for function in &api.functions {
        pages.push((format!("{}.md", function.name), page(api, faces, function)));
    }
    pages
}

/// Functions by sections, with their first sentences.
fn list(api: &Api) -> String {
    let mut out = "# Functions\n".to_string();
    for group in order::groups(api).iter().filter(|group| !group.functions.is_empty()) {
        let _ = write!(out, "\n## {}\n\n{}\n\n| function | does |\n|---|---|\n", group.heading, group.says);
        for function in &group.functions {
            let _ = writeln!(out, "| [{0}]({0}.md) | {1} |", function.name, cell(&function.doc.summary()));
        }
    }
    out
}

fn page(api: &Api, faces: &Faces, function: &Function) -> String {
    let [before, after] = function.doc.paragraphs();
    let mut out = format!("# {}\n", function.name);
    for paragraph in &before {
        let _ = write!(out, "\n{}\n", linked(api, function, paragraph));
    }
    let _ =
        write!(out, "\n## C\n\n```c\n#include <feti_contact.h>\n\n{};\n```\n", prototype(function, WIDTH));
    write_fortran(&mut out, api, faces, function);
    if !function.is_twin {
        write_arguments(&mut out, api, function);
        write_results(&mut out, api, function);
    }
    for paragraph in &after {
        let _ = write!(out, "\n{}\n", paragraph.replacen("Safety:", "**Safety.**", 1));
    }
    let _ = write!(out, "\nSource: `c/src/{}`\n", function.source);
    out
}

fn write_fortran(out: &mut String, api: &Api, faces: &Faces, function: &Function) {
    out.push_str("\n## Fortran\n");
    if let Some(signatures) = faces.typed.get(&function.name) {
        out.push_str("\n```fortran\nuse feti_contact\n");
        for signature in signatures {
            let _ = write!(out, "\n{}\n", signature.join("\n"));
        }
        out.push_str("```\n\nNumbers count from 1, sizes come from the arrays; without `stat` any status but FETI_OK ends the program. \
             As C has it:\n");
    }
    let interface = fortran::interface(api, function);
    let _ = write!(out, "\n```fortran\nuse feti_contact_c\n\n{}```\n", outdented(&interface));
    if let Some(calls) = faces.f77.get(&function.name) {
        let _ = write!(out, "\n## FORTRAN 77\n\n```fortran\n{}\n```\n\n", calls.join("\n"));
        out.push_str("Arguments and rules: [FORTRAN 77 hosts](../fortran77.md).\n");
    }
}

fn outdented(text: &str) -> String {
    let indent = text.lines().map(|line| line.len() - line.trim_start().len()).min().unwrap_or(0);
    text.lines().map(|line| format!("{}\n", &line[indent..])).collect()
}

fn write_arguments(out: &mut String, api: &Api, function: &Function) {
    if function.arguments.is_empty() {
        return;
    }
    out.push_str("\n## Arguments\n");
    write_table(out, &function.arguments, |rule| linked(api, function, rule));
}

fn write_table(out: &mut String, arguments: &[Argument], linked: impl Fn(&str) -> String) {
    out.push_str("\n| k | argument | in/out | shape | meaning, unit, rule |\n|---|---|---|---|---|\n");
    for (k, argument) in arguments.iter().enumerate() {
        let row = &argument.row;
        let (number, direction) = (k + 1, direction(row.direction));
        let _ = writeln!(
            out,
            "| {number} | `{}` | {direction} | {} | {} |",
            row.argument,
            cell(&row.shape),
            cell(&linked(&row.rule))
        );
    }
}

pub fn direction(direction: Direction) -> &'static str {
    match direction {
        Direction::In => "in",
        Direction::Out => "out",
        Direction::InOut => "in/out",
    }
}

fn write_results(out: &mut String, api: &Api, function: &Function) {
    if !function.has_status() {
        return;
    }
    out.push_str("\n## Status\n\n| status | when |\n|---|---|\n");
    for (status, when) in statuses::results(api, function) {
        let _ = writeln!(out, "| `{status}` | {} |", cell(&linked(api, function, &when)));
    }
    out.push_str("\nAfter a failure nothing is written or changed. All numbers: [statuses](statuses.md).\n");
}

/// Whether the page of types has a heading of this name.
fn is_described(api: &Api, name: &str) -> bool {
    api.structs.iter().any(|s| s.name == name) || api.callbacks.iter().any(|c| c.name == name)
}

/// Names of other functions, of structs and callbacks outside `code` become links to their pages.
fn linked(api: &Api, function: &Function, text: &str) -> String {
    let parts = text.split('`').enumerate().map(|(k, part)| {
        if k % 2 == 1 {
            return part.to_string();
        }
        let mut out = String::new();
        for word in part.split_inclusive(|c: char| !c.is_ascii_alphanumeric() && c != '_') {
            let name = word.trim_end_matches(|c: char| !c.is_ascii_alphanumeric() && c != '_');
            out.push_str(&match name {
                _ if name == function.name => name.to_string(),
                _ if api.functions.iter().any(|f| f.name == name) => format!("[{name}]({name}.md)"),
                _ if is_described(api, name) => format!("[{name}](types.md#{name})"),
                _ => name.to_string(),
            });
            out.push_str(&word[name.len()..]);
        }
        out
    });
    parts.collect::<Vec<_>>().join("`")
}

/// A text inside a table.
fn cell(text: &str) -> String {
    text.replace('|', "\\|")
}

fn types(api: &Api) -> String {
    let mut out = "# Structs, functions of the host, constants\n\n## Structs\n".to_string();
    let groups = order::groups(api);
    for structure in groups.iter().flat_map(|group| &group.structs) {
        let _ = write!(out, "\n### {}\n\n{}\n", structure.name, structure.doc.summary());
        let Some(fields) = &structure.fields else { continue };
        out.push_str("\n| member | meaning |\n|---|---|\n");
        for field in fields {
            let _ =
                writeln!(out, "| `{}` | {} |", declared(&field.ty, &field.name), cell(&field.doc.summary()));
        }
    }
    out.push_str("\n## Functions of the host\n");
    for callback in groups.iter().flat_map(|group| &group.callbacks) {
        let [before, _] = callback.doc.paragraphs();
        let arguments: Vec<_> = callback.arguments.iter().map(|a| declared(&a.ty, &a.name)).collect();
        let _ = write!(out, "\n### {}\n\n{}\n\n```c\n", callback.name, before.join("\n\n"));
        let _ = write!(out, "typedef int32_t (*{})({});\n```\n", callback.name, arguments.join(", "));
        write_table(&mut out, &callback.arguments, str::to_string);
    }
    out.push_str("\n## Constants\n\n| name | value | meaning |\n|---|---|---|\n");
    let constants = groups.iter().flat_map(|group| &group.constants);
    for constant in constants.filter(|constant| constant.source != statuses::FILE) {
        let meaning = cell(&constant.doc.summary());
        let _ = writeln!(out, "| `{}` | {} | {meaning} |", constant.name, constant.value);
    }
    out
}

#[cfg(test)]
mod tests {
    use super::*;

    const SOURCE: &str = "/// A problem.\n#[repr(C)] pub struct feti_problem { _private: [u8; 0] }\n\
        /// Nothing.\npub const FETI_EXACT: i32 = 0;\n\
        /// Adds `feti_clear`.\n///\n/// See feti_clear; FETI_STATE before. Not feti_problem.\n///\n\
        /// | argument | in/out | shape | rule |\n/// |---|---|---|---|\n/// | `p` | in | scalar | the handle |\n\
        /// | `x` | in | n | |x| <= 1, force |\n///\n/// # Safety\n/// Given.\n\
        #[no_mangle] pub unsafe extern \"C\" fn feti_add(p: *mut feti_problem, x: *const f64) -> i32 { 0 }\n\
        /// Clears. Never fails.\n#[no_mangle] pub extern \"C\" fn feti_clear() -> i32 { 0 }\n";
    const STATUS: &str =
        "/// Done.\npub const FETI_OK: i32 = 0;\n/// Bad.\npub const FETI_HANDLE: i32 = -2;\n\
        /// Busy.\npub const FETI_BUSY: i32 = -3;\n/// Too early.\npub const FETI_STATE: i32 = -5;\n";

    fn api() -> Api {
        let sources = [("rows.rs", SOURCE), ("header/status.rs", STATUS)];
        let sources = sources.map(|(name, text)| (name.to_string(), text.to_string()));
        crate::checked(&sources, [0, 1, 0]).unwrap()
    }

    fn pages() -> BTreeMap<String, String> {
        let signature = vec!["subroutine feti_add(p, x)".to_string()];
        let mut faces = Faces::default();
        faces.typed.insert("feti_add".to_string(), vec![signature]);
        faces.f77.insert("feti_add".to_string(), vec!["CALL FTADD(IP, IERR)".to_string()]);
        let (api, mut pages) = (api(), BTreeMap::new());
        pages.extend(print(&api, &faces));
        pages.extend(crate::man::print(&api, &faces));
        pages
    }

    #[test]
    fn a_page_has_all_languages_arguments_statuses_and_links() {
        let page = &pages()["feti_add.md"];
        for line in [
            "See [feti_clear](feti_clear.md); FETI_STATE before. Not [feti_problem](types.md#feti_problem).",
            "Adds `feti_clear`.",
            "int32_t feti_add(feti_problem *p, const double *x);",
            "subroutine feti_add(p, x)",
            "function feti_add(p, x) bind(C, name=\"feti_add\")",
            "```fortran\nCALL FTADD(IP, IERR)\n```",
            "| 2 | `x` | in | n | \\|x\\| <= 1, force |",
            "| `FETI_HANDLE` | Bad. |",
            "| `FETI_BUSY` | Busy. |",
            "| `FETI_STATE` | Before. |",
            "| `FETI_ARGUMENT - k` |",
            "**Safety.** Given.",
            "Source: `c/src/rows.rs`",
        ] {
            assert!(page.contains(line), "no `{line}` in\n{page}");
        }
    }

    #[test]
    fn a_function_that_never_fails_has_no_statuses() {
        let page = &pages()["feti_clear.md"];
        assert!(page.contains("int32_t feti_clear(void);") && !page.contains("## Status"), "{page}");
    }

    #[test]
    fn functions_are_listed_by_section_and_constants_without_statuses() {
        let pages = pages();
        assert!(
            pages["functions.md"].contains("## Other\n") && pages["functions.md"].contains("(feti_add.md)")
        );
        assert!(pages["types.md"].contains("| `FETI_EXACT` | 0 | Nothing. |"));
        assert!(!pages["types.md"].contains("FETI_BUSY"));
    }

    #[test]
    fn manual_pages_escape_what_roff_would_take_for_its_own() {
        let pages = pages();
        let page = &pages["man3/feti_add.3"];
        assert!(page.starts_with(".TH feti_add 3 ") && page.contains(".B FETI_ARGUMENT \\- k\n"), "{page}");
        assert!(pages["man7/feti_contact.7"].contains(".BR feti_clear (3)"));
        assert_eq!(crate::man::text(".x\n'y - \\z"), "\\&.x\n\\&'y \\- \\ez");
    }
}
