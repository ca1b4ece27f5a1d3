//! Beams so slender that K hardly resists their bending: no gap separates it from the rigid motions.

use decks::Csr;
use feti_contact::error::Kind;
use feti_contact::solver::{Modes, Outcome, Problem, RowKind, RowsInput};

use crate::null_space::registered;
use crate::null_space::tidy::beam;

/// Of the springs under the nodes, which push and do not pull.
const SPRING: f64 = 1e5;

/// Weight on a beam of elements of length 1, and a force at a third of it that lifts the ends.
fn load(elements: usize) -> Vec<f64> {
    let mut f: Vec<f64> = (0..2 * elements + 2).map(|j| if j % 2 == 0 { -1000.0 } else { 0.0 }).collect();
    f[2 * (elements / 3)] -= 3e5;
    f
}

/// A x = b for a positive definite matrix with no entry more than 3 columns off its diagonal.
fn banded(a: &Csr, springs: impl Fn(usize) -> f64, b: &[f64]) -> Vec<f64> {
    let n = b.len();
    // rows of L from the column i - 3 on, and D
    let (mut l, mut d, mut x) = (vec![[0.0; 3]; n], vec![0.0; n], b.to_vec());
    for i in 0..n {
        let mut row = [0.0; 4];
        a.row(i).filter(|(j, _)| *j <= i).for_each(|(j, v)| row[j + 3 - i] = v);
        row[3] += springs(i);
        for j in i.saturating_sub(3)..i {
            let value: f64 = (i.saturating_sub(3)..j)
                .filter(|k| k + 3 >= j)
                .fold(row[j + 3 - i], |sum, k| sum - row[k + 3 - i] * l[j][k + 3 - j]);
            row[j + 3 - i] = value;
        }
        for j in i.saturating_sub(3)..i {
            l[i][j + 3 - i] = row[j + 3 - i] / d[j];
            row[3] -= row[j + 3 - i] * l[i][j + 3 - i];
            x[i] -= l[i][j + 3 - i] * x[j];
        }
        d[i] = row[3];
    }
    for i in (0..n).rev() {
        x[i] /= d[i];
        let later: f64 = (i + 1..n.min(i + 4)).map(|j| l[j][i + 3 - j] * x[j]).sum();
        x[i] -= later;
    }
    x
}

/// Forces of the springs by the active sets of a host.
fn by_active_sets(k: &Csr, f: &[f64]) -> Vec<f64> {
    let mut pressed = vec![true; f.len() / 2];
    loop {
        let u = banded(k, |j| if j % 2 == 0 && pressed[j / 2] { SPRING } else { 0.0 }, f);
        let now: Vec<bool> = u.iter().step_by(2).map(|u| *u < 0.0).collect();
        if now == pressed {
            return u.iter().step_by(2).map(|u| SPRING * (-u).max(0.0)).collect();
        }
        pressed = now;
    }
}

/// How the rigid motions are told.
#[derive(Clone, Copy, Debug)]
enum Told {
    Not,
    Coordinates,
    Vectors(Modes),
}

fn on_springs(elements: usize, bending: f64, told: Told) -> Problem {
    let (k, n) = (beam(elements, bending, 1.0), 2 * elements + 2);
    let mut problem = registered(&k);
    let at = |j: usize| (j / 2) as f64;
    match told {
        Told::Not => {}
        Told::Coordinates => {
            let node: Vec<i32> = (0..n).map(|j| j as i32 / 2).collect();
            let dir: Vec<i32> = (0..n).map(|j| if j % 2 == 0 { 2 } else { 6 }).collect();
            let xyz: Vec<f64> = (0..n).flat_map(|j| [at(j), 0.0, 0.0]).collect();
            problem.set_coordinates(0, 3, &node, &dir, &xyz, 3).unwrap();
        }
        Told::Vectors(modes) => {
            let middle = elements as f64 / 2.0;
            let lift = (0..n).map(|j| if j % 2 == 0 { 1.0 } else { 0.0 });
            let turn = (0..n).map(|j| if j % 2 == 0 { at(j) - middle } else { 1.0 });
            let all: Vec<f64> = lift.chain(turn).collect();
            problem.set_null_space(0, n, 2, &all, n, modes).unwrap();
        }
    }
    problem.set_load(0, &load(elements)).unwrap();
    let ptr: Vec<usize> = (0..=elements + 1).collect();
    let dof: Vec<i64> = (0..=elements as i64).map(|node| 2 * node).collect();
    let val = vec![-1.0; elements + 1];
    let rows = RowsInput { ptr: &ptr, body: None, dof: &dof, val: &val, rhs: None };
    problem.add_rows(RowKind::Inequality, rows).unwrap();
    problem.set_compliance(RowKind::Inequality, 0, &vec![1.0 / SPRING; elements + 1]).unwrap();
    problem
}

#[test]
fn a_slender_beam_on_one_sided_springs_is_solved_whatever_is_told_of_its_motions() {
    for (elements, bending) in [(900, 1e8 / 3.0), (2500, 1e8 / 3.0), (4000, 1e7 / 3.0)] {
        let forces = by_active_sets(&beam(elements, bending, 1.0), &load(elements));
        let most = forces.iter().fold(0.0, |most: f64, force| most.max(*force));
        assert!(forces.contains(&0.0) && most > 2000.0);
        for told in
            [Told::Not, Told::Coordinates, Told::Vectors(Modes::Exact), Told::Vectors(Modes::Candidates)]
        {
            let what = format!("{elements} elements, {told:?}");
            let mut problem = on_springs(elements, bending, told);
            let report = problem.solve().unwrap_or_else(|error| panic!("{what}: {error}"));
            assert_eq!(report.outcome, Outcome::Solved, "{what}");
            let found = problem.multipliers(RowKind::Inequality).unwrap();
            let off = found.iter().zip(&forces).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max);
            assert!(off < 1e-9 * most, "{what}: {off:e} of {most:e}");
        }
    }
}

/// A motion that was left out is no bending.
#[test]
fn motions_that_are_said_to_be_all_and_are_not_are_refused() {
    let mut problem = registered(&beam(100, 1e8, 1.0));
    let lift: Vec<f64> = (0..202).map(|j| f64::from(u8::from(j % 2 == 0))).collect();
    problem.set_null_space(0, 202, 1, &lift, 202, Modes::Exact).unwrap();
    let error = problem.setup().unwrap_err();
    assert!(error.kind == Kind::NullSpace && error.what.contains("a mode is missing"), "{error}");
}
