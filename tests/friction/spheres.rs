//! Mindlin's two spheres: equal and elastic, Poisson's ratio 0, pressed together and pushed along, against the closed form, which is
//! exact for this ratio: then the surfaces move along the force alone, and the slip has the direction of the shear everywhere.

use feti_contact::error::Result;
use feti_contact::linalg::{Csr, Matrix, Operator, SpdSolver};
use feti_contact::qp::friction::{
    friction, known_face, Cones, Coordinate, Face, FacePreconditioner, FrictionLimits, FrictionProblem,
    FrictionStart, Law, Node, OnFace,
};
use feti_contact::qp::{Qp, Verdict};

use crate::friction::problem::Content;

const PI: f64 = std::f64::consts::PI;
const MU: f64 = 0.3;
/// Direction of the push in the plane of contact.
const ALONG: [f64; 2] = [0.6, 0.8];
/// Side of the square of cells, in radii of the contact. How the circle's edge falls among the cells moves all errors by a factor of
/// about two; with this side the outermost centres lie outside of the circle on both grids.
const SIDE: f64 = 2.16;

/// A (n^2 x n^2, displacement by force) for the normal and both tangential directions: row 3 i + k is direction k of cell i.
struct InThreeDirections(Matrix);

impl Operator for InThreeDirections {
    fn order(&self) -> usize {
        3 * self.0.rows
    }

    fn apply(&self, x: &[f64], y: &mut [f64]) {
        for k in 0..3 {
            let own: Vec<f64> = x.iter().skip(k).step_by(3).copied().collect();
            let mut image = vec![0.0; own.len()];
            self.0.mul_add(1.0, &own, &mut image);
            y.iter_mut().skip(k).step_by(3).zip(image).for_each(|(y, v)| *y = v);
        }
    }
}

/// `M = H^-1 (W' A^-1 W + D) H^-1`, `H = I + D`, which is diagonal.
struct Inverse(InThreeDirections);

struct OnFree<'a> {
    inverse: &'a InThreeDirections,
    /// Free coordinates with their number and damping.
    free: Vec<(usize, Coordinate, f64)>,
}

impl FacePreconditioner for Inverse {
    fn on<'a>(&'a self, face: &Face) -> Result<Box<dyn OnFace + 'a>> {
        let of = |(k, at): (usize, &Coordinate)| match at.law {
            Law::Free { damping, .. } => Some((k, *at, damping)),
            Law::Held { .. } => None,
        };
        let free = face.coordinates.iter().enumerate().filter_map(of).collect();
        Ok(Box::new(OnFree { inverse: &self.0, free }))
    }
}

impl OnFace for OnFree<'_> {
    fn apply(&self, q: &[f64], z: &mut [f64]) -> Result<()> {
        let mut v = vec![0.0; q.len()];
        let mut image = vec![0.0; q.len()];
        self.free.iter().for_each(|(k, at, damping)| at.add(q[*k] / (1.0 + damping), &mut v));
        self.inverse.apply(&v, &mut image);
        z.fill(0.0);
        for (k, at, damping) in &self.free {
            let damped = damping * q[*k] / (1.0 + damping);
            z[*k] = (at.of(&image) + damped) / (1.0 + damping);
        }
        Ok(())
    }
}

/// Radius of contact a = 1, largest pressure p0 = 1, E* = 1, so that the normal force is 2 pi/3 and the spheres approach by pi/2.
struct Spheres {
    influence: InThreeDirections,
    inverse: Inverse,
    place: Vec<[f64; 2]>,
    /// Side of a cell.
    side: f64,
    /// Part of mu times the normal force.
    push: f64,
}

impl Spheres {
    fn new(n: usize, push: f64) -> Self {
        let side = SIDE / n as f64;
        let at = |i: usize| (i as f64 + 0.5) * side - 0.5 * SIDE;
        let place: Vec<[f64; 2]> = (0..n * n).map(|i| [at(i % n), at(i / n)]).collect();
        let by =
            |i: usize, j: usize| displacement(place[i][0] - place[j][0], place[i][1] - place[j][1], side);
        let cells = place.len();
        let influence = Matrix::from_fn(cells, cells, by).unwrap();
        let solver = SpdSolver::new(&influence, &vec![1.0; cells]).unwrap();
        let mut inverse = Matrix::zeros(cells, cells).unwrap();
        for j in 0..cells {
            let unit: Vec<f64> = (0..cells).map(|i| f64::from(u8::from(i == j))).collect();
            inverse.col_mut(j).copy_from_slice(&solver.solve(&unit));
        }
        let inverse = Inverse(InThreeDirections(inverse));
        Self { influence: InThreeDirections(influence), inverse, place, side, push }
    }

    /// Shear where there is no slip beyond the circle r = c: that of Hertz's pressure in r < 1 less that in r < c.
    fn stuck(&self) -> f64 {
        (1.0 - self.push).cbrt()
    }

