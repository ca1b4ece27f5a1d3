//! `feti-reference DIR` writes options.md and statuses.md, as the library that runs lists them through its C functions.

use std::ffi::{c_char, CStr};
use std::fmt::Write;
use std::path::Path;
use std::process::ExitCode;

use feti_contact_c::{
    feti_option, feti_option_at, feti_option_count, feti_status_name, feti_status_text, FETI_ARGUMENT,
    FETI_OK, FETI_OPTION_F64, FETI_OPTION_I64,
};

/// Numbers among which the statuses are looked for; every refused argument has the name of FETI_ARGUMENT.
const STATUSES: std::ops::RangeInclusive<i32> = FETI_ARGUMENT..=99;
/// From here on a bound of an option is none.
const NO_LIMIT: f64 = 1e300;

fn main() -> ExitCode {
    let Some(folder) = std::env::args().nth(1) else {
        eprintln!("usage: feti-reference DIR");
        return ExitCode::FAILURE;
    };
    let folder = Path::new(&folder);
    let write = |name: &str, text: String| std::fs::write(folder.join(name), text);
    let written = std::fs::create_dir_all(folder)
        .and_then(|()| write("options.md", options()))
        .and_then(|()| write("statuses.md", statuses()));
    match written {
        Ok(()) => ExitCode::SUCCESS,
        Err(error) => {
            eprintln!("feti-reference: {}: {error}", folder.display());
            ExitCode::FAILURE
        }
    }
}

fn options() -> String {
    let mut out =
        "# Options\n\n| name | type | default | range | meaning |\n|---|---|---|---|---|\n".to_string();
    for option in (0..feti_option_count()).filter_map(option) {
        let (name, doc) = (text(option.name), text(option.doc));
        let [ty, default, range] = columns(&option);
        let _ = writeln!(out, "| `{name}` | {ty} | {default} | {range} | {} |", cell(&doc));
    }
    out
}

fn option(k: i64) -> Option<feti_option> {
    // SAFETY: all zero is a valid value of numbers and pointers.
    let mut option: feti_option = unsafe { std::mem::zeroed() };
    option.struct_size = size_of::<feti_option>() as i64;
    // SAFETY: the size is set.
    (unsafe { feti_option_at(k, &mut option) } == FETI_OK).then_some(option)
}

/// Type, default and range.
fn columns(option: &feti_option) -> [String; 3] {
    let range = |show: fn(f64) -> String| format!("{} to {}", show(option.minimum), show(option.maximum));
    match option.r#type {
        FETI_OPTION_F64 => ["number".to_string(), number(option.default_f64), range(number)],
        FETI_OPTION_I64 => ["integer".to_string(), option.default_i64.to_string(), range(whole)],
        _ => ["text".to_string(), format!("`{}`", text(option.default_str)), String::new()],
    }
}

fn number(value: f64) -> String {
    match value.abs() {
        size if size >= NO_LIMIT => "no limit".to_string(),
        size if size != 0.0 && !(1e-3..1e5).contains(&size) => format!("{value:e}"),
        _ => value.to_string(),
    }
}

fn whole(value: f64) -> String {
    format!("{value:.0}")
}

fn statuses() -> String {
    let mut out = "# Statuses\n\n0: success; above 0: an answer that is incomplete; below 0: a failure. Numbers are never \
                   used again.\n\n| name | value | meaning |\n|---|---|---|\n"
        .to_string();
    let named = |status: &i32| text(feti_status_name(*status)) != "FETI_UNKNOWN";
    for status in STATUSES.rev().filter(named) {
        let (name, meaning) = (text(feti_status_name(status)), text(feti_status_text(status)));
        let _ = writeln!(out, "| `{name}` | {status} | {} |", cell(&meaning));
    }
    out
}

/// A static text of the library, empty where there is none.
fn text(from: *const c_char) -> String {
    if from.is_null() {
        return String::new();
    }
    // SAFETY: the library's texts are static and NUL terminated.
    unsafe { CStr::from_ptr(from) }.to_string_lossy().into_owned()
}

/// A text inside a table of Markdown.
fn cell(text: &str) -> String {
    text.replace('|', "\\|")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_option_and_status_has_its_line() {
        let options = options();
        assert_eq!(options.lines().count() as i64, 4 + feti_option_count());
        assert!(options.contains("| `gamma` | number | 1 | 0.001 to 1000 |"), "{options}");
        assert!(options.contains("| `start` | text | `cold` |  |"), "{options}");
        assert!(options.contains("sqrt(K_ii K_jj)") && options.contains("\\|K_ij - K_ji\\|"), "{options}");
        let statuses = statuses();
        for line in ["| `FETI_OK` | 0 | done |", "| `FETI_ARGUMENT` | -100 |", "| `FETI_OVERFLOW` | -13 |"] {
            assert!(statuses.contains(line), "{statuses}");
        }
    }

    #[test]
    fn a_bound_that_is_none_is_said_so() {
        assert_eq!([number(1e300), number(0.25), number(1e-12)], ["no limit", "0.25", "1e-12"]);
    }
}
