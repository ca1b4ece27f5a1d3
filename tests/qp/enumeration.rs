//! Random programs against the enumeration of all faces: on every set F of rows that may move,
//! `A_FF x_F - G_F'alpha = b_F, G_F x_F = e`, and the first answer that satisfies all conditions is optimal.
//! Faces with a singular system need no attention: some optimal x is a vertex of the set of all of them.

use decks::random::Random;
use feti_contact::qp::Verdict;

use crate::qp::dense::{dot, independent_rows, norm, solve, Dense};
use crate::qp::program::Program;

/// An optimal x with its multiplier, `None` when there is no feasible point.
pub fn by_enumeration(program: &Program) -> Option<(Vec<f64>, Vec<f64>)> {
    let m = program.b.len();
    let rows = independent_rows(&program.g);
    (0..1usize << m).find_map(|set| {
        let face: Vec<usize> = (0..m).filter(|i| set >> i & 1 == 1).collect();
        let (x, alpha) = on_face(program, &face, &rows)?;
        let held_free = |i: &usize| !program.bounded[*i] && !face.contains(i);
        let residuals = program.residuals(&x, &alpha);
        let gradient_zero = (0..m).filter(held_free).all(|i| {
            let r = dot(&program.a.0[i], &x) - program.b[i];
            let coarse: f64 = program.g.0.iter().zip(&alpha).map(|(row, a)| row[i] * a).sum();
            (r - coarse).abs() <= 1e-9 * residuals.gradient_size
        });
        (gradient_zero && residuals.within(1e-9)).then_some((x, alpha))
    })
}

fn on_face(program: &Program, face: &[usize], rows: &[usize]) -> Option<(Vec<f64>, Vec<f64>)> {
    let (n, r) = (face.len(), rows.len());
    let mut matrix = vec![vec![0.0; n + r]; n + r];
    for (k, &i) in face.iter().enumerate() {
        face.iter().enumerate().for_each(|(l, &j)| matrix[k][l] = program.a.0[i][j]);
        for (l, &row) in rows.iter().enumerate() {
            matrix[k][n + l] = program.g.0[row][i];
            matrix[n + l][k] = program.g.0[row][i];
        }
    }
    let rhs = face.iter().map(|&i| program.b[i]).chain(rows.iter().map(|&row| program.e[row]));
    let solution = solve(matrix, rhs.collect())?;
    let (mut x, mut alpha) = (vec![0.0; program.b.len()], vec![0.0; program.e.len()]);
    for (k, &i) in face.iter().enumerate() {
        let rounding = 1e-11 * (1.0 + norm(&solution[..n]));
        x[i] = if program.bounded[i] && solution[k].abs() <= rounding { 0.0 } else { solution[k] };
    }
    rows.iter().enumerate().for_each(|(l, &row)| alpha[row] = -solution[n + l]);
    Some((x, alpha))
}

/// What a random program looks like.
#[derive(Clone, Copy)]
pub struct Kind {
    /// Rank of A below m.
    pub deficient: bool,
    /// Some rows without a bound.
    pub free: bool,
    /// The last row of G repeats the others.
    pub dependent: bool,
    /// `b` leaves some rows at zero without a force.
    pub degenerate: bool,
}

/// A program with a feasible x and a feasible multiplier, hence with a solution; m <= 10, r <= 3.
pub fn random_program(random: &mut Random, kind: Kind) -> Program {
    let m = 1 + random.below(10);
    let r = random.below(4).min(m.saturating_sub(1));
    let rank = if kind.deficient { random.below(m) } else { m + 1 };
    let mut c: Vec<Vec<f64>> = (0..rank.max(1)).map(|_| random.normals(m, 1.0)).collect();
    if rank == 0 {
        c[0].fill(0.0);
    }
    let a = Dense::gram(&Dense(c));
    let mut g: Vec<Vec<f64>> = (0..r).map(|_| random.normals(m, 1.0)).collect();
    if kind.dependent && r > 1 {
        g[r - 1] = (0..m).map(|i| g[..r - 1].iter().map(|row| row[i]).sum::<f64>()).collect();
    }
    let bounded: Vec<bool> = (0..m).map(|_| !kind.free || random.chance(0.6)).collect();
    let point = |x: &mut Random| -> Vec<f64> {
        let value = |&bounded: &bool| {
            let v = x.normal();
            if bounded && x.chance(0.5) {
                0.0
            } else if bounded {
                v.abs()
            } else {
                v
            }
        };
        bounded.iter().map(value).collect()
    };
    let e = Dense(g.clone()).times(&point(random));
    let y = point(random);
    let alpha = random.normals(r, 1.0);
    let coarse = Dense(g.clone()).transpose_times(&alpha, m);
    let force = |&bounded: &bool| {
        if !bounded || (kind.degenerate && random.chance(0.5)) {
            0.0
        } else {
            random.normal().abs()
        }
    };
    let forces: Vec<f64> = bounded.iter().map(force).collect();
    let b = (0..m).map(|i| dot(&a.0[i], &y) - coarse[i] - forces[i]).collect();
    Program { a, b, g: Dense(g), e, bounded }
}

