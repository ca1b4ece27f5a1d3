//! K+ of the bodies. Nothing is computed twice: equal bodies share one K+; bodies with equal matrices whose null spaces
//! are given in different form share one factor; bodies with equal patterns share one symbolic analysis; a body with new
//! values on its old pattern keeps its analysis.

use std::collections::{HashMap, HashSet};
use std::hash::Hash;
use std::sync::Arc;
use std::time::Instant;

use crate::body::{
    input_key, pattern_key, same_body, same_matrix, same_pattern, value_key, Layout, Plan, Symbolic,
};
use crate::dual::{DistinctRows, Size};
use crate::error::Result;
use crate::model::SolvedModel;
use crate::numbers::setup::ANALYSED;
use crate::platform::threads;
use crate::progress::{Log, LogLevel, Phase, SetupPart, Watch};
use crate::setup::execute::{OnRanks, Planned};
use crate::setup::memory_limit::check_memory;
use crate::setup::operators::Operators;
use crate::setup::plans::{plans, weights};
use crate::setup::prepared::Prepared;
use crate::setup::rounding::may_be_rounded;

/// Number of analyses for a pattern that a body tries before it makes a new one.
const TRIED: usize = 8;

impl Prepared {
    /// Makes K+ of the bodies that have none; `rows`: number of distinct rows on each. Returns the dual operators suited
    /// to these numbers and to the memory.
    pub(super) fn factorize(
        &mut self,
        model: &SolvedModel,
        rows: &[DistinctRows],
        watch: &mut Watch,
    ) -> Result<Operators> {
        if self.bodies.iter().all(|own| own.inverse.is_some()) {
            let operators = self.operators(model, rows, &self.entries(&[], &[], &[]), 0);
            let all: Vec<usize> = (0..self.bodies.len()).collect();
            let ranks = self.lend(model, (&all, &|p| p), &operators);
            self.check_memory(model, &operators, 0, operators.bytes_on_others(&ranks))?;
            return Ok(operators);
        }
        self.try_hosts(model, watch)?;
        let begun = Instant::now();
        let representatives = self.representatives(model)?;
        let pending: Vec<usize> = (0..representatives.len())
            .filter(|&p| representatives[p] == p && self.bodies[p].inverse.is_none())
            .collect();
        let mut plans = plans(model, &pending, &self.bodies, watch)?;
        let begun = watch.phases.ended(Phase::NullSpaces, begun);
        self.analyse(model, &pending, &mut plans, watch)?;
        let begun = watch.phases.ended(Phase::Analysis, begun);
        let factors = self.factors_for(model, &pending, &plans);
        let bytes_of = |k: usize| if factors[k].is_none() { plans[k].bytes() } else { 0 };
        let bytes = (0..pending.len()).map(bytes_of).sum();
        let mut operators =
            self.operators(model, rows, &self.entries(&representatives, &pending, &plans), bytes);
        let given: HashMap<usize, usize> =
            pending.iter().zip(&factors).filter_map(|(p, factor)| Some((*p, (*factor)?))).collect();
        let owner = |p: usize| given.get(&representatives[p]).copied().unwrap_or(representatives[p]);
        let rounded = may_be_rounded(model, &operators, owner);
        let ranks = self.lend(model, (&representatives, &owner), &operators);
        let mut here = vec![false; ranks.len()];
        (0..ranks.len()).filter(|p| ranks[*p] == 0).for_each(|p| here[representatives[p]] = true);
        let on_others = (0..pending.len()).filter(|k| !here[pending[*k]]).map(bytes_of).sum::<usize>();
        self.check_memory(model, &operators, bytes, on_others + operators.bytes_on_others(&ranks))?;
        let work = |p: usize| operators.sizes[p].factorisation();
        let planned = Planned { pending: &pending, plans, factors, rounded: &rounded, work: &work };
        let ended = self.execute(model, planned, (&representatives, &ranks), watch);
        watch.phases.ended(Phase::Factorisation, begun);
        self.share(&representatives, &ranks, ended?);
        operators.factor_bytes = self.bytes_of_factors();
        self.tell_doubts(model, &pending, &watch.log)?;
        Ok(operators)
    }

