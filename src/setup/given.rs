//! Bodies given to other ranks before anything is made of them, and what is made of bodies wherever they are.

use std::collections::{BTreeMap, HashMap};
use std::sync::{Arc, Mutex};

use crate::body::{same_body, Asking, Away, BodyElsewhere, Entered, Facts, Token, Wire};
use crate::dual::DistinctRows;
use crate::error::{Error, Kind, Result};
use crate::linalg::hash::classes;
use crate::model::SolvedModel;
use crate::platform::stopwatch;
use crate::platform::threads;
use crate::progress::{SetupPart, Watch};
use crate::setup::islands::Island;
use crate::setup::lending::{ranks_of, Cost};
use crate::setup::prepared::{Prepared, There};
use crate::setup::separate::beside_pieces;

/// The bodies of an island that are on other ranks; empty if there are none.
pub type AwayOf = Box<[Option<Away>]>;

/// Those of island k; of no island if there are none at all.
pub fn away_of(all: &[AwayOf], k: usize) -> &[Option<Away>] {
    all.get(k).map_or(&[], |own| own)
}

impl Prepared {
    /// Gives bodies to other ranks if a setup is due.
    pub fn give(&mut self, model: &SolvedModel, watch: &Watch) -> Result<()> {
        self.follow(model);
        if self.lending.is_none() || self.is_up_to_date(model) {
            return Ok(());
        }
        self.find_given(model);
        self.find_keys(model)?;
        let same = |p: usize, q: usize| same_body(&model.bodies[p].body, &model.bodies[q].body);
        let equal = classes(self.bodies.len(), |p| self.bodies[p].keys, same);
        let ranks = self.lend(model, &equal)?;
        self.send(model, (&equal, &ranks), watch)
    }

    /// Bodies that the host has given on other ranks.
    fn find_given(&mut self, model: &SolvedModel) {
        for (own, given) in self.bodies.iter_mut().zip(&model.bodies).filter(|(own, _)| own.there.is_none()) {
            let Some(of) = given.body.elsewhere() else { continue };
            own.rank = Some(of.name.rank as u32);
            own.there = Some(Box::new(There { of: Arc::clone(of), load: Mutex::default() }));
        }
    }

    /// Sends every rank its bodies, equal ones once.
    fn send(
        &mut self,
        model: &SolvedModel,
        (equal, ranks): (&[usize], &[usize]),
        watch: &Watch,
    ) -> Result<()> {
        let Some(lending) = &self.lending else { return Ok(()) };
        let place = |p: usize| (equal[p], ranks[p]);
        let there = |p: usize| Some((place(p), Arc::clone(&self.bodies[p].there.as_ref()?.of)));
        let mut known: HashMap<(usize, usize), Arc<BodyElsewhere>> =
            (0..ranks.len()).filter_map(there).collect();
        let is_new = |p: &usize| ranks[*p] > 0 && self.bodies[*p].there.is_none();
        let new: Vec<usize> = (0..ranks.len()).filter(is_new).collect();
        let sent: BTreeMap<(usize, usize), usize> = new.iter().rev().map(|&p| (place(p), p)).collect();
        let sent: Vec<usize> = sent.into_values().filter(|p| !known.contains_key(&place(*p))).collect();
        let facts = |k: usize| Ok(Facts::of(&model.bodies[sent[k]].body));
        let facts = stopwatch::aside(|| threads::run(model.threads(), sent.len(), facts))?;
        let mut questions = Vec::new();
        for (&p, facts) in sent.iter().zip(facts) {
            let facts = facts.ok_or_else(without_ranks)?;
            let (asking, there) = lending.giving(ranks[p], &model.bodies[p].body, facts);
            questions.push((p, asking));
            known.insert(place(p), Arc::new(there));
        }
        let owed = watch.stops.interrupt.during(|| self.ask(questions))?;
        for (p, answer) in owed.answers::<()>()? {
            answer.map_err(|e| e.body(p))?;
        }
        for p in new {
            let of = known.get(&place(p)).cloned();
            self.bodies[p].there = of.map(|of| Box::new(There { of, load: Mutex::default() }));
        }
        Ok(())
    }

    /// What other ranks have in place of bodies, which need not be here. Parts in islands with pieces are needed here, too.
    pub fn gone(&self, model: &SolvedModel) -> Result<Vec<(usize, Arc<BodyElsewhere>)>> {
        let is_here = |p: usize| model.bodies[p].body.elsewhere().is_none();
        let there =
            self.bodies.iter().enumerate().filter_map(|(p, own)| Some((p, own.there.as_ref()?.of.clone())));
        let mut gone: Vec<_> = there.filter(|(p, _)| is_here(*p)).collect();
        if !gone.is_empty() {
            let stays = beside_pieces(model)?;
            gone.retain(|(p, _)| stays.get(*p) != Some(&true));
        }
        Ok(gone)
    }

    /// The rank that has a body.
    pub(super) fn rank(&self, p: usize) -> usize {
        self.bodies[p].there.as_ref().map_or(0, |there| there.of.name.rank)
    }

