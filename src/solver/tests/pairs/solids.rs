//! Boxes of isoparametric elements of every kind whose sides are surfaces of the seven shapes, perhaps distorted; edges are straight.

use std::collections::{BTreeMap, HashMap};

use crate::solver::{Problem, Shape, SparseInput, Storage};

const POISSON: f64 = 0.3;
/// Young's modulus is 1.
pub const LAME: f64 = POISSON / ((1.0 + POISSON) * (1.0 - 2.0 * POISSON));
pub const SHEAR: f64 = 0.5 / (1.0 + POISSON);

type Point = [f64; 3];
/// A node of an element: the corners in the middle of which it lies, as offsets of 0 or 1.
type Corners = Vec<[usize; 3]>;

/// An element: nodes, parent points and exponents of the monomials that span its functions.
struct Element {
    nodes: Vec<Corners>,
    points: Vec<Point>,
    monomials: Vec<[i32; 3]>,
    gauss: Vec<(Point, f64)>,
}

pub struct Solid {
    pub dim: usize,
    pub shape: Shape,
    /// Positions, `dim` per node.
    pub x: Vec<f64>,
    /// K of all directions by rows, plane strain in the plane.
    pub k: Vec<BTreeMap<usize, f64>>,
    /// Faces of the lower and the upper side.
    pub faces: [Vec<i64>; 2],
    /// -1: held.
    pub dof: Vec<i64>,
    pub free: usize,
}

fn all_below(n: usize, dim: usize) -> Vec<[usize; 3]> {
    let of = |i: usize| if i < dim { n } else { 1 };
    (0..of(2)).flat_map(|c| (0..of(1)).flat_map(move |b| (0..of(0)).map(move |a| [a, b, c]))).collect()
}

/// Gauss points on [0, 1]^dim.
fn gauss(dim: usize) -> Vec<(Point, f64)> {
    let line =
        [(0.112_701_665_379_258_3, 5.0 / 18.0), (0.5, 4.0 / 9.0), (0.887_298_334_620_741_7, 5.0 / 18.0)];
    let point = |at: [usize; 3]| {
        let of = |i: usize| if i < dim { line[at[i]] } else { (0.0, 1.0) };
        let [a, b, c] = [of(0), of(1), of(2)];
        ([a.0, b.0, c.0], a.1 * b.1 * c.1)
    };
    all_below(3, dim).into_iter().map(point).collect()
}