/// x is unique when A is positive definite on the kernel of G.
pub fn has_one_solution(program: &Program) -> bool {
    let m = program.b.len();
    let mut sum = Dense::gram(&program.g_or_zero());
    sum.0.iter_mut().zip(&program.a.0).for_each(|(s, a)| s.iter_mut().zip(a).for_each(|(s, a)| *s += a));
    solve(sum.0, vec![0.0; m]).is_some()
}

impl Program {
    /// G, one zero row where it has none.
    fn g_or_zero(&self) -> Dense {
        if self.e.is_empty() {
            Dense::zeros(1, self.b.len())
        } else {
            self.g.clone()
        }
    }

    /// `alpha` is unique up to the kernel of G' when the rows with x > 0 have the rank of all.
    fn has_one_multiplier(&self, x: &[f64]) -> bool {
        let moving = |row: &Vec<f64>| {
            let entries = row.iter().enumerate();
            entries.filter(|(i, _)| !self.bounded[*i] || x[*i] > 1e-6).map(|(_, v)| *v).collect()
        };
        let part = Dense(self.g.0.iter().map(moving).collect());
        independent_rows(&part).len() == independent_rows(&self.g).len()
    }
}

/// What is wrong with the library's solution.
fn fault(program: &Program) -> Option<String> {
    let expected = by_enumeration(program).expect("feasible by construction");
    let found = program.minimise();
    let residuals = program.residuals(&found.x, &found.alpha);
    if found.verdict != Verdict::Solved {
        return Some(format!("{:?}, {:?}, {residuals:?}", found.verdict, found.counts));
    }
    let size = program.value(&expected.0).abs() + dot(&program.b, &expected.0).abs();
    let difference = (program.value(&found.x) - program.value(&expected.0)).abs();
    if difference > 1e-9 * size + 1e-12 {
        return Some(format!("theta differs by {difference:e} of {size:e}"));
    }
    let distance = distance(&found.x, &expected.0);
    if has_one_solution(program) && distance > 1e-6 * (norm(&expected.0) + 1e-3) {
        return Some(format!("x differs by {distance:e}"));
    }
    let difference: Vec<f64> = found.alpha.iter().zip(&expected.1).map(|(a, b)| a - b).collect();
    let forces = norm(&program.g.transpose_times(&difference, program.b.len()));
    let one = program.has_one_multiplier(&expected.0);
    (one && forces > 1e-6 * residuals.gradient_size).then(|| format!("G'alpha differs by {forces:e}"))
}

pub fn distance(x: &[f64], y: &[f64]) -> f64 {
    x.iter().zip(y).map(|(x, y)| (x - y) * (x - y)).sum::<f64>().sqrt()
}

const PER_KIND: u64 = 60;

#[test]
pub fn random_programs_are_solved_as_by_enumeration_of_all_faces() {
    let mut faults = Vec::new();
    for bits in 0..16u64 {
        let on = |bit: u64| bits >> bit & 1 == 1;
        let kind = Kind { deficient: on(0), free: on(1), dependent: on(2), degenerate: on(3) };
        for seed in 0..PER_KIND {
            let program = random_program(&mut Random::new(1000 * bits + seed), kind);
            let (m, r) = (program.b.len(), program.e.len());
            let what = |fault| format!("kind {bits:04b} seed {seed:3} m {m:2} r {r}: {fault}");
            faults.extend(fault(&program).map(what));
        }
    }
    assert!(faults.is_empty(), "{} of {} programs:\n{}", faults.len(), 16 * PER_KIND, faults.join("\n"));
}

#[test]
fn any_start_leads_to_the_same_optimum() {
    let kind = Kind { deficient: false, free: true, dependent: false, degenerate: false };
    for seed in 0..PER_KIND {
        let mut random = Random::new(seed);
        let program = random_program(&mut random, kind);
        let (expected, _) = by_enumeration(&program).expect("feasible by construction");
        let start = random.normals(program.b.len(), 10.0);
        let found = program.minimise_from(&start, 1e-12, 1e-9);
        assert_eq!(found.verdict, Verdict::Solved, "seed {seed}");
        let distance = distance(&found.x, &expected);
        assert!(distance <= 1e-6 * (norm(&expected) + 1e-3), "seed {seed}: {distance:e}");
    }
}
