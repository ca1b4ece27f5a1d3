//! The surroundings of the calls: handles, busy, panics, error records. No solve is needed for it.

use std::collections::BTreeSet;
use std::ffi::{c_char, CStr};
use std::ptr::{null, null_mut};
use std::sync::mpsc;

use super::guard::{call, enter};
use super::*;

const SOURCES: [&str; 13] = [
    include_str!("body.rs"),
    include_str!("diagnosis.rs"),
    include_str!("error_store.rs"),
    include_str!("file.rs"),
    include_str!("log.rs"),
    include_str!("null_space.rs"),
    include_str!("options.rs"),
    include_str!("phases.rs"),
    include_str!("problem.rs"),
    include_str!("progress.rs"),
    include_str!("results.rs"),
    include_str!("rows.rs"),
    include_str!("solve.rs"),
    include_str!("state.rs"),
    include_str!("validation.rs"),
];

/// A problem that is destroyed with the test.
struct Owned(*mut feti_problem);

impl Owned {
    fn new() -> Self {
        let mut p = null_mut();
        // SAFETY: room for a pointer.
        assert_eq!(unsafe { feti_problem_create(&mut p) }, FETI_OK);
        assert!(!p.is_null());
        Self(p)
    }

    /// With one body of two unknowns.
    fn with_body() -> Self {
        let owned = Self::new();
        let mut body = -1;
        // SAFETY: room for one number.
        assert_eq!(unsafe { feti_body_add(owned.0, 2, &mut body) }, FETI_OK);
        assert_eq!(body, 0);
        owned
    }

    fn set(&self, name: &CStr, value: i64) -> i32 {
        // SAFETY: NUL terminated.
        unsafe { feti_set_i64(self.0, name.as_ptr(), value) }
    }

    fn load(&self, f: &[f64]) -> i32 {
        // SAFETY: as many numbers as said.
        unsafe { feti_body_load(self.0, 0, f.len() as i64, f.as_ptr()) }
    }

