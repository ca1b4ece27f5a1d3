//! Results read by a host: info, details, texts, the list of options.

use std::ptr::null_mut;

use super::{last_detail, last_error, string, Owned};
use crate::*;

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
fn bodies_whose_unknowns_together_exceed_64_bits_are_refused_and_nothing_is_added() {
    let p = Owned::new();
    let add = |n: i64| {
        let mut body = -1;
        // SAFETY: room for one number.
        (unsafe { feti_body_add(p.0, n, &mut body) }, body)
    };
    let most = (1 << 60) - 1;
    (0..8).for_each(|body| assert_eq!(add(most), (FETI_OK, body)));
    assert_eq!(add(8), (FETI_OVERFLOW, -1));
    assert_eq!((last_detail().body, last_detail().limit), (8, 7.0));
    assert_eq!((add(7), add(1)), ((FETI_OK, 8), (FETI_OVERFLOW, -1)));
    let (mut bodies, mut unknowns, mut rows, mut equalities) = (0, 0, 0, 0);
    // SAFETY: room for one number each.
    let status = unsafe { feti_counts(p.0, &mut bodies, &mut unknowns, &mut rows, &mut equalities) };
    assert_eq!((status, bodies, unknowns), (FETI_OK, 9, i64::MAX));
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
    assert_eq!(stiffness(&ptr, 0, FETI_FULL, 2), -109);
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

/// Adds one equality row with one entry.
fn add_row(p: *mut feti_problem, ptr: &[i32; 2], dof: &[i32; 1], val: &[f64; 1], base: i32) -> i32 {
    let (body, rhs, first) = (null_mut(), null_mut(), null_mut());
    // SAFETY: the arrays of one row with one entry.
    unsafe {
        let (ptr, dof, val) = (ptr.as_ptr(), dof.as_ptr(), val.as_ptr());
        feti_rows_add_i32(p, FETI_EQUALITY, 1, ptr, body, dof, val, base, rhs, first)
    }
}

#[test]
fn a_refused_index_is_told_as_the_host_counts() {
    let p = Owned::with_body();
    for base in [0, 1] {
        assert_eq!(p.set(c"index_base", base), FETI_OK);
        assert_eq!(feti_state_drop(p.0, 4), -102);
        assert_eq!(last_error(), "feti_state_drop: no state has this number");
        assert_eq!(last_detail().value, (4 + base) as f64);
        assert_eq!(feti_state_drop(p.0, -1), -102);
        assert_eq!(last_error(), "feti_state_drop: id is below the first number");
        assert_eq!(last_detail().value, (base - 1) as f64);
        let (ptr, dof, val) = ([base as i32, base as i32 + 1], [base as i32 + 7], [1.0]);
        let added = add_row(p.0, &ptr, &dof, &val, base as i32);
        assert_eq!((added, last_detail().value), (-106, (7 + base) as f64));
    }
}

/// Sets a matrix of two rows and three entries with these positions and columns.
fn stiffness(p: *mut feti_problem, ptr: &[i32; 3], col: &[i32; 3], base: i32, storage: i32) -> i32 {
    let val = [4.0, -4.0, 4.0];
    // SAFETY: three positions and entries.
    unsafe {
        let (ptr, col, val) = (ptr.as_ptr(), col.as_ptr(), val.as_ptr());
        feti_body_stiffness_i32(p, 0, 2, ptr, col, val, base, storage, FETI_COPY)
    }
}

/// The bases of the call and of the texts differ: C hosts whose arrays count from 1.
#[test]
fn an_index_of_an_array_is_told_with_the_base_of_its_call_and_with_its_body() {
    let p = Owned::with_body();
    assert_eq!(stiffness(p.0, &[1, 2, 4], &[1, 1, 9], 1, FETI_LOWER), -105);
    let text =
        "feti_body_stiffness_i32: body 0, row 1, entry 2: column 9 is outside the 2 unknowns of the body";
    assert_eq!((last_error().as_str(), last_detail().value), (text, 9.0));
    assert_eq!(add_row(p.0, &[1, 2], &[7], &[1.0], 1), -106);
    let text = "feti_rows_add_i32: row 0, entry 0: unknown 7 is outside the 2 unknowns of all bodies";
    assert_eq!((last_error().as_str(), last_detail().value), (text, 7.0));
    let of_body = |body: i32, dof: i32| {
        let (ptr, body, dof) = ([1, 2], [body], [dof]);
        // SAFETY: the arrays of one row with one entry.
        unsafe {
            let (body, dof, val) = (body.as_ptr(), dof.as_ptr(), [1.0].as_ptr());
            feti_rows_add_i32(p.0, FETI_EQUALITY, 1, ptr.as_ptr(), body, dof, val, 1, null_mut(), null_mut())
        }
    };
    assert_eq!(of_body(4, 1), -105);
    let text = "feti_rows_add_i32: row 0, entry 0: body 4 does not exist: there are 1 bodies";
    assert_eq!((last_error().as_str(), last_detail().value), (text, 4.0));
    assert_eq!(of_body(1, 3), -106);
    let text = "feti_rows_add_i32: body 0, row 0, entry 0: unknown 3 is outside the 2 unknowns of the body";
    assert_eq!((last_error().as_str(), last_detail().body), (text, 0));
}

#[test]
fn texts_name_what_is_wrong_and_no_base() {
    let p = Owned::with_body();
    // SAFETY: refused before anything is written.
    assert_eq!(unsafe { feti_body_add(p.0, -5, &mut 0) }, -102);
    assert_eq!(last_error(), "feti_body_add: n is -5, and must not be negative");
    assert_eq!(stiffness(p.0, &[0, 1, 3], &[1, 1, 2], 1, FETI_LOWER), -104);
    assert_eq!(
        last_error(),
        "feti_body_stiffness_i32: row 0: row_ptr starts with 0, and has to start with 1"
    );
    assert_eq!(stiffness(p.0, &[0, 1, 3], &[0, 0, 1], 0, 7), -108);
    assert!(last_error().contains("storage is 7, none of FETI_FULL"), "{}", last_error());
    assert_eq!(stiffness(p.0, &[0, 1, 3], &[0, 0, 1], 0, FETI_FULL), -106);
    assert!(last_error().contains("with FETI_LOWER, not with FETI_FULL"), "{}", last_error());
}

/// 13 unknowns, dim = 2: an array n x dim is shorter than an array with ld = n.
#[test]
fn coordinates_with_the_leading_dimension_of_the_other_layout_are_refused_before_they_are_read() {
    let p = Owned::new();
    let n = 13;
    let (node, dir, xyz) = ([1_i32; 14], [1_i32; 14], [0.5; 14 * 14]);
    let give = |body: i64, n: i64, ld: i64, xyz: *const f64| {
        // SAFETY: NULL is refused, the other array holds ld (n - 1) + 2 numbers.
        unsafe { feti_body_coordinates(p.0, body, 2, n, node.as_ptr(), dir.as_ptr(), xyz, ld) }
    };
    for n in [n, n - 1] {
        // SAFETY: room for one number.
        assert_eq!(unsafe { feti_body_add(p.0, n, &mut 0) }, FETI_OK);
    }
    assert_eq!(give(0, n, n, std::ptr::null()), -108);
    let text = "body 0: ld is 13, the number of unknowns: coordinates lie unknown by unknown";
    assert!(last_error().contains(text), "{}", last_error());
    assert_eq!((last_detail().value, last_detail().limit), (13.0, 2.0));
    for ld in [2, n - 1, n + 1] {
        assert_eq!(give(0, n, ld, xyz.as_ptr()), FETI_OK, "ld {ld}");
    }
    assert_eq!(give(1, n - 1, n - 1, xyz.as_ptr()), FETI_OK, "records of 12 numbers for each of 12 unknowns");
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
