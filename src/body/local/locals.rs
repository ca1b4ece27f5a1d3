//! All bodies of an island: questions about them, at once and wherever they are.

use std::borrow::Cow;
use std::sync::Arc;

use crate::body::elsewhere::{ask, Asking, Away};
use crate::body::given::Stiffness;
use crate::body::local::brought::{Bring, Put, Section};
use crate::body::local::kept::{Distributed, Given, Kept, OfBody};
use crate::body::local::seen::Seen;
use crate::body::local::{Heading, Local, Question};
use crate::error::Result;
use crate::linalg::Symmetric;
use crate::platform::memory::copied;
use crate::platform::{stopwatch, threads};
use crate::ranks::Token;

/// The bodies of an island.
#[derive(Clone)]
pub struct Locals<'a> {
    bodies: Vec<Seen<'a>>,
    /// Some body is on another rank.
    some_away: bool,
    threads: usize,
}

/// A vector over the unknowns of a body: itself, or its name on the rank where the host has given the body.
pub enum Home {
    Here(Vec<f64>),
    There(Arc<Token>),
}

/// K, n x n, force / length, and `D~ / 2^p`, n.
pub type OfSection<'a> = (Cow<'a, Symmetric>, Cow<'a, [f64]>);

/// Entries of K, below which a question about all bodies costs less than waking other threads.
const PARALLEL_PAYS: usize = 1 << 18;

/// A question about a body elsewhere: `kept`, the name of what is made; `given`, those of what is read.
fn asking<Q: Question>(away: &Away, question: Q, kept: Option<u64>, given: Vec<u64>) -> Asking {
    let Away { name, .. } = away;
    let heading = Heading { body: name.number, kept, from: None, given };
    Asking::new(name.rank, Q::NAME, (heading, question))
}

/// Tests count the answers.
fn answered<Q: Question>(answer: Q::Answer) -> Q::Answer {
    #[cfg(feature = "loopback")]
    crate::body::local::answers::answered(Q::NAME, &answer);
    answer
}

impl<'a> Locals<'a> {
    pub fn new(bodies: Vec<Seen<'a>>, threads: usize) -> Self {
        // few bodies share their own work among the threads
        let pays =
            bodies.len() >= threads && bodies.iter().map(Seen::entries).sum::<usize>() >= PARALLEL_PAYS;
        let some_away = bodies.iter().any(|body| body.away().is_some());
        Self { bodies, some_away, threads: if pays { threads } else { 1 } }
    }

    pub fn len(&self) -> usize {
        self.bodies.len()
    }

    pub fn iter(&self) -> impl ExactSizeIterator<Item = &Seen<'a>> + '_ {
        self.bodies.iter()
    }

