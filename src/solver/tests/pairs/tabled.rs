//! Surfaces that name unknowns of the host's table.

use super::*;
use crate::solver::{DofTableInput, Outcome, PairField, Storage};

/// Every direction of every node of the blocks is an unknown of the table; those that K has not are driven by `constant`.
fn set_table(problem: &mut Problem, blocks: &[&Block], constant: impl Fn(usize, usize) -> f64) {
    let (mut number, mut constants, mut first) = (Vec::new(), Vec::new(), 0);
    for (which, block) in blocks.iter().enumerate() {
        number.extend(block.dof.iter().map(|dof| if *dof < 0 { -1 } else { first + dof }));
        constants
            .extend((0..block.dof.len()).map(|i| if block.dof[i] < 0 { constant(which, i) } else { 0.0 }));
        first += block.free as i64;
    }
    let input =
        DofTableInput { number: &number, ptr: None, term: &[], coefficient: &[], constant: Some(&constants) };
    problem.set_dof_table(input).unwrap();
}

/// A side of a block whose first unknown in the table is `first`.
fn surface_by_table(problem: &mut Problem, block: &Block, first: usize, top: bool) -> usize {
    let dof: Vec<i64> = (0..block.dof.len()).map(|i| (first + i) as i64).collect();
    block.surface_of(problem, None, &dof, top)
}

#[test]
fn a_table_of_supports_gives_the_rows_and_the_answer_of_unknowns_below_base() {
    for dim in [2, 3] {
        let [lower, upper] = stacked(dim);
        let solved = |by_table: bool| {
            let mut problem = Problem::new();
            let bodies = [lower.give(&mut problem), upper.give(&mut problem)];
            let (master, slave) = if by_table {
                set_table(&mut problem, &[&lower, &upper], |_, _| 0.0);
                let second = lower.dof.len();
                (
                    surface_by_table(&mut problem, &lower, 0, true),
                    surface_by_table(&mut problem, &upper, second, false),
                )
            } else {
                (lower.surface(&mut problem, bodies[0], true), upper.surface(&mut problem, bodies[1], false))
            };
            let made = pair(&mut problem, slave, master, 0.1);
            problem.pair_set(made, "friction", &[0.3]).unwrap();
            problem.pair_set(made, "offset", &[1e-3]).unwrap();
            problem.pairs_find().unwrap();
            assert_eq!(problem.solve().unwrap().outcome, Outcome::Solved);
            (problem, made)
        };
        let ((by_table, made), (by_body, _)) = (solved(true), solved(false));
        assert!(by_table.model.contact.same_but_rhs(&by_body.model.contact));
        assert!(by_table.model.friction.rows.same_but_rhs(&by_body.model.friction.rows));
        assert_eq!(by_table.model.contact.rhs, by_body.model.contact.rhs);
        assert_eq!(
            by_table.pair_field(made, PairField::Force).unwrap(),
            by_body.pair_field(made, PairField::Force).unwrap()
        );
        // forces on all unknowns, held ones too, have no sum
        let mut sum = vec![0.0; dim];
        let mut spread = vec![0.0; lower.dof.len() + upper.dof.len()];
        by_table.spread_reaction(None, |i, force| spread[i] = force).unwrap();
        spread.iter().enumerate().for_each(|(i, force)| sum[i % dim] += force);
        let most = spread.iter().fold(0.0, |most: f64, force| most.max(force.abs()));
        assert!(most > 0.0 && sum.iter().all(|sum| sum.abs() < 1e-12 * most), "{sum:?}");
    }
}

/// What the table drives is on its way when gaps are judged, whether it comes before the find or after it.
#[test]
fn a_driven_block_presses_by_what_its_constants_tell() {
    const DOWN: f64 = 2e-3;
    let [lower, upper] = stacked(2);
    let constant = |which: usize, i: usize| if which == 1 && i % 2 == 1 { -DOWN } else { 0.0 };
    let pressed = |constants_first: bool| {
        let mut problem = Problem::new();
        lower.give(&mut problem);
        upper.give(&mut problem);
        set_table(&mut problem, &[&lower, &upper], |_, _| 0.0);
        let master = surface_by_table(&mut problem, &lower, 0, true);
        let slave = surface_by_table(&mut problem, &upper, lower.dof.len(), false);
        let made = pair(&mut problem, slave, master, 0.1);
        if !constants_first {
            problem.pairs_find().unwrap();
        }
        set_table(&mut problem, &[&lower, &upper], constant);
        if constants_first {
            problem.pairs_find().unwrap();
        }
        // K v = f - K_fh g: the coupling is the host's
        let g: Vec<f64> =
            (0..upper.dof.len()).map(|i| if upper.dof[i] < 0 { constant(1, i) } else { 0.0 }).collect();
        let mut load = vec![0.0; lower.dof.len()];
        load.extend(upper.forces(&g).iter().zip(&upper.dof).map(|(f, dof)| if *dof < 0 { 0.0 } else { -f }));
        problem.set_all_loads(&load).unwrap();
        assert_eq!(problem.solve().unwrap().outcome, Outcome::Solved);
        let mut u = vec![0.0; load.len()];
        problem.spread_displacement(problem.displacements().unwrap(), |i, v| u[i] = v).unwrap();
        (u, problem.pair_field(made, PairField::Force).unwrap())
    };
    let (first, then) = (pressed(true), pressed(false));
    assert_eq!(first, then);
    // by symmetry of two equal blocks held alike the middle goes down by half, away from the side that the lower one has held
    let top = upper.side(true)[0];
    assert_eq!(first.0[lower.dof.len() + 2 * top + 1], -DOWN);
    assert!(first.1.iter().sum::<f64>() > 0.0);
}

