//! The bodies of islands on the ranks that have their K+.

use std::collections::HashMap;
use std::sync::Arc;

use crate::body::{Away, Coarse, Joined, Joining, Owed};
use crate::dual::Form;
use crate::error::Result;
use crate::setup::prepared::Prepared;

/// Bodies that join their islands on other ranks, with their dual operators.
pub(super) struct Joins {
    owed: Owed,
    joining: HashMap<usize, Joining>,
}

impl Prepared {
    /// Tells the other ranks of which islands their bodies are: all by one request to each rank.
    pub(super) fn join(&self, joining: impl Fn(usize) -> Option<Joining>) -> Result<Joins> {
        let (mut questions, mut all) = (Vec::new(), HashMap::new());
        for (p, mut joining) in (0..self.bodies.len()).filter_map(|p| Some((p, joining(p)?))) {
            questions.extend(joining.asking.take().map(|asking| (p, asking)));
            all.insert(p, joining);
        }
        Ok(Joins { owed: self.ask(questions)?, joining: all })
    }
}

impl Joins {
    /// What stands here for the dual operator that another rank makes of a body.
    pub fn form(&self, p: usize) -> Option<Form> {
        Some(Form::Elsewhere(Arc::clone(self.joining.get(&p)?.form.as_ref()?)))
    }

    /// What rank 0 knows of the bodies, and their parts of G.
    pub fn answers(self) -> Result<HashMap<usize, (Away, Coarse)>> {
        let Self { owed, mut joining } = self;
        let mut all = HashMap::new();
        for (p, answer) in owed.answers::<Joined>()? {
            let answer = answer.map_err(|e| e.body(p))?;
            all.extend(joining.remove(&p).map(|joining| (p, Away::of(joining, answer))));
        }
        Ok(all)
    }
}
