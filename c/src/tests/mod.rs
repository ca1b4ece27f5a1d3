//! The frame of the calls: handles, busy, panics, error records. These tests need no solve.

use std::collections::BTreeSet;
use std::ffi::{c_char, CStr};
use std::ptr::null_mut;
use std::sync::mpsc;

use crate::boundary::{call, enter, handle};
use crate::*;

mod errors;
mod friction;
mod panics;
mod ranks;
mod table;
use table::{statuses, SOURCES};

/// A problem that is destroyed with the test.
pub(super) struct Owned(pub(super) *mut feti_problem);

impl Owned {
    pub(super) fn new() -> Self {
        let mut p = null_mut();
        // SAFETY: room for a pointer.
        assert_eq!(unsafe { feti_problem_create(&mut p) }, FETI_OK);
        assert!(!p.is_null());
        Self(p)
    }

    /// A problem with one body of two unknowns.
    pub(super) fn with_body() -> Self {
        let owned = Self::new();
        let mut body = -1;
        // SAFETY: room for one number.
        assert_eq!(unsafe { feti_body_add(owned.0, 2, &mut body) }, FETI_OK);
        assert_eq!(body, 0);
        owned
    }

    pub(super) fn set(&self, name: &CStr, value: i64) -> i32 {
        // SAFETY: NUL terminated.
        unsafe { feti_set_i64(self.0, name.as_ptr(), value) }
    }

    pub(super) fn load(&self, f: &[f64]) -> i32 {
        // SAFETY: as many numbers as said.
        unsafe { feti_body_load(self.0, 0, f.len() as i64, f.as_ptr()) }
    }

    pub(super) fn error(&self) -> String {
        let (mut text, mut len) = ([0; 400], 0);
        // SAFETY: room for 400 characters and one number.
        assert_eq!(unsafe { feti_problem_error(self.0, text.as_mut_ptr(), 400, &mut len) }, FETI_OK);
        let text = string(&text);
        assert_eq!(text.len() as i64, len);
        text
    }
}

impl Drop for Owned {
    fn drop(&mut self) {
        // SAFETY: leads to a pointer.
        unsafe { feti_problem_destroy(&mut self.0) };
    }
}

pub(super) fn string(text: &[c_char]) -> String {
    text.iter().take_while(|c| **c != 0).map(|c| char::from(*c as u8)).collect()
}

pub(super) fn last_error() -> String {
    let mut text = [0; 400];
    // SAFETY: room for 400 characters.
    unsafe { feti_last_error(text.as_mut_ptr(), 400) };
    string(&text)
}

pub(super) fn last_detail() -> feti_error_detail {
    // SAFETY: all zero is a valid value.
    let mut detail: feti_error_detail = unsafe { std::mem::zeroed() };
    detail.struct_size = size_of::<feti_error_detail>() as i64;
    // SAFETY: the size is set.
    assert_eq!(unsafe { feti_last_error_detail(&mut detail) }, FETI_OK);
    detail
}

/// (name, arguments, text up to the next function) of every exported function but twins, whose call is made by their macro.
fn exported() -> Vec<(&'static str, Vec<&'static str>, &'static str)> {
    let items = SOURCES.iter().flat_map(|source| source.split("#[no_mangle]").skip(1));
    let parsed = items.map(|item| {
        let (_, signature) = item.split_once(" fn ").unwrap();
        let (name, rest) = signature.split_once('(').unwrap();
        let (arguments, body) = rest.split_once(')').unwrap();
        let names = arguments.split(',').filter_map(|argument| argument.split_once(':'));
        (name, names.map(|(name, _)| name.trim()).collect(), body)
    });
    parsed.collect()
}

pub(super) fn assert_all(p: *mut feti_problem, expected: impl Fn(&str) -> i32) {
    for (function, status) in statuses(p) {
        assert_eq!(status, expected(function), "{function}");
    }
}

