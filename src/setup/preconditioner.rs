//! Preconditioners of the dual problems, according to the options.

use std::time::Instant;

use crate::body::{boundary, diagonal, dirichlet_bytes, Inside, Stiffness};
use crate::dual::{constrained, Boundary, BoundaryStiffness, Preconditioner};
use crate::error::{Error, Kind, Result};
use crate::model::{Preconditioning, SolvedModel};
use crate::platform::memory::reserved;
use crate::platform::{tally, threads};
use crate::progress::{Phase, Stops, Watch};
use crate::setup::islands::Island;
use crate::setup::prepared::Prepared;
use crate::setup::ready::Ready;

/// `automatic` chooses the lumped preconditioner if a product with F costs at least this number of operations per row. On
/// glued subdomains it saves a hundred products, and its setup takes the time of 3e4 operations per row; on two bodies in
/// contact it saves few.
const LUMPED_PAYS: usize = 300;
/// This limit if most rows are glue: a step costs about 2000 operations per row in addition to the product, for the
/// coarse problem and vectors, and half of the steps are saved.
const LUMPED_PAYS_ON_GLUE: usize = 50;

impl Prepared {
    /// The preconditioners for the options, kept until the options change.
    pub fn set_up_preconditioner(&mut self, model: &SolvedModel, watch: &mut Watch) -> Result<()> {
        let Some(duals) = &self.duals else { return Ok(()) };
        let asked: Vec<Preconditioning> = duals.islands.iter().map(|ready| wanted(model, ready)).collect();
        if duals.islands.iter().map(Ready::preconditioning).eq(asked.iter().copied()) {
            return Ok(());
        }
        let begun = Instant::now();
        if asked.contains(&Preconditioning::Dirichlet) {
            let boundaries = |ready: &Ready| {
                let island = &ready.island;
                let dofs = constrained(&ready.rows.matrix, &island.touched, island.bodies.len());
                dofs.iter().map(|dofs| dirichlet_bytes(dofs.len())).sum::<usize>()
            };
            duals.operators.check_more(&model.settings, duals.islands.iter().map(boundaries).sum())?;
        }
        let mut made = reserved(asked.len(), "groups of bodies")?;
        for (ready, &asked) in duals.islands.iter().zip(&asked) {
            let inside = match asked {
                Preconditioning::Automatic | Preconditioning::None => None,
                Preconditioning::Lumped => Some(Inside::Held),
                Preconditioning::Dirichlet => Some(Inside::Free),
            };
            let of = |inside| Ok(Box::new((asked, self.preconditioner(model, ready, inside, &watch.stops)?)));
            made.push(inside.map(of).transpose()?);
        }
        let islands = self.duals.iter_mut().flat_map(|duals| &mut duals.islands);
        islands.zip(made).for_each(|(ready, made)| ready.preconditioner = made);
        watch.phases.ended(Phase::Preconditioner, begun);
        watch.setup_done()
    }

    fn preconditioner(
        &self,
        model: &SolvedModel,
        ready: &Ready,
        inside: Inside,
        stops: &Stops,
    ) -> Result<Preconditioner> {
        let Island { bodies, touched, unit, .. } = &*ready.island;
        let constrained = constrained(&ready.rows.matrix, touched, bodies.len());
        let local = |k: usize| -> Vec<usize> { constrained[k].iter().map(|&j| touched.dof(j)).collect() };
        let (mut questions, mut elsewhere) = (Vec::new(), Vec::new());
        for (k, &p) in bodies.iter().enumerate() {
            let there = self.inverse(model, p).and_then(|inverse| inverse.kplus.elsewhere());
            elsewhere.push(there.map(|there| {
                let (asking, form) = there.boundary(inside, 1.0 / unit, local(k));
                questions.push((p, asking));
                form
            }));
        }
        let owed = stops.interrupt.during(|| self.ask(questions))?;
        let own = threads::run(model.threads(), bodies.len(), |k| {
            if elsewhere[k].is_some() {
                return Ok(None);
            }
            let (p, missing) =
                (bodies[k], || Error::new(Kind::Internal, "a body without stiffness was set up"));
            stops.check()?;
            tally::costly();
            let made = match model.bodies[p].body.k().ok_or_else(missing)? {
                Stiffness::Matrix(k_p) => {
                    stops.interrupt.during(|| boundary(k_p, inside, 1.0 / unit, &local(k)))
                }
                Stiffness::Host(k_p) => diagonal(k_p, 1.0 / unit, &local(k)),
                Stiffness::Assembled(_) => Err(missing()),
            };
            made.map(Some).map_err(|e| e.body(p))
        })?;
        for (p, answer) in owed.answers::<()>()? {
            answer.map_err(|e| e.body(p))?;
        }
        let forms = own.into_iter().zip(elsewhere).filter_map(|(own, elsewhere)| {
            own.map(BoundaryStiffness::Own).or(elsewhere.map(BoundaryStiffness::Elsewhere))
        });
        let boundary = |(dofs, stiffness)| Boundary { dofs, stiffness };
        let boundaries = constrained.into_iter().zip(forms).map(boundary).collect();
        let (rows, compliance) = (&ready.rows.matrix, &ready.dual.compliance);
        Preconditioner::new(rows, compliance[..rows.rows()].to_vec(), &ready.rows.metric, boundaries)
    }
}

fn wanted(model: &SolvedModel, ready: &Ready) -> Preconditioning {
    let of_host = |&p: &usize| model.bodies[p].body.operator().is_some();
    match model.settings.preconditioner {
        Preconditioning::Automatic if ready.island.bodies.iter().all(of_host) => Preconditioning::None,
        Preconditioning::Automatic if lumped_pays(ready) => Preconditioning::Lumped,
        Preconditioning::Automatic => Preconditioning::None,
        asked => asked,
    }
}

fn lumped_pays(ready: &Ready) -> bool {
    let rows = ready.rows.matrix.rows();
    let glued = rows > 2 * ready.rows.contact;
    let least = if glued { LUMPED_PAYS_ON_GLUE } else { LUMPED_PAYS };
    ready.dual.product_work() > least * rows
}
