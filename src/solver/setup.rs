//! Everything that does not depend on loads and gaps: null spaces, factors, scaling, dual operators.

use std::sync::Arc;
use std::time::Instant;

use crate::body::{diagonal, dirichlet, dirichlet_bytes, lumped, Body, GeneralizedInverse, Plan, Stiffness};
use crate::constraints::RowKind;
use crate::dual::{self, constrained, Boundary, Draft, Dual, Preconditioner};
use crate::error::{Error, Kind, Result};
use crate::linalg::{Multiple, Operator, Symmetric};
use crate::platform::memory::reserved;
use crate::platform::threads;
use crate::solver::diagnosis::empty_row_contradicts;
use crate::solver::host::lacks_null_space;
use crate::solver::islands::{islands, Island, Members};
use crate::solver::operators::Operators;
use crate::solver::paper;
use crate::solver::phases::{Phase, Phases};
use crate::solver::problem::Problem;
use crate::solver::rows::DualRows;
use crate::solver::watch::{Part, Watch};
use crate::solver::words::Preconditioning;

/// `automatic` takes the lumped preconditioner where a product with F costs this many operations for each row. On glued
/// subdomains it saves a hundred products and takes the time of 3e4 operations for each row to set up; on two bodies in
/// contact it saves few.
const LUMPED_PAYS: usize = 300;

/// `scale` times the stiffness of the constrained dofs of a body.
type BoundaryStiffness = fn(&Symmetric, f64, &[usize]) -> Result<Box<dyn Operator + Send>>;

/// The dual problems of all islands, ready for any load and gap.
pub(super) struct Setup {
    pub islands: Vec<Ready>,
    /// Of all bodies.
    pub operators: Operators,
    /// Island of every body.
    pub island_of: Vec<usize>,
}

/// The dual problem of an island.
pub(super) struct Ready {
    pub island: Island,
    pub dual: Dual,
    pub rows: DualRows,
    /// The preconditioner and which one of the options it is.
    pub preconditioner: Option<(Preconditioning, Preconditioner)>,
}

impl Problem {
    /// Null spaces, factors and dual operators, as far as they are not there yet.
    pub fn setup(&mut self) -> Result<()> {
        self.watched(|problem, watch| {
            if !problem.is_set_up() {
                problem.phases = Phases::default();
                watch.log.begin(problem, "setup")?;
            }
            let done = problem.set_up(watch);
            problem.logged("setup", done, watch)
        })
    }

    /// True where factors and dual operators are as the options want them.
    pub(super) fn is_set_up(&self) -> bool {
        let coupled = paper::is_asked(&self.settings);
        let suits = |ready: &Ready| ready.rows.coupled == coupled;
        self.ready
            .as_ref()
            .is_some_and(|setup| setup.islands.iter().all(suits) && self.wants(&setup.operators))
    }

    pub(super) fn set_up(&mut self, watch: &mut Watch) -> Result<()> {
        let begun = Instant::now();
        self.check_complete()?;
        self.check_empty_rows()?;
        if self.is_set_up() {
            self.refresh_gaps();
            return Ok(());
        }
        if self.ready.is_some() {
            self.forget_dual();
        }
        let islands = islands(self)?;
        let coupled = paper::is_asked(&self.settings);
        let mut rows = reserved(islands.len(), "groups of bodies")?;
        let mut distinct = vec![0; self.bodies.len()];
        for island in &islands {
            check_compliance(island)?;
            let own = DualRows::of(island, self.metric(island), coupled)?;
            let counts = Dual::distinct_rows(island.ranges.clone(), &own.matrix);
            island.bodies.iter().zip(counts).for_each(|(&p, count)| distinct[p] = count);
            rows.push(own);
        }
        self.phases.ended(Phase::Rows, begun);
        let operators = self.factorize(&distinct, watch)?;
        let begun = Instant::now();
        self.ready = Some(self.dualize(islands.into_iter().zip(rows).collect(), operators, watch)?);
        self.phases.ended(Phase::DualOperators, begun);
        Ok(())
    }

    /// Gives the islands the gaps as they are now.
    pub(super) fn refresh_gaps(&mut self) {
        let (contact, equalities) = (&self.contact.rhs, &self.equalities.rhs);
        let islands = self.ready.iter_mut().flat_map(|setup| &mut setup.islands);
        islands.for_each(|ready| ready.island.refresh(contact, equalities));
    }

    /// `D / 2^p` over the unknowns of an island, for dofs without stiffness D of the stiffest dof of their body.
    fn metric(&self, island: &Island) -> Vec<f64> {
        let of_body = |&p: &usize| {
            let body = &self.bodies[p].body;
            let without = body.without(island.unit);
            body.k()
                .into_iter()
                .flat_map(move |k| (0..k.order()).map(move |i| k.metric(i, without) / island.unit))
        };
        island.bodies.iter().flat_map(of_body).collect()
    }

