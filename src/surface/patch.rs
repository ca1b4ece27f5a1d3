//! One face with the positions of its nodes: points, tangents, normals, and its point nearest to another.

use std::sync::OnceLock;

use crate::numbers::surface::{CONVEX, NEAR, NO_AREA};
use crate::surface::domain::Domain;
use crate::surface::shape::{Functions, Kind, Parent, Shape, MOST};
use crate::surface::vector::{cross, dot, length, minus, plus, times, unit, Vector, E_Z, ZERO};

/// `X(r) = sum_k N_k(r) x_k`
#[derive(Debug, Clone, Copy)]
pub struct Patch {
    pub shape: Shape,
    x: [Vector; MOST],
}

/// X and its derivatives at a point.
struct Taylor {
    x: Vector,
    /// X_,r and X_,s
    first: [Vector; 2],
    /// X_,rr, X_,ss and X_,rs
    second: [Vector; 3],
}

/// Steps of Newton's method; all faces of sensible form need fewer than ten.
const STEPS: usize = 60;
/// Halvings of one step.
const HALVINGS: usize = 30;

impl Patch {
    pub fn new(shape: Shape, nodes: impl Iterator<Item = Vector>) -> Self {
        let mut x = [ZERO; MOST];
        x.iter_mut().zip(nodes).for_each(|(to, from)| *to = from);
        Self { shape, x }
    }

    pub fn nodes(&self) -> &[Vector] {
        &self.x[..self.shape.nodes()]
    }

    pub fn point(&self, r: Parent) -> Vector {
        Functions::sum(&self.shape.at(r).n, self.nodes())
    }

    /// X_1 and X_2; in the plane X_2 is the normal of the plane.
    pub fn tangents(&self, of: &Functions) -> [Vector; 2] {
        let sum = |a: usize| Functions::sum(&of.first[a], self.nodes());
        [sum(0), if self.shape.kind() == Kind::Line { E_Z } else { sum(1) }]
    }

    /// The unit normal, outward by the order of the nodes; that of the centre where the face has none.
    pub fn normal(&self, of: &Functions) -> Vector {
        let at = |of: &Functions| {
            let [a, b] = self.tangents(of);
            let n = cross(a, b);
            (length(n) > NO_AREA * length(a) * length(b)).then(|| unit(n)).flatten()
        };
        at(of).or_else(|| at(&self.shape.at(self.shape.centre()))).unwrap_or(E_Z)
    }

    pub fn centre_normal(&self) -> Vector {
        self.normal(&self.shape.at(self.shape.centre()))
    }

    /// Vectors along the edges that leave corner k: to the next corner, and to the one before.
    pub fn edges_at(&self, k: usize) -> [Vector; 2] {
        let corners = self.shape.corners();
        let (next, before) = ((k + 1) % corners.len(), (k + corners.len() - 1) % corners.len());
        if !self.shape.is_quadratic() {
            return [minus(self.x[next], self.x[k]), minus(self.x[before], self.x[k])];
        }
        let [a, b] = self.tangents(&self.shape.at(corners[k]));
        [next, before].map(|to| {
            let d = [corners[to][0] - corners[k][0], corners[to][1] - corners[k][1]];
            plus(times(d[0], a), d[1], b)
        })
    }

    /// Length of the longest chord between corners.
    pub fn size(&self) -> f64 {
        let corners = &self.x[..self.shape.corners().len()];
        let ends = (0..corners.len()).map(|k| (corners[k], corners[(k + 1) % corners.len()]));
        ends.map(|(a, b)| length(minus(a, b))).fold(0.0, f64::max)
    }

    /// The positions of a straight sub-face, its last corner repeated in triangles and lines.
    pub fn sub_face(&self, of: &[usize; 4]) -> [Vector; 4] {
        of.map(|k| self.x[k])
    }

    /// How far the face may leave the box of its corners in each direction: sum |mid - mean of the corners| over edges and centre, since
    /// each term of the quadratic part is at most that. (On triangles the sum of two terms may exceed the larger by a third.)
    pub fn sagitta(&self) -> Vector {
        let (shape, corners) = (self.shape, self.shape.corners().len());
        let mut sum = ZERO;
        let mut add = |mid: usize, mean: Vector| {
            let bulge = minus(self.x[mid], mean);
            (0..3).for_each(|i| sum[i] += bulge[i].abs());
        };
        let half = |a: usize, b: usize| times(0.5, plus(self.x[a], 1.0, self.x[b]));
        if shape == Shape::Line3 {
            add(2, half(0, 1));
        } else if shape.is_quadratic() {
            (0..corners).for_each(|k| add(corners + k, half(k, (k + 1) % corners)));
        }
        if shape == Shape::Quad9 {
            add(8, times(0.5, plus(half(4, 6), 1.0, half(5, 7))));
            add(8, times(0.5, plus(half(0, 2), 1.0, half(1, 3))));
        }
        sum
    }

