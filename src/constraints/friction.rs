//! Contact nodes with friction: a normal row, one or two tangential rows, a coefficient and a bound.

mod factors;

pub use factors::{entries, Entries};

use std::ops::Range;
use std::sync::Arc;

use crate::constraints::friction::factors::{check_factors, ratio};
use crate::constraints::{RowKind, RowSet, RowsInput};
use crate::error::{Error, Result, INDEX};
use crate::linalg::vector::{first_non_finite, NOISE};
use crate::linalg::Csr;
use crate::numbers::rows::FACTORS;
use crate::platform::memory::filled;

/// The law of one node: `|lambda_t| <= bound + coefficient x lambda_n`.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct FrictionNode {
    /// Its contact row; without one, only the bound limits the force.
    pub normal: Option<usize>,
    /// The first of its tangential rows, and their number.
    pub first: usize,
    pub count: usize,
    /// mu >= 0, no unit.
    pub coefficient: f64,
    /// Constant part of the limit, force >= 0.
    pub bound: f64,
}

impl FrictionNode {
    /// Its tangential rows.
    pub fn rows(&self) -> Range<usize> {
        self.first..self.first + self.count
    }

    /// Whether the node has a positive bound, or a positive coefficient and a contact row.
    pub fn has_friction(&self) -> bool {
        self.bound > 0.0 || (self.coefficient > 0.0 && self.normal.is_some())
    }

    /// `bound + coefficient x lambda_n`, force, for the forces of all contact rows.
    pub fn limit(&self, lambda: &[f64]) -> f64 {
        let normal = self.normal.map_or(0.0, |row| lambda[row].max(0.0));
        self.bound + if normal > 0.0 { self.coefficient * normal } else { 0.0 }
    }
}

/// All nodes with friction; node i has the tangential rows `i x dim` to `(i + 1) x dim`.
#[derive(Debug, Default)]
pub struct Friction {
    /// Tangential rows of a node: 1 in the plane, 2 in space; 0 without nodes.
    pub dim: usize,
    pub nodes: Vec<FrictionNode>,
    /// T, with s_old as right-hand sides and C_t as compliances, equal for all rows of a node. `open_gap` is minus the
    /// slip: `-s = s_old + C_t lambda_t - T u`.
    pub rows: RowSet,
}

/// Nodes as given; `rows`: the tangential rows, dim per node, without right-hand sides.
#[derive(Debug, Clone, Copy)]
pub struct FrictionInput<'a> {
    pub dim: usize,
    /// Contact row of each node, counting from 0; -1: none.
    pub normal: &'a [i64],
    pub rows: RowsInput<'a>,
    /// Zeros when absent.
    pub coefficient: Option<&'a [f64]>,
    /// Force; zeros when absent.
    pub bound: Option<&'a [f64]>,
}

impl Friction {
    pub fn len(&self) -> usize {
        self.nodes.len()
    }

    /// The node may carry a tangential force: it has a bound, or its contact row may close.
    pub fn acts(&self, node: usize, contact: &RowSet) -> bool {
        let FrictionNode { normal, bound, .. } = self.nodes[node];
        bound > 0.0 || normal.is_some_and(|row| contact.is_finite(row))
    }

    /// Rows and compliances equal those of the other, and the same nodes and rows, with the same contact rows, may carry a force.
    pub fn same_but_law(&self, contact: &RowSet, other: &Self, other_contact: &RowSet) -> bool {
        let node = |k: usize| {
            self.nodes[k].normal == other.nodes[k].normal
                && self.acts(k, contact) == other.acts(k, other_contact)
        };
        let counts = (self.dim, self.len()) == (other.dim, other.len());
        let row = |i: usize| self.counts(i) == other.counts(i);
        counts
            && self.rows.same_but_rhs(&other.rows)
            && (0..self.len()).all(node)
            && (0..self.rows.len()).all(row)
    }

    /// Tangential row i has entries, or slips by its s_old alone and takes its part of the node's force.
    pub fn counts(&self, i: usize) -> bool {
        !self.rows.is_empty_row(i) || self.rows.rhs[i] != 0.0
    }

    /// `T u - C_t lambda_t`, length, (dim, nodes): the s_old for which the answer has no slip.
    pub fn reached(&self, u: impl Fn(usize) -> f64, tangential: &[f64]) -> Result<Vec<f64>> {
        let mut rows = self.rows.copied("friction")?;
        rows.rhs.fill(0.0);
        Ok((0..rows.len()).map(|i| 0.0 - rows.open_gap_at(i, &u, tangential[i])).collect())
    }

    /// The ratio of the lengths of a node's rows, if it is too large for one factor, or supports have taken entries.
    pub fn unequal(&self, node: usize, contact: &RowSet) -> Option<f64> {
        let FrictionNode { normal, .. } = self.nodes[node];
        let own = self.nodes[node].rows().map(|i| entries(&self.rows, i));
        let ratio = ratio(&mut own.chain(normal.map(|row| entries(contact, row))).collect());
        (ratio > FACTORS).then_some(ratio)
    }

