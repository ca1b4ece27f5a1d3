//! What is kept of every body, here or where the body is, and what questions read of it.

use std::any::Any;
use std::sync::{Arc, Mutex, MutexGuard, PoisonError, RwLock};

use crate::body::store::Store;
use crate::error::{Error, Kind, Result};
use crate::ranks::Token;

/// One for each body of an island.
#[derive(Clone)]
pub struct Kept<T = Vec<f64>> {
    of: Vec<OfBody<T>>,
}

#[derive(Clone)]
pub(super) enum OfBody<T> {
    Here(T),
    /// Several may name the same until a question changes it.
    Elsewhere(Arc<Token>),
}

/// One of these while a question changes it.
pub(super) struct Cell<'a, T>(Mutex<Option<&'a mut T>>);

/// A vector over the unknowns of the bodies of an island, and its values where rows touch them.
#[derive(Clone)]
pub struct Distributed {
    pub of: Kept,
    /// Body after body.
    pub at_rows: Vec<f64>,
}

impl Distributed {
    /// From the values of every body where rows touch it.
    pub fn new((at_rows, of): (Vec<Vec<f64>>, Kept)) -> Self {
        Self { of, at_rows: at_rows.concat() }
    }
}

impl<T> Kept<T> {
    /// Of bodies that are all here.
    pub fn of(of: Vec<T>) -> Self {
        Self { of: of.into_iter().map(OfBody::Here).collect() }
    }

    pub(super) fn wherever(of: Vec<OfBody<T>>) -> Self {
        Self { of }
    }

    /// Of a body that is here.
    pub(super) fn here(&self, p: usize) -> Result<&T> {
        match &self.of[p] {
            OfBody::Here(own) => Ok(own),
            OfBody::Elsewhere(_) => Err(not_here()),
        }
    }

    pub(super) fn here_mut(&mut self, p: usize) -> Result<&mut T> {
        match &mut self.of[p] {
            OfBody::Here(own) => Ok(own),
            OfBody::Elsewhere(_) => Err(not_here()),
        }
    }

    /// Its name, if the body is elsewhere.
    pub(super) fn token(&self, p: usize) -> Result<&Arc<Token>> {
        match &self.of[p] {
            OfBody::Elsewhere(token) => Ok(token),
            OfBody::Here(_) => Err(not_here()),
        }
    }

    pub(super) fn name_anew(&mut self, p: usize, token: Arc<Token>) {
        self.of[p] = OfBody::Elsewhere(token);
    }

    pub(super) fn cells(&mut self) -> Vec<Cell<'_, T>> {
        self.of.iter_mut().map(Cell::of).collect()
    }

    /// Of bodies that are all here.
    pub(super) fn each(&self) -> Result<Vec<&T>> {
        (0..self.of.len()).map(|p| self.here(p)).collect()
    }
}

impl<'a, T> Cell<'a, T> {
    fn of(of: &'a mut OfBody<T>) -> Self {
        Self(Mutex::new(match of {
            OfBody::Here(own) => Some(own),
            OfBody::Elsewhere(_) => None,
        }))
    }

    pub fn change<R>(&self, change: impl FnOnce(&mut T) -> Result<R>) -> Result<R> {
        let mut own: MutexGuard<'_, Option<&'a mut T>> =
            self.0.lock().unwrap_or_else(PoisonError::into_inner);
        change(own.as_mut().ok_or_else(not_here)?)
    }
}

fn not_here() -> Error {
    Error::new(Kind::Internal, "data of a body are looked for on the wrong rank")
}

/// What a question reads.
pub trait Given {
    /// Of one body, and of all.
    type Of<'a>;
    type All<'a>: Copy + Sync;

    /// Of a body that is here.
    fn of<'a>(all: Self::All<'a>, p: usize) -> Result<Self::Of<'a>>;

    /// The names of what is kept elsewhere of a body.
    fn names(all: Self::All<'_>, p: usize) -> Result<Vec<u64>>;

    /// Reads what is kept under these names.
    fn read<R>(from: &Store, names: &[u64], read: impl FnOnce(Self::Of<'_>) -> Result<R>) -> Result<R>;
}

/// Reads what is kept under a name.
fn with<T: Any + Send + Sync, R>(
    from: &Store,
    name: Option<&u64>,
    read: impl FnOnce(&T) -> Result<R>,
) -> Result<R> {
    let kept = from.find::<RwLock<T>>(*name.ok_or_else(crate::ranks::damaged)?)?;
    let kept = kept.read().unwrap_or_else(PoisonError::into_inner);
    read(&kept)
}

impl Given for () {
    type Of<'a> = ();
    type All<'a> = ();

    fn of<'a>(_: Self::All<'a>, _: usize) -> Result<Self::Of<'a>> {
        Ok(())
    }

    fn names(_: (), _: usize) -> Result<Vec<u64>> {
        Ok(Vec::new())
    }

    fn read<R>(_: &Store, _: &[u64], read: impl FnOnce(()) -> Result<R>) -> Result<R> {
        read(())
    }
}

impl<A: Any + Send + Sync> Given for (A,) {
    type Of<'a> = &'a A;
    type All<'a> = &'a Kept<A>;

    fn of<'a>(all: Self::All<'a>, p: usize) -> Result<Self::Of<'a>> {
        all.here(p)
    }

    fn names(all: Self::All<'_>, p: usize) -> Result<Vec<u64>> {
        Ok(vec![all.token(p)?.number])
    }

    fn read<R>(from: &Store, names: &[u64], read: impl FnOnce(&A) -> Result<R>) -> Result<R> {
        with(from, names.first(), read)
    }
}

impl<A: Any + Send + Sync, B: Any + Send + Sync> Given for (A, B) {
    type Of<'a> = (&'a A, &'a B);
    type All<'a> = (&'a Kept<A>, &'a Kept<B>);

    fn of<'a>(all: Self::All<'a>, p: usize) -> Result<Self::Of<'a>> {
        Ok((all.0.here(p)?, all.1.here(p)?))
    }

    fn names(all: Self::All<'_>, p: usize) -> Result<Vec<u64>> {
        Ok(vec![all.0.token(p)?.number, all.1.token(p)?.number])
    }

    fn read<R>(from: &Store, names: &[u64], read: impl FnOnce(Self::Of<'_>) -> Result<R>) -> Result<R> {
        with(from, names.first(), |a: &A| with(from, names.get(1), |b: &B| read((a, b))))
    }
}

impl<A: Any + Send + Sync, B: Any + Send + Sync, C: Any + Send + Sync> Given for (A, B, C) {
    type Of<'a> = (&'a A, &'a B, &'a C);
    type All<'a> = (&'a Kept<A>, &'a Kept<B>, &'a Kept<C>);

    fn of<'a>(all: Self::All<'a>, p: usize) -> Result<Self::Of<'a>> {
        Ok((all.0.here(p)?, all.1.here(p)?, all.2.here(p)?))
    }

    fn names(all: Self::All<'_>, p: usize) -> Result<Vec<u64>> {
        Ok(vec![all.0.token(p)?.number, all.1.token(p)?.number, all.2.token(p)?.number])
    }

    fn read<R>(from: &Store, names: &[u64], read: impl FnOnce(Self::Of<'_>) -> Result<R>) -> Result<R> {
        with(from, names.first(), |a: &A| {
            with(from, names.get(1), |b: &B| with(from, names.get(2), |c: &C| read((a, b, c))))
        })
    }
}