    fn shear(&self, place: [f64; 2]) -> f64 {
        let (square, c) = (place[0] * place[0] + place[1] * place[1], self.stuck());
        MU * ((1.0 - square).max(0.0).sqrt() - (c * c - square).max(0.0).sqrt())
    }

    fn shift(&self) -> f64 {
        MU * 0.5 * PI * (1.0 - self.stuck().powi(2))
    }
}

/// At (x, y) by a unit force spread over a square cell around 0: `1/(pi side^2)` times the integral of 1/r. Boussinesq's displacement of
/// both surfaces along the normal, and for Poisson's ratio 0 Cerruti's along the force.
fn displacement(x: f64, y: f64, side: f64) -> f64 {
    let corner = |x: f64, y: f64| x * (y / x.abs()).asinh() + y * (x / y.abs()).asinh();
    let (left, right, below, above) = (x - 0.5 * side, x + 0.5 * side, y - 0.5 * side, y + 0.5 * side);
    let integral = corner(right, above) - corner(left, above) - corner(right, below) + corner(left, below);
    integral / (PI * side * side)
}

struct Found {
    /// Errors of the approach and of the tangential shift, of the closed ones.
    approach: f64,
    shift: f64,
    /// Root of the mean square error of the shear, of that of the closed shear.
    shear: f64,
    products: usize,
    /// Of the linear problem on the states that were found.
    linear: usize,
}

fn found(n: usize, push: f64) -> Found {
    let spheres = Spheres::new(n, push);
    let m = 3 * n * n;
    let mut d = vec![0.0; m];
    spheres.place.iter().enumerate().for_each(|(i, [x, y])| d[3 * i] = -0.25 * PI * (x * x + y * y));
    let unit = 1.0 / n as f64;
    let mut g_transposed = Csr::empty(3);
    (0..m).for_each(|i| g_transposed.push_row([(i % 3, unit)]));
    let pressed = 2.0 * PI / 3.0;
    let pushed = push * MU * pressed;
    let e = [unit * pressed, unit * pushed * ALONG[0], unit * pushed * ALONG[1]];
    let node = |i: usize| Node::new(Some(3 * i), &[3 * i + 1, 3 * i + 2], MU, 0.0).unwrap();
    let cones = Cones::new(m, (0..n * n).map(node).collect()).unwrap();
    let qp = Qp::plain(&spheres.influence, &d, &g_transposed, &e, &[]);
    let problem = FrictionProblem { qp, cones: &cones, preconditioner: Some(&spheres.inverse) };
    let limits = FrictionLimits { tolerance: 1e-9, products: 1000, direct: None };
    let found = friction(problem, limits, FrictionStart::default(), &mut Content, &mut Content).unwrap();
    assert_eq!(found.verdict, Verdict::Solved, "{} {:?}", found.merit, found.counts);
    let linear = known_face(problem, limits, (&found.x, &found.alpha), &mut Content).unwrap();
    let (mut missed, mut square) = (0.0, 0.0);
    for (i, &place) in spheres.place.iter().enumerate() {
        let closed = spheres.shear(place);
        for (k, along) in ALONG.iter().enumerate() {
            missed += (found.x[3 * i + 1 + k] / spheres.side.powi(2) - closed * along).powi(2);
        }
        square += closed * closed;
    }
    let [approach, first, second] = [0, 1, 2].map(|k| unit * found.alpha[k]);
    let shift = (first - spheres.shift() * ALONG[0]).hypot(second - spheres.shift() * ALONG[1]);
    let found = Found {
        approach: (approach / (0.5 * PI) - 1.0).abs(),
        shift: shift / spheres.shift(),
        shear: (missed / square).sqrt(),
        products: found.counts.products,
        linear,
    };
    println!(
        "n {n} push {push}: approach {:.1e}, shift {:.1e}, shear {:.2e}, products {} / {linear}",
        found.approach, found.shift, found.shear, found.products
    );
    found
}

/// The annulus of slip, 1 - c wide, is .11, .26 and .54 for these pushes: at the first it is narrower than a cell of the coarse grid,
/// and the shear, whose slope at both of its edges is infinite, is as good as that.
fn assert_mindlin(n: usize, shears: [f64; 3]) {
    for (push, limit) in [0.3, 0.6, 0.9].into_iter().zip(shears) {
        let found = found(n, push);
        assert!(
            found.approach <= 1e-3 && found.shift <= 1e-3,
            "{push}: {:e} {:e}",
            found.approach,
            found.shift
        );
        assert!(found.shear <= limit, "{push}: {:e}", found.shear);
        assert!(found.products <= 2 * found.linear, "{push}: {} {}", found.products, found.linear);
    }
}

#[test]
fn the_shear_between_spheres_is_that_of_mindlin() {
    assert_mindlin(16, [0.07, 0.04, 0.03]);
}

#[test]
fn the_shear_between_finely_divided_spheres_is_that_of_mindlin() {
    assert_mindlin(32, [0.045, 0.03, 0.02]);
}
