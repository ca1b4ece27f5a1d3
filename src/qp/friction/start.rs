//! The start of the method: x within the cones, a that fits its face, the length to which gaps are relative.

use crate::error::Result;
use crate::linalg::vector::norm;
use crate::numbers::friction::{MISSED_BALANCE, RHO};
use crate::numbers::rounding;
use crate::qp::friction::coordinates::of_rows;
use crate::qp::friction::face::Face;
use crate::qp::friction::motions::Motions;
use crate::qp::friction::nearest::{Projected, Target};
use crate::qp::friction::newton::{Point, Run};
use crate::qp::friction::{FrictionLimits, FrictionProblem, FrictionStart};
use crate::qp::{Counts, Observer};

impl<'a, 'w> Run<'a, 'w> {
    /// The method and the first x; if no forces within the cones balance the load, none with the remaining load.
    pub fn new(
        problem: FrictionProblem<'a>,
        limits: FrictionLimits,
        start: FrictionStart,
        observer: &'w mut dyn Observer,
    ) -> Result<(Self, Projected)> {
        let mut motions = Motions::of(&problem.qp, problem.cones)?;
        let all_rows =
            motions.inverse(&of_rows(problem.cones), vec![1.0; problem.qp.b.len()], (false, 0.0))?;
        let y = start.x.map_or_else(|| vec![0.0; problem.qp.b.len()], <[f64]>::to_vec);
        let factorised = usize::from(!problem.qp.e.is_empty());
        let run = Self {
            pairs: start.pairs.of_order(y.len()),
            counts: Counts { coarse_factorisations: factorised, starts: 1, ..Counts::default() },
            limit: limits.products,
            scale: 0.0,
            small: 0.0,
            last: Point::default(),
            slide: None,
            problem,
            motions,
            all_rows,
            observer,
        };
        let first = run.projected(&y)?;
        Ok((run, first))
    }

    /// PROJ_C(y)
    pub fn projected(&self, y: &[f64]) -> Result<Projected> {
        let FrictionProblem { qp, cones, .. } = &self.problem;
        Target { qp, cones, motions: &self.motions, y, delta: 0.0 }.projected(vec![0.0; qp.e.len()])
    }

    /// The start point, the scale and the merit that counts as zero.
    pub fn begun(&mut self, tolerance: f64, first: &Projected, alpha: &[f64]) -> Result<Point> {
        let g = self.gradient(&first.point)?;
        self.measure(&g, tolerance)?;
        self.allow_for_balance(&first.point)?;
        self.begin(&first.point, &g, alpha)
    }

    /// `F x - d`
    pub fn gradient(&mut self, x: &[f64]) -> Result<Vec<f64>> {
        let mut g = if x.iter().all(|x| *x == 0.0) { vec![0.0; x.len()] } else { self.product(x)? };
        g.iter_mut().zip(self.problem.qp.b).for_each(|(g, d)| *g -= d);
        Ok(g)
    }

    /// Sets the length to which gaps are relative, and the merit that counts as zero, which includes rounding of d.
    pub fn measure(&mut self, g: &[f64], tolerance: f64) -> Result<()> {
        self.scale = self.size_of_gaps(g)?;
        self.small = (tolerance * self.scale).max(64.0 * f64::EPSILON * norm(self.problem.qp.b).max(norm(g)));
        Ok(())
    }

    /// Increases that merit by the rounding of `G x = e` at the start, which later directions do not change.
    pub fn allow_for_balance(&mut self, x: &[f64]) -> Result<()> {
        let floor = MISSED_BALANCE * self.balance_missed(x)?.sqrt() / RHO;
        self.small = if floor > self.small { floor } else { self.small };
        Ok(())
    }

    /// N, `|P d|`, or `|P (F x - d)|` if that is 0.
    fn size_of_gaps(&mut self, g: &[f64]) -> Result<f64> {
        let mut whole = 0.0f64;
        for v in [self.problem.qp.b, g] {
            let mut v = v.to_vec();
            whole = whole.max(norm(&v));
            self.without_motions(&mut v)?;
            // otherwise the projected direction is zero
            if norm(&v) > rounding::SUM * whole {
                return Ok(norm(&v));
            }
        }
        Ok(0.0)
    }

    /// The start point with x and g; a in two passes, `a += da` with the face of (x, 0), then with that of (x, r).
    pub fn begin(&mut self, x: &[f64], g: &[f64], alpha: &[f64]) -> Result<Point> {
        let none = vec![0.0; x.len()];
        let first = self.model(Face::at(self.problem.cones, x, &none, RHO))?;
        let alpha = self.turned(&first, x, g, alpha)?;
        let second = self.model(Face::at(self.problem.cones, x, &self.gaps(g, &alpha), RHO))?;
        let alpha = self.turned(&second, x, g, &alpha)?;
        self.point(x.to_vec(), g.to_vec(), alpha)
    }
}
