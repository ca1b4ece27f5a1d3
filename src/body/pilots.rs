//! Carried unknowns x: those that rows hold far better than K, such as pilots with dummy stiffness. With them held, as in (14)-(15),
//! K+ is 0 there, and their motions are soft motions, as in [`soft`](crate::body::soft), with `R'D~R = I` and S = R'K R. Otherwise u
//! would be the difference of forces that nearly cancel, divided by a stiffness that means nothing.

use std::sync::Arc;

use crate::error::Result;
use crate::linalg::{Matrix, Multiple, Symmetric};
use crate::platform::memory::zeros;
use crate::ranks::wire_struct;

/// What an island tells a body of its carried unknowns.
#[derive(Debug, Clone, PartialEq)]
pub struct Carried {
    /// Ascending.
    pub dofs: Arc<[usize]>,
    /// Their D~, in the unit of K.
    pub metric: Arc<[f64]>,
    /// Power of two by which D of the others is multiplied, and the metric of those without stiffness, in the unit of K.
    pub scale: f64,
    pub without: f64,
}

wire_struct!(Carried { dofs, metric, scale, without });

/// The carried unknowns of a body.
#[derive(Debug, Clone)]
pub struct Pilots {
    /// D~ of all unknowns, in the unit of K.
    pub metric: Arc<[f64]>,
    /// Ascending.
    pub carried: Arc<[usize]>,
}

impl Pilots {
    /// Of a body with this K.
    pub fn of(Carried { dofs, metric, scale, without }: &Carried, k: &Symmetric) -> Result<Self> {
        let mut all = zeros(k.order(), "the metric of a body")?;
        let own = |i: usize| Some(k.metric(i, 0.0)).filter(|d| *d > 0.0).map_or(*without, |d| d * scale);
        all.iter_mut().enumerate().for_each(|(i, d)| *d = own(i).min(f64::MAX));
        dofs.iter().zip(&**metric).for_each(|(dof, d)| all[*dof] = *d);
        Ok(Self { metric: all.into(), carried: Arc::clone(dofs) })
    }

    /// The motions of single unknowns, n x carried.
    pub(super) fn motions(&self) -> Result<Matrix> {
        let mut motions = Matrix::zeros(self.metric.len(), self.carried.len())?;
        self.carried.iter().enumerate().for_each(|(j, &x)| motions.set(x, j, 1.0));
        Ok(motions)
    }

    /// Rows carry all unknowns: the null space of K need not be known.
    pub fn are_all(&self) -> bool {
        self.carried.len() == self.metric.len()
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
}
