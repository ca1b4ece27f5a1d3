//! The factorisations, here and on other ranks.

use std::collections::{HashMap, HashSet};
use std::sync::{Arc, Mutex};

use crate::body::{
    grounded, Analysis, Factorised, GeneralizedInverse, Made, NewKplus, Owed, Plan, PlanAway, Precision,
};
use crate::error::{Error, Kind, Result};
use crate::model::SolvedModel;
use crate::numbers::setup::{ANALYSED, FACTORISED, ROUND, WORK};
use crate::platform::slabs::Slabs;
use crate::platform::stopwatch;
use crate::platform::threads;
use crate::progress::{SetupPart, Watch};
use crate::setup::analysed::{Analysed, OnRank};
use crate::setup::given::{first_of_bodies, without_ranks};
use crate::setup::plans::{PlanAt, PlanOf};
use crate::setup::prepared::{Inverse, Prepared};
use crate::setup::rounds::{rounds, Round};

/// The plans of bodies that represent others on ranks, with their analyses, and the bodies whose factors they use.
pub(super) struct Planned<'a> {
    pub plans: Vec<PlanOf>,
    pub analysed: Vec<Arc<Analysed>>,
    pub factors: Vec<Option<usize>>,
    /// The same if all bodies were on one rank.
    pub shared: Vec<Option<usize>>,
    /// Of all bodies.
    pub precisions: &'a [Precision],
    /// Of all bodies: operations of the factorisation.
    pub work: &'a dyn Fn(usize) -> f64,
}

/// K+ by body and rank.
pub(super) type OnRanks = HashMap<(usize, usize), Arc<Inverse>>;

/// A plan with its analysis.
type Analysing<P> = (P, Arc<Analysed>);

/// A K+ that has been made.
struct OfBody {
    body: usize,
    rank: usize,
    inverse: GeneralizedInverse,
    analysed: Arc<Analysed>,
    further_analyses: usize,
    factorisations: usize,
    /// Bytes of its plan.
    planned: usize,
}

/// K+ that other ranks are making.
struct Lent {
    owed: Owed,
    bodies: Vec<(usize, NewKplus, Analysing<PlanAway>)>,
}

impl Lent {
    fn answers(self) -> Result<Vec<(usize, Result<OfBody>)>> {
        let Self { owed, bodies } = self;
        let answers = owed.answers::<Made>()?.into_iter();
        let made = |(k, answer): (usize, Result<Made>)| {
            let (body, NewKplus { kplus, further }, (_, planned)) = &bodies[k];
            let of = answer.map(|made: Made| {
                let (rank, mut analysed) = (kplus.rank, Arc::clone(planned));
                if let Some((layout, of)) = &made.further {
                    analysed =
                        Analysed::new(Arc::clone(layout), *of, rank, OnRank::Away(Arc::clone(further)));
                }
                let (further_analyses, factorisations) = (made.further_analyses, made.factorisations);
                let inverse = made.at(Arc::clone(kplus), kplus.number);
                let planned = planned.of.bytes;
                OfBody { body: *body, rank, inverse, analysed, further_analyses, factorisations, planned }
            });
            (*body, of)
        };
        Ok(answers.map(made).collect())
    }
}