    /// A copy that shares the entries of the rows; `what` names it in errors.
    pub fn copied(&self, what: &str) -> Result<Self> {
        Ok(Self { dim: self.dim, nodes: self.nodes.clone(), rows: self.rows.copied(what)? })
    }

    /// Drops all nodes but the first `count`.
    pub fn keep_first(&mut self, count: usize) {
        self.nodes.truncate(count);
        self.dim = if count > 0 { self.dim } else { 0 };
        self.rows.keep_first(count * self.dim);
    }

    /// Appends nodes; returns the number of the first. An error changes nothing.
    pub fn add(&mut self, input: FrictionInput, contact: &RowSet, offsets: &[usize]) -> Result<usize> {
        let (first, count) = (self.len(), input.normal.len());
        if !(1..=2).contains(&input.dim) || (first > 0 && input.dim != self.dim) {
            let what = match first {
                0 => "a node has one or two tangential rows".to_owned(),
                _ => format!("the existing nodes have {} tangential rows each", self.dim),
            };
            return Err(Error::argument("dim", what).value(input.dim as f64));
        }
        let normal = self.normals(input.normal, contact)?;
        let coefficient = values_of(input.coefficient, "coefficient", count, 0)?;
        let bound = values_of(input.bound, "bound", count, 0)?;
        for (k, row) in normal.iter().enumerate() {
            if row.is_none() && coefficient[k] > 0.0 {
                let what = "a coefficient of friction needs a contact row";
                return Err(Error::argument("normal_row", what).node(k).entry(k));
            }
        }
        let mut rows = RowSet::default();
        rows.add(RowKind::Tangential, input.rows, offsets).map_err(|error| of_node(error, input.dim))?;
        drop_noise(&mut rows, &normal, contact);
        if count > 0 {
            self.dim = input.dim;
        }
        self.rows.append(&rows, offsets)?;
        let node = |(k, normal)| FrictionNode {
            normal,
            first: (first + k) * input.dim,
            count: input.dim,
            coefficient: coefficient[k],
            bound: bound[k],
        };
        self.nodes.extend(normal.into_iter().enumerate().map(node));
        Ok(first)
    }

    /// Refuses nodes whose rows have different factors; `contact`: the entries of a contact row, over the same unknowns as those of `input`.
    pub fn check_factors(
        input: FrictionInput,
        contact: impl Fn(usize) -> Entries,
        offsets: &[usize],
    ) -> Result<()> {
        let mut rows = RowSet::default();
        rows.add(RowKind::Tangential, input.rows, offsets)
            .map_err(|error| of_node(error, input.dim.max(1)))?;
        for (k, row) in input.normal.iter().enumerate() {
            let own = (k * input.dim..(k + 1) * input.dim).map(|i| entries(&rows, i));
            check_factors(own.chain(usize::try_from(*row).map(&contact)).collect(), k)?;
        }
        Ok(())
    }

    /// Contact rows of new nodes; each may belong to one node only.
    fn normals(&self, given: &[i64], contact: &RowSet) -> Result<Vec<Option<usize>>> {
        let mut taken = filled(contact.len(), false, "friction")?;
        self.nodes.iter().filter_map(|node| node.normal).for_each(|row| taken[row] = true);
        let mut normals = Vec::with_capacity(given.len());
        for (k, &row) in given.iter().enumerate() {
            if row == -1 {
                normals.push(None);
                continue;
            }
            let known = usize::try_from(row).ok().filter(|&row| row < contact.len());
            let number = known.ok_or_else(|| {
                let what =
                    format!("contact row {INDEX} does not exist: there are {} contact rows", contact.len());
                Error::argument("normal_row", what).node(k).entry(k).index(row)
            })?;
            if std::mem::replace(&mut taken[number], true) {
                let what = "this contact row already has a node of friction";
                return Err(Error::argument("normal_row", what).node(k).row(number).entry(k));
            }
            normals.push(Some(number));
        }
        Ok(normals)
    }

    /// Sets coefficients, bounds, or both, of the nodes from `first` on. True if some node begins or ceases to act.
    pub fn set_law(
        &mut self,
        first: usize,
        count: usize,
        coefficient: Option<&[f64]>,
        bound: Option<&[f64]>,
        contact: &RowSet,
    ) -> Result<bool> {
        self.check_nodes(first, count)?;
        let given = |values: Option<&[f64]>, name| match values {
            Some(_) => values_of(values, name, count, first).map(Some),
            None => Ok(None),
        };
        let (coefficient, bound) = (given(coefficient, "coefficient")?, given(bound, "bound")?);
        let without = |k: usize| self.nodes[first + k].normal.is_none();
        if let Some(k) = (0..count).find(|&k| without(k) && coefficient.as_ref().is_some_and(|c| c[k] > 0.0))
        {
            let what = "a coefficient of friction needs a contact row";
            return Err(Error::argument("coefficient", what).node(first + k).entry(k));
        }
        let acted: Vec<bool> = (first..first + count).map(|node| self.acts(node, contact)).collect();
        for (k, node) in self.nodes[first..first + count].iter_mut().enumerate() {
            coefficient.iter().for_each(|coefficient| node.coefficient = coefficient[k]);
            bound.iter().for_each(|bound| node.bound = bound[k]);
        }
        Ok(acted.iter().enumerate().any(|(k, acted)| *acted != self.acts(first + k, contact)))
    }

