//! Decks small enough to solve many times, and their answers.

use decks::small::{FacingSprings, SpringAndBlock};
use decks::{Cube, Deck, Membrane, Moduli, Stack};
use feti_contact::solver::{Outcome, Problem, RowKind};

use crate::support::hand_over;

/// Decks whose answer is unique.
pub fn decks() -> Vec<Deck> {
    let stack = Stack { in_plane: vec![4, 3], layers: vec![1], noise: 0.1, ..Stack::default() };
    let tower = Stack { bodies: 3, moduli: vec![1.0, 1e-3, 10.0], ..stack.clone() };
    let plane = Cube { dimension: 2, subdomains: [2, 2, 1], elements: 3, ..Cube::default() };
    let moduli = Moduli::Checkerboard(10.0);
    let space = Cube { elements: 1, moduli, waves: 0.3, pressure: 5.0, ..Cube::default() };
    let layered = Cube { layer: 0.5, ..plane.clone() };
    vec![
        stack.build(),
        tower.build(),
        plane.build(),
        space.build(),
        Membrane { cells: 8, ..Membrane::p1_p3() }.build(),
        SpringAndBlock { spring: 2.0, force: 3.0, gap: 0.25, block: None }.build().deck,
        SpringAndBlock { spring: 3.0, force: 0.7, gap: 0.1, block: Some(7.0) }.build().deck,
        FacingSprings { springs: [2.0, 5.0], forces: [3.0, -1.0], gap: 0.1 }.build().deck,
        layered.build(),
        compliant(tower.build(), 3),
    ]
}

/// The deck with every `each`-th row of both kinds a spring, stiffer and softer than the bodies.
fn compliant(mut deck: Deck, each: usize) -> Deck {
    for rows in [&mut deck.contact, &mut deck.equalities] {
        rows.compliance.iter_mut().step_by(each).zip([0.1, 30.0].iter().cycle()).for_each(|(c, v)| *c = *v);
    }
    deck.name += "_compliant";
    deck
}

/// Displacements, multipliers and what the method did.
#[derive(Clone, Debug, PartialEq)]
pub struct Answer {
    pub u: Vec<f64>,
    pub lambda: Vec<f64>,
    pub mu: Vec<f64>,
    /// Conjugate gradient steps, expansions, releases.
    pub steps: [usize; 3],
    pub products: usize,
    pub coarse_solves: usize,
}

impl Answer {
    pub fn of(deck: &Deck) -> Self {
        Self::from(&mut hand_over::problem(deck).unwrap(), &deck.name)
    }

    /// Solves; the certificate must hold.
    pub fn from(problem: &mut Problem, name: &str) -> Self {
        let report = problem.solve().unwrap_or_else(|error| panic!("{name}: {error}"));
        assert_eq!(report.outcome, Outcome::Solved, "{name}: {report:?}");
        assert!(report.certificate.passed(), "{name}: {:?}", report.certificate);
        let bodies = 0..report.sizes.bodies;
        Self {
            u: bodies.flat_map(|p| problem.displacement(p).unwrap().to_vec()).collect(),
            lambda: problem.multipliers(RowKind::Inequality).unwrap().to_vec(),
            mu: problem.multipliers(RowKind::Equality).unwrap().to_vec(),
            steps: [report.counts.conjugate_gradient, report.counts.expansions, report.counts.releases],
            products: report.counts.products,
            coarse_solves: report.counts.coarse_solves,
        }
    }

    /// The same in other units: u by `length`, lambda and mu by `force`.
    pub fn in_units(&self, length: f64, force: f64) -> Self {
        let by = |values: &[f64], factor: f64| values.iter().map(|v| v * factor).collect();
        Self {
            u: by(&self.u, length),
            lambda: by(&self.lambda, force),
            mu: by(&self.mu, force),
            ..self.clone()
        }
    }

    /// The same numbers to `tolerance` of the largest of their kind.
    pub fn assert_near(&self, expected: &Self, tolerance: f64, what: &str) {
        let kinds = [
            ("u", &self.u, &expected.u),
            ("lambda", &self.lambda, &expected.lambda),
            ("mu", &self.mu, &expected.mu),
        ];
        for (kind, found, expected) in kinds {
            assert_eq!(found.len(), expected.len(), "{what}: {kind}");
            let size = expected.iter().fold(0.0f64, |size, v| size.max(v.abs()));
            let difference = found.iter().zip(expected).fold(0.0f64, |d, (a, b)| d.max((a - b).abs()));
            assert!(difference <= tolerance * size, "{what}: {kind} differs by {difference:e} of {size:e}");
        }
    }

    /// The same bits and the same counts.
    pub fn assert_same(&self, expected: &Self, what: &str) {
        self.assert_near(expected, 0.0, what);
        let counts = |answer: &Self| (answer.steps, answer.products, answer.coarse_solves);
        assert_eq!(counts(self), counts(expected), "{what}: counts");
    }
}
