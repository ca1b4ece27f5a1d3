//! The part of the setup of K+ before the factorisation, from which the cost of the factorisation is known.

use std::sync::Arc;

use crate::body::candidates::{verified, Kernel};
use crate::body::fixing::{fixing_dofs, given_dofs};
use crate::body::generalized_inverse::{Factorised, GeneralizedInverse};
use crate::body::known::{Known, Retry};
use crate::body::layout::{Layout, Symbolic};
use crate::body::misfit::Misfit;
use crate::body::null_space::{Modes, NullSpaceInput, Verified};
use crate::body::pilots::Pilots;
use crate::body::rounded::Precision;
use crate::linalg::vector::NOISE;
use crate::numbers::body::{PROBE, RESISTED};

use crate::body::search::Search;
use crate::error::{Error, Kind, Result};
use crate::linalg::{Matrix, Multiple};
use crate::platform::memory::{headroom, PRODUCTS};
use crate::platform::slabs::Slabs;
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
        if input.modes == Modes::Soft && fixing.is_none() {
            let found = Kernel::of(&k, &input.vectors, RESISTED)?;
            if found.misfit().is_some() {
                let kept = NullSpaceInput { vectors: found.motions, modes: Modes::Soft };
                return Ok(Self::plan_all(k, &kept, tolerance, None)?.or_all_soft(input.clone()));
            }
        }
        Self::plan_all(k, input, tolerance, fixing)
    }

    /// As `plan_with`; soft motions that K resists like any other are not left out.
    fn plan_all(
        k: Multiple,
        input: &NullSpaceInput,
        tolerance: f64,
        fixing: Option<&[usize]>,
    ) -> Result<Plan> {
        let (root, given) = (k.roots()?, fixing.is_some());
        let Verified { basis: null_space, error, misfit } = verified(&k, input, tolerance)?;
        let fixing = match fixing {
            Some(given) => given_dofs(&null_space, &root, given)?,
            None => fixing_dofs(&null_space, &root)?,
        };
        let soft = input.modes == Modes::Soft;
        Ok(Plan::Known(Known { soft, misfit, ..Known::of(k, null_space, error, fixing, given) }))
    }

    /// The plan if nothing is known about the null space.
    pub fn search(k: Multiple, tolerance: f64, fixing: Option<&[usize]>) -> Result<Plan> {
        Search::new(k, tolerance, fixing).map(Plan::Search)
    }
}

impl Plan {
    /// The plan if rows carry all unknowns: the null space of K need not be known.
    pub fn of_pilots(k: Multiple, pilots: Pilots) -> Result<Self> {
        let none = Matrix::zeros(k.order(), 0)?;
        Self::Known(Known::of(k, none, NOISE, Vec::new(), false)).with_pilots(Some(pilots))
    }

    /// Holds these unknowns as well.
    pub fn with_pilots(self, pilots: Option<Pilots>) -> Result<Self> {
        let Some(pilots) = pilots else { return Ok(self) };
        Ok(match self {
            Self::Known(known) => Self::Known(known.with_pilots(pilots)?),
            Self::Search(search) => Self::Search(search.with_pilots(pilots)?),
        })
    }

    /// Searches the null space in K if K turns out to have more null vectors than planned, as in a piece with a hinge; those that the
    /// host has `told` are all, and motions that K hardly resists are soft, as the bending of a very slender body.
    pub fn or_search(self, tolerance: f64, told: bool) -> Self {
        match self {
            Self::Known(known) if known.retry.is_none() && !known.given => {
                let floats = told.then_some(known.null_space.cols);
                Self::Known(Known { retry: Some(Retry::Search { tolerance, fixing: None, floats }), ..known })
            }
            planned => planned,
        }
    }

    /// Takes all these motions as soft if K turns out to need them. Without soft motions left, K+ is that of any body.
    pub(super) fn or_all_soft(self, all: NullSpaceInput) -> Self {
        match self {
            Self::Known(known) => {
                let soft = known.null_space.cols > 0;
                Self::Known(Known { soft, retry: Some(Retry::AllSoft(all)), ..known })
            }
            planned => planned,
        }
    }

