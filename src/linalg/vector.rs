//! Loops over vectors, always in the order of the entries, sums of long ones in a fixed number of parts: the same bits on any number
//! of threads.

/// Entries from which a sum is formed in parts: one sum waits for every addition, parts go at the speed of the memory.
const LONG: usize = 16384;
/// Parts of a long sum.
const PARTS: usize = 16;

/// `x'y`
pub fn dot(x: &[f64], y: &[f64]) -> f64 {
    if x.len() < LONG {
        return x.iter().zip(y).map(|(a, b)| a * b).sum();
    }
    let ((x, x_rest), (y, y_rest)) = (x.as_chunks::<PARTS>(), y.as_chunks::<PARTS>());
    let mut sums = [0.0; PARTS];
    for (x, y) in x.iter().zip(y) {
        (0..PARTS).for_each(|k| sums[k] += x[k] * y[k]);
    }
    sums.iter().sum::<f64>() + x_rest.iter().zip(y_rest).map(|(a, b)| a * b).sum::<f64>()
}

/// `|x|_2`
pub fn norm(x: &[f64]) -> f64 {
    dot(x, x).sqrt()
}

/// `max |x_i|`
pub fn norm_max(x: &[f64]) -> f64 {
    x.iter().fold(0.0, |largest, v| v.abs().max(largest))
}

/// `y += a x`
pub fn axpy(a: f64, x: &[f64], y: &mut [f64]) {
    for (y, x) in y.iter_mut().zip(x) {
        *y += a * x;
    }
}

/// `sqrt(sum w_i x_i^2)`: the norm of `x` in the metric `diag(w)`, of x however small or large.
pub fn weighted_norm(x: &[f64], weight: impl Fn(usize) -> f64) -> f64 {
    // exact: the bits are those without it, but where squares over- or underflow
    let size = power_of_two_below(norm_max(x).max(f64::MIN_POSITIVE));
    let square = |(i, v): (usize, &f64)| weight(i) * (v / size) * (v / size);
    size * x.iter().enumerate().map(square).sum::<f64>().sqrt()
}

/// `part / whole`; nothing of nothing is 0.
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

/// The power of two below x > 0, 1 where x is no normal number: to divide by it is exact.
pub fn power_of_two_below(x: f64) -> f64 {
    const EXPONENT: u64 = 0x7ff0_0000_0000_0000;
    if x.is_normal() {
        f64::from_bits(x.to_bits() & EXPONENT)
    } else {
        1.0
    }
}
