//! An elastic punch, floating, whose upper nodes are tied to a pilot with two displacements and a rotation, on an elastic
//! block: the forces are those of a pilot without stiffness.

use decks::{Block, Csr, Rows};
use feti_contact::solver::{Problem, RowKind, SparseInput, Storage};

use crate::pilots::{assert_near, forces, solved};

const E: f64 = 1e6;

/// How the pilot with a stiffness of kp to the ground stands in the model.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Pilot {
    /// A body of its own.
    Alone,
    /// Hung by springs kp on the upper nodes of the punch, in one matrix for the whole model.
    Hung,
}

/// The forces with `n` elements along the contact.
fn pressed(n: usize, kp: f64, pilot: Pilot) -> Vec<f64> {
    let size = 1.0 / n as f64;
    let (below, above) = (n / 4 + 1, n / 8 + 1);
    let block = |rows: usize, y: f64, young: f64| Block {
        dimension: 2,
        elements: [n, rows, 1],
        size: [1.0, rows as f64 * size, 1.0],
        origin: [0.0, y, 0.0],
        young,
        ..Block::default()
    };
    let (base, punch) = (block(below, 0.0, E), block(above, below as f64 * size, 10.0 * E));
    let (held, free) = (base.floating().body, punch.floating().body);
    let mut problem = Problem::new();
    let (first, led) = (held.dofs(), held.dofs() + free.dofs());
    let own: Vec<f64> = (0..9).map(|at| if at % 4 == 0 { kp } else { 0.0 }).collect();
    let own = Csr::from_dense(3, &own);
    let loads = [vec![0.0; held.dofs()], vec![0.0; free.dofs()], vec![0.0, -100.0, 3.0]];
    let parts = [&held.stiffness, &free.stiffness, &own];
    match pilot {
        Pilot::Alone => parts.iter().zip(&loads).for_each(|(k, load)| add(&mut problem, k, load)),
        Pilot::Hung => {
            let tops =
                (0..=n).flat_map(|x| [0, 1].map(|c| (first + 2 * punch.node([x, above, 0]) + c, led + c)));
            add(&mut problem, &hung(parts, tops.collect(), kp), &loads.concat());
        }
    }
    let (mut contact, mut equalities) = (Rows::none(led + 3), Rows::none(led + 3));
    for x in 0..=n {
        let (foot, top) = (2 * base.node([x, 0, 0]), first + 2 * punch.node([x, above, 0]));
        let (lower, upper) = (2 * base.node([x, below, 0]) + 1, first + 2 * punch.node([x, 0, 0]) + 1);
        let arm = x as f64 * size - 0.5;
        contact.push(&[(lower, 1.0), (upper, -1.0)], 1e-4 * arm * arm);
        [foot, foot + 1].into_iter().for_each(|dof| equalities.push(&[(dof, 1.0)], 0.0));
        // the pilot is 1 above the upper nodes
        equalities.push(&[(top, 1.0), (led, -1.0), (led + 2, -1.0)], 0.0);
        equalities.push(&[(top + 1, 1.0), (led + 1, -1.0), (led + 2, -arm)], 0.0);
    }
    equalities.push(&[(led, 1.0)], 0.0);
    add_rows(&mut problem, &contact, &equalities);
    let report = solved(&mut problem, &format!("{n} elements, kp {kp:e}, {pilot:?}"));
    assert!(report.counts.products < 10 * n, "{n} elements, kp {kp:e}, {pilot:?}: {:?}", report.counts);
    forces(&problem)[0].clone()
}

pub fn add(problem: &mut Problem, k: &Csr, load: &[f64]) {
    let body = problem.add_body(load.len()).unwrap();
    let col: Vec<i64> = k.col.iter().map(|&j| j as i64).collect();
    let input = SparseInput { ptr: &k.ptr, col: &col, val: &k.val, storage: Storage::Full };
    problem.set_stiffness(body, input).unwrap();
    problem.set_load(body, load).unwrap();
}

pub fn add_rows(problem: &mut Problem, contact: &Rows, equalities: &Rows) {
    for (kind, rows) in [(RowKind::Inequality, contact), (RowKind::Equality, equalities)] {
        let all: Vec<Vec<(usize, f64)>> = (0..rows.rhs.len()).map(|i| rows.matrix.row(i).collect()).collect();
        let all: Vec<_> = all.iter().zip(&rows.rhs).map(|(row, rhs)| (&row[..], *rhs)).collect();
        crate::pilots::add_rows(problem, kind, &all);
    }
}

/// One matrix for these parts, with springs of stiffness kp between these unknowns.
pub fn hung(parts: [&Csr; 3], springs: Vec<(usize, usize)>, kp: f64) -> Csr {
    let (mut rows, mut start) = (Vec::new(), 0);
    for part in parts {
        rows.extend((0..part.rows).map(|i| part.row(i).map(|(j, v)| (start + j, v)).collect::<Vec<_>>()));
        start += part.cols;
    }
    for (i, j) in springs.into_iter().flat_map(|(i, j)| [(i, j), (j, i)]) {
        rows[i].extend([(i, kp), (j, -kp)]);
    }
    let mut all = Csr::empty(start);
    rows.iter().for_each(|row| all.push_row(row));
    all
}

#[test]
fn the_forces_below_a_punch_do_not_depend_on_the_stiffness_of_its_pilot() {
    for (n, pilot) in [
        (10, Pilot::Alone),
        (40, Pilot::Alone),
        (160, Pilot::Alone),
        (10, Pilot::Hung),
        (40, Pilot::Hung),
        (160, Pilot::Hung),
    ] {
        let right = pressed(n, 0.0, Pilot::Alone);
        assert!((right.iter().sum::<f64>() - 100.0).abs() < 1e-9);
        for kp in [1e-300, 1e-20, 1e-18, 1e-15, 1e-12, 1e-9, 1e-6] {
            let what = format!("{n} elements, kp {kp:e}, {pilot:?}");
            assert_near(&pressed(n, kp, pilot), &right, 1e-9, &what);
        }
    }
}
