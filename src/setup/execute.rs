//! The factorisations, here and on other ranks.

use std::collections::{BTreeSet, HashMap};
use std::sync::{Arc, Mutex};

use crate::body::{grounded, Elsewhere, Factorised, GeneralizedInverse, Made, Owed, Plan, Symbolic, Token};
use crate::error::{Error, Kind, Result};
use crate::model::SolvedModel;
use crate::numbers::setup::{ANALYSED, FACTORISED, ROUND, WORK};
use crate::platform::slabs::Slabs;
use crate::platform::stopwatch;
use crate::platform::threads;
use crate::progress::{SetupPart, Watch};
use crate::setup::lending::{ranks_of, Cost};
use crate::setup::operators::Operators;
use crate::setup::plans::of_coordinates;
use crate::setup::prepared::{Inverse, Prepared};
use crate::setup::rounds::{rounds, Round};

/// Bodies that represent others, their plans, and the bodies whose factors they use.
pub(super) struct Planned<'a> {
    pub pending: &'a [usize],
    pub plans: Vec<Plan>,
    pub factors: Vec<Option<usize>>,
    /// Of all bodies: the factor may be rounded.
    pub rounded: &'a [bool],
    /// Of all bodies: operations of the factorisation.
    pub work: &'a dyn Fn(usize) -> f64,
}

/// K+ by body and rank.
pub(super) type OnRanks = HashMap<(usize, usize), Arc<Inverse>>;

fn without_ranks() -> Error {
    Error::new(Kind::Internal, "a body was lent without a plan or a rank")
}

/// A K+ that has been made.
struct OfBody {
    body: usize,
    rank: usize,
    of: Factorised,
    /// Bytes of its plan.
    planned: usize,
}

/// K+ that other ranks are making: body, name, bytes and analysis of the plan.
struct Lent {
    owed: Owed,
    bodies: Vec<(usize, Arc<Token>, usize, Option<Arc<Symbolic>>)>,
}

impl Lent {
    fn answers(self) -> Result<Vec<(usize, Result<OfBody>)>> {
        let Self { owed, bodies } = self;
        let answers = owed.answers::<Made>()?.into_iter();
        let made = |(k, answer): (usize, Result<Made>)| {
            let (body, token, planned, symbolic) = &bodies[k];
            let of = answer.and_then(|answer| {
                let symbolic = symbolic.as_ref().ok_or_else(without_ranks)?;
                let of = answer.at(Arc::clone(token), token.number, symbolic);
                Ok(OfBody { body: *body, rank: token.rank, of, planned: *planned })
            });
            (*body, of)
        };
        Ok(answers.map(made).collect())
    }
}

/// Factorises bodies here, into `all`. `until`: the fraction of the setup at the end.
fn make_here(
    model: &SolvedModel,
    plans: Vec<(usize, Arc<Plan>)>,
    rounded: &[bool],
    (watch, until): (&mut Watch, f64),
    all: &mut Vec<OfBody>,
) -> Result<()> {
    let own: Vec<(usize, usize)> = plans.iter().map(|(p, plan)| (*p, plan.bytes())).collect();
    let plans: Vec<_> = plans.into_iter().map(|(_, plan)| Mutex::new(Some(plan))).collect();
    // operations grow like the power 3/2 of the entries
    let weights = own.iter().map(|(_, bytes)| (*bytes as f64).powf(WORK)).collect();
    let part = SetupPart::of(model.threads(), weights, until);
    let slabs = Slabs::of(own.iter().filter(|(p, _)| rounded[*p]).map(|(_, bytes)| bytes / 2).sum())?;
    let make = |k: usize| {
        let plan = plans[k].lock().ok().and_then(|mut plan| plan.take()).and_then(Arc::into_inner);
        let plan = plan.ok_or_else(|| Error::new(Kind::Internal, "a body was factorised twice"))?;
        let (p, matrix) = (own[k].0, rounded[own[k].0].then(|| plan.matrix().clone()));
        let mut made = plan.execute().map_err(|e| of_coordinates(&model.bodies[p].body, e).body(p))?;
        if let Some(k) = matrix {
            made.inverse = made.inverse.rounded(&k, &slabs).map_err(|e| e.body(p))?;
        }
        Ok(made)
    };
    let take = |k: usize, of: Factorised| all.push(OfBody { body: own[k].0, rank: 0, of, planned: own[k].1 });
    stopwatch::aside(|| watch.every_body(&part, make, take))
}

