//! K+, null spaces and facts of bodies on the rank that has given them.

use std::collections::HashSet;

use decks::random::Random;

use super::{add_row, bits, number_chain, on_ranks, N};
use crate::body::Name;
use crate::error::Kind;
use crate::solver::tests::lent::{set_chains, set_springs};
use crate::solver::{BodyFacts, Outcome, Problem, RowKind, RowsInput};

const COUNT: usize = 5;

/// As a chain; the even ones but for the first in two parts.
fn add(problem: &mut Problem, p: usize) {
    if p == 0 || p % 2 == 1 {
        super::add_chain(problem, p);
        return;
    }
    let body = problem.add_body(2 * N).unwrap();
    set_chains(problem, body, &[2.0, 5.0], false);
    let numbers: Vec<i64> = (0..2 * N as i64).map(|i| 10 * p as i64 + i).collect();
    problem.set_numbering(body, &numbers).unwrap();
}

/// What a host can ask of a body after a setup.
#[derive(Debug, PartialEq)]
struct Asked {
    null_space: (usize, Vec<u64>),
    fixing: Vec<usize>,
    gap: Option<u64>,
    kplus: Vec<u64>,
    facts: BodyFacts,
}

fn asked(problem: &mut Problem, body: usize) -> Asked {
    let n = problem.order(body).unwrap();
    let (x, mut y) = ((0..n).map(|i| 1.0 + (i * i) as f64).collect::<Vec<_>>(), vec![0.0; n]);
    problem.kplus(body, &x, &mut y).unwrap();
    let mut facts = problem.body_facts(body).unwrap();
    // a number of the rank
    facts.factors.as_mut().unwrap().shared_with = None;
    let (r, basis) = problem.null_space(body).unwrap();
    let null_space = (r, bits(&basis));
    Asked {
        null_space,
        fixing: problem.fixing_dofs(body).unwrap(),
        gap: problem.null_space_gap(body).unwrap().map(f64::to_bits),
        kplus: bits(&y),
        facts,
    }
}

#[test]
fn a_rank_can_ask_what_was_made_of_its_own_bodies() {
    let mut problem = serial();
    problem.setup().unwrap();
    let serial: Vec<Asked> = (0..COUNT).map(|p| asked(&mut problem, p)).collect();
    on_ranks(3, |rank, problem| {
        let own: Vec<usize> = (0..COUNT).filter(|p| (p + 1) % 3 == rank).collect();
        own.iter().for_each(|p| add(problem, *p));
        (1..COUNT).filter(|p| p % 3 == rank).for_each(|p| add_row(problem, p));
        if rank > 0 {
            let error = problem.kplus(0, &[0.0; N], &mut [0.0; N]).unwrap_err();
            assert_eq!((error.kind, error.place.body), (Kind::State, Some(0)));
        }
        problem.setup().unwrap();
        for (body, p) in own.iter().enumerate() {
            assert_eq!(asked(problem, body), serial[*p], "body {p} on rank {rank}");
        }
        // new values: nothing is known until all ranks set up again
        let body = own.iter().position(|p| p % 2 == 1);
        if let Some(body) = body {
            set_chains(problem, body, &[7.0], false);
            number_chain(problem, body, own[body]);
            assert_eq!(problem.null_space(body).unwrap_err().kind, Kind::State);
            assert_eq!(problem.body_facts(body).unwrap().factors, None);
        }
        problem.setup().unwrap();
        body.into_iter().for_each(|body| assert_eq!(problem.null_space(body).unwrap().0, 1));
    });
}

/// 64 equal bodies, 64 of one pattern, 32 pairs: dealt out as they come, each rank factorises every matrix that it has once.
#[test]
fn equal_bodies_share_a_factor_on_every_rank() {
    const MANY: usize = 64;
    let kinds: [fn(usize) -> f64; 3] = [|_| 2.0, |p| 2.0 + p as f64, |p| 2.0 + (p / 2) as f64];
    let add = |problem: &mut Problem, p: usize, stiffness: f64| {
        let body = problem.add_body(N).unwrap();
        set_chains(problem, body, &[stiffness], p == 0);
        number_chain(problem, body, p);
    };
    for (kind, stiffness) in kinds.into_iter().enumerate() {
        let mut serial = Problem::new();
        (0..MANY).for_each(|p| add(&mut serial, p, stiffness(p)));
        (1..MANY).for_each(|p| add_row(&mut serial, p));
        assert_eq!(serial.solve().unwrap().outcome, Outcome::Solved);
        let u: Vec<Vec<u64>> = (0..MANY).map(|p| bits(serial.displacement(p).unwrap())).collect();
        for (size, seed) in [(2, 1), (3, 2), (4, 3), (4, 4)] {
            let rank_of: Vec<usize> = {
                let mut random = Random::new(seed);
                (0..MANY).map(|_| random.below(size)).collect()
            };
            on_ranks(size, |rank, problem| {
                let own: Vec<usize> = (0..MANY).rev().filter(|p| rank_of[*p] == rank).collect();
                own.iter().for_each(|p| add(problem, *p, stiffness(*p)));
                (1..MANY).filter(|p| p % size == rank).for_each(|p| add_row(problem, p));
                assert_eq!(problem.solve().unwrap().outcome, Outcome::Solved);
                let factors: HashSet<usize> = (0..own.len())
                    .flat_map(|body| problem.made(body))
                    .map(|part| part.kplus().factor_address())
                    .collect();
                // the held chain has a matrix of its own
                let distinct: HashSet<(bool, u64)> =
                    own.iter().map(|p| (*p == 0, stiffness(*p).to_bits())).collect();
                assert_eq!(factors.len(), distinct.len(), "kind {kind}, rank {rank} of {size}");
                for (body, p) in own.iter().enumerate() {
                    assert_eq!(bits(problem.displacement(body).unwrap()), u[*p], "kind {kind}, chain {p}");
                }
            });
        }
    }
}

