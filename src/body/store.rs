//! What a rank that serves keeps for rank 0, under the names that rank 0 has given.

use std::any::Any;
use std::collections::HashMap;
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};

use crate::error::{Error, Kind, Result};

#[derive(Default)]
pub struct Store {
    named: Mutex<HashMap<u64, Arc<dyn Any + Send + Sync>>>,
}

impl Store {
    pub fn keep<T: Any + Send + Sync>(&self, name: u64, value: T) {
        self.share(name, Arc::new(value));
    }

    pub fn share<T: Any + Send + Sync>(&self, name: u64, value: Arc<T>) {
        self.all().insert(name, value);
    }

    pub fn find<T: Any + Send + Sync>(&self, name: u64) -> Result<Arc<T>> {
        let missing = || Error::new(Kind::Internal, "a rank does not have what rank 0 asks for");
        let found = self.all().get(&name).cloned().ok_or_else(missing)?;
        found.downcast().map_err(|_| missing())
    }

    /// What rank 0 no longer has goes.
    pub fn forget(&self, names: &[u64]) {
        // dropped without the lock
        let mut all = self.all();
        let gone: Vec<_> = names.iter().filter_map(|name| all.remove(name)).collect();
        drop(all);
        drop(gone);
    }

    /// Number of what is kept.
    pub fn len(&self) -> usize {
        self.all().len()
    }

    fn all(&self) -> MutexGuard<'_, HashMap<u64, Arc<dyn Any + Send + Sync>>> {
        self.named.lock().unwrap_or_else(PoisonError::into_inner)
    }
}
