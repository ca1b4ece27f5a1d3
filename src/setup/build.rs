//! Everything that does not depend on loads and gaps: null spaces, factors, scaling, dual operators.

use std::ops::Range;
use std::sync::Arc;
use std::time::Instant;

use crate::body::{Away, Carried, InIsland, Local, Seen};
use crate::certificate::{Metric, Trace};
use crate::constraints::RowKind;
use crate::dual::{self, DistinctRows, Draft, Dual, Form};
use crate::error::{Error, Kind, Result};
use crate::linalg::by_body::{ranges, ByBody};
use crate::linalg::hash::{hash, Shared, START};
use crate::model::{Counted, Lengths, Method, Preconditioning, Settings, SolvedModel};
use crate::numbers::setup::{ASSEMBLED, ASSEMBLED_LUMPED};
use crate::platform::memory::reserved;
use crate::platform::stopwatch;
use crate::progress::{Log, LogLevel, Phase, SetupPart, Watch};
use crate::qp::BetweenSolves;
use crate::setup::given::{away_of, AwayOf};
use crate::setup::islands::{Island, Members};
use crate::setup::operators::Operators;
use crate::setup::prepared::{Duals, Prepared};
use crate::setup::ready::{Apart, Ready};
use crate::setup::rows::DualRows;
use crate::setup::separate::islands;
use crate::setup::whole::{OfParts, Whole};

/// An island without its dual.
struct WithRows {
    island: Box<Island>,
    rows: Arc<DualRows>,
    /// `D~ / 2^p`
    metric: Arc<ByBody>,
    /// C', no unit.
    compliance: Vec<f64>,
}

impl WithRows {
    /// What a body must know of the island.
    fn told(&self, k: usize, carried: Option<&Carried>) -> InIsland {
        let Self { island, rows, .. } = self;
        let carried = carried.map_or(&[][..], |carried| &carried.dofs);
        InIsland {
            carried: carried.iter().map(|dof| *dof as u32).collect(),
            metric: rows.metric[island.touched.range(k)].to_vec(),
            island: island.unit,
            balanced: !rows.coupled,
        }
    }
}

impl Prepared {
    /// True if factors and dual operators are up to date and as the options require.
    pub fn is_up_to_date(&self, model: &SolvedModel) -> bool {
        let suits = |ready: &Ready| ready.rows.coupled == coupled(&model.settings);
        self.duals(model)
            .is_some_and(|duals| duals.islands.iter().all(suits) && duals.operators.suit(&model.settings))
    }

    /// Makes null spaces, factors and dual operators that are missing or out of date, for a model that has all of its input
    /// (`check_complete`).
    pub fn set_up(&mut self, model: &SolvedModel, watch: &mut Watch) -> Result<()> {
        let begun = Instant::now();
        self.follow(model);
        if self.is_up_to_date(model) {
            let lengths = self.lengths(model)?;
            lengths.check_empty_rows()?;
            return self.refresh(&lengths);
        }
        let islands = islands(model)?;
        let away = self.enter(model, &islands, watch)?;
        let lengths = self.first_lengths(model, &islands, &away)?;
        lengths.check_empty_rows()?;
        self.release();
        let mut with_rows = reserved(islands.len(), "groups of bodies")?;
        let (mut known, mut metrics) = (Shared::default(), Shared::default());
        let mut distinct = vec![DistinctRows::default(); model.bodies.len()];
        let mut all_carried = vec![None; model.bodies.len()];
        for (k, mut island) in islands.into_iter().enumerate() {
            island.refresh(&lengths);
            check_compliance(&island)?;
            let (Metric { values, carried }, metric) = metric(model, &island, away_of(&away, k))?;
            for (k, &p) in island.bodies.iter().enumerate() {
                let range = island.touched.range(k);
                let [first, end] = [range.start, range.end].map(|end| carried.partition_point(|j| *j < end));
                if first < end {
                    let (own, by) = (&carried[first..end], ratio_of_units(model, &island, p));
                    let (body, unit) = (&model.bodies[p].body, island.unit);
                    all_carried[p] = Some(Box::new(Carried {
                        dofs: own.iter().map(|&j| island.touched.dof(j)).collect(),
                        metric: own.iter().map(|&j| (values[j] * by).min(f64::MAX)).collect(),
                        // bodies without stiffness are equal in all islands
                        scale: if body.largest_diagonal() > 0.0 { by / unit } else { 1.0 },
                        without: body.without(unit) / unit * by,
                    }));
                }
            }
            let (mut own, compliance) = DualRows::of(&island, values, coupled(&model.settings))?;
            own.uneven |= !carried.is_empty();
            own.level_gaps(&mut island, &lengths);
            let orders: Vec<_> = island.ranges.iter().map(Range::len).collect();
            let tangential = own.first_tangential();
            let counts = Dual::distinct_rows(&orders, &island.touched, &own.matrix, tangential);
            island.bodies.iter().zip(counts).for_each(|(&p, count)| distinct[p] = count);
            let rows = known.share(own.key(), own, DualRows::eq);
            let key = hash(START, metric.in_sequence().iter().map(|d| d.to_bits()));
            let metric = metrics.share(key, metric, ByBody::eq);
            with_rows.push(WithRows { island: Box::new(island), rows, metric, compliance });
        }
        self.carry(all_carried);
        watch.phases.ended(Phase::Rows, begun);
        let operators = self.factorize(model, &distinct, watch)?;
        self.tell_pilots(model, &watch.log)?;
        let begun = Instant::now();
        self.duals = Some(self.dualize(model, (with_rows, away), operators, watch)?);
        self.made += 1;
        watch.phases.ended(Phase::DualOperators, begun);
        Ok(())
    }

