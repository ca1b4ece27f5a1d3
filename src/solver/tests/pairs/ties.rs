//! Ties over gaps.

use super::*;
use crate::solver::{Outcome, PairField, RowKind};

/// Two floating blocks with a gap of 0.3 between them.
fn tied(dim: usize, method: PairMethod) -> (Problem, [Block; 2], [usize; 2], [usize; 2], usize) {
    let (size, steps) = (&[1.5, 1.0, 1.0][3 - dim..], &[3, 2, 2][3 - dim..]);
    let mut low = vec![0.0; dim];
    let lower = block(&low, size, steps, |_| false);
    low[dim - 1] = size[dim - 1] + 0.3;
    low[0] = 0.2;
    let upper = block(&low, &size.iter().map(|s| 0.7 * s).collect::<Vec<_>>(), steps, |_| false);
    let mut problem = Problem::new();
    let bodies = [lower.give(&mut problem), upper.give(&mut problem)];
    let surfaces =
        [lower.surface(&mut problem, bodies[0], true), upper.surface(&mut problem, bodies[1], false)];
    let made = problem.pair_add(surfaces[1], surfaces[0], method, true, 0.5).unwrap().0;
    (problem, [lower, upper], bodies, surfaces, made)
}

#[test]
fn ties_over_a_gap_leave_the_motions_of_a_floating_pair_free() {
    for (dim, method) in [2, 3].into_iter().flat_map(|dim| METHODS.map(|method| (dim, method))) {
        let (mut problem, blocks, _, surfaces, made) = tied(dim, method);
        problem.pairs_find().unwrap();
        let rows = &problem.model.equalities;
        assert_eq!(rows.len(), dim * blocks[1].side(false).len());
        assert!(rows.rhs.iter().all(|h| *h == 0.0) && (0..rows.len()).all(|i| !rows.is_empty_row(i)));
        let turns: &[[usize; 2]] = if dim == 2 { &[[0, 1]] } else { &[[0, 1], [1, 2], [2, 0]] };
        for [i, j] in turns {
            let u: Vec<f64> = blocks
                .iter()
                .flat_map(|block| block.x.chunks(dim))
                .flat_map(|x| {
                    let mut u = vec![0.0; dim];
                    (u[*i], u[*j]) = (-x[*j], x[*i]);
                    u
                })
                .collect();
            for row in 0..rows.len() {
                let work = rows.matrix.row_dot(row, &u);
                assert!(work.abs() <= 1e-13 * rows.matrix.row_dot_abs(row, &u), "{work:e}");
            }
        }
        // the gap of 0.3 is kept, not closed
        let report = problem.solve().unwrap();
        assert_eq!(report.outcome, Outcome::Solved);
        assert!(problem.displacements().unwrap().iter().all(|u| u.abs() < 1e-12), "nothing is strained");
        // both turn by half a radian: nothing has opened
        for (block, surface) in blocks.iter().zip(surfaces) {
            let (c, s) = (0.5f64.cos(), 0.5f64.sin());
            let turned: Vec<f64> = block
                .x
                .chunks(dim)
                .flat_map(|x| {
                    let mut x = x.to_vec();
                    (x[0], x[dim - 1]) = (c * x[0] - s * x[dim - 1], s * x[0] + c * x[dim - 1]);
                    x
                })
                .collect();
            problem.surface_move(surface, &turned, dim).unwrap();
        }
        problem.pairs_find().unwrap();
        assert!(problem.model.equalities.rhs.iter().all(|h| h.abs() < 1e-14));
        // one of them moves away by 0.1 along the normal: the next solve closes that
        let away: Vec<f64> = blocks[1]
            .x
            .chunks(dim)
            .flat_map(|x| {
                let mut x = x.to_vec();
                x[dim - 1] += 0.1;
                x
            })
            .collect();
        problem.surface_move(surfaces[1], &away, dim).unwrap();
        problem.surface_move(surfaces[0], &blocks[0].x, dim).unwrap();
        problem.pairs_find().unwrap();
        let h = &problem.model.equalities.rhs;
        assert!(
            h.chunks(dim).all(|h| (h[0] + 0.1).abs() < 1e-14 && h[1..].iter().all(|h| h.abs() < 1e-14)),
            "{h:?}"
        );
        let gap = problem.pair_field(made, PairField::Normal).unwrap();
        assert!(blocks[1].side(false).iter().all(|node| (gap[dim * node + dim - 1] + 1.0).abs() < 1e-15));
    }
}

