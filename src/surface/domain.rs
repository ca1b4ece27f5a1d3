//! The parent interval, triangle or square, grown beyond some edges: where a foot may lie.

use crate::numbers::surface::ON_EDGE;
use crate::surface::shape::{Kind, Parent, Shape};

/// A convex polygon of parent points; the interval of a line.
#[derive(Debug, Clone, Copy)]
pub struct Domain {
    kind: Kind,
    vertices: [Parent; 4],
    /// Number of vertices.
    count: usize,
}

impl Domain {
    /// Grown beyond edge k by the part `growth(k)` of an edge.
    pub fn grown(shape: Shape, growth: impl Fn(usize) -> f64) -> Self {
        let kind = shape.kind();
        let (vertices, count) = match kind {
            Kind::Line => {
                let [a, b] = [0, 1].map(|k| 1.0 + 2.0 * growth(k));
                ([[-a, 0.0], [b, 0.0], [b, 0.0], [b, 0.0]], 2)
            }
            Kind::Triangle => {
                let [a, b, c] = [0, 1, 2].map(&growth);
                ([[-c, -a], [1.0 + b + a, -a], [-c, 1.0 + b + c], [-c, 1.0 + b + c]], 3)
            }
            Kind::Square => {
                let [a, b, c, d] = [0, 1, 2, 3].map(|k| 1.0 + 2.0 * growth(k));
                ([[-d, -a], [b, -a], [b, c], [-d, c]], 4)
            }
        };
        Self { kind, vertices, count }
    }

    /// Point with part t of edge k behind it.
    fn along(&self, k: usize, t: f64) -> Parent {
        let [a, b] = self.ends(k);
        if t == 1.0 {
            return b;
        }
        [a[0] + t * (b[0] - a[0]), a[1] + t * (b[1] - a[1])]
    }

    fn ends(&self, k: usize) -> [Parent; 2] {
        [self.vertices[k], self.vertices[(k + 1) % self.count]]
    }

    /// Distance of r from edge k, in lengths of the edge; negative outside.
    fn depth(&self, k: usize, r: Parent) -> f64 {
        if self.kind == Kind::Line {
            let [low, high] = [self.vertices[0][0], self.vertices[1][0]];
            return (if k == 0 { r[0] - low } else { high - r[0] }) / (high - low);
        }
        let [a, b] = self.ends(k);
        let e = [b[0] - a[0], b[1] - a[1]];
        (e[0] * (r[1] - a[1]) - e[1] * (r[0] - a[0])) / (e[0] * e[0] + e[1] * e[1])
    }

