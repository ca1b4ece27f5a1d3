//! Carried unknowns x: those that rows hold far better than K, such as pilots with dummy stiffness. With them held, as in (14)-(15),
//! K+ is 0 there, and their motions are soft motions, as in [`soft`](crate::body::soft), with `R'D~R = I` and S = R'K R. Otherwise u
//! would be the difference of forces that nearly cancel, divided by a stiffness that means nothing.

use std::sync::Arc;

use crate::body::fixing::fixing_dofs;
use crate::body::generalized_inverse::GeneralizedInverse;
use crate::body::known::Known;
use crate::body::null_space::{DEPENDENT, ROUNDING};
use crate::body::plan::Plan;
use crate::body::probe::MOST_ROUNDING;
use crate::body::soft::{known_to_entries, soft_motions};
use crate::error::Result;
use crate::linalg::{Matrix, Multiple, Symmetric};

/// The carried unknowns of a body.
#[derive(Debug, Clone, PartialEq)]
pub struct Pilots {
    /// D~ of all unknowns, in the unit of K.
    pub metric: Arc<[f64]>,
    /// Ascending.
    pub carried: Arc<[usize]>,
}

impl Pilots {
    /// The motions of single unknowns, n x carried.
    fn motions(&self) -> Result<Matrix> {
        let mut motions = Matrix::zeros(self.metric.len(), self.carried.len())?;
        self.carried.iter().enumerate().for_each(|(j, &x)| motions.set(x, j, 1.0));
        Ok(motions)
    }

    /// Rows carry all unknowns: the null space of K need not be known.
    pub fn are_all(&self) -> bool {
        self.carried.len() == self.metric.len()
    }

    /// The plan if they are all unknowns.
    pub fn plan(self, k: Multiple) -> Result<Plan> {
        let none = Matrix::zeros(k.order(), 0)?;
        Plan::Known(Known::of(k, none, ROUNDING, Vec::new(), false)).with_pilots(Some(self))
    }

    /// K in the same pattern, with a unit spring for each of them in place of what couples them to other unknowns.
    pub(super) fn without(&self, k: &Multiple) -> Result<Multiple> {
        let is_carried = |i: usize| self.carried.binary_search(&i).is_ok();
        let mut rest = Symmetric::with_room(k.order(), k.matrix.col.len(), "a body without its pilots")?;
        for i in 0..k.order() {
            let carried = is_carried(i);
            let kept = |(j, v)| match carried || is_carried(j) {
                true => (j, f64::from(u8::from(i == j))),
                false => (j, v),
            };
            rest.push_row(k.lower_row(i).map(kept));
        }
        Ok(rest.into())
    }

    /// Adds their motions to those of K+, whose factor holds them. `are_null`: K does not resist the motions of K+.
    pub(super) fn lead(
        &self,
        mut inverse: GeneralizedInverse,
        k: &Multiple,
        are_null: bool,
    ) -> Result<GeneralizedInverse> {
        let metric = Some(&*self.metric);
        let (mut null, mut soft) = (inverse.null_space, self.motions()?);
        if !are_null {
            (0..soft.cols).for_each(|j| null.push_col(soft.col(j)));
            (null, soft) = (Matrix::zeros(null.rows, 0)?, null);
        }
        (inverse.null_space, inverse.stiffness) = soft_motions(&inverse.factor, (k, metric), null, soft)?;
        inverse.error = known_to_entries(&inverse.factor, k, &inverse.null_space)?;
        inverse.rounding = inverse.error.min(MOST_ROUNDING);
        Ok(inverse)
    }
}

impl Plan {
    /// Holds these unknowns as well.
    pub fn with_pilots(self, pilots: Option<Pilots>) -> Result<Self> {
        let Some(pilots) = pilots else { return Ok(self) };
        Ok(match self {
            Self::Known(known) => Self::Known(known.with_pilots(pilots)?),
            Self::Search(search) => Self::Search(search.with_pilots(pilots)?),
        })
    }
}

impl Known {
    /// The null vectors lose their values at these unknowns, and those that move nothing else are left out.
    fn with_pilots(mut self, pilots: Pilots) -> Result<Self> {
        let mut root = self.k.roots()?;
        pilots.carried.iter().for_each(|&x| root[x] = 0.0);
        let Matrix { rows, cols, .. } = self.null_space;
        let others = Matrix::from_fn(rows, cols, |i, j| root[i] * self.null_space.get(i, j))?;
        let others = others.orthonormalised(DEPENDENT);
        if others.cols < cols || pilots.carried.iter().any(|x| self.fixing.contains(x)) {
            (self.fixing, self.given) = (fixing_dofs(&others, &vec![1.0; rows])?, false);
        }
        let value = |i: usize, j: usize| if root[i] > 0.0 { others.get(i, j) / root[i] } else { 0.0 };
        self.null_space = Matrix::from_fn(rows, others.cols, value)?;
        self.fixing.extend(&*pilots.carried);
        Ok(Self { pilots: Some(pilots), ..self })
    }
}