    fn check_complete(&self) -> Result<()> {
        if self.bodies.is_empty() {
            return Err(Error::new(Kind::State, "the problem has no body yet"));
        }
        for (p, slot) in self.bodies.iter().enumerate() {
            if slot.body.k().is_none() {
                return Err(Error::new(Kind::State, "the stiffness matrix has not been given").body(p));
            }
            if lacks_null_space(&slot.body) {
                let what = "the null space has not been given: it cannot be found from products with K";
                return Err(Error::new(Kind::State, what).body(p));
            }
            if slot.spoiled {
                let what =
                    "the values of the stiffness matrix were rewritten in place and refused: give others";
                return Err(Error::new(Kind::State, what).body(p));
            }
        }
        Ok(())
    }

    /// Also where all is set up: right-hand sides may have changed since.
    pub(super) fn check_empty_rows(&self) -> Result<()> {
        self.contact.check_empty_rows(RowKind::Inequality).map_err(|e| empty_row_contradicts(e, 0))?;
        let first = self.contact.len();
        self.equalities.check_empty_rows(RowKind::Equality).map_err(|e| empty_row_contradicts(e, first))
    }

    /// Threads of the setup: fewer unknowns for each cost less than to wake it.
    pub(super) fn threads(&self) -> usize {
        const FOR_EACH: usize = 500;
        threads::count(self.settings.threads, self.counts().dofs / FOR_EACH)
    }

    /// Forms F and G of every island.
    fn dualize(
        &mut self,
        islands: Vec<(Island, DualRows)>,
        operators: Operators,
        watch: &mut Watch,
    ) -> Result<Setup> {
        let mut drafts = reserved(islands.len(), "groups of bodies")?;
        let (mut island_of, mut number_in) = (vec![0; self.bodies.len()], vec![0; self.bodies.len()]);
        for (k, (island, rows)) in islands.iter().enumerate() {
            let mut parts = reserved(island.bodies.len(), "groups of bodies")?;
            for (number, (&p, range)) in island.bodies.iter().zip(&island.ranges).enumerate() {
                (island_of[p], number_in[p]) = (k, number);
                let by = island.unit / self.bodies[p].body.without(island.unit);
                let Some(inverse) = self.bodies[p].inverse.as_mut() else { continue };
                let (kplus, kept) = (Arc::clone(&inverse.kplus), inverse.operator.take());
                let (size, implicit) = (operators.sizes[p], operators.implicit[p]);
                parts.push(dual::Part { range: range.clone(), kplus, by, kept, size, implicit });
            }
            drafts.push(Draft::new(parts, &rows.matrix));
        }
        let all: Vec<usize> = (0..self.bodies.len()).collect();
        let part = Part {
            threads: self.threads(),
            weights: operators.weights(),
            until: self.assembled(),
            on_caller: self.on_caller(&all),
        };
        let mut made: Vec<Vec<_>> =
            islands.iter().map(|(island, _)| island.bodies.iter().map(|_| None).collect()).collect();
        let assemble = |p: usize| drafts[island_of[p]].assemble(number_in[p]).map_err(|e| e.body(p));
        watch.every_body(&part, assemble, |p, operator| made[island_of[p]][number_in[p]] = operator)?;
        let mut ready = reserved(islands.len(), "groups of bodies")?;
        for (((island, rows), draft), made) in islands.into_iter().zip(drafts).zip(made) {
            // Algorithm 3 weighs the rigid modes as the paper has them
            let dual = draft.finish(made, rows.compliance.clone(), !rows.coupled);
            self.work.columns_computed += dual.columns.computed;
            self.work.columns_kept += dual.columns.kept;
            ready.push(Ready { island, dual, rows, preconditioner: None });
        }
        Ok(Setup { islands: ready, operators, island_of })
    }

    /// Fraction of the setup that is done with the dual operators: what is left is for the preconditioner.
    fn assembled(&self) -> f64 {
        match self.settings.preconditioner {
            Preconditioning::None => 1.0,
            Preconditioning::Dirichlet => 0.6,
            Preconditioning::Automatic | Preconditioning::Lumped => 0.98,
        }
    }

    /// The preconditioners the options ask for, kept until they ask for others.
    pub(super) fn set_up_preconditioner(&mut self, watch: &mut Watch) -> Result<()> {
        let Some(setup) = &self.ready else { return Ok(()) };
        let asked: Vec<Preconditioning> =
            setup.islands.iter().map(|ready| self.wanted_preconditioner(ready)).collect();
        if setup.islands.iter().map(Ready::preconditioning).eq(asked.iter().copied()) {
            return Ok(());
        }
        let begun = Instant::now();
        if asked.contains(&Preconditioning::Dirichlet) {
            let boundaries = |ready: &Ready| {
                let dofs = constrained(&ready.rows.matrix, &ready.island.ranges);
                dofs.iter().map(|dofs| dirichlet_bytes(dofs.len())).sum::<usize>()
            };
            self.check_more(&setup.operators, setup.islands.iter().map(boundaries).sum())?;
        }
        let mut made = reserved(asked.len(), "groups of bodies")?;
        for (ready, &asked) in setup.islands.iter().zip(&asked) {
            made.push(match asked {
                Preconditioning::Automatic | Preconditioning::None => None,
                Preconditioning::Lumped => Some((asked, self.preconditioner(ready, lumped)?)),
                Preconditioning::Dirichlet => Some((asked, self.preconditioner(ready, dirichlet)?)),
            });
        }
        let islands = self.ready.iter_mut().flat_map(|setup| &mut setup.islands);
        islands.zip(made).for_each(|(ready, made)| ready.preconditioner = made);
        self.phases.ended(Phase::Preconditioner, begun);
        watch.setup_done()
    }