/// Of two failures that of the first body.
fn first_of_bodies(a: Result<()>, b: Error) -> Result<()> {
    let body = |error: &Error| error.place.body.unwrap_or(0);
    match a {
        Err(a) if body(&a) <= body(&b) => Err(a),
        _ => Err(b),
    }
}

impl Prepared {
    /// The rank of every body, where its K+ is or will be: 0 without other ranks. Bodies that share a factor stay together; `owner`: the
    /// body whose factor a body uses.
    pub(super) fn lend(
        &mut self,
        model: &SolvedModel,
        (representatives, owner): (&[usize], &dyn Fn(usize) -> usize),
        operators: &Operators,
    ) -> Vec<usize> {
        let Some(lending) = &self.lending else { return vec![0; representatives.len()] };
        let of_kplus = |p: usize| {
            let kplus = &self.bodies[p].inverse.as_ref()?.kplus;
            Some(kplus.elsewhere().map_or(0, Elsewhere::rank))
        };
        let given = |p: usize| {
            of_kplus(p)
                .or_else(|| of_kplus(representatives[p]))
                .or(self.bodies[p].rank.map(|rank| rank as usize))
        };
        let given: Vec<Option<usize>> = (0..representatives.len()).map(given).collect();
        let assembly = operators.weights();
        let cost = |p: usize| {
            let bytes =
                model.bodies[p].body.stiffness.as_ref()?.col.len() * (size_of::<f64>() + size_of::<u32>());
            let work = operators.sizes[p].factorisation() + assembly[p];
            Some(Cost { work, bytes: bytes as f64 })
        };
        let costs: Vec<Option<Cost>> = (0..representatives.len()).map(cost).collect();
        let mut ranks = ranks_of(lending.size(), &given, &costs, lending.all);
        for p in (0..ranks.len()).filter(|p| owner(*p) != representatives[*p]) {
            ranks[p] = ranks[owner(p)];
        }
        let new = (0..ranks.len()).filter(|p| given[*p].is_none());
        lending.count(new.clone().count(), new.filter(|p| ranks[*p] > 0).count());
        self.bodies.iter_mut().zip(&ranks).for_each(|(own, rank)| own.rank = Some(*rank as u32));
        ranks
    }

    /// Makes the K+ of the bodies that represent others, on each rank of those; first those with a factor of their own. What could be
    /// made is kept if another body fails.
    pub(super) fn execute(
        &mut self,
        model: &SolvedModel,
        Planned { pending, plans, factors, rounded, work }: Planned,
        (representatives, ranks): (&[usize], &[usize]),
        watch: &mut Watch,
    ) -> Result<OnRanks> {
        let mut ranks_of: HashMap<usize, BTreeSet<usize>> = HashMap::new();
        for (p, rank) in ranks.iter().enumerate() {
            ranks_of.entry(representatives[p]).or_default().insert(*rank);
        }
        let (mut all, mut others) = (Round::default(), Vec::new());
        for ((&p, plan), factor) in pending.iter().zip(plans).zip(factors) {
            let plan = Arc::new(plan);
            if let Some(q) = factor {
                others.push((p, plan, q));
                continue;
            }
            let elsewhere = ranks_of[&p].iter().filter(|rank| **rank > 0);
            all.lent.extend(elsewhere.map(|rank| (p, *rank, Arc::clone(&plan))));
            all.own.extend(ranks_of[&p].contains(&0).then_some((p, plan)));
        }
        let (mut made, mut ended) = (Vec::new(), Ok(()));
        let least = if self.lending.as_ref().is_some_and(|lending| lending.all) { 1.0 } else { ROUND };
        let rounds = rounds(all, work, (model.threads(), least));
        let count = rounds.len();
        for (k, Round { lent, own }) in rounds.into_iter().enumerate() {
            let left = (count - k - 1) as f64 / count as f64;
            let until = FACTORISED - left * (FACTORISED - ANALYSED);
            let lent = self.lent(lent, rounded, watch)?;
            if let Err(error) = make_here(model, own, rounded, (watch, until), &mut made) {
                ended = first_of_bodies(ended, error);
            }
            for (p, answer) in lent.answers()? {
                match answer {
                    Ok(of) => made.push(of),
                    Err(error) => {
                        let error = of_coordinates(&model.bodies[p].body, error).body(p);
                        ended = first_of_bodies(ended, error);
                    }
                }
            }
            // a host that wants to end does not wait for the next round
            if let Err(error) = if k + 1 < count { watch.part_done() } else { Ok(()) } {
                ended = first_of_bodies(ended, error);
                break;
            }
        }
        let mut all = self.kept(model, made, &ranks_of)?;
        if ended.is_err() {
            for ((p, rank), inverse) in all {
                if rank == ranks[p] {
                    self.bodies[p].inverse = Some(inverse);
                }
            }
            return ended.map(|()| OnRanks::default());
        }
        for (p, plan, q) in others {
            let there = all.get(&(q, ranks[p])).or(self.bodies[q].inverse.as_ref());
            let Some(of) = there.cloned() else { continue };
            let kplus = match of.kplus.elsewhere() {
                None => Arc::into_inner(plan).ok_or_else(without_ranks)?.with_factor_of(&of.kplus)?,
                Some(elsewhere) => self.with_factor_elsewhere(&plan, elsewhere)?,
            };
            self.bodies[p].symbolic = self.bodies[q].symbolic.clone();
            let (unit, kplus, bytes) = (model.bodies[p].body.unit(), Arc::new(kplus), of.bytes);
            let grounded = kplus.elsewhere().is_none().then(|| self.grounded(model, p)).transpose()?;
            all.insert((p, ranks[p]), Arc::new(Inverse { unit, kplus, grounded, bytes }));
        }
        Ok(all)
    }