    /// Entries of the factor of every body: of its K+, of its plan, or of the body that represents it.
    fn entries(&self, representatives: &[usize], pending: &[usize], plans: &[Plan]) -> Vec<usize> {
        let planned = plans.iter().map(|plan| plan.symbolic().map_or(0, |of| of.analysis.entries()));
        let planned: HashMap<usize, usize> = pending.iter().copied().zip(planned).collect();
        let of = |p: usize| {
            let there = self.bodies[p].inverse.as_ref().map(|inverse| inverse.kplus.entries());
            there.or_else(|| planned.get(&p).copied())
        };
        (0..self.bodies.len()).map(|p| of(p).or_else(|| of(*representatives.get(p)?)).unwrap_or(0)).collect()
    }

    /// For every plan the body with the factor, present or planned, of an equal matrix with equal dofs held; none if the
    /// plan must factorise itself.
    fn factors_for(&self, model: &SolvedModel, pending: &[usize], plans: &[Plan]) -> Vec<Option<usize>> {
        let mut known: HashMap<_, Vec<usize>> = HashMap::new();
        for (q, own) in self.bodies.iter().enumerate().filter(|(_, own)| own.inverse.is_some()) {
            known.entry((own.keys, own.symbolic.as_ref().map(Arc::as_ptr))).or_default().push(q);
        }
        let mut find = |(&p, plan): (&usize, &Plan)| {
            let shareable = matches!(plan, Plan::Known(_)) && self.bodies.len() > 1;
            let symbolic = plan.symbolic().filter(|_| shareable)?;
            let alike = known.entry((self.bodies[p].keys, Some(Arc::as_ptr(symbolic)))).or_default();
            let found = alike.iter().copied().find(|&q| same_stiffness(model, p, q));
            alike.extend(found.is_none().then_some(p));
            found
        };
        pending.iter().zip(plans).map(&mut find).collect()
    }

    /// For every body the body whose K+ it uses: the first equal body that already has K+, otherwise the first equal
    /// body.
    fn representatives(&mut self, model: &SolvedModel) -> Result<Vec<usize>> {
        self.find_keys(model)?;
        let same = |p: usize, q: usize| {
            self.bodies[p].pilots == self.bodies[q].pilots
                && same_body(&model.bodies[p].body, &model.bodies[q].body)
        };
        let key = |p: usize| (self.bodies[p].keys, input_key(&model.bodies[p].body));
        let first = classes(self.bodies.len(), key, same);
        let has = |p: usize| self.bodies[p].inverse.is_some();
        let mut ready = HashMap::new();
        (0..first.len()).rev().filter(|&p| has(p)).for_each(|p| {
            ready.insert(first[p], p);
        });
        let of = |p: usize| if has(p) { p } else { ready.get(&first[p]).copied().unwrap_or(first[p]) };
        Ok((0..first.len()).map(of).collect())
    }

    /// Computes the keys of the matrices; a single body needs none.
    fn find_keys(&mut self, model: &SolvedModel) -> Result<()> {
        if self.bodies.len() < 2 {
            return Ok(());
        }
        let without: Vec<usize> = (0..self.bodies.len()).filter(|&p| self.bodies[p].keys.is_none()).collect();
        let keys = threads::run(model.threads(), without.len(), |k| {
            let stiffness = model.bodies[without[k]].body.stiffness.as_ref();
            Ok(stiffness.map(|k| [pattern_key(k), value_key(k)]))
        })?;
        without.into_iter().zip(keys).for_each(|(p, keys)| self.bodies[p].keys = keys);
        Ok(())
    }

