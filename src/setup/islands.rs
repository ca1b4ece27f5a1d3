//! Bodies that do not interact are solved as separate problems. An island is a set of bodies joined by rows, directly or
//! through other bodies, with all its rows; its answer has the bits that it would have if solved alone.

use std::ops::Range;
use std::sync::Arc;

use crate::certificate::{Certificate, Entry};
use crate::constraints::{Friction, FrictionNode, RowKind, RowSet, Taken};
use crate::error::Result;
use crate::linalg::graph::joined;
use crate::linalg::hash::{hash, same_bits, Shared, START};
use crate::linalg::vector::power_of_two_below;
use crate::linalg::Csr;
use crate::model::{Lengths, SolvedModel};
use crate::platform::memory::{copied, filled, headroom, reserved, zeros};

const WHAT: &str = "groups of bodies";

/// Bodies joined by rows, with their own numbering: unknowns body after body, rows in the order of the host.
#[derive(Clone)]
pub struct Island {
    /// Numbers of the bodies, ascending.
    pub bodies: Box<[usize]>,
    /// Unknowns of each body among those of the island; equal islands share them.
    pub ranges: Arc<Vec<Range<usize>>>,
    pub contact: Members,
    /// Shared by the islands without equality rows.
    pub equalities: Arc<Members>,
    /// Shared by the islands without friction.
    pub friction: Arc<Nodes>,
    /// 2^p, p = floor(log2 max K_ii), force / length: forces are divided by it.
    pub unit: f64,
}

/// Rows of one kind in an island.
#[derive(Clone, Default)]
pub struct Members {
    /// Their numbers among all rows of this kind, ascending.
    pub numbers: Vec<usize>,
    /// Over the unknowns of the island.
    pub rows: RowSet,
}

/// Nodes with friction in an island that may carry a tangential force.
#[derive(Clone, Default)]
pub struct Nodes {
    /// Their numbers among all nodes, ascending.
    pub numbers: Vec<usize>,
    /// Laws with the contact rows and tangential rows of the island.
    pub nodes: Vec<FrictionNode>,
    /// Tangential rows that count: those without entries only if they slip by their s_old.
    pub tangential: Members,
}

impl Island {
    /// Some node has friction.
    pub fn has_friction(&self) -> bool {
        self.friction.nodes.iter().any(FrictionNode::has_friction)
    }

    pub fn unknowns(&self) -> usize {
        self.ranges.last().map_or(0, |range| range.end)
    }

    /// Place in the island of the body with unknown j.
    pub fn body_of(&self, j: usize) -> usize {
        self.ranges.partition_point(|range| range.end <= j)
    }

    pub fn members(&self, kind: RowKind) -> &Members {
        match kind {
            RowKind::Inequality => &self.contact,
            RowKind::Equality => &self.equalities,
            RowKind::Tangential => &self.friction.tangential,
        }
    }

    /// Kind of row i of the stack, contact rows, equality rows, tangential rows, and its number within this kind.
    pub fn kind_and_place(&self, i: usize) -> (RowKind, usize) {
        let (contact, equalities) = (self.contact.numbers.len(), self.equalities.numbers.len());
        match (i.checked_sub(contact), i.checked_sub(contact + equalities)) {
            (None, _) => (RowKind::Inequality, i),
            (Some(k), None) => (RowKind::Equality, k),
            (_, Some(k)) => (RowKind::Tangential, k),
        }
    }

    /// Kind of row i of the stack, and its number among all rows of this kind.
    pub fn kind_and_row(&self, i: usize) -> (RowKind, usize) {
        let (kind, place) = self.kind_and_place(i);
        (kind, self.members(kind).numbers[place])
    }

    /// Number of row i of the stack among the `contact` contact rows of the host followed by its equality rows;
    /// tangential rows are not included.
    pub fn in_stack(&self, contact: usize, i: usize) -> usize {
        match self.kind_and_row(i) {
            (RowKind::Inequality, row) => row,
            (RowKind::Equality | RowKind::Tangential, row) => contact + row,
        }
    }

    /// The set of row i of the stack, and its number in this set.
    pub fn row(&self, i: usize) -> (&RowSet, usize) {
        let (kind, place) = self.kind_and_place(i);
        (&self.members(kind).rows, place)
    }

    /// The loads of its bodies one after the other, force.
    pub fn loads(&self, model: &SolvedModel) -> Result<Vec<f64>> {
        let mut all = zeros(self.unknowns(), "the loads")?;
        for (&p, range) in self.bodies.iter().zip(&*self.ranges) {
            if let Some(load) = &model.bodies[p].body.load {
                all[range.clone()].copy_from_slice(load);
            }
        }
        Ok(all)
    }

