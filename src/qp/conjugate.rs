//! Directions stored with their images, conjugate to each other: `p_i'A p_j = sigma` for i = j, else 0. They lie on the
//! present face and in the kernel of G, so that theta is minimised over their span without a product: P8 and P13 of
//! docs/method.md.

use crate::linalg::vector::{add_multiples, axpy, dot, dots, norm, norm_max, power_of_two_below, LONG};
use crate::numbers::linalg::DEPENDENT;
use crate::numbers::rounding;

/// More directions than this cost more than the products they save.
pub const MOST: usize = 100;

/// A direction p and, behind it, its image A p.
type Pair = Box<[f64]>;

#[derive(Default)]
pub struct Conjugate {
    /// Oldest first.
    pairs: Vec<Pair>,
    /// sigma: the largest power of two that does not exceed the Rayleigh quotient of the first direction, so that powers
    /// of two in A change no other bit.
    curvature: f64,
}

impl Conjugate {
    /// `z <- z - sum p_i (A p_i)'z / sigma`
    pub fn make_conjugate(&self, z: &mut [f64]) {
        for pairs in self.groups(z.len()) {
            let shares = self.shares(&images(pairs), z, -1.0);
            add_multiples(&shares, &directions(pairs), z);
        }
    }

    /// Adds (p, A p) after removing the part that is not conjugate to the others.
    pub fn push(&mut self, p: &[f64], image: &[f64]) {
        let (m, whole) = (p.len(), dot(p, image));
        let mut pair: Pair = [p, image].concat().into();
        for pairs in self.groups(m) {
            let shares = self.shares(&directions(pairs), &pair[m..], -1.0);
            // conjugate up to rounding: the energy product is below this part of the energies
            let rounded = rounding::METHOD * (whole / self.curvature).sqrt();
            if m < LONG || norm_max(&shares) > rounded {
                add_multiples(&shares, &both(pairs), &mut pair);
            }
        }
        let (p, image) = pair.split_at(m);
        let curvature = dot(p, image);
        if whole > 0.0 && curvature > DEPENDENT * whole {
            if self.pairs.is_empty() {
                self.curvature = power_of_two_below(curvature / dot(p, p));
            }
            let length = (curvature / self.curvature).sqrt();
            pair.iter_mut().for_each(|v| *v /= length);
            if self.pairs.len() == MOST {
                self.pairs.remove(0);
            }
            // small problems, of which there may be very many, keep one
            self.pairs.reserve_exact(1);
            self.pairs.push(pair);
        }
    }

    /// `d = sum p_i p_i'g / sigma` and A d: `x - d` has the least theta on x + span. `None` without directions.
    pub fn minimiser(&self, g: &[f64]) -> Option<(Vec<f64>, Vec<f64>)> {
        let mut d = vec![0.0; 2 * g.len()];
        let shares = self.shares(&directions(&self.pairs), g, 1.0);
        add_multiples(&shares, &both(&self.pairs), &mut d);
        let image = d.split_off(g.len());
        (!self.pairs.is_empty()).then_some((d, image))
    }

