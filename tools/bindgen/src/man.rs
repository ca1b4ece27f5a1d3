//! Manual pages: section 3 for every function, section 7 for the library.

use std::fmt::Write;

use crate::c_types::prototype;
use crate::model::{Api, Function};
use crate::order;
use crate::pages::{direction, Faces};
use crate::statuses::{self, results};

/// (file name, text) of every page, below `man3` and `man7`.
pub fn print(api: &Api, faces: &Faces) -> Vec<(String, String)> {
    let mut pages = vec![("man7/feti_contact.7".to_string(), overview(api))];
    for function in &api.functions {
        pages.push((format!("man3/{}.3", function.name), page(api, faces, function)));
    }
    pages
}

fn title(api: &Api, name: &str, section: u32) -> String {
    let [major, minor, patch] = api.version;
    format!(".TH {name} {section} \"\" \"feti-contact {major}.{minor}.{patch}\" \"feti-contact\"\n")
}

fn page(api: &Api, faces: &Faces, function: &Function) -> String {
    let [before, after] = function.doc.paragraphs();
    let name = &function.name;
    let mut out = title(api, name, 3);
    let _ = write!(out, ".SH NAME\n{name} \\- {}\n", text(&function.doc.summary()));
    let _ = write!(
        out,
        ".SH SYNOPSIS\n.nf\n#include <feti_contact.h>\n\n{};\n.fi\n",
        text(&prototype(function, 78))
    );
    if let Some(signatures) = faces.typed.get(name) {
        let lines = signatures.iter().map(|signature| text(&signature.join("\n")));
        let _ = write!(
            out,
            ".SS Fortran\n.nf\nuse feti_contact\n\n{}\n.fi\n",
            lines.collect::<Vec<_>>().join("\n\n")
        );
    }
    if let Some(calls) = faces.f77.get(name) {
        let _ = write!(out, ".SS FORTRAN 77\n.nf\n{}\n.fi\n", text(&calls.join("\n")));
    }
    if before.len() > 1 {
        let paragraphs: Vec<_> = before[1..].iter().map(|paragraph| text(paragraph)).collect();
        let _ = write!(out, ".SH DESCRIPTION\n{}\n", paragraphs.join("\n.PP\n"));
    }
    if !function.is_twin {
        write_arguments(&mut out, function);
    }
    if function.has_status() && !function.is_twin {
        out.push_str(".SH RETURN VALUE\n");
        for (status, when) in results(api, function) {
            let _ = write!(out, ".TP\n.B {}\n{}\n", text(&status), text(&when));
        }
    }
    if let Some(safety) = after.first().and_then(|paragraph| paragraph.strip_prefix("Safety:")) {
        let _ = write!(out, ".SH SAFETY\n{}\n", text(safety.trim()));
    }
    out.push_str(".SH SEE ALSO\n.BR feti_contact (7)\n");
    out
}

fn write_arguments(out: &mut String, function: &Function) {
    if function.arguments.is_empty() {
        return;
    }
    out.push_str(".SH ARGUMENTS\n");
    for argument in &function.arguments {
        let row = &argument.row;
        let _ = write!(
            out,
            ".TP\n\\fI{}\\fR  ({}, {})\n{}\n",
            text(&row.argument),
            direction(row.direction),
            text(&row.shape),
            text(&row.rule)
        );
    }
}

fn overview(api: &Api) -> String {
    let mut out = title(api, "feti_contact", 7);
    out.push_str(
        ".SH NAME\nfeti_contact \\- contact problems of elastic bodies by FETI duality, for C and Fortran\n.SH DESCRIPTION\n\
         Minimises 1/2 u'Ku \\- f'u subject to B u <= c and H u = h, where K is the stiffness of several bodies, floating \
         ones included.\nA host creates a problem, adds bodies and rows, solves, and reads displacements and forces.\n\
         Every function but those that never fail returns a status: 0 for success, above 0 for a usable but incomplete \
         answer, below 0 for a failure, whose text feti_last_error tells. After a failure nothing is written or changed.\nLink with \\-lfeti_contact.\n.SH FUNCTIONS\n",
    );
    for group in order::groups(api).iter().filter(|group| !group.functions.is_empty()) {
        let _ = write!(out, ".SS {}\n{}\n", text(group.heading), text(group.says));
        for function in &group.functions {
            let _ = write!(out, ".TP\n.BR {} (3)\n{}\n", function.name, text(&function.doc.summary()));
        }
    }
    out.push_str(".SH STATUSES\n");
    for constant in api.constants.iter().filter(|constant| constant.source == statuses::FILE) {
        let meaning = text(&constant.doc.summary());
        let _ = write!(
            out,
            ".TP\n.BR {} \" = {}\"\n{meaning}\n",
            constant.name,
            text(&constant.value.to_string())
        );
    }
    out
}

/// Text that no line of it is taken for a request, with plain hyphens and backslashes.
pub fn text(plain: &str) -> String {
    let escaped = plain.replace('\\', "\\e").replace('-', "\\-").replace('`', "");
    let lines = escaped.lines().map(|line| match line.chars().next() {
        Some('.' | '\'') => format!("\\&{line}"),
        _ => line.to_string(),
    });
    lines.collect::<Vec<_>>().join("\n")
}
