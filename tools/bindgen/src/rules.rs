//! The rules of arguments, as the documentation of C has them, in the terms of the typed Fortran modules.

use crate::model::{Api, Argument};
use crate::typed_table::{Dummy, Entry};

/// What the arrays and flags of the procedures mean, in one paragraph.
pub fn described(api: &Api, entries: &[&Entry]) -> Option<String> {
    let mut clauses: Vec<(&str, String)> = Vec::new();
    for entry in entries.iter().filter(|entry| !entry.by_hand) {
        for dummy in entry.arguments.iter().map(|token| Dummy::read(token)) {
            let argument = api.function(entry.function).arguments.iter().find(|a| a.name == dummy.of_c);
            let Some(argument) =
                argument.filter(|a| !["p", "body"].contains(&a.name.as_str()) || !a.is_scalar())
            else {
                continue;
            };
            let rule = in_fortran(&argument.row.rule);
            if !rule.is_empty() && clauses.iter().all(|(name, _)| *name != dummy.name) {
                clauses
                    .push((dummy.name, format!("{}{}: {rule}", dummy.name, shape(entry, &dummy, argument))));
            }
        }
    }
    let texts: Vec<_> = clauses.into_iter().map(|(_, text)| text).collect();
    (!texts.is_empty()).then(|| texts.join(". ") + ".")
}

/// `(dim,nodes)` of an array that C describes by `dim * nodes`.
fn shape(entry: &Entry, dummy: &Dummy, argument: &Argument) -> String {
    let shape = &argument.row.shape;
    let rows = if entry.given.iter().any(|(name, _)| *name == "dim") { "dim" } else { "n" };
    match (dummy.rank(), shape.split_once(" * ")) {
        (1, _) if shape.contains('[') => "(:)".to_string(),
        (1, _) => format!("({shape})"),
        (2, Some((first, second))) => {
            format!("({},{second})", if first.starts_with("ld") { rows } else { first })
        }
        _ => String::new(),
    }
}

/// A rule of C, without what concerns addresses and storage.
fn in_fortran(rule: &str) -> String {
    let of_c = ["NULL", "`base`", "column-major:", "`struct_size`", "xyz["];
    let (kept, left): (Vec<_>, Vec<_>) =
        rule.split("; ").partition(|clause| of_c.iter().all(|word| !clause.contains(word)));
    let unit = left.iter().filter_map(|clause| clause.rsplit_once(", ")).map(|(_, unit)| unit);
    let unit = unit.filter(|unit| kept.is_empty() && unit.contains("length"));
    let absent = left.iter().filter(|clause| **clause == "NULL: zeros").map(|_| "absent: zeros");
    let text = kept.iter().copied().chain(unit).chain(absent).collect::<Vec<_>>().join("; ");
    let changes = [
        (", from 0", ", from 1"),
        ("column-major, ", ""),
        (", node after node", ""),
        ("node after node, ", ""),
        ("[", "("),
        ("]", ")"),
    ];
    changes.iter().fold(text, |text, (old, new)| text.replace(old, new))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_count_from_one_and_storage_is_not_described() {
        for (rule, expected) in [
            ("first row to change, from 0", "first row to change, from 1"),
            ("column-major: K_ij is k[i + ld j], force per length", "force per length"),
            (
                "row i holds the entries `row_ptr[i]` to `row_ptr[i + 1] - 1`; starts with `base`",
                "row i holds the entries `row_ptr(i)` to `row_ptr(i + 1) - 1`",
            ),
            ("c or h, length; NULL: zeros", "c or h, length; absent: zeros"),
            ("columns, counted from `base`", ""),
        ] {
            assert_eq!(in_fortran(rule), expected);
        }
    }
}
