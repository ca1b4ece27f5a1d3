//! The method that always ends on small programs: redundant rows, vertices without forces, motions that nothing resists.

use decks::random::Random;
use feti_contact::qp::{proximal, Direct, Solution};

use crate::dense::{norm, Dense};
use crate::enumeration::{by_enumeration, random_program, Kind};
use crate::program::Program;

impl Program {
    fn by_nearest_points(&self, limit: usize) -> Option<Solution> {
        let nothing = self.given_up_at(&vec![0.0; self.b.len()]);
        let g_transposed = self.g_transposed();
        proximal(self.qp(&g_transposed, None), Direct { entries: &self.a, limit }, &nothing).unwrap()
    }

    /// Every row once times each of the factors.
    fn repeated(&self, factors: &[f64]) -> Self {
        let m = self.b.len();
        let all: Vec<(usize, f64)> = factors.iter().flat_map(|f| (0..m).map(move |i| (i, *f))).collect();
        let a =
            all.iter().map(|(i, f)| all.iter().map(|(j, g)| f * g * self.a.0[*i][*j]).collect()).collect();
        let g = self.g.0.iter().map(|row| all.iter().map(|(i, f)| f * row[*i]).collect()).collect();
        Self {
            a: Dense(a),
            b: all.iter().map(|(i, f)| f * self.b[*i]).collect(),
            g: Dense(g),
            e: self.e.clone(),
            bounded: all.iter().map(|(i, _)| self.bounded[*i]).collect(),
        }
    }
}

#[test]
fn whatever_rows_depend_on_each_other_the_minimum_is_that_of_the_enumeration_of_all_faces() {
    for bits in 0..16u64 {
        let on = |bit: u64| bits >> bit & 1 == 1;
        let kind = Kind { deficient: on(0), free: on(1), dependent: on(2), degenerate: on(3) };
        for seed in 0..60 {
            let program = random_program(&mut Random::new(7000 * (bits + 1) + seed), kind);
            let least = program.value(&by_enumeration(&program).expect("feasible by construction").0);
            for many in [program.clone(), program.repeated(&[1.0, 0.3, 1e3])] {
                let found = many.by_nearest_points(usize::MAX).expect("few rows");
                let residuals = many.residuals(&found.x, &found.alpha);
                let what = format!("kind {bits:04b} seed {seed} rows {}: {residuals:?}", many.b.len());
                assert!(residuals.within(1e-8), "{what}");
                let size = least.abs() + residuals.gradient_size * norm(&found.x);
                assert!((many.value(&found.x) - least).abs() <= 1e-8 * size + 1e-12, "{what}");
            }
        }
    }
}

#[test]
fn in_any_units_the_minimum_is_the_same() {
    let kind = Kind { deficient: true, free: true, dependent: false, degenerate: true };
    for seed in 0..40 {
        let program = random_program(&mut Random::new(seed), kind);
        let found = program.by_nearest_points(usize::MAX).unwrap();
        for (length, force) in [(1e-9, 1e6), (1e12, 1e-20)] {
            let times = |v: &[f64], by: f64| v.iter().map(|v| v * by).collect::<Vec<f64>>();
            let a = Dense(program.a.0.iter().map(|row| times(row, length / force)).collect());
            let scaled =
                Program { a, b: times(&program.b, length), e: times(&program.e, force), ..program.clone() };
            let other = scaled.by_nearest_points(usize::MAX).unwrap();
            let residuals = scaled.residuals(&other.x, &other.alpha);
            assert!(residuals.within(1e-8), "{seed}: {residuals:?}");
            let difference: Vec<f64> = other.x.iter().zip(&found.x).map(|(a, b)| a / force - b).collect();
            let unique = crate::enumeration::has_one_solution(&program);
            assert!(!unique || norm(&difference) <= 1e-7 * (norm(&found.x) + 1e-3), "{seed}");
        }
    }
}

#[test]
fn what_is_larger_than_the_limit_is_not_begun() {
    let program = Program::new(Dense::diagonal(&[1.0, 1.0]), &[1.0, -1.0]);
    assert!(program.by_nearest_points(1).is_none());
    assert_eq!(program.by_nearest_points(2).unwrap().x, [1.0, 0.0]);
}
