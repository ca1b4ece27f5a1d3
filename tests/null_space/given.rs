//! Null spaces that the host gives, against option null_space_tolerance.

use feti_contact::error::{Error, Kind};
use feti_contact::solver::{Modes, Problem, SparseInput, Storage};

use crate::null_space::bodies::cube;
use crate::null_space::digits::quads;
use crate::null_space::registered;

/// A spring 1 between two unknowns, the first held by another one.
fn spring(held: f64) -> Result<Problem, Error> {
    let mut problem = Problem::new();
    problem.add_body(2)?;
    let (ptr, col, val) = ([0, 1, 3], [0, 0, 1], [1.0 + held, -1.0, 1.0]);
    problem.set_stiffness(0, SparseInput { ptr: &ptr, col: &col, val: &val, storage: Storage::Lower })?;
    Ok(problem)
}

/// The free spring with the null vector (1, 1 + 2 e): `|K R| = e |K||R|`.
fn set_up(e: f64, tolerance: Option<f64>) -> Result<(), Error> {
    let mut problem = spring(0.0)?;
    problem.set_null_space(0, 2, 1, &[1.0, 1.0 + 2.0 * e], 2, Modes::Exact)?;
    tolerance.map_or(Ok(()), |tolerance| problem.set_f64("null_space_tolerance", tolerance))?;
    problem.setup()
}

#[test]
fn a_null_space_is_refused_from_the_tolerance_on_with_its_error_and_the_limit() {
    for (asked, tolerance) in [(None, 1e-8), (Some(1e-5), 1e-5), (Some(1e-12), 1e-12)] {
        assert!(set_up(0.5 * tolerance, asked).is_ok(), "{tolerance:e}");
        let refused = set_up(2.0 * tolerance, asked).unwrap_err();
        assert_eq!((refused.kind, refused.place.body), (Kind::NullSpace, Some(0)), "{refused}");
        assert_eq!(refused.place.limit, Some(tolerance));
        let found = refused.place.value.unwrap();
        assert!((found / (2.0 * tolerance) - 1.0).abs() < 1e-3, "{found:e} of {tolerance:e}");
    }
}

/// `|D^-1 K v|` of the unit vector v = (1, 1) / 2^1/2 is 0.7 of the spring that holds it.
#[test]
fn a_candidate_that_a_weak_spring_resists_is_no_null_vector() {
    for (held, dimension) in [(0.0, 1), (1e-12, 1), (1e-10, 0), (1e-9, 0), (1e-3, 0)] {
        let mut problem = spring(held).unwrap();
        problem.set_null_space(0, 2, 1, &[1.0, 1.0], 2, Modes::Candidates).unwrap();
        assert_eq!(problem.null_space(0).unwrap().0, dimension, "{held:e}");
    }
}

/// The rotation (-y, x) about an origin at 5e6 to 1e8 edges is a translation but for its last digits.
#[test]
fn candidates_of_a_body_far_from_the_origin_lose_no_motion() {
    for far in [1.0, 1e3, 5e5, 5e6, 1e8] {
        for block in [quads(8), cube(3)] {
            let (d, n) = (block.dimension, block.dimension * block.nodes());
            let at = |node: usize, k: usize| far * [1.0, 0.1, 0.03][k] + block.grid(node)[k] as f64 / 8.0;
            let mut modes: Vec<f64> =
                (0..d).flat_map(|k| (0..n).map(move |i| f64::from(u8::from(i % d == k)))).collect();
            let planes: &[[usize; 2]] = if d == 2 { &[[0, 1]] } else { &[[0, 1], [1, 2], [2, 0]] };
            for &[a, b] in planes {
                modes.extend((0..n).map(|i| match i % d {
                    k if k == a => -at(i / d, b),
                    k if k == b => at(i / d, a),
                    _ => 0.0,
                }));
            }
            let r = d + planes.len();
            let mut problem = registered(&block.stiffness());
            problem.set_null_space(0, n, r, &modes, n, Modes::Candidates).unwrap();
            let found = problem.null_space(0).unwrap_or_else(|e| panic!("{far:e}: {e}")).0;
            assert_eq!(found, r, "{far:e}");
        }
    }
}

/// Rounding of far candidates is no excuse for a spring.
#[test]
fn a_candidate_far_from_the_origin_that_a_spring_resists_is_no_null_vector() {
    let block = quads(8);
    let mut k = block.stiffness();
    let at = k.ptr[20] + k.col[k.ptr[20]..k.ptr[21]].partition_point(|&j| j < 20);
    k.val[at] *= 1.0 + 1e-4;
    let n = k.rows;
    let place = |i: usize, k: usize| 5e6 + block.grid(i / 2)[k] as f64 / 8.0;
    let mut modes: Vec<f64> =
        (0..2).flat_map(|k| (0..n).map(move |i| f64::from(u8::from(i % 2 == k)))).collect();
    modes.extend((0..n).map(|i| if i % 2 == 0 { -place(i, 1) } else { place(i, 0) }));
    let mut problem = registered(&k);
    problem.set_null_space(0, n, 3, &modes, n, Modes::Candidates).unwrap();
    assert_eq!(problem.null_space(0).unwrap().0, 2);
}
