//! The preconditioner of the dual layer on faces with friction against the one by dense matrices.

use feti_contact::dual::{Boundary, BoundaryStiffness, Preconditioner, TurnedFace, TurnedRow};
use feti_contact::error::Result;
use feti_contact::qp::friction::{
    friction, Face, FacePreconditioner, FrictionProblem, FrictionStart, Law, OnFace,
};
use feti_contact::qp::Verdict;

use crate::friction::deck::Deck;
use crate::friction::dense::Dense;
use crate::friction::problem::{Content, Given, Random};

struct OfBodies(Preconditioner);

struct OnTurned<'a> {
    /// Free coordinates.
    free: Vec<usize>,
    face: TurnedFace<'a>,
}

impl FacePreconditioner for OfBodies {
    fn on<'a>(&'a self, face: &Face) -> Result<Box<dyn OnFace + 'a>> {
        let (mut free, mut rows) = (Vec::new(), Vec::new());
        for (k, at) in face.coordinates.iter().enumerate() {
            if let Law::Free { damping, .. } = at.law {
                free.push(k);
                rows.push(TurnedRow { rows: at.rows, along: at.along, damping });
            }
        }
        Ok(Box::new(OnTurned { free, face: self.0.turned(&rows)? }))
    }
}

impl OnFace for OnTurned<'_> {
    fn apply(&self, q: &[f64], z: &mut [f64]) -> Result<()> {
        let own: Vec<f64> = self.free.iter().map(|&k| q[k]).collect();
        let mut image = vec![0.0; own.len()];
        self.face.apply(&own, &mut image)?;
        z.fill(0.0);
        self.free.iter().zip(image).for_each(|(&k, v)| z[k] = v);
        Ok(())
    }
}

fn of_bodies(given: &mut Given) -> OfBodies {
    let parts = given.parts.take().unwrap();
    let boundaries = parts
        .boundaries
        .into_iter()
        .map(|(dofs, schur)| Boundary { dofs, stiffness: BoundaryStiffness::Own(Box::new(Dense(schur))) })
        .collect();
    let compliance = vec![0.0; given.d.len()];
    OfBodies(Preconditioner::new(&parts.b, compliance, &parts.metric, boundaries).unwrap())
}

#[test]
fn the_preconditioner_of_bodies_is_that_of_dense_matrices() {
    let mut random = Random::new(9);
    for deck in [Deck::new(2, 8, 3, 0.6, 0.5), Deck::new(3, 3, 3, 0.6, 0.5)] {
        let mut given = deck.given();
        let bodies = of_bodies(&mut given);
        let m = given.d.len();
        for _ in 0..5 {
            let face = Face::at(&given.cones, &random.vector(m), &random.vector(m), 0.2);
            let mut q = random.vector(m);
            q.iter_mut().zip(&face.coordinates).filter(|(_, at)| !at.is_free()).for_each(|(q, _)| *q = 0.0);
            let (mut own, mut dense) = (vec![0.0; m], vec![0.0; m]);
            bodies.on(&face).unwrap().apply(&q, &mut own).unwrap();
            given.preconditioner.as_ref().unwrap().on(&face).unwrap().apply(&q, &mut dense).unwrap();
            let size = dense.iter().fold(0.0, |largest: f64, v| largest.max(v.abs()));
            assert!(own.iter().zip(&dense).all(|(a, b)| (a - b).abs() < 1e-8 * size), "{deck:?}");
        }
        let problem = FrictionProblem { preconditioner: Some(&bodies), ..given.problem() };
        let limits = given.limits(1e-9, 0);
        let found = friction(problem, limits, FrictionStart::default(), &mut Content, &mut Content).unwrap();
        let dense = given.from(FrictionStart::default(), 1e-9, 0);
        assert_eq!(found.verdict, Verdict::Solved);
        assert!(
            found.counts.products.abs_diff(dense.counts.products) <= 2,
            "{} {}",
            found.counts.products,
            dense.counts.products
        );
    }
}
