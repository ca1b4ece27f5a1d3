//! The bodies of an island and what is asked about them. What belongs to one body stays with it: its K, K+, null space, and whatever is
//! kept of a solve over its unknowns. Questions bring it sizes, amplitudes and values where rows touch it, and it answers with such.

mod kept;

pub use kept::{Distributed, Given, Kept};

use std::borrow::Cow;
use std::sync::Arc;

use crate::body::elsewhere::{ask, Asking, Name};
use crate::body::generalized_inverse::GeneralizedInverse;
use crate::body::given::Stiffness;
use crate::error::{Error, Kind, Result};
use crate::linalg::{Csr, Matrix};
use crate::platform::memory::{copied, zeros};
use crate::platform::threads;
use crate::ranks::{wire_struct, wire_unit, Token, Wire};
use kept::OfBody;

/// One body of an island, n unknowns.
#[derive(Clone, Copy)]
pub struct Local<'a> {
    /// K_p, n x n, force / length.
    pub stiffness: Stiffness<'a>,
    /// R_p, n x r, no unit, with `R'DR = unit`.
    pub null_space: &'a Matrix,
    /// K has positive or negative stiffness along motions of R, which are exact: `(K R)'u` is part of their balance.
    pub soft: bool,
    /// Force / length, also the metric of dofs without stiffness.
    pub unit: f64,
    /// Unknowns of the body held so stiffly that neighbours are negligible, ascending: see `grounded`.
    pub grounded: &'a [u32],
    /// The t unknowns that rows touch, ascending.
    pub touched: &'a [u32],
    /// Its part of the dual problem; none if only its answer is judged.
    pub dual: Option<LocalDual<'a>>,
}

/// A body in the dual problem of its island.
#[derive(Clone, Copy)]
pub struct LocalDual<'a> {
    pub kplus: &'a GeneralizedInverse,
    /// The rows of the dual that touch the body, over its unknowns.
    pub rows: &'a Csr,
    /// `D~ / 2^p`, n.
    pub metric: &'a [f64],
    /// 2^p of the island, force / length.
    pub island: f64,
    /// Power of two by which K+ is multiplied.
    pub by: f64,
    /// The number by which R is divided in G and e.
    pub size: f64,
}

/// What is asked about a body; one code answers it wherever the body is.
pub trait Question: Wire + Send + Sync + 'static {
    const NAME: Name;
    type Answer: Wire + Send;
    /// What it makes or changes, and what it reads, of all that is kept of the body.
    type Kept: Clone + Default + Send + Sync + 'static;
    type Given: Given;

    fn answer(
        &self,
        body: &Local,
        kept: &mut Self::Kept,
        given: <Self::Given as Given>::Of<'_>,
    ) -> Result<Self::Answer>;
}

/// A question on its way to the rank of its body, before what is asked.
pub struct Heading {
    /// Names: of the body; of what is made or changed, and of what it is a changed copy of; of what is read.
    pub body: u64,
    pub kept: Option<u64>,
    pub from: Option<u64>,
    pub given: Vec<u64>,
}

wire_struct!(Heading { body, kept, from, given });

/// The bodies of an island.
#[derive(Clone)]
pub struct Locals<'a> {
    bodies: Vec<Local<'a>>,
    /// The names of bodies that are elsewhere; empty if none is.
    elsewhere: &'a [Option<Token>],
    threads: usize,
}

/// Entries of K, below which a question about all bodies costs less than waking other threads.
const PARALLEL_PAYS: usize = 1 << 18;

impl<'a> Locals<'a> {
    pub fn new(bodies: Vec<Local<'a>>, elsewhere: &'a [Option<Token>], threads: usize) -> Self {
        // few bodies share their own work among the threads
        let pays = bodies.len() >= threads
            && bodies.iter().map(|body| body.stiffness.entries()).sum::<usize>() >= PARALLEL_PAYS;
        Self { bodies, elsewhere, threads: if pays { threads } else { 1 } }
    }

    pub fn len(&self) -> usize {
        self.bodies.len()
    }

    pub fn iter(&self) -> impl ExactSizeIterator<Item = &Local<'a>> + '_ {
        self.bodies.iter()
    }

