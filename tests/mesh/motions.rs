//! Motions that closed rows leave open are found by the pieces of a body that is cut as by the whole of it.

use decks::mesh::Mesh;
use feti_contact::solver::{Outcome, Problem, RowKind};

use crate::mesh::bodies::{apart, give_rows, solved, Model};

/// Two blocks of 2 to 5 elements along each edge, of varied E, the lower one held at z = 0 or, for every other seed, at x = 0; and into
/// how many pieces each is cut.
fn random(seed: u64) -> (Model, i64) {
    let mut random = decks::random::Random::new(seed);
    let n = [0; 3].map(|_| 2 + random.between(0.0, 4.0) as usize);
    let pieces = 2 + random.between(0.0, 30.0) as i64;
    let mut block = |low: f64| {
        let mut mesh = Mesh::grid(n, |[x, y, z]| [x, y, z + low]);
        mesh.young.iter_mut().for_each(|young| *young = 1.0 + 1e-3 * random.between(0.0, 1.0));
        mesh
    };
    let axis = if seed % 2 == 0 { 0 } else { 2 };
    (Model::stacked(block(0.0), block(1.0), |at| at[axis] == 0.0), pieces)
}

/// Cut, with some of its contact rows as equality rows, along these axes, and no others.
fn glued(model: &Model, pieces: i64, axes: &[usize], rows: impl Fn(usize) -> bool) -> Problem {
    let mut problem = model.by_elements(pieces, true).unwrap();
    problem.clear_rows(RowKind::Inequality);
    let along = |(entries, c): &(Vec<(usize, usize, f64)>, f64), axis: usize| {
        (entries.iter().map(|&(p, j, v)| (p, j + axis - 2, v)).collect(), *c)
    };
    let chosen = (0..model.rows.len()).filter(|&i| rows(i));
    let all: Vec<_> =
        chosen.flat_map(|i| axes.iter().map(move |&axis| along(&model.rows[i], axis))).collect();
    give_rows(&mut problem, RowKind::Equality, &all).unwrap();
    problem
}

#[test]
fn a_cut_block_that_slides_travels_least_and_has_the_open_motions_of_the_whole() {
    for seed in [38, 377, 400, 410, 512, 622].into_iter().chain(1..20) {
        let (model, pieces) = random(seed);
        let (mut whole, mut cut) =
            (model.by_elements(1, true).unwrap(), model.by_elements(pieces, true).unwrap());
        let [(u, ..), (own, ..)] = [&mut whole, &mut cut].map(solved);
        let open = [whole, cut].map(|problem| problem.report().unwrap().undetermined);
        assert_eq!(open, [3, 3], "{seed}");
        assert!(apart(&own, &u) < 1e-9, "{seed}: {:e}", apart(&own, &u));
    }
}

#[test]
fn pieces_on_the_rows_that_carry_a_force_have_the_answer_of_the_contact_problem() {
    for seed in [4, 22, 52, 93, 151, 189, 422, 548, 621] {
        let (model, pieces) = random(seed);
        let (u, forces, _) = solved(&mut model.by_elements(1, true).unwrap());
        let mut problem = glued(&model, pieces, &[2], |i| forces[i] > 0.0);
        let report = problem.solve().unwrap();
        assert_eq!((report.outcome, report.undetermined), (Outcome::Solved, 3), "{seed}");
        let own = problem.displacements().unwrap();
        assert!(apart(own, &u) < 1e-9, "{seed}: {:e}", apart(own, &u));
    }
}

/// Rows in x and z leave the translation in y alone.
#[test]
fn a_single_motion_of_pieces_is_open() {
    for seed in [23, 195, 235, 262, 319, 403, 456, 526, 558, 695] {
        let (model, pieces) = random(seed);
        let report = glued(&model, pieces, &[0, 2], |_| true).solve().unwrap();
        assert_eq!((report.outcome, report.undetermined), (Outcome::Solved, 1), "{seed}");
    }
}