/// Factorises bodies here, into `all`. `until`: the fraction of the setup at the end.
fn make_here(
    (model, explained): (&SolvedModel, &(dyn Fn(usize, Error) -> Error + Sync)),
    plans: Vec<(usize, Analysing<Plan>)>,
    precisions: &[Precision],
    (watch, until): (&mut Watch, f64),
    all: &mut Vec<OfBody>,
) -> Result<()> {
    let own: Vec<(usize, Arc<Analysed>)> =
        plans.iter().map(|(p, (_, analysed))| (*p, Arc::clone(analysed))).collect();
    let bytes = |k: usize| own[k].1.of.bytes;
    let plans: Vec<_> = plans.into_iter().map(|(_, (plan, _))| Mutex::new(Some(plan))).collect();
    // operations grow like the power 3/2 of the entries
    let weights = (0..own.len()).map(|k| (bytes(k) as f64).powf(WORK)).collect();
    let part = SetupPart::of(model.threads(), weights, until);
    let in_single =
        (0..own.len()).filter(|k| precisions[own[*k].0] == Precision::Rounded).map(|k| bytes(k) / 2).sum();
    let slabs = Slabs::of(in_single)?;
    let make = |k: usize| {
        let plan = plans[k].lock().ok().and_then(|mut plan| plan.take());
        let mut plan = plan.ok_or_else(|| Error::new(Kind::Internal, "a body was factorised twice"))?;
        let (p, analysed) = &own[k];
        let Some(OnRank::Here(symbolic)) = analysed.on(0) else { return Err(without_ranks()) };
        plan.set_analysis(Arc::clone(&symbolic));
        let made = plan.execute_in(precisions[*p], &slabs).map_err(|e| explained(*p, e).body(*p))?;
        let is_further = !Arc::ptr_eq(&made.symbolic, &symbolic);
        Ok((made, is_further))
    };
    let take = |k: usize, (made, is_further): (Factorised, bool)| {
        let (body, mut analysed) = (own[k].0, Arc::clone(&own[k].1));
        let planned = analysed.of.bytes;
        let Factorised { inverse, symbolic, further_analyses, factorisations } = made;
        if is_further {
            let of = Analysis::from(&*symbolic);
            analysed = Analysed::new(Arc::clone(&symbolic.layout), of, 0, OnRank::Here(symbolic));
        }
        all.push(OfBody { body, rank: 0, inverse, analysed, further_analyses, factorisations, planned });
    };
    stopwatch::aside(|| watch.every_body(&part, make, take))
}

impl Prepared {
    /// Makes the K+ of the bodies that represent others, on each rank of those; first those with a factor of their own. What could be
    /// made is kept if another body fails.
    pub(super) fn execute(
        &mut self,
        model: &SolvedModel,
        Planned { plans, analysed, factors, shared, precisions, work }: Planned,
        watch: &mut Watch,
    ) -> Result<OnRanks> {
        // on several ranks the first counts, and what would be shared on one rank does not
        let mut seen = HashSet::new();
        let is_first = |of: &PlanOf| self.bodies[of.body].inverse.is_none() && seen.insert(of.body);
        let are_first: Vec<bool> = plans.iter().map(is_first).collect();
        let counted: HashSet<(usize, usize)> = (0..plans.len())
            .filter(|k| are_first[*k] && shared[*k].is_none())
            .map(|k| (plans[k].body, plans[k].rank))
            .collect();
        let by: HashMap<(usize, usize), usize> = plans.iter().map(|of| ((of.body, of.rank), of.by)).collect();
        let (mut all, mut others) = (Round::default(), Vec::new());
        for ((PlanOf { body, rank, at, .. }, analysed), factor) in
            plans.into_iter().zip(analysed).zip(factors)
        {
            match (factor, at) {
                (Some(q), at) => others.push((body, rank, (at, analysed), q)),
                (None, PlanAt::Here(plan)) => all.own.push((body, (*plan, analysed))),
                (None, PlanAt::Away(plan)) => all.lent.push((body, rank, (plan, analysed))),
            }
        }
        let (mut made, mut ended) = (Vec::new(), Ok(()));
        let least = if self.lending.as_ref().is_some_and(|lending| lending.all) { 1.0 } else { ROUND };
        let rounds = rounds(all, work, (model.threads(), least));
        let count = rounds.len();
        for (k, Round { lent, own }) in rounds.into_iter().enumerate() {
            let left = (count - k - 1) as f64 / count as f64;
            let until = FACTORISED - left * (FACTORISED - ANALYSED);
            let lent = self.lent(lent, precisions, watch)?;
            let explained = |p: usize, e: Error| model.bodies[by[&(p, 0)]].body.explained(e);
            if let Err(error) = make_here((model, &explained), own, precisions, (watch, until), &mut made) {
                ended = first_of_bodies(ended, error);
            }
            for (p, answer) in lent.answers()? {
                match answer {
                    Ok(of) => made.push(of),
                    Err(error) => ended = first_of_bodies(ended, error.body(p)),
                }
            }
            // a host that wants to end does not wait for the next round
            if let Err(error) = if k + 1 < count { watch.part_done() } else { Ok(()) } {
                ended = first_of_bodies(ended, error);
                break;
            }
        }
        let mut all = self.kept(model, made, &counted, &by)?;
        if ended.is_err() {
            for (of, inverse) in all {
                self.bodies[by[&of]].inverse = Some(inverse);
            }
            return ended.map(|()| OnRanks::default());
        }
        for (p, rank, (plan, analysed), q) in others {
            let there = all.get(&(q, rank)).or(self.bodies[q].inverse.as_ref());
            let Some(of) = there.cloned() else { continue };
            let kplus = match plan {
                PlanAt::Here(plan) => plan.with_factor_of(&of.kplus)?,
                PlanAt::Away(plan) => self.with_factor_elsewhere(&plan, &analysed, &of.kplus)?,
            };
            self.bodies[p].analysed = self.bodies[q].analysed.clone();
            let (unit, kplus, bytes) = (model.bodies[p].body.unit(), Arc::new(kplus), of.bytes);
            let grounded =
                kplus.elsewhere().is_none().then(|| self.grounded(model, by[&(p, rank)])).transpose()?;
            all.insert((p, rank), Arc::new(Inverse { unit, kplus, grounded, bytes }));
        }
        Ok(all)
    }

