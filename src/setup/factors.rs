//! K+ of the bodies. Nothing is computed twice: equal bodies share one K+; bodies with equal matrices whose null spaces
//! are given in different form share one factor; bodies with equal patterns share one symbolic analysis; a body with new
//! values on its old pattern keeps its analysis.

use std::collections::{BTreeMap, HashMap, HashSet};
use std::sync::Arc;
use std::time::Instant;

use crate::body::{input_key, pattern_key, same_body, same_matrix_of, value_key, Body, Precision};
use crate::dual::{DistinctRows, Size};
use crate::error::Result;
use crate::linalg::hash::classes;
use crate::model::{Counted, SolvedModel};
use crate::platform::threads;
use crate::progress::{Log, LogLevel, Phase, Watch};
use crate::setup::analysed::Analysed;
use crate::setup::execute::{OnRanks, Planned};
use crate::setup::memory_limit::check_memory;
use crate::setup::operators::Operators;
use crate::setup::plans::{Maker, PlanOf};
use crate::setup::prepared::Prepared;
use crate::setup::rounding::precisions;

impl Prepared {
    /// Makes K+ of the bodies that have none; `rows`: number of distinct rows on each. Returns the dual operators suited
    /// to these numbers and to the memory.
    pub(super) fn factorize(
        &mut self,
        model: &SolvedModel,
        rows: &[DistinctRows],
        watch: &mut Watch,
    ) -> Result<Operators> {
        let ranks: Vec<usize> = (0..self.bodies.len()).map(|p| self.rank(p)).collect();
        if self.bodies.iter().all(|own| own.inverse.is_some()) {
            let operators = self.operators(model, rows, &self.entries(model, &[], &HashMap::new()), 0);
            self.check_memory(model, &operators, 0, operators.bytes_on_others(&ranks))?;
            return Ok(operators);
        }
        self.try_hosts(model, watch)?;
        let begun = Instant::now();
        let representatives = self.representatives(model)?;
        let makers = self.makers(&representatives, &ranks);
        let mut plans = self.plans(model, makers, watch)?;
        let begun = watch.phases.ended(Phase::NullSpaces, begun);
        let analysed = self.analyse(model, &mut plans, watch)?;
        let begun = watch.phases.ended(Phase::Analysis, begun);
        // what is shared if all are on one rank decides what is rounded, and what memory is counted
        let shared = self.factors_for(model, &plans, &analysed, |_| 0);
        let factors = self.factors_for(model, &plans, &analysed, |rank| rank);
        let (mut given, mut entries, mut bytes, mut on_others) = (HashMap::new(), HashMap::new(), 0, 0);
        for ((plan, analysed), shared) in plans.iter().zip(&analysed).zip(&shared) {
            let is_first = entries.insert(plan.body, analysed.of.entries).is_none();
            let is_new = is_first && self.bodies[plan.body].inverse.is_none();
            match shared.filter(|_| is_new) {
                Some(factor) => drop(given.insert(plan.body, factor)),
                None if is_new => {
                    bytes += analysed.of.bytes;
                    on_others += if plan.rank == 0 { 0 } else { analysed.of.bytes };
                }
                None => {}
            }
        }
        let entries = self.entries(model, &representatives, &entries);
        let mut operators = self.operators(model, rows, &entries, bytes);
        let owner = |p: usize| given.get(&representatives[p]).copied().unwrap_or(representatives[p]);
        let mut precisions = precisions(model, &operators, owner);
        for plan in &plans {
            let owner = owner(plan.body);
            let there = self.bodies[owner].inverse.as_ref().map(|inverse| inverse.kplus.is_rounded());
            precisions[plan.body] = match there {
                Some(false) => Precision::Double,
                Some(true) if model.is_piece(plan.body) => Precision::Rounded,
                Some(true) => Precision::Single,
                None => precisions[owner],
            };
        }
        self.check_memory(model, &operators, bytes, on_others + operators.bytes_on_others(&ranks))?;
        let work = |p: usize| operators.sizes[p].factorisation();
        let mut pending: Vec<usize> = plans.iter().map(|plan| plan.body).collect();
        pending.dedup();
        let planned = Planned { plans, analysed, factors, shared, precisions: &precisions, work: &work };
        let ended = self.execute(model, planned, watch);
        watch.phases.ended(Phase::Factorisation, begun);
        self.share(&representatives, &ranks, ended?);
        operators.factor_bytes = self.bytes_of_factors();
        self.tell_doubts(model, &pending, &watch.log)?;
        self.tell_precision(model, &pending, &watch.log)?;
        Ok(operators)
    }