    /// Adds rigid motions that the coarse problem shall have, whether K resists them or not.
    pub fn carrying(self, rigid: Matrix) -> Self {
        match self {
            Self::Known(known) => Self::Known(Known { rigid: Some(rigid), ..known }),
            planned => planned,
        }
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

    /// Takes over the first of these layouts that is suitable, if any.
    pub fn follow_first<'l>(&mut self, layouts: impl Iterator<Item = &'l Layout>) -> Result<Option<usize>> {
        for (k, layout) in layouts.enumerate() {
            if self.follow(layout)? {
                return Ok(Some(k));
            }
        }
        Ok(None)
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

    /// The null space is known.
    pub fn is_known(&self) -> bool {
        matches!(self, Self::Known(_))
    }

    /// K, of the same bits wherever it is kept.
    pub fn matrix(&self) -> &Multiple {
        match self {
            Self::Known(known) => &known.k,
            Self::Search(search) => search.matrix(),
        }
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
            Self::Known(known) if other.gap.is_none() && other.own_motions() == known.fixing.len() => {
                let misfit = known.held();
                let Known { k, null_space, error, doubt, soft, pilots, rigid, .. } = known;
                let (rounding, stiffness) = (NOISE, Vec::new());
                let (carried, other) = (None, other.clone());
                let own = GeneralizedInverse {
                    null_space,
                    stiffness,
                    rounding,
                    error,
                    doubt,
                    misfit,
                    carried,
                    ..other
                };
                let mut own = own.judged_by(&k, soft, pilots.as_ref(), rigid.as_ref())?;
                own.find_near(&k)?;
                Ok(own)
            }
            Self::Known(_) | Self::Search(_) => Ok(other.clone()),
        }
    }

    /// As `execute`, with a factor of this precision if K allows it; one that is rounded is stored in `slabs`.
    pub fn execute_in(mut self, precision: Precision, slabs: &Slabs) -> Result<Factorised> {
        if let (Self::Known(known), Precision::Single) = (&mut self, precision) {
            known.single = true;
        }
        if precision != Precision::Rounded {
            return self.execute();
        }
        let k = self.matrix().clone();
        let made = self.execute()?;
        Ok(Factorised { inverse: made.inverse.rounded(&k, slabs)?, ..made })
    }

    /// Factorises and probes. If K has more null vectors than the coordinates gave, searches them in K.
    pub fn execute(mut self) -> Result<Factorised> {
        tally::costly();
        if self.symbolic().is_none() {
            let symbolic = self.analyse()?;
            self.set_analysis(symbolic);
        }
        match self {
            Self::Known(mut known) => {
                let (retry, k, pilots) = (known.retry.take(), known.k.clone(), known.pilots.clone());
                let (misfit, held) = (known.misfit, known.held().and_then(|misfit| misfit.held()));
                let most = match retry {
                    Some(Retry::AllSoft(_)) => known.null_space.cols,
                    _ => known.most_motions(),
                };
                let first = known.execute(most).map_err(|error| {
                    match held.filter(|_| error.kind == Kind::NullSpace) {
                        Some(held) => Error { what: format!("{}; {held}", error.what), ..error },
                        None => error,
                    }
                });
                match retry {
                    Some(retry) if retry.follows(&first, misfit) => retry.execute(k, misfit, pilots, first),
                    _ => first,
                }
            }
            Self::Search(search) => search.execute(),
        }
    }
}

impl Retry {
    /// Whether another way may succeed after this one: a K+ that is softer than `PROBE` needs motions declared soft that were left out. If
    /// all rigid motions fit, K is not the K of other coordinates.
    fn follows(&self, first: &Result<Factorised>, misfit: Option<Misfit>) -> bool {
        match first {
            Ok(made) => matches!(self, Self::AllSoft(_)) && made.inverse.softness < PROBE,
            Err(error) => match error.kind {
                Kind::NullSpace => true,
                Kind::Indefinite | Kind::Internal => {
                    !self.is_told() && misfit.is_none_or(|misfit| misfit.fit < misfit.of)
                }
                _ => false,
            },
        }
    }

    /// The host has told how many motions float.
    fn is_told(&self) -> bool {
        matches!(self, Self::Search { floats: Some(_), .. })
    }

    /// `first`: what came of the motions known.
    fn execute(
        self,
        k: Multiple,
        misfit: Option<Misfit>,
        pilots: Option<Pilots>,
        first: Result<Factorised>,
    ) -> Result<Factorised> {
        let mut told = None;
        let planned = match self {
            Self::Search { tolerance, fixing, floats } => {
                told = floats;
                let search = Search::new(k, tolerance, fixing.as_deref())?;
                Plan::Search(match misfit.filter(|_| told.is_none()) {
                    Some(misfit) => search.instead_of(misfit),
                    None => search,
                })
            }
            Self::AllSoft(NullSpaceInput { vectors, modes }) => {
                let vectors = Kernel::of(&k, &vectors, f64::INFINITY)?.motions;
                let input = NullSpaceInput { vectors, modes };
                GeneralizedInverse::plan_all(k, &input, f64::INFINITY, None)?
            }
        };
        match planned.with_pilots(pilots)?.execute() {
            Ok(made) if told.is_none_or(|floats| floats == made.inverse.floating()) => {
                Ok(Factorised { factorisations: made.factorisations + 1, ..made })
            }
            Err(error) if told.is_none() || !matches!(error.kind, Kind::NullSpace | Kind::Indefinite) => {
                Err(error)
            }
            _ => first,
        }
    }
}
