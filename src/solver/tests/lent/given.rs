//! What rank 0 knows of bodies that it has given to other ranks.

use crate::body::Name;
use crate::solve::local::Rigid;
use crate::solver::tests::lent::{chains, served, set_springs, solved, N};
use crate::solver::{Problem, RowKind, RowsInput};

/// Coordinates of a chain, printed to five digits.
fn place(problem: &mut Problem, body: usize) {
    let (node, direction): (Vec<i32>, Vec<i32>) = (1..=N as i32).map(|i| (i, 1)).unzip();
    let x: Vec<f64> = (0..N).map(|i| [0.0, 0.12345, 0.23451, 0.34512, 0.4][i] * (1 + body) as f64).collect();
    problem.set_coordinates(body, 1, &node, &direction, &x, 1).unwrap();
}

#[test]
fn what_is_known_of_a_body_on_another_rank_is_what_would_be_found_in_it() {
    let served = served(|_, _| None);
    let mut problem = chains(&[4.0, 3.0, 2.0, 1.0, 5.0], served.lending());
    [0, 3].into_iter().for_each(|body| place(&mut problem, body));
    solved(&mut problem).unwrap();
    let mut lent = 0;
    for (given, known) in problem.model.bodies.iter().zip(&problem.solved().bodies) {
        let [given, known] = [&given.body, &known.body];
        lent += usize::from(known.k().is_none());
        assert_eq!((given.unit(), given.without(7.0)), (known.unit(), known.without(7.0)));
        assert_eq!((given.length(), given.last_digit()), (known.length(), known.last_digit()));
        assert_eq!((given.order, given.entries()), (known.order, known.entries()));
    }
    assert_eq!(lent, 4);
    let placed = |body: usize| problem.solved().bodies[body].body.last_digit() > 0.0;
    assert!([0, 3].into_iter().all(placed) && ![1, 4].into_iter().any(placed));
    drop(problem);
    assert_eq!(served.end(), 0);
}

/// Equal chains of which one holds another dof, or lies elsewhere: on one rank, and on rank 0.
#[test]
fn bodies_are_equal_only_if_all_that_the_host_has_told_of_them_is() {
    for change in [
        (|problem, body| problem.set_fixing(body, Some(&[2])).unwrap()) as fn(&mut Problem, usize),
        |problem, body| place(problem, body),
    ] {
        for body in [4, 5, 6] {
            let served = served(|_, _| None);
            let mut both = [chains(&[2.0; 7], served.lending()), chains(&[2.0; 7], None)];
            let answers = both.each_mut().map(|problem| {
                change(problem, body);
                let answer = solved(problem).unwrap();
                let inverses: Vec<Vec<f64>> = (0..7)
                    .map(|p| {
                        let mut u = vec![0.0; N];
                        problem.kplus(p, &[1.0, -0.5, 0.25, 2.0, 0.0], &mut u).unwrap();
                        u
                    })
                    .collect();
                (answer, inverses)
            });
            assert_eq!(answers[0], answers[1], "{body}");
            assert!(served.asked(Name::Give) > 2);
            drop(both);
            assert_eq!(served.end(), 0);
        }
    }
}

/// What could not be made is asked for again, and what could be given is not sent again.
#[test]
fn after_a_failure_no_body_is_given_twice() {
    let served = served(|_, _| None);
    let mut problem = chains(&[4.0, 3.0, 2.0, 1.0, 5.0], served.lending());
    problem.set_i64("memory_limit", 1).unwrap();
    problem.solve().unwrap_err();
    let given = served.asked(Name::Give);
    problem.set_i64("memory_limit", 1 << 40).unwrap();
    assert_eq!(solved(&mut problem).as_ref(), Ok(&super::serial(&[4.0, 3.0, 2.0, 1.0, 5.0])));
    assert_eq!((given, served.asked(Name::Give)), (4, 4));
    drop(problem);
    assert_eq!(served.end(), 0);
}

/// A chain whose last spring is a billion times softer, at both ends tied to others, and a pilot of one unknown, tied to a chain and
/// loaded: unknowns that rows hold, on other ranks.
#[test]
fn unknowns_that_rows_hold_have_their_metric_on_other_ranks() {
    let served = served(|_, _| None);
    let answers = [served.lending(), None].map(|lending| {
        let mut problem = chains(&[4.0, 3.0, 2.0, 1.0], lending);
        let soft = [1.0, 1.0, 1.0, 1e-9];
        let row = |i: usize| match i.checked_sub(1) {
            Some(before) => (-soft[before], soft.get(i).unwrap_or(&0.0) + soft[before]),
            None => (0.0, soft[0]),
        };
        let (chain, pilot) = (problem.add_body(N).unwrap(), problem.add_body(1).unwrap());
        set_springs(&mut problem, chain, (0..N).map(row));
        set_springs(&mut problem, pilot, [(0.0, 1e-9)].into_iter());
        assert_eq!((chain, pilot), (4, 5), "on ranks 2 and 0");
        problem.set_load(pilot, &[-0.5]).unwrap();
        let (chain, pilot, end) = (chain as i64, pilot as i64, N as i64 - 1);
        for (body, dof) in [([3, chain], [end, 0]), ([0, chain], [end, end]), ([chain, pilot], [end, 0])] {
            let rows = RowsInput { ptr: &[0, 2], body: Some(&body), dof: &dof, val: &[1.0, -1.0], rhs: None };
            problem.add_rows(RowKind::Equality, rows).unwrap();
        }
        let answer = solved(&mut problem).unwrap();
        let (model, prepared) = (problem.solved(), &problem.prepared);
        assert!(prepared.carries(4) && prepared.carries(5));
        let bodies = prepared.locals(model, &prepared.done(model).unwrap().islands[0]).unwrap();
        let v = bodies.iter().map(|body| (0..body.order()).map(|i| 1.0 + i as f64).collect()).collect();
        let rigid = bodies.ask(|_| Rigid, &bodies.put(v).unwrap()).unwrap();
        assert!(rigid[4].iter().any(|a| *a != 0.0), "R'D v");
        (answer, rigid)
    });
    assert_eq!(answers[0], answers[1]);
    assert_eq!(served.end(), 0);
}
