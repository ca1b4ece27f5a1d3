//! What a function returns: the statuses of every call, and those that its text names with their reasons.

use crate::model::{Api, Constant, Function};

/// The constants of this file are statuses.
pub const FILE: &str = "header/status.rs";
/// A function with these words in its text returns what this one does, too.
const SETUP: (&str, &str) = ("feti_setup when it is due", "feti_setup");

/// The statuses of a function with the reason for each: one that its text gives goes before that of every call.
pub fn results(api: &Api, function: &Function) -> Vec<(String, String)> {
    let mut told = clauses(api, function);
    if let Some(setup) = api.functions.iter().find(|f| f.name == SETUP.1 && function.says(SETUP.0)) {
        told.extend(clauses(api, setup));
    }
    let general = of_every_call(api, function).into_iter().filter_map(|name| status(api, name));
    let general: Vec<_> = general.map(|constant| (constant.name.clone(), constant.doc.summary())).collect();
    let order: Vec<_> = general.iter().chain(&told).map(|(name, _)| name.clone()).collect();
    let mut results: Vec<(String, String)> = Vec::new();
    for name in order {
        if results.iter().all(|(listed, _)| *listed != name) {
            let mut reasons = told.iter().chain(&general);
            results.extend(reasons.find(|(found, _)| *found == name).cloned());
        }
    }
    let handle = function.arguments.first().and_then(|argument| argument.ty.target());
    let is_handle = handle.is_some_and(|ty| api.is_opaque(ty) || ty.target().is_some());
    if function.arguments.len() > usize::from(is_handle) {
        results.push(("FETI_ARGUMENT - k".to_string(), "Argument k is refused.".to_string()));
    }
    results
}

/// What a function may return whatever it does.
fn of_every_call(api: &Api, function: &Function) -> Vec<&'static str> {
    let mut names = vec!["FETI_OK"];
    let Some(handle) = function.arguments.first().and_then(|argument| argument.ty.target()) else {
        return names;
    };
    let (uses, moves) = (api.is_opaque(handle), handle.target().is_some());
    let creates = function.name == "feti_problem_create";
    if uses || moves {
        names.push("FETI_HANDLE");
    }
    if uses && !function.is_never_busy() {
        names.extend(["FETI_BUSY", "FETI_MEMORY"]);
    }
    if creates {
        names.push("FETI_MEMORY");
    }
    if uses && function.name != "feti_problem_error" || creates {
        names.push("FETI_INTERNAL");
    }
    names
}

fn status<'a>(api: &'a Api, name: &str) -> Option<&'a Constant> {
    api.constants.iter().find(|constant| constant.source == FILE && constant.name == name)
}

/// The statuses with which clauses of the text begin, the rest of the clause being the reason: "FETI_STATE before the first
/// solve." What other calls return stands inside a clause.
fn clauses(api: &Api, function: &Function) -> Vec<(String, String)> {
    let [before, _] = function.doc.paragraphs();
    let mut found = Vec::new();
    for clause in before.iter().flat_map(|text| text.split(". ")).flat_map(|text| text.split("; ")) {
        let (names, when) = begin(clause.trim_end_matches('.'));
        for constant in names.iter().filter_map(|name| status(api, name)) {
            let reason = if when.is_empty() { constant.doc.summary() } else { format!("{when}.") };
            found.push((constant.name.clone(), upper(&reason)));
        }
    }
    found
}

/// "FETI_A, FETI_B where it rains" -> the names, "where it rains".
fn begin(clause: &str) -> (Vec<&str>, &str) {
    let (mut names, mut rest) = (Vec::new(), clause);
    while rest.starts_with("FETI_") {
        let end = rest.find(|c: char| !c.is_ascii_uppercase() && c != '_').unwrap_or(rest.len());
        names.push(&rest[..end]);
        rest = &rest[end..];
        let mut more = [", ", " and ", " or "].iter().filter_map(|joint| rest.strip_prefix(joint));
        rest = more.find(|next| next.starts_with("FETI_")).unwrap_or(rest);
    }
    (names, rest.trim_start_matches([':', ',']).trim())
}

pub fn upper(text: &str) -> String {
    let first = text.chars().next().map(|c| c.to_ascii_uppercase());
    first.into_iter().chain(text.chars().skip(1)).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    const SOURCE: &str = "/// A problem.\n#[repr(C)] pub struct feti_problem { _private: [u8; 0] }\n\
        /// Prepares.\n///\n/// FETI_STATE without a body. FETI_IO, FETI_TIME and FETI_BAD.\n///\n\
        /// | argument | in/out | shape | rule |\n/// |---|---|---|---|\n/// | `p` | in | scalar | the handle |\n\
        #[no_mangle] pub extern \"C\" fn feti_setup(p: *mut feti_problem) -> i32 { 0 }\n\
        /// Reads.\n///\n/// Runs feti_setup when it is due; FETI_STATE without an answer. Another call returns FETI_TIME.\n///\n\
        /// | argument | in/out | shape | rule |\n/// |---|---|---|---|\n/// | `p` | in | scalar | the handle |\n\
        #[no_mangle] pub extern \"C\" fn feti_read(p: *mut feti_problem) -> i32 { 0 }\n";
    const STATUS: &str = "/// Done.\npub const FETI_OK: i32 = 0;\n/// No handle.\npub const FETI_HANDLE: i32 = -2;\n\
        /// Busy.\npub const FETI_BUSY: i32 = -3;\n/// Too early.\npub const FETI_STATE: i32 = -5;\n\
        /// A file.\npub const FETI_IO: i32 = -10;\n/// Late.\npub const FETI_TIME: i32 = 2;\n\
        /// None left.\npub const FETI_MEMORY: i32 = -1;\n/// A fault.\npub const FETI_INTERNAL: i32 = -11;\n";

    fn of(name: &str) -> Vec<(String, String)> {
        let sources = [("solve.rs", SOURCE), ("header/status.rs", STATUS)];
        let sources = sources.map(|(name, text)| (name.to_string(), text.to_string()));
        let api = crate::checked(&sources, [0, 1, 0]).unwrap();
        results(&api, api.functions.iter().find(|f| f.name == name).unwrap())
    }

    fn reason<'a>(results: &'a [(String, String)], name: &str) -> Option<&'a str> {
        results.iter().find(|(status, _)| status == name).map(|(_, when)| when.as_str())
    }

    #[test]
    fn statuses_come_with_the_reason_that_the_text_gives() {
        let setup = of("feti_setup");
        assert_eq!(reason(&setup, "FETI_STATE"), Some("Without a body."));
        assert_eq!(reason(&setup, "FETI_IO"), Some("A file."));
        for (name, when) in
            [("FETI_BUSY", "Busy."), ("FETI_MEMORY", "None left."), ("FETI_INTERNAL", "A fault.")]
        {
            assert_eq!(reason(&setup, name), Some(when));
        }
    }

    #[test]
    fn a_call_that_sets_up_has_the_statuses_of_the_setup_and_none_of_other_calls() {
        let read = of("feti_read");
        assert_eq!(reason(&read, "FETI_STATE"), Some("Without an answer."));
        assert!(reason(&read, "FETI_IO").is_some());
        assert_eq!(read.iter().filter(|(name, _)| name == "FETI_STATE").count(), 1);
    }
}
