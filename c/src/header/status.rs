//! Status numbers with their names and texts, and the version. Numbers are never reused.

use std::ffi::{c_char, CStr};

use feti_contact::error::Kind;
use feti_contact::solver::Outcome;

/// Done.
pub const FETI_OK: i32 = 0;
/// The limit on steps was reached; the results are those of the last step.
pub const FETI_ITERATIONS: i32 = 1;
/// The time limit was reached; the results are those of the last step.
pub const FETI_TIME: i32 = 2;
/// The host cancelled; the results are those of the last step, or none if there was no step yet.
pub const FETI_CANCELLED: i32 = 3;
/// Steps no longer reduce the error; the results are those of the last step.
pub const FETI_STALLED: i32 = 4;
/// The certificate does not pass.
pub const FETI_INACCURATE: i32 = 5;
/// The answer is usable but incomplete: a small part of the load is not held, or a body moves far beyond its deformation.
pub const FETI_MARGINAL: i32 = 6;
/// Memory could not be reserved, or option memory_limit would be exceeded.
pub const FETI_MEMORY: i32 = -1;
/// The handle is NULL, was destroyed, or does not come from this library.
pub const FETI_HANDLE: i32 = -2;
/// Another call on this problem is running.
pub const FETI_BUSY: i32 = -3;
/// A function of the host reported a failure.
pub const FETI_CALLBACK: i32 = -4;
/// Something that this call needs has not been given yet.
pub const FETI_STATE: i32 = -5;
/// No forces of the rows, friction within its law included, balance the load: a body without contact, or a block on a plane
/// that is pushed by more than mu N.
pub const FETI_LOAD_NOT_HELD: i32 = -6;
/// Rows contradict each other.
pub const FETI_GAPS_CONTRADICT: i32 = -7;
/// The null space of a body is not the one that was given, or was not found.
pub const FETI_NULL_SPACE: i32 = -8;
/// A stiffness matrix has a negative or vanishing pivot outside its null space, or negative stiffness along a motion that
/// the contact does not stop.
pub const FETI_INDEFINITE: i32 = -9;
/// A file could not be read or written.
pub const FETI_IO: i32 = -10;
/// An internal error of the library; afterwards only feti_problem_destroy and the error functions accept the problem.
pub const FETI_INTERNAL: i32 = -11;
/// The request is valid but not available.
pub const FETI_UNSUPPORTED: i32 = -12;
/// A given number, or a product of given numbers, does not fit its type.
pub const FETI_OVERFLOW: i32 = -13;
/// Forces within the law of friction would balance the load, since a spring, a support or a second wall across the contact
/// could press harder than it does: bodies slide steadily, and no equilibrium was found.
pub const FETI_SLIDES: i32 = -14;
/// Another rank cannot be reached, or runs another build of the library.
pub const FETI_COMMUNICATION: i32 = -15;
/// FETI_ARGUMENT - k: argument k was refused, where the handle is argument 1. FETI_ARGUMENT itself: data of an earlier
/// call was refused.
pub const FETI_ARGUMENT: i32 = -100;

/// Largest k of a status FETI_ARGUMENT - k.
const MOST_ARGUMENTS: i32 = 99;

/// (number, name, text)
const TABLE: [(i32, &CStr, &CStr); 23] = [
    (FETI_OK, c"FETI_OK", c"done"),
    (FETI_ITERATIONS, c"FETI_ITERATIONS", c"stopped at the limit on steps before the tolerance was met"),
    (FETI_TIME, c"FETI_TIME", c"stopped at the time limit before the tolerance was met"),
    (FETI_CANCELLED, c"FETI_CANCELLED", c"cancelled by the host"),
    (FETI_STALLED, c"FETI_STALLED", c"stopped because steps no longer reduce the error"),
    (FETI_INACCURATE, c"FETI_INACCURATE", c"solved, but the certificate does not pass"),
    (FETI_MARGINAL, c"FETI_MARGINAL", c"solved, but a small part of the load is not held, or a body moves far beyond its deformation"),
    (FETI_MEMORY, c"FETI_MEMORY", c"memory could not be reserved, or the memory limit would be exceeded"),
    (FETI_HANDLE, c"FETI_HANDLE", c"the handle is NULL, destroyed, or not from this library"),
    (FETI_BUSY, c"FETI_BUSY", c"another call on this problem is running"),
    (FETI_CALLBACK, c"FETI_CALLBACK", c"a function of the host reported a failure, or gave an invalid result"),
    (FETI_STATE, c"FETI_STATE", c"something this call needs has not been given yet"),
    (FETI_LOAD_NOT_HELD, c"FETI_LOAD_NOT_HELD", c"the load has a component that no contact force can balance"),
    (FETI_GAPS_CONTRADICT, c"FETI_GAPS_CONTRADICT", c"the rows contradict each other: no displacement satisfies them"),
    (FETI_NULL_SPACE, c"FETI_NULL_SPACE", c"the null space of a body is not what was claimed, or was not found"),
    (FETI_INDEFINITE, c"FETI_INDEFINITE", c"a stiffness matrix is not positive definite outside its null space"),
    (FETI_IO, c"FETI_IO", c"a file could not be read or written"),
    (FETI_INTERNAL, c"FETI_INTERNAL", c"the library contradicts itself; the problem can only be destroyed"),
    (FETI_UNSUPPORTED, c"FETI_UNSUPPORTED", c"the request is valid but not available"),
    (FETI_OVERFLOW, c"FETI_OVERFLOW", c"a number, or a product of numbers that were given, does not fit its type"),
    (FETI_SLIDES, c"FETI_SLIDES", c"bodies slide: friction holds only a part of the load, and no rest was found"),
    (FETI_COMMUNICATION, c"FETI_COMMUNICATION", c"another rank cannot be reached, or runs another build of the library"),
    (FETI_ARGUMENT, c"FETI_ARGUMENT", c"an argument was refused: its position is FETI_ARGUMENT minus the status, 0 for data of an earlier call"),
];

