//! A symbolic analysis wherever it is.

use std::collections::BTreeMap;
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};

use crate::body::{Analysis, Layout, Symbolic, Token};

/// A symbolic analysis, on each rank that needs it.
pub struct Analysed {
    pub layout: Arc<Layout>,
    pub of: Analysis,
    on: Mutex<BTreeMap<usize, OnRank>>,
}

#[derive(Clone)]
pub enum OnRank {
    Here(Arc<Symbolic>),
    Away(Arc<Token>),
}

impl Analysed {
    /// `rank`: where it has been made first.
    pub fn new(layout: Arc<Layout>, of: Analysis, rank: usize, on: OnRank) -> Arc<Self> {
        Arc::new(Self { layout, of, on: Mutex::new([(rank, on)].into()) })
    }

    pub fn on(&self, rank: usize) -> Option<OnRank> {
        self.all().get(&rank).cloned()
    }

    pub fn keep(&self, rank: usize, on: OnRank) {
        self.all().insert(rank, on);
    }

    fn all(&self) -> MutexGuard<'_, BTreeMap<usize, OnRank>> {
        self.on.lock().unwrap_or_else(PoisonError::into_inner)
    }
}
