//! (11), the secondary decomposition: the floating membrane of Problem 1 cut by the host into four quarters, joined
//! again by rows H u = 0 with free multipliers. The four copies of the node in the middle may be joined by three rows or by
//! all six.

use crate::paper::cases::METHODS;
use crate::reference::case::{difference, Case};
use feti_contact::solver::{Modes, Outcome, Problem, RowKind, RowsInput, SparseInput, Storage};

const LINE: usize = 21;
const CUT: usize = 10;
const QUARTER: usize = (CUT + 1) * (CUT + 1);

/// Unknown of node (i, j) in quarter q, none where the node lies elsewhere.
fn unknown(q: usize, i: usize, j: usize) -> Option<usize> {
    let (first_i, first_j) = (CUT * (q % 2), CUT * (q / 2));
    let inside = |k: usize, first: usize| (first..=first + CUT).contains(&k);
    (inside(i, first_i) && inside(j, first_j)).then(|| (i - first_i) * (CUT + 1) + j - first_j)
}

/// Quarters that share node (i, j), ascending.
fn copies(i: usize, j: usize) -> Vec<(usize, usize)> {
    (0..4).filter_map(|q| unknown(q, i, j).map(|dof| (q, dof))).collect()
}

/// Edges of the grid with both ends in the quarter; those on a cut weigh one half in each of the two.
fn stiffness(q: usize) -> Vec<f64> {
    let mut k = vec![0.0; QUARTER * QUARTER];
    let nodes = (0..LINE).flat_map(|i| (0..LINE).map(move |j| (i, j)));
    for (i, j) in nodes {
        for (to_i, to_j) in [(i + 1, j), (i, j + 1)] {
            let ends = |q: usize| unknown(q, i, j).zip(unknown(q, to_i, to_j));
            let Some((a, b)) = ends(q) else { continue };
            let weight = 1.0 / (0..4).filter(|&q| ends(q).is_some()).count() as f64;
            for (row, col, sign) in [(a, a, 1.0), (b, b, 1.0), (a, b, -1.0), (b, a, -1.0)] {
                k[row + col * QUARTER] += sign * weight;
            }
        }
    }
    k
}

/// The left membrane from the reference, four quarters, 21 contact rows, rows H u = 0.
fn cut(case: &Case, redundant: bool) -> Problem {
    let mut problem = Problem::new();
    problem.offer_method(&paper::Paper);
    let k = &case.bodies[0].0;
    let input = SparseInput { ptr: &k.ptr, col: &k.col, val: &k.val, storage: Storage::Lower };
    let left = k.ptr.len() - 1;
    problem.add_body(left).unwrap();
    problem.set_stiffness(0, input).unwrap();
    problem.set_null_space(0, left, 0, &[], left, Modes::Exact).unwrap();
    problem.set_load(0, &case.load[..left]).unwrap();
    let mut loads = vec![vec![0.0; QUARTER]; 4];
    for (i, j) in (0..LINE).flat_map(|i| (0..LINE).map(move |j| (i, j))) {
        let (q, dof) = copies(i, j)[0];
        loads[q][dof] = case.load[left + i * LINE + j];
    }
    for (q, load) in loads.iter().enumerate() {
        let body = problem.add_body(QUARTER).unwrap();
        problem.set_stiffness_dense(body, QUARTER, &stiffness(q), QUARTER, Storage::Full).unwrap();
        problem.set_null_space(body, QUARTER, 1, &[1.0; QUARTER], QUARTER, Modes::Exact).unwrap();
        problem.set_load(body, load).unwrap();
    }
    let contact =
        (0..LINE).map(|j| vec![(0, left - LINE + j, 1.0), (copies(0, j)[0].0 + 1, copies(0, j)[0].1, -1.0)]);
    add(&mut problem, RowKind::Inequality, contact.collect());
    let mut glue = Vec::new();
    for (i, j) in (0..LINE).flat_map(|i| (0..LINE).map(move |j| (i, j))) {
        let copies = copies(i, j);
        for a in 0..copies.len() {
            let last = if redundant { copies.len() } else { (a + 2).min(copies.len()) };
            for b in a + 1..last {
                glue.push(vec![(copies[a].0 + 1, copies[a].1, 1.0), (copies[b].0 + 1, copies[b].1, -1.0)]);
            }
        }
    }
    assert_eq!(glue.len(), if redundant { 4 * CUT + 6 } else { 4 * CUT + 3 });
    add(&mut problem, RowKind::Equality, glue);
    problem
}

/// Rows of (body, dof, value).
fn add(problem: &mut Problem, kind: RowKind, rows: Vec<Vec<(usize, usize, f64)>>) {
    let mut ptr = vec![0];
    rows.iter().for_each(|row| ptr.push(ptr[ptr.len() - 1] + row.len()));
    let all: Vec<_> = rows.concat();
    let body: Vec<i64> = all.iter().map(|e| e.0 as i64).collect();
    let dof: Vec<i64> = all.iter().map(|e| e.1 as i64).collect();
    let val: Vec<f64> = all.iter().map(|e| e.2).collect();
    problem
        .add_rows(kind, RowsInput { ptr: &ptr, body: Some(&body), dof: &dof, val: &val, rhs: None })
        .unwrap();
}

#[test]
fn a_membrane_in_quarters_has_the_forces_of_the_whole_one() {
    let case = Case::read("p1_P3");
    for redundant in [false, true] {
        let runs = METHODS.map(|method| [(method, "relative"), (method, "printed")]).concat();
        for (method, units) in [&[("proportioning", "relative")], &runs[..]].concat() {
            let mut problem = cut(&case, redundant);
            problem.set_str("method", method).unwrap();
            problem.set_str("paper_units", units).unwrap();
            if method != "proportioning" {
                problem.set_f64("tolerance", 1e-6).unwrap();
                problem.set_f64("certificate_tolerance", 1e-4).unwrap();
            }
            let report = problem.solve().unwrap();
            assert_eq!(
                report.outcome,
                Outcome::Solved,
                "{method} {units} {redundant}: {:?}",
                report.certificate
            );
            let bound = if method == "proportioning" { 1e-8 } else { 1e-3 };
            let error = difference(problem.multipliers(RowKind::Inequality).unwrap(), &case.lambda);
            assert!(error <= bound, "{method} {units} {redundant}: forces differ by {error:.1e}");
            let free = problem.multipliers(RowKind::Equality).unwrap();
            assert!(free.iter().any(|mu| *mu < 0.0) && free.iter().any(|mu| *mu > 0.0), "mu is free");
            for (i, j) in [(CUT, CUT), (CUT, 3), (14, CUT)] {
                let values: Vec<f64> =
                    copies(i, j).iter().map(|(q, dof)| problem.displacement(q + 1).unwrap()[*dof]).collect();
                assert!(
                    values.iter().all(|u| (u - values[0]).abs() <= bound * values[0].abs()),
                    "{values:?}"
                );
            }
        }
    }
}
