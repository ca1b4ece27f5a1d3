//! How FORTRAN 77 calls the functions of C, read from the sources of its face.

use std::collections::BTreeMap;

use crate::typed::statements;

/// For every function of C the statements that call it, `CALL FTBADD(IP, N, IBODY, IERR)`. A subroutine is the face of the
/// function that it calls first, or of those behind a generic name.
pub fn calls(sources: &[String]) -> BTreeMap<String, Vec<String>> {
    let texts: Vec<Vec<String>> = sources.iter().map(|text| statements(text)).collect();
    let generics = generics(&texts);
    let mut found: BTreeMap<String, Vec<String>> = BTreeMap::new();
    for text in &texts {
        let mut open: Option<&str> = None;
        for line in text {
            if line.starts_with("subroutine ft") {
                open = Some(line);
            } else if let Some(statement) = open {
                let functions = functions(line, &generics);
                for function in &functions {
                    let call = statement.replacen("subroutine", "CALL", 1).to_uppercase();
                    found.entry(function.clone()).or_default().push(call);
                }
                open = open.filter(|_| functions.is_empty());
            }
        }
    }
    found
}

/// Generic name, or name of a procedure of a module -> functions of C: those it stands for, or the first that it calls.
fn generics(texts: &[Vec<String>]) -> BTreeMap<String, Vec<String>> {
    let mut generics: BTreeMap<String, Vec<String>> = BTreeMap::new();
    let mut generic = None;
    for line in texts.iter().flatten() {
        let word = |keyword| line.strip_prefix(keyword).map(|rest| name_at(rest).to_string());
        if let Some(name) = word("interface ").or(word("subroutine ")) {
            generic = Some(name).filter(|name| !name.starts_with("ft"));
        } else if let Some(name) = &generic {
            let listed =
                line.strip_prefix("procedure ").map(|list| list.split(',').map(|f| f.trim().to_string()));
            let functions = listed.map_or_else(|| functions(line, &BTreeMap::new()), Iterator::collect);
            if !functions.is_empty() {
                generics.insert(name.clone(), functions);
                generic = None;
            }
        }
    }
    generics
}

/// The functions of C that a statement calls first.
fn functions(line: &str, generics: &BTreeMap<String, Vec<String>>) -> Vec<String> {
    let starts = line
        .char_indices()
        .filter(|(at, _)| !line[..*at].ends_with(|c: char| c.is_alphanumeric() || c == '_'));
    let called = starts.map(|(at, _)| name_at(&line[at..])).filter(|name| line.contains(&format!("{name}(")));
    let mut known = called.filter_map(|name| match generics.get(name) {
        Some(functions) => Some(functions.clone()),
        None => name.starts_with("feti_").then(|| vec![name.to_string()]),
    });
    known.next().unwrap_or_default()
}

fn name_at(text: &str) -> &str {
    let end = text.find(|c: char| !c.is_alphanumeric() && c != '_').unwrap_or(text.len());
    &text[..end]
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Its helper reads the details of the error, too.
    #[test]
    fn the_page_of_the_error_text_has_the_subroutine_that_tells_it() {
        let fortran = std::path::Path::new(env!("CARGO_MANIFEST_DIR")).join("../../include/fortran");
        let read =
            |part| std::fs::read_to_string(fortran.join(format!("feti_contact_f77_{part}.f90"))).unwrap();
        let found = calls(&[read("base"), read("problem")]);
        assert_eq!(found["feti_last_error"], ["CALL FTERR(IERR, TEXT)"]);
    }

    #[test]
    fn a_subroutine_is_the_face_of_what_it_calls_first() {
        let base = "interface add\n  procedure feti_add_i32, feti_add_i64\nend interface\n\
            subroutine give_text(text)\n n = feti_text(c_loc(text))\nend subroutine\n";
        let face = "subroutine ftadd(ip, &\n  n, ierr)\n  ierr = told(add(handle(ip), wide(n)))\nend subroutine\n\
            subroutine ftnew(ip)\n call create()\ncontains\n subroutine create()\n  s = feti_create(p)\n  s = feti_set(p)\n\
            end subroutine\nend subroutine\nsubroutine fterr(text)\n call give_text(text)\nend subroutine\n";
        let found = calls(&[base.to_string(), face.to_string()]);
        let pairs: Vec<_> =
            found.iter().map(|(function, calls)| (function.as_str(), calls.join("; "))).collect();
        let expected = [
            ("feti_add_i32", "CALL FTADD(IP, N, IERR)"),
            ("feti_add_i64", "CALL FTADD(IP, N, IERR)"),
            ("feti_create", "CALL FTNEW(IP)"),
            ("feti_text", "CALL FTERR(TEXT)"),
        ];
        assert_eq!(pairs, expected.map(|(function, call)| (function, call.to_string())));
    }
}
