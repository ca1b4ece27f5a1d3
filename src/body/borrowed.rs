//! Matrices whose numbers remain in the host's arrays.

use crate::body::stiffness::check_order;
use crate::error::Result;
use crate::linalg::vector::first_non_finite;
use crate::linalg::{Array, Borrowed, Symmetric};
use crate::platform::memory::{copied, reserved};

const WHAT: &str = "the pattern of a stiffness matrix";

/// The columns of a matrix, counted from 0.
pub enum Columns<'a> {
    /// In the form that the matrix stores.
    Kept(Borrowed<u32>),
    /// As a function of the position, to be copied.
    Given(&'a dyn Fn(usize) -> i64),
}

/// The matrix of these rows without a copy of its values, if they have the stored form: lower triangle, ascending
/// columns, the diagonal at the end of every row. `None` if they do not, or if a value is not finite.
pub fn from_borrowed(ptr: &[usize], col: Columns<'_>, val: Borrowed<f64>) -> Result<Option<Symmetric>> {
    check_order(ptr.len() - 1)?;
    let col: Array<u32> = match col {
        Columns::Kept(col) => col.into(),
        Columns::Given(column) => {
            let mut copy = reserved(val.len(), WHAT)?;
            copy.extend((0..val.len()).map(|at| u32::try_from(column(at)).unwrap_or(u32::MAX)));
            copy.into()
        }
    };
    let k = Symmetric::new(copied(ptr, WHAT)?, col, val);
    let is_kept_so = |i: usize| {
        let row = &k.col[k.ptr[i]..k.ptr[i + 1]];
        row.last() == Some(&(i as u32)) && row.windows(2).all(|pair| pair[0] < pair[1])
    };
    let is_kept = (0..k.order()).all(is_kept_so) && first_non_finite(&k.val).is_none();
    Ok(is_kept.then_some(k))
}

#[cfg(test)]
mod tests {
    use std::ptr::NonNull;

    use super::*;

    fn borrowed<T>(numbers: &[T]) -> Borrowed<T> {
        // SAFETY: the tests keep their arrays alive.
        unsafe { Borrowed::new(NonNull::from(numbers).cast(), numbers.len()) }
    }

    #[test]
    fn rows_in_the_form_of_the_matrix_are_not_copied_and_others_are_left_alone() {
        let (ptr, val) = ([0, 1, 3], [2.0, -1.0, 3.0]);
        let col = [0_u32, 0, 1];
        let k = from_borrowed(&ptr, Columns::Kept(borrowed(&col)), borrowed(&val)).unwrap().unwrap();
        assert_eq!((k.col.as_ptr(), k.val.as_ptr()), (col.as_ptr(), val.as_ptr()));
        assert_eq!(k, Symmetric::new(vec![0, 1, 3], vec![0, 0, 1], vec![2.0, -1.0, 3.0]));
        let taken = |ptr: &[usize], col: [i64; 3], val: [f64; 3]| {
            let given = |at: usize| col[at];
            from_borrowed(ptr, Columns::Given(&given), borrowed(&val)).map(|k| k.is_some())
        };
        assert_eq!(taken(&ptr, [0, 0, 1], val), Ok(true));
        for other in [[0, 1, 0], [0, 0, 0], [0, -1, 1], [1, 0, 1], [0, 0, 1 << 32]] {
            assert_eq!(taken(&ptr, other, val), Ok(false), "{other:?}");
        }
        assert_eq!(taken(&[0, 3, 3], [0, 0, 1], val), Ok(false), "a row without diagonal");
        assert_eq!(taken(&ptr, [0, 0, 1], [2.0, f64::NAN, 3.0]), Ok(false));
    }
}