    pub fn body(&self, p: usize) -> &Local<'a> {
        &self.bodies[p]
    }

    /// Asks about every body; the answers in their order, or the first error.
    pub fn ask<Q: Question<Kept = ()>>(
        &self,
        question: impl Fn(usize) -> Q,
        given: <Q::Given as Given>::All<'_>,
    ) -> Result<Vec<Q::Answer>> {
        let heading = |p: usize, body| {
            let given = Q::Given::names(given, p)?;
            Ok(Heading { body, kept: None, from: None, given })
        };
        let own = |p: usize, q: &Q| q.answer(&self.bodies[p], &mut (), Q::Given::of(given, p)?);
        self.each(question, heading, own, |_, answer| answer)
    }

    /// Asks about every body what makes something that is kept.
    pub fn make<Q: Question>(
        &self,
        question: impl Fn(usize) -> Q,
        given: <Q::Given as Given>::All<'_>,
    ) -> Result<(Vec<Q::Answer>, Kept<Q::Kept>)> {
        let named = |token: &Token| Arc::new(token.ranks.token(token.rank));
        let tokens: Vec<Option<Arc<Token>>> =
            self.elsewhere.iter().map(|of| of.as_ref().map(named)).collect();
        let token = |p: usize| tokens.get(p).and_then(Option::as_ref);
        let heading = |p: usize, body| {
            let given = Q::Given::names(given, p)?;
            Ok(Heading { body, kept: token(p).map(|token| token.number), from: None, given })
        };
        let own = |p: usize, q: &Q| {
            let mut kept = Q::Kept::default();
            let answer = q.answer(&self.bodies[p], &mut kept, Q::Given::of(given, p)?)?;
            Ok((answer, Some(kept)))
        };
        let made = self.each(question, heading, own, |_, answer| (answer, None))?;
        let (answers, kept): (_, Vec<_>) = made.into_iter().unzip();
        let kept = kept.into_iter().enumerate().map(|(p, own)| match (own, token(p)) {
            (None, Some(token)) => OfBody::Elsewhere(Arc::clone(token)),
            (own, _) => OfBody::Here(own.unwrap_or_default()),
        });
        Ok((answers, Kept::wherever(kept.collect())))
    }

    /// Asks about every body what changes what is kept.
    pub fn change<Q: Question>(
        &self,
        question: impl Fn(usize) -> Q,
        kept: &mut Kept<Q::Kept>,
        given: <Q::Given as Given>::All<'_>,
    ) -> Result<Vec<Q::Answer>> {
        let mut from = vec![None; self.elsewhere.len()];
        for (p, of) in self.elsewhere.iter().enumerate() {
            let Some(of) = of else { continue };
            // what others name, too, stays as it is
            let token = kept.token(p)?;
            if Arc::strong_count(token) > 1 {
                from[p] = Some(token.number);
                kept.name_anew(p, Arc::new(of.ranks.token(of.rank)));
            }
        }
        let names: Vec<Option<u64>> =
            (0..self.elsewhere.len()).map(|p| kept.token(p).ok().map(|token| token.number)).collect();
        let heading = |p: usize, body| {
            let given = Q::Given::names(given, p)?;
            Ok(Heading { body, kept: names[p], from: from[p], given })
        };
        let cells = kept.cells();
        let own = |p: usize, q: &Q| {
            let given = Q::Given::of(given, p)?;
            cells[p].change(|kept| q.answer(&self.bodies[p], kept, given))
        };
        self.each(question, heading, own, |_, answer| answer)
    }

    /// The bodies that are elsewhere are asked about first, by one request to each rank, and answered last.
    fn each<Q: Question, T: Send>(
        &self,
        question: impl Fn(usize) -> Q,
        heading: impl Fn(usize, u64) -> Result<Heading>,
        own: impl Fn(usize, &Q) -> Result<T> + Sync,
        of_answer: impl Fn(usize, Q::Answer) -> T,
    ) -> Result<Vec<T>> {
        let Some(first) = self.elsewhere.iter().find_map(Option::as_ref) else {
            return self.here(question, own);
        };
        let mut asked = Vec::new();
        for (p, token) in self.elsewhere.iter().enumerate() {
            let Some(token) = token else { continue };
            let heading = heading(p, token.number)?;
            asked.push((p, Asking::new(token.rank, Q::NAME, &heading).and(&question(p))));
        }
        let owed = ask(&first.ranks, asked)?;
        let question = |p: usize| self.is_here(p).then(|| question(p));
        let mut all = self.here(question, |p, q| Ok(q.as_ref().map(|q| own(p, q))))?;
        for (p, answer) in owed.answers::<Q::Answer>()? {
            all[p] = Some(answer.map(|answer| of_answer(p, answer)));
        }
        all.into_iter().map(|of| of.ok_or_else(crate::ranks::damaged)?).collect()
    }

    fn here<Q: Send + Sync, T: Send>(
        &self,
        question: impl Fn(usize) -> Q,
        own: impl Fn(usize, &Q) -> Result<T> + Sync,
    ) -> Result<Vec<T>> {
        if self.threads == 1 {
            return (0..self.bodies.len()).map(|p| own(p, &question(p))).collect();
        }
        let questions: Vec<Q> = (0..self.bodies.len()).map(question).collect();
        let on_caller = |p: usize| self.is_here(p) && self.bodies[p].on_caller();
        threads::run_apart(self.threads, questions.len(), on_caller, |p| own(p, &questions[p]))
    }

    fn is_here(&self, p: usize) -> bool {
        self.elsewhere.get(p).is_none_or(Option::is_none)
    }

    /// The values of vectors of all bodies where rows touch them, body after body.
    pub fn at_rows(&self, v: &[Vec<f64>]) -> Vec<f64> {
        self.bodies.iter().zip(v).flat_map(|(body, v)| body.at_rows(v)).collect()
    }

    /// Keeps these vectors with their bodies.
    pub fn put(&self, v: Vec<Vec<f64>>) -> Result<Kept> {
        if self.elsewhere.is_empty() {
            return Ok(Kept::of(v));
        }
        Ok(self.make(|p| Put { v: v[p].clone() }, ())?.1)
    }

    /// The vectors of all bodies.
    pub fn bring<'v>(&self, v: &'v Kept) -> Result<Vec<Cow<'v, [f64]>>> {
        if self.elsewhere.is_empty() {
            return Ok(v.each()?.into_iter().map(|own| Cow::Borrowed(&own[..])).collect());
        }
        Ok(self.ask(|_| Bring, v)?.into_iter().map(Cow::Owned).collect())
    }
}

