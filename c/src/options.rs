//! Options by name, and their table.

use std::ffi::c_char;
use std::ptr;

use crate::boundary::{
    call, check_text_room, copy_text, enter, entry_at, text, without_problem, OutStruct, Output,
};
use crate::header::types::{feti_option, feti_problem, FETI_OPTION_F64, FETI_OPTION_I64, FETI_OPTION_STR};
use feti_contact::solver::{options, OptionInfo, OptionValue};

/// Sets an option that is a number.
///
/// The value stays valid until it is set again.
///
/// | argument | in/out | shape | rule |
/// |---|---|---|---|
/// | `p` | in | scalar | the handle |
/// | `name` | in | text | a name of feti_option_at with type FETI_OPTION_F64 |
/// | `value` | in | scalar | within the range of the option |
///
/// # Safety
/// `name` is NUL terminated.
#[no_mangle]
pub unsafe extern "C" fn feti_set_f64(p: *mut feti_problem, name: *const c_char, value: f64) -> i32 {
    enter(p, call!(feti_set_f64(p, name, value)), |problem| {
        // SAFETY: NUL terminated guaranteed by the caller.
        problem.set_f64(unsafe { text(name, "name") }?, value)
    })
}

/// Sets an option that is an integer.
///
/// The value stays valid until it is set again.
///
/// | argument | in/out | shape | rule |
/// |---|---|---|---|
/// | `p` | in | scalar | the handle |
/// | `name` | in | text | a name of feti_option_at with type FETI_OPTION_I64 |
/// | `value` | in | scalar | within the range of the option |
///
/// # Safety
/// `name` is NUL terminated.
#[no_mangle]
pub unsafe extern "C" fn feti_set_i64(p: *mut feti_problem, name: *const c_char, value: i64) -> i32 {
    enter(p, call!(feti_set_i64(p, name, value)), |problem| {
        // SAFETY: NUL terminated guaranteed by the caller.
        problem.set_i64(unsafe { text(name, "name") }?, value)
    })
}

/// Sets an option that is a text.
///
/// The text is copied and stays valid until it is set again.
///
/// | argument | in/out | shape | rule |
/// |---|---|---|---|
/// | `p` | in | scalar | the handle |
/// | `name` | in | text | a name of feti_option_at with type FETI_OPTION_STR |
/// | `value` | in | text | one of the texts that the option accepts |
///
/// # Safety
/// `name` and `value` are NUL terminated.
#[no_mangle]
pub unsafe extern "C" fn feti_set_str(
    p: *mut feti_problem,
    name: *const c_char,
    value: *const c_char,
) -> i32 {
    enter(p, call!(feti_set_str(p, name, value)), |problem| {
        // SAFETY: NUL terminated guaranteed by the caller.
        let (name, value) = unsafe { (text(name, "name")?, text(value, "value")?) };
        problem.set_str(name, value)
    })
}

/// Sets several options with one text, such as "tolerance=1e-8 threads=4".
///
/// The text has items name = value of any type, separated by blanks, commas or line ends; a # begins a comment that
/// ends with the line. If an option occurs twice, the last value counts. The error names the option, and `entry` of the
/// error detail is the position of the byte in the text, from 0.
///
/// | argument | in/out | shape | rule |
/// |---|---|---|---|
/// | `p` | in | scalar | the handle |
/// | `text` | in | text | the options |
///
/// # Safety
/// `text` is NUL terminated.
#[no_mangle]
pub unsafe extern "C" fn feti_set_text(p: *mut feti_problem, text: *const c_char) -> i32 {
    enter(p, call!(feti_set_text(p, text)), |problem| {
        // SAFETY: NUL terminated guaranteed by the caller.
        problem.set_text(unsafe { self::text(text, "text") }?)
    })
}

/// Reads an option that is a number.
///
/// | argument | in/out | shape | rule |
/// |---|---|---|---|
/// | `p` | in | scalar | the handle |
/// | `name` | in | text | a name of feti_option_at with type FETI_OPTION_F64 |
/// | `value` | out | scalar | the current value |
///
/// # Safety
/// `name` is NUL terminated, `value` has room for one number.
#[no_mangle]
pub unsafe extern "C" fn feti_get_f64(p: *mut feti_problem, name: *const c_char, value: *mut f64) -> i32 {
    enter(p, call!(feti_get_f64(p, name, value)), |problem| {
        // SAFETY: NUL terminated, and room for one number, guaranteed by the caller.
        let (name, value) = unsafe { (text(name, "name")?, Output::new(value, 1, "value")?) };
        value.set(problem.get_f64(name)?);
        Ok(())
    })
}