    /// Copies the values of the island from values over all unknowns.
    pub fn gather(&self, model: &SolvedModel, all: &[f64]) -> Result<Vec<f64>> {
        let mut own = reserved(self.unknowns(), WHAT)?;
        self.bodies.iter().for_each(|&p| own.extend_from_slice(&all[model.range(p)]));
        Ok(own)
    }

    /// Copies values over the unknowns of the island to values over all unknowns.
    pub fn scatter(&self, model: &SolvedModel, own: &[f64], all: &mut [f64]) {
        for (&p, range) in self.bodies.iter().zip(&*self.ranges) {
            all[model.range(p)].copy_from_slice(&own[range.clone()]);
        }
    }

    /// Replaces the numbers of bodies and rows of the island in a certificate by those of the model.
    pub fn named(&self, own: Certificate) -> Certificate {
        let at = |entry: Entry, numbers: &[usize]| Entry { place: entry.place.map(|k| numbers[k]), ..entry };
        let (contact, equalities) = (&self.contact.numbers, &self.equalities.numbers);
        Certificate {
            equilibrium: at(own.equilibrium, &self.bodies),
            balance: at(own.balance, &self.bodies),
            penetration: at(own.penetration, contact),
            equality: at(own.equality, equalities),
            negative_force: at(own.negative_force, contact),
            complementarity: at(own.complementarity, contact),
            friction_cone: at(own.friction_cone, &self.friction.numbers),
            friction_work: at(own.friction_work, &self.friction.numbers),
            friction_stick: at(own.friction_stick, &self.friction.numbers),
            ..own
        }
    }

    /// Takes over the right-hand sides of the host, without those that are rounding, and its laws of friction.
    pub fn refresh(&mut self, lengths: &Lengths) {
        let model = lengths.model();
        let mut friction = Some(&mut self.friction).filter(|of| !of.is_empty()).map(Arc::make_mut);
        let tangential = friction.as_mut().map(|of| (&mut of.tangential, RowKind::Tangential));
        let equalities = Some(&mut self.equalities).filter(|of| !of.numbers.is_empty());
        let equalities = equalities.map(|of| (Arc::make_mut(of), RowKind::Equality));
        let contact = (&mut self.contact, RowKind::Inequality);
        for (members, kind) in [contact].into_iter().chain(equalities).chain(tangential) {
            let rows = model.rows(kind);
            let Members { numbers, rows: own } = members;
            let mut rounding = vec![0.0; numbers.len()];
            let of_own = own.rhs.iter_mut().zip(&mut rounding);
            for ((c, taken), &i) in of_own.zip(&*numbers) {
                *c = lengths.rhs(kind, i);
                *taken = if *c == rows.rhs[i] { 0.0 } else { rows.rhs[i].abs() };
            }
            let is_taken = rounding.iter().any(|taken| *taken != 0.0);
            own.taken = is_taken.then(|| Box::new(Taken { rhs: rounding, ..Taken::default() }));
        }
        let nodes = friction.into_iter().flat_map(|of| of.nodes.iter_mut().zip(&of.numbers));
        for (own, &number) in nodes {
            let (coefficient, bound) = law(model, number);
            *own = FrictionNode { coefficient, bound, ..*own };
        }
    }
}

/// Coefficient and bound of a node; a contact row without entries has a constant force, which is added to the bound.
fn law(model: &SolvedModel, number: usize) -> (f64, f64) {
    let FrictionNode { normal, coefficient, bound, .. } = model.friction.nodes[number];
    let alone = normal.map_or(0.0, |row| model.contact.force_without_entries(RowKind::Inequality, row));
    (coefficient, bound + coefficient * alone)
}

impl Nodes {
    pub fn is_empty(&self) -> bool {
        self.numbers.is_empty()
    }
}

impl Members {
    /// Copies the values of the island from values over all rows of the kind.
    pub fn gather(&self, all: &[f64]) -> Vec<f64> {
        self.numbers.iter().map(|&i| all[i]).collect()
    }

    pub fn scatter<T: Copy>(&self, own: &[T], all: &mut [T]) {
        self.numbers.iter().zip(own).for_each(|(&i, v)| all[i] = *v);
    }
}