    fn error(&self) -> String {
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

fn string(text: &[c_char]) -> String {
    text.iter().take_while(|c| **c != 0).map(|c| char::from(*c as u8)).collect()
}

fn last_error() -> String {
    let mut text = [0; 400];
    // SAFETY: room for 400 characters.
    unsafe { feti_last_error(text.as_mut_ptr(), 400) };
    string(&text)
}

fn last_detail() -> feti_error_detail {
    // SAFETY: all zero is a valid value.
    let mut detail: feti_error_detail = unsafe { std::mem::zeroed() };
    detail.struct_size = size_of::<feti_error_detail>() as i64;
    // SAFETY: the size is set.
    assert_eq!(unsafe { feti_last_error_detail(&mut detail) }, FETI_OK);
    detail
}

/// Status of every function with handle `p` and otherwise NULL and zero; the handle is looked at first.
fn statuses(p: *mut feti_problem) -> Vec<(&'static str, i32)> {
    macro_rules! table {
        ($($function:ident($($argument:expr),*);)*) => {
            #[allow(unused_unsafe)]
            // SAFETY: pointers are NULL, sizes zero.
            unsafe { vec![$((stringify!($function), $function(p $(, $argument)*))),*] }
        };
    }
    table! {
        feti_problem_error(null_mut(), 0, &mut 0);
        feti_set_f64(null(), 0.0);
        feti_set_i64(null(), 0);
        feti_set_str(null(), null()); feti_set_text(null());
        feti_get_f64(null(), null_mut());
        feti_get_i64(null(), null_mut());
        feti_get_str(null(), null_mut(), 0, null_mut());
        feti_body_add(0, null_mut());
        feti_body_stiffness_i32(0, 0, null(), null(), null(), 0, 0, 0);
        feti_body_stiffness_i64(0, 0, null(), null(), null(), 0, 0, 0);
        feti_body_stiffness_dense(0, 0, null(), 0, 0, 0);
        feti_body_null_space(0, 0, 0, null(), 0, 0);
        feti_body_null_space_get(0, 0, null_mut(), null_mut(), 0);
        feti_body_coordinates(0, 0, 0, null(), null(), null(), 0);
        feti_body_load(0, 0, null());
        feti_rows_add_i32(0, 0, null(), null(), null(), null(), 0, null(), null_mut());
        feti_rows_add_i64(0, 0, null(), null(), null(), null(), 0, null(), null_mut());
        feti_rows_rhs(0, 0, 0, null());
        feti_rows_compliance(0, 0, 0, null());
        feti_rows_clear(0);
        feti_setup(); feti_solve(null_mut());
        feti_phase_count(null_mut()); feti_phase_at(0, null_mut());
        feti_cancel(); feti_problem_write(null()); feti_problem_read(null());
        feti_on_progress(None, null_mut()); feti_on_log(None, 0, null_mut());
        feti_start_from(0, 0, null()); feti_state_save(null_mut());
        feti_state_restore(0); feti_state_drop(0);
        feti_diagnosis(null_mut());
        feti_diagnosis_rows(0, 0, null_mut(), null_mut(), null_mut());
        feti_diagnosis_motion(0, 0, null_mut());
        feti_diagnosis_dependent(0, null_mut(), null_mut());
        feti_diagnosis_untouched(0, null_mut(), null_mut());
        feti_diagnosis_undetermined(0, null_mut(), null_mut());
        feti_diagnosis_undetermined_motion(0, 0, 0, null_mut());
        feti_check(0, null(), 0, null(), 0, null(), null_mut());
        feti_displacement(0, 0, null_mut());
        feti_reaction(0, 0, 0, null_mut());
        feti_amplitudes(0, 0, null_mut());
        feti_multipliers(0, 0, null_mut());
        feti_gaps(0, null_mut()); feti_active(0, null_mut());
        feti_counts(null_mut(), null_mut(), null_mut(), null_mut());
        feti_body_fixing(0, 0, null_mut());
        feti_body_fixing_set(0, 0, null());
        feti_body_kplus(0, 0, 0, null(), 0, null_mut(), 0);
        feti_dual_apply(0, null(), null_mut());
        feti_dual_rhs(0, null_mut());
    }
}

/// (name, arguments, text up to the next function) of every exported function.
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

fn assert_all(p: *mut feti_problem, expected: impl Fn(&str) -> i32) {
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
    let declared: BTreeSet<_> =
        of_problem.map(|item| item.split_once(" fn ").unwrap().1.split('(').next().unwrap()).collect();
    assert_eq!((tabled.len(), tabled), (54, declared));
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
    assert_eq!(seen, 57);
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

#[test]
fn after_a_panic_only_destroy_and_the_error_functions_work_and_other_problems_do() {
    let (mut broken, other) = (Owned::with_body(), Owned::with_body());
    assert_eq!(broken.set(c"fault_injection", 1), FETI_OK);
    // SAFETY: `info` may be NULL.
    assert_eq!(unsafe { feti_solve(broken.0, null_mut()) }, FETI_INTERNAL);
    assert!(last_error().contains("fault injected on request"));
    assert_eq!(broken.error(), last_error());
    let first = broken.error();
    assert_all(broken.0, |function| if function == "feti_problem_error" { FETI_OK } else { FETI_INTERNAL });
    assert_eq!(broken.error(), first, "the problem keeps the error that broke it");
    assert_eq!(other.load(&[1.0, 2.0]), FETI_OK);
    // SAFETY: leads to a pointer.
    assert_eq!(unsafe { feti_problem_destroy(&mut broken.0) }, FETI_OK);
}

#[test]
fn info_is_written_whatever_happens_and_no_more_than_the_caller_has_room_for() {
    let p = Owned::with_body();
    // SAFETY: all zero is a valid value.
    let mut info: feti_info = unsafe { std::mem::zeroed() };
    // SAFETY: `struct_size` is at most the size.
    let mut solve = |p: *mut feti_problem, size: usize| unsafe {
        info = std::mem::zeroed();
        info.struct_size = size as i64;
        (feti_solve(p, &mut info), info)
    };
    let (status, full) = solve(p.0, size_of::<feti_info>());
    assert!(status < 0 && full.status == status);
    assert_eq!((full.bodies, full.dofs, full.rows), (1, 2, 0));
    assert!(full.worst.is_nan() && full.seconds_solve.is_nan());
    let (status, old) = solve(p.0, 24);
    assert_eq!((old.struct_size, old.status, old.bodies, old.dofs), (24, status, 1, 0));
    assert_eq!(solve(p.0, 15).0, FETI_ARGUMENT - 2);
    assert_eq!(solve(null_mut(), size_of::<feti_info>()).1.status, FETI_HANDLE);
    assert_eq!(p.set(c"fault_injection", 1), FETI_OK);
    let (_, broken) = solve(p.0, size_of::<feti_info>());
    assert_eq!((broken.status, broken.bodies), (FETI_INTERNAL, 1));
}

#[test]
fn a_refused_argument_is_reported_by_position_name_and_place() {
    let p = Owned::with_body();
    assert_eq!(p.load(&[0.0, f64::INFINITY]), -104);
    let detail = last_detail();
    assert_eq!((detail.status, detail.argument, detail.body, detail.entry), (-104, 4, 0, 1));
    assert_eq!((detail.dof, detail.row, detail.component), (-1, -1, -1));
    assert_eq!(string(&detail.function), "feti_body_load");
    assert_eq!(p.load(&[0.0, 1.0, 2.0]), -103);
    assert_eq!((last_detail().value, last_detail().limit), (3.0, 2.0));
    let ptr = [0_i32, 1, 2];
    let stiffness = |row_ptr: &[i32], base, storage, flags| {
        let (col, val) = ([0_i32, 1], [1.0, 1.0]);
        // SAFETY: two rows of one entry each, or refused before.
        unsafe {
            let (col, val) = (col.as_ptr(), val.as_ptr());
            feti_body_stiffness_i32(p.0, 0, 2, row_ptr.as_ptr(), col, val, base, storage, flags)
        }
    };
    assert_eq!(stiffness(&ptr, 0, FETI_FULL, FETI_COPY), FETI_OK);
    assert_eq!(stiffness(&ptr, 1, FETI_FULL, FETI_COPY), -104);
    assert_eq!(stiffness(&ptr, 2, FETI_FULL, FETI_COPY), -107);
    assert_eq!(stiffness(&ptr, 0, 3, FETI_COPY), -108);
    assert_eq!(stiffness(&ptr, 0, FETI_FULL, 1), -109);
    assert_eq!(stiffness(&[0, 2, 1], 0, FETI_FULL, FETI_COPY), -104);
    assert_eq!((last_detail().row, last_detail().body), (1, -1));
}

#[test]
fn texts_count_from_the_base_of_the_host_and_details_from_zero() {
    let p = Owned::with_body();
    p.load(&[f64::NAN, 0.0]);
    assert!(last_error().starts_with("feti_body_load: body 0, entry 0: "), "{}", last_error());
    assert_eq!(p.set(c"index_base", 1), FETI_OK);
    p.load(&[f64::NAN, 0.0]);
    assert!(last_error().starts_with("feti_body_load: body 1, entry 1: "), "{}", last_error());
    assert_eq!((last_detail().body, last_detail().entry), (0, 0));
}

#[test]
fn the_last_error_is_kept_per_thread_and_cut_to_its_room() {
    let p = Owned::with_body();
    p.load(&[f64::NAN, 0.0]);
    assert_eq!(p.load(&[1.0, 1.0]), FETI_OK);
    let full = last_error();
    assert_eq!(full, p.error(), "a successful call clears nothing");
    let mut text = [1; 12];
    // SAFETY: room for as many characters as said.
    unsafe {
        assert_eq!(feti_last_error(null_mut(), 0), full.len() as i64);
        assert_eq!(feti_last_error(text.as_mut_ptr(), 10), full.len() as i64);
        assert_eq!(feti_problem_error(p.0, null_mut(), 1, &mut 0), -102);
    }
    assert_eq!((string(&text), &text[9..]), ("feti_body".to_string(), &[0, 1, 1][..]));
    let elsewhere = std::thread::spawn(|| (last_error(), last_detail().status)).join().unwrap();
    assert_eq!(elsewhere, (String::new(), FETI_OK));
    let mut short = feti_error_detail { struct_size: 8, ..last_detail() };
    // SAFETY: the size is refused, nothing is written.
    assert_eq!(unsafe { feti_last_error_detail(&mut short) }, -101);
}

#[test]
fn options_are_listed_with_type_and_default() {
    // SAFETY: all zero is a valid value, the size is set, names are NUL terminated.
    unsafe {
        let mut option: feti_option = std::mem::zeroed();
        option.struct_size = size_of::<feti_option>() as i64;
        let p = Owned::new();
        for k in 0..feti_option_count() {
            assert_eq!(feti_option_at(k, &mut option), FETI_OK);
            let (mut number, mut integer) = (0.0, 0);
            match option.r#type {
                FETI_OPTION_F64 => assert_eq!(feti_get_f64(p.0, option.name, &mut number), FETI_OK),
                FETI_OPTION_I64 => assert_eq!(feti_get_i64(p.0, option.name, &mut integer), FETI_OK),
                _ => assert_eq!(feti_get_str(p.0, option.name, null_mut(), 0, &mut integer), FETI_OK),
            }
            match option.r#type {
                FETI_OPTION_F64 => assert_eq!(number, option.default_f64),
                FETI_OPTION_I64 => assert_eq!(integer, option.default_i64),
                _ => assert!(option.default_f64.is_nan() && !option.default_str.is_null()),
            }
        }
        assert_eq!(feti_option_at(-1, &mut option), -101);
        assert_eq!(feti_option_at(feti_option_count(), &mut option), -101);
        assert_eq!(feti_option_at(0, null_mut()), -102);
    }
}
