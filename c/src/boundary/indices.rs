//! Index arrays of the host, 32 or 64 bits, counted from 0 or 1, converted once.

use crate::boundary::arrays::{input, meaning};
use feti_contact::error::{Error, Result};
use feti_contact::platform::memory::reserved;

/// The integer types of index arrays.
pub trait Index: Copy {
    fn wide(self) -> i64;
    /// The numbers as the 32-bit columns of a matrix; negative numbers become far too large.
    fn unsigned(from: *const Self) -> Option<*const u32>;
}

impl Index for i32 {
    fn wide(self) -> i64 {
        i64::from(self)
    }

    fn unsigned(from: *const Self) -> Option<*const u32> {
        Some(from.cast())
    }
}

impl Index for i64 {
    fn wide(self) -> i64 {
        self
    }

    fn unsigned(_: *const Self) -> Option<*const u32> {
        None
    }
}

/// The base of the index arrays of a call: 0 or 1.
pub fn base_of(value: i32) -> Result<i64> {
    meaning(value, "base", &[(0, 0), (1, 1)], "neither 0 nor 1")
}

/// Argument `row_ptr`: `rows` + 1 nondecreasing positions, the first is `base`; from 0 in the result.
///
/// # Safety
/// `from` leads to `rows` + 1 numbers that nobody writes to during the call.
pub unsafe fn pointers<I: Index>(from: *const I, rows: usize, base: i64) -> Result<Vec<usize>> {
    // SAFETY: guaranteed by the caller.
    unsafe { positions(from, rows, base, ("row_ptr", Error::row)) }
}

/// Argument `ptr` of elements, like `row_ptr`.
///
/// # Safety
/// As for [`pointers`].
pub unsafe fn element_pointers<I: Index>(from: *const I, elements: usize, base: i64) -> Result<Vec<usize>> {
    // SAFETY: guaranteed by the caller.
    unsafe { positions(from, elements, base, ("ptr", Error::element)) }
}

/// Argument `ptr` of a profile, like `row_ptr`.
///
/// # Safety
/// As for [`pointers`].
pub unsafe fn column_pointers<I: Index>(from: *const I, columns: usize, base: i64) -> Result<Vec<usize>> {
    // SAFETY: guaranteed by the caller.
    unsafe { positions(from, columns, base, ("ptr", Error::dof)) }
}

/// Argument `ptr` of a table of unknowns, like `row_ptr`.
///
/// # Safety
/// As for [`pointers`].
pub unsafe fn term_pointers<I: Index>(from: *const I, unknowns: usize, base: i64) -> Result<Vec<usize>> {
    // SAFETY: guaranteed by the caller.
    unsafe { positions(from, unknowns, base, ("ptr", Error::entry)) }
}

/// `named`: the argument, and the setter for the place of its error.
///
/// # Safety
/// As for [`pointers`].
unsafe fn positions<I: Index>(
    from: *const I,
    rows: usize,
    base: i64,
    named: (&'static str, fn(Error, usize) -> Error),
) -> Result<Vec<usize>> {
    let (name, at) = named;
    // SAFETY: guaranteed by the caller; without rows the array is not looked at.
    let given = unsafe { input(from, if rows == 0 { 0 } else { rows + 1 }, name) }?;
    let mut positions = reserved(rows + 1, "an index array")?;
    positions.push(0);
    if given.first().is_some_and(|first| first.wide() != base) {
        let text = format!("{name} starts with {}, and has to start with {base}", given[0].wide());
        return Err(at(Error::argument(name, text), 0).value(given[0].wide() as f64).limit(base as f64));
    }
    for (row, pair) in given.windows(2).enumerate() {
        let (start, end) = (pair[0].wide(), pair[1].wide());
        let position = usize::try_from(end.saturating_sub(base));
        match position {
            Ok(position) if end >= start && position <= isize::MAX as usize / 8 => positions.push(position),
            _ => {
                let text = format!("{name} goes from {start} to {end}");
                return Err(at(Error::argument(name, text), row).value(end as f64).limit(start as f64));
            }
        }
    }
    Ok(positions)
}

/// `len` numbers, converted to count from 0; numbers below `base` become negative, and the range check refuses them.
///
/// # Safety
/// `from` leads to `len` numbers that nobody writes to during the call.
pub unsafe fn numbers<I: Index>(
    from: *const I,
    len: usize,
    base: i64,
    name: &'static str,
) -> Result<Vec<i64>> {
    // SAFETY: guaranteed by the caller.
    let given = unsafe { input(from, len, name) }?;
    let mut numbers = reserved(len, "an index array")?;
    numbers.extend(given.iter().map(|number| number.wide().saturating_sub(base)));
    Ok(numbers)
}

#[cfg(test)]
mod tests {
    use super::*;
    use feti_contact::error::Kind;

    fn pointers_of(given: &[i32], base: i64) -> Result<Vec<usize>> {
        // SAFETY: the slice has rows + 1 numbers.
        unsafe { pointers(given.as_ptr(), given.len() - 1, base) }
    }

    #[test]
    fn pointers_count_from_their_base() {
        assert_eq!(pointers_of(&[0, 2, 2, 5], 0).unwrap(), [0, 2, 2, 5]);
        assert_eq!(pointers_of(&[1, 3, 3, 6], 1).unwrap(), [0, 2, 2, 5]);
        // SAFETY: without rows nothing is read.
        assert_eq!(unsafe { pointers::<i64>(std::ptr::null(), 0, 1) }.unwrap(), [0]);
    }

    #[test]
    fn bad_pointers_are_refused_with_their_row() {
        for (given, base, row) in
            [(&[1, 3][..], 0, 0), (&[0, 3], 1, 0), (&[0, 3, 2], 0, 1), (&[0, 1, 4, -9], 0, 2)]
        {
            let error = pointers_of(given, base).unwrap_err();
            assert_eq!((error.kind, error.place.row), (Kind::Argument("row_ptr"), Some(row)));
        }
        assert_eq!(base_of(2).unwrap_err().kind, Kind::Argument("base"));
        assert_eq!(base_of(-1).unwrap_err().kind, Kind::Argument("base"));
    }

    #[test]
    fn numbers_keep_their_sign_after_the_base() {
        // SAFETY: slices with as many numbers as said.
        unsafe {
            assert_eq!(numbers([1_i32, 0, 7].as_ptr(), 3, 1, "col").unwrap(), [0, -1, 6]);
            assert_eq!(numbers([i64::MIN, 4].as_ptr(), 2, 1, "col").unwrap(), [i64::MIN, 3]);
        }
    }
}
