//! Failures on other ranks, and of the link to them.

use std::sync::atomic::{AtomicUsize, Ordering};

use super::{bits, chains, serial, served, serving, solved, Served, N};
use crate::error::{Error, Kind};
use crate::ranks::loopback::{linked, linked_by};
use crate::ranks::Link;
use crate::solver::{Modes, Outcome, Problem, Rank};

/// Each request of a solve fails in each way, on each rank; the next solve is right.
#[test]
fn a_failure_on_another_rank_is_that_of_the_call_and_the_next_solve_is_right() {
    let stiffness = [4.0, 3.0, 2.0, 1.0, 5.0];
    let right = serial(&stiffness);
    let kinds = [Kind::Memory, Kind::NullSpace, Kind::Indefinite, Kind::Cancelled, Kind::TimeOver].map(Some);
    let stops = [Some(Kind::Cancelled), Some(Kind::TimeOver)];
    // none: a panic
    for (kind, rank) in kinds.into_iter().chain([None]).flat_map(|kind| [(kind, 1), (kind, 2)]) {
        let (mut nth, mut failures) = (1, 0);
        loop {
            let served = served(move |at, count| {
                let fails = (at, count) == (rank, nth);
                fails.then(|| {
                    Err(Error::new(kind.expect("a panic, as the test wants"), "made to fail").dof(2))
                })
            });
            let mut problem = chains(&stiffness, served.lending());
            let is_solved = match problem.solve() {
                Ok(report) if report.outcome == Outcome::Solved => {
                    assert_eq!(bits(&problem), right);
                    true
                }
                // a solve that is stopped keeps what it has
                Ok(report) => {
                    assert!(stops.contains(&kind), "{:?}", report.outcome);
                    false
                }
                Err(error) => {
                    assert_eq!(error.kind, kind.unwrap_or(Kind::Internal), "{error}");
                    assert!(kind.is_none() || error.place.dof == Some(2), "{error}");
                    false
                }
            };
            if !is_solved {
                failures += 1;
                assert_eq!(solved(&mut problem).as_ref(), Ok(&right), "{kind:?} {rank} {nth}");
            }
            drop(problem);
            assert_eq!(served.end(), 0);
            if is_solved {
                break;
            }
            nth += 1;
        }
        assert!(failures >= 3, "{kind:?}: {failures} requests");
    }
}

/// Floating chains that are said to be held: of several the first is named, wherever they are. What could be made stays.
#[test]
fn the_error_is_that_of_the_first_body_and_others_are_not_made_again() {
    for wrong in [vec![1, 2, 3], vec![2, 3], vec![3, 4], vec![2, 4], vec![4]] {
        let served = served(|_, _| None);
        let stiffness = [4.0, 3.0, 2.0, 1.0, 5.0];
        let mut both = [chains(&stiffness, served.lending()), chains(&stiffness, None)];
        let ends = both.each_mut().map(|problem| {
            for &body in &wrong {
                problem.set_null_space(body, N, 0, &[], N, Modes::Exact).unwrap();
            }
            let error = problem.setup().unwrap_err();
            assert_eq!((error.kind, error.place.body), (Kind::NullSpace, Some(wrong[0])), "{error}");
            for &body in &wrong {
                problem.set_null_space(body, N, 1, &[1.0; N], N, Modes::Exact).unwrap();
            }
            (error, solved(problem).unwrap(), problem.work())
        });
        assert_eq!(ends[0], ends[1], "{wrong:?}");
    }
}

/// A link that fails at a message.
struct Failing {
    link: Box<dyn Link>,
    left: AtomicUsize,
}

impl Failing {
    fn goes_on(&self) -> bool {
        self.left.fetch_update(Ordering::Relaxed, Ordering::Relaxed, |left| left.checked_sub(1)).is_ok()
    }
}

impl Link for Failing {
    fn send(&self, rank: usize, data: &[u8]) -> bool {
        self.goes_on() && self.link.send(rank, data)
    }

    fn flush(&self) -> bool {
        self.link.flush()
    }

    fn receive(&self, rank: usize, data: &mut [u8]) -> bool {
        self.goes_on() && self.link.receive(rank, data)
    }
}

#[test]
fn after_a_broken_link_a_problem_goes_on_alone() {
    let stiffness = [4.0, 3.0, 2.0, 1.0];
    let right = serial(&stiffness);
    let mut broken = 0;
    for left in 0.. {
        let (leader, others) = linked_by(3, |link| Box::new(Failing { link, left: AtomicUsize::new(left) }));
        let served = serving(leader, others, |_, _| None);
        let mut problem = chains(&stiffness, served.lending());
        match solved(&mut problem) {
            Ok(bits) => {
                assert_eq!(bits, right);
                break;
            }
            Err(error) => assert_eq!(error.kind, Kind::Communication, "{error}"),
        }
        broken += 1;
        assert_eq!(solved(&mut problem).as_ref(), Ok(&right), "alone, after {left} messages");
        drop(problem);
        // the ranks that serve end when the link is gone
        let Served { leader, threads, .. } = served;
        drop(leader);
        threads.into_iter().for_each(|thread| thread.join().unwrap());
    }
    assert!(broken > 20, "{broken} messages");
}

#[test]
fn a_problem_goes_on_alone_when_the_others_serve_no_longer() {
    let stiffness = [4.0, 3.0, 2.0, 1.0];
    let served = served(|_, _| None);
    let mut problem = chains(&stiffness, served.lending());
    assert_eq!(solved(&mut problem), Ok(serial(&stiffness)));
    served.end();
    assert_eq!(solved(&mut problem), Ok(serial(&stiffness)));
    let mut late = Problem::new();
    late.add_body(1).unwrap();
    let (leader, _others) = linked(2);
    assert_eq!(late.join(Rank::new(leader)).unwrap_err().kind, Kind::State);
}
