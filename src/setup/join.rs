//! The bodies of islands, on the ranks that have their K+.

use std::sync::Arc;

use crate::body::{Join, LocalDual};
use crate::error::Result;
use crate::model::SolvedModel;
use crate::setup::prepared::Prepared;
use crate::setup::ready::Ready;

impl Prepared {
    /// Tells the other ranks of which islands their bodies are: all by one request to each rank.
    pub(super) fn join(&self, model: &SolvedModel, islands: &mut [Ready]) -> Result<()> {
        let Some(lending) = &self.lending else { return Ok(()) };
        let (mut questions, mut named) = (Vec::new(), Vec::new());
        for ready in islands.iter() {
            let island = &ready.island;
            let mut names: Vec<_> = island.bodies.iter().map(|_| None).collect();
            for (k, &p) in island.bodies.iter().enumerate() {
                let Some(inverse) = &self.bodies[p].inverse else { continue };
                let Some(elsewhere) = inverse.kplus.elsewhere() else { continue };
                let metric = ready.metric.on(k);
                let LocalDual { rows, island: unit, by, size, .. } = ready.dual.local(k, island.unit, metric);
                let join = |member, kplus| Join {
                    member,
                    kplus,
                    unit: model.bodies[p].body.without(unit),
                    grounded: Arc::clone(&inverse.grounded),
                    touched: island.touched.on(k).to_vec(),
                    rows: Arc::new(rows.clone()),
                    metric: island.touched.dofs(k).map(|dof| metric[dof]).collect(),
                    island: unit,
                    by,
                    size,
                };
                let (asking, name) = lending.joining(elsewhere, join);
                questions.push((p, asking));
                names[k] = Some(name);
            }
            named.push(names);
        }
        for (p, answer) in self.ask(questions)?.answers::<()>()? {
            answer.map_err(|e| e.body(p))?;
        }
        for (ready, names) in islands.iter_mut().zip(named) {
            if names.iter().any(Option::is_some) {
                ready.apart.get_or_insert_default().elsewhere = names.into();
            }
        }
        Ok(())
    }
}
