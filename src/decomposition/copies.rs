//! The copies of a body's unknowns in its pieces.

use crate::error::Result;
use crate::model::{Model, Parts};
use crate::platform::memory::filled;

const WHAT: &str = "the copies of unknowns";
/// A copy with less than this part of the stiffness of the stiffest one takes no row of the host.
const SLACK: f64 = 1e-3;

/// For every unknown of a body that is cut its copies.
pub struct Copies {
    ptr: Vec<usize>,
    /// The part, and the unknown among all unknowns of all parts; by parts.
    copies: Vec<(u32, usize)>,
}

impl Copies {
    /// None of a body that is whole.
    pub fn of(host: &Model, parts: &Parts, body: usize) -> Result<Option<Self>> {
        if !parts.is_cut(body) {
            return Ok(None);
        }
        let order = host.bodies[body].body.order;
        let mut ptr = filled(order + 1, 0, WHAT)?;
        let dofs = |part: usize| parts.parts[part].piece.iter().flat_map(|(dofs, _)| dofs.iter());
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

    /// Parts and places of the copies of an unknown.
    pub fn all(&self, dof: usize) -> &[(u32, usize)] {
        &self.copies[self.ptr[dof]..self.ptr[dof + 1]]
    }

    /// Number of unknowns of the body.
    pub fn order(&self) -> usize {
        self.ptr.len() - 1
    }

    /// The place that rows of the host act on: the first copy that is not much softer than another. One node has one part then.
    pub fn first_stiff(&self, parts: &Parts, dof: usize) -> usize {
        let share =
            |(part, place): (u32, usize)| parts.place(part as usize, place - parts.starts[part as usize]).1;
        let all = self.all(dof);
        let most = all.iter().map(|copy| share(*copy)).fold(0.0, f64::max);
        all.iter().find(|copy| share(**copy) >= SLACK * most).map_or(0, |copy| copy.1)
    }
}
