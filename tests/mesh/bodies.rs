//! Bodies by their elements in contact, handed over whole or to be cut.

use decks::mesh::Mesh;
use feti_contact::error::Result;
use feti_contact::solver::{Outcome, Problem, RowKind, RowsInput};

/// Bodies with loads and rows over the unknowns of all of them.
pub struct Model {
    pub bodies: Vec<Mesh>,
    /// By bodies.
    pub loads: Vec<Vec<f64>>,
    /// Contact rows: entries, gap.
    pub rows: Vec<(Vec<(usize, usize, f64)>, f64)>,
}

impl Model {
    /// Bodies, of which the second stands on the first: facing nodes are those of its lowest and of the highest layer of the first.
    /// It is pressed down on its highest nodes, more so towards x = 1. `held`: nodes of the first body that are held.
    pub fn stacked(mut lower: Mesh, upper: Mesh, held: impl Fn([f64; 3]) -> bool) -> Self {
        lower.held = lower.nodes.iter().map(|at| held(*at)).collect();
        let [below, above] = [&lower, &upper].map(|mesh| mesh.numbers().0);
        let extreme = |mesh: &Mesh, sign: f64| {
            mesh.nodes.iter().map(|at| sign * at[2]).fold(f64::NEG_INFINITY, f64::max) * sign
        };
        let (top, bottom, end) = (extreme(&lower, 1.0), extreme(&upper, -1.0), extreme(&upper, 1.0));
        let on = |mesh: &Mesh, z: f64| -> Vec<usize> {
            let near = |k: &usize| (mesh.nodes[*k][2] - z).abs() < 1e-9;
            (0..mesh.nodes.len()).filter(near).collect()
        };
        let mut rows = Vec::new();
        for k in on(&upper, bottom) {
            let at = upper.nodes[k];
            let same =
                |other: &&usize| (0..2).all(|axis| (lower.nodes[**other][axis] - at[axis]).abs() < 1e-9);
            let facing = on(&lower, top);
            let facing = facing.iter().find(same).and_then(|other| below[*other]);
            if let (Some(own), Some(other)) = (above[k], facing) {
                let gap = 0.02 * ((at[0] - 0.5).powi(2) + (at[1] - 0.5).powi(2));
                rows.push((vec![(0, other + 2, 1.0), (1, own + 2, -1.0)], gap));
            }
        }
        let mut loads = vec![vec![0.0; lower.numbers().1], vec![0.0; upper.numbers().1]];
        let pressed = on(&upper, end);
        for &k in &pressed {
            let force = 0.01 * (1.0 + upper.nodes[k][0]) / pressed.len() as f64;
            above[k].iter().for_each(|first| loads[1][first + 2] -= force);
        }
        Self { bodies: vec![lower, upper], loads, rows }
    }

    /// By its elements, with so many pieces for each body, 0: as the library chooses.
    pub fn by_elements(&self, pieces: i64, coordinates: bool) -> Result<Problem> {
        let mut problem = Problem::new();
        problem.set_i64("pieces", pieces)?;
        // displacements are compared to 1e-9: cut bodies are solved as far as the certificate asks
        problem.set_f64("certificate_tolerance", 1e-10)?;
        for mesh in &self.bodies {
            let (number, unknowns) = mesh.numbers();
            let body = problem.add_body(unknowns)?;
            if coordinates {
                give_coordinates(&mut problem, body, mesh, &number)?;
            }
            let (ptr, dof) = mesh.connectivity();
            problem.set_mesh(body, &ptr, &dof)?;
            give_elements(&mut problem, body, mesh)?;
        }
        self.give_loads(&mut problem)?;
        Ok(problem)
    }

    pub fn give_loads(&self, problem: &mut Problem) -> Result<()> {
        for (body, load) in self.loads.iter().enumerate() {
            problem.set_load(body, load)?;
        }
        give_rows(problem, RowKind::Inequality, &self.rows)
    }
}

/// Rows by their entries and right-hand sides.
pub type Rows = [(Vec<(usize, usize, f64)>, f64)];

pub fn give_rows(problem: &mut Problem, kind: RowKind, rows: &Rows) -> Result<()> {
    let (mut ptr, mut body, mut dof, mut val, mut rhs) = (vec![0], vec![], vec![], vec![], vec![]);
    for (entries, c) in rows {
        for (p, j, v) in entries {
            body.push(*p as i64);
            dof.push(*j as i64);
            val.push(*v);
        }
        ptr.push(dof.len());
        rhs.push(*c);
    }
    problem
        .add_rows(kind, RowsInput { ptr: &ptr, body: Some(&body), dof: &dof, val: &val, rhs: Some(&rhs) })?;
    Ok(())
}

pub fn give_elements(problem: &mut Problem, body: usize, mesh: &Mesh) -> Result<()> {
    let order = 3 * mesh.elements.first().map_or(0, Vec::len);
    (0..mesh.elements.len()).try_for_each(|e| problem.add_element(body, e, order, &mesh.stiffness(e), order))
}

fn give_coordinates(problem: &mut Problem, body: usize, mesh: &Mesh, number: &[Option<usize>]) -> Result<()> {
    let free = || (0..mesh.nodes.len()).filter(|&k| number[k].is_some());
    let node: Vec<i32> = free().flat_map(|k| [k as i32; 3]).collect();
    let dir: Vec<i32> = free().flat_map(|_| [1, 2, 3]).collect();
    let xyz: Vec<f64> = free().flat_map(|k| [mesh.nodes[k]; 3]).flatten().collect();
    problem.set_coordinates(body, 3, &node, &dir, &xyz, 3)
}

/// u of all bodies, lambda, energy of a solved problem whose certificate passes.
pub fn solved(problem: &mut Problem) -> (Vec<f64>, Vec<f64>, f64) {
    let report = problem.solve().unwrap();
    assert_eq!(report.outcome, Outcome::Solved, "{:?}", report.certificate);
    assert!(report.certificate.passed());
    (
        problem.displacements().unwrap().to_vec(),
        problem.multipliers(RowKind::Inequality).unwrap().to_vec(),
        report.energy,
    )
}

/// `|a - b| / |b|`
pub fn apart(a: &[f64], b: &[f64]) -> f64 {
    let norm = |v: &mut dyn Iterator<Item = f64>| v.map(|v| v * v).sum::<f64>().sqrt();
    norm(&mut a.iter().zip(b).map(|(a, b)| a - b)) / norm(&mut b.iter().copied())
}

/// Two blocks of n^3 hexahedra each, the lower one clamped at its bottom, the upper one loose.
pub fn blocks(n: usize) -> Model {
    let mut random = decks::random::Random::new(3);
    let mut block = |low: f64| {
        let mut mesh = Mesh::grid([n; 3], |[x, y, z]| [x, y, z + low]);
        mesh.young.iter_mut().for_each(|young| *young = 1.0 + 1e-3 * random.between(0.0, 1.0));
        mesh
    };
    Model::stacked(block(0.0), block(1.0), |at| at[2] == 0.0)
}