    /// Entries of the factor of every body: of its K+, as planned for the body that represents it, or supposed.
    pub(super) fn entries(
        &self,
        model: &SolvedModel,
        representatives: &[usize],
        planned: &HashMap<usize, usize>,
    ) -> Vec<usize> {
        let of = |p: usize| {
            let there = self.bodies[p].inverse.as_ref().map(|inverse| inverse.kplus.entries());
            there.or_else(|| planned.get(&p).copied())
        };
        let supposed = |p: usize| supposed_entries(&model.bodies[p].body);
        let all = (0..self.bodies.len())
            .map(|p| of(p).or_else(|| of(*representatives.get(p)?)).or_else(|| supposed(p)).unwrap_or(0));
        all.collect()
    }

    /// The K+ that are missing: one for equal bodies on one rank.
    fn makers(&self, representatives: &[usize], ranks: &[usize]) -> Vec<Maker> {
        let of = |p: usize| (representatives[p], ranks[p]);
        let (has, lacks): (Vec<usize>, Vec<usize>) =
            (0..ranks.len()).partition(|p| self.bodies[*p].inverse.is_some());
        let has: HashSet<(usize, usize)> = has.into_iter().map(of).collect();
        let missing = lacks.into_iter().rev().filter(|p| !has.contains(&of(*p)));
        let makers: BTreeMap<(usize, usize), usize> = missing.map(|p| (of(p), p)).collect();
        makers.into_iter().map(|((body, rank), by)| Maker { body, rank, by }).collect()
    }

    /// For every plan the body with the factor, present or planned on its rank, of an equal matrix with equal dofs held; none if the
    /// plan must factorise itself. `on`: the rank that counts for a rank.
    fn factors_for(
        &self,
        model: &SolvedModel,
        plans: &[PlanOf],
        analysed: &[Arc<Analysed>],
        on: impl Fn(usize) -> usize,
    ) -> Vec<Option<usize>> {
        let mut known: HashMap<_, Vec<usize>> = HashMap::new();
        for (q, own) in self.bodies.iter().enumerate() {
            let Some(inverse) = &own.inverse else { continue };
            let key = (on(inverse.rank()), own.keys, own.analysed.as_ref().map(Arc::as_ptr));
            known.entry(key).or_default().push(q);
        }
        let mut find = |(plan, analysed): (&PlanOf, &Arc<Analysed>)| {
            if !plan.is_known() || self.bodies.len() < 2 {
                return None;
            }
            let p = plan.body;
            let key = (on(plan.rank), self.bodies[p].keys, Some(Arc::as_ptr(analysed)));
            let alike = known.entry(key).or_default();
            let found =
                alike.iter().copied().find(|&q| same_matrix_of(&model.bodies[p].body, &model.bodies[q].body));
            alike.extend(found.is_none().then_some(p));
            found
        };
        plans.iter().zip(analysed).map(&mut find).collect()
    }