    /// What has been made, with its analysis and its work; on several ranks it counts once.
    fn kept(
        &mut self,
        model: &SolvedModel,
        made: Vec<OfBody>,
        counted: &HashSet<(usize, usize)>,
        by: &HashMap<(usize, usize), usize>,
    ) -> Result<OnRanks> {
        let grounded = threads::run(model.threads(), made.len(), |k| {
            (made[k].rank == 0).then(|| self.grounded(model, by[&(made[k].body, 0)])).transpose()
        })?;
        let mut all = OnRanks::default();
        for (of, grounded) in made.into_iter().zip(grounded) {
            let (p, mut bytes) = (of.body, of.planned.saturating_sub(of.inverse.bytes_saved()));
            if counted.contains(&(p, of.rank)) {
                self.work.analyses += of.further_analyses;
                self.work.factorisations += of.factorisations;
                self.bodies[p].analysed = Some(of.analysed);
            } else {
                bytes = 0;
            }
            let (unit, kplus) = (model.bodies[p].body.unit(), Arc::new(of.inverse));
            all.insert((p, of.rank), Arc::new(Inverse { unit, kplus, grounded, bytes }));
        }
        Ok(all)
    }

    /// Unknowns of a body that its matrix holds so stiffly that neighbours are negligible; not those that rows carry.
    pub(super) fn grounded(&self, model: &SolvedModel, p: usize) -> Result<Arc<[u32]>> {
        let matrix = model.bodies[p].body.stiffness.as_deref();
        let mut held = matrix.map_or(Ok(Vec::new()), |k| grounded(k.into()))?;
        if let Some(carried) = &self.bodies[p].carried {
            held.retain(|j| carried.dofs.binary_search(&(*j as usize)).is_err());
        }
        Ok(held.into())
    }

    /// Asks for the K+ of bodies on other ranks.
    fn lent(
        &self,
        plans: Vec<(usize, usize, Analysing<PlanAway>)>,
        precisions: &[Precision],
        watch: &Watch,
    ) -> Result<Lent> {
        let (mut questions, mut bodies) = (Vec::new(), Vec::new());
        for (p, rank, (plan, analysed)) in plans {
            let Some(OnRank::Away(symbolic)) = analysed.on(rank) else { return Err(without_ranks()) };
            let (asking, new) = plan.factorising(&symbolic, None, precisions[p]);
            questions.push((bodies.len(), asking));
            bodies.push((p, new, (plan, analysed)));
        }
        let owed = watch.stops.interrupt.during(|| self.ask(questions))?;
        Ok(Lent { owed, bodies })
    }

    /// As `with_factor_of`, on the rank that has the factor.
    fn with_factor_elsewhere(
        &self,
        plan: &PlanAway,
        analysed: &Analysed,
        of: &GeneralizedInverse,
    ) -> Result<GeneralizedInverse> {
        let of = of.elsewhere().ok_or_else(without_ranks)?;
        let Some(OnRank::Away(symbolic)) = analysed.on(of.rank()) else { return Err(without_ranks()) };
        let (asking, new) = plan.factorising(&symbolic, Some(of), Precision::Double);
        let answer = self.ask(vec![(0, asking)])?.answers::<Made>()?.pop();
        Ok(answer.ok_or_else(without_ranks)?.1?.at(new.kplus, of.factor))
    }
}