#[test]
fn a_tie_carries_tension_and_shear() {
    METHODS.into_iter().for_each(tension_and_shear);
}

fn tension_and_shear(method: PairMethod) {
    let (mut problem, blocks, bodies, _, made) = tied(2, method);
    problem.pairs_find().unwrap();
    // supports by further rows: the lower block's foot is fixed
    let foot = blocks[0].side(false);
    let dof: Vec<i64> = foot.iter().flat_map(|node| [2 * *node as i64, 2 * *node as i64 + 1]).collect();
    let ptr: Vec<usize> = (0..=dof.len()).collect();
    let (body, val) = (vec![bodies[0] as i64; dof.len()], vec![1.0; dof.len()]);
    let rows = crate::solver::RowsInput { ptr: &ptr, body: Some(&body), dof: &dof, val: &val, rhs: None };
    problem.add_rows(RowKind::Equality, rows).unwrap();
    let top = blocks[1].side(true);
    let mut load = vec![0.0; blocks[1].dof.len()];
    top.iter().for_each(|node| (load[2 * node], load[2 * node + 1]) = (2e-4, 1e-3));
    problem.set_load(bodies[1], &load).unwrap();
    assert_eq!(problem.solve().unwrap().outcome, Outcome::Solved);
    let facts = problem.pair_info(made).unwrap();
    let count = top.len() as f64;
    assert!(
        (facts.force[0] + 2e-4 * count).abs() < 1e-9 && (facts.force[1] + 1e-3 * count).abs() < 1e-9,
        "{facts:?}"
    );
    assert!(problem.pair_field(made, PairField::Force).unwrap().iter().sum::<f64>() < 0.0, "tension");
}

#[test]
fn a_foot_tied_to_a_rigid_plane_over_a_gap_follows_it() {
    METHODS.into_iter().for_each(foot_on_plane);
}

fn foot_on_plane(method: PairMethod) {
    use crate::solver::RigidShape;
    let upper = block(&[0.0, 0.0], &[2.0, 1.0], &[4, 2], |x| x[1] == 1.0);
    let mut problem = Problem::new();
    let body = upper.give(&mut problem);
    let slave = upper.surface(&mut problem, body, false);
    let plane = |x: f64, y: f64| [x, y - 0.05, 0.0, 1.0];
    let master = problem.surface_rigid(2, RigidShape::Plane, &plane(0.0, 0.0)).unwrap();
    let made = problem.pair_add(slave, master, method, true, 0.1).unwrap().0;
    // while it is off it demands nothing, and finds no points
    problem.pair_set(made, "on", &[0.0]).unwrap();
    problem.surface_move(master, &plane(7.0, 0.0), 2).unwrap();
    problem.pairs_find().unwrap();
    assert!((0..10).all(|row| problem.model.equalities.is_empty_row(row)));
    problem.pair_set(made, "on", &[1.0]).unwrap();
    problem.surface_move(master, &plane(0.0, 0.0), 2).unwrap();
    problem.pairs_find().unwrap();
    problem.surface_move(master, &plane(0.01, 0.02), 2).unwrap();
    problem.pairs_find().unwrap();
    problem.solve().unwrap();
    let u = upper.spread(problem.displacement(body).unwrap());
    for node in upper.side(false) {
        assert!((u[2 * node] - 0.01).abs() < 1e-12 && (u[2 * node + 1] - 0.02).abs() < 1e-12);
    }
}
