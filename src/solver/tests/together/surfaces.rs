//! Pairs of surfaces on one of several ranks.

use super::{add_chain, on_ranks};
use crate::error::Kind;
use crate::solver::tests::lent::{set_chains, N};
use crate::solver::tests::pairs::{pair_by, stacked, METHODS};
use crate::solver::{Outcome, PairField, PairMethod, Problem, RowKind, RowsInput};

/// Two load steps of two blocks that rub, the upper one moved in between: forces, slips and states of the foot, and the resultant.
fn rubbed(problem: &mut Problem, method: PairMethod) -> Vec<Vec<u64>> {
    let [lower, upper] = stacked(3);
    let bodies = [lower.give(problem), upper.give(problem)];
    let (master, slave) = (lower.surface(problem, bodies[0], true), upper.surface(problem, bodies[1], false));
    let made = pair_by(problem, method, slave, master, 0.1);
    problem.pair_set(made, "offset", &[1e-3]).unwrap();
    let mut all = Vec::new();
    for (friction, moved) in [(0.3, 0.0), (0.2, 1e-3)] {
        problem.pair_set(made, "friction", &[friction]).unwrap();
        let x: Vec<f64> =
            upper.x.iter().enumerate().map(|(i, x)| if i % 3 == 0 { x + moved } else { *x }).collect();
        problem.surface_move(slave, &x, 3).unwrap();
        problem.pairs_find().unwrap();
        assert_eq!(problem.solve().unwrap().outcome, Outcome::Solved);
        for field in [PairField::Force, PairField::Shear, PairField::Slip, PairField::Closed] {
            all.push(problem.pair_field(made, field).unwrap().iter().map(|v| v.to_bits()).collect());
        }
        let facts = problem.pair_info(made).unwrap();
        assert!(facts.closed > 0 && facts.force[2] > 0.0);
        all.push(facts.force.iter().map(|v| v.to_bits()).collect());
        problem.pairs_commit().unwrap();
    }
    all
}

#[test]
fn a_pair_on_any_rank_has_the_bits_of_one_rank() {
    for method in METHODS {
        let alone = rubbed(&mut Problem::new(), method);
        for (size, owner) in [(1, 0), (2, 0), (2, 1), (3, 1)] {
            let found = on_ranks(size, |rank, problem| {
                if rank == owner {
                    return rubbed(problem, method);
                }
                // another rank has a chain, or nothing
                if rank == 2 {
                    let body = problem.add_body(N).unwrap();
                    set_chains(problem, body, &[2.0], true);
                    problem.set_load(body, &[1.0; N]).unwrap();
                }
                (0..2).for_each(|_| assert_eq!(problem.solve().unwrap().outcome, Outcome::Solved));
                Vec::new()
            });
            assert_eq!(found[owner], alone, "{size} ranks, pair of rank {owner}");
        }
    }
}

/// The block rests on a chain of rank 1 by a row of the host, which comes after the rows of the pair; a find leaves it as it is.
#[test]
fn rows_that_name_unknowns_of_other_ranks_stay_behind_those_of_pairs() {
    on_ranks(2, |rank, problem| {
        if rank == 1 {
            add_chain(problem, 0);
            (0..2).for_each(|_| assert_eq!(problem.solve().unwrap().outcome, Outcome::Solved));
            return;
        }
        let [lower, upper] = stacked(2);
        for (block, first) in [(&lower, 1000), (&upper, 2000)] {
            let body = block.give(problem);
            let numbers: Vec<i64> = (first..first + block.free as i64).collect();
            problem.set_numbering(body, &numbers).unwrap();
        }
        let (master, slave) = (lower.surface(problem, 0, true), upper.surface(problem, 1, false));
        let made = pair_by(problem, PairMethod::NodeToFace, slave, master, 0.1);
        problem.pair_set(made, "offset", &[1e-3]).unwrap();
        let row = problem.sizes().rows;
        let input =
            RowsInput { ptr: &[0, 2], body: None, dof: &[4, 2000], val: &[-1.0, 1.0], rhs: Some(&[1e-3]) };
        problem.add_rows(RowKind::Inequality, input).unwrap();
        let mut before = None;
        for _ in 0..2 {
            problem.pairs_find().unwrap();
            assert_eq!(problem.solve().unwrap().outcome, Outcome::Solved);
            let forces = problem.multipliers(RowKind::Inequality).unwrap().to_vec();
            assert!(forces[row] > 0.0 && before.is_none_or(|before| before == forces[row].to_bits()));
            before = Some(forces[row].to_bits());
        }
    });
}

#[test]
fn a_surface_on_unknowns_of_another_rank_is_refused() {
    on_ranks(2, |rank, problem| {
        add_chain(problem, rank);
        let dof = [10 * (1 - rank as i64), -1];
        let error = problem.surface_add(None, 2, &[0.0, 0.0], 2, Some((&dof, 2))).unwrap_err();
        assert_eq!((error.kind, error.place.node), (Kind::Unsupported, Some(0)));
    });
}
