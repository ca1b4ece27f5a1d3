//! A find of 1e5 nodes against 1e5 faces, rows and all.

use feti_contact::error::Result;
use feti_contact::solver::{PairField, PairMethod, Problem, Shape};

use crate::clock::{bytes, peak, restart_peak, Clock};
use crate::steps::{print_lap, text};

/// Faces along a side of the master, and of the slave.
const MASTER: usize = 316;
const SLAVE: usize = 310;
/// Height of waves, which bilinear faces follow by their twist.
const WAVY: f64 = 0.05;

/// Time of a first find and of one after a motion; memory beside the rows, of a slave with one face.
pub fn run(threads: i64) -> std::result::Result<(), String> {
    let memory = Sheets::new(1, WAVY, PairMethod::NodeToFace, threads).and_then(|mut sheets| {
        restart_peak();
        let before = bytes("/proc/self/status", "VmRSS:").map_or(f64::NAN, |bytes| bytes as f64);
        sheets.problem.pairs_find()?;
        Ok((peak() - before) / (MASTER * MASTER) as f64)
    });
    println!("bytes_per_face {:.0}", memory.map_err(text)?);
    let cases = [
        ("nodes", PairMethod::NodeToFace, WAVY),
        ("mortar_9_points", PairMethod::Mortar, 0.0),
        ("mortar_16_points", PairMethod::Mortar, WAVY),
    ];
    let mut bits = 0u64;
    for (name, method, wave) in cases {
        let mut sheets = Sheets::new(SLAVE, wave, method, threads).map_err(text)?;
        let first = Clock::start();
        sheets.problem.pairs_find().map_err(text)?;
        print_lap(&format!("{name}_first"), first.lap());
        sheets.lower(1e-5).map_err(text)?;
        let again = Clock::start();
        sheets.problem.pairs_find().map_err(text)?;
        print_lap(name, again.lap());
        let normals = sheets.problem.pair_field(0, PairField::Normal).map_err(text)?;
        bits = normals.iter().fold(bits, |sum, n| (sum.rotate_left(5) ^ n.to_bits()) % (1 << 52));
    }
    println!("bits {bits}");
    Ok(())
}

/// Two sheets of bilinear faces, one over the other, whose waves have this height; nothing is solved, so that they have no K.
struct Sheets {
    problem: Problem,
    slave: Vec<f64>,
}

impl Sheets {
    fn new(side: usize, wave: f64, method: PairMethod, threads: i64) -> Result<Self> {
        let mut problem = Problem::new();
        problem.set_i64("threads", threads)?;
        let (slave, master) = (sheet(side, wave, 1e-4), sheet(MASTER, wave, 0.0));
        let slave_surface = add(&mut problem, side, &slave, true)?;
        let master_surface = add(&mut problem, MASTER, &master, false)?;
        problem.pair_add(slave_surface, master_surface, method, false, 0.01)?;
        problem.pair_set(0, "friction", &[0.3])?;
        Ok(Self { problem, slave })
    }

    fn lower(&mut self, by: f64) -> Result<()> {
        self.slave.iter_mut().skip(2).step_by(3).for_each(|z| *z -= by);
        self.problem.surface_move(0, &self.slave, 3)
    }
}

/// Positions of (side + 1)^2 nodes over the unit square.
fn sheet(side: usize, wave: f64, up: f64) -> Vec<f64> {
    let node = |k: usize| {
        let [u, v] = [k % (side + 1), k / (side + 1)].map(|i| i as f64 / side as f64);
        [u, v, up + wave * (7.0 * u).sin() * (5.0 * v).cos()]
    };
    (0..(side + 1).pow(2)).flat_map(node).collect()
}

fn add(problem: &mut Problem, side: usize, x: &[f64], looks_down: bool) -> Result<usize> {
    let body = problem.add_body(x.len())?;
    let dof: Vec<i64> = (0..x.len() as i64).collect();
    let surface = problem.surface_add(Some(body), 3, x, 3, Some((&dof, 3)))?;
    let node = |i: usize, j: usize| (j * (side + 1) + i) as i64;
    let face = |k: usize| {
        let (i, j) = (k % side, k / side);
        let mut face = [node(i, j), node(i + 1, j), node(i + 1, j + 1), node(i, j + 1)];
        if looks_down {
            face.reverse();
        }
        face
    };
    let faces: Vec<i64> = (0..side * side).flat_map(face).collect();
    problem.surface_faces(surface, Shape::Quad4, &faces)?;
    Ok(surface)
}
