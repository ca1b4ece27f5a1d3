//! What the tests of the program share: a healthy problem with a change, as a file, and the program.

use std::path::{Path, PathBuf};
use std::process::{Command, Output};

use feti_contact::solver::{FrictionInput, Modes, Problem, RowKind, RowsInput, Storage, TripletInput};

pub struct Body {
    pub n: usize,
    /// Row, column, value: the lower triangle, element by element.
    pub k: Vec<(usize, usize, f64)>,
    /// None: coordinates alone.
    pub motions: Option<Vec<Vec<f64>>>,
    pub load: Vec<f64>,
    pub xyz: Vec<[f64; 3]>,
    pub dir: Vec<i32>,
}

#[derive(Clone)]
pub struct Row {
    /// Body, unknown, coefficient.
    pub entries: Vec<(usize, usize, f64)>,
    pub rhs: f64,
}

pub struct Scene {
    pub bodies: Vec<Body>,
    pub contact: Vec<Row>,
    pub equality: Vec<Row>,
    /// A tangential row for each contact row, and its coefficient.
    pub friction: Vec<(Row, f64)>,
}

/// A rectangle of square elements of plane strain, E = 1000, from its lower left corner.
fn rectangle(steps: [usize; 2], corner: [f64; 2], edge: f64) -> Body {
    let place = |i: usize, j: usize| [corner[0] + edge * i as f64, corner[1] + edge * j as f64, 0.0];
    let node = |i: usize, j: usize| i + (steps[0] + 1) * j;
    let n = 2 * (steps[0] + 1) * (steps[1] + 1);
    let (mut k, ke) = (Vec::new(), decks::elements::elasticity(&[edge, edge], 1000.0, 0.3));
    for e in 0..steps[0] * steps[1] {
        let (i, j) = (e % steps[0], e / steps[0]);
        let nodes = [node(i, j), node(i + 1, j), node(i, j + 1), node(i + 1, j + 1)];
        let dof: Vec<usize> = nodes.iter().flat_map(|node| [2 * node, 2 * node + 1]).collect();
        for (a, b) in (0..8).flat_map(|a| (0..8).map(move |b| (a, b))).filter(|&(a, b)| dof[a] >= dof[b]) {
            k.push((dof[a], dof[b], ke[8 * a + b]));
        }
    }
    let places = (0..=steps[1]).flat_map(|j| (0..=steps[0]).map(move |i| (i, j)));
    let xyz: Vec<[f64; 3]> = places.flat_map(|(i, j)| [place(i, j); 2]).collect();
    let along = |d: usize| (0..n).map(|i| if i % 2 == d { 1.0 } else { 0.0 }).collect::<Vec<f64>>();
    let turn = (0..n).map(|i| if i % 2 == 0 { -xyz[i][1] } else { xyz[i][0] }).collect();
    let motions = Some(vec![along(0), along(1), turn]);
    Body { n, k, motions, load: vec![0.0; n], xyz, dir: (0..n).map(|i| 1 + i as i32 % 2).collect() }
}

/// A block that floats over another one, at a gap of 0.01, is pressed down and to the right; friction 0.3 carries what pushes it sideways.
pub fn healthy() -> Scene {
    let (below, mut above) = (rectangle([10, 3], [0.0, 0.0], 0.4), rectangle([6, 3], [0.53, 1.21], 0.47));
    for i in 0..7 {
        above.load[2 * (21 + i) + 1] = -1.0;
        above.load[2 * (21 + i)] = 0.02 * (1 + i) as f64;
    }
    let (mut contact, mut friction, mut equality) = (Vec::new(), Vec::new(), Vec::new());
    for i in 0..7 {
        let x = above.xyz[2 * i];
        let face = (x[0] / 0.4) as usize;
        let w = x[0] / 0.4 - face as f64;
        let along = |d: usize, sign: f64| {
            let node = |k: usize| 2 * (33 + face + k) + d;
            vec![(1, 2 * i + d, sign), (0, node(0), -sign * (1.0 - w)), (0, node(1), -sign * w)]
        };
        // n = (0, -1) from the node to the face
        contact.push(Row { entries: along(1, -1.0), rhs: x[1] - 1.2 });
        friction.push((Row { entries: along(0, 1.0), rhs: 0.0 }, 0.3));
    }
    for i in 0..11 {
        equality.extend([0, 1].map(|d| Row { entries: vec![(0, 2 * i + d, 1.0)], rhs: 0.0 }));
    }
    Scene { bodies: vec![below, above], contact, equality, friction }
}