    /// An affine image of its parent, but for bulge and twist of this part of its size.
    pub fn is_affine(&self, part: f64) -> bool {
        let twist = match self.shape.kind() {
            Kind::Square => minus(plus(self.x[0], 1.0, self.x[2]), plus(self.x[1], 1.0, self.x[3])),
            _ => ZERO,
        };
        length(self.sagitta()) + length(twist) <= part * self.size()
    }

    fn taylor(&self, r: Parent) -> Taylor {
        let (f, x) = (self.shape.at(r), self.nodes());
        let none = self.shape.kind() == Kind::Line;
        let first =
            [Functions::sum(&f.first[0], x), if none { ZERO } else { Functions::sum(&f.first[1], x) }];
        let second = match self.shape {
            Shape::Line2 | Shape::Tri3 => [ZERO; 3],
            _ => f.second.map(|w| Functions::sum(&w, x)),
        };
        Taylor { x: Functions::sum(&f.n, x), first, second }
    }

    /// The point of the face over `domain` nearest to x: the best of the minima that Newton's method finds from several starts, on quadratic
    /// faces from the nodes and from each sample that is nearer than those around it.
    pub fn nearest(&self, x: Vector, domain: &Domain) -> Parent {
        let far = |d: Vector| dot(d, d);
        let mut best = (self.shape.centre(), f64::INFINITY);
        let mut from = |start: Parent| {
            let end = self.descent(x, domain, start);
            let at = far(minus(self.point(end), x));
            if at < best.1 {
                best = (end, at);
            }
        };
        if matches!(self.shape, Shape::Line2 | Shape::Tri3) || self.is_convex_from(x) {
            return self.descent(x, domain, self.shape.centre());
        }
        if self.shape.is_quadratic() {
            let samples = samples(self.shape);
            let mut at = [f64::INFINITY; SAMPLES * SAMPLES];
            for (at, sample) in at.iter_mut().zip(samples) {
                *at = far(minus(Functions::sum(&sample.n, self.nodes()), x));
            }
            let is_least = |k: &usize| samples[*k].around.iter().all(|j| at[*k] <= at[*j as usize]);
            (0..samples.len()).filter(is_least).for_each(|k| from(samples[k].r));
            (0..self.shape.nodes()).for_each(|k| from(self.shape.place(k)));
            return best.0;
        }
        from(self.shape.centre());
        let corner = |k: usize| far(minus(self.x[k], x));
        let nearest = (1..4).fold(0, |least, k| if corner(k) < corner(least) { k } else { least });
        from(self.shape.place(nearest));
        best.0
    }

    /// One minimum at most: (X - x).X_ab is below X_a.X_b on the whole face, as on the parallelogram of its corners. |X - x| is at most its
    /// value at the centre and the longest edge; |X_ab| four times bulge and twist; the least eigenvalue of X_a.X_b height^2 / 8.
    fn is_convex_from(&self, x: Vector) -> bool {
        let (corners, kind) = (self.shape.corners().len(), self.shape.kind());
        let edge = |k: usize| minus(self.x[(k + 1) % corners], self.x[k]);
        let longest = (0..corners).map(|k| length(edge(k))).fold(0.0, f64::max);
        let (area, twist) = match kind {
            Kind::Line => (longest * longest, ZERO),
            Kind::Triangle => (length(cross(edge(0), edge(1))), ZERO),
            Kind::Square => (
                length(cross(edge(0), edge(1))).min(length(cross(edge(2), edge(3)))),
                plus(edge(0), 1.0, edge(2)),
            ),
        };
        let curvature = length(self.sagitta()) + 0.5 * length(twist);
        let centre = (0..corners).fold(ZERO, |sum, k| plus(sum, 1.0 / corners as f64, self.x[k]));
        let far = length(minus(x, centre)) + longest;
        far * curvature * longest * longest <= CONVEX * area * area
    }

