//! Convex polygons in the plane of a slave face, counterclockwise; in problems of the plane intervals of its line.

use crate::linalg::vector::NOISE;

/// Coordinates in the plane of a face, length; on a line the second is 0.
pub type Flat = [f64; 2];

/// Corners of a convex polygon, or the ends of an interval.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Polygon(pub Vec<Flat>);

/// The points with `m.z >= c`.
type Half = (Flat, f64);

impl Polygon {
    /// Twice the area to the left of a, b, c.
    fn doubled(a: Flat, b: Flat, c: Flat) -> f64 {
        (b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0])
    }

    fn is_interval(&self) -> bool {
        self.0.len() == 2
    }

    /// Area, or length of an interval.
    pub fn area(&self) -> f64 {
        match &self.0[..] {
            [a, b] => b[0] - a[0],
            [a, rest @ ..] => 0.5 * rest.windows(2).map(|b| Self::doubled(*a, b[0], b[1])).sum::<f64>(),
            [] => 0.0,
        }
    }

    /// Of its area; corners that lie on each other do not shift it.
    pub fn centroid(&self) -> Flat {
        let [a, rest @ ..] = &self.0[..] else { return [0.0; 2] };
        if let [b] = rest {
            return [0.5 * (a[0] + b[0]), 0.0];
        }
        let (mut sum, mut area) = ([0.0; 2], 0.0);
        for of in rest.windows(2) {
            let doubled = Self::doubled(*a, of[0], of[1]);
            area += doubled;
            (0..2).for_each(|i| sum[i] += doubled * ((of[0][i] - a[i]) + (of[1][i] - a[i])) / 3.0);
        }
        [0, 1].map(|i| a[i] + if area > 0.0 { sum[i] / area } else { 0.0 })
    }

    /// Triangles that fill it: around the centroid, or from its first corner, which are fewer.
    pub fn triangles(&self, around: bool) -> impl Iterator<Item = [Flat; 3]> + '_ {
        let (z, count) = (&self.0, self.0.len());
        let (apex, skipped) = if around { (self.centroid(), 0) } else { (z[0], 1) };
        (skipped..count - skipped).map(move |k| [apex, z[k], z[(k + 1) % count]])
    }

    /// Its convex parts: a quadrilateral with a corner that turns inwards is two triangles.
    pub fn convex_parts(self) -> Vec<Self> {
        let (z, count) = (&self.0, self.0.len());
        let turns_in = |k: &usize| Self::doubled(z[(k + count - 1) % count], z[*k], z[(k + 1) % count]) < 0.0;
        match (0..count).find(turns_in).filter(|_| count == 4) {
            Some(k) => [[0, 1, 2], [0, 2, 3]].map(|of| Self(of.map(|j| z[(k + j) % 4]).to_vec())).into(),
            None => vec![self],
        }
    }

    /// Of edges as short as rounding none: they have no direction.
    fn halves(&self) -> Vec<Half> {
        let z = &self.0;
        let half = |k: usize| {
            let (a, b) = (z[k], z[(k + 1) % z.len()]);
            let m = if self.is_interval() { [b[0] - a[0], 0.0] } else { [a[1] - b[1], b[0] - a[0]] };
            (m, m[0] * a[0] + m[1] * a[1])
        };
        let size = |(m, _): &Half| m[0].abs().max(m[1].abs());
        let mut halves: Vec<Half> = (0..z.len()).map(half).collect();
        let longest = halves.iter().map(size).fold(0.0, f64::max);
        halves.retain(|half| size(half) > NOISE * longest);
        halves
    }

    fn cut(&self, (m, c): Half) -> Self {
        let count = self.0.len();
        let mut kept = Vec::with_capacity(count + 1);
        let side = |z: Flat| m[0] * z[0] + m[1] * z[1] - c;
        for k in 0..count {
            let (a, b) = (self.0[k], self.0[(k + 1) % count]);
            let (of_a, of_b) = (side(a), side(b));
            if of_a >= 0.0 {
                kept.push(a);
            }
            let crosses = (of_a > 0.0 && of_b < 0.0) || (of_a < 0.0 && of_b > 0.0);
            if crosses && !(self.is_interval() && k == 1) {
                let t = of_a / (of_a - of_b);
                kept.push([0, 1].map(|i| a[i] + t * (b[i] - a[i])));
            }
        }
        let fewest = if self.is_interval() { 2 } else { 3 };
        Self(if kept.len() < fewest { Vec::new() } else { kept })
    }

    /// What both cover (Sutherland and Hodgman).
    pub fn common(&self, other: &Self) -> Self {
        let apart = |i: usize| {
            let of = |of: &Self| {
                of.0.iter().fold([f64::INFINITY, f64::NEG_INFINITY], |[low, high], z| {
                    [low.min(z[i]), high.max(z[i])]
                })
            };
            let ([low, high], [from, to]) = (of(self), of(other));
            low > to || from > high
        };
        if self.0.is_empty() || other.0.is_empty() || apart(0) || apart(1) {
            return Self::default();
        }
        let mut common = self.clone();
        for half in other.halves() {
            common = common.cut(half);
            if common.0.is_empty() {
                break;
            }
        }
        common
    }

    /// What `other` does not cover, in convex parts.
    pub fn without(&self, other: &Self) -> Vec<Self> {
        let (mut rest, mut parts) = (self.clone(), Vec::new());
        for (m, c) in other.halves() {
            parts.push(rest.cut((m.map(|m| -m), -c)));
            rest = rest.cut((m, c));
        }
        parts.retain(|part| !part.0.is_empty());
        parts
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn square(low: Flat, size: f64) -> Polygon {
        let [x, y] = low;
        Polygon(vec![[x, y], [x + size, y], [x + size, y + size], [x, y + size]])
    }

    #[test]
    fn what_is_common_and_what_is_left_fill_a_polygon() {
        let whole = square([0.0, 0.0], 1.0);
        let turned = Polygon(vec![[0.5, -0.2], [1.3, 0.6], [0.5, 1.1], [-0.1, 0.5]]);
        for other in [square([0.3, 0.4], 0.2), square([0.7, 0.6], 2.0), square([1.0, 0.0], 1.0), turned] {
            let common = whole.common(&other);
            let rest: f64 = whole.without(&other).iter().map(Polygon::area).sum();
            assert!((common.area() + rest - 1.0).abs() < 1e-15, "{other:?}");
            assert!((common.area() - other.common(&whole).area()).abs() < 1e-15);
            for around in [true, false].into_iter().filter(|_| !common.0.is_empty()) {
                let sum: f64 =
                    common.triangles(around).map(|[a, b, c]| 0.5 * Polygon::doubled(a, b, c)).sum();
                assert!((sum - common.area()).abs() < 1e-15);
            }
        }
        assert_eq!(whole.common(&square([2.0, 0.0], 1.0)), Polygon::default());
    }

    #[test]
    fn intervals_are_cut_exactly() {
        let interval = |a: f64, b: f64| Polygon(vec![[a, 0.0], [b, 0.0]]);
        let whole = interval(0.0, 1.0);
        assert_eq!(whole.common(&interval(0.25, 3.0)), interval(0.25, 1.0));
        assert_eq!(whole.common(&interval(-1.0, 0.5)), interval(0.0, 0.5));
        assert_eq!(whole.without(&interval(0.25, 0.5)), [interval(0.0, 0.25), interval(0.5, 1.0)]);
        assert_eq!(whole.common(&interval(2.0, 3.0)), Polygon::default());
    }

    #[test]
    fn a_corner_that_turns_inwards_makes_two_triangles() {
        let arrow = Polygon(vec![[0.0, 0.0], [1.0, -1.0], [0.3, 0.0], [1.0, 1.0]]);
        let area = arrow.area();
        let parts = arrow.convex_parts();
        assert!(parts.len() == 2 && parts.iter().all(|part| part.area() > 0.0));
        assert!((parts.iter().map(Polygon::area).sum::<f64>() - area).abs() < 1e-15);
    }
}