/// Keeps a vector.
pub struct Put {
    v: Vec<f64>,
}

wire_struct!(Put { v });

impl Question for Put {
    const NAME: Name = Name::Put;
    type Answer = ();
    type Kept = Vec<f64>;
    type Given = ();

    fn answer(&self, _: &Local, v: &mut Vec<f64>, _: ()) -> Result<()> {
        v.clone_from(&self.v);
        Ok(())
    }
}

/// Asks for a vector.
pub struct Bring;

wire_unit!(Bring);

impl Question for Bring {
    const NAME: Name = Name::Bring;
    type Answer = Vec<f64>;
    type Kept = ();
    type Given = (Vec<f64>,);

    fn answer(&self, _: &Local, _: &mut (), v: &Vec<f64>) -> Result<Vec<f64>> {
        copied(v, "a vector over the unknowns of a body")
    }
}

impl<'a> Local<'a> {
    pub fn order(&self) -> usize {
        self.stiffness.order()
    }

    /// Its part of the dual problem.
    pub fn dual(&self) -> Result<&LocalDual<'a>> {
        self.dual.as_ref().ok_or_else(|| Error::new(Kind::Internal, "a body without a dual problem"))
    }

    /// `K v` and the terms to which its rounding is relative, `|K||v|`.
    pub fn products(&self, v: &[f64], what: &str) -> Result<(Vec<f64>, Vec<f64>)> {
        let (mut image, mut terms) = (zeros(v.len(), what)?, zeros(v.len(), what)?);
        self.stiffness.mul_with_terms(v, &mut image, &mut terms)?;
        Ok((image, terms))
    }

    /// The values where rows touch the body.
    pub fn at_rows<T: Copy>(&self, v: &[T]) -> Vec<T> {
        self.touched.iter().map(|dof| v[*dof as usize]).collect()
    }

    /// Replaces the values where rows touch the body.
    pub fn set_at_rows<T: Copy>(&self, values: &[T], v: &mut [T]) {
        self.touched.iter().zip(values).for_each(|(dof, value)| v[*dof as usize] = *value);
    }

    /// Functions of the host compute its products, on the thread that calls the library.
    fn on_caller(&self) -> bool {
        self.stiffness.on_caller() || self.dual.as_ref().is_some_and(|dual| dual.kplus.on_caller())
    }
}