/// Reads an option that is an integer.
///
/// | argument | in/out | shape | rule |
/// |---|---|---|---|
/// | `p` | in | scalar | the handle |
/// | `name` | in | text | a name of feti_option_at with type FETI_OPTION_I64 |
/// | `value` | out | scalar | the current value |
///
/// # Safety
/// `name` is NUL terminated, `value` has room for one number.
#[no_mangle]
pub unsafe extern "C" fn feti_get_i64(p: *mut feti_problem, name: *const c_char, value: *mut i64) -> i32 {
    enter(p, call!(feti_get_i64(p, name, value)), |problem| {
        // SAFETY: NUL terminated, and room for one number, guaranteed by the caller.
        let (name, value) = unsafe { (text(name, "name")?, Output::new(value, 1, "value")?) };
        value.set(problem.get_i64(name)?);
        Ok(())
    })
}

/// Reads an option that is a text.
///
/// The text is truncated to fit, and always NUL terminated if `cap` > 0.
///
/// | argument | in/out | shape | rule |
/// |---|---|---|---|
/// | `p` | in | scalar | the handle |
/// | `name` | in | text | a name of feti_option_at with type FETI_OPTION_STR |
/// | `buf` | out | text | room for `cap` characters; NULL with `cap` = 0 asks for the length |
/// | `cap` | in | scalar | characters in `buf`, >= 0 |
/// | `len` | out | scalar | full length without the terminating zero |
///
/// # Safety
/// `name` is NUL terminated, `buf` has room for `cap` characters, `len` for one number.
#[no_mangle]
pub unsafe extern "C" fn feti_get_str(
    p: *mut feti_problem,
    name: *const c_char,
    buf: *mut c_char,
    cap: i64,
    len: *mut i64,
) -> i32 {
    enter(p, call!(feti_get_str(p, name, buf, cap, len)), |problem| {
        check_text_room(buf, cap)?;
        // SAFETY: NUL terminated, and room for one number, guaranteed by the caller.
        let (name, len) = unsafe { (text(name, "name")?, Output::new(len, 1, "len")?) };
        let value = problem.get_str(name)?;
        // SAFETY: the caller gives room for `cap` characters.
        len.set(unsafe { copy_text(&value, buf, cap) });
        Ok(())
    })
}

/// Number of options.
///
/// Never fails.
#[no_mangle]
pub extern "C" fn feti_option_count() -> i64 {
    options().len() as i64
}

/// Describes an option: name, text, type, default and range.
///
/// The texts are static. The caller sets `struct_size`; the library writes no more bytes than that.
///
/// | argument | in/out | shape | rule |
/// |---|---|---|---|
/// | `k` | in | scalar | from 0, less than feti_option_count |
/// | `out` | in/out | scalar | `struct_size` set, at least 16 |
///
/// # Safety
/// `out` points to `struct_size` writable bytes.
#[no_mangle]
pub unsafe extern "C" fn feti_option_at(k: i64, out: *mut feti_option) -> i32 {
    without_problem(call!(feti_option_at(k, out)), || {
        let info = entry_at(options(), k, "options")?;
        // SAFETY: the caller gives `struct_size` bytes.
        unsafe { OutStruct::new(out, "out") }?.write(&described(info));
        Ok(())
    })
}

fn described(info: &OptionInfo) -> feti_option {
    let mut option = feti_option {
        struct_size: size_of::<feti_option>() as i64,
        r#type: FETI_OPTION_F64,
        reserved: 0,
        minimum: info.minimum,
        maximum: info.maximum,
        default_f64: f64::NAN,
        default_i64: 0,
        name: info.name.as_ptr(),
        doc: info.doc.as_ptr(),
        default_str: ptr::null(),
    };
    match info.default {
        OptionValue::F64(value) => option.default_f64 = value,
        OptionValue::I64(value) => {
            option.r#type = FETI_OPTION_I64;
            (option.default_i64, option.default_f64) = (value, value as f64);
        }
        OptionValue::Str(value) | OptionValue::Text(value) => {
            (option.r#type, option.default_str) = (FETI_OPTION_STR, value.as_ptr());
        }
    }
    option
}
