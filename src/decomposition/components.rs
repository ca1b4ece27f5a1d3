//! The connected components of stiffness matrices. No entry of K joins two of them, so each is a body of its own; only
//! the rounding of directions, which is no stiffness, is left out.

use std::sync::Arc;

use crate::error::Result;
use crate::linalg::graph::joined;
use crate::linalg::vector::NOISE;
use crate::linalg::Symmetric;
use crate::model::HostModel;
use crate::platform::memory::{filled, headroom, reserved};
use crate::platform::threads;

const WHAT: &str = "the connected parts of a body";
/// Bytes of labels and lists, per unknown.
const PER_DOF: usize = 3 * size_of::<usize>();

/// The components of a matrix.
pub struct Components {
    /// Component of every unknown, numbered by first unknowns.
    pub of: Vec<usize>,
    pub count: usize,
    /// Unknowns with a stiffness that is only rounding, each a component without stiffness; empty if there are none.
    slight: Vec<bool>,
}

/// A component: its unknowns within the matrix, ascending, and its block.
pub struct Component {
    pub dofs: Arc<[u32]>,
    pub stiffness: Symmetric,
}

impl Components {
    /// None if the matrix is connected.
    pub fn of(k: &Symmetric) -> Result<Option<Self>> {
        Self::all(k).map(|found| (found.count > 1).then_some(found))
    }

    /// Entries that are 0 connect nothing.
    pub fn all(k: &Symmetric) -> Result<Self> {
        let _room = headroom(k.order() * PER_DOF, WHAT)?;
        let slight = slight(k)?;
        let is_own = |i: usize| slight.get(i) == Some(&true);
        let row = |i: usize| {
            let joined = k.lower_row(i).filter(move |&(j, v)| v != 0.0 && !is_own(i) && !is_own(j));
            std::iter::once(i).chain(joined.map(|entry| entry.0))
        };
        let (of, count) = joined(k.order(), (0..k.order()).map(row));
        Ok(Self { of, count, slight })
    }

    fn is_slight(&self, i: usize) -> bool {
        self.slight.get(i) == Some(&true)
    }

    /// Unknowns without any stiffness, ascending.
    pub fn empty<'a>(&'a self, k: &'a Symmetric) -> Result<impl Iterator<Item = usize> + 'a> {
        let mut members = filled(self.count, 0u32, WHAT)?;
        self.of.iter().for_each(|&c| members[c] += 1);
        let is_stiff = |i: usize| k.diagonal(i) != 0.0 && !self.is_slight(i);
        Ok((0..self.of.len()).filter(move |&i| members[self.of[i]] == 1 && !is_stiff(i)))
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
            let given = if self.is_slight(i) { 0.0 } else { 1.0 };
            matrix.push_row(own(i).map(|(j, v)| (place[j] as usize, given * v)));
        }
        let kept = blocks.into_iter().filter(|(dofs, _)| !dofs.is_empty());
        Ok(kept.map(|(dofs, stiffness): (Vec<u32>, _)| Component { dofs: dofs.into(), stiffness }).collect())
    }
}

/// Unknowns that K resists only by the rounding of directions, as a bar along (6e-17, 1) resists what moves across it,
/// with 4e-33: `K_ij` is rounding of `K_jj`, `K_ii` is rounding of `K_ij`, and K need not be indefinite for it, as it is
/// with a Lagrange multiplier. No other entry may join such an unknown to one that has stiffness. Empty if there are
/// none.
pub fn slight(k: &Symmetric) -> Result<Vec<bool>> {
    let entries = || {
        let row = |i: usize| k.lower_row(i).filter(move |&(j, v)| j < i && v != 0.0);
        (0..k.order()).flat_map(move |i| row(i).map(move |(j, v)| (i, j, v.abs())))
    };
    let is_noticed = |v: f64, j: usize| v > NOISE * k.diagonal(j);
    let mut slight = Vec::new();
    // K_ii <= N K_ij and K_ij^2 <= 2 K_ii K_jj allow no more than K_ii <= 2 N^2 K_jj: nearly every K has no such pair
    let stiff = (0..k.order()).map(|i| k.diagonal(i)).filter(|k| *k > 0.0);
    let (least, most) = stiff.fold((f64::INFINITY, 0.0f64), |(least, most), k| (least.min(k), most.max(k)));
    if least > 4.0 * NOISE * NOISE * most {
        return Ok(slight);
    }
    for (a, b, v) in entries() {
        for (i, j) in [(a, b), (b, a)] {
            let [own, other] = [i, j].map(|of| k.diagonal(of));
            if 0.0 < own && own <= NOISE * v && 0.0 < other && v / other <= 2.0 * own / v {
                if slight.is_empty() {
                    slight = filled(k.order(), false, WHAT)?;
                }
                slight[i] = true;
            }
        }
    }
    if slight.is_empty() {
        return Ok(slight);
    }
    let joins = |i: usize, j: usize, v: f64| !slight[i] || is_noticed(v, j);
    let joining = entries().filter(|&(i, j, v)| joins(i, j, v) && joins(j, i, v));
    let (of, count) = joined(k.order(), joining.map(|(i, j, _)| [i, j].into_iter()));
    let mut are_slight = filled(count, true, WHAT)?;
    of.iter().zip(&slight).for_each(|(&c, slight)| are_slight[c] &= *slight);
    slight.iter_mut().zip(of).for_each(|(slight, c)| *slight = are_slight[c]);
    Ok(slight)
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
    pub fn follow(&mut self, host: &HostModel) -> Result<()> {
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