    /// The edges on which r lies.
    pub fn edges_of(&self, r: Parent) -> impl Iterator<Item = usize> + '_ {
        (0..self.count).filter(move |&k| self.depth(k, r) <= ON_EDGE)
    }

    /// The minimum of `g.p + p'Hp / 2` along an edge on which r lies, if g keeps r from leaving it; none where it has no minimum.
    pub fn minimum_on_edge(&self, r: Parent, g: [f64; 2], h: [f64; 3]) -> Option<Parent> {
        if self.kind == Kind::Line {
            return self
                .edges_of(r)
                .next()
                .filter(|k| if *k == 0 { g[0] >= 0.0 } else { g[0] <= 0.0 })
                .map(|_| r);
        }
        let mut stays = None;
        for k in self.edges_of(r) {
            let [a, b] = self.ends(k);
            let e = [b[0] - a[0], b[1] - a[1]];
            let curvature = e[0] * (h[0] * e[0] + h[2] * e[1]) + e[1] * (h[2] * e[0] + h[1] * e[1]);
            if e[0] * g[1] - e[1] * g[0] < 0.0 || !(curvature > 0.0) {
                return None;
            }
            let t = ((r[0] - a[0]) * e[0] + (r[1] - a[1]) * e[1]) / (e[0] * e[0] + e[1] * e[1]);
            let target = (t - (g[0] * e[0] + g[1] * e[1]) / curvature).clamp(0.0, 1.0);
            let target = if (target - t).abs() > f64::EPSILON { self.along(k, target) } else { r };
            if stays.is_none() || target != r {
                stays = Some(target);
            }
        }
        stays
    }

    /// The minimum over the domain of `g.p + p'Hp / 2`, p = target - r, H = (11, 22, 12) definite.
    pub fn minimum(&self, r: Parent, g: [f64; 2], h: [f64; 3]) -> Parent {
        if self.kind == Kind::Line {
            return [(r[0] - g[0] / h[0]).clamp(self.vertices[0][0], self.vertices[1][0]), 0.0];
        }
        let det = h[0] * h[1] - h[2] * h[2];
        let free = [r[0] - (h[1] * g[0] - h[2] * g[1]) / det, r[1] - (h[0] * g[1] - h[2] * g[0]) / det];
        let is_inside = match self.kind {
            Kind::Square => {
                let [low, _, high, _] = self.vertices;
                (0..2).all(|i| (low[i]..=high[i]).contains(&free[i]))
            }
            _ => (0..self.count).all(|k| self.depth(k, free) >= 0.0),
        };
        if is_inside {
            return free;
        }
        let (mut best, mut least) = (r, f64::INFINITY);
        for k in 0..self.count {
            let [a, b] = self.ends(k);
            let (e, p) = ([b[0] - a[0], b[1] - a[1]], [a[0] - r[0], a[1] - r[1]]);
            let times_h = |p: [f64; 2]| [h[0] * p[0] + h[2] * p[1], h[2] * p[0] + h[1] * p[1]];
            let (hp, he) = (times_h(p), times_h(e));
            let slope = e[0] * (g[0] + hp[0]) + e[1] * (g[1] + hp[1]);
            let target = self.along(k, (-slope / (e[0] * he[0] + e[1] * he[1])).clamp(0.0, 1.0));
            let p = [target[0] - r[0], target[1] - r[1]];
            let hp = times_h(p);
            let value = p[0] * (g[0] + 0.5 * hp[0]) + p[1] * (g[1] + 0.5 * hp[1]);
            if value < least {
                (best, least) = (target, value);
            }
        }
        best
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_grown_parent_has_its_edges_further_out() {
        for shape in Shape::ALL {
            let whole = Domain::grown(shape, |_| 0.0);
            let edges = shape.corners().len();
            for k in 0..edges {
                let corner = shape.corners()[k];
                let own: Vec<usize> = whole.edges_of(corner).collect();
                let expected = if edges == 2 { 1 } else { 2 };
                assert_eq!(own.len(), expected, "{shape:?}");
                let grown = Domain::grown(shape, |edge| if edge == k { 0.05 } else { 0.0 });
                assert_eq!(grown.edges_of(corner).count(), expected - 1, "{shape:?}");
                assert_eq!(grown.edges_of(shape.centre()).count(), 0);
            }
        }
    }

    #[test]
    fn the_minimum_of_a_quadratic_model_is_not_above_any_point_of_the_domain() {
        let random = crate::linalg::random::scattered(6000);
        for shape in [Shape::Line2, Shape::Tri3, Shape::Quad4] {
            let domain = Domain::grown(shape, |k| 0.02 * k as f64);
            for w in random.chunks(6) {
                let flat = shape == Shape::Line2;
                let r = domain.along(0, w[0] + 0.5);
                let g = [4.0 * w[1], if flat { 0.0 } else { 4.0 * w[2] }];
                let h = [1.5 + w[3], 1.5 + w[4], w[5]];
                let value = |t: Parent| {
                    let p = [t[0] - r[0], t[1] - r[1]];
                    let hp = [h[0] * p[0] + h[2] * p[1], h[2] * p[0] + h[1] * p[1]];
                    p[0] * (g[0] + 0.5 * hp[0]) + p[1] * (g[1] + 0.5 * hp[1])
                };
                let best = domain.minimum(r, g, h);
                assert!((0..domain.count).all(|k| domain.depth(k, best) >= -1e-15));
                for k in 0..domain.count {
                    for t in [0.0, 0.3, 0.7, 1.0] {
                        assert!(value(best) <= value(domain.along(k, t)) + 1e-14, "{shape:?}");
                        let inner = domain.along(k, t).map(|v| 0.4 * v);
                        assert!(value(best) <= value(inner) + 1e-14, "{shape:?}");
                    }
                }
            }
        }
    }
}
