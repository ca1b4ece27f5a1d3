//! A question about a body of an island on the rank of the body.

use std::sync::{PoisonError, RwLock};

use crate::body::lent::member::Member;
use crate::body::local::{Given, Heading, Question};
use crate::body::store::Store;
use crate::error::Result;
use crate::ranks::{message, Wire};

/// A question with its data, of any kind.
pub trait Answering: Send {
    /// The answer as a message, an error too.
    fn answered(self: Box<Self>, store: &Store) -> Vec<u8>;
}

struct Asked<Q> {
    heading: Heading,
    question: Q,
}

/// Takes a question of this kind from a message.
pub fn asked<Q: Question>(from: &mut &[u8]) -> Result<Box<dyn Answering>> {
    Ok(Box::new(Asked { heading: Heading::take(from)?, question: Q::take(from)? }))
}

impl<Q: Question> Asked<Q> {
    fn answer(self, store: &Store) -> Result<Q::Answer> {
        let Self { heading: Heading { body, kept, from, given }, question } = self;
        let member = store.find::<Member>(body)?;
        let answer = |kept: &mut Q::Kept| {
            Q::Given::read(store, &given, |given| question.answer(&member.local()?, kept, given))
        };
        let Some(name) = kept else { return answer(&mut Q::Kept::default()) };
        let first = match from {
            Some(from) => Some(read(&*store.find::<RwLock<Q::Kept>>(from)?)),
            None => store.find::<RwLock<Q::Kept>>(name).is_err().then(Q::Kept::default),
        };
        if let Some(mut new) = first {
            let answered = answer(&mut new)?;
            store.keep(name, RwLock::new(new));
            return Ok(answered);
        }
        let kept = store.find::<RwLock<Q::Kept>>(name)?;
        let mut kept = kept.write().unwrap_or_else(PoisonError::into_inner);
        answer(&mut kept)
    }
}

fn read<T: Clone>(of: &RwLock<T>) -> T {
    of.read().unwrap_or_else(PoisonError::into_inner).clone()
}

impl<Q: Question> Answering for Asked<Q> {
    fn answered(self: Box<Self>, store: &Store) -> Vec<u8> {
        message(&self.answer(store))
    }
}