    /// The rank of every body: that which it has had, or an equal one. `equal`: the first equal body of each.
    fn lend(&mut self, model: &SolvedModel, equal: &[usize]) -> Result<Vec<usize>> {
        let Some(lending) = &self.lending else { return Ok(vec![0; equal.len()]) };
        let rank = |p: usize| self.bodies[p].rank.map(|rank| rank as usize);
        let all = 0..equal.len();
        let of_class: HashMap<usize, usize> =
            all.clone().rev().filter_map(|p| Some((equal[p], rank(p)?))).collect();
        let serves = |rank: &usize| lending.serve[*rank];
        let given: Vec<Option<usize>> = all
            .clone()
            .map(|p| rank(p).or_else(|| of_class.get(&equal[p]).copied().filter(serves)))
            .collect();
        // no row of the dual is known yet: one for each unknown that a row touches
        let rows: Vec<DistinctRows> =
            touched(model).into_iter().map(|rows| DistinctRows { rows, places: rows }).collect();
        let operators = self.operators(model, &rows, &self.entries(model, &[], &HashMap::new()), 0);
        let assembly = operators.weights();
        let cost = |p: usize| {
            let entries = model.bodies[p].body.stiffness.as_ref()?.col.len();
            let bytes = (entries * (size_of::<f64>() + size_of::<u32>())) as f64;
            Some(Cost { work: operators.sizes[p].factorisation() + assembly[p], bytes })
        };
        let costs: Vec<Option<Cost>> = all.clone().map(cost).collect();
        let ranks = ranks_of(&lending.serve, &given, &costs, lending.all);
        let new = all.filter(|p| given[*p].is_none());
        lending.count(new.clone().count(), new.filter(|p| ranks[*p] > 0).count());
        self.bodies.iter_mut().zip(&ranks).for_each(|(own, rank)| own.rank = Some(*rank as u32));
        Ok(ranks)
    }

    /// Tells other ranks where rows touch their bodies: of every island the bodies that are not here.
    pub(super) fn enter(
        &self,
        model: &SolvedModel,
        islands: &[Island],
        watch: &Watch,
    ) -> Result<Vec<AwayOf>> {
        if self.bodies.iter().all(|own| own.there.is_none()) {
            return Ok(Vec::new());
        }
        let (mut questions, mut names) = (Vec::new(), HashMap::new());
        for island in islands {
            for (k, &p) in island.bodies.iter().enumerate() {
                let Some(there) = &self.bodies[p].there else { continue };
                let unit = model.bodies[p].body.without(island.unit);
                let (asking, name) = there.of.entering(island.touched.on(k), unit);
                questions.push((p, asking));
                names.insert(p, (name, unit));
            }
        }
        let owed = watch.stops.interrupt.during(|| self.ask(questions))?;
        let mut entered = HashMap::new();
        for (p, answer) in owed.answers::<Entered>()? {
            let (name, unit) = names.remove(&p).ok_or_else(without_ranks)?;
            let there = self.bodies[p].there.as_ref().ok_or_else(without_ranks)?;
            let order = model.bodies[p].body.order;
            entered.insert(p, there.of.entered(name, order, unit, answer.map_err(|e| e.body(p))?));
        }
        let of_island = |island: &Island| match island.bodies.iter().any(|p| entered.contains_key(p)) {
            true => island.bodies.iter().map(|p| entered.remove(p)).collect(),
            false => Box::default(),
        };
        Ok(islands.iter().map(of_island).collect())
    }

    /// Makes something of each of these bodies, with the end of this part of the setup: another rank is asked about those with a question,
    /// the others are `here`, on threads. The error of the first body counts.
    pub(super) fn wherever<A: Wire, T: Send>(
        &self,
        (model, bodies): (&SolvedModel, &[usize]),
        asking: impl Fn(usize) -> Option<(Asking, Arc<Token>)>,
        here: impl Fn(usize) -> Result<T> + Sync,
        there: impl Fn(Arc<Token>, A) -> T,
        (watch, until): (&mut Watch, f64),
    ) -> Result<Vec<T>> {
        let (mut questions, mut names, mut own) = (Vec::new(), HashMap::new(), Vec::new());
        for k in 0..bodies.len() {
            match asking(k) {
                Some((asking, name)) => {
                    questions.push((k, asking));
                    names.insert(k, name);
                }
                None => own.push(k),
            }
        }
        let owed = watch.stops.interrupt.during(|| self.ask(questions))?;
        let weights =
            own.iter().map(|k| model.bodies[bodies[*k]].body.entries().unwrap_or(1) as f64).collect();
        let part = SetupPart::of(model.threads(), weights, until);
        let mut made: Vec<Option<T>> = bodies.iter().map(|_| None).collect();
        let work = |i: usize| here(own[i]).map_err(|e| e.body(bodies[own[i]]));
        let take = |i: usize, of| made[own[i]] = Some(of);
        let mut ended = stopwatch::aside(|| watch.every_body(&part, work, take));
        for (k, answer) in owed.answers::<A>()? {
            let name = names.remove(&k).ok_or_else(without_ranks)?;
            match answer {
                Ok(of) => made[k] = Some(there(name, of)),
                Err(error) => ended = first_of_bodies(ended, error.body(bodies[k])),
            }
        }
        ended?;
        made.into_iter().map(|of| of.ok_or_else(without_ranks)).collect()
    }
}

/// Of each body the number of its unknowns that rows touch.
fn touched(model: &SolvedModel) -> Vec<usize> {
    let all = [&model.contact, &model.equalities, &model.friction.rows].into_iter();
    let mut touched: Vec<usize> = all
        .flat_map(|rows| (0..rows.len()).filter(|i| rows.is_finite(*i)).flat_map(|i| rows.matrix.row(i)))
        .map(|(j, _)| j)
        .collect();
    touched.sort_unstable();
    touched.dedup();
    let before = |j: usize| touched.partition_point(|i| *i < j);
    (0..model.bodies.len()).map(|p| before(model.range(p).end) - before(model.range(p).start)).collect()
}

/// Of two failures that of the first body.
pub(super) fn first_of_bodies(a: Result<()>, b: Error) -> Result<()> {
    let body = |error: &Error| error.place.body.unwrap_or(0);
    match a {
        Err(a) if body(&a) <= body(&b) => Err(a),
        _ => Err(b),
    }
}

pub(super) fn without_ranks() -> Error {
    Error::new(Kind::Internal, "a body is on a rank that does not have it")
}
