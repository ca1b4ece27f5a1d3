//! The bodies of the host to which the parts of a model belong. A part is a connected component of the K of a body, or a
//! piece of a body that is cut.

use std::ops::Range;
use std::sync::Arc;

use crate::body::Assembled;
use crate::error::Result;
use crate::platform::memory::zeros;

const WHAT: &str = "the parts of bodies";

/// The bodies of the host, the parts that represent them, and the unknowns of the parts.
#[derive(Debug, Default)]
pub struct Parts {
    /// First part of every body of the host, and the total number of parts.
    pub first: Vec<usize>,
    /// First unknown of every body of the host, and their end.
    pub offsets: Vec<usize>,
    /// First unknown of every part, and their end.
    pub starts: Vec<usize>,
    pub parts: Vec<Part>,
    /// Numbers within their bodies of the unknowns of parts that are not whole bodies; within a part they ascend.
    pub dofs: Vec<u32>,
    /// Weight of the parts at their unknowns (the weights of all copies sum to 1); beyond its end they have the only copies.
    pub shares: Vec<f64>,
    /// K of the bodies that are cut.
    pub assembled: Vec<Option<Arc<Assembled>>>,
    /// Unknowns without stiffness, row and load, in no part, among all unknowns of the host: their displacement is 0.
    pub loose: Vec<usize>,
    /// Number of the host's equality rows: later rows are glue, those of joints first.
    pub equalities: usize,
    /// For each row that glues two bodies of the host: the number of the host that their unknowns share.
    pub joints: Vec<usize>,
}

/// One part.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Part {
    /// Body of the host.
    pub body: usize,
    /// Number of the piece of the body that it belongs to, if the body is cut.
    pub piece: u32,
    /// It is the body.
    pub whole: bool,
    /// Place of its first unknown in `dofs`, if it is not.
    pub first: usize,
}

/// Two unknowns that move together.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Joint {
    /// Their number.
    pub number: usize,
    /// Their positions among the unknowns of all bodies one after the other, ascending.
    pub ends: [usize; 2],
}

impl Parts {
    /// Parts of a body of the host.
    pub fn of(&self, body: usize) -> Range<usize> {
        self.first[body]..self.first[body + 1]
    }

    /// Number of equality rows by which answers are judged, including joints: later rows glue pieces.
    pub fn judged(&self) -> usize {
        self.equalities + self.joints.len()
    }

    /// Whether the body of the host is cut.
    pub fn is_cut(&self, body: usize) -> bool {
        self.assembled[body].is_some()
    }

    /// Number of unknown i of a part within its body, and the weight of the part there.
    pub fn place(&self, part: usize, i: usize) -> (usize, f64) {
        let Part { whole, first, .. } = self.parts[part];
        let dof = if whole { i } else { self.dofs[first + i] as usize };
        (dof, self.shares.get(self.starts[part] + i).copied().unwrap_or(1.0))
    }

    /// The unknowns of a part within its body, ascending; none if it has all.
    pub fn listed(&self, part: usize) -> Option<&[u32]> {
        let Part { whole, first, .. } = self.parts[part];
        (!whole).then(|| &self.dofs[first..first + self.starts[part + 1] - self.starts[part]])
    }

    /// The unknowns of a part within its body, ascending.
    pub fn dofs_of(&self, part: usize) -> impl Iterator<Item = usize> + '_ {
        (0..self.starts[part + 1] - self.starts[part]).map(move |i| self.place(part, i).0)
    }

    /// The only part of a body, if it has all unknowns of the body.
    pub fn only(&self, body: usize) -> Option<usize> {
        let first = self.first[body];
        self.parts[first].whole.then_some(first)
    }

    /// Whether the parts of both models are the same unknowns.
    pub fn same(&self, other: &Self) -> bool {
        let same = |parts: &Self| parts.parts.iter().map(|part| part.whole).collect::<Vec<_>>();
        let of = |parts: &Self| (same(parts), [&parts.first, &parts.starts].map(Clone::clone));
        of(self) == of(other) && self.dofs == other.dofs
    }

    /// The values of a part from values over the unknowns of its body.
    pub fn gather<'a>(&'a self, part: usize, of_body: &'a [f64]) -> impl Iterator<Item = f64> + 'a {
        self.dofs_of(part).map(|dof| of_body[dof])
    }

    /// The weighted mean of the copies, over the unknowns of the host's bodies.
    pub fn mean(&self, of_parts: &[f64]) -> Result<Vec<f64>> {
        self.mean_from(of_parts, (&self.starts, &self.offsets))
    }

    /// As `mean`, with the first values of parts and of bodies in these vectors, and their ends; parts that stay on other ranks have none.
    pub fn mean_from(&self, of_parts: &[f64], (starts, offsets): (&[usize], &[usize])) -> Result<Vec<f64>> {
        let mut all = zeros(offsets.last().copied().unwrap_or(0), WHAT)?;
        for part in 0..self.parts.len() {
            let offset = offsets[self.parts[part].body];
            for (i, v) in of_parts[starts[part]..starts[part + 1]].iter().enumerate() {
                let (dof, share) = self.place(part, i);
                all[offset + dof] += share * v;
            }
        }
        Ok(all)
    }
}