#[test]
fn the_table_of_statuses_holds_every_function_of_a_problem() {
    let tabled: BTreeSet<_> = statuses(null_mut()).into_iter().map(|row| row.0).collect();
    let of_problem = SOURCES.iter().flat_map(|source| source.split("#[no_mangle]").skip(1)).filter(|item| {
        let head = item.split('{').next().unwrap();
        head.contains("p: *mut feti_problem")
    });
    let twins = SOURCES.iter().flat_map(|source| source.split("twins! {").skip(1));
    let heads =
        of_problem.chain(twins).map(|item| item.split_once(" fn ").unwrap().1.split('(').next().unwrap());
    let declared: BTreeSet<_> = heads.flat_map(|names| names.split(", ")).collect();
    assert_eq!((tabled.len(), tabled), (104, declared));
}

#[test]
fn argument_names_in_errors_are_those_of_the_signature_in_order() {
    let mut seen = 0;
    for (name, arguments, body) in exported() {
        let Some((_, call)) = body.split_once("call!(") else { continue };
        let (called, rest) = call.split_once('(').unwrap();
        let named: Vec<_> = rest.split(')').next().unwrap().split(',').map(str::trim).collect();
        assert_eq!((called, named), (name, arguments));
        seen += 1;
    }
    assert_eq!(seen, 86);
}

#[test]
fn every_function_refuses_a_null_handle() {
    assert_all(null_mut(), |_| FETI_HANDLE);
    // SAFETY: NULL is refused, and so is a pointer to NULL.
    unsafe {
        assert_eq!(feti_problem_create(null_mut()), FETI_HANDLE);
        assert_eq!(feti_problem_destroy(null_mut()), FETI_HANDLE);
        assert_eq!(feti_problem_destroy(&mut null_mut()), FETI_HANDLE);
    }
    assert!(last_error().starts_with("feti_problem_destroy: the handle is NULL"));
}

#[test]
fn every_function_refuses_a_dead_and_a_foreign_handle() {
    let mut p = Owned::new();
    let mut copy = p.0;
    // SAFETY: lead to pointers.
    unsafe {
        assert_eq!(feti_problem_destroy(&mut p.0), FETI_OK);
        assert!(p.0.is_null());
        assert_eq!(feti_problem_destroy(&mut copy), FETI_HANDLE);
    }
    assert_all(copy, |_| FETI_HANDLE);
    let mut local = [0_u8; 64];
    assert_all(local.as_mut_ptr().cast(), |_| FETI_HANDLE);
    assert_all(usize::MAX as *mut feti_problem, |_| FETI_HANDLE);
}

#[test]
fn handles_are_never_used_again() {
    let mut seen = BTreeSet::new();
    for _ in 0..50 {
        let (a, b) = (Owned::new(), Owned::new());
        assert!(seen.insert(a.0.addr()) && seen.insert(b.0.addr()));
    }
}

#[test]
fn a_call_that_found_the_problem_before_it_was_destroyed_is_refused() {
    let mut p = Owned::new();
    let slot = handle::find(p.0).unwrap();
    // SAFETY: leads to a pointer.
    assert_eq!(unsafe { feti_problem_destroy(&mut p.0) }, FETI_OK);
    assert_eq!(slot.with(|_| ()), Err(handle::Refusal::Gone));
}

#[test]
fn while_a_call_runs_every_other_but_cancel_and_the_error_text_is_busy() {
    let p = Owned::with_body();
    assert_eq!(p.load(&[0.0, f64::NAN]), -104);
    let (started, wait_for_start) = mpsc::channel();
    let (finish, wait_for_finish) = mpsc::channel::<()>();
    let number = p.0.addr();
    let running = std::thread::spawn(move || {
        let p: *mut feti_problem = std::ptr::without_provenance_mut(number);
        enter(p, call!(feti_setup(p)), |_| {
            started.send(()).unwrap();
            let _ = wait_for_finish.recv();
            Ok(())
        })
    });
    wait_for_start.recv().unwrap();
    let exempt = ["feti_problem_error", "feti_cancel"];
    assert_all(p.0, |function| if exempt.contains(&function) { FETI_OK } else { FETI_BUSY });
    let mut copy = p.0;
    // SAFETY: leads to a pointer.
    assert_eq!(unsafe { feti_problem_destroy(&mut copy) }, FETI_BUSY);
    assert_eq!(copy, p.0);
    assert!(p.error().starts_with("feti_body_load: "), "a refusal does not hide the problem's own error");
    finish.send(()).unwrap();
    assert_eq!(running.join().unwrap(), FETI_OK);
    assert_eq!(p.load(&[0.0, 1.0]), FETI_OK);
}
