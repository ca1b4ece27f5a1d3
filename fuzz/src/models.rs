//! Stiffness matrices of small bodies, with their null spaces by hand.

use super::bytes::Bytes;

/// What a host knows of a body.
#[derive(Debug, Clone, Default)]
pub struct Model {
    /// Unknowns.
    pub n: usize,
    /// (n * n) K by columns.
    pub k: Vec<f64>,
    /// (n * r) null space R by columns.
    pub modes: Vec<f64>,
    /// (2 * n) position of each unknown, where it has one.
    pub xy: Vec<f64>,
    /// Unknowns of one node: 1 or 2.
    pub per_node: usize,
    /// The matrix that the library has, where it is known.
    pub given: Option<Given>,
}

/// A matrix as it was given.
#[derive(Debug, Clone)]
pub struct Given {
    pub dense: bool,
    /// Where it came by itself.
    pub diagonal: Option<Vec<f64>>,
    pub value: Vec<f64>,
}

impl Model {
    fn zero(n: usize) -> Self {
        Self { n, k: vec![0.0; n * n], modes: Vec::new(), xy: Vec::new(), per_node: 1, given: None }
    }

    pub fn r(&self) -> usize {
        self.modes.len().checked_div(self.n).unwrap_or(0)
    }

    fn add(&mut self, i: usize, j: usize, value: f64) {
        self.k[i + j * self.n] += value;
    }
}

/// Unknowns in a line, joined by springs; the first held by one where `held` is positive.
pub fn chain(bytes: &mut Bytes, n: usize, held: f64) -> Model {
    let mut chain = Model::zero(n);
    for i in 1..n {
        let k = bytes.positive();
        for (a, b, sign) in [(i, i, 1.0), (i - 1, i - 1, 1.0), (i, i - 1, -1.0), (i - 1, i, -1.0)] {
            chain.add(a, b, sign * k);
        }
    }
    chain.add(0, 0, held);
    if held <= 0.0 {
        chain.modes = vec![1.0; n];
    }
    chain
}

/// K = A'A + I with A of multiples of 1/8: no null space.
pub fn definite(bytes: &mut Bytes, n: usize) -> Model {
    let mut model = Model::zero(n);
    let a: Vec<f64> = (0..n * n).map(|_| bytes.number()).collect();
    for j in 0..n {
        for i in 0..n {
            let dot: f64 = (0..n).map(|l| a[l + i * n] * a[l + j * n]).sum();
            model.add(i, j, dot + if i == j { 1.0 } else { 0.0 });
        }
    }
    model
}

/// Entries of the plane-stress element of a unit square, Poisson's ratio 0.3, by distance of its four corners.
fn square() -> [[f64; 8]; 8] {
    let nu = 0.3;
    let k = [
        0.5 - nu / 6.0,
        0.125 + nu / 8.0,
        -0.25 - nu / 12.0,
        -0.125 + 3.0 * nu / 8.0,
        -0.25 + nu / 12.0,
        -0.125 - nu / 8.0,
        nu / 6.0,
        0.125 - 3.0 * nu / 8.0,
    ];
    const PLACE: [[usize; 8]; 8] = [
        [0, 1, 2, 3, 4, 5, 6, 7],
        [1, 0, 7, 6, 5, 4, 3, 2],
        [2, 7, 0, 5, 6, 3, 4, 1],
        [3, 6, 5, 0, 7, 2, 1, 4],
        [4, 5, 6, 7, 0, 1, 2, 3],
        [5, 4, 3, 2, 1, 0, 7, 6],
        [6, 3, 4, 1, 2, 7, 0, 5],
        [7, 2, 1, 4, 3, 6, 5, 0],
    ];
    PLACE.map(|row| row.map(|place| k[place] / (1.0 - nu * nu)))
}

/// nx x ny squares of plane stress, nodes row by row from below, (x, y) at each; floating: three rigid modes.
pub fn grid(nx: usize, ny: usize) -> Model {
    let across = nx + 1;
    let mut grid = Model::zero(2 * across * (ny + 1));
    let element = square();
    for (x, y) in (0..ny).flat_map(|y| (0..nx).map(move |x| (x, y))) {
        let low = x + y * across;
        let corners = [low, low + 1, low + across + 1, low + across];
        let dof = |corner: usize| 2 * corners[corner / 2] + corner % 2;
        for (a, row) in element.iter().enumerate() {
            for (b, value) in row.iter().enumerate() {
                grid.add(dof(a), dof(b), *value);
            }
        }
    }
    grid.per_node = 2;
    grid.xy = (0..grid.n).flat_map(|i| [(i / 2 % across) as f64, (i / 2 / across) as f64]).collect();
    let motion = |mode: usize, i: usize| match (mode, i % 2) {
        (0, 0) | (1, 1) => 1.0,
        (2, 0) => -grid.xy[2 * i + 1],
        (2, 1) => grid.xy[2 * i],
        _ => 0.0,
    };
    grid.modes =
        (0..3).flat_map(|mode| (0..grid.n).map(move |i| (mode, i))).map(|(m, i)| motion(m, i)).collect();
    grid
}

/// The same, every unknown of the lowest row of nodes held by a spring.
pub fn grounded_grid(nx: usize, ny: usize, spring: f64) -> Model {
    let mut grid = grid(nx, ny);
    (0..2 * (nx + 1)).for_each(|i| grid.add(i, i, spring));
    grid.modes = Vec::new();
    grid
}

/// Any symmetric matrix, now and then with numbers that no model wants.
pub fn any(bytes: &mut Bytes, n: usize) -> Model {
    let mut model = Model::zero(n);
    let wild = bytes.chance(64);
    for j in 0..n {
        for i in 0..=j {
            let value = if wild && bytes.chance(48) { bytes.wild() } else { bytes.number() };
            model.add(i, j, value);
            if i != j {
                model.add(j, i, value);
            }
        }
    }
    model
}
