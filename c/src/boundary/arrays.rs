//! Host pointers to slices and back, checked: sizes, NULL, alignment, texts. Results are copied to the host at the end of a call,
//! so that a failure leaves the host's arrays unchanged and overlapping arrays do no harm.

use std::ffi::{c_char, CStr, OsStr};
use std::path::Path;
use std::ptr::NonNull;

use feti_contact::error::{Error, Result, INDEX};
use feti_contact::platform::shortage::{is_short, RunningCall};
use feti_contact::solver::Borrowed;

/// A size: not negative, and small enough for an array of 8-byte numbers.
pub fn count(value: i64, name: &'static str) -> Result<usize> {
    let largest = isize::MAX as usize / 8;
    match usize::try_from(value) {
        Ok(count) if count <= largest => Ok(count),
        Ok(_) => {
            let text = format!("{name} is {value}, no array has so many entries");
            Err(Error::argument(name, text).value(value as f64))
        }
        Err(_) => Err(negative(value, name)),
    }
}

fn negative(value: i64, name: &'static str) -> Error {
    Error::argument(name, format!("{name} is {value}, and must not be negative")).value(value as f64)
}

/// A number of a body or row, counted from 0. The text omits the number: Fortran passes every number below 1 as a number
/// below -1, since -1 means all bodies.
pub fn id(value: i64, name: &'static str) -> Result<usize> {
    usize::try_from(value)
        .map_err(|_| Error::argument(name, format!("{name} is below the first number")).index(value))
}

/// A size that must have a known value: "n is 5, the body has 7".
pub fn same(value: i64, expected: usize, name: &'static str, what: &str) -> Result<usize> {
    if usize::try_from(value) == Ok(expected) {
        return Ok(expected);
    }
    let text = format!("{name} is {value}, {what} {expected}");
    Err(Error::argument(name, text).value(value as f64).limit(expected as f64))
}

/// The meaning of an argument with a few permitted values; for another value, the error says that it is `not` one of
/// them.
pub fn meaning<T: Copy>(value: i32, name: &'static str, known: &[(i32, T)], not: &str) -> Result<T> {
    let found = known.iter().find(|(number, _)| *number == value).map(|(_, meaning)| *meaning);
    found.ok_or_else(|| Error::argument(name, format!("{name} is {value}, {not}")).value(f64::from(value)))
}

/// Entry `k` of a list of `what`.
pub fn entry_at<'a, T>(list: &'a [T], k: i64, what: &str) -> Result<&'a T> {
    let found = usize::try_from(k).ok().and_then(|k| list.get(k));
    found.ok_or_else(|| {
        Error::argument("k", format!("number {INDEX} does not exist: there are {} {what}", list.len()))
            .index(k)
    })
}

/// Entries of a column-major array of `rows` x `columns` with leading dimension `ld`: ld (columns - 1) + rows.
pub fn column_major(rows: usize, columns: usize, ld: i64, name: &'static str) -> Result<(usize, usize)> {
    let ld = count(ld, name)?;
    if ld < rows {
        let text = format!("leading dimension {ld} is less than the {rows} rows");
        return Err(Error::argument(name, text).value(ld as f64).limit(rows as f64));
    }
    let Some(before) = columns.checked_sub(1) else {
        return Ok((0, ld));
    };
    let entries = ld.checked_mul(before).and_then(|entries| entries.checked_add(rows));
    let entries = entries.filter(|entries| *entries <= isize::MAX as usize / 8).ok_or_else(|| {
        Error::argument(name, format!("{columns} columns of {ld} entries: no array has so many"))
    })?;
    Ok((entries, ld))
}

/// True if this memory is available: for small allocations, at whose failure Rust would end the process.
pub fn left(bytes: usize) -> bool {
    let _running = RunningCall::begin();
    let mut room = Vec::<u8>::new();
    // what the reserve has given is not left
    let left = room.try_reserve_exact(bytes).is_ok() && !is_short();
    std::hint::black_box(room);
    left
}

pub fn null(name: &'static str) -> Error {
    Error::argument(name, format!("{name} is NULL"))
}

fn check_pointer<T>(from: *const T, name: &'static str) -> Result<()> {
    if from.is_null() {
        return Err(null(name));
    }
    if !from.is_aligned() {
        let what = format!("{name} is not aligned to {} bytes", align_of::<T>());
        return Err(Error::argument(name, what));
    }
    Ok(())
}

/// The host's array of `len` numbers; with `len` = 0 the pointer is ignored.
///
/// # Safety
/// `from` leads to `len` numbers that nobody writes to during the call.
pub unsafe fn input<'a, T>(from: *const T, len: usize, name: &'static str) -> Result<&'a [T]> {
    if len == 0 {
        return Ok(&[]);
    }
    check_pointer(from, name)?;
    // SAFETY: not NULL, aligned, and `len` numbers guaranteed by the caller; `count` has bounded the bytes.
    Ok(unsafe { std::slice::from_raw_parts(from, len) })
}

