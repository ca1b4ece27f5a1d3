//! Options by name and by one text: any bytes as names, words and texts.

use std::ffi::CString;

use feti_contact_c::*;

use super::buffers::{Out, Written};
use super::bytes::Bytes;
use super::host::last_error;

/// Sets and reads options; what was set is read back, what was refused has changed nothing.
pub fn run(data: &[u8]) {
    let mut bytes = Bytes::new(data);
    let mut p = std::ptr::null_mut();
    // SAFETY: room for a handle.
    assert_eq!(unsafe { feti_problem_create(&mut p) }, FETI_OK);
    let mut calls = 0;
    while !bytes.used_up() && calls < 8 {
        one(p, &mut bytes);
        calls += 1;
    }
    // SAFETY: leads to a handle.
    assert_eq!(unsafe { feti_problem_destroy(&mut p) }, FETI_OK);
}

/// A name of the list, or any text; `log_file` would write files of any name.
fn name(bytes: &mut Bytes) -> CString {
    let name = any_name(bytes);
    match name.as_bytes() == b"log_file" {
        true => c"log_level".to_owned(),
        false => name,
    }
}

fn any_name(bytes: &mut Bytes) -> CString {
    if bytes.chance(96) {
        return text(bytes, 24);
    }
    // SAFETY: the struct is as large as it says, its texts are static.
    unsafe {
        let mut option: feti_option = std::mem::zeroed();
        option.struct_size = size_of::<feti_option>() as i64;
        let k = bytes.below(feti_option_count() as usize);
        assert_eq!(feti_option_at(k as i64, &mut option), FETI_OK);
        std::ffi::CStr::from_ptr(option.name).to_owned()
    }
}

/// The next bytes up to a zero.
fn text(bytes: &mut Bytes, most: usize) -> CString {
    let length = bytes.below(most + 1);
    let taken: Vec<u8> = bytes.take(length).iter().copied().take_while(|byte| *byte != 0).collect();
    CString::new(taken).expect("no NUL")
}

fn number(bytes: &mut Bytes) -> f64 {
    match bytes.below(4) {
        0 => bytes.wild(),
        1 => 10f64.powi(i32::from(bytes.byte() as i8) / 8),
        _ => bytes.number(),
    }
}

/// A status of the header, never FETI_INTERNAL.
fn check(status: i32) -> bool {
    let refused = (FETI_ARGUMENT - 6..=FETI_ARGUMENT).contains(&status);
    assert!(status == FETI_OK || refused, "status {status}: {}", last_error());
    status == FETI_OK
}

fn one(p: *mut feti_problem, bytes: &mut Bytes) {
    let (call, name) = (bytes.below(5), name(bytes));
    // SAFETY: the texts end with NUL, every number has its room.
    unsafe {
        match call {
            0 => {
                let (value, mut before, mut after) = (number(bytes), Out::<f64>::new(1), Out::<f64>::new(1));
                let known = check(feti_get_f64(p, name.as_ptr(), before.cells.as_mut_ptr()));
                assert_ne!(known, before.untouched());
                let set = check(feti_set_f64(p, name.as_ptr(), value));
                check(feti_get_f64(p, name.as_ptr(), after.cells.as_mut_ptr()));
                let wanted = if set { value } else { before.cells[0] };
                assert_eq!(after.cells[0].to_bits(), wanted.to_bits());
            }
            1 => {
                let value = [0, 1, 2, -1, 4096, 4097, i64::MAX, i64::MIN][bytes.below(8)];
                let (mut before, mut after) = (Out::<i64>::new(1), Out::<i64>::new(1));
                let known = check(feti_get_i64(p, name.as_ptr(), before.cells.as_mut_ptr()));
                assert_ne!(known, before.untouched());
                let set = check(feti_set_i64(p, name.as_ptr(), value));
                check(feti_get_i64(p, name.as_ptr(), after.cells.as_mut_ptr()));
                assert_eq!(after.cells[0], if set { value } else { before.cells[0] });
            }
            2 => whole_text(p, bytes),
            _ => word(p, &name, &text(bytes, 24), bytes.below(32)),
        }
    }
}

/// Items as they may come, among them right ones; after a refusal the option looked at is as it was.
unsafe fn whole_text(p: *mut feti_problem, bytes: &mut Bytes) {
    let mut items = Vec::new();
    for _ in 0..bytes.below(4) {
        items.extend_from_slice(name(bytes).as_bytes());
        items.extend_from_slice([&b"="[..], b" = ", b"", b"=="][bytes.below(4)]);
        let value = number(bytes);
        match bytes.below(4) {
            0 => items.extend_from_slice(text(bytes, 24).as_bytes()),
            1 => items.extend_from_slice(format!("{value:e}").as_bytes()),
            2 => items.extend_from_slice(format!("{}", bytes.below(4)).as_bytes()),
            _ => items.extend_from_slice(format!("{value}").as_bytes()),
        }
        items.extend_from_slice([&b" "[..], b",", b"\n", b" # "][bytes.below(4)]);
    }
    if items.windows(8).any(|bytes| bytes == b"log_file") {
        return;
    }
    let items = CString::new(items).expect("no NUL");
    let (mut before, mut after) = (Out::<f64>::new(1), Out::<f64>::new(1));
    // SAFETY: the texts end with NUL, every number has its room.
    unsafe {
        check(feti_get_f64(p, c"tolerance".as_ptr(), before.cells.as_mut_ptr()));
        let set = check(feti_set_text(p, items.as_ptr()));
        check(feti_get_f64(p, c"tolerance".as_ptr(), after.cells.as_mut_ptr()));
        assert!(set || before.cells[0].to_bits() == after.cells[0].to_bits());
    }
}

/// A word set and read back into room for `cap` characters.
unsafe fn word(p: *mut feti_problem, name: &CString, value: &CString, cap: usize) {
    let (mut room, mut length) = (Out::<u8>::new(cap), Out::<i64>::new(1));
    // SAFETY: the texts end with NUL, room for `cap` characters.
    unsafe {
        let set = check(feti_set_str(p, name.as_ptr(), value.as_ptr()));
        let at = if cap > 0 { room.cells.as_mut_ptr() } else { std::ptr::null_mut() };
        let read = check(feti_get_str(p, name.as_ptr(), at.cast(), cap as i64, length.cells.as_mut_ptr()));
        assert!(read || (room.untouched() && length.untouched() && !set));
        if read && cap > 0 {
            let end = room.cells.iter().position(|byte| *byte == 0).expect("NUL at the end");
            assert_eq!(end, usize::try_from(length.cells[0]).expect("a length").min(cap - 1));
            assert!(!set || value.as_bytes().starts_with(&room.cells[..end]));
        }
    }
}
