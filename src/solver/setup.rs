//! Everything that does not depend on loads and gaps: null spaces, factors, scaling, dual operators.

use std::ffi::CStr;
use std::ops::Range;
use std::sync::Arc;
use std::time::Instant;

use crate::body::{dirichlet, dirichlet_bytes, lumped, Body, GeneralizedInverse, Modes, NullSpaceInput};
use crate::constraints::RowKind;
use crate::dual::{constrained, Boundary, Dual, Part, Preconditioner};
use crate::error::{Error, Kind, Result};
use crate::linalg::memory::{available, reserved};
use crate::linalg::vector::power_of_two_below;
use crate::linalg::{Multiple, Operator, Symmetric};
use crate::solver::diagnosis::empty_row_contradicts;
use crate::solver::paper;
use crate::solver::problem::Problem;
use crate::solver::rows::DualRows;
use crate::solver::threads;
use crate::solver::watch::{Stops, Watch};

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
    /// The preconditioner and its name in the options.
    pub preconditioner: Option<(&'static CStr, Preconditioner)>,
}

impl Problem {
    /// Null spaces, factors and dual operators, as far as they are not there yet.
    pub fn setup(&mut self) -> Result<()> {
        self.watched(Self::set_up)
    }

    pub(super) fn set_up(&mut self, watch: &mut Watch) -> Result<()> {
        let coupled = paper::is_asked(&self.settings);
        let suits = |ready: &Ready| ready.rows.coupled == coupled || self.equalities.len() == 0;
        if self.ready.as_ref().is_some_and(suits) {
            return Ok(());
        }
        if self.ready.is_some() {
            self.forget_dual();
        }
        let started = Instant::now();
        self.check_complete()?;
        self.contact.check_empty_rows(RowKind::Inequality).map_err(|e| empty_row_contradicts(e, 0))?;
        let first = self.contact.len();
        self.equalities.check_empty_rows(RowKind::Equality).map_err(|e| empty_row_contradicts(e, first))?;
        let unit = self.unit();
        self.check_compliance(unit)?;
        let rows = DualRows::of(self, unit, coupled)?;
        self.factorize(unit, &rows, &watch.stops)?;
        watch.part_done()?;
        self.ready = Some(self.dualize(unit, rows, &watch.stops)?);
        watch.part_done()?;
        self.seconds_setup = started.elapsed().as_secs_f64();
        Ok(())
    }

    fn check_complete(&self) -> Result<()> {
        if self.bodies.is_empty() {
            return Err(Error::new(Kind::State, "the problem has no body yet"));
        }
        for (p, slot) in self.bodies.iter().enumerate() {
            if slot.body.stiffness.is_none() {
                return Err(Error::new(Kind::State, "the stiffness matrix has not been given").body(p));
            }
        }
        Ok(())
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
        let stiffness = self.bodies.iter().filter_map(|slot| slot.body.stiffness.as_ref());
        power_of_two_below(stiffness.map(|k| k.largest_diagonal()).fold(0.0, f64::max))
    }

    /// Factors, dual operators and so many bytes more against the limit of the host, and against what the
    /// system would give.
    pub(super) fn check_memory(&self, rows: &DualRows, more: usize) -> Result<()> {
        let kept = self.bytes_of_factors();
        let operators = Dual::bytes(self.ranges().into_iter(), &rows.matrix);
        let needed = kept.saturating_add(more).saturating_add(operators);
        let limit = usize::try_from(self.settings.memory_limit).unwrap_or(0);
        if limit > 0 && needed > limit {
            let what = format!("factors and dual operators take {needed} bytes, memory_limit is {limit}");
            return Err(Error::new(Kind::Memory, what).value(needed as f64).limit(limit as f64));
        }
        available(more.saturating_add(operators), "factors and dual operators")
    }

