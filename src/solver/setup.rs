//! Everything that does not depend on loads and gaps: null spaces, factors, scaling, dual operators.

use std::ffi::CStr;
use std::ops::Range;
use std::sync::Arc;
use std::time::Instant;

use crate::body::{
    diagonal, dirichlet, dirichlet_bytes, lumped, Body, GeneralizedInverse, Modes, NullSpaceInput, Plan,
    Stiffness,
};
use crate::constraints::RowKind;
use crate::dual::{self, constrained, Boundary, Dual, Preconditioner};
use crate::error::{Error, Kind, Result};
use crate::linalg::memory::reserved;
use crate::linalg::vector::power_of_two_below;
use crate::linalg::{Multiple, Operator, Symmetric};
use crate::solver::diagnosis::empty_row_contradicts;
use crate::solver::host::lacks_null_space;
use crate::solver::operators::Operators;
use crate::solver::paper;
use crate::solver::phases::{Phase, Phases};
use crate::solver::problem::Problem;
use crate::solver::rows::DualRows;
use crate::solver::threads;
use crate::solver::watch::{Part, Watch};

/// `automatic` takes the lumped preconditioner where a product with F costs this many operations for each row. On glued
/// subdomains it saves a hundred products and takes the time of 3e4 operations for each row to set up; on two bodies in
/// contact it saves few.
const LUMPED_PAYS: usize = 300;

/// `scale` times the stiffness of the constrained dofs of a body.
type BoundaryStiffness = fn(&Symmetric, f64, &[usize]) -> Result<Box<dyn Operator + Send>>;

/// The dual problem, ready for any load and gap.
pub(super) struct Ready {
    /// 2^p, p = floor(log2 max K_ii), force / length: K and forces are divided by it.
    pub unit: f64,
    pub dual: Dual,
    pub rows: DualRows,
    pub operators: Operators,
    /// The preconditioner and its name in the options.
    pub preconditioner: Option<(&'static CStr, Preconditioner)>,
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
        let suits = |ready: &Ready| {
            (ready.rows.coupled == coupled || self.equalities.len() == 0) && self.wants(&ready.operators)
        };
        self.ready.as_ref().is_some_and(suits)
    }