/// Boxes [0, 1]^dim; of a cell's simplices the one along the order of axes `order`.
fn elements(shape: Shape) -> Vec<Element> {
    let dim = if matches!(shape, Shape::Line2 | Shape::Line3) { 2 } else { 3 };
    let sum = |m: &[usize; 3], least: usize| m.iter().filter(|m| **m >= least).sum::<usize>();
    let power = |m: [usize; 3]| m.map(|m| m as i32);
    if !matches!(shape, Shape::Tri3 | Shape::Tri6) {
        // of the points on a grid of 3 those with an odd number of half coordinates, and of the monomials those of that degree
        let most = match shape {
            Shape::Line2 | Shape::Quad4 => 0,
            Shape::Quad9 => 3,
            _ => 1,
        };
        let halves = |at: &[usize; 3]| at.iter().filter(|i| **i == 1).count();
        let at: Vec<[usize; 3]> = all_below(3, dim).into_iter().filter(|at| halves(at) <= most).collect();
        let corners = |at: &[usize; 3]| {
            let on = |corner: &[usize; 3]| (0..3).all(|i| at[i] == 1 || at[i] == 2 * corner[i]);
            all_below(2, dim).into_iter().filter(on).collect()
        };
        let monomials = all_below(if most > 0 { 3 } else { 2 }, dim).into_iter();
        return vec![Element {
            nodes: at.iter().map(corners).collect(),
            points: at.iter().map(|at| at.map(|i| 0.5 * i as f64)).collect(),
            monomials: monomials.filter(|m| sum(m, 2) <= 2 * most).map(power).collect(),
            gauss: gauss(dim),
        }];
    }
    let degree = if shape == Shape::Tri3 { 1 } else { 2 };
    let orders = [[0, 1, 2], [1, 2, 0], [2, 0, 1], [0, 2, 1], [2, 1, 0], [1, 0, 2]];
    let simplex = |(k, order): (usize, [usize; 3])| {
        // the path from corner 0 to corner 1, 1, 1; every second one is turned to have a positive volume
        let mut path = vec![[0; 3]];
        order.iter().for_each(|axis| {
            let mut next = path[path.len() - 1];
            next[*axis] = 1;
            path.push(next);
        });
        if k >= 3 {
            path.swap(2, 3);
        }
        let parent = |k: usize| std::array::from_fn(|i| if i + 1 == k { 1.0 } else { 0.0 });
        let mut pairs: Vec<[usize; 2]> = (0..4).map(|k| [k, k]).collect();
        if degree == 2 {
            pairs.extend((0..4).flat_map(|a| (0..a).map(move |b| [b, a])));
        }
        let middle = |&[a, b]: &[usize; 2]| {
            let (a, b): (Point, Point) = (parent(a), parent(b));
            std::array::from_fn(|i| 0.5 * (a[i] + b[i]))
        };
        let collapsed = |([a, b, c], w): (Point, f64)| {
            ([a, (1.0 - a) * b, (1.0 - a) * (1.0 - b) * c], w * (1.0 - a) * (1.0 - a) * (1.0 - b))
        };
        Element {
            nodes: pairs
                .iter()
                .map(|[a, b]| if a == b { vec![path[*a]] } else { vec![path[*a], path[*b]] })
                .collect(),
            points: pairs.iter().map(middle).collect(),
            monomials: all_below(degree + 1, 3)
                .into_iter()
                .filter(|m| sum(m, 1) <= degree)
                .map(power)
                .collect(),
            gauss: gauss(3).into_iter().map(collapsed).collect(),
        }
    };
    orders.into_iter().enumerate().map(simplex).collect()
}

/// Solves `a x = b` for square `a` by rows, of size n.
fn solved(mut a: Vec<f64>, mut b: Vec<f64>, n: usize) -> Vec<f64> {
    let m = b.len() / n;
    for c in 0..n {
        let pivot = (c..n).max_by(|i, j| a[i * n + c].abs().total_cmp(&a[j * n + c].abs())).unwrap();
        (0..n).for_each(|j| a.swap(c * n + j, pivot * n + j));
        (0..m).for_each(|j| b.swap(c * m + j, pivot * m + j));
        for i in (0..n).filter(|i| *i != c) {
            let factor = a[i * n + c] / a[c * n + c];
            (c..n).for_each(|j| a[i * n + j] -= factor * a[c * n + j]);
            (0..m).for_each(|j| b[i * m + j] -= factor * b[c * m + j]);
        }
    }
    (0..n * m).map(|i| b[i] / a[i / m * n + i / m]).collect()
}

impl Element {
    /// Coefficients of the functions by monomials: monomial x node.
    fn coefficients(&self) -> Vec<f64> {
        let n = self.points.len();
        let value = |m: &[i32; 3], r: &Point| (0..3).map(|i| r[i].powi(m[i])).product::<f64>();
        let at = self.points.iter().flat_map(|r| self.monomials.iter().map(|m| value(m, r)));
        solved(at.collect(), (0..n * n).map(|i| if i % (n + 1) == 0 { 1.0 } else { 0.0 }).collect(), n)
    }

    /// Derivatives of the functions at r by parent coordinates.
    fn slopes(&self, coefficients: &[f64], r: &Point) -> Vec<Point> {
        let n = self.points.len();
        let slope = |m: &[i32; 3], a: usize| {
            let of = |i: usize| match i == a {
                true => f64::from(m[i]) * r[i].powi(m[i] - 1),
                false => r[i].powi(m[i]),
            };
            if m[a] == 0 {
                0.0
            } else {
                of(0) * of(1) * of(2)
            }
        };
        let of = |k: usize, a: usize| {
            self.monomials.iter().enumerate().map(|(m, of)| coefficients[m * n + k] * slope(of, a)).sum()
        };
        (0..n).map(|k| std::array::from_fn(|a| of(k, a))).collect()
    }
}