/// New loads need nothing of a setup; new values of one body only its own.
#[test]
fn a_second_step_makes_only_what_has_changed() {
    const SETUP: [Name; 6] =
        [Name::Enter, Name::Plan, Name::Analyse, Name::Factorise, Name::Join, Name::Boundary];
    on_ranks(3, |rank, problem| {
        let own: Vec<usize> = (0..6).filter(|p| p % 3 == rank).collect();
        for p in &own {
            super::add_chain(problem, *p);
        }
        (1..6).filter(|p| p % 3 == rank).for_each(|p| add_row(problem, p));
        let asked = |problem: &Problem| {
            let all = problem.joined.as_ref().unwrap().rank.bodies.asked();
            SETUP.map(|name| all[name as usize])
        };
        problem.solve().unwrap();
        let first = asked(problem);
        assert_eq!(rank == 0, first == [0; 6]);
        let mut load = [0.0; N];
        load[2] = 0.5;
        problem.set_load(0, &load).unwrap();
        problem.solve().unwrap();
        assert_eq!(asked(problem), first, "new loads");
        if rank == 1 {
            set_chains(problem, 1, &[8.0], false);
        }
        problem.solve().unwrap();
        let [.., factorise, _, _] = asked(problem);
        assert_eq!(factorise - first[3], u64::from(rank == 1), "new values on rank 1");
    });
}

/// Three bars, each on its rank, the upper two on the one before: bytes of all messages of a second step and its check.
fn bytes_of_a_step(n: usize) -> u64 {
    let bytes = on_ranks(3, |rank, problem| {
        let body = problem.add_body(n).unwrap();
        let springs = (0..n).map(|i| {
            let ends = usize::from(i > 0 || rank == 0) + usize::from(i + 1 < n);
            (if i > 0 { -3.0 } else { 0.0 }, 3.0 * ends as f64)
        });
        set_springs(problem, body, springs);
        let numbers: Vec<i64> = (0..n as i64).map(|i| i + (rank * n) as i64).collect();
        problem.set_numbering(body, &numbers).unwrap();
        if rank > 0 {
            let ends = [(rank * n) as i64 - 1, (rank * n) as i64];
            let rows =
                RowsInput { ptr: &[0, 2], body: None, dof: &ends, val: &[1.0, -1.0], rhs: Some(&[0.1]) };
            problem.add_rows(RowKind::Inequality, rows).unwrap();
        }
        let mut load = vec![0.0; n];
        let mut step = |problem: &mut Problem, force: f64| {
            load[n - 1] = force;
            problem.set_load(body, &load).unwrap();
            let before = problem.traffic().bytes;
            assert_eq!(problem.solve().unwrap().outcome, Outcome::Solved);
            let u = problem.displacement(body).unwrap().to_vec();
            assert!(u.iter().all(|u| *u < 0.0));
            let forces = problem.multipliers(RowKind::Inequality).unwrap().to_vec();
            assert!(problem.check(&u, &forces, &[]).unwrap().passed());
            problem.traffic().bytes - before
        };
        step(problem, -1.0);
        step(problem, -2.0)
    });
    bytes[0]
}

/// Neither loads nor displacements of other ranks come to rank 0.
#[test]
fn what_is_said_in_a_step_to_other_ranks_does_not_depend_on_the_length_of_bars() {
    let [short, long, longest] = [50, 100, 200].map(bytes_of_a_step);
    let differs = |bytes: u64| bytes.abs_diff(short) * 50 > short;
    assert!(!differs(long) && !differs(longest), "{short} {long} {longest}");
}

/// The chains in their order, on one rank, which lends none: equal bodies share a factor.
fn serial() -> Problem {
    let mut problem = Problem::new();
    problem.prepared.lending = None;
    (0..COUNT).for_each(|p| add(&mut problem, p));
    (1..COUNT).for_each(|p| add_row(&mut problem, p));
    problem
}

/// One rank that may share its problem takes the order of several, and is asked in its own.
#[test]
fn one_rank_alone_tells_what_was_made_in_the_order_of_its_host() {
    let mut serial = serial();
    let x: Vec<f64> = (1..COUNT).map(|p| 1.0 / p as f64).collect();
    let (mut image, mut d) = (vec![0.0; COUNT - 1], vec![0.0; COUNT - 1]);
    serial.dual_apply(&x, &mut image).unwrap();
    serial.dual_rhs(&mut d).unwrap();
    let made: Vec<Asked> = (0..COUNT).map(|p| asked(&mut serial, p)).collect();
    on_ranks(1, |_, problem| {
        (0..COUNT).rev().for_each(|p| add(problem, p));
        (1..COUNT).rev().for_each(|p| add_row(problem, p));
        let x: Vec<f64> = x.iter().rev().copied().collect();
        let (mut own_image, mut own_d) = (vec![0.0; COUNT - 1], vec![0.0; COUNT - 1]);
        problem.dual_apply(&x, &mut own_image).unwrap();
        problem.dual_rhs(&mut own_d).unwrap();
        own_image.reverse();
        own_d.reverse();
        assert_eq!((bits(&own_image), bits(&own_d)), (bits(&image), bits(&d)));
        made.iter().rev().enumerate().for_each(|(body, of)| assert_eq!(asked(problem, body), *of, "{body}"));
    });
}
