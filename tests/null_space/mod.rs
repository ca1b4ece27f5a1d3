//! Null spaces found from the stiffness alone: bodies whose motions without stiffness are known by construction.

mod answers;
mod bodies;
mod coordinates;
mod digits;
mod given;
mod rows;
mod slender;
mod tidy;

use bodies::{bar, chain, cube, frame, held, membrane};
use decks::{Block, Csr};
use feti_contact::error::{Error, Kind};
use feti_contact::solver::{LogLevel, Modes, Problem, SparseInput, Storage};
use std::sync::{Arc, Mutex};

fn registered(k: &Csr) -> Problem {
    let mut problem = Problem::new();
    problem.add_body(k.rows).unwrap();
    let col: Vec<i64> = k.col.iter().map(|&j| j as i64).collect();
    let input = SparseInput { ptr: &k.ptr, col: &col, val: &k.val, storage: Storage::Full };
    problem.set_stiffness(0, input).unwrap();
    problem
}

/// The warnings that a setup tells.
fn warnings(problem: &mut Problem) -> Vec<String> {
    let lines = lines(problem, LogLevel::Result);
    lines.into_iter().filter(|line| line.contains("warning")).collect()
}

/// The lines that a setup tells, up to this level.
fn lines(problem: &mut Problem, level: LogLevel) -> Vec<String> {
    let lines = Arc::new(Mutex::new(Vec::new()));
    let book = Arc::clone(&lines);
    let listener = move |_, text: &str| {
        book.lock().unwrap().push(text.to_owned());
        0
    };
    problem.on_log(Some((level, Box::new(listener))));
    problem.setup().unwrap_or_else(|e| panic!("{e}"));
    let lines = lines.lock().unwrap();
    lines.clone()
}

/// What the library found.
struct Found {
    dimension: usize,
    basis: Vec<f64>,
    fixing: Vec<usize>,
    gap: f64,
}

fn found(name: &str, k: &Csr) -> Found {
    let mut problem = registered(k);
    let (dimension, basis) = problem.null_space(0).unwrap_or_else(|e| panic!("{name}: {e}"));
    let basis = basis.to_vec();
    let fixing = problem.fixing_dofs(0).unwrap().to_vec();
    let gap = problem.null_space_gap(0).unwrap().unwrap();
    println!("{name}: n {} dimension {dimension} gap {gap:.0e}", k.rows);
    Found { dimension, basis, fixing, gap }
}

fn assert_dimension(name: &str, k: &Csr, expected: usize) -> Found {
    let found = found(name, k);
    assert_eq!(found.dimension, expected, "{name}");
    assert_eq!(found.fixing.len(), expected, "{name}");
    assert!(found.gap >= 1e3, "{name}: gap {:.1e}", found.gap);
    found
}

/// The largest part of a mode, in the metric of diag K, that is not in the span of the basis.
fn left_over(k: &Csr, found: &Found, modes: &[Vec<f64>]) -> f64 {
    let d = k.diagonal();
    let dot = |a: &[f64], b: &[f64]| a.iter().zip(b).zip(&d).map(|((a, b), d)| a * b * d).sum::<f64>();
    let rest = |mode: &Vec<f64>| {
        let mut rest = mode.clone();
        for r in found.basis.chunks_exact(k.rows) {
            let part = dot(r, mode) / dot(r, r);
            rest.iter_mut().zip(r).for_each(|(v, r)| *v -= part * r);
        }
        (dot(&rest, &rest) / dot(mode, mode)).sqrt()
    };
    modes.iter().map(rest).fold(0.0, f64::max)
}