/// A box from `low` of `size` with `steps` cells. Its inner grid points are moved by up to the part `by` of a cell, on its sides along them.
pub fn solid(shape: Shape, low: &[f64], size: &[f64], steps: &[usize], by: f64) -> Solid {
    let random = crate::linalg::random::scattered(3 * 20_usize.pow(3));
    let corner = |at: [usize; 3]| -> Point {
        let of = |i: usize| {
            let moved = by / 1.5 * random[3 * (at[0] + 20 * (at[1] + 20 * at[2])) + i];
            let moved = if at[i] == 0 || at[i] == steps[i] { 0.0 } else { moved };
            low[i] + size[i] / steps[i] as f64 * (at[i] as f64 + moved)
        };
        std::array::from_fn(|i| if i < low.len() { of(i) } else { 0.0 })
    };
    mapped(shape, steps, corner, |x| x)
}

/// A grid with these corners, between which edges are straight, mapped by `to`.
pub fn mapped(
    shape: Shape,
    steps: &[usize],
    corner: impl Fn([usize; 3]) -> Point,
    to: impl Fn(Point) -> Point,
) -> Solid {
    let dim = steps.len();
    let (mut known, mut x): (HashMap<[usize; 3], usize>, Vec<f64>) = (HashMap::new(), Vec::new());
    let mut node = |cell: [usize; 3], corners: &Corners| {
        let at = corners.iter().map(|of| [0, 1, 2].map(|i| cell[i] + of[i]));
        let key = [0, 1, 2].map(|i| 4 * at.clone().map(|at| at[i]).sum::<usize>() / corners.len());
        *known.entry(key).or_insert_with(|| {
            let mean = |i: usize| at.clone().map(|at| corner(at)[i]).sum::<f64>() / corners.len() as f64;
            x.extend(&to([0, 1, 2].map(mean))[..dim]);
            x.len() / dim - 1
        })
    };
    let (mut parts, mut faces) = (Vec::new(), [Vec::new(), Vec::new()]);
    let kinds = elements(shape);
    let cells = all_below(*steps.iter().max().unwrap(), dim)
        .into_iter()
        .filter(|at| (0..dim).all(|i| at[i] < steps[i]));
    for cell in cells {
        for (kind, element) in kinds.iter().enumerate() {
            parts.push((kind, element.nodes.iter().map(|of| node(cell, of)).collect::<Vec<_>>()));
        }
        for (top, side) in [(false, 0), (true, steps[dim - 1] - 1)] {
            if cell[dim - 1] == side {
                let all = face_nodes(shape, top);
                faces[usize::from(top)].extend(all.iter().map(|of| node(cell, of) as i64));
            }
        }
    }
    let order = x.len();
    let mut k = vec![BTreeMap::new(); order];
    let coefficients: Vec<Vec<f64>> = kinds.iter().map(Element::coefficients).collect();
    for (kind, nodes) in &parts {
        for (r, weight) in &kinds[*kind].gauss {
            let slopes = kinds[*kind].slopes(&coefficients[*kind], r);
            let mut jacobian = vec![0.0; dim * dim];
            for (a, i) in (0..dim).flat_map(|a| (0..dim).map(move |i| (a, i))) {
                jacobian[a * dim + i] = nodes.iter().zip(&slopes).map(|(n, of)| of[a] * x[dim * n + i]).sum();
            }
            let right: Vec<f64> = (0..dim).flat_map(|a| slopes.iter().map(move |of| of[a])).collect();
            let gradients = solved(jacobian.clone(), right, dim);
            let gradient = |k: usize, i: usize| gradients[i * nodes.len() + k];
            let weight = weight * determinant(&jacobian, dim);
            for (a, b) in (0..nodes.len()).flat_map(|a| (0..nodes.len()).map(move |b| (a, b))) {
                let product: f64 = (0..dim).map(|i| gradient(a, i) * gradient(b, i)).sum();
                for (i, j) in (0..dim).flat_map(|i| (0..dim).map(move |j| (i, j))) {
                    let mut value =
                        LAME * gradient(a, i) * gradient(b, j) + SHEAR * gradient(a, j) * gradient(b, i);
                    value += if i == j { SHEAR * product } else { 0.0 };
                    *k[dim * nodes[a] + i].entry(dim * nodes[b] + j).or_insert(0.0) += weight * value;
                }
            }
        }
    }
    let dof = (0..order as i64).collect();
    Solid { dim, shape, x, k, faces, dof, free: order }
}

