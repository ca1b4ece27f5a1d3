//! Loads and gaps of an island, scaled for its dual problem.

use crate::body::{Distributed, Kept, Locals};
use crate::certificate::Load;
use crate::dual::Preconditioner;
use crate::error::Result;
use crate::linalg::vector::norm_max;
use crate::linalg::{Csr, Operator};
use crate::platform::interrupt;
use crate::qp::{self, Qp};
use crate::setup::Ready;
use crate::solve::case::Case;
use crate::solve::gaps::Gaps;
use crate::solve::local::{FromLoad, Loaded, Scale, Take, Unheld};

/// Loads and gaps in the scaling of the dual.
pub struct Scaled {
    /// Of the host.
    pub loads: Kept<Load>,
    /// f / 2^p
    pub load: Distributed,
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
    pub loads: Option<Kept<Load>>,
    /// The largest |resultant| / |load| over the groups of bodies that move together.
    pub share: f64,
}

/// `B_p K_p+ f_p` of every body, and e.
fn of_load(bodies: &Locals, load: &Kept) -> Result<(Vec<Vec<f64>>, Vec<f64>)> {
    let answers = bodies.ask(|_| FromLoad, load)?.into_iter();
    let (moved, resultants): (_, Vec<_>) = answers.map(|of| (of.moved, of.resultants)).unzip();
    Ok((moved, resultants.concat()))
}

impl Scaled {
    /// `gaps`: from the largest entry of `B_p K_p+ f_p`.
    pub fn new(case: Case, gaps: impl FnOnce(f64) -> Result<Gaps>) -> Result<Self> {
        let (bodies, loads) = (case.locals()?, case.loads()?);
        let load = Distributed::new(bodies.make(|_| Scale, &loads)?);
        interrupt::check()?;
        let (moved, resultants) = of_load(&bodies, &load.of)?;
        let gaps = gaps(moved.iter().map(|own| norm_max(own)).fold(0.0, f64::max))?;
        let d = case.ready.dual.rhs(&moved, &gaps.dual);
        Ok(Self { loads, load, gaps, moved, d, resultants, unheld: None, cleaned: None, along: Vec::new() })
    }

    /// Removes the part of the loads that forces x of the dual leave and of which nothing holds a `share`: `left` from the loads if given,
    /// otherwise from the resultants alone.
    pub fn take(&mut self, case: Case, x: &[f64], left: Option<&Kept<Unheld>>, share: f64) -> Result<()> {
        let ready = case.ready;
        let mut held = vec![0.0; self.resultants.len()];
        self.coarse(ready).mul_transposed_add(1.0, x, &mut held);
        let before = self.unheld.as_ref().map_or(0.0, |taken| taken.share);
        let mut taken = Taken { loads: None, share: share.max(before) };
        if let Some(left) = left {
            let bodies = case.locals()?;
            self.load.at_rows = bodies.change(|_| Take, &mut self.load.of, left)?.concat();
            self.moved = of_load(&bodies, &self.load.of)?.0;
            self.d = ready.dual.rhs(&self.moved, &self.gaps.dual);
            taken.loads = Some(bodies.make(|_| Loaded, (&self.load.of, &self.loads))?.1);
        }
        self.resultants = held;
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
