//! Loads and gaps of an island, scaled for its dual problem.

use crate::dual::Preconditioner;
use crate::error::Result;
use crate::linalg::{ByBody, Csr, Operator};
use crate::qp::{self, Qp};
use crate::setup::Ready;
use crate::solve::case::Case;
use crate::solve::gaps::Gaps;

/// Loads and gaps in the scaling of the dual.
pub struct Scaled {
    /// f / 2^p
    pub load: ByBody,
    pub gaps: Gaps,
    /// `B_p K_p+ f_p` of every body.
    pub moved: Vec<Vec<f64>>,
    d: Vec<f64>,
    /// `e = R'f`
    pub resultants: Vec<f64>,
    /// The part removed from the loads because nothing holds it.
    pub unheld: Option<Taken>,
    /// G' without the resistance to slides that are noise of the host's data.
    pub cleaned: Option<Box<Csr>>,
    /// The motion along which forces leave a part of the load, amplitudes over the modes of the dual; empty if there is none.
    pub along: Vec<f64>,
}

/// Loads without the part that nothing holds.
pub struct Taken {
    /// The loads without this part, force; none if the part is so small on each body that it is removed from the
    /// resultants alone.
    pub load: Option<ByBody>,
    /// The largest |resultant| / |load| over the groups of bodies that move together.
    pub share: f64,
}

impl Scaled {
    /// `load`: f / 2^p; `moved`: `B_p K_p+ f_p`.
    pub fn new(ready: &Ready, load: ByBody, moved: Vec<Vec<f64>>, gaps: Gaps) -> Self {
        let d = ready.dual.rhs(&moved, &gaps.dual);
        let resultants = ready.dual.resultants(&load);
        Self { load, gaps, moved, d, resultants, unheld: None, cleaned: None, along: Vec::new() }
    }

    /// Removes the part of the loads that forces x of the dual leave and of which nothing holds a `share`: `left`, in
    /// units of 2^p, from the loads if given, otherwise from the resultants alone.
    pub fn take(&mut self, case: Case, x: &[f64], left: Option<&ByBody>, share: f64) -> Result<()> {
        let ready = case.ready;
        let mut held = vec![0.0; self.resultants.len()];
        self.coarse(ready).mul_transposed_add(1.0, x, &mut held);
        self.resultants = held;
        let before = self.unheld.as_ref().map_or(0.0, |taken| taken.share);
        let mut taken = Taken { load: None, share: share.max(before) };
        if let Some(left) = left {
            self.load.add(-1.0, left);
            self.moved = ready.moved(case.threads(), &self.load)?;
            self.d = ready.dual.rhs(&self.moved, &self.gaps.dual);
            taken.load = Some(self.load.map(|f| f * ready.island.unit));
        }
        self.unheld = Some(taken);
        Ok(())
    }

    /// G'
    fn coarse<'a>(&'a self, ready: &'a Ready) -> &'a Csr {
        self.cleaned.as_deref().unwrap_or(&ready.dual.coarse)
    }

    pub fn qp<'a>(&'a self, ready: &'a Ready, a: &'a dyn Operator) -> Qp<'a> {
        let (g_transposed, blocks) = (self.coarse(ready), &ready.dual.blocks[..]);
        let preconditioner = ready.preconditioner.as_ref().map(|made| &made.1 as &dyn qp::Preconditioner);
        let (b, e, bounded, rounding) =
            (&self.d, &self.resultants, &self.gaps.bounded, ready.dual.rounding());
        Qp { a, b, g_transposed, blocks, rounding, e, bounded, preconditioner, kept: Some(&ready.kept) }
    }
}

impl qp::Preconditioner for Preconditioner {
    fn apply(&self, held: &[bool], r: &[f64], z: &mut [f64]) -> Result<()> {
        Preconditioner::apply(self, held, r, z)
    }
}
