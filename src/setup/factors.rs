//! K+ of the bodies. Nothing is computed twice: equal bodies share one K+; bodies with equal matrices whose null spaces
//! are given in different form share one factor; bodies with equal patterns share one symbolic analysis; a body with new
//! values on its old pattern keeps its analysis.

use std::collections::{BTreeSet, HashMap};
use std::hash::Hash;
use std::sync::Arc;
use std::time::Instant;

use crate::body::{input_key, pattern_key, same_body, same_matrix, value_key};
use crate::dual::{DistinctRows, Size};
use crate::error::Result;
use crate::linalg::Symmetric;
use crate::model::SolvedModel;
use crate::platform::threads;
use crate::progress::{Log, LogLevel, Phase, Watch};
use crate::setup::analysed::Analysed;
use crate::setup::execute::{OnRanks, Planned};
use crate::setup::memory_limit::check_memory;
use crate::setup::operators::Operators;
use crate::setup::plans::PlanOf;
use crate::setup::prepared::Prepared;
use crate::setup::rounding::may_be_rounded;

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
            let operators = self.operators(model, rows, &self.entries(model, &[], &HashMap::new()), 0);
            let all: Vec<usize> = (0..self.bodies.len()).collect();
            let ranks = self.lend(model, &all, &operators);
            self.check_memory(model, &operators, 0, operators.bytes_on_others(&ranks))?;
            return Ok(operators);
        }
        self.try_hosts(model, watch)?;
        let begun = Instant::now();
        let representatives = self.representatives(model)?;
        let supposed = self.entries(model, &representatives, &HashMap::new());
        let ranks = self.lend(model, &representatives, &self.operators(model, rows, &supposed, 0));
        let of: BTreeSet<(usize, usize)> =
            representatives.iter().copied().zip(ranks.iter().copied()).collect();
        let of: Vec<_> = of.into_iter().filter(|(p, _)| self.bodies[*p].inverse.is_none()).collect();
        let mut plans = self.plans(model, &of, watch)?;
        let begun = watch.phases.ended(Phase::NullSpaces, begun);
        let analysed = self.analyse(model, &mut plans, watch)?;
        let begun = watch.phases.ended(Phase::Analysis, begun);
        let factors = self.factors_for(model, &plans, &analysed);
        // on several ranks the first counts
        let (mut given, mut entries, mut bytes, mut on_others) = (HashMap::new(), HashMap::new(), 0, 0);
        for ((plan, analysed), factor) in plans.iter().zip(&analysed).zip(&factors) {
            let is_first = entries.insert(plan.body, analysed.of.entries).is_none();
            match factor.filter(|_| is_first) {
                Some(factor) => drop(given.insert(plan.body, factor)),
                None if is_first => {
                    bytes += analysed.of.bytes;
                    on_others += if plan.rank == 0 { 0 } else { analysed.of.bytes };
                }
                None => {}
            }
        }
        let entries = self.entries(model, &representatives, &entries);
        let mut operators = self.operators(model, rows, &entries, bytes);
        let owner = |p: usize| given.get(&representatives[p]).copied().unwrap_or(representatives[p]);
        let rounded = may_be_rounded(model, &operators, owner);
        self.check_memory(model, &operators, bytes, on_others + operators.bytes_on_others(&ranks))?;
        let work = |p: usize| operators.sizes[p].factorisation();
        let planned = Planned { plans, analysed, factors, rounded: &rounded, work: &work };
        let ended = self.execute(model, planned, (&representatives, &ranks), watch);
        watch.phases.ended(Phase::Factorisation, begun);
        self.share(&representatives, &ranks, ended?);
        operators.factor_bytes = self.bytes_of_factors();
        let mut pending: Vec<usize> = of.into_iter().map(|(p, _)| p).collect();
        pending.dedup();
        self.tell_doubts(model, &pending, &watch.log)?;
        Ok(operators)
    }

    /// Entries of the factor of every body: of its K+, as planned for the body that represents it, or supposed.
    fn entries(
        &self,
        model: &SolvedModel,
        representatives: &[usize],
        planned: &HashMap<usize, usize>,
    ) -> Vec<usize> {
        let of = |p: usize| {
            let there = self.bodies[p].inverse.as_ref().map(|inverse| inverse.kplus.entries());
            there.or_else(|| planned.get(&p).copied())
        };
        let supposed = |p: usize| model.bodies[p].body.stiffness.as_ref().map(|k| supposed_entries(k));
        let all = (0..self.bodies.len())
            .map(|p| of(p).or_else(|| of(*representatives.get(p)?)).or_else(|| supposed(p)).unwrap_or(0));
        all.collect()
    }

    /// For every plan the body with the factor, present or planned on its rank, of an equal matrix with equal dofs held; none if the
    /// plan must factorise itself.
    fn factors_for(
        &self,
        model: &SolvedModel,
        plans: &[PlanOf],
        analysed: &[Arc<Analysed>],
    ) -> Vec<Option<usize>> {
        let mut known: HashMap<_, Vec<usize>> = HashMap::new();
        for (q, own) in self.bodies.iter().enumerate() {
            let Some(inverse) = &own.inverse else { continue };
            let key = (inverse.rank(), own.keys, own.analysed.as_ref().map(Arc::as_ptr));
            known.entry(key).or_default().push(q);
        }
        let mut find = |(plan, analysed): (&PlanOf, &Arc<Analysed>)| {
            if !plan.is_known() || self.bodies.len() < 2 {
                return None;
            }
            let p = plan.body;
            let key = (plan.rank, self.bodies[p].keys, Some(Arc::as_ptr(analysed)));
            let alike = known.entry(key).or_default();
            let found = alike.iter().copied().find(|&q| same_stiffness(model, p, q));
            alike.extend(found.is_none().then_some(p));
            found
        };
        plans.iter().zip(analysed).map(&mut find).collect()
    }

    /// The first body of an equal matrix for every body.
    pub(super) fn same_matrices(&self, model: &SolvedModel) -> Vec<usize> {
        classes(self.bodies.len(), |p| self.bodies[p].keys, |p, q| same_stiffness(model, p, q))
    }

    /// For every body the body whose K+ it uses: the first equal body that already has K+, otherwise the first equal
    /// body.
    fn representatives(&mut self, model: &SolvedModel) -> Result<Vec<usize>> {
        self.find_keys(model)?;
        let same = |p: usize, q: usize| {
            self.bodies[p].carried == self.bodies[q].carried
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

    /// Gives every body the K+ of the body that represents it: what has been `made` on its rank, or was there.
    fn share(&mut self, representatives: &[usize], ranks: &[usize], made: OnRanks) {
        for (p, &representative) in representatives.iter().enumerate() {
            if let Some(inverse) = made.get(&(representative, ranks[p])) {
                self.bodies[p].inverse = Some(Arc::clone(inverse));
            } else if p != representative {
                self.bodies[p].inverse = self.bodies[representative].inverse.clone();
            }
            self.bodies[p].analysed = self.bodies[representative].analysed.clone();
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
            if kplus.is_soft() && self.bodies[p].carried.is_none() {
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

/// Entries of a factor before its analysis, of K with so many entries a row: in one dimension twice these, in two and three dimensions
/// what nested dissection needs.
fn supposed_entries(k: &Symmetric) -> usize {
    let (n, entries) = (k.order().max(1) as f64, k.col.len() as f64);
    (entries * n.cbrt().min(entries / n)) as usize
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
