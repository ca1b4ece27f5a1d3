//! Reads the reference cases of tests/data and hands them to the solver.

use std::fs::File;
use std::io::Read;
use std::ops::Range;
use std::path::{Path, PathBuf};

use feti_contact::solver::{Modes, Problem, RowKind, RowsInput, SparseInput, Storage};
use flate2::read::GzDecoder;

/// By rows, 0-based.
#[derive(Default, Clone)]
pub struct Sparse {
    pub ptr: Vec<usize>,
    pub col: Vec<i64>,
    pub val: Vec<f64>,
}

/// One case folder; `bodies` holds lower triangles and null spaces (n x r by columns).
pub struct Case {
    pub bodies: Vec<(Sparse, Vec<f64>)>,
    pub contact: (Sparse, Vec<f64>),
    pub equalities: (Sparse, Vec<f64>),
    pub load: Vec<f64>,
    pub u: Vec<f64>,
    pub lambda: Vec<f64>,
    /// Node, direction, x, y, z per dof where known.
    pub dofs: Vec<[f64; 5]>,
}

/// What the library is told about null spaces.
#[derive(Clone, Copy, PartialEq)]
pub enum Hint {
    NullSpaces,
    Coordinates,
    Nothing,
}

pub const CASES: [&str; 10] = [
    "p1_P1",
    "p1_P3",
    "p1_P3_galerkin",
    "p2_A",
    "p2_B1",
    "p2_B2",
    "p3_2block",
    "p3_3block",
    "hertz_cylinder",
    "three_bodies",
];

fn numbers(path: PathBuf) -> Option<Vec<Vec<f64>>> {
    let mut text = String::new();
    GzDecoder::new(File::open(path).ok()?).read_to_string(&mut text).unwrap();
    let lines = text.lines().filter(|line| !line.starts_with(['%', '#']) && !line.trim().is_empty());
    Some(lines.map(|line| line.split_whitespace().map(|word| word.parse().unwrap()).collect()).collect())
}

fn sparse(path: PathBuf) -> Option<Sparse> {
    let lines = numbers(path)?;
    let rows = lines[0][0] as usize;
    let mut entries: Vec<_> = lines[1..].iter().map(|l| (l[0] as usize - 1, l[1] as i64 - 1, l[2])).collect();
    entries.sort_by_key(|e| (e.0, e.1));
    let mut ptr = vec![0; rows + 1];
    entries.iter().for_each(|e| ptr[e.0 + 1] += 1);
    (0..rows).for_each(|i| ptr[i + 1] += ptr[i]);
    Some(Sparse {
        ptr,
        col: entries.iter().map(|e| e.1).collect(),
        val: entries.iter().map(|e| e.2).collect(),
    })
}

fn vector(path: PathBuf) -> Option<Vec<f64>> {
    Some(numbers(path)?.into_iter().map(|line| line[0]).collect())
}

impl Case {
    pub fn read(name: &str) -> Self {
        let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/data").join(name);
        let file = |name: &str| folder.join(name);
        let bodies = (1..)
            .map_while(|p| {
                let k = sparse(file(&format!("K{p}.mtx.gz")))?;
                let r = vector(file(&format!("R{p}.mtx.gz"))).map_or_else(Vec::new, |r| r[1..].to_vec());
                Some((k, r))
            })
            .collect();
        let equalities = sparse(file("H.mtx.gz")).unwrap_or(Sparse { ptr: vec![0], ..Sparse::default() });
        Self {
            bodies,
            contact: (sparse(file("B.mtx.gz")).unwrap(), vector(file("c.txt.gz")).unwrap()),
            equalities: (equalities, vector(file("h.txt.gz")).unwrap_or_default()),
            load: vector(file("f.txt.gz")).unwrap(),
            u: vector(file("u_ref.txt.gz")).unwrap(),
            lambda: vector(file("lambda_ref.txt.gz")).unwrap(),
            dofs: numbers(file("dofs.txt.gz"))
                .map_or_else(Vec::new, |lines| lines.iter().map(|l| std::array::from_fn(|k| l[k])).collect()),
        }
    }

