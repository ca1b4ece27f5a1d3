//! A preconditioner changes the way, not the answer.

use decks::random::Random;
use feti_contact::error::Result;
use feti_contact::qp::{Preconditioner, Verdict};

use crate::qp::dense::{solve, Dense};
use crate::qp::program::Program;

/// `A_FF^-1` on the rows that are not held.
struct Exact(Dense);

impl Preconditioner for Exact {
    fn apply(&self, held: &[bool], r: &[f64], z: &mut [f64]) -> Result<()> {
        let face: Vec<usize> = (0..r.len()).filter(|&i| !held[i]).collect();
        let part = |i: &usize| face.iter().map(|&j| self.0 .0[*i][j]).collect();
        let inverse = solve(face.iter().map(part).collect(), face.iter().map(|&i| r[i]).collect());
        z.fill(0.0);
        for (i, value) in face.iter().zip(inverse.expect("A is definite")) {
            z[*i] = value;
        }
        Ok(())
    }
}

/// What no preconditioner should do: point uphill, or nowhere.
struct Useless(f64);

impl Preconditioner for Useless {
    fn apply(&self, _: &[bool], r: &[f64], z: &mut [f64]) -> Result<()> {
        z.iter_mut().zip(r).for_each(|(z, r)| *z = self.0 * r);
        Ok(())
    }
}

/// Definite, eigenvalues from 1 to 101, without equalities.
fn program(seed: u64) -> Program {
    let (mut random, m) = (Random::new(seed), 20);
    let direction = random.normals(m, 0.2);
    let mut a = Dense::diagonal(&(0..m).map(|k| 100f64.powf(k as f64 / 19.0)).collect::<Vec<_>>());
    for (row, d) in a.0.iter_mut().zip(&direction) {
        row.iter_mut().zip(&direction).for_each(|(a, e)| *a += d * e);
    }
    let b = random.normals(m, 1.0);
    Program::new(a, &b)
}

#[test]
fn the_exact_inverse_of_a_face_solves_it_in_one_step() {
    let program = program(1).with_free_rows(&(0..20).collect::<Vec<_>>());
    let solution = program.minimise_with(Some(&Exact(program.a.clone())));
    assert_eq!(solution.verdict, Verdict::Solved);
    assert!(solution.counts.conjugate_gradient <= 2, "{:?}", solution.counts);
    assert!(solution.counts.preconditioned >= 1);
    assert!(program.solved().counts.conjugate_gradient > 10, "the test is too easy");
}

#[test]
fn any_preconditioner_gives_the_same_answer() {
    for seed in 0..20 {
        let program = program(seed);
        let expected = program.solved();
        let exact = Exact(program.a.clone());
        let all: [&dyn Preconditioner; 3] = [&exact, &Useless(-1.0), &Useless(0.0)];
        for (k, preconditioner) in all.into_iter().enumerate() {
            let found = program.minimise_with(Some(preconditioner));
            assert_eq!(found.verdict, Verdict::Solved, "seed {seed}, preconditioner {k}");
            for (found, expected) in found.x.iter().zip(&expected.x) {
                approx::assert_relative_eq!(*found, *expected, epsilon = 1e-7, max_relative = 1e-7);
            }
        }
    }
}
