//! What rank 0 knows of a K+ that another rank has made.

use std::sync::Arc;

use crate::body::elsewhere::Elsewhere;
use crate::body::generalized_inverse::{Factorised, GeneralizedInverse};
use crate::body::layout::Layout;
use crate::body::lent::planned::Analysis;
use crate::body::misfit::Misfit;
use crate::body::probe::Factor;
use crate::body::spectrum::Doubt;
use crate::linalg::Matrix;
use crate::ranks::{wire_struct, Token};

/// The fields of a `Factorised`, without its factor.
pub struct Made {
    order: usize,
    motions: usize,
    stiffness: Vec<f64>,
    rounding: f64,
    error: f64,
    fixing: Vec<usize>,
    gap: Option<f64>,
    softness: f64,
    doubt: Option<Doubt>,
    misfit: Option<Misfit>,
    entries: usize,
    is_rounded: bool,
    carried: usize,
    bytes_saved: usize,
    /// The analysis, if it is a further one.
    pub further: Option<(Arc<Layout>, Analysis)>,
    pub further_analyses: usize,
    pub factorisations: usize,
}

wire_struct!(Made {
    order,
    motions,
    stiffness,
    rounding,
    error,
    fixing,
    gap,
    softness,
    doubt,
    misfit,
    entries,
    is_rounded,
    carried,
    bytes_saved,
    further,
    further_analyses,
    factorisations,
});

impl Made {
    /// `is_further`: its analysis is not that of the plan.
    pub fn of(made: &Factorised, is_further: bool) -> Self {
        let of = &*made.symbolic;
        Self {
            further: is_further.then(|| (Arc::clone(&of.layout), of.into())),
            further_analyses: made.further_analyses,
            factorisations: made.factorisations,
            ..Self::of_shared(&made.inverse)
        }
    }

    /// Of a K+ with the factor of another.
    pub fn of_shared(kplus: &GeneralizedInverse) -> Self {
        Self {
            order: kplus.order(),
            motions: kplus.motions(),
            stiffness: kplus.stiffness.clone(),
            rounding: kplus.rounding,
            error: kplus.error,
            fixing: kplus.fixing.clone(),
            gap: kplus.gap,
            softness: kplus.softness,
            doubt: kplus.doubt,
            misfit: kplus.misfit,
            entries: kplus.entries(),
            is_rounded: kplus.is_rounded(),
            carried: kplus.carried_motions(),
            bytes_saved: kplus.bytes_saved(),
            further: None,
            further_analyses: 0,
            factorisations: 0,
        }
    }

    /// What stands for it on rank 0. `factor`: the name of the K+ whose factor it uses.
    pub fn at(self, kplus: Arc<Token>, factor: u64) -> GeneralizedInverse {
        let Self { order, motions, entries, is_rounded, carried, bytes_saved, .. } = self;
        let elsewhere = Elsewhere { kplus, factor, motions, entries, is_rounded, carried, bytes_saved };
        GeneralizedInverse {
            null_space: Matrix { rows: order, cols: 0, data: Vec::new() },
            stiffness: self.stiffness,
            rounding: self.rounding,
            error: self.error,
            fixing: self.fixing,
            gap: self.gap,
            softness: self.softness,
            doubt: self.doubt,
            misfit: self.misfit,
            factor: Factor::Elsewhere(elsewhere),
            carried: None,
            near: None,
        }
    }
}