    /// Logs how many unknowns are carried.
    fn tell_pilots(&self, model: &SolvedModel, log: &Log) -> Result<()> {
        let carries = |p: &usize| self.bodies[*p].carried.is_some();
        let Some(first) = (0..self.bodies.len()).find(carries) else { return Ok(()) };
        let all: usize =
            self.bodies.iter().filter_map(|own| own.carried.as_ref()).map(|own| own.dofs.len()).sum();
        let number = model.number_of(Counted::Body, model.name(first));
        log.say(LogLevel::Result, || {
            format!(
                "rows hold {all} unknowns far better than K does, as pilots: the first is in body {number}"
            )
        })
    }

    /// Updates what depends on gaps and loads.
    pub fn refresh(&mut self, lengths: &Lengths) -> Result<()> {
        let loads = self.duals.as_ref().map(|duals| self.loads_of_hosts(lengths.model(), &duals.islands));
        if let (Some(duals), Some(loads)) = (&mut self.duals, loads) {
            duals.loads = loads?;
        }
        let islands = self.duals.iter_mut().flat_map(|duals| &mut duals.islands);
        for ready in islands {
            ready.island.refresh(lengths);
            ready.rows.level_gaps(&mut ready.island, lengths);
            let Some(whole) = ready.apart.as_mut().and_then(|apart| apart.whole.as_mut()) else { continue };
            whole.island.refresh(lengths);
            let (level, own) = (&ready.island.contact.rows, &mut whole.island.contact.rows);
            own.rhs.clone_from(&level.rhs);
            own.taken.clone_from(&level.taken);
        }
        Ok(())
    }

    /// Forms F and G of every island.
    fn dualize(
        &mut self,
        model: &SolvedModel,
        (islands, away): (Vec<WithRows>, Vec<AwayOf>),
        operators: Operators,
        watch: &mut Watch,
    ) -> Result<Duals> {
        let mut drafts = reserved(islands.len(), "groups of bodies")?;
        let (mut island_of, mut number_in) = (vec![0; model.bodies.len()], vec![0; model.bodies.len()]);
        for (k, WithRows { island, rows, .. }) in islands.iter().enumerate() {
            let mut parts = reserved(island.bodies.len(), "groups of bodies")?;
            for (number, &p) in island.bodies.iter().enumerate() {
                (island_of[p], number_in[p]) = (k, number);
                let by = ratio_of_units(model, island, p);
                let own = &mut self.bodies[p];
                let Some(inverse) = &own.inverse else { continue };
                let (kplus, kept) = (Arc::clone(&inverse.kplus), own.operator.take());
                let (size, implicit) = (operators.sizes[p], operators.implicit[p]);
                let may_wait = operators.may_wait() && !implicit && kplus.host().is_some();
                let ledger = may_wait.then(|| Arc::clone(self.ledgers.entry(p).or_default()));
                parts.push(dual::BodyShare { kplus, by, kept, size, implicit, ledger });
            }
            drafts.push(Draft::new(parts, &island.touched, &rows.matrix));
        }
        let all: Vec<usize> = (0..model.bodies.len()).collect();
        let part = SetupPart {
            threads: model.threads(),
            weights: operators.weights(),
            until: assembled(&model.settings),
            on_caller: model.on_caller(&all),
        };
        let joining = |p: usize| {
            let (k, number) = (island_of[p], number_in[p]);
            self.bodies[p].inverse.as_ref()?.kplus.elsewhere()?;
            let member = &away_of(&away, k).get(number)?.as_ref()?.name;
            drafts[k].joining(number, member, islands[k].told(number, self.bodies[p].carried.as_deref()))
        };
        let joins = watch.stops.interrupt.during(|| self.join(joining))?;
        let mut made: Vec<Option<Form>> = all.iter().map(|&p| joins.form(p)).collect();
        let is_asked: Vec<bool> = made.iter().map(Option::is_some).collect();
        let assemble = |p: usize| match is_asked[p] {
            true => Ok(None),
            false => drafts[island_of[p]].assemble(number_in[p]).map_err(|e| e.body(p)),
        };
        let mut take = |p: usize, operator: Option<Form>| made[p] = operator.or(made[p].take());
        stopwatch::aside(|| watch.every_body(&part, assemble, &mut take))?;
        let mut joined = joins.answers()?;
        let mut ready = reserved(islands.len(), "groups of bodies")?;
        let (mut known, mut away) = (Shared::default(), away.into_iter());
        for (WithRows { island, rows, metric, compliance }, draft) in islands.into_iter().zip(drafts) {
            let columns = draft.columns();
            self.work.columns_computed += columns.computed;
            self.work.columns_kept += columns.kept;
            // Algorithm 3 uses the rigid modes without scaling, as in the paper
            let parts = island.bodies.iter().map(|p| (made[*p].take(), joined.remove(p)));
            let dual = draft.finish(parts, compliance, !rows.coupled);
            let dual = known.share(dual.key(), dual, Dual::same);
            let missing = || Error::new(Kind::State, "a body has not been set up");
            let inverse = |part: usize| self.bodies[part].inverse.as_ref().ok_or_else(missing);
            let grounded = |part: usize| match &inverse(part)?.grounded {
                Some(grounded) => Ok(Arc::clone(grounded)),
                None => self.grounded(model, part),
            };
            let kplus = |part: usize| Ok(&inverse(part)?.kplus);
            let whole = Whole::of(model, &island, &OfParts { kplus: &kplus, grounded: &grounded })?;
            let away = away.next().unwrap_or_default();
            let apart = (!away.is_empty() || whole.is_some()).then(|| Box::new(Apart { whole, away }));
            let pairs = (!island.friction.is_empty()).then(Box::default);
            ready.push(Ready {
                island,
                dual,
                rows,
                metric,
                apart,
                preconditioner: None,
                kept: BetweenSolves::default(),
                pairs,
            });
        }
        let loads = self.loads_of_hosts(model, &ready)?;
        Ok(Duals { of: model.revisions, islands: ready, operators, island_of, loads })
    }
}

