//! The last error, per thread; each problem keeps its own error in its slot. A successful call clears nothing.

use std::cell::RefCell;
use std::ffi::c_char;

use crate::boundary::arrays;
use crate::boundary::call::Call;
use crate::boundary::record::{known, OutStruct};
use crate::header::status::{describe, of_kind, FETI_ARGUMENT, FETI_OK};
use crate::header::types::feti_error_detail;
use feti_contact::error::{Error, Place};

/// A failed call.
#[derive(Debug, Clone)]
pub struct Record {
    pub status: i32,
    /// Position of the refused argument, from 1; 0: none.
    argument: i32,
    function: &'static str,
    place: Place,
    /// "function: what was wrong".
    pub text: String,
}

thread_local! {
    static LAST: RefCell<Option<Record>> = const { RefCell::new(None) };
}

impl Record {
    pub fn of_error(call: Call, error: &Error) -> Self {
        let (status, argument) = of_kind(error.kind, call.arguments);
        let text = format!("{}: {error}", call.function);
        Self { status, argument, function: call.function, place: *error.place, text }
    }

    /// A record of a status that no [`Error`] has, with its own text.
    pub fn of_status(call: Call, status: i32) -> Self {
        let text = format!("{}: {}", call.function, describe(status).1.to_string_lossy());
        Self { status, argument: 0, function: call.function, place: Place::default(), text }
    }

    /// The record with the place and the text of a reason.
    pub fn because(self, why: Option<Error>) -> Self {
        match why {
            Some(why) => Self { text: format!("{}: {why}", self.text), place: *why.place, ..self },
            None => self,
        }
    }

    /// Makes this the last error of the thread; returns its status.
    pub fn publish(self) -> i32 {
        let status = self.status;
        // a thread that is being destroyed keeps no last error
        let _ = LAST.try_with(|last| last.replace(Some(self)));
        status
    }
}

/// The struct of the header; without a record its status is FETI_OK and its numbers mean none.
fn detail(record: Option<&Record>) -> feti_error_detail {
    let place = record.map(|record| record.place).unwrap_or_default();
    let index = place.given_index().map(|index| index as f64);
    let mut function = [0; 40];
    let name = record.map_or("", |record| record.function);
    for (to, from) in function[..39].iter_mut().zip(name.bytes()) {
        *to = from as c_char;
    }
    feti_error_detail {
        struct_size: size_of::<feti_error_detail>() as i64,
        status: record.map_or(FETI_OK, |record| record.status),
        argument: record.map_or(0, |record| record.argument),
        body: known(place.body),
        component: known(place.component),
        dof: known(place.dof),
        row: known(place.row),
        entry: known(place.byte.or(place.entry)),
        value: index.or(place.value).unwrap_or(f64::NAN),
        limit: place.limit.unwrap_or(f64::NAN),
        function,
        element: known(place.element),
        node: known(place.node),
        rank: known(place.rank),
        pair: known(place.pair),
        face: known(place.face),
    }
}

/// Text of the last error in the calling thread.
///
/// The text is truncated to fit, and always NUL terminated if `cap` > 0. Returns the full length without the NUL, or 0 if
/// no error has occurred; a successful call does not clear the text. Never fails.
///
/// | argument | in/out | shape | rule |
/// |---|---|---|---|
/// | `buf` | out | text | room for `cap` characters; NULL asks for the length |
/// | `cap` | in | scalar | characters in `buf`, 0 with NULL |
///
/// # Safety
/// `buf` has room for `cap` characters or is NULL.
#[no_mangle]
pub unsafe extern "C" fn feti_last_error(buf: *mut c_char, cap: i64) -> i64 {
    let read = |last: &RefCell<Option<Record>>| {
        let last = last.borrow();
        let text = last.as_ref().map_or("", |record| record.text.as_str());
        // SAFETY: the caller gives room for `cap` characters.
        unsafe { arrays::copy_text(text, buf, cap) }
    };
    LAST.try_with(read).unwrap_or(0)
}

/// Details of the last error in the calling thread: function, argument, place, value and limit.
///
/// The caller sets `struct_size`; the library writes no more bytes than that. A refusal of `out` leaves the last error
/// unchanged.
///
/// | argument | in/out | shape | rule |
/// |---|---|---|---|
/// | `out` | in/out | scalar | `struct_size` set, at least 16 |
///
/// # Safety
/// `out` points to `struct_size` writable bytes.
#[no_mangle]
pub unsafe extern "C" fn feti_last_error_detail(out: *mut feti_error_detail) -> i32 {
    // SAFETY: the caller gives `struct_size` bytes.
    let Ok(target) = (unsafe { OutStruct::new(out, "out") }) else {
        return FETI_ARGUMENT - 1;
    };
    let facts = LAST.try_with(|last| detail(last.borrow().as_ref()));
    target.write(&facts.unwrap_or_else(|_| detail(None)));
    FETI_OK
}