/// A tool of three nodes that hangs on a pilot without stiffness: two displacements and a turn.
#[test]
fn a_rigid_tool_follows_its_pilot_under_a_load() {
    const P: f64 = 1e-3;
    let lower = block(&[0.0, 0.0], &[2.0, 1.0], &[4, 2], |x| x[1] == 0.0);
    let mut problem = Problem::new();
    lower.give(&mut problem);
    let pilot = problem.add_body(3).unwrap();
    problem.set_stiffness_dense(pilot, 3, &[0.0; 9], 3, Storage::Full).unwrap();
    // the tool: a line from x = -1 to 3 at y = 1, its pilot above x = 0.7
    let tool = [[3.0, 1.0], [0.4, 1.0], [-1.0, 1.0]];
    let at = [0.7, 4.0];
    let (n, free) = (lower.dof.len(), lower.free as i64);
    let mut number = lower.dof.clone();
    number.extend([free, free + 1, free + 2]);
    let (mut ptr, mut term, mut coefficient) = (vec![0; n + 4], Vec::new(), Vec::new());
    for x in tool {
        let arm = [x[0] - at[0], x[1] - at[1]];
        for (i, turned) in [(0, -arm[1]), (1, arm[0])] {
            term.extend([(n + i) as i64, (n + 2) as i64]);
            coefficient.extend([1.0, turned]);
            number.push(-1);
            ptr.push(term.len());
        }
    }
    let input = DofTableInput {
        number: &number,
        ptr: Some(&ptr),
        term: &term,
        coefficient: &coefficient,
        constant: None,
    };
    problem.set_dof_table(input).unwrap();
    let slave = surface_by_table(&mut problem, &lower, 0, true);
    let dof: Vec<i64> = (0..6).map(|i| (n + 3 + i) as i64).collect();
    let master = problem.surface_add(None, 2, tool.as_flattened(), 2, Some((&dof, 2))).unwrap();
    problem.surface_faces(master, Shape::Line2, &[1, 0, 2, 1]).unwrap();
    let made = pair(&mut problem, slave, master, 0.1);
    problem.pair_set(made, "friction", &[0.2]).unwrap();
    problem.pairs_find().unwrap();
    let mut load = vec![0.0; number.len()];
    load[n + 1] = -P;
    problem.set_all_loads(&load).unwrap();
    assert_eq!(problem.solve().unwrap().outcome, Outcome::Solved);
    let facts = problem.pair_info(made).unwrap();
    assert!((facts.force[1] + P).abs() < 1e-9 * P && facts.force[0].abs() < 1e-9 * P, "{facts:?}");
    // the resultant goes through the pilot, and the nodes of the tool move as it does
    assert!((facts.moment[2] + P * at[0]).abs() < 1e-8 * P, "{facts:?}");
    let mut u = vec![0.0; number.len()];
    problem.spread_displacement(problem.displacements().unwrap(), |i, v| u[i] = v).unwrap();
    for (k, x) in tool.iter().enumerate() {
        let turned = u[n + 1] + (x[0] - at[0]) * u[n + 2];
        assert!(u[n + 1] < 0.0 && (u[n + 3 + 2 * k + 1] - turned).abs() < 1e-15);
    }
}

/// Slave and master hang on the same unknown: the row has lost its entries, and touching is no contradiction.
#[test]
fn a_row_whose_unknowns_cancel_is_switched_off() {
    let upper = block(&[0.0, 0.0], &[2.0, 1.0], &[4, 2], |_| false);
    let mut problem = Problem::new();
    let body = upper.give(&mut problem);
    let slave = upper.surface(&mut problem, body, false);
    let under = problem.surface_add(Some(body), 2, &upper.x, 2, Some((&upper.dof, 2))).unwrap();
    let turned: Vec<i64> = upper.faces(false).chunks(2).flat_map(|face| [face[1], face[0]]).collect();
    problem.surface_faces(under, Shape::Line2, &turned).unwrap();
    let made = pair(&mut problem, slave, under, 0.1);
    problem.pairs_find().unwrap();
    assert!(problem.model.contact.rhs.iter().all(|c| *c == f64::INFINITY));
    assert_eq!(problem.pair_info(made).unwrap().held, 5);
}

#[test]
fn surfaces_with_and_without_the_table_do_not_meet_and_none_outgrows_it() {
    let [lower, upper] = stacked(2);
    let mut problem = Problem::new();
    let bodies = [lower.give(&mut problem), upper.give(&mut problem)];
    set_table(&mut problem, &[&lower, &upper], |_, _| 0.0);
    let master = surface_by_table(&mut problem, &lower, 0, true);
    let slave = upper.surface(&mut problem, bodies[1], false);
    let error = problem.pair_add(slave, master, PairMethod::NodeToFace, false, 0.1).unwrap_err();
    assert_eq!(error.kind, crate::error::Kind::Argument("master"));
    let short = DofTableInput { number: &[0, 1], ptr: None, term: &[], coefficient: &[], constant: None };
    let error = problem.set_dof_table(short).unwrap_err();
    assert_eq!(error.kind, crate::error::Kind::Argument("n"));
    let n = (lower.dof.len() + upper.dof.len()) as i64;
    let error = problem.surface_add(None, 2, &[0.0, 0.0], 2, Some((&[0, n], 2))).unwrap_err();
    assert_eq!((error.kind, error.place.node), (crate::error::Kind::Argument("dof"), Some(0)));
}
