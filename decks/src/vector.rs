//! Dense vectors: the few operations the decks and their tests need.

/// x'y.
pub(crate) fn dot(x: &[f64], y: &[f64]) -> f64 {
    x.iter().zip(y).map(|(a, b)| a * b).sum()
}

/// |x|.
#[cfg(test)]
pub(crate) fn norm(x: &[f64]) -> f64 {
    dot(x, x).sqrt()
}

/// max |x_i|, 0 for an empty vector.
pub(crate) fn norm_max(x: &[f64]) -> f64 {
    x.iter().fold(0.0, |largest, value| largest.max(value.abs()))
}

/// y := y + a x.
pub(crate) fn axpy(a: f64, x: &[f64], y: &mut [f64]) {
    for (target, value) in y.iter_mut().zip(x) {
        *target += a * value;
    }
}