/// The islands of a problem, by their first bodies. Rows without entries and rows that never close, `c = +infinity`, are
/// in none of them.
pub fn islands(model: &SolvedModel) -> Result<Vec<Island>> {
    let (bodies, offsets) = (model.bodies.len(), &model.offsets);
    let body_of = |j: usize| offsets[1..].partition_point(|end| *end <= j);
    let all = [&model.contact, &model.equalities];
    let touched = all.into_iter().flat_map(|rows| {
        let finite = (0..rows.len()).filter(|&i| rows.is_finite(i));
        finite.map(move |i| rows.matrix.row(i).map(move |(j, _)| body_of(j)))
    });
    let _room = headroom(3 * size_of::<usize>() * bodies, WHAT)?;
    let (mut of_body, mut count) = joined(bodies, touched);
    let acting = acting(model);
    if !acting.is_empty() {
        let nodes = acting.iter().map(|&node| unknowns_of(model, node).map(|j| of_body[body_of(j)]));
        let (joint, all) = joined(count, nodes);
        of_body.iter_mut().for_each(|island| *island = joint[*island]);
        count = all;
    }
    if let Some(parts) = &model.parts {
        // the pieces of one body belong together, even if no row glues them
        let cut = (0..parts.assembled.len()).filter(|body| parts.is_cut(*body));
        let pieces = cut.map(|body| parts.of(body).map(|part| of_body[part]));
        let (joint, all) = joined(count, pieces);
        of_body.iter_mut().for_each(|island| *island = joint[*island]);
        count = all;
    }
    let mut islands = vec![Island::empty(); count];
    let (mut start, mut shapes) = (filled(bodies, 0, WHAT)?, Shared::default());
    for (island, bodies) in islands.iter_mut().zip(members(count, of_body.iter().copied().zip(0..))) {
        let mut end = 0;
        let range = |&p: &usize| {
            start[p] = end;
            end += model.bodies[p].body.order;
            start[p]..end
        };
        let ranges: Vec<Range<usize>> = bodies.iter().map(range).collect();
        let key = hash(START, ranges.iter().map(|range| range.end as u64));
        island.ranges = shapes.share(key, ranges, Vec::eq);
        island.bodies = bodies.into();
    }
    let place = |j: usize| start[body_of(j)] + j - offsets[body_of(j)];
    let mut known = Default::default();
    for kind in [RowKind::Inequality, RowKind::Equality] {
        let rows = model.rows(kind);
        let finite = (0..rows.len()).filter(|&i| rows.is_finite(i));
        let island_of = |i: usize| rows.matrix.row(i).next().map(|(j, _)| (of_body[body_of(j)], i));
        let numbers = members(count, finite.filter_map(island_of));
        for (island, numbers) in islands.iter_mut().zip(numbers).filter(|(_, own)| !own.is_empty()) {
            let rows = restricted(rows, &numbers, island.unknowns(), place, &mut known)?;
            let own = Members { numbers, rows };
            if kind == RowKind::Inequality {
                island.contact = own;
            } else {
                island.equalities = Arc::new(own);
            }
        }
    }
    nodes(model, &acting, &mut islands, |j| of_body[body_of(j)], place)?;
    for island in &mut islands {
        let stiffness = island.bodies.iter().filter_map(|&p| model.bodies[p].body.k());
        island.unit = power_of_two_below(stiffness.map(|k| k.largest_diagonal()).fold(0.0, f64::max));
    }
    Ok(islands)
}

/// For each of `count` islands its members, given as (island, member), in lists without room for more.
fn members(count: usize, all: impl Iterator<Item = (usize, usize)> + Clone) -> Vec<Vec<usize>> {
    let mut sizes = vec![0; count];
    all.clone().for_each(|(island, _)| sizes[island] += 1);
    let mut members: Vec<_> = sizes.into_iter().map(Vec::with_capacity).collect();
    all.for_each(|(island, member)| members[island].push(member));
    members
}

/// Nodes with friction that may carry a tangential force and have a tangential row that counts.
fn acting(model: &SolvedModel) -> Vec<usize> {
    let friction = &model.friction;
    let counts = |node: &usize| friction.nodes[*node].rows().any(|row| friction.counts(row));
    (0..friction.len()).filter(|&node| friction.acts(node, &model.contact)).filter(counts).collect()
}

/// Unknowns that the rows of a node touch.
fn unknowns_of(model: &SolvedModel, node: usize) -> impl Iterator<Item = usize> + '_ {
    let Friction { nodes, rows, .. } = &model.friction;
    let own = nodes[node].rows().flat_map(|row| rows.matrix.row(row));
    let normal = nodes[node].normal.filter(|&row| model.contact.is_finite(row));
    own.chain(normal.into_iter().flat_map(|row| model.contact.matrix.row(row))).map(|(j, _)| j)
}