    /// The case with one body, whose K has the matrices of all bodies as blocks.
    pub fn one_k(self) -> Self {
        let unknowns = |(k, _): &(Sparse, Vec<f64>)| k.ptr.len() - 1;
        let n: usize = self.bodies.iter().map(unknowns).sum();
        let modes = self.bodies.iter().map(|body| body.1.len() / unknowns(body)).max().unwrap_or(0);
        let (mut all, mut basis, mut first) =
            (Sparse { ptr: vec![0], ..Sparse::default() }, vec![0.0; n * modes], 0);
        for body in &self.bodies {
            let (k, r) = body;
            let (own, before) = (unknowns(body), all.col.len());
            all.ptr.extend(k.ptr[1..].iter().map(|at| before + at));
            all.col.extend(k.col.iter().map(|j| first as i64 + j));
            all.val.extend(&k.val);
            for (j, mode) in r.chunks_exact(own).enumerate() {
                basis[j * n + first..j * n + first + own].copy_from_slice(mode);
            }
            first += own;
        }
        Self { bodies: vec![(all, basis)], ..self }
    }

    /// Registers everything; null spaces as exact, or coordinates in their place.
    pub fn problem(&self, coordinates: bool) -> Problem {
        self.problem_with(if coordinates { Hint::Coordinates } else { Hint::NullSpaces })
    }

    /// Registers everything, with what the library is told about null spaces.
    pub fn problem_with(&self, hint: Hint) -> Problem {
        let mut problem = Problem::new();
        problem.offer_method(&paper::Paper);
        let mut start = 0;
        for (k, r) in &self.bodies {
            let n = k.ptr.len() - 1;
            let body = problem.add_body(n).unwrap();
            let input = SparseInput { ptr: &k.ptr, col: &k.col, val: &k.val, storage: Storage::Lower };
            problem.set_stiffness(body, input).unwrap();
            match hint {
                Hint::Coordinates => self.set_coordinates(&mut problem, body, start..start + n),
                Hint::NullSpaces => {
                    problem.set_null_space(body, n, r.len() / n, r, n, Modes::Exact).unwrap();
                }
                Hint::Nothing => {}
            }
            problem.set_load(body, &self.load[start..start + n]).unwrap();
            start += n;
        }
        for (kind, (rows, rhs)) in
            [(RowKind::Inequality, &self.contact), (RowKind::Equality, &self.equalities)]
        {
            let input =
                RowsInput { ptr: &rows.ptr, body: None, dof: &rows.col, val: &rows.val, rhs: Some(rhs) };
            problem.add_rows(kind, input).unwrap();
        }
        problem
    }

    fn set_coordinates(&self, problem: &mut Problem, body: usize, range: Range<usize>) {
        let dofs = &self.dofs[range];
        let node: Vec<i32> = dofs.iter().map(|d| d[0] as i32).collect();
        let direction: Vec<i32> = dofs.iter().map(|d| d[1] as i32).collect();
        let xyz: Vec<f64> = dofs.iter().flat_map(|d| d[2..].to_vec()).collect();
        problem.set_coordinates(body, 3, &node, &direction, &xyz, 3).unwrap();
    }

    /// Displacements of all bodies after a solve.
    pub fn displacement(&self, problem: &Problem) -> Vec<f64> {
        (0..self.bodies.len()).flat_map(|p| problem.displacement(p).unwrap().to_vec()).collect()
    }
}

/// `max |a - b| / max |b|`
pub fn difference(a: &[f64], b: &[f64]) -> f64 {
    let largest = |x: &mut dyn Iterator<Item = f64>| x.fold(0.0, |m: f64, v| m.max(v.abs()));
    largest(&mut a.iter().zip(b).map(|(a, b)| a - b)) / largest(&mut b.iter().copied())
}