    /// Sets C_t >= 0, length / force, of the nodes from `first` on.
    pub fn set_compliance(&mut self, first: usize, inv_kt: &[f64]) -> Result<()> {
        self.check_nodes(first, inv_kt.len())?;
        if let Some(at) = inv_kt.iter().position(|v| !(v.is_finite() && *v >= 0.0)) {
            let what = format!("the compliance 1/k is not a finite number >= 0: {}", inv_kt[at]);
            return Err(Error::argument("inv_kt", what).node(first + at).entry(at).value(inv_kt[at]));
        }
        let dim = self.dim;
        let target = &mut Arc::make_mut(&mut self.rows.compliance)[first * dim..(first + inv_kt.len()) * dim];
        target.iter_mut().enumerate().for_each(|(i, c)| *c = inv_kt[i / dim]);
        Ok(())
    }

    /// Sets s_old, length, (dim, nodes), of the nodes from `first` on. True if some row without entries begins or ceases to
    /// count.
    pub fn set_reference(&mut self, first: usize, count: usize, dim: usize, s_old: &[f64]) -> Result<bool> {
        self.check_nodes(first, count)?;
        self.check_dim(dim, count)?;
        let from = first * self.dim;
        if let Some(at) = first_non_finite(s_old) {
            let error = Error::argument("s_old", "the slip is not a finite number");
            return Err(error.node(first + at / dim).entry(at).value(s_old[at]));
        }
        let range = from..from + s_old.len();
        let counted: Vec<bool> = range.clone().map(|i| self.counts(i)).collect();
        self.rows.rhs[range.clone()].copy_from_slice(s_old);
        Ok(range.zip(counted).any(|(i, counted)| self.counts(i) != counted))
    }

    /// Checks that `dim` is that of the nodes; a call with no node may have any `dim`.
    pub fn check_dim(&self, dim: usize, count: usize) -> Result<()> {
        if count == 0 || dim == self.dim {
            return Ok(());
        }
        let what = format!("the nodes have {} tangential rows each", self.dim);
        Err(Error::argument("dim", what).value(dim as f64).limit(self.dim as f64))
    }

    /// Checks that `count` nodes exist from `first` on.
    pub fn check_nodes(&self, first: usize, count: usize) -> Result<()> {
        let (nodes, end) = (self.len(), first.saturating_add(count));
        if end <= nodes {
            return Ok(());
        }
        let argument = if first < nodes { "nodes" } else { "first" };
        let what = format!("there are {nodes} nodes with friction");
        Err(Error::argument(argument, what).value(end as f64).limit(nodes as f64))
    }
}

/// Tangential rows that are rounding of the other rows of their node have no entries.
fn drop_noise(rows: &mut RowSet, normal: &[Option<usize>], contact: &RowSet) {
    let dim = rows.len() / normal.len().max(1);
    let largest = |i: usize| rows.largest_entry(i);
    let of_node = |node: usize| {
        let own = (node * dim..(node + 1) * dim).map(largest);
        own.chain(normal[node].map(|row| contact.largest_entry(row))).fold(0.0, f64::max)
    };
    let is_noise = |i: &usize| 0.0 < largest(*i) && largest(*i) <= NOISE * of_node(i / dim);
    let dropped: Vec<usize> = (0..rows.len()).filter(is_noise).collect();
    if dropped.is_empty() {
        return;
    }
    let mut kept = Csr::empty(rows.matrix.cols);
    for i in 0..rows.len() {
        kept.push_row(rows.matrix.row(i).filter(|_| dropped.binary_search(&i).is_err()));
    }
    rows.matrix = Arc::new(kept);
    rows.taken.get_or_insert_default().entries.extend(dropped);
}

/// The error of a tangential row among the nodes to be added.
fn of_node(error: Error, dim: usize) -> Error {
    match error.place.row {
        Some(row) => error.node(row / dim),
        None => error,
    }
}

/// One value >= 0 per node; zeros if absent.
fn values_of(given: Option<&[f64]>, name: &'static str, count: usize, first: usize) -> Result<Vec<f64>> {
    let Some(values) = given else { return filled(count, 0.0, "friction") };
    match values.iter().position(|v| !(v.is_finite() && *v >= 0.0)) {
        Some(at) => {
            let what = format!("the {name} of friction is not a finite number >= 0: {}", values[at]);
            Err(Error::argument(name, what).node(first + at).entry(at).value(values[at]))
        }
        None => Ok(values.to_vec()),
    }
}

#[cfg(test)]
mod tests;