    /// Threads to use; a problem so small that waking them costs more than the work gets one.
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
        self.offsets().windows(2).map(|pair| pair[0]..pair[1]).collect()
    }

    /// Forms F and G.
    fn dualize(&mut self, unit: f64, rows: DualRows, stops: &Stops) -> Result<Ready> {
        let (ranges, threads) = (self.ranges(), self.threads());
        let parts = ranges.into_iter().zip(&mut self.bodies).filter_map(|(range, slot)| {
            let inverse = slot.inverse.as_mut()?;
            Some(Part { range, kplus: Arc::clone(&inverse.kplus), kept: inverse.operator.take() })
        });
        let unless_cancelled = |task: &(dyn Fn(usize) -> Result<_> + Sync), p| {
            stops.check_cancelled()?;
            task(p)
        };
        let dual = Dual::new(parts.collect(), &rows.matrix, rows.compliance.clone(), &|count, task| {
            threads::run(threads, count, |p| unless_cancelled(task, p))
        })?;
        self.work.columns_computed += dual.columns.computed;
        self.work.columns_kept += dual.columns.kept;
        Ok(Ready { unit, dual, rows, preconditioner: None })
    }

    /// The preconditioner the options ask for, kept until they ask for another.
    pub(super) fn set_up_preconditioner(&mut self, watch: &mut Watch) -> Result<()> {
        let Some(ready) = &self.ready else { return Ok(()) };
        let asked = match self.settings.preconditioner {
            word if word != c"automatic" => word,
            _ if ready.dual.product_work() > LUMPED_PAYS * ready.rows.matrix.rows() => c"lumped",
            _ => c"none",
        };
        if ready.preconditioner.as_ref().map_or(c"none", |(name, _)| *name) == asked {
            return Ok(());
        }
        let preconditioner = match asked.to_bytes() {
            b"none" => None,
            b"lumped" => Some((asked, self.preconditioner(ready, lumped)?)),
            _ => {
                let boundaries =
                    self.ranges().into_iter().map(|range| constrained(&ready.rows.matrix, &range).len());
                self.check_memory(&ready.rows, boundaries.map(dirichlet_bytes).sum())?;
                Some((asked, self.preconditioner(ready, dirichlet)?))
            }
        };
        if let Some(ready) = &mut self.ready {
            ready.preconditioner = preconditioner;
        }
        watch.part_done()
    }

    fn preconditioner(&self, ready: &Ready, stiffness: BoundaryStiffness) -> Result<Preconditioner> {
        let ranges = self.ranges();
        let boundaries = threads::run(self.threads(), ranges.len(), |p| {
            let local = constrained(&ready.rows.matrix, &ranges[p]);
            let k = self.bodies[p].body.stiffness.as_ref();
            let k = k.ok_or_else(|| Error::new(Kind::Internal, "a body without stiffness was set up"))?;
            let stiffness = stiffness(k, 1.0 / ready.unit, &local).map_err(|e| e.body(p))?;
            Ok(Boundary { dofs: local.iter().map(|j| j + ranges[p].start).collect(), stiffness })
        })?;
        Preconditioner::new(&ready.rows.matrix, ready.rows.compliance.clone(), &ready.rows.metric, boundaries)
    }
}

impl Ready {
    /// `B_p K_p+ f_p` of every body.
    pub fn moved(&self, threads: usize, f: &[f64]) -> Result<Vec<Vec<f64>>> {
        threads::run(threads, self.dual.bodies(), |p| self.dual.moved(p, f))
    }

    /// `u = K+ f + R alpha`, over all unknowns.
    pub fn displacement(&self, threads: usize, f: &[f64], alpha: &[f64]) -> Result<Vec<f64>> {
        let bodies = threads::run(threads, self.dual.bodies(), |p| self.dual.displacement(p, f, alpha))?;
        let mut all = reserved(f.len(), "a displacement")?;
        bodies.iter().for_each(|u| all.extend_from_slice(u));
        Ok(all)
    }
}

/// Null space and fixing dofs of a body, found before anything is factorised.
pub(super) fn plan(body: &Body, unit: f64, tolerance: f64) -> Result<crate::body::Plan> {
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