fn determinant(m: &[f64], dim: usize) -> f64 {
    let two = |i: usize, j: usize| m[i] * m[dim + j] - m[j] * m[dim + i];
    match dim {
        2 => two(0, 1),
        _ => m[6] * two(1, 2) - m[7] * two(0, 2) + m[8] * two(0, 1),
    }
}

/// Nodes of the faces of a cell on its lower or upper side, seen from outside counterclockwise; in the plane the body is on the left.
fn face_nodes(shape: Shape, top: bool) -> Vec<Corners> {
    let z = usize::from(top);
    let plan: &[&[[usize; 2]]] = match shape {
        Shape::Line2 | Shape::Line3 => &[&[[1, 0], [0, 0]]],
        Shape::Tri3 | Shape::Tri6 => &[&[[0, 0], [1, 0], [1, 1]], &[[0, 0], [1, 1], [0, 1]]],
        _ => &[&[[0, 0], [1, 0], [1, 1], [0, 1]]],
    };
    let mut all = Vec::new();
    for corners in plan {
        let lines = corners.len() == 2;
        let mut corners: Vec<[usize; 3]> =
            corners.iter().map(|[i, j]| if lines { [*i, z, 0] } else { [*i, *j, z] }).collect();
        if !top {
            corners.reverse();
        }
        let edges = if lines { 1 } else { corners.len() };
        all.extend(corners.iter().map(|corner| vec![*corner]));
        if !matches!(shape, Shape::Line2 | Shape::Tri3 | Shape::Quad4) {
            all.extend((0..edges).map(|k| vec![corners[k], corners[(k + 1) % corners.len()]]));
        }
        if shape == Shape::Quad9 {
            all.push(corners);
        }
    }
    all
}

impl Solid {
    /// Holds the directions `held(position)`.
    pub fn hold(&mut self, held: impl Fn(&[f64], usize) -> bool) {
        let mut free = 0;
        for i in 0..self.dof.len() {
            let node = i / self.dim * self.dim;
            self.dof[i] = if held(&self.x[node..node + self.dim], i - node) { -1 } else { free };
            free += i64::from(self.dof[i] >= 0);
        }
        self.free = free as usize;
    }

    /// Adds the body with loads on all its directions, and returns its number.
    pub fn give(&self, problem: &mut Problem, load: &[f64]) -> usize {
        let free: Vec<usize> = (0..self.dof.len()).filter(|&i| self.dof[i] >= 0).collect();
        let body = problem.add_body(self.free).unwrap();
        let (mut ptr, mut col, mut val) = (vec![0], Vec::new(), Vec::new());
        for i in &free {
            for (j, value) in self.k[*i].iter().filter(|(j, _)| self.dof[**j] >= 0) {
                col.push(self.dof[*j]);
                val.push(*value);
            }
            ptr.push(col.len());
        }
        let k = SparseInput { ptr: &ptr, col: &col, val: &val, storage: Storage::Full };
        problem.set_stiffness(body, k).unwrap();
        problem.set_load(body, &free.iter().map(|i| load[*i]).collect::<Vec<_>>()).unwrap();
        body
    }

    /// Adds one side as a surface.
    pub fn surface(&self, problem: &mut Problem, body: usize, top: bool) -> usize {
        let surface = problem
            .surface_add(Some(body), self.dim, &self.x, self.dim, Some((&self.dof, self.dim)))
            .unwrap();
        problem.surface_faces(surface, self.shape, &self.faces[usize::from(top)]).unwrap();
        surface
    }

    /// `K u` over all directions.
    pub fn forces(&self, u: &[f64]) -> Vec<f64> {
        self.k.iter().map(|row| row.iter().map(|(j, k)| k * u[*j]).sum()).collect()
    }
}