    pub fn body(&self, p: usize) -> &Seen<'a> {
        &self.bodies[p]
    }

    /// Asks about every body; the answers in their order, or the first error.
    pub fn ask<Q: Question<Kept = ()>>(
        &self,
        question: impl Fn(usize) -> Q + Sync,
        given: <Q::Given as Given>::All<'_>,
    ) -> Result<Vec<Q::Answer>> {
        let heading = |p: usize, body| {
            let given = Q::Given::names(given, p)?;
            Ok(Heading { body, kept: None, from: None, given })
        };
        let own = |p: usize, q: Q| {
            let answer = q.answer(self.bodies[p].here()?, &mut (), Q::Given::of(given, p)?);
            answer.map(answered::<Q>)
        };
        self.each(question, heading, own)
    }

    /// Asks about every body what makes something that is kept.
    pub fn make<Q: Question>(
        &self,
        question: impl Fn(usize) -> Q + Sync,
        given: <Q::Given as Given>::All<'_>,
    ) -> Result<(Vec<Q::Answer>, Kept<Q::Kept>)> {
        let nothing = |body: &Seen| match body.away() {
            Some(Away { name, .. }) => OfBody::Elsewhere(Arc::new(name.ranks.token(name.rank))),
            None => OfBody::Here(Q::Kept::default()),
        };
        let mut kept = Kept::wherever(self.bodies.iter().map(nothing).collect());
        let answers = self.change(question, &mut kept, given)?;
        Ok((answers, kept))
    }

    /// Asks about every body what changes what is kept.
    pub fn change<Q: Question>(
        &self,
        question: impl Fn(usize) -> Q + Sync,
        kept: &mut Kept<Q::Kept>,
        given: <Q::Given as Given>::All<'_>,
    ) -> Result<Vec<Q::Answer>> {
        let mut names = vec![(None, None); if self.some_away { self.bodies.len() } else { 0 }];
        for (p, (name, from)) in names.iter_mut().enumerate() {
            let Some(Away { name: of, .. }) = self.bodies[p].away() else { continue };
            // what others name, too, stays as it is
            let token = kept.token(p)?;
            if Arc::strong_count(token) > 1 {
                *from = Some(token.number);
                kept.name_anew(p, Arc::new(of.ranks.token(of.rank)));
            }
            *name = Some(kept.token(p)?.number);
        }
        let heading = |p: usize, body| {
            let given = Q::Given::names(given, p)?;
            let (kept, from) = names[p];
            Ok(Heading { body, kept, from, given })
        };
        if self.threads == 1 && !self.some_away {
            let own = |(p, body): (usize, &Seen)| {
                let answer = question(p).answer(body.here()?, kept.here_mut(p)?, Q::Given::of(given, p)?);
                answer.map(answered::<Q>)
            };
            return stopwatch::aside(|| self.bodies.iter().enumerate().map(own).collect());
        }
        let cells = kept.cells();
        let own = |p: usize, q: Q| {
            let given = Q::Given::of(given, p)?;
            cells[p].change(|kept| q.answer(self.bodies[p].here()?, kept, given).map(answered::<Q>))
        };
        self.each(question, heading, own)
    }

    /// What is known here of bodies that are here, and what has these names where the others are.
    pub fn kept<T>(
        &self,
        here: impl Fn(usize) -> T,
        there: impl Fn(usize) -> Result<Arc<Token>>,
    ) -> Result<Kept<T>> {
        let of = |(p, body): (usize, &Seen)| match body.away() {
            Some(_) => Ok(OfBody::Elsewhere(there(p)?)),
            None => Ok(OfBody::Here(here(p))),
        };
        Ok(Kept::wherever(self.bodies.iter().enumerate().map(of).collect::<Result<_>>()?))
    }

    /// The bodies that are elsewhere are asked about first, by one request to each rank, and answered last.
    fn each<Q: Question>(
        &self,
        question: impl Fn(usize) -> Q + Sync,
        heading: impl Fn(usize, u64) -> Result<Heading>,
        own: impl Fn(usize, Q) -> Result<Q::Answer> + Sync,
    ) -> Result<Vec<Q::Answer>> {
        let away = self.some_away.then(|| self.bodies.iter().find_map(Seen::away)).flatten();
        let Some(Away { name: first, .. }) = away else { return self.here(|p| own(p, question(p))) };
        let mut asked = Vec::new();
        for (p, body) in self.bodies.iter().enumerate() {
            let Some(Away { name: token, .. }) = body.away() else { continue };
            let heading = heading(p, token.number)?;
            asked.push((p, Asking::new(token.rank, Q::NAME, (heading, question(p)))));
        }
        let owed = ask(&first.ranks, asked)?;
        let is_here = |p: usize| self.bodies[p].away().is_none();
        let mut all = self.here(|p| Ok(is_here(p).then(|| own(p, question(p)))))?;
        for (p, answer) in owed.answers::<Q::Answer>()? {
            all[p] = Some(answer.map(answered::<Q>));
        }
        all.into_iter().map(|of| of.ok_or_else(crate::ranks::damaged)?).collect()
    }

    fn here<T: Send>(&self, own: impl Fn(usize) -> Result<T> + Sync) -> Result<Vec<T>> {
        let on_caller = |p: usize| self.bodies[p].here().is_ok_and(Local::on_caller);
        stopwatch::aside(|| match self.threads {
            1 => (0..self.bodies.len()).map(own).collect(),
            threads => threads::run_apart(threads, self.bodies.len(), on_caller, own),
        })
    }

    /// The values of vectors of all bodies where rows touch them, body after body.
    pub fn at_rows(&self, v: &[Vec<f64>]) -> Vec<f64> {
        self.bodies.iter().zip(v).flat_map(|(body, v)| body.at_rows(v)).collect()
    }

    /// Keeps these vectors with their bodies.
    pub fn put(&self, v: Vec<Vec<f64>>) -> Result<Kept> {
        if !self.some_away {
            return Ok(Kept::of(v));
        }
        Ok(self.make(|p| Put { v: v[p].clone() }, ())?.1)
    }

    /// The vectors of all bodies.
    pub fn bring<'v>(&self, v: &'v Kept) -> Result<Vec<Cow<'v, [f64]>>> {
        if !self.some_away {
            return Ok(v.each()?.into_iter().map(|own| Cow::Borrowed(&own[..])).collect());
        }
        Ok(self.ask(|_| Bring { at: None }, v)?.into_iter().map(Cow::Owned).collect())
    }

    /// The vectors of the bodies that are here or come from here, brought; of the others, which `stays` names, what they are called there.
    pub fn home(&self, v: &Kept, stays: impl Fn(usize) -> bool) -> Result<Vec<Home>> {
        let (mut asked, mut all) = (Vec::new(), Vec::with_capacity(self.len()));
        for (p, body) in self.bodies.iter().enumerate() {
            all.push(match body.away() {
                None => Home::Here(copied(v.here(p)?, "a displacement")?),
                Some(_) if stays(p) => Home::There(Arc::clone(v.token(p)?)),
                Some(away) => {
                    asked.push((p, asking(away, Bring { at: None }, None, vec![v.token(p)?.number])));
                    Home::Here(Vec::new())
                }
            });
        }
        for (p, brought) in self.answered::<Bring>(asked)? {
            all[p] = Home::Here(brought);
        }
        Ok(all)
    }

    /// Vectors that are here, or have names where their bodies are.
    pub fn placed(&self, v: Vec<Home>) -> Result<Distributed> {
        let (mut sent, mut asked) = (Vec::new(), Vec::new());
        let (mut of, mut at_rows) = (Vec::with_capacity(self.len()), Vec::with_capacity(self.len()));
        for (p, (body, v)) in self.bodies.iter().zip(v).enumerate() {
            let (own, at) = match (body.away(), v) {
                (None, Home::Here(v)) => (body.at_rows(&v), OfBody::Here(v)),
                (Some(away), Home::Here(v)) => {
                    let (at, token) = (body.at_rows(&v), away.name.ranks.token(away.name.rank));
                    sent.push((p, asking(away, Put { v }, Some(token.number), Vec::new())));
                    (at, OfBody::Elsewhere(Arc::new(token)))
                }
                (Some(away), Home::There(token)) => {
                    let at = Some(body.touched().to_vec());
                    asked.push((p, asking(away, Bring { at }, None, vec![token.number])));
                    (Vec::new(), OfBody::Elsewhere(token))
                }
                (None, Home::There(_)) => return Err(crate::ranks::damaged()),
            };
            at_rows.push(own);
            of.push(at);
        }
        self.answered::<Put>(sent)?;
        for (p, brought) in self.answered::<Bring>(asked)? {
            at_rows[p] = brought;
        }
        Ok(Distributed::new((at_rows, Kept::wherever(of))))
    }

    /// Values of a vector of a body elsewhere at these unknowns.
    pub fn values(&self, p: usize, token: &Token, at: Vec<u32>) -> Result<Vec<f64>> {
        let away = self.bodies[p].away().ok_or_else(crate::ranks::damaged)?;
        let asked = asking(away, Bring { at: Some(at) }, None, vec![token.number]);
        let mut brought = self.answered::<Bring>(vec![(p, asked)])?;
        brought.pop().map(|(_, values)| values).ok_or_else(crate::ranks::damaged)
    }

    /// The answers to questions about some bodies elsewhere.
    fn answered<Q: Question>(&self, asked: Vec<(usize, Asking)>) -> Result<Vec<(usize, Q::Answer)>> {
        let away = self.bodies.iter().find_map(Seen::away);
        let Some(Away { name, .. }) = away.filter(|_| !asked.is_empty()) else { return Ok(Vec::new()) };
        let answers = ask(&name.ranks, asked)?.answers::<Q::Answer>()?.into_iter();
        answers.map(|(p, answer)| Ok((p, answered::<Q>(answer?)))).collect()
    }

    /// K and metric of all bodies in one place; none if the entries of some K are not known.
    pub fn sections(&self) -> Result<Option<Vec<OfSection<'a>>>> {
        let own = |body: &Seen<'a>| {
            let local = body.here()?;
            let Stiffness::Matrix(k) = local.stiffness else { return Ok(None) };
            Ok(Some((Cow::Borrowed(k), Cow::Borrowed(local.dual()?.metric))))
        };
        if !self.some_away {
            return self.bodies.iter().map(own).collect();
        }
        let brought = self.ask(|_| Section, ())?.into_iter();
        Ok(brought.map(|of| of.map(|(k, metric)| (Cow::Owned(k), Cow::Owned(metric)))).collect())
    }
}