    fn wanted_preconditioner(&self, ready: &Ready) -> Preconditioning {
        let of_host = |&p: &usize| self.bodies[p].body.operator.is_some();
        match self.settings.preconditioner {
            Preconditioning::Automatic if ready.island.bodies.iter().all(of_host) => Preconditioning::None,
            Preconditioning::Automatic
                if ready.dual.product_work() > LUMPED_PAYS * ready.rows.matrix.rows() =>
            {
                Preconditioning::Lumped
            }
            Preconditioning::Automatic => Preconditioning::None,
            asked => asked,
        }
    }

    fn preconditioner(&self, ready: &Ready, stiffness: BoundaryStiffness) -> Result<Preconditioner> {
        let Island { bodies, ranges, unit, .. } = &ready.island;
        let constrained = constrained(&ready.rows.matrix, ranges);
        let boundaries = threads::run(self.threads(), ranges.len(), |k| {
            let (p, local) = (bodies[k], &constrained[k]);
            let missing = || Error::new(Kind::Internal, "a body without stiffness was set up");
            let made = match self.bodies[p].body.k().ok_or_else(missing)? {
                Stiffness::Matrix(k) => stiffness(k, 1.0 / unit, local),
                Stiffness::Host(k) => diagonal(k, 1.0 / unit, local),
            };
            let stiffness = made.map_err(|e| e.body(p))?;
            Ok(Boundary { dofs: local.iter().map(|j| j + ranges[k].start).collect(), stiffness })
        })?;
        Preconditioner::new(&ready.rows.matrix, ready.rows.compliance.clone(), &ready.rows.metric, boundaries)
    }
}

impl Ready {
    /// Which preconditioner is there.
    pub fn preconditioning(&self) -> Preconditioning {
        self.preconditioner.as_ref().map_or(Preconditioning::None, |(kind, _)| *kind)
    }

    /// `B_p K_p+ f_p` of every body.
    pub fn moved(&self, threads: usize, f: &[f64]) -> Result<Vec<Vec<f64>>> {
        let on_caller = |p: usize| self.dual.solves_on_caller(p);
        threads::run_apart(threads, self.dual.bodies(), on_caller, |p| self.dual.moved(p, f))
    }

    /// `sum_p |B_p u_p|`, row by row.
    pub fn distances(
        &self,
        threads: usize,
        moved: &[Vec<f64>],
        x: &[f64],
        alpha: &[f64],
    ) -> Result<Vec<f64>> {
        let on_caller = |p: usize| self.dual.multiplies_on_caller(p);
        let in_parallel =
            |count, task: &(dyn Fn(usize) -> _ + Sync)| threads::run_apart(threads, count, on_caller, task);
        self.dual.distances(moved, x, alpha, &in_parallel)
    }

    /// `K+ f`, over the unknowns of the island.
    pub fn displacement(&self, threads: usize, f: &[f64]) -> Result<Vec<f64>> {
        let on_caller = |p: usize| self.dual.solves_on_caller(p);
        let displacement = |p| self.dual.displacement(p, f);
        let bodies = threads::run_apart(threads, self.dual.bodies(), on_caller, displacement)?;
        let mut all = reserved(f.len(), "a displacement")?;
        bodies.iter().for_each(|u| all.extend_from_slice(u));
        Ok(all)
    }
}

/// A compliance times the stiffness of the bodies must be a number.
fn check_compliance(island: &Island) -> Result<()> {
    for kind in [RowKind::Inequality, RowKind::Equality] {
        let Members { numbers, rows } = island.members(kind);
        if let Some(row) = rows.compliance.iter().position(|c| !(c * island.unit).is_finite()) {
            let what = format!("the compliance of this {} times max K_ii overflows", kind.name());
            let error = Error::new(Kind::Overflow, what).row(numbers[row]);
            return Err(error.value(rows.compliance[row]));
        }
    }
    Ok(())
}

/// Null space and fixing dofs of a body, found before anything is factorised.
pub(super) fn plan(body: &Body, tolerance: f64) -> Result<Plan> {
    let missing = || Error::new(Kind::Internal, "a body without stiffness was set up");
    let matrix = Arc::clone(body.stiffness.as_ref().ok_or_else(missing)?);
    let k = Multiple { matrix, by: 1.0 / body.unit() };
    let fixing = body.fixing.as_deref();
    if let Some(given) = &body.null_space {
        return GeneralizedInverse::plan_with(k, given, tolerance, fixing);
    }
    let Some(coordinates) = &body.coordinates else {
        return GeneralizedInverse::search(k, tolerance, fixing);
    };
    let rigid = coordinates.rigid_modes(&k.matrix)?;
    GeneralizedInverse::plan_near(k, &rigid, tolerance, fixing)
}
