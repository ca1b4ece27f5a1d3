//! Rows that are added or cleared, and stiffnesses that change, decide anew whether an unknown is carried.

use feti_contact::solver::{Problem, RowKind};

use crate::pilots::{add_body, add_rows, assert_near, forces, solved};

#[test]
fn a_spring_is_carried_while_rows_hold_it() {
    let (k, weak, load) = (1e6, 1e-6, 10.0);
    let mut problem = Problem::new();
    add_body(&mut problem, &[k], &[0.0]);
    add_body(&mut problem, &[weak], &[load]);
    solved(&mut problem, "without rows");
    assert_near(problem.displacement(1).unwrap(), &[load / weak], 1e-12, "without rows");
    add_rows(&mut problem, RowKind::Inequality, &[(&[(0, -1.0), (1, 1.0)], 0.0)]);
    for _ in 0..2 {
        solved(&mut problem, "with a row");
        assert_near(&forces(&problem)[0], &[load * k / (k + weak)], 1e-12, "with a row");
    }
    // as stiff as the other: carried no more
    problem.set_values_dense(1, 1, &[k], 1).unwrap();
    solved(&mut problem, "stiff");
    assert_near(&forces(&problem)[0], &[load / 2.0], 1e-12, "stiff");
    problem.set_values_dense(1, 1, &[weak], 1).unwrap();
    solved(&mut problem, "soft again");
    assert_near(&forces(&problem)[0], &[load * k / (k + weak)], 1e-12, "soft again");
}
