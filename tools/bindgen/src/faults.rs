//! What is made wrong with an argument: statements of C, one fault each.
//!
//! `@` stands for the argument, `@_` for the memory behind a pointer, `#` for the right value. Every fault must be refused with the
//! number of this argument, all others being right.

use crate::dictionary::Role;
use crate::model::{Argument, Type};

const PAST: &str = "@ = 99";
const NEGATIVE: [&str; 2] = ["@ = -1", "@ = INT64_MIN"];
const WORD: &[&str] = &["@ = \"no such word\"", "@ = \"\"", "@ = \"\\xff\""];

const RANKS: &[&str] = &[
    "@_[0].struct_size = 15",
    "@_[0].struct_size = INT64_MIN",
    "@_[0].rank = -1",
    "@_[0].rank = 1",
    "@_[0].size = 0",
    "@_[0].size = -1",
    "@_[0].local_size = 0",
    "@_[0].local_size = 2",
    "@_[0].reserved0 = 1",
    "@_[0].reserved[3] = @_",
    "@_[0].size = 2",
    "@_[0].size = 2, @_[0].flush = host_feti_flush_fn, @_[0].receive = host_feti_receive_fn",
    "@_[0].size = 2, @_[0].send = host_feti_send_fn, @_[0].receive = host_feti_receive_fn",
    "@_[0].size = 2, @_[0].send = host_feti_send_fn, @_[0].flush = host_feti_flush_fn",
];

/// Wrong values of a number that is passed by value.
pub fn of_number(ty: &Type, role: Role, right: &str) -> Vec<String> {
    let statements: &[&str] = match role {
        Role::Size => &["@ = # + 1", "@ = # - 1", "@ = INT64_MAX"],
        Role::UpTo => &["@ = # + 1", "@ = INT64_MAX"],
        Role::Free => &["@ = INT64_MAX"],
        Role::Positive => &["@ = 0", "@ = INT64_MAX"],
        Role::Number => &[PAST, "@ = INT64_MAX"],
        Role::BodyOrAll => return made(&["@ = -2", "@ = INT64_MIN", PAST, "@ = INT64_MAX"], right),
        Role::Leading => &["@ = # - 1", "@ = INT64_MAX"],
        Role::Room => &[],
        Role::Choice => return made(&[PAST, "@ = -1", "@ = INT32_MIN"], right),
        Role::Base => return made(&["@ = 2", "@ = -1"], right),
        Role::Dimension => return made(&["@ = 0", "@ = 4", "@ = -1"], right),
        Role::Value if *ty == Type::F64 => return made(&["@ = NAN", "@ = INFINITY", "@ = -INFINITY"], right),
        Role::Value => &["@ = INT64_MAX"],
        _ => return Vec::new(),
    };
    made(&[statements, &NEGATIVE].concat(), right)
}

/// Wrong contents of an array or a text that is read, whose initialiser is `right`.
pub fn of_contents(role: Role, right: &str) -> Vec<String> {
    let last = right.split(',').count() - 1;
    let at_last = |value: &str| format!("@_[{last}] = {value}");
    match role {
        Role::Doubles => vec!["@_[0] = NAN".to_string(), at_last("INFINITY"), at_last("-INFINITY")],
        Role::Gaps => vec!["@_[0] = NAN".to_string(), at_last("-INFINITY")],
        Role::NotNegative => vec!["@_[0] = NAN".to_string(), at_last("INFINITY"), at_last("-1e-300")],
        Role::Positions => vec!["@_[0] = 1".to_string(), "@_[0] = -1".to_string(), at_last("-1")],
        Role::Indices => vec!["@_[0] = -1".to_string(), at_last("99")],
        Role::Rows => vec!["@_[0] = -2".to_string(), at_last("99")],
        Role::Unknowns => vec![at_last("99")],
        Role::Distinct => vec!["@_[0] = -1".to_string(), at_last("@_[0]")],
        Role::Directions => vec!["@_[0] = 0".to_string(), at_last("7")],
        Role::Ranks => made(RANKS, right),
        Role::Size => vec!["@_[0] = 0".to_string(), "@_[0] = -1".to_string()],
        Role::Word => made(WORD, right),
        Role::Options => made(&["@ = \"no such word\"", "@ = \"\\xff\""], right),
        _ => Vec::new(),
    }
}

/// Wrong sizes of a struct that begins with `struct_size`.
pub fn of_record() -> Vec<String> {
    made(
        &["@_.struct_size = 0", "@_.struct_size = -1", "@_.struct_size = 15", "@_.struct_size = INT64_MIN"],
        "",
    )
}

/// Wrong pointers: NULL where the rule does not name it, and numbers that are not aligned.
pub fn of_pointer(argument: &Argument, ty: &str) -> Vec<String> {
    let mut faults = Vec::new();
    if !argument.is_nullable() {
        faults.push("@ = NULL".to_string());
    }
    let target = argument.ty.target();
    if target.is_some_and(Type::is_number) {
        faults.push(format!("@ = ({ty})(void *)((char *)@_ + 1)"));
    }
    faults
}

fn made(statements: &[&str], right: &str) -> Vec<String> {
    statements.iter().map(|statement| statement.replace('#', right)).collect()
}