/// A small block far from the others.
pub fn alone() -> Body {
    rectangle([2, 2], [9.0, 9.0], 0.3)
}

impl Scene {
    /// The bytes of its file, or why the library refuses it at once.
    pub fn problem(&self) -> feti_contact::error::Result<Problem> {
        let mut problem = Problem::new();
        for body in &self.bodies {
            let p = problem.add_body(body.n)?;
            let [row, col] = [0, 1].map(|k| body.k.iter().map(|e| [e.0, e.1][k] as i64).collect::<Vec<_>>());
            let val: Vec<f64> = body.k.iter().map(|e| e.2).collect();
            let k = TripletInput { row: &row, col: &col, val: &val, storage: Storage::Lower };
            problem.set_stiffness_triplets(p, body.n, k)?;
            if let Some(motions) = &body.motions {
                problem.set_null_space(p, body.n, motions.len(), &motions.concat(), body.n, Modes::Exact)?;
            }
            problem.set_coordinates(p, 3, &body.dir, &body.dir, &body.xyz.concat(), 3)?;
            problem.set_load(p, &body.load)?;
        }
        add(&mut problem, RowKind::Inequality, &self.contact)?;
        add(&mut problem, RowKind::Equality, &self.equality)?;
        let (ptr, body, dof, val) = arrays(self.friction.iter().map(|(row, _)| row));
        let rows = RowsInput { ptr: &ptr, body: Some(&body), dof: &dof, val: &val, rhs: None };
        let normal: Vec<i64> = (0..self.friction.len() as i64).collect();
        let coefficient: Vec<f64> = self.friction.iter().map(|(_, mu)| *mu).collect();
        problem.add_friction(FrictionInput {
            dim: 1,
            normal: &normal,
            rows,
            coefficient: Some(&coefficient),
            bound: None,
        })?;
        Ok(problem)
    }

    pub fn write(&self, path: &Path) {
        self.problem().and_then(|mut problem| problem.write_file(path)).unwrap();
    }
}

fn arrays<'a>(rows: impl Iterator<Item = &'a Row>) -> (Vec<usize>, Vec<i64>, Vec<i64>, Vec<f64>) {
    let (mut ptr, mut body, mut dof, mut val) = (vec![0], Vec::new(), Vec::new(), Vec::new());
    for row in rows {
        for (p, i, value) in &row.entries {
            body.push(*p as i64);
            dof.push(*i as i64);
            val.push(*value);
        }
        ptr.push(dof.len());
    }
    (ptr, body, dof, val)
}

fn add(problem: &mut Problem, kind: RowKind, rows: &[Row]) -> feti_contact::error::Result<()> {
    let (ptr, body, dof, val) = arrays(rows.iter());
    let rhs: Vec<f64> = rows.iter().map(|row| row.rhs).collect();
    let rows = RowsInput { ptr: &ptr, body: Some(&body), dof: &dof, val: &val, rhs: Some(&rhs) };
    problem.add_rows(kind, rows).map(drop)
}

/// A folder of this test alone.
pub fn folder(test: &str) -> PathBuf {
    let path = std::env::temp_dir().join(format!("feti-program-{test}-{}", std::process::id()));
    let _ = std::fs::remove_dir_all(&path);
    std::fs::create_dir_all(&path).unwrap();
    path
}

pub fn run(arguments: &[&str]) -> Output {
    Command::new(env!("CARGO_BIN_EXE_feti-contact")).args(arguments).output().unwrap()
}

/// Standard output and error, and the exit status.
pub fn said(arguments: &[&str]) -> (String, String, i32) {
    let Output { stdout, stderr, status } = run(arguments);
    let text = |bytes: Vec<u8>| String::from_utf8(bytes).unwrap();
    (text(stdout), text(stderr), status.code().expect("an exit status, no signal"))
}