/// The methods of the paper use the rows of the host, scaled but not decoupled.
fn coupled(settings: &Settings) -> bool {
    settings.method != Method::Proportioning
}

/// The unit of forces of an island, 2^p, relative to that of K of a body, a power of two. Above 2^1000 the stiffness of the
/// body is nothing: its unknowns are carried, and K+ is 0.
fn ratio_of_units(model: &SolvedModel, island: &Island, body: usize) -> f64 {
    (island.unit / model.bodies[body].body.without(island.unit)).min(2f64.powi(1000))
}

/// `D~ / 2^p` of an island, where rows touch and over all unknowns of the bodies that are here; for dofs without stiffness D is that of the
/// stiffest dof of their body.
fn metric(model: &SolvedModel, island: &Island, away: &[Option<Away>]) -> Result<(Metric, ByBody)> {
    let bodies = island.matrices(model, away);
    let rows = RowKind::ALL.map(|kind| &island.members(kind).rows);
    let at_rows = Metric::of(&Trace::of(&bodies, Seen::unit), rows, &|_, _| true, island.unit)?;
    let everywhere = |(k, body): (usize, &Seen)| {
        let Ok(body) = body.here() else { return Vec::new() };
        let of = |i: usize| body.stiffness.metric(i, body.unit) / island.unit;
        let mut own: Vec<f64> = (0..body.order()).map(of).collect();
        body.set_at_rows(&at_rows.values[island.touched.range(k)], &mut own);
        own
    };
    let each = bodies.iter().enumerate().map(everywhere);
    let ranges = match away.is_empty() {
        true => Arc::clone(&island.ranges),
        false => Arc::new(ranges(bodies.iter().map(|body| body.here().map_or(0, Local::order)))),
    };
    let all = ByBody::from_each(&ranges, each, "the metric of an island")?;
    Ok((at_rows, all))
}

/// Fraction of the setup completed after the dual operators: the rest is for the preconditioner.
fn assembled(settings: &Settings) -> f64 {
    match settings.preconditioner {
        Preconditioning::None => 1.0,
        Preconditioning::Dirichlet => ASSEMBLED,
        Preconditioning::Automatic | Preconditioning::Lumped => ASSEMBLED_LUMPED,
    }
}

/// Checks that a compliance times the stiffness of the bodies does not overflow.
fn check_compliance(island: &Island) -> Result<()> {
    for kind in RowKind::ALL {
        let Members { numbers, rows } = island.members(kind);
        if let Some(row) = rows.compliance.iter().position(|c| !(c * island.unit).is_finite()) {
            let what = format!("the compliance of this {} times max K_ii overflows", kind.name());
            let error = Error::new(Kind::Overflow, what).row(numbers[row]).kind(kind as usize);
            return Err(error.value(rows.compliance[row]));
        }
    }
    Ok(())
}