    pub(super) fn set_up(&mut self, watch: &mut Watch) -> Result<()> {
        let begun = Instant::now();
        self.check_complete()?;
        self.check_empty_rows()?;
        if self.is_set_up() {
            return Ok(());
        }
        if self.ready.is_some() {
            self.forget_dual();
        }
        let unit = self.unit();
        self.check_compliance(unit)?;
        let rows = DualRows::of(self, unit, paper::is_asked(&self.settings))?;
        self.phases.ended(Phase::Rows, begun);
        let operators = self.factorize(unit, &rows, watch)?;
        let begun = Instant::now();
        self.ready = Some(self.dualize(unit, rows, operators, watch)?);
        self.phases.ended(Phase::DualOperators, begun);
        Ok(())
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

    /// A compliance times the stiffness of the bodies must be a number.
    fn check_compliance(&self, unit: f64) -> Result<()> {
        for (kind, rows) in [(RowKind::Inequality, &self.contact), (RowKind::Equality, &self.equalities)] {
            if let Some(row) = rows.compliance.iter().position(|c| !(c * unit).is_finite()) {
                let what = format!("the compliance of this {} times max K_ii overflows", kind.name());
                return Err(Error::new(Kind::Overflow, what).row(row).value(rows.compliance[row]));
            }
        }
        Ok(())
    }

    /// The power of two below the largest diagonal entry of all bodies (1 when there is none): dividing by it
    /// is exact, so powers of two in the host's units do not change a bit of what follows.
    pub(super) fn unit(&self) -> f64 {
        let stiffness = self.bodies.iter().filter_map(|slot| slot.body.k());
        power_of_two_below(stiffness.map(|k| k.largest_diagonal()).fold(0.0, f64::max))
    }

    /// Threads of the setup; a problem so small that waking them costs more than the work gets one.
    pub(super) fn threads(&self) -> usize {
        const SMALL: usize = 1000;
        if self.counts().dofs < SMALL {
            1
        } else {
            threads::count(self.settings.threads)
        }
    }

    /// Unknowns of every body among all.
    pub(super) fn ranges(&self) -> Vec<Range<usize>> {
        self.offsets.windows(2).map(|pair| pair[0]..pair[1]).collect()
    }

    /// Forms F and G.
    fn dualize(
        &mut self,
        unit: f64,
        rows: DualRows,
        operators: Operators,
        watch: &mut Watch,
    ) -> Result<Ready> {
        let all: Vec<usize> = (0..self.bodies.len()).collect();
        let part = Part {
            threads: self.threads(),
            weights: operators.weights(),
            until: self.assembled(),
            on_caller: self.on_caller(&all),
        };
        let bodies = self.ranges().into_iter().zip(&mut self.bodies).enumerate();
        let parts = bodies.filter_map(|(p, (range, slot))| {
            let inverse = slot.inverse.as_mut()?;
            let (kplus, kept) = (Arc::clone(&inverse.kplus), inverse.operator.take());
            Some(dual::Part { range, kplus, kept, size: operators.sizes[p], implicit: operators.implicit[p] })
        });
        let dual = Dual::new(parts.collect(), &rows.matrix, rows.compliance.clone(), &mut |count, task| {
            let mut made: Vec<_> = (0..count).map(|_| None).collect();
            watch.every_body(&part, task, |p, operator| made[p] = operator)?;
            Ok(made)
        })?;
        self.work.columns_computed += dual.columns.computed;
        self.work.columns_kept += dual.columns.kept;
        Ok(Ready { unit, dual, rows, operators, preconditioner: None })
    }

    /// Fraction of the setup that is done with the dual operators: what is left is for the preconditioner.
    fn assembled(&self) -> f64 {
        match self.settings.preconditioner.to_bytes() {
            b"none" => 1.0,
            b"dirichlet" => 0.6,
            _ => 0.98,
        }
    }

    /// The preconditioner the options ask for, kept until they ask for another.
    pub(super) fn set_up_preconditioner(&mut self, watch: &mut Watch) -> Result<()> {
        let Some(ready) = &self.ready else { return Ok(()) };
        let asked = match self.settings.preconditioner {
            word if word != c"automatic" => word,
            _ if self.bodies.iter().all(|slot| slot.body.operator.is_some()) => c"none",
            _ if ready.dual.product_work() > LUMPED_PAYS * ready.rows.matrix.rows() => c"lumped",
            _ => c"none",
        };
        if ready.preconditioner.as_ref().map_or(c"none", |(name, _)| *name) == asked {
            return Ok(());
        }
        let begun = Instant::now();
        let preconditioner = match asked.to_bytes() {
            b"none" => None,
            b"lumped" => Some((asked, self.preconditioner(ready, lumped)?)),
            _ => {
                let boundaries = constrained(&ready.rows.matrix, &self.ranges());
                self.check_more(ready, boundaries.iter().map(|dofs| dirichlet_bytes(dofs.len())).sum())?;
                Some((asked, self.preconditioner(ready, dirichlet)?))
            }
        };
        if let Some(ready) = &mut self.ready {
            ready.preconditioner = preconditioner;
        }
        self.phases.ended(Phase::Preconditioner, begun);
        watch.setup_done()
    }

    fn preconditioner(&self, ready: &Ready, stiffness: BoundaryStiffness) -> Result<Preconditioner> {
        let ranges = self.ranges();
        let constrained = constrained(&ready.rows.matrix, &ranges);
        let boundaries = threads::run(self.threads(), ranges.len(), |p| {
            let local = &constrained[p];
            let missing = || Error::new(Kind::Internal, "a body without stiffness was set up");
            let made = match self.bodies[p].body.k().ok_or_else(missing)? {
                Stiffness::Matrix(k) => stiffness(k, 1.0 / ready.unit, local),
                Stiffness::Host(k) => diagonal(k, 1.0 / ready.unit, local),
            };
            let stiffness = made.map_err(|e| e.body(p))?;
            Ok(Boundary { dofs: local.iter().map(|j| j + ranges[p].start).collect(), stiffness })
        })?;
        Preconditioner::new(&ready.rows.matrix, ready.rows.compliance.clone(), &ready.rows.metric, boundaries)
    }
}

impl Ready {
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

    /// `u = K+ f + R alpha`, over all unknowns.
    pub fn displacement(&self, threads: usize, f: &[f64], alpha: &[f64]) -> Result<Vec<f64>> {
        let on_caller = |p: usize| self.dual.solves_on_caller(p);
        let displacement = |p| self.dual.displacement(p, f, alpha);
        let bodies = threads::run_apart(threads, self.dual.bodies(), on_caller, displacement)?;
        let mut all = reserved(f.len(), "a displacement")?;
        bodies.iter().for_each(|u| all.extend_from_slice(u));
        Ok(all)
    }
}

/// Null space and fixing dofs of a body, found before anything is factorised.
pub(super) fn plan(body: &Body, unit: f64, tolerance: f64) -> Result<Plan> {
    let missing = || Error::new(Kind::Internal, "a body without stiffness was set up");
    let matrix = Arc::clone(body.stiffness.as_ref().ok_or_else(missing)?);
    let k = Multiple { matrix, by: 1.0 / unit };
    let fixing = body.fixing.as_deref();
    if let Some(given) = &body.null_space {
        return GeneralizedInverse::plan_with(k, given, tolerance, fixing);
    }
    let Some(coordinates) = &body.coordinates else {
        return GeneralizedInverse::search(k, tolerance, fixing);
    };
    let vectors = coordinates.rigid_modes(&k.matrix)?;
    let candidates = NullSpaceInput { vectors, modes: Modes::Candidates };
    GeneralizedInverse::plan_with(k, &candidates, tolerance, fixing)
}