    /// Directions that are subtracted from a vector together: all of them from a long vector, which is read once; one
    /// after the other from a short vector, so that each removes the rounding of the previous one.
    fn groups(&self, length: usize) -> std::slice::Chunks<'_, Pair> {
        self.pairs.chunks(if length < LONG { 1 } else { MOST })
    }

    /// `a v_i'z / sigma`
    fn shares(&self, v: &[&[f64]], z: &[f64], a: f64) -> Vec<f64> {
        dots(v, z).iter().map(|share| a * share / self.curvature).collect()
    }

    /// Some direction has an entry in row i.
    pub fn moves(&self, i: usize) -> bool {
        self.pairs.iter().any(|pair| pair[i] != 0.0)
    }

    pub fn is_empty(&self) -> bool {
        self.pairs.is_empty()
    }

    pub fn forget(&mut self) {
        self.pairs.clear();
    }

    /// Keeps the directions of the span that are zero on row i: one fewer than before, by a reflection that maps the row
    /// to (0, ..., 0, length).
    pub fn hold(&mut self, i: usize) {
        let mut w: Vec<f64> = self.pairs.iter().map(|pair| pair[i]).collect();
        let Some(&last) = w.last() else { return };
        let length = norm(&w);
        // nothing is left: the row depends on others that are held
        if length <= rounding::SOLVE * directions(&self.pairs).into_iter().map(norm_max).fold(0.0, f64::max) {
            self.pairs.iter_mut().for_each(|pair| pair[i] = 0.0);
            return;
        }
        let k = w.len() - 1;
        w[k] += length.copysign(last);
        let scale = 2.0 / dot(&w, &w);
        let mut sum = vec![0.0; self.pairs[0].len()];
        self.pairs.iter().zip(&w).for_each(|(pair, w)| axpy(*w, pair, &mut sum));
        self.pairs.iter_mut().zip(&w).for_each(|(pair, w)| axpy(-scale * w, &sum, pair));
        self.pairs.pop();
        self.pairs.iter_mut().for_each(|pair| pair[i] = 0.0);
    }
}

fn directions(pairs: &[Pair]) -> Vec<&[f64]> {
    pairs.iter().map(|pair| &pair[..pair.len() / 2]).collect()
}

fn images(pairs: &[Pair]) -> Vec<&[f64]> {
    pairs.iter().map(|pair| &pair[pair.len() / 2..]).collect()
}

fn both(pairs: &[Pair]) -> Vec<&[f64]> {
    pairs.iter().map(|pair| &pair[..]).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    /// `(A x)_i = 2 x_i - x_(i-1) - x_(i+1)`
    fn image(x: &[f64]) -> Vec<f64> {
        let at = |i: usize| x.get(i).copied().unwrap_or(0.0);
        (0..x.len()).map(|i| 2.0 * x[i] - if i > 0 { at(i - 1) } else { 0.0 } - at(i + 1)).collect()
    }

    fn kept() -> Conjugate {
        let mut kept = Conjugate::default();
        for p in [[1.0, 2.0, 0.0, 1.0, -1.0], [0.0, 1.0, 3.0, -2.0, 0.5], [2.0, 0.0, 1.0, 1.0, 4.0]] {
            kept.push(&p, &image(&p));
        }
        kept
    }

    fn assert_conjugate(kept: &Conjugate) {
        for (j, pair) in kept.pairs.iter().enumerate() {
            let (p, of_p) = pair.split_at(5);
            assert!(image(p).iter().zip(of_p).all(|(a, b)| (a - b).abs() < 1e-14), "the image of {p:?}");
            for (k, other) in images(&kept.pairs).into_iter().enumerate() {
                let expected = if j == k { kept.curvature } else { 0.0 };
                assert!((dot(p, other) - expected).abs() < 1e-14, "{j} {k}");
            }
        }
    }

    #[test]
    fn a_row_that_is_held_costs_one_direction_and_leaves_the_others_conjugate_with_their_images() {
        let mut kept = kept();
        assert_conjugate(&kept);
        kept.hold(3);
        assert_eq!(kept.pairs.len(), 2);
        assert_conjugate(&kept);
        assert!(kept.pairs.iter().all(|pair| pair[3] == 0.0));
    }

    #[test]
    fn the_minimiser_leaves_no_slope_along_any_direction() {
        let (kept, mut g) = (kept(), vec![1.0, -2.0, 0.5, 3.0, 1.0]);
        let (_, of_d) = kept.minimiser(&g).unwrap();
        axpy(-1.0, &of_d, &mut g);
        assert!(directions(&kept.pairs).into_iter().all(|p| dot(p, &g).abs() < 1e-14));
        assert!(Conjugate::default().minimiser(&g).is_none());
    }

    #[test]
    fn a_direction_of_the_span_is_not_kept_twice() {
        let mut kept = kept();
        let p: Vec<f64> = (0..5).map(|i| kept.pairs[0][i] - 3.0 * kept.pairs[2][i]).collect();
        kept.push(&p, &image(&p));
        assert_eq!(kept.pairs.len(), 3);
    }
}
