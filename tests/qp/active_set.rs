//! The direct method on small programs: against the enumeration of all faces, on degenerate vertices and
//! singular faces, and where it must give up.

use decks::random::Random;
use feti_contact::linalg::{Entries, Matrix};
use feti_contact::qp::{active_set, Counts, Direct, Solution, Verdict};

use crate::dense::{norm, Dense};
use crate::enumeration::{by_enumeration, distance, has_one_solution, random_program, Kind};
use crate::program::{Conditions, Program};

impl Entries for Dense {
    fn add_block(&self, rows: &[usize], block: &mut Matrix) {
        for (l, &j) in rows.iter().enumerate() {
            for (k, &i) in rows.iter().enumerate().skip(l) {
                block.set(k, l, block.get(k, l) + self.0[i][j]);
            }
        }
    }
}

impl Program {
    /// The direct method from `start`, its answer accepted when the conditions hold to `accepted`.
    fn directly(&self, start: &[f64], accepted: f64) -> Solution {
        self.directly_within(start, accepted, usize::MAX)
    }

    fn directly_within(&self, start: &[f64], accepted: f64, limit: usize) -> Solution {
        let from = Solution {
            x: start.to_vec(),
            alpha: vec![0.0; self.e.len()],
            undetermined: 0,
            scale: norm(&self.b),
            verdict: Verdict::Stalled,
            counts: Counts::default(),
        };
        let g_transposed = self.g_transposed();
        let direct = Direct { entries: &self.a, limit };
        let mut judge = Conditions { program: self, accepted };
        active_set(self.qp(&g_transposed, None), direct, &from, &mut judge).unwrap()
    }
}

#[test]
#[ignore]
fn survey() {
    for bits in 0..16u64 {
        let on = |bit: u64| bits >> bit & 1 == 1;
        let kind = Kind { deficient: on(0), free: on(1), dependent: on(2), degenerate: on(3) };
        let mut solved = [0; 4];
        let mut wrong = 0;
        let mut faces = 0;
        for seed in 0..60 {
            let program = random_program(&mut Random::new(1000 * bits + seed), kind);
            let m = program.b.len();
            let (x, _) = by_enumeration(&program).unwrap();
            let rough: Vec<f64> = program.minimise_from(&vec![0.0; m], 1e-2, 1.0).x;
            let starts = [vec![0.0; m], vec![1.0; m], rough, x.clone()];
            for (k, start) in starts.iter().enumerate() {
                let found = program.directly(start, 1e-12);
                faces += found.counts.direct;
                if found.verdict == Verdict::Solved {
                    solved[k] += 1;
                    if has_one_solution(&program) && distance(&found.x, &x) > 1e-6 * (norm(&x) + 1e-3) {
                        wrong += 1;
                    }
                } else if k == 3 {
                    println!("{bits:04b} {seed} m {m} r {}: {:?} {:?}", program.e.len(), found.counts, x);
                }
            }
        }
        println!("{bits:04b}: of 60: zero {} one {} rough {} exact {}; wrong {wrong} faces {faces}", solved[0], solved[1], solved[2], solved[3]);
    }
}
