//! The copies of a body's unknowns in its parts.

use crate::error::Result;
use crate::model::{HostModel, Parts};
use crate::numbers::rows::SLACK;
use crate::platform::memory::filled;

const WHAT: &str = "the copies of unknowns";

/// The copies of every unknown of a body with several parts.
pub struct Copies {
    ptr: Vec<usize>,
    /// The part, and the unknown's number in it; in the order of the parts.
    copies: Vec<(u32, u32)>,
}

impl Copies {
    /// None for a body that is its only part.
    pub fn of(host: &HostModel, parts: &Parts, body: usize) -> Result<Option<Self>> {
        if parts.only(body).is_some() {
            return Ok(None);
        }
        let order = host.bodies[body].body.order;
        let mut ptr = filled(order + 1, 0, WHAT)?;
        parts.of(body).flat_map(|part| parts.dofs_of(part)).for_each(|dof| ptr[dof + 1] += 1);
        (0..order).for_each(|dof| ptr[dof + 1] += ptr[dof]);
        let (mut next, mut copies) = (ptr.clone(), filled(ptr[order], (0, 0), WHAT)?);
        for part in parts.of(body) {
            for (i, dof) in parts.dofs_of(part).enumerate() {
                copies[next[dof]] = (part as u32, i as u32);
                next[dof] += 1;
            }
        }
        Ok(Some(Self { ptr, copies }))
    }

    /// Parts of the copies of an unknown, and the copies' numbers in them.
    pub fn all(&self, dof: usize) -> impl Iterator<Item = (usize, usize)> + '_ {
        let copies = &self.copies[self.ptr[dof]..self.ptr[dof + 1]];
        copies.iter().map(|&(part, i)| (part as usize, i as usize))
    }

    /// Number of unknowns of the body.
    pub fn order(&self) -> usize {
        self.ptr.len() - 1
    }

    /// The copy on which rows of the host act: the first that is not much softer than another, so all unknowns of a node
    /// get the same part.
    pub fn first_stiff(&self, parts: &Parts, dof: usize) -> usize {
        let share = |(part, i): (usize, usize)| parts.place(part, i).1;
        let most = self.all(dof).map(share).fold(0.0, f64::max);
        let stiff = self.all(dof).find(|copy| share(*copy) >= SLACK * most);
        stiff.map_or(0, |(part, i)| parts.starts[part] + i)
    }
}