#[test]
fn a_free_body_has_its_rigid_motions_and_no_other() {
    for (name, block) in [
        ("cube", cube(8)),
        ("one element", cube(1)),
        ("plate", bar([24, 24, 1], [24.0, 24.0, 0.5], 0.3)),
        ("beam 60:1", bar([60, 3, 3], [60.0, 1.0, 1.0], 0.3)),
        ("beam 200:1", bar([200, 2, 2], [200.0, 1.0, 1.0], 0.3)),
        ("nearly incompressible", bar([8, 8, 8], [1.0; 3], 0.4999)),
    ] {
        let k = block.stiffness();
        let found = assert_dimension(name, &k, 6);
        let left = left_over(&k, &found, &block.rigid_modes());
        assert!(left < 1e-6, "{name}: {left:.1e} of a rigid motion is missing");
    }
    let square = Block { dimension: 2, elements: [20, 20, 1], ..Block::default() };
    assert_dimension("plane square", &square.stiffness(), 3);
    let found = assert_dimension("membrane", &membrane(30), 1);
    assert!(left_over(&membrane(30), &found, &[vec![1.0; 961]]) < 1e-12);
}

#[test]
fn supports_leave_the_motions_they_allow() {
    let block = cube(8);
    let cases: [(&str, Csr, usize); 5] = [
        ("hinged edge", held(&block, |at, _| at[0] == 0 && at[2] == 0), 1),
        ("roller plane", held(&block, |at, direction| at[2] == 0 && direction == 2), 3),
        ("clamped face", held(&block, |at, _| at[2] == 0), 0),
        ("clamped corner", held(&block, |at, _| at == [0, 0, 0]), 3),
        ("guided bar", held(&block, |at, direction| (at[0] == 0 || at[1] == 0) && direction < 2), 1),
    ];
    for (name, k, dimension) in cases {
        assert_dimension(name, &k, dimension);
    }
}

/// The same supports written as 1e30 on the diagonal.
#[test]
fn supports_on_the_diagonal_are_supports() {
    let block = cube(6);
    let mut k = block.stiffness();
    for dof in (0..k.rows).filter(|dof| block.grid(dof / 3)[2] == 0 && dof % 3 == 2) {
        let at = k.ptr[dof] + k.col[k.ptr[dof]..k.ptr[dof + 1]].partition_point(|&j| j < dof);
        k.val[at] = 1e30;
    }
    assert_dimension("roller plane by 1e30", &k, 3);
}

#[test]
fn parts_joined_at_a_vertex_or_not_at_all_move_on_their_own() {
    let (six, one, five) = (cube(6).stiffness(), cube(1).stiffness(), cube(5).stiffness());
    assert_dimension("two components", &chain(&[&six, &six], 0, &[1.0, 1e3]), 12);
    assert_dimension("two blocks, one vertex", &chain(&[&six, &five], 3, &[1.0, 1.0]), 9);
    assert_dimension("a small block at a vertex of a large one", &chain(&[&six, &one], 3, &[1.0, 1.0]), 9);
    assert_dimension("eight blocks, vertex to vertex", &chain(&[&five; 8], 3, &[1.0; 8]), 27);
    assert_dimension("nine small blocks, vertex to vertex", &chain(&[&one; 9], 3, &[1.0; 9]), 30);
}

#[test]
fn stiffness_may_leap_by_ten_orders_of_magnitude() {
    let block = bar([8, 8, 4], [1.0, 1.0, 0.5], 0.3);
    let k = block.stiffness();
    for contrast in [1e6, 1e10] {
        assert_dimension("two materials", &chain(&[&k, &k], 3 * 81, &[1.0, contrast]), 6);
    }
}

#[test]
fn a_thin_frame_with_rotations_has_its_six_motions() {
    for thickness in [0.007, 0.05] {
        let (k, modes) = frame(20, thickness);
        let found = assert_dimension("frame", &k, 6);
        assert!(left_over(&k, &found, &modes) < 1e-7, "{:.1e}", left_over(&k, &found, &modes));
    }
}

