//! The part of the setup of K+ before the factorisation, from which the cost of the factorisation is known.

use std::sync::Arc;

use crate::body::fixing::{fixing_dofs, given_dofs};
use crate::body::generalized_inverse::{Factorised, GeneralizedInverse, Layout, Symbolic};
use crate::body::known::{Known, Retry};
use crate::body::null_space::{
    one_column_each, verified, Modes, NullSpaceInput, Verified, ROUNDING as KNOWN,
};
use crate::body::rigid_modes::RigidModes;
use crate::body::search::Search;
use crate::error::{Error, Kind, Result};
use crate::linalg::Multiple;
use crate::platform::memory::{headroom, PRODUCTS};
use crate::platform::tally;

/// How K+ will be computed.
pub enum Plan {
    Known(Known),
    Search(Search),
}

impl GeneralizedInverse {
    /// Plan for the null space `input` of `k` (a multiple with its largest diagonal entry in [1, 2)).
    pub fn plan(k: Multiple, input: &NullSpaceInput, tolerance: f64) -> Result<Plan> {
        Self::plan_with(k, input, tolerance, None)
    }

    /// As `plan`, with the dofs to hold in K+ if the host has given them.
    pub fn plan_with(
        k: Multiple,
        input: &NullSpaceInput,
        tolerance: f64,
        fixing: Option<&[usize]>,
    ) -> Result<Plan> {
        let per_dof = (8 * input.vectors.cols + 24) * size_of::<f64>();
        let _room = headroom(k.order() * per_dof + PRODUCTS, "the null space of a body")?;
        let (root, given) = (k.roots()?, fixing.is_some());
        let Verified { basis: null_space, error } = verified(&k, input, tolerance)?;
        let fixing = match fixing {
            Some(given) => given_dofs(&null_space, &root, given)?,
            None => fixing_dofs(&null_space, &root)?,
        };
        let soft = input.modes == Modes::Soft;
        Ok(Plan::Known(Known { soft, ..Known::of(k, null_space, error, fixing, given) }))
    }

    /// The plan if nothing is known about the null space.
    pub fn search(k: Multiple, tolerance: f64, fixing: Option<&[usize]>) -> Result<Plan> {
        Search::new(k, tolerance, fixing).map(Plan::Search)
    }
}

impl Plan {
    /// Searches the null space in K if K turns out to have more null vectors than planned, as in a piece with a hinge.
    pub fn or_search(self, tolerance: f64) -> Self {
        match self {
            Self::Known(known) if known.retry.is_none() => {
                Self::Known(Known { retry: Some(Retry { misfit: None, tolerance, fixing: None }), ..known })
            }
            planned => planned,
        }
    }

    /// Adds rigid motions that the coarse problem shall have, whether K resists them or not.
    pub fn carrying(self, rigid: &RigidModes) -> Result<Self> {
        Ok(match self {
            Self::Known(known) => {
                Self::Known(Known { rigid: Some(one_column_each(&rigid.modes, &rigid.parts())?), ..known })
            }
            planned => planned,
        })
    }

    /// Takes over the layout of another body with the same pattern, or of this body with other values, if it is suitable.
    /// Returns whether it did; `set_analysis` must then provide the analysis.
    pub fn follow(&mut self, layout: &Layout) -> Result<bool> {
        match (self, layout) {
            (Self::Known(known), Layout::Held(dofs)) => known.follow(dofs),
            (Self::Search(search), layout) => Ok(*search.layout == *layout),
            _ => Ok(false),
        }
    }

    /// The input of the analysis besides the pattern of K.
    pub fn layout(&self) -> Arc<Layout> {
        match self {
            Self::Known(known) => Arc::new(Layout::Held(known.fixing.clone())),
            Self::Search(search) => Arc::clone(&search.layout),
        }
    }

    /// The symbolic analysis for the layout.
    pub fn analyse(&self) -> Result<Arc<Symbolic>> {
        let analysis = match self {
            Self::Known(known) => known.analyse()?,
            Self::Search(search) => search.analyse()?,
        };
        Ok(Arc::new(Symbolic { layout: self.layout(), analysis }))
    }

    /// Sets the analysis for the layout, made here or for another body.
    pub fn set_analysis(&mut self, symbolic: Arc<Symbolic>) {
        match self {
            Self::Known(known) => known.symbolic = Some(symbolic),
            Self::Search(search) => search.symbolic = Some(symbolic),
        }
    }

    /// The analysis, if already made.
    pub fn symbolic(&self) -> Option<&Arc<Symbolic>> {
        match self {
            Self::Known(known) => known.symbolic.as_ref(),
            Self::Search(search) => search.symbolic.as_ref(),
        }
    }

    /// Bytes of the factorisation; known after the analysis.
    pub fn bytes(&self) -> usize {
        self.symbolic().map_or(0, |symbolic| symbolic.analysis.bytes())
    }

    /// K+ with the already probed factor of an equal matrix with the same dofs held. Uses the null space of the plan,
    /// unless the null space of `other` was found in K or includes further motions.
    pub fn with_factor_of(self, other: &GeneralizedInverse) -> Result<GeneralizedInverse> {
        match self {
            Self::Known(Known { k, null_space, error, doubt, soft, rigid, .. })
                if other.gap.is_none() && other.own_motions() == null_space.cols =>
            {
                let doubts = doubt.into_iter().collect();
                let (rounding, stiffness) = (KNOWN, Vec::new());
                let (carried, other) = (None, other.clone());
                let own =
                    GeneralizedInverse { null_space, stiffness, rounding, error, doubts, carried, ..other };
                let mut own = own.judged_by(&k, soft, rigid.as_ref())?;
                own.find_near(&k)?;
                Ok(own)
            }
            Self::Known(_) | Self::Search(_) => Ok(other.clone()),
        }
    }

    /// Factorises and probes. If K has more null vectors than the coordinates gave, searches them in K.
    pub fn execute(mut self) -> Result<Factorised> {
        tally::costly();
        if self.symbolic().is_none() {
            let symbolic = self.analyse()?;
            self.set_analysis(symbolic);
        }
        match self {
            Self::Known(mut known) => match known.retry.take() {
                None => known.execute(),
                Some(retry) => {
                    let k = known.k.clone();
                    known.execute().or_else(|error| sought(k, retry, error))
                }
            },
            Self::Search(search) => search.execute(),
        }
    }
}

/// Searches the null space in K after `error`.
fn sought(k: Multiple, retry: Retry, error: Error) -> Result<Factorised> {
    if !matches!(error.kind, Kind::NullSpace | Kind::Indefinite | Kind::Internal) {
        return Err(error);
    }
    let Retry { misfit, tolerance, fixing } = retry;
    let search = Search::new(k, tolerance, fixing.as_deref())?;
    let search = match misfit {
        Some(misfit) => search.instead_of(misfit),
        None => search,
    };
    let mut made = search.execute()?;
    made.factorisations += 1;
    Ok(made)
}