/// As [`input`], for numbers that must be finite.
///
/// # Safety
/// As for [`input`].
pub unsafe fn finite_input<'a>(from: *const f64, len: usize, name: &'static str) -> Result<&'a [f64]> {
    // SAFETY: guaranteed by the caller.
    let values = unsafe { input(from, len, name) }?;
    check_finite(values, 0, name)?;
    Ok(values)
}

/// Checks `values`, the entries from `start` on of the array `name`.
pub fn check_finite(values: &[f64], start: usize, name: &'static str) -> Result<()> {
    match values.iter().position(|value| !value.is_finite()) {
        None => Ok(()),
        Some(at) => Err(Error::argument(name, "the entry is not a finite number").entry(start + at)),
    }
}

/// As [`input`]; NULL means that the array is not given.
///
/// # Safety
/// As for [`input`].
pub unsafe fn input_or_none<'a, T>(
    from: *const T,
    len: usize,
    name: &'static str,
) -> Result<Option<&'a [T]>> {
    if from.is_null() {
        return Ok(None);
    }
    // SAFETY: guaranteed by the caller.
    unsafe { input(from, len, name) }.map(Some)
}

/// The host's array of `len` numbers, which is read beyond the call.
///
/// # Safety
/// `from` leads to `len` numbers that stay as long as the result and its copies, and that nobody writes to during a call.
pub unsafe fn borrowed<T>(from: *const T, len: usize, name: &'static str) -> Result<Borrowed<T>> {
    check_pointer(from, name)?;
    let start = NonNull::new(from.cast_mut()).ok_or_else(|| null(name))?;
    // SAFETY: not NULL, aligned, and `len` numbers guaranteed by the caller.
    Ok(unsafe { Borrowed::new(start, len) })
}

/// The destination of a result; an optional output may be NULL.
pub struct Output<T> {
    to: *mut T,
    len: usize,
}

impl<T: Copy> Output<T> {
    /// # Safety
    /// `to` has room for `len` numbers until the call returns.
    pub unsafe fn new(to: *mut T, len: usize, name: &'static str) -> Result<Self> {
        if len > 0 {
            check_pointer(to, name)?;
        }
        Ok(Self { to, len })
    }

    /// # Safety
    /// `to` is NULL or has room for `len` numbers until the call returns.
    pub unsafe fn optional(to: *mut T, len: usize, name: &'static str) -> Result<Self> {
        // SAFETY: guaranteed by the caller; NULL has no room.
        unsafe { Self::new(to, if to.is_null() { 0 } else { len }, name) }
    }

    /// Writes as many of `values` as fit, from entry `at` on.
    pub fn write_at(&self, at: usize, values: &[T]) {
        let len = values.len().min(self.len.saturating_sub(at));
        if len > 0 {
            // SAFETY: at + len <= self.len numbers lie behind `to`; the library's own `values` do not overlap them.
            unsafe { std::ptr::copy_nonoverlapping(values.as_ptr(), self.to.add(at), len) };
        }
    }

    pub fn write(&self, values: &[T]) {
        self.write_at(0, values);
    }

    pub fn set(&self, value: T) {
        self.write_at(0, &[value]);
    }
}

/// A text of the host.
///
/// # Safety
/// `from` is NULL or NUL terminated.
pub unsafe fn text<'a>(from: *const c_char, name: &'static str) -> Result<&'a str> {
    if from.is_null() {
        return Err(null(name));
    }
    // SAFETY: NUL terminated guaranteed by the caller.
    let bytes = unsafe { CStr::from_ptr(from) };
    bytes.to_str().map_err(|error| {
        let at = error.valid_up_to();
        Error::argument(name, "the text is not UTF-8").byte(at)
    })
}

/// The name of a file: any bytes on Unix.
///
/// # Safety
/// `from` is NULL or NUL terminated.
pub unsafe fn file_path<'a>(from: *const c_char, name: &'static str) -> Result<&'a Path> {
    if from.is_null() {
        return Err(null(name));
    }
    #[cfg(unix)]
    let path = {
        use std::os::unix::ffi::OsStrExt;
        // SAFETY: NUL terminated guaranteed by the caller.
        OsStr::from_bytes(unsafe { CStr::from_ptr(from) }.to_bytes())
    };
    #[cfg(not(unix))]
    // SAFETY: NUL terminated guaranteed by the caller.
    let path = OsStr::new(unsafe { text(from, name) }?);
    if path.is_empty() {
        return Err(Error::argument(name, "the name of the file is empty"));
    }
    Ok(Path::new(path))
}

/// Checks room for a text: `cap` >= 0 characters, NULL only with 0.
pub fn check_text_room(buf: *const c_char, cap: i64) -> Result<()> {
    if cap < 0 {
        return Err(negative(cap, "cap"));
    }
    if buf.is_null() && cap > 0 {
        return Err(Error::argument("buf", "NULL with room for characters"));
    }
    Ok(())
}

