//! Points and weights on triangles and intervals of a plane.

use std::f64::consts::PI;
use std::sync::OnceLock;

use crate::surface::mortar::polygon::{Flat, Polygon};
use crate::surface::shape::Parent;

type Line = [(f64, f64)];

/// Points of the triangles of a polygon, in each of two directions.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Rule {
    /// Exact to degree 4.
    Three,
    /// Exact to degree 6.
    Four,
    /// The same on the smaller triangles around the centroid.
    FourAround,
}

/// Gauss's n points and weights on [0, 1], n = 3 or 4: zeros of Legendre's polynomial P_n by Newton's method from those of Chebyshev's.
fn gauss(n: usize) -> &'static Line {
    /// All digits are there after 5.
    const STEPS: usize = 10;
    static RULES: [OnceLock<Vec<(f64, f64)>>; 2] = [const { OnceLock::new() }; 2];
    RULES[n - 3].get_or_init(|| {
        let slope_at = |x: f64| {
            let next = |(low, high): (f64, f64), k: usize| {
                (high, ((2 * k + 1) as f64 * x * high - k as f64 * low) / (k + 1) as f64)
            };
            let (low, high) = (1..n).fold((1.0, x), next);
            (high, n as f64 * (x * high - low) / (x * x - 1.0))
        };
        let point = |i: usize| {
            let start = (PI * (2 * i + 1) as f64 / (2 * n) as f64).cos();
            let x = (0..STEPS).fold(start, |x, _| {
                let (p, slope) = slope_at(x);
                x - p / slope
            });
            let slope = slope_at(x).1;
            (0.5 * (1.0 - x), 1.0 / ((1.0 - x * x) * slope * slope))
        };
        (0..n).map(point).collect()
    })
}

/// Points of a polygon or interval with their weights, area.
pub fn points(of: &Polygon, which: Rule, mut at: impl FnMut(Flat, f64)) {
    let rule = gauss(if which == Rule::Three { 3 } else { 4 });
    if let [a, b] = of.0[..] {
        let length = b[0] - a[0];
        return rule.iter().for_each(|(t, w)| at([a[0] + t * length, 0.0], w * length));
    }
    for [a, b, c] in of.triangles(which == Rule::FourAround) {
        let (p, q) = ([b[0] - a[0], b[1] - a[1]], [c[0] - b[0], c[1] - b[1]]);
        let doubled = p[0] * q[1] - p[1] * q[0];
        if !(doubled > 0.0) {
            continue;
        }
        // z = a + s (p + t q), dA = doubled s ds dt
        for ((s, w), (t, v)) in rule.iter().flat_map(|s| rule.iter().map(move |t| (s, t))) {
            let z = [0, 1].map(|i| a[i] + s * (p[i] + t * q[i]));
            at(z, w * v * s * doubled);
        }
    }
}

/// 3 x 3 points of the parent square.
pub fn of_square() -> impl Iterator<Item = (Parent, f64)> {
    let rule = gauss(3);
    let all = rule.iter().flat_map(move |s| rule.iter().map(move |t| (s, t)));
    all.map(|((s, w), (t, v))| ([2.0 * s - 1.0, 2.0 * t - 1.0], 4.0 * w * v))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn polynomials_over_a_polygon_are_integrated_exactly() {
        let polygon = Polygon(vec![[0.0, 0.0], [2.0, 0.0], [2.0, 1.0], [0.0, 1.0]]);
        for (which, degree) in [(Rule::Three, 4), (Rule::Four, 6), (Rule::FourAround, 6)] {
            for (i, j) in (0..=degree).flat_map(|i| (0..=degree - i).map(move |j| (i, j))) {
                let mut sum = 0.0;
                points(&polygon, which, |z, w| sum += w * z[0].powi(i) * z[1].powi(j));
                let exact = 2f64.powi(i + 1) / f64::from((i + 1) * (j + 1));
                assert!((sum - exact).abs() < 1e-14 * exact, "{which:?} {i} {j}: {sum} {exact}");
            }
        }
    }
}