/// Gives the islands their acting nodes.
fn nodes(
    model: &SolvedModel,
    acting: &[usize],
    islands: &mut [Island],
    island_of: impl Fn(usize) -> usize,
    place: impl Fn(usize) -> usize + Copy,
) -> Result<()> {
    let all = &model.friction;
    for &number in acting {
        let Some(first) = unknowns_of(model, number).next() else { continue };
        let island = &mut islands[island_of(first)];
        let own = Arc::make_mut(&mut island.friction);
        let first = own.tangential.numbers.len();
        let given = all.nodes[number];
        own.tangential.numbers.extend(given.rows().filter(|&row| all.counts(row)));
        let count = own.tangential.numbers.len() - first;
        let normal = given.normal.and_then(|row| island.contact.numbers.binary_search(&row).ok());
        let (coefficient, bound) = law(model, number);
        own.numbers.push(number);
        own.nodes.push(FrictionNode { normal, first, count, coefficient, bound });
    }
    for island in islands.iter_mut().filter(|island| !island.friction.is_empty()) {
        let unknowns = island.unknowns();
        let Members { numbers, rows } = &mut Arc::make_mut(&mut island.friction).tangential;
        *rows = restricted(&all.rows, numbers, unknowns, place, &mut Default::default())?;
    }
    Ok(())
}

/// These rows over the unknowns of an island, which shares their entries with the host's rows if it has all of them, otherwise, as
/// their compliances, with other islands that have equal ones.
fn restricted(
    rows: &RowSet,
    numbers: &[usize],
    unknowns: usize,
    place: impl Fn(usize) -> usize,
    (known, compliances): &mut (Shared<Csr>, Shared<Vec<f64>>),
) -> Result<RowSet> {
    let pick = |values: &[f64]| -> Vec<f64> { numbers.iter().map(|&i| values[i]).collect() };
    let matrix = if numbers.len() == rows.len() && rows.matrix.cols == unknowns {
        Arc::clone(&rows.matrix)
    } else {
        let entries = numbers.iter().map(|&i| rows.matrix.row(i).count()).sum();
        let mut own = Csr::with_room(unknowns, numbers.len(), entries);
        numbers.iter().for_each(|&i| own.push_row(rows.matrix.row(i).map(|(j, v)| (place(j), v))));
        known.share(own.key(), own, Csr::eq)
    };
    let (rhs, compliance) = (copied(&pick(&rows.rhs), WHAT)?, pick(&rows.compliance));
    let key = hash(START, compliance.iter().map(|c| c.to_bits()));
    let compliance = compliances.share(key, compliance, |a, b| same_bits(a, b));
    Ok(RowSet { matrix, rhs, compliance, ..RowSet::default() })
}

impl Island {
    fn empty() -> Self {
        let (contact, equalities, friction) = Default::default();
        Self { bodies: [].into(), ranges: Arc::default(), contact, equalities, friction, unit: 1.0 }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::body::{SparseInput, Storage};
    use crate::constraints::RowsInput;
    use crate::model::HostModel;

    /// Bodies of 1, 2, 1, 2, 1 unknowns; contact rows join 0 and 3, equality rows 4 and 1.
    #[test]
    fn islands_are_joined_by_finite_rows_of_either_kind_alone() {
        let mut model = HostModel::new();
        for n in [1, 2, 1, 2, 1] {
            let body = model.add_body(n).unwrap();
            let (ptr, col): (Vec<usize>, Vec<i64>) = ((0..=n).collect(), (0..n as i64).collect());
            let k = SparseInput { ptr: &ptr, col: &col, val: &vec![3.0; n], storage: Storage::Lower };
            model.set_stiffness(body, k).unwrap();
        }
        let contact = RowsInput {
            ptr: &[0, 2, 4, 4, 5],
            body: None,
            dof: &[0, 5, 3, 2, 3],
            val: &[1.0, -1.0, 1.0, 2.0, 5.0],
            rhs: Some(&[0.5, f64::INFINITY, 1.0, 0.25]),
        };
        model.add_rows(RowKind::Inequality, contact).unwrap();
        let equal = RowsInput { ptr: &[0, 2], body: None, dof: &[6, 1], val: &[1.0, -1.0], rhs: None };
        model.add_rows(RowKind::Equality, equal).unwrap();
        let islands = islands(&model).unwrap();
        let bodies: Vec<_> = islands.iter().map(|island| island.bodies.to_vec()).collect();
        assert_eq!(bodies, [vec![0, 3], vec![1, 4], vec![2]]);
        let [first, second, third] = &islands[..] else { panic!("{bodies:?}") };
        assert_eq!((first.contact.numbers.as_slice(), first.unit), (&[0][..], 2.0));
        assert!(first.contact.rows.matrix.row(0).eq([(0, 1.0), (2, -1.0)]));
        assert!(second.equalities.rows.matrix.row(0).eq([(0, -1.0), (2, 1.0)]));
        assert_eq!((third.contact.numbers.as_slice(), third.contact.rows.rhs[0]), (&[3][..], 0.25));
        assert_eq!(second.kind_and_row(0), (RowKind::Equality, 0));
    }
}
