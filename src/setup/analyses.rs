//! Symbolic analyses: bodies with equal patterns share one, as far as the dofs that they hold suit.

use std::collections::{BTreeMap, HashSet};
use std::sync::Arc;

use crate::body::{same_pattern_of, Analysis, Layout, PlanAway};
use crate::error::Result;
use crate::model::SolvedModel;
use crate::numbers::setup::ANALYSED;
use crate::progress::Watch;
use crate::setup::analysed::{Analysed, OnRank};
use crate::setup::given::without_ranks;
use crate::setup::plans::{PlanAt, PlanOf};
use crate::setup::prepared::Prepared;

/// Number of analyses for a pattern that a body tries before it makes a new one.
const TRIED: usize = 8;

/// An analysis that exists or will be made.
struct Offer {
    /// A body with this pattern.
    body: usize,
    layout: Arc<Layout>,
    made: Option<Arc<Analysed>>,
}

/// What a plan has tried so far.
#[derive(Default)]
struct Choice {
    /// The analysis of the same body, tried before those of others.
    own: Option<usize>,
    /// Offers seen, and those of other bodies tried.
    seen: usize,
    others: usize,
    chosen: Option<usize>,
}

impl Choice {
    /// The offers to be tried next.
    fn next(&mut self, offers: &[Offer], same_pattern: impl Fn(usize) -> bool) -> Vec<usize> {
        let own = self.own.filter(|_| self.seen == 0);
        let others =
            (self.seen..offers.len()).filter(|&o| Some(o) != self.own && same_pattern(offers[o].body));
        let others: Vec<usize> = others.take(TRIED - self.others).collect();
        (self.seen, self.others) = (offers.len(), self.others + others.len());
        own.into_iter().chain(others).collect()
    }
}

impl Prepared {
    /// The analysis of every plan: the previous one of its body, that of another body with an equal pattern, or a new one.
    pub(super) fn analyse(
        &mut self,
        model: &SolvedModel,
        plans: &mut [PlanOf],
        watch: &mut Watch,
    ) -> Result<Vec<Arc<Analysed>>> {
        let mut offers = self.offers();
        let chosen = self.choose(model, plans, &mut offers, watch)?;
        let known = |k: &usize| offers[chosen[*k]].made.as_ref().and_then(|made| made.on(plans[*k].rank));
        let mut seen = HashSet::new();
        let is_first = |k: &usize| seen.insert((chosen[*k], plans[*k].rank));
        let makers: Vec<usize> = (0..plans.len()).filter(|k| known(k).is_none()).filter(is_first).collect();
        for (k, of, on) in self.made(model, plans, &makers, watch)? {
            let Offer { layout, made, .. } = &mut offers[chosen[k]];
            match made {
                Some(made) => made.keep(plans[k].rank, on),
                None => {
                    *made = Some(Analysed::new(Arc::clone(layout), of, plans[k].rank, on));
                    self.work.analyses += 1;
                }
            }
        }
        chosen.into_iter().map(|o| offers[o].made.clone().ok_or_else(without_ranks)).collect()
    }

    /// Analyses for the layouts of these of the plans.
    fn made(
        &self,
        model: &SolvedModel,
        plans: &[PlanOf],
        of: &[usize],
        watch: &mut Watch,
    ) -> Result<Vec<(usize, Analysis, OnRank)>> {
        let asking = |i: usize| plans[of[i]].away().map(PlanAway::analysing);
        let here = |i: usize| {
            let symbolic = plans[of[i]].here()?.analyse()?;
            Ok((Analysis::from(&*symbolic), OnRank::Here(symbolic)))
        };
        let there = |name, analysis: Analysis| (analysis, OnRank::Away(name));
        let bodies: Vec<usize> = of.iter().map(|k| plans[*k].body).collect();
        let made = self.wherever((model, &bodies), asking, here, there, (watch, ANALYSED))?;
        Ok(of.iter().zip(made).map(|(k, (of, on))| (*k, of, on)).collect())
    }

    /// The existing analyses, each once.
    fn offers(&self) -> Vec<Offer> {
        let mut offers: Vec<Offer> = Vec::new();
        let mut seen = HashSet::new();
        for (body, own) in self.bodies.iter().enumerate() {
            if let Some(made) = own.analysed.as_ref().filter(|of| seen.insert(Arc::as_ptr(of))) {
                offers.push(Offer { body, layout: Arc::clone(&made.layout), made: Some(Arc::clone(made)) });
            }
        }
        offers
    }

    /// The first offer that suits each plan. Plans that none suits make new ones, in their order: of one pattern one at a time, which those
    /// after it try in turn.
    fn choose(
        &self,
        model: &SolvedModel,
        plans: &mut [PlanOf],
        offers: &mut Vec<Offer>,
        watch: &Watch,
    ) -> Result<Vec<usize>> {
        let own = |plan: &PlanOf| {
            let own = self.bodies[plan.body].analysed.as_ref()?;
            offers.iter().position(|offer| offer.made.as_ref().is_some_and(|made| Arc::ptr_eq(made, own)))
        };
        let mut choices: Vec<Choice> =
            plans.iter().map(|plan| Choice { own: own(plan), ..Choice::default() }).collect();
        loop {
            let (mut questions, mut tried) = (Vec::new(), BTreeMap::new());
            for (k, choice) in choices.iter_mut().enumerate().filter(|(_, choice)| choice.chosen.is_none()) {
                let p = plans[k].body;
                let next = choice.next(offers, |q| self.same_pattern(model, p, q));
                match &mut plans[k].at {
                    PlanAt::Here(plan) => {
                        let suits = plan.follow_first(next.iter().map(|o| &*offers[*o].layout))?;
                        choice.chosen = suits.map(|at| next[at]);
                    }
                    PlanAt::Away(plan) if !next.is_empty() => {
                        let layouts = next.iter().map(|o| Arc::clone(&offers[*o].layout)).collect();
                        questions.push((k, plan.following(layouts)));
                        tried.insert(k, next);
                    }
                    PlanAt::Away(_) => {}
                }
            }
            let owed = watch.stops.interrupt.during(|| self.ask(questions))?;
            for (k, answer) in owed.answers::<Option<usize>>()? {
                let suits = answer.map_err(|e| e.body(plans[k].body))?;
                choices[k].chosen = suits.and_then(|at| tried[&k].get(at).copied());
            }
            let (mut waits, first) = (false, offers.len());
            for (k, choice) in choices.iter_mut().enumerate().filter(|(_, choice)| choice.chosen.is_none()) {
                let p = plans[k].body;
                if choice.others < TRIED
                    && offers[first..].iter().any(|o| self.same_pattern(model, p, o.body))
                {
                    waits = true;
                    continue;
                }
                choice.chosen = Some(offers.len());
                offers.push(Offer { body: p, layout: plans[k].layout(), made: None });
            }
            if !waits {
                return Ok(choices.into_iter().filter_map(|choice| choice.chosen).collect());
            }
        }
    }

    fn same_pattern(&self, model: &SolvedModel, p: usize, q: usize) -> bool {
        let keys = [p, q].map(|p| self.bodies[p].keys.map(|keys| keys[0]));
        p == q || keys[0] == keys[1] && same_pattern_of(&model.bodies[p].body, &model.bodies[q].body)
    }
}