#[test]
fn dofs_without_stiffness_are_no_motions_unless_something_acts_on_them_and_single_springs_are_none() {
    let one = cube(3).stiffness();
    let (spring, nothing) = (Csr::from_dense(1, &[7.0]), Csr::from_dense(1, &[0.0]));
    assert_dimension("with a spring", &chain(&[&one, &spring], 0, &[1.0, 1.0]), 6);
    let k = chain(&[&one, &spring, &nothing, &nothing], 0, &[1.0; 4]);
    assert_dimension("with dofs without stiffness", &k, 6);
    let mut problem = registered(&k);
    let mut load = vec![0.0; k.rows];
    load[k.rows - 1] = 1.0;
    problem.set_load(0, &load).unwrap();
    assert_eq!(problem.null_space(0).unwrap().0, 7);
    assert!(problem.fixing_dofs(0).unwrap().contains(&(k.rows - 1)));
}

#[test]
fn units_do_not_change_a_bit_of_the_motions() {
    let k = cube(6).stiffness();
    let scaled = k.clone().scaled(2f64.powi(40));
    let (a, b) = (found("in one unit", &k), found("in another", &scaled));
    assert_eq!((a.dimension, a.basis, a.fixing), (b.dimension, b.basis, b.fixing));
}

/// K+ is one of K: `K K+ f = f` for a load that balances.
#[test]
fn the_generalised_inverse_solves_for_loads_that_balance() {
    let five = cube(5).stiffness();
    let k = chain(&[&five, &five], 3, &[1.0, 1.0]);
    let mut problem = registered(&k);
    let motion: Vec<f64> = (0..k.rows).map(|i| (3.7 * i as f64).sin()).collect();
    let load = k.times(&motion);
    let mut x = vec![0.0; k.rows];
    problem.kplus(0, &load, &mut x).unwrap();
    let error = k.times(&x).iter().zip(&load).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max);
    assert!(error < 1e-11, "{error:.1e}");
    assert!(problem.fixing_dofs(0).unwrap().to_vec().iter().all(|&dof| x[dof] == 0.0));
}

#[test]
fn fixing_dofs_of_the_host_are_held() {
    let block = cube(4);
    let k = block.stiffness();
    let far = [block.node([0, 0, 0]), block.node([4, 0, 0]), block.node([0, 4, 0])];
    let given = [3 * far[0], 3 * far[0] + 1, 3 * far[0] + 2, 3 * far[1] + 1, 3 * far[1] + 2, 3 * far[2] + 2];
    let mut problem = registered(&k);
    problem.set_fixing(0, Some(&given)).unwrap();
    let mut held = problem.fixing_dofs(0).unwrap().to_vec();
    held.sort_unstable();
    let mut expected = given.to_vec();
    expected.sort_unstable();
    assert_eq!(held, expected);
    let refused = |dofs: &[usize]| -> Error {
        let mut problem = registered(&k);
        problem.set_fixing(0, Some(dofs)).unwrap();
        problem.setup().unwrap_err()
    };
    assert_eq!(refused(&given[..5]).place.limit, Some(6.0));
    assert_eq!(refused(&[0, 3, 6, 9, 12, 15]).kind, Kind::NullSpace);
}

#[test]
fn an_indefinite_stiffness_is_refused_as_such() {
    let mut k = cube(5).stiffness();
    let at = k.ptr[200] + k.col[k.ptr[200]..k.ptr[201]].partition_point(|&j| j < 200);
    k.val[at] *= 0.1;
    let error = registered(&k).setup().unwrap_err();
    assert_eq!(error.kind, Kind::Indefinite, "{error}");
    assert!(error.place.dof.is_some() && error.place.body == Some(0));
}

/// A null space that the host calls exact is the host's word: a missing mode is refused, not completed.
#[test]
fn an_exact_null_space_with_a_mode_missing_is_refused() {
    let block = cube(5);
    let (k, modes) = (block.stiffness(), block.rigid_modes());
    let mut problem = registered(&k);
    problem.set_null_space(0, k.rows, 5, &modes[..5].concat(), k.rows, Modes::Exact).unwrap();
    let error = problem.setup().unwrap_err();
    assert_eq!((error.kind, error.place.body), (Kind::NullSpace, Some(0)));
    assert!(error.what.contains("a mode is missing"), "{error}");
}
