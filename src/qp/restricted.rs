//! The problem restricted to some of its rows: the others stay at 0, and neither they nor their gradient are computed.
//! Rows whose gap is far larger than all motions therefore change nothing, not even rounding.

use crate::error::Result;
use crate::linalg::{Csr, Entries, Matrix, Operator};
use crate::qp::{AcceptanceTest, Direct, Effort, Mended, Preconditioner, Qp, Solution, Verdict};

pub struct Restricted<'a> {
    whole: Qp<'a>,
    /// Ascending.
    rows: &'a [usize],
    b: Vec<f64>,
    g_transposed: Csr,
    bounded: Vec<bool>,
}

impl<'a> Restricted<'a> {
    pub fn new(whole: Qp<'a>, rows: &'a [usize]) -> Self {
        let mut g_transposed = Csr::empty(whole.g_transposed.cols);
        rows.iter().for_each(|&i| g_transposed.push_row(whole.g_transposed.row(i)));
        let b = gather(rows, whole.b);
        let bounded = rows.iter().map(|&i| whole.bounded[i]).collect();
        Self { whole, rows, b, g_transposed, bounded }
    }

    pub fn bounded(&self) -> &[bool] {
        &self.bounded
    }

    pub fn qp(&self) -> Qp<'_> {
        let preconditioner = self.whole.preconditioner.is_some().then_some(self as &dyn Preconditioner);
        let (b, g_transposed, bounded) = (&self.b, &self.g_transposed, &self.bounded);
        Qp { a: self, b, g_transposed, bounded, preconditioner, kept: None, ..self.whole }
    }

    /// The entries of x on these rows.
    pub fn start(&self, x: &[f64]) -> Vec<f64> {
        gather(self.rows, x)
    }

    /// Extends a solution, or an unbounded direction, to all rows.
    pub fn whole(&self, solution: Solution) -> Solution {
        let verdict = match solution.verdict {
            Verdict::Unbounded { p } => Verdict::Unbounded { p: self.spread(&p) },
            verdict => verdict,
        };
        Solution { x: self.spread(&solution.x), verdict, ..solution }
    }

    /// Restricts a solution to these rows; none if other rows have forces.
    fn part(&self, solution: Solution) -> Option<Solution> {
        let x = self.start(&solution.x);
        (self.spread(&x) == solution.x).then_some(Solution { x, ..solution })
    }

    /// The entries on these rows of a product over all rows; after an error y is unchanged.
    fn product(
        &self,
        x: &[f64],
        y: &mut [f64],
        of_all: impl Fn(&[f64], &mut [f64]) -> Result<()>,
    ) -> Result<()> {
        let mut image = vec![0.0; self.whole.b.len()];
        of_all(&self.spread(x), &mut image)?;
        y.copy_from_slice(&gather(self.rows, &image));
        Ok(())
    }

    /// Entries on these rows, and 0 on the others.
    pub fn spread(&self, own: &[f64]) -> Vec<f64> {
        let mut all = vec![0.0; self.whole.b.len()];
        self.rows.iter().zip(own).for_each(|(&i, v)| all[i] = *v);
        all
    }
}

fn gather(rows: &[usize], all: &[f64]) -> Vec<f64> {
    rows.iter().map(|&i| all[i]).collect()
}

impl Operator for Restricted<'_> {
    fn order(&self) -> usize {
        self.rows.len()
    }

    fn apply(&self, x: &[f64], y: &mut [f64]) {
        let mut image = vec![0.0; self.whole.b.len()];
        self.whole.a.apply(&self.spread(x), &mut image);
        y.copy_from_slice(&gather(self.rows, &image));
    }

    fn try_apply(&self, x: &[f64], y: &mut [f64]) -> Result<()> {
        self.product(x, y, |x, image| self.whole.a.try_apply(x, image))
    }

    fn apply_to_share(&self, share: f64, x: &[f64], y: &mut [f64]) -> Result<()> {
        self.product(x, y, |x, image| self.whole.a.apply_to_share(share, x, image))
    }

    fn approximate(&self, x: &[f64], y: &mut [f64]) -> Result<()> {
        self.product(x, y, |x, image| self.whole.a.approximate(x, image))
    }

    fn has_approximation(&self) -> bool {
        self.whole.a.has_approximation()
    }
}

impl Preconditioner for Restricted<'_> {
    /// The rows left out are held.
    fn apply(&self, held: &[bool], r: &[f64], z: &mut [f64]) -> Result<()> {
        let Some(preconditioner) = self.whole.preconditioner else { return Ok(()) };
        let mut all = vec![true; self.whole.b.len()];
        self.rows.iter().zip(held).for_each(|(&i, held)| all[i] = *held);
        let mut image = vec![0.0; all.len()];
        preconditioner.apply(&all, &self.spread(r), &mut image)?;
        z.copy_from_slice(&gather(self.rows, &image));
        Ok(())
    }
}

/// The entries of A on these rows.
pub struct DirectOnRows<'a> {
    pub whole: Direct<'a>,
    pub rows: &'a [usize],
}

impl DirectOnRows<'_> {
    pub fn direct(&self) -> Direct<'_> {
        Direct { entries: self, limit: self.whole.limit }
    }
}

impl Entries for DirectOnRows<'_> {
    fn add_block(&self, rows: &[usize], block: &mut Matrix) -> Result<()> {
        let all: Vec<usize> = rows.iter().map(|&i| self.rows[i]).collect();
        self.whole.entries.add_block(&all, block)
    }
}

/// Passes points on some rows to an acceptance test for all rows.
pub struct Judged<'a> {
    pub whole: &'a mut dyn AcceptanceTest,
    pub on: &'a Restricted<'a>,
}

impl AcceptanceTest for Judged<'_> {
    fn scale(&mut self, x: &[f64], alpha: &[f64]) -> Result<f64> {
        self.whole.scale(&self.on.spread(x), alpha)
    }

    fn share_of_energy(&self) -> f64 {
        self.whole.share_of_energy()
    }

    fn accepts(&mut self, x: &[f64], alpha: &[f64]) -> Result<bool> {
        self.whole.accepts(&self.on.spread(x), alpha)
    }

    fn missed(&self) -> Option<f64> {
        self.whole.missed()
    }

    fn has_better_data(&self) -> bool {
        self.whole.has_better_data()
    }

    fn pays_after(&self, effort: Effort) -> Option<usize> {
        self.whole.pays_after(effort)
    }

    fn mended(&mut self, solution: &Solution, effort: Effort) -> Result<Mended> {
        Ok(match self.whole.mended(&self.on.whole(solution.clone()), effort)? {
            Mended::Accepted(mended) => self.on.part(mended).map_or(Mended::Failed, Mended::Accepted),
            Mended::Near(x) => Mended::Near(self.on.start(&x)),
            failed => failed,
        })
    }
}
