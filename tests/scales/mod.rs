//! Models that hold things of very different size: nearly free bodies, rows far away, groups that have nothing to do with
//! each other, long travels, penalty supports, gaps of mixed scale. What passes must be right where a user looks.
//!
//! | module | models |
//! |---|---|
//! | [`free`], [`cut`] | an upper block free to slide and spin, moduli varied, null spaces mixed and noisy, cut into pieces |
//! | [`beams`] | long beams on springs that only push and on rigid beds |
//! | [`far`] | a row whose gap is never closed |
//! | [`presolve`] | rows that contradict each other beside one that is far away |
//! | [`heavy`] | a heavy body whose loads cancel beside a light one |
//! | [`long`] | rows over all unknowns of a large body |
//! | [`loose`] | towers, walls and heaps of many loose bodies |
//! | [`groups`] | groups of bodies that no row joins |
//! | [`slides`] | bodies that slide along normals of few digits |
//! | [`travel`] | a body that travels much further than it deforms |
//! | [`penalty`] | displacements prescribed by penalty |
//! | [`mixed`] | contrast 100, gaps from 1e-6 to 1 of the displacement; [`dense`] is its second solver |
//! | [`plane`] | the plane models that they share |

mod beams;
mod cut;
mod dense;
mod far;
mod free;
mod groups;
mod heavy;
mod long;
mod loose;
mod mixed;
mod penalty;
mod plane;
mod presolve;
mod slides;
mod travel;

use crate::support::hand_over;
use decks::Deck;
use feti_contact::solver::{Outcome, Problem, Report, RowKind};

/// An answer over all unknowns, contact rows, equality rows.
struct Answer {
    u: Vec<f64>,
    lambda: Vec<f64>,
    mu: Vec<f64>,
    report: Report,
}

/// The answer whatever its outcome.
fn answer(problem: &mut Problem) -> feti_contact::error::Result<Answer> {
    let report = problem.solve()?;
    Ok(Answer {
        u: problem.displacements()?.to_vec(),
        lambda: problem.multipliers(RowKind::Inequality)?.to_vec(),
        mu: problem.multipliers(RowKind::Equality)?.to_vec(),
        report,
    })
}

/// An answer that the library calls solved.
fn solved(problem: &mut Problem) -> Answer {
    let answer = answer(problem).unwrap();
    assert_eq!(answer.report.outcome, Outcome::Solved, "{:?}", answer.report);
    assert!(answer.report.certificate.passed());
    answer
}

fn problem(deck: &Deck) -> Problem {
    hand_over::problem(deck).unwrap()
}

/// Claims about many cases: all of them are tried before the test ends, so that one run shows every figure.
#[derive(Default)]
struct Claims {
    tried: usize,
    failed: Vec<String>,
}

impl Claims {
    fn claim(&mut self, holds: bool, what: impl FnOnce() -> String) {
        self.tried += 1;
        if !holds {
            self.failed.push(what());
        }
    }

    /// `figure <= limit`; what is not a number fails.
    fn at_most(&mut self, figure: f64, limit: f64, what: &str) {
        self.claim(figure <= limit, || format!("{what}: {figure:.1e}, allowed {limit:.0e}"));
    }

    /// The answer, where it is one that the library calls solved.
    fn solved(&mut self, problem: &mut Problem, what: &str) -> Option<Answer> {
        match answer(problem) {
            Ok(answer) => {
                let holds = answer.report.outcome == Outcome::Solved && answer.report.certificate.passed();
                let worst = answer.report.certificate.worst();
                let outcome = answer.report.outcome;
                self.claim(holds, || format!("{what}: {outcome:?}, worst {worst:.1e}"));
                Some(answer)
            }
            Err(error) => {
                self.claim(false, || format!("{what}: {error}"));
                None
            }
        }
    }

    fn end(self) {
        assert!(self.tried > 0);
        let failed = self.failed.len();
        assert!(failed == 0, "{failed} of {} claims fail:\n{}", self.tried, self.failed.join("\n"));
    }
}

/// max |x_i|, and not a number where one of them is none.
fn largest(x: &[f64]) -> f64 {
    x.iter().fold(0.0, |most, x| if x.abs() > most || x.is_nan() { x.abs() } else { most })
}

/// max |x_i - y_i|
fn distance(x: &[f64], y: &[f64]) -> f64 {
    assert_eq!(x.len(), y.len());
    largest(&x.iter().zip(y).map(|(x, y)| x - y).collect::<Vec<_>>())
}

/// max |x_i - y_i| / max |y_i|
fn difference(x: &[f64], y: &[f64]) -> f64 {
    distance(x, y) / largest(y)
}

fn dot(x: &[f64], y: &[f64]) -> f64 {
    x.iter().zip(y).map(|(x, y)| x * y).sum()
}

/// y := y + a x
fn add(a: f64, x: &[f64], y: &mut [f64]) {
    y.iter_mut().zip(x).for_each(|(y, x)| *y += a * x);
}

/// 1/2 u'Ku - f'u, force x length.
fn energy(deck: &Deck, u: &[f64]) -> f64 {
    let of = |p: usize| {
        let (own, body) = (&u[deck.offset(p)..deck.offset(p + 1)], &deck.bodies[p]);
        0.5 * dot(own, &body.stiffness.times(own)) - dot(&body.load, own)
    };
    (0..deck.bodies.len()).map(of).sum()
}