/// Copies as many whole characters of `text` as fit, and a NUL; returns the full length. Writes nothing without room.
///
/// # Safety
/// `buf` is NULL or has room for `cap` characters.
pub unsafe fn copy_text(text: &str, buf: *mut c_char, cap: i64) -> i64 {
    let room = usize::try_from(cap).unwrap_or(0);
    if !buf.is_null() && room > 0 {
        let fits = |len: &usize| text.is_char_boundary(*len);
        let len = (0..=text.len().min(room - 1)).rev().find(fits).unwrap_or(0);
        // SAFETY: len < cap characters and the NUL fit.
        unsafe {
            std::ptr::copy_nonoverlapping(text.as_ptr(), buf.cast(), len);
            buf.add(len).write(0);
        }
    }
    text.len() as i64
}

#[cfg(test)]
mod tests {
    use super::*;
    use feti_contact::error::Kind;

    fn kind<T>(result: Result<T>) -> Kind {
        result.err().map_or(Kind::Internal, |error| error.kind)
    }

    #[test]
    fn sizes_that_no_array_has_are_refused() {
        assert_eq!(count(0, "n").unwrap(), 0);
        for bad in [-1, i64::MIN, i64::MAX, isize::MAX as i64 / 8 + 1] {
            assert_eq!(kind(count(bad, "n")), Kind::Argument("n"));
        }
        assert_eq!(column_major(3, 4, 5, "ld").unwrap(), (18, 5));
        assert_eq!(column_major(3, 0, 5, "ld").unwrap(), (0, 5));
        assert_eq!(kind(column_major(3, 4, 2, "ld")), Kind::Argument("ld"));
        assert_eq!(kind(column_major(3, usize::MAX / 2, 1 << 40, "ld")), Kind::Argument("ld"));
    }

    #[test]
    fn null_and_misaligned_arrays_are_refused_unless_they_are_empty() {
        let numbers = [1.0, 2.0];
        let shifted = numbers.as_ptr().wrapping_byte_add(4);
        // SAFETY: the bad pointers are refused before they are followed.
        unsafe {
            assert_eq!(input(numbers.as_ptr(), 2, "f").unwrap(), numbers);
            assert_eq!(kind(input::<f64>(std::ptr::null(), 2, "f")), Kind::Argument("f"));
            assert_eq!(kind(input(shifted, 1, "f")), Kind::Argument("f"));
            assert!(input::<f64>(std::ptr::null(), 0, "f").unwrap().is_empty());
            assert!(input_or_none::<f64>(std::ptr::null(), 2, "f").unwrap().is_none());
            assert_eq!(kind(Output::<f64>::new(std::ptr::null_mut(), 1, "u")), Kind::Argument("u"));
        }
    }

    #[test]
    fn numbers_that_must_be_finite_are_refused_with_their_entry() {
        // SAFETY: three numbers each.
        let read = |x: [f64; 3]| unsafe { finite_input(x.as_ptr(), 3, "x") }.map(|_| ());
        assert_eq!(read([0.0, -1e308, 5e-324]), Ok(()));
        for bad in [f64::NAN, f64::INFINITY, f64::NEG_INFINITY] {
            let error = read([0.0, bad, bad]).unwrap_err();
            assert_eq!((error.kind, error.place.entry), (Kind::Argument("x"), Some(1)));
        }
        assert_eq!(check_finite(&[1.0, f64::NAN], 4, "x").unwrap_err().place.entry, Some(5));
    }

    #[test]
    fn a_text_is_cut_to_its_room_at_whole_characters() {
        let cut = |text: &str, cap: i64| {
            let mut room = [7; 8];
            // SAFETY: `cap` is at most the room.
            let full = unsafe { copy_text(text, room.as_mut_ptr(), cap) };
            let len = room.iter().position(|c| *c == 0);
            (full, len, room[usize::try_from(cap).unwrap_or(0)..].iter().all(|c| *c == 7))
        };
        assert_eq!(cut("abcdef", 8), (6, Some(6), true));
        assert_eq!(cut("abcdef", 7), (6, Some(6), true));
        assert_eq!(cut("abcdef", 4), (6, Some(3), true));
        assert_eq!(cut("ab\u{e9}", 4), (4, Some(2), true));
        assert_eq!(cut("abcdef", 0), (6, None, true));
        assert_eq!(cut("abcdef", -3), (6, None, true));
        // SAFETY: NULL is allowed.
        assert_eq!(unsafe { copy_text("abc", std::ptr::null_mut(), 5) }, 3);
    }

    #[test]
    fn a_text_that_is_null_or_not_utf8_is_refused() {
        // SAFETY: NULL is allowed, the others are NUL terminated.
        unsafe {
            assert_eq!(text(c"gamma".as_ptr(), "name").unwrap(), "gamma");
            assert_eq!(kind(text(std::ptr::null(), "name")), Kind::Argument("name"));
            assert_eq!(kind(text(c"a\xff".as_ptr(), "name")), Kind::Argument("name"));
        }
    }
}
