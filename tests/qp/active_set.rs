//! The direct method on small programs: against the enumeration of all faces, on degenerate vertices and
//! singular faces, and where it must give up.

use decks::random::Random;
use feti_contact::linalg::{Entries, Matrix};
use feti_contact::qp::{active_set, Direct, Solution, Verdict};

use crate::dense::{norm, Dense};
use crate::enumeration::{by_enumeration, distance, has_one_solution, random_program, Kind};
use crate::program::{Conditions, Program};

impl Entries for Dense {
    fn add_block(&self, rows: &[usize], block: &mut Matrix) -> feti_contact::error::Result<()> {
        for (l, &j) in rows.iter().enumerate() {
            for (k, &i) in rows.iter().enumerate().skip(l) {
                block.set(k, l, block.get(k, l) + self.0[i][j]);
            }
        }
        Ok(())
    }
}

impl Program {
    /// The direct method from `start`, its answer accepted when the conditions hold to `accepted`.
    fn directly(&self, start: &[f64], accepted: f64) -> Solution {
        self.directly_within(start, accepted, usize::MAX)
    }

    fn directly_within(&self, start: &[f64], accepted: f64, limit: usize) -> Solution {
        let from = self.given_up_at(start);
        let g_transposed = self.g_transposed();
        let direct = Direct { entries: &self.a, limit };
        let mut judge = Conditions { program: self, accepted };
        active_set(self.qp(&g_transposed, None), direct, &from, &mut judge).unwrap()
    }
}

#[test]
fn near_the_optimum_the_answer_is_that_of_the_enumeration_of_all_faces() {
    let mut solved = 0;
    for bits in 0..16u64 {
        let on = |bit: u64| bits >> bit & 1 == 1;
        let kind = Kind { deficient: on(0), free: on(1), dependent: on(2), degenerate: on(3) };
        for seed in 0..60 {
            let program = random_program(&mut Random::new(1000 * bits + seed), kind);
            let (expected, _) = by_enumeration(&program).expect("feasible by construction");
            let rough = program.minimise_from(&vec![0.0; program.b.len()], 1e-2, 1.0).x;
            for (start, must) in [(&expected, true), (&rough, false)] {
                let found = program.directly(start, 1e-12);
                let is_solved = found.verdict == Verdict::Solved;
                assert!(is_solved || !must, "kind {bits:04b} seed {seed}: {:?}", found.counts);
                solved += usize::from(is_solved && !must);
                let apart = distance(&found.x, &expected) > 1e-8 * (norm(&expected) + 1e-3);
                let wrong = is_solved && apart && has_one_solution(&program);
                assert!(!wrong, "kind {bits:04b} seed {seed}: {:?}", found.x);
            }
        }
    }
    assert!(solved >= 900, "{solved} of 960 from a rough start");
}

/// The programs of `traps::a_degenerate_vertex...`: free rows do not determine alpha, least squares mislead.
#[test]
fn at_a_degenerate_vertex_the_projection_finds_the_multiplier_that_confirms_it() {
    let identity = |m: usize| Dense::diagonal(&vec![1.0; m]);
    let corner = Program::new(identity(2), &[1.0, 3.0]).with_equalities(&[&[1.0, 1.0]], &[0.0]);
    let line = Program::new(identity(2), &[1.0, -3.0]).with_equalities(&[&[1.0, -1.0]], &[0.0]);
    for program in [corner, line] {
        let found = program.directly(&[0.0; 2], 1e-12);
        assert_eq!((found.verdict, found.x), (Verdict::Solved, vec![0.0; 2]));
        assert_eq!(found.undetermined, 1);
    }
    // x1 = x2: 0 is a vertex and not optimal, the projection frees both rows
    let line = Program::new(identity(2), &[-1.0, 3.0]).with_equalities(&[&[1.0, -1.0]], &[0.0]);
    let found = line.directly(&[0.0; 2], 1e-12);
    assert!(found.verdict == Verdict::Solved && distance(&found.x, &[1.0; 2]) < 1e-14, "{:?}", found.x);
}

#[test]
fn as_many_rows_as_modes_are_solved_by_the_equalities_alone() {
    let g: [&[f64]; 3] = [&[1.0, 1.0, 1.0], &[0.0, 1.0, -1.0], &[1.0, 0.0, -1.0]];
    let a = Dense::gram(&Dense(vec![vec![1.0, 2.0, 0.0], vec![0.0, 1.0, -1.0]]));
    let program = Program::new(a, &[5.0, -7.0, 1.0]).with_equalities(&g, &[6.0, -1.0, -2.0]);
    let found = program.directly(&[1.0; 3], 1e-13);
    assert_eq!((found.verdict, found.counts.direct), (Verdict::Solved, 1));
    assert!(distance(&found.x, &[1.0, 2.0, 3.0]) < 1e-14, "{:?}", found.x);
}

#[test]
fn a_singular_face_is_solved_where_it_has_a_minimum_and_given_up_where_it_has_none() {
    // two rows on one spring: their forces share 2 in any way
    let twice = Program::new(Dense(vec![vec![1.0; 2]; 2]), &[2.0, 2.0]);
    let found = twice.directly(&[0.5, 1.0], 1e-13);
    assert_eq!(found.verdict, Verdict::Solved);
    assert!((found.x[0] + found.x[1] - 2.0).abs() < 1e-14, "{:?}", found.x);
    // with different gaps the face of both has no minimum
    let apart = Program::new(Dense(vec![vec![1.0; 2]; 2]), &[2.0, 1.9]);
    let given_up = apart.directly(&[1.0; 2], 1e-13);
    assert_eq!((given_up.verdict, given_up.x), (Verdict::Stalled, vec![1.0; 2]));
    assert_eq!(apart.directly(&[1.0, 0.0], 1e-13).verdict, Verdict::Solved);
}

/// A = C'C of random C with a strongly coupled b: rows swap for ever in a part of such programs.
#[test]
fn rows_that_swap_for_ever_end_the_method_and_leave_the_start() {
    let mut cycles = 0;
    for seed in 0..400 {
        let mut random = Random::new(seed);
        let c = (0..8).map(|_| random.normals(8, 1.0)).collect();
        let program = Program::new(Dense::gram(&Dense(c)), &random.normals(8, 1.0));
        let start = vec![1.0; 8];
        let found = program.directly(&start, 1e-12);
        if found.verdict != Verdict::Solved {
            assert_eq!((found.verdict, found.x), (Verdict::Stalled, start), "seed {seed}");
            assert!(found.counts.direct < 30, "seed {seed}: a set that comes again is recognised");
            cycles += 1;
        }
    }
    assert!((1..200).contains(&cycles), "{cycles} of 400");
}

#[test]
fn what_is_larger_than_the_limit_is_not_begun() {
    let program = Program::new(Dense::diagonal(&[1.0; 4]), &[1.0; 4]).with_equalities(&[&[1.0; 4]], &[2.0]);
    let attempts = [4, 5].map(|limit| program.directly_within(&[1.0; 4], 1e-12, limit));
    assert_eq!(
        attempts.map(|found| (found.verdict, found.counts.direct)),
        [(Verdict::Stalled, 0), (Verdict::Solved, 1)]
    );
}