/// Status of a failure, and the position of the refused argument (0: none) in `arguments`.
pub(crate) fn of_kind(kind: Kind, arguments: &[&str]) -> (i32, i32) {
    let Kind::Argument(name) = kind else { return (of_name(kind.status()), 0) };
    let position = arguments.iter().position(|argument| *argument == name).map_or(0, |k| k as i32 + 1);
    (FETI_ARGUMENT - position, position)
}

/// Status of a solve that gave an answer.
pub(crate) fn of_outcome(outcome: &Outcome) -> i32 {
    of_name(outcome.status())
}

fn of_name(name: &str) -> i32 {
    TABLE.iter().find(|row| row.1.to_bytes() == name.as_bytes()).map_or(FETI_INTERNAL, |row| row.0)
}

/// (name, text) of a status.
pub(crate) fn describe(status: i32) -> (&'static CStr, &'static CStr) {
    let is_argument = (FETI_ARGUMENT - MOST_ARGUMENTS..=FETI_ARGUMENT).contains(&status);
    let number = if is_argument { FETI_ARGUMENT } else { status };
    let found = TABLE.iter().find(|row| row.0 == number);
    found.map_or((c"FETI_UNKNOWN", c"no status of this library"), |row| (row.1, row.2))
}

/// Name of a status, such as "FETI_LOAD_NOT_HELD".
///
/// The name is "FETI_ARGUMENT" for every refused argument and "FETI_UNKNOWN" for a number that is not a status. The text
/// is static. Never fails.
///
/// | argument | in/out | shape | rule |
/// |---|---|---|---|
/// | `status` | in | scalar | any number |
#[no_mangle]
pub extern "C" fn feti_status_name(status: i32) -> *const c_char {
    describe(status).0.as_ptr()
}

/// One English sentence that explains a status.
///
/// The text is static. Never fails.
///
/// | argument | in/out | shape | rule |
/// |---|---|---|---|
/// | `status` | in | scalar | any number |
#[no_mangle]
pub extern "C" fn feti_status_text(status: i32) -> *const c_char {
    describe(status).1.as_ptr()
}

/// Version of the loaded library, "MAJOR.MINOR.PATCH".
///
/// The text is static. Never fails.
#[no_mangle]
pub extern "C" fn feti_version() -> *const c_char {
    concat!(env!("CARGO_PKG_VERSION"), "\0").as_ptr().cast()
}

/// Version of the loaded library as one number, 10000 MAJOR + 100 MINOR + PATCH.
///
/// Never fails.
#[no_mangle]
pub extern "C" fn feti_version_number() -> i32 {
    const MAJOR: i32 = decimal(env!("CARGO_PKG_VERSION_MAJOR"));
    const MINOR: i32 = decimal(env!("CARGO_PKG_VERSION_MINOR"));
    const PATCH: i32 = decimal(env!("CARGO_PKG_VERSION_PATCH"));
    10_000 * MAJOR + 100 * MINOR + PATCH
}

/// Value of a text of digits.
const fn decimal(digits: &str) -> i32 {
    let digits = digits.as_bytes();
    let (mut value, mut k) = (0, 0);
    while k < digits.len() {
        value = 10 * value + (digits[k] - b'0') as i32;
        k += 1;
    }
    value
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn an_argument_is_numbered_by_its_position_with_the_handle_as_one() {
        let arguments = ["p", "body", "n", "f"];
        assert_eq!(of_kind(Kind::Argument("f"), &arguments), (-104, 4));
        assert_eq!(of_kind(Kind::Argument("body"), &arguments), (-102, 2));
        assert_eq!(of_kind(Kind::Argument("val"), &arguments), (-100, 0));
        assert_eq!(of_kind(Kind::LoadNotHeld, &arguments), (-6, 0));
    }

    #[test]
    fn every_status_has_its_own_number_name_and_text() {
        for (k, row) in TABLE.iter().enumerate() {
            assert_eq!(describe(row.0), (row.1, row.2));
            assert!(TABLE[..k].iter().all(|other| other.0 != row.0 && other.1 != row.1 && other.2 != row.2));
        }
        assert_eq!(describe(-104).0, c"FETI_ARGUMENT");
        assert_eq!(describe(-199).0, c"FETI_ARGUMENT");
        for unknown in [7, -16, -99, -200, i32::MIN, i32::MAX] {
            assert_eq!(describe(unknown).0, c"FETI_UNKNOWN");
        }
    }

    #[test]
    fn the_version_number_agrees_with_the_text() {
        let parts: Vec<i32> =
            env!("CARGO_PKG_VERSION").split('.').filter_map(|part| part.parse().ok()).collect();
        assert_eq!(feti_version_number(), 10_000 * parts[0] + 100 * parts[1] + parts[2]);
        // SAFETY: the text is static and NUL terminated.
        let text = unsafe { CStr::from_ptr(feti_version()) };
        assert_eq!(text.to_bytes(), env!("CARGO_PKG_VERSION").as_bytes());
    }
}
