//! Loops over vectors in the order of the entries; long sums in a fixed number of parts. The result has the same bits for
//! any number of threads.

use std::slice;

use crate::platform::threads::{parts, parts_of};

/// Length from which a sum is formed in parts: a single sum waits for every addition, parts reach the speed of the
/// memory.
pub const LONG: usize = 16384;
/// A sum is rounding if it is below this part of the sum of its terms' sizes.
pub const NOISE: f64 = 64.0 * f64::EPSILON;
/// Parts of a long sum.
const PARTS: usize = 16;

/// `x'y`
pub fn dot(x: &[f64], y: &[f64]) -> f64 {
    if x.len() < LONG {
        return x.iter().zip(y).map(|(a, b)| a * b).sum();
    }
    dot_in_parts(x, y)
}

/// The same in parts, which add up side by side, also of short vectors.
pub fn dot_in_parts(x: &[f64], y: &[f64]) -> f64 {
    let ((x, x_rest), (y, y_rest)) = (as_arrays::<PARTS>(x), as_arrays::<PARTS>(y));
    let mut sums = [0.0; PARTS];
    for (x, y) in x.iter().zip(y) {
        (0..PARTS).for_each(|k| sums[k] += x[k] * y[k]);
    }
    sums.iter().sum::<f64>() + x_rest.iter().zip(y_rest).map(|(a, b)| a * b).sum::<f64>()
}

/// Rows per part of a loop over several long vectors.
const PART: usize = LONG;

/// `x_k'y` of several vectors.
pub fn dots(x: &[&[f64]], y: &[f64]) -> Vec<f64> {
    if y.len() < LONG {
        return x.iter().map(|x| dot(x, y)).collect();
    }
    let of_part = parts(y.len().div_ceil(PART), |part| {
        let rows = PART * part..y.len().min(PART * (part + 1));
        x.iter().map(|x| dot_in_parts(&x[rows.clone()], &y[rows.clone()])).collect::<Vec<f64>>()
    });
    let mut sums = vec![0.0; x.len()];
    of_part.iter().for_each(|part| axpy(1.0, part, &mut sums));
    sums
}

/// `y += sum_k a_k x_k`
pub fn add_multiples(a: &[f64], x: &[&[f64]], y: &mut [f64]) {
    parts_of(y.chunks_mut(PART).collect(), |part, y| {
        let rows = PART * part..PART * part + y.len();
        a.iter().zip(x).for_each(|(a, x)| axpy(*a, &x[rows.clone()], y));
    });
}

/// `|x|_2`
pub fn norm(x: &[f64]) -> f64 {
    dot(x, x).sqrt()
}

/// `max |x_i|`
pub fn norm_max(x: &[f64]) -> f64 {
    x.iter().fold(0.0, |largest, v| v.abs().max(largest))
}

/// Number of the first entry that is largest in size; 0 without entries.
pub fn fastest(v: &[f64]) -> usize {
    (0..v.len()).fold(0, |best, i| if v[i].abs() > v[best].abs() { i } else { best })
}

/// `y += a x`
pub fn axpy(a: f64, x: &[f64], y: &mut [f64]) {
    for (y, x) in y.iter_mut().zip(x) {
        *y += a * x;
    }
}

/// `sqrt(sum w_i x_i^2)`: the norm of `x` in the metric `diag(w)`, without overflow or underflow.
pub fn weighted_norm(x: &[f64], weight: impl Fn(usize) -> f64) -> f64 {
    // scaling by a power of two is exact: it changes the result only if squares would over- or underflow
    let size = power_of_two_below(norm_max(x).max(f64::MIN_POSITIVE));
    let square = |(i, v): (usize, &f64)| weight(i) * (v / size) * (v / size);
    size * x.iter().enumerate().map(square).sum::<f64>().sqrt()
}

/// x as arrays of N entries, and the rest: `as_chunks` of the standard library, which exists from Rust 1.88 on.
pub fn as_arrays<const N: usize>(x: &[f64]) -> (&[[f64; N]], &[f64]) {
    let (whole, rest) = x.split_at(x.len() / N * N);
    // SAFETY: an array of N numbers has the layout of N consecutive numbers of a slice
    (unsafe { slice::from_raw_parts(whole.as_ptr().cast(), whole.len() / N) }, rest)
}

/// `as_arrays` of a mutable vector.
pub fn as_arrays_mut<const N: usize>(x: &mut [f64]) -> (&mut [[f64; N]], &mut [f64]) {
    let (whole, rest) = x.split_at_mut(x.len() / N * N);
    // SAFETY: as in `as_arrays`; `whole` is not used afterwards
    (unsafe { slice::from_raw_parts_mut(whole.as_mut_ptr().cast(), whole.len() / N) }, rest)
}

/// `part / whole`; 0 / 0 counts as 0.
pub fn ratio(part: f64, whole: f64) -> f64 {
    if part == 0.0 {
        0.0
    } else {
        part / whole
    }
}

/// Position of the first entry that is not a finite number.
pub fn first_non_finite(x: &[f64]) -> Option<usize> {
    x.iter().position(|v| !v.is_finite())
}

/// The largest power of two that does not exceed x > 0, 1 if x is not a normal number: division by it is exact.
pub fn power_of_two_below(x: f64) -> f64 {
    const EXPONENT: u64 = 0x7ff0_0000_0000_0000;
    if x.is_normal() {
        f64::from_bits(x.to_bits() & EXPONENT)
    } else {
        1.0
    }
}