    /// Newton's method for `|X(r) - x|^2 / 2 -> min` over the domain. Each step goes to the minimum of the quadratic model over the whole
    /// domain, which gives the active edges; steps are halved until the distance falls.
    /// No step is longer than the distance of two samples: a longer one may end at another minimum, which is lower than the start only.
    fn descent(&self, x: Vector, domain: &Domain, start: Parent) -> Parent {
        let reach = if self.shape.is_quadratic() { self.shape.extent() / LAST as f64 } else { f64::INFINITY };
        let (mut r, mut is_near) = (start, false);
        for _ in 0..STEPS {
            let at = self.taylor(r);
            let d = minus(at.x, x);
            let (target, squares) = at.target(domain, r, d);
            let step = [target[0] - r[0], target[1] - r[1]];
            let size = step[0].abs().max(step[1].abs());
            if !(size > 2.0 * f64::EPSILON) {
                break;
            }
            if squares && size <= NEAR {
                r = target;
                if is_near {
                    break;
                }
                is_near = true;
                continue;
            }
            let (mut share, before) = (reach / size, dot(d, d));
            let mut trial = target;
            for _ in 0..HALVINGS {
                if share < 1.0 {
                    trial = [r[0] + share * step[0], r[1] + share * step[1]];
                }
                let d = minus(self.point(trial), x);
                if dot(d, d) < before {
                    break;
                }
                share = 0.5 * share.min(1.0);
            }
            (r, is_near) = (trial, false);
        }
        r
    }
}

impl Taylor {
    /// Where Newton's method goes from r, and whether its error squares there; d = X - x. With `H_ab = X_a.X_b + d.X_ab` (11, 22, 12) where
    /// that is definite in the domain, or along the edge on which the minimum stays; otherwise with `X_a.X_b` alone (Gauss-Newton).
    fn target(&self, domain: &Domain, r: Parent, d: Vector) -> (Parent, bool) {
        let [a, b] = self.first;
        let g = [dot(d, a), dot(d, b)];
        let gauss = [dot(a, a), dot(b, b), dot(a, b)];
        // a line extends in one direction
        let filled = |h: [f64; 3]| [h[0], if gauss[1] > 0.0 { h[1] } else { h[0].abs().max(1.0) }, h[2]];
        let whole = filled(std::array::from_fn(|k| gauss[k] + dot(d, self.second[k])));
        if is_definite(&whole) {
            return (domain.minimum(r, g, whole), true);
        }
        if let Some(target) = domain.minimum_on_edge(r, g, whole) {
            return (target, true);
        }
        let (gauss, largest) = (filled(gauss), gauss[0].max(gauss[1]));
        let h = if is_definite(&gauss) {
            gauss
        } else {
            [largest, largest, 0.0].map(|h| if largest > 0.0 { h } else { 1.0 })
        };
        (domain.minimum(r, g, h), false)
    }
}

fn is_definite(h: &[f64; 3]) -> bool {
    h[0] > 0.0 && h[1] > 0.0 && h[0] * h[1] - h[2] * h[2] > NEAR * NEAR * h[0] * h[1]
}

/// Last sample along each direction of a quadratic face, from 0.
const LAST: usize = 4;
const SAMPLES: usize = LAST + 1;

/// A sample of a shape: its point, the functions there, and the numbers of the samples around it.
struct Sample {
    r: Parent,
    n: [f64; MOST],
    around: Vec<u8>,
}

/// The samples of a quadratic shape.
fn samples(shape: Shape) -> &'static [Sample] {
    static ALL: [OnceLock<Vec<Sample>>; 4] = [const { OnceLock::new() }; 4];
    let which = match shape {
        Shape::Line3 => 0,
        Shape::Tri6 => 1,
        Shape::Quad8 => 2,
        _ => 3,
    };
    ALL[which].get_or_init(|| {
        let all = (0..SAMPLES * SAMPLES).map(|at| [at % SAMPLES, at / SAMPLES]);
        let places: Vec<[usize; 2]> = match shape.kind() {
            Kind::Line => all.take(SAMPLES).collect(),
            Kind::Triangle => all.filter(|[i, j]| i + j <= LAST).collect(),
            Kind::Square => all.collect(),
        };
        let sample = |&[i, j]: &[usize; 2]| {
            let [r, s] = [i, j].map(|i| i as f64 / LAST as f64);
            let r = match shape.kind() {
                Kind::Line => [2.0 * r - 1.0, 0.0],
                Kind::Triangle => [r, s],
                Kind::Square => [2.0 * r - 1.0, 2.0 * s - 1.0],
            };
            let near = |&(_, [k, l]): &(usize, &[usize; 2])| k.abs_diff(i) <= 1 && l.abs_diff(j) <= 1;
            let around = places.iter().enumerate().filter(near).map(|(at, _)| at as u8).collect();
            Sample { r, n: shape.at(r).n, around }
        };
        places.iter().map(sample).collect()
    })
}

#[cfg(test)]
mod tests;
