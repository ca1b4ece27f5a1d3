//! The connected components of stiffness matrices. No entry of K joins two of them, so each is a body of its own.

use std::sync::Arc;

use crate::error::Result;
use crate::linalg::graph::components;
use crate::linalg::Symmetric;
use crate::model::Model;
use crate::platform::memory::{filled, headroom, reserved};
use crate::platform::threads;

const WHAT: &str = "the connected parts of a body";
/// Bytes of labels and lists, per unknown.
const PER_DOF: usize = 3 * size_of::<usize>();

/// A matrix of several components.
pub struct Components {
    /// Component of every unknown, numbered by first unknowns.
    of: Vec<usize>,
    pub count: usize,
}

/// A component: its unknowns within the matrix, ascending, and its block.
pub struct Component {
    pub dofs: Arc<[u32]>,
    pub stiffness: Symmetric,
}

impl Components {
    /// None if the matrix is connected.
    pub fn of(k: &Symmetric) -> Result<Option<Self>> {
        let _room = headroom(k.order() * PER_DOF, WHAT)?;
        let (of, count) = components(k);
        Ok((count > 1).then_some(Self { of, count }))
    }

    /// Unknowns without any stiffness, ascending.
    pub fn empty<'a>(&'a self, k: &'a Symmetric) -> Result<impl Iterator<Item = usize> + 'a> {
        let mut members = filled(self.count, 0u32, WHAT)?;
        self.of.iter().for_each(|&c| members[c] += 1);
        Ok((0..self.of.len()).filter(move |&i| members[self.of[i]] == 1 && k.diagonal(i) == 0.0))
    }

    /// The components of k, except those of which `leave_out` names the first unknown.
    pub fn blocks(&self, k: &Symmetric, leave_out: impl Fn(usize) -> bool) -> Result<Vec<Component>> {
        let (n, of) = (k.order(), &self.of);
        let (mut sizes, mut left_out) = (filled(self.count, (0, 0), WHAT)?, filled(self.count, None, WHAT)?);
        let mut place = filled(n, 0u32, WHAT)?;
        let own = |i: usize| k.lower_row(i).filter(move |entry| of[entry.0] == of[i]);
        for i in 0..n {
            let c = of[i];
            let out = *left_out[c].get_or_insert_with(|| leave_out(i));
            place[i] = sizes[c].0 as u32;
            if !out {
                sizes[c] = (sizes[c].0 + 1, sizes[c].1 + own(i).count());
            }
        }
        let mut blocks = reserved(self.count, WHAT)?;
        for &(dofs, entries) in &sizes {
            let matrix = Symmetric::with_room(dofs, entries, WHAT)?;
            blocks.push((reserved(dofs, WHAT)?, matrix));
        }
        for i in (0..n).filter(|&i| left_out[of[i]] == Some(false)) {
            let (dofs, matrix) = &mut blocks[of[i]];
            dofs.push(i as u32);
            matrix.push_row(own(i).map(|(j, v)| (place[j] as usize, v)));
        }
        let kept = blocks.into_iter().filter(|(dofs, _)| !dofs.is_empty());
        Ok(kept.map(|(dofs, stiffness): (Vec<u32>, _)| Component { dofs: dofs.into(), stiffness }).collect())
    }
}

/// The components of all bodies that are given by one matrix, each found once for every K.
#[derive(Default)]
pub struct Connected {
    bodies: Vec<Found>,
}

#[derive(Default)]
struct Found {
    /// Revision of K.
    of: Option<u64>,
    components: Option<Arc<Components>>,
}

impl Connected {
    /// Finds the components of the matrices that have changed.
    pub fn follow(&mut self, host: &Model) -> Result<()> {
        self.bodies.resize_with(host.bodies.len(), Found::default);
        let changed = |&p: &usize| self.bodies[p].of != Some(host.bodies[p].revisions.stiffness);
        let changed: Vec<usize> = (0..self.bodies.len()).filter(changed).collect();
        let found = threads::run(host.threads(), changed.len(), |k| {
            let stiffness = host.bodies[changed[k]].body.stiffness.as_deref();
            stiffness.map(Components::of).transpose().map_err(|e| e.body(changed[k]))
        })?;
        for (p, components) in changed.into_iter().zip(found) {
            let components = components.flatten().map(Arc::new);
            self.bodies[p] = Found { of: Some(host.bodies[p].revisions.stiffness), components };
        }
        Ok(())
    }

    /// None if the matrix of the body is connected, or the body has none.
    pub fn components(&self, body: usize) -> Option<&Arc<Components>> {
        self.bodies.get(body)?.components.as_ref()
    }

    pub fn all_connected(&self) -> bool {
        self.bodies.iter().all(|found| found.components.is_none())
    }
}