    /// For every body the body whose K+ it uses: the first equal body that already has K+, otherwise the first equal
    /// body.
    fn representatives(&mut self, model: &SolvedModel) -> Result<Vec<usize>> {
        self.find_keys(model)?;
        let same = |p: usize, q: usize| {
            self.bodies[p].carried == self.bodies[q].carried
                && same_body(&model.bodies[p].body, &model.bodies[q].body)
        };
        // of a body on another rank the key of its input is in its facts
        let key = |p: usize| {
            let body = &model.bodies[p].body;
            (self.bodies[p].keys, self.lending.is_none().then(|| input_key(body)))
        };
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
    pub(super) fn find_keys(&mut self, model: &SolvedModel) -> Result<()> {
        if self.bodies.len() < 2 {
            return Ok(());
        }
        let without: Vec<usize> = (0..self.bodies.len()).filter(|&p| self.bodies[p].keys.is_none()).collect();
        let keys = threads::run(model.threads(), without.len(), |k| {
            let body = &model.bodies[without[k]].body;
            let there = body.elsewhere().map(|of| [of.facts.keys[0], of.facts.keys[1]]);
            Ok(there.or_else(|| body.stiffness.as_ref().map(|k| [pattern_key(k), value_key(k)])))
        })?;
        without.into_iter().zip(keys).for_each(|(p, keys)| self.bodies[p].keys = keys);
        Ok(())
    }

    /// Gives every body the K+ of the body that represents it: what has been `made` on its rank, or was there.
    fn share(&mut self, representatives: &[usize], ranks: &[usize], mut made: OnRanks) {
        let of = |p: usize| (representatives[p], ranks[p]);
        for (p, own) in self.bodies.iter().enumerate() {
            made.extend(own.inverse.as_ref().map(|inverse| (of(p), Arc::clone(inverse))));
        }
        for p in 0..representatives.len() {
            if self.bodies[p].inverse.is_none() {
                self.bodies[p].inverse = made.get(&of(p)).cloned();
            }
            self.bodies[p].analysed = self.bodies[representatives[p]].analysed.clone();
        }
    }

    /// Dual operators for these numbers of distinct rows and factor entries of the bodies. `more`: bytes of factors not made yet.
    pub(super) fn operators(
        &self,
        model: &SolvedModel,
        rows: &[DistinctRows],
        entries: &[usize],
        more: usize,
    ) -> Operators {
        let size = |p: usize| {
            let there = self.bodies[p].inverse.as_ref();
            let rounded = model.is_piece(p) && there.is_some_and(|inverse| inverse.kplus.is_rounded());
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

    /// Logs how many of these bodies have a factor in single precision; pieces are not counted.
    fn tell_precision(&self, model: &SolvedModel, bodies: &[usize], log: &Log) -> Result<()> {
        let is_single = |p: &&usize| {
            let inverse = self.bodies[**p].inverse.as_ref();
            !model.is_piece(**p) && inverse.is_some_and(|inverse| inverse.kplus.is_rounded())
        };
        match bodies.iter().filter(is_single).count() {
            0 => Ok(()),
            count => log.say(LogLevel::Phase, || format!("factors in single precision: {count}")),
        }
    }

    /// Logs what rounding of the entries leaves uncertain about the null spaces of these bodies.
    fn tell_doubts(&self, model: &SolvedModel, bodies: &[usize], log: &Log) -> Result<()> {
        for &p in bodies {
            let number = || model.number_of(Counted::Body, model.name(p));
            let Some(kplus) = self.bodies[p].inverse.as_ref().map(|of| &of.kplus) else { continue };
            if let Some(misfit) = kplus.misfit.filter(|_| kplus.gap.is_some()) {
                let warning = if misfit.fit < misfit.of { "warning: " } else { "" };
                let text = || {
                    format!("{warning}body {}: {misfit}; the library searched its null space in K", number())
                };
                log.say(LogLevel::Result, text)?;
            } else if let Some(held) = kplus.misfit.filter(|_| !model.is_piece(p)).and_then(|of| of.held()) {
                log.say(LogLevel::Phase, || format!("body {}: {held}", number()))?;
            }
            if kplus.is_soft() && self.bodies[p].carried.is_none() {
                let soft = kplus.stiffness.iter().filter(|stiffness| **stiffness != 0.0);
                let least = soft.clone().fold(f64::INFINITY, |least: f64, stiffness| least.min(*stiffness));
                let text = || {
                    format!(
                        "body {}: K has small stiffness along {} motions, at least {least:.1e} of its stiffness",
                        number(),
                        soft.count()
                    )
                };
                log.say(LogLevel::Result, text)?;
            }
            if let Some(doubt) = &kplus.doubt {
                log.say(LogLevel::Result, || format!("warning: body {}: {doubt}", number()))?;
            }
        }
        Ok(())
    }
}

/// Entries of a factor before its analysis, of K with so many entries a row: in one dimension twice these, in two and three dimensions
/// what nested dissection needs.
fn supposed_entries(body: &Body) -> Option<usize> {
    let (n, entries) = (body.order.max(1) as f64, body.entries()? as f64);
    Some((entries * n.cbrt().min(entries / n)) as usize)
}