    /// The analysis of every plan: the previous one of its body, that of another body with an equal pattern, or a new
    /// one.
    fn analyse(
        &mut self,
        model: &SolvedModel,
        pending: &[usize],
        plans: &mut [Plan],
        watch: &mut Watch,
    ) -> Result<()> {
        let mut offers = self.offers();
        let mut chosen = Vec::with_capacity(plans.len());
        for (k, &p) in pending.iter().enumerate() {
            let own = self.bodies[p].symbolic.as_ref();
            let found = choose(&mut plans[k], own, &offers, |q| self.same_pattern(model, p, q))?;
            chosen.push(found.unwrap_or(offers.len()));
            if found.is_none() {
                offers.push(SharedAnalysis { body: p, layout: plans[k].layout(), symbolic: None, plan: k });
            }
        }
        let new: Vec<usize> = (0..offers.len()).filter(|&o| offers[o].symbolic.is_none()).collect();
        let bodies: Vec<usize> = new.iter().map(|&o| offers[o].body).collect();
        let part = SetupPart::of(model.threads(), weights(model, &bodies), ANALYSED);
        let mut made: Vec<Option<Arc<Symbolic>>> = new.iter().map(|_| None).collect();
        let analyse = |i: usize| plans[offers[new[i]].plan].analyse().map_err(|e| e.body(bodies[i]));
        watch.every_body(&part, analyse, |i, symbolic| made[i] = Some(symbolic))?;
        self.work.analyses += made.len();
        new.into_iter().zip(made).for_each(|(o, made)| offers[o].symbolic = made);
        for (plan, o) in plans.iter_mut().zip(chosen) {
            offers[o].symbolic.iter().for_each(|symbolic| plan.set_analysis(Arc::clone(symbolic)));
        }
        Ok(())
    }

    /// The existing analyses, each once.
    fn offers(&self) -> Vec<SharedAnalysis> {
        let mut offers: Vec<SharedAnalysis> = Vec::new();
        let mut seen = HashSet::new();
        for (p, own) in self.bodies.iter().enumerate() {
            if let Some(symbolic) = own.symbolic.as_ref().filter(|of| seen.insert(Arc::as_ptr(of))) {
                let layout = Arc::clone(&symbolic.layout);
                offers.push(SharedAnalysis {
                    body: p,
                    layout,
                    symbolic: Some(Arc::clone(symbolic)),
                    plan: 0,
                });
            }
        }
        offers
    }

    fn same_pattern(&self, model: &SolvedModel, p: usize, q: usize) -> bool {
        let [a, b] = [p, q].map(|p| model.bodies[p].body.stiffness.as_ref());
        let keys = [p, q].map(|p| self.bodies[p].keys.map(|keys| keys[0]));
        p == q || keys[0] == keys[1] && a.zip(b).is_some_and(|(a, b)| same_pattern(a, b))
    }

    /// Gives every body the K+ of the body that represents it: what has been `made` on its rank, or was there.
    fn share(&mut self, representatives: &[usize], ranks: &[usize], made: OnRanks) {
        for (p, &representative) in representatives.iter().enumerate() {
            if let Some(inverse) = made.get(&(representative, ranks[p])) {
                self.bodies[p].inverse = Some(Arc::clone(inverse));
            } else if p != representative {
                self.bodies[p].inverse = self.bodies[representative].inverse.clone();
            }
            self.bodies[p].symbolic = self.bodies[representative].symbolic.clone();
        }
    }

    /// Dual operators for these numbers of distinct rows and factor entries of the bodies. `more`: bytes of factors not made yet.
    fn operators(
        &self,
        model: &SolvedModel,
        rows: &[DistinctRows],
        entries: &[usize],
        more: usize,
    ) -> Operators {
        let size = |p: usize| {
            let there = self.bodies[p].inverse.as_ref();
            let rounded = there.is_some_and(|inverse| inverse.kplus.is_rounded());
            let single = model.is_piece(p) && there.is_none();
            let DistinctRows { rows, places } = rows[p];
            let unknowns = model.bodies[p].body.order;
            Size { rows, places, unknowns, entries: entries[p], single, rounded }
        };
        let sizes: Vec<Size> = (0..rows.len()).map(size).collect();
        Operators::new(&model.settings, sizes, self.bytes_of_factors().saturating_add(more))
    }