    /// What has been made, with its analysis and its work; on several ranks it counts once.
    fn kept(
        &mut self,
        model: &SolvedModel,
        made: Vec<OfBody>,
        ranks_of: &HashMap<usize, BTreeSet<usize>>,
    ) -> Result<OnRanks> {
        let grounded = threads::run(model.threads(), made.len(), |k| {
            (made[k].rank == 0).then(|| self.grounded(model, made[k].body)).transpose()
        })?;
        let mut all = OnRanks::default();
        for (OfBody { body: p, rank, of, planned }, grounded) in made.into_iter().zip(grounded) {
            let mut bytes = planned.saturating_sub(of.inverse.bytes_saved());
            if ranks_of[&p].first() == Some(&rank) {
                self.work.analyses += of.further_analyses;
                self.work.factorisations += of.factorisations;
                self.bodies[p].symbolic = Some(of.symbolic);
            } else {
                bytes = 0;
            }
            let (unit, kplus) = (model.bodies[p].body.unit(), Arc::new(of.inverse));
            all.insert((p, rank), Arc::new(Inverse { unit, kplus, grounded, bytes }));
        }
        Ok(all)
    }

    /// Unknowns of a body that its matrix holds so stiffly that neighbours are negligible; not those that rows carry.
    pub(super) fn grounded(&self, model: &SolvedModel, p: usize) -> Result<Arc<[u32]>> {
        let matrix = model.bodies[p].body.stiffness.as_deref();
        let mut held = matrix.map_or(Ok(Vec::new()), |k| grounded(k.into()))?;
        if let Some(pilots) = &self.bodies[p].pilots {
            held.retain(|j| pilots.carried.binary_search(&(*j as usize)).is_err());
        }
        Ok(held.into())
    }

    /// Asks for the K+ of bodies on other ranks.
    fn lent(&self, plans: Vec<(usize, usize, Arc<Plan>)>, rounded: &[bool], watch: &Watch) -> Result<Lent> {
        let (mut questions, mut bodies) = (Vec::new(), Vec::new());
        for (p, rank, plan) in plans {
            let lending = self.lending.as_ref().ok_or_else(without_ranks)?;
            let (asking, token) = lending.factorising(rank, &plan, None, rounded[p]);
            questions.push((bodies.len(), asking));
            bodies.push((p, token, plan.bytes(), plan.symbolic().cloned()));
        }
        let owed = watch.stops.interrupt.during(|| self.ask(questions))?;
        Ok(Lent { owed, bodies })
    }

    /// As `with_factor_of`, on the rank that has the factor.
    fn with_factor_elsewhere(&self, plan: &Arc<Plan>, of: &Elsewhere) -> Result<GeneralizedInverse> {
        let lending = self.lending.as_ref().ok_or_else(without_ranks)?;
        let (asking, token) = lending.factorising(of.rank(), plan, Some(of), false);
        let symbolic = plan.symbolic().cloned().ok_or_else(without_ranks)?;
        let answer = self.ask(vec![(0, asking)])?.answers::<Made>()?.pop();
        Ok(answer.ok_or_else(without_ranks)?.1?.at(token, of.factor, &symbolic).inverse)
    }
}
