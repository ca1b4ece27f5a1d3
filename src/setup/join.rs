//! The bodies of islands on the ranks that have their K+.

use std::collections::HashMap;
use std::sync::Arc;

use crate::body::{Coarse, FormElsewhere, Joining, Owed};
use crate::dual::Form;
use crate::error::Result;
use crate::setup::prepared::Prepared;

/// Bodies that join the dual problems of their islands on other ranks, with their dual operators.
pub(super) struct Joins {
    owed: Owed,
    forms: HashMap<usize, Arc<FormElsewhere>>,
}

impl Prepared {
    /// Tells the other ranks of which dual problems their bodies are: all by one request to each rank.
    pub(super) fn join(&self, joining: impl Fn(usize) -> Option<Joining>) -> Result<Joins> {
        let (mut questions, mut forms) = (Vec::new(), HashMap::new());
        for (p, Joining { asking, form }) in (0..self.bodies.len()).filter_map(|p| Some((p, joining(p)?))) {
            questions.push((p, asking));
            forms.extend(form.map(|form| (p, form)));
        }
        Ok(Joins { owed: self.ask(questions)?, forms })
    }
}

impl Joins {
    /// What stands here for the dual operator that another rank makes of a body.
    pub fn form(&self, p: usize) -> Option<Form> {
        Some(Form::Elsewhere(Arc::clone(self.forms.get(&p)?)))
    }

    /// The parts of G of the bodies.
    pub fn answers(self) -> Result<HashMap<usize, Coarse>> {
        let answers = self.owed.answers::<Coarse>()?.into_iter();
        answers.map(|(p, answer)| Ok((p, answer.map_err(|e| e.body(p))?))).collect()
    }
}
