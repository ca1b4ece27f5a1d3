//! Dual operators here and on other ranks: products with all of them at once.

use std::sync::Arc;

use crate::body::{Asking, FormElsewhere};
use crate::dual::{Dual, InParallel, Subdomain};
use crate::error::Result;
use crate::linalg::{Operator, Packed};
use crate::platform::stopwatch;

/// `B K_p+ B'`, here or on another rank.
#[derive(Clone)]
pub enum Form {
    Own(Arc<Packed>),
    Elsewhere(Arc<FormElsewhere>),
}

impl Form {
    pub fn order(&self) -> usize {
        match self {
            Self::Own(form) => form.order(),
            Self::Elsewhere(form) => form.order(),
        }
    }

    /// It is assembled.
    pub fn is_explicit(&self) -> bool {
        match self {
            Self::Own(_) => true,
            Self::Elsewhere(form) => form.explicit,
        }
    }

    /// Bytes kept here.
    pub fn bytes_kept(&self) -> usize {
        match self {
            Self::Own(form) => form.bytes_kept(),
            Self::Elsewhere(_) => 0,
        }
    }
}

/// What is computed for every body.
pub(super) struct Each<'a> {
    /// For a body here.
    pub own: &'a (dyn Fn(usize) -> Result<Vec<f64>> + Sync),
    /// The question about a body elsewhere.
    pub asking: &'a dyn Fn(usize) -> Option<Asking>,
    /// The result for it from the answer.
    pub of_answer: &'a dyn Fn(usize, Vec<f64>) -> Result<Vec<f64>>,
}

impl Dual {
    /// The results of all bodies in order. Those of other ranks are asked for first, by one request to each rank, and received last.
    pub(super) fn each(&self, each: &Each, in_parallel: &InParallel<Vec<f64>>) -> Result<Vec<Vec<f64>>> {
        let is_elsewhere = |s: &Subdomain| s.kplus.elsewhere().is_some();
        let Some(first) = self.subdomains.iter().find_map(|s| s.kplus.elsewhere()) else {
            return stopwatch::aside(|| in_parallel(self.subdomains.len(), each.own));
        };
        let questions = (0..self.subdomains.len()).filter_map(|p| Some((p, (each.asking)(p)?)));
        let owed = first.ask(questions.collect())?;
        let here = |p: usize| match is_elsewhere(&self.subdomains[p]) {
            true => Ok(Vec::new()),
            false => (each.own)(p),
        };
        let mut results = stopwatch::aside(|| in_parallel(self.subdomains.len(), &here))?;
        for (p, answer) in owed.answers()? {
            results[p] = (each.of_answer)(p, answer?)?;
        }
        Ok(results)
    }
}
