//! The copies of a body's unknowns in its parts.

use crate::error::Result;
use crate::model::{Model, Parts};
use crate::platform::memory::filled;

const WHAT: &str = "the copies of unknowns";
/// Rows of the host do not act on a copy with less than this part of the stiffness of the stiffest copy.
const SLACK: f64 = 1e-3;

/// The copies of every unknown of a body with several parts.
pub struct Copies {
    ptr: Vec<usize>,
    /// The part, and the unknown's number among all unknowns of all parts; in the order of the parts.
    copies: Vec<(u32, usize)>,
}

impl Copies {
    /// None for a body that is its only part.
    pub fn of(host: &Model, parts: &Parts, body: usize) -> Result<Option<Self>> {
        if parts.only(body).is_some() {
            return Ok(None);
        }
        let order = host.bodies[body].body.order;
        let mut ptr = filled(order + 1, 0, WHAT)?;
        let dofs = |part: usize| parts.parts[part].dofs.iter().flat_map(|dofs| dofs.iter());
        parts.of(body).flat_map(dofs).for_each(|&dof| ptr[dof as usize + 1] += 1);
        (0..order).for_each(|dof| ptr[dof + 1] += ptr[dof]);
        let (mut next, mut copies) = (ptr.clone(), filled(ptr[order], (0, 0), WHAT)?);
        for part in parts.of(body) {
            for (i, &dof) in dofs(part).enumerate() {
                copies[next[dof as usize]] = (part as u32, parts.starts[part] + i);
                next[dof as usize] += 1;
            }
        }
        Ok(Some(Self { ptr, copies }))
    }

    /// Parts and unknowns of the copies of an unknown.
    pub fn all(&self, dof: usize) -> &[(u32, usize)] {
        &self.copies[self.ptr[dof]..self.ptr[dof + 1]]
    }

    /// Number of unknowns of the body.
    pub fn order(&self) -> usize {
        self.ptr.len() - 1
    }

    /// The copy on which rows of the host act: the first that is not much softer than another, so all unknowns of a node
    /// get the same part.
    pub fn first_stiff(&self, parts: &Parts, dof: usize) -> usize {
        let share =
            |(part, place): (u32, usize)| parts.place(part as usize, place - parts.starts[part as usize]).1;
        let all = self.all(dof);
        let most = all.iter().map(|copy| share(*copy)).fold(0.0, f64::max);
        all.iter().find(|copy| share(**copy) >= SLACK * most).map_or(0, |copy| copy.1)
    }
}