    /// An error if factors and operators do not fit into memory. Operators kept from previous rows are dropped if that helps. `more`: bytes
    /// of factors not made yet; `on_others`: bytes that other ranks take.
    fn check_memory(
        &mut self,
        model: &SolvedModel,
        operators: &Operators,
        more: usize,
        on_others: usize,
    ) -> Result<()> {
        let there = self.bytes_of_factors();
        let more = more.saturating_add(operators.bytes);
        let check = |kept: usize| check_memory(&model.settings, there, more.saturating_add(kept), on_others);
        let kept = self.bodies.iter().filter_map(|own| own.operator.as_ref());
        let kept: usize = kept.map(|kept| kept.bytes()).sum();
        if kept > 0 && check(kept).is_err() {
            self.bodies.iter_mut().for_each(|own| own.operator = None);
        }
        check(0).map_err(|error| operators.named(error))
    }

    /// Logs what rounding of the entries leaves uncertain about the null spaces of these bodies.
    fn tell_doubts(&self, model: &SolvedModel, bodies: &[usize], log: &Log) -> Result<()> {
        for &p in bodies {
            let number = model.name(p) as i64 + model.settings.index_base;
            let Some(kplus) = self.bodies[p].inverse.as_ref().map(|of| &of.kplus) else { continue };
            if let Some(misfit) = kplus.misfit.filter(|_| kplus.gap.is_some()) {
                let warning = if misfit.fit < misfit.of { "warning: " } else { "" };
                let text =
                    || format!("{warning}body {number}: {misfit}; the library searched its null space in K");
                log.say(LogLevel::Result, text)?;
            } else if let Some(held) = kplus.misfit.filter(|_| !model.is_piece(p)).and_then(|of| of.held()) {
                log.say(LogLevel::Phase, || format!("body {number}: {held}"))?;
            }
            if kplus.is_soft() && self.bodies[p].pilots.is_none() {
                let soft = kplus.stiffness.iter().filter(|stiffness| **stiffness != 0.0);
                let least = soft.clone().fold(f64::INFINITY, |least: f64, stiffness| least.min(*stiffness));
                let text = || {
                    format!(
                        "body {number}: K has small stiffness along {} motions, at least {least:.1e} of its stiffness",
                        soft.count()
                    )
                };
                log.say(LogLevel::Result, text)?;
            }
            if let Some(doubt) = &kplus.doubt {
                log.say(LogLevel::Result, || format!("warning: body {number}: {doubt}"))?;
            }
        }
        Ok(())
    }
}

fn same_stiffness(model: &SolvedModel, p: usize, q: usize) -> bool {
    let [a, b] = [p, q].map(|p| model.bodies[p].body.stiffness.as_ref());
    a.zip(b).is_some_and(|(a, b)| same_matrix(a, b))
}

/// A symbolic analysis that exists or will be made by the plan of this number.
struct SharedAnalysis {
    /// A body with this pattern.
    body: usize,
    layout: Arc<Layout>,
    symbolic: Option<Arc<Symbolic>>,
    plan: usize,
}

/// The first analysis that fits the plan of a body; the body's own analysis comes before those of others.
fn choose(
    plan: &mut Plan,
    own: Option<&Arc<Symbolic>>,
    offers: &[SharedAnalysis],
    same_pattern: impl Fn(usize) -> bool,
) -> Result<Option<usize>> {
    let is_own =
        |offer: &SharedAnalysis| offer.symbolic.as_ref().zip(own).is_some_and(|(a, b)| Arc::ptr_eq(a, b));
    let own = offers.iter().position(is_own);
    let others = (0..offers.len()).filter(|&o| Some(o) != own && same_pattern(offers[o].body));
    for o in own.into_iter().chain(others.take(TRIED)) {
        if plan.follow(&offers[o].layout)? {
            return Ok(Some(o));
        }
    }
    Ok(None)
}

/// The first equal member for every member.
fn classes<K: Eq + Hash>(
    count: usize,
    key: impl Fn(usize) -> K,
    same: impl Fn(usize, usize) -> bool,
) -> Vec<usize> {
    let mut first_of: HashMap<K, Vec<usize>> = HashMap::new();
    let class = |p: usize| {
        let firsts = first_of.entry(key(p)).or_default();
        firsts.iter().copied().find(|&q| same(p, q)).unwrap_or_else(|| {
            firsts.push(p);
            p
        })
    };
    (0..count).map(class).collect()
}
