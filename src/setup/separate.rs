//! Which bodies are joined by rows, directly or through other bodies: the islands of a problem.

use std::sync::Arc;

use crate::constraints::{Friction, FrictionNode, RowKind, RowSet, Touched};
use crate::error::Result;
use crate::linalg::by_body::ranges;
use crate::linalg::graph::joined;
use crate::linalg::hash::{hash, same_bits, Shared, START};
use crate::linalg::vector::power_of_two_below;
use crate::linalg::Csr;
use crate::model::SolvedModel;
use crate::platform::memory::{copied, filled, headroom};
use crate::setup::islands::{law, Island};

const WHAT: &str = "groups of bodies";

/// The island of every body, by their first bodies, and their number. Rows without entries and rows that never close, `c = +infinity`, are
/// in none of them.
fn groups(model: &SolvedModel, acting: &[usize]) -> Result<(Vec<usize>, usize)> {
    let body_of = |j: usize| model.offsets[1..].partition_point(|end| *end <= j);
    let touched = [&model.contact, &model.equalities].into_iter().flat_map(|rows| {
        let finite = (0..rows.len()).filter(|&i| rows.is_finite(i));
        finite.map(move |i| rows.matrix.row(i).map(move |(j, _)| body_of(j)))
    });
    let (mut of_body, mut count) = joined(model.bodies.len(), touched);
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
    Ok((of_body, count))
}

/// The bodies in islands with pieces of a body that is cut; empty if none is.
pub fn beside_pieces(model: &SolvedModel) -> Result<Vec<bool>> {
    if !(0..model.bodies.len()).any(|p| model.is_piece(p)) {
        return Ok(Vec::new());
    }
    let (of_body, count) = groups(model, &acting(model))?;
    let mut has_pieces = filled(count, false, WHAT)?;
    (0..of_body.len()).filter(|p| model.is_piece(*p)).for_each(|p| has_pieces[of_body[p]] = true);
    Ok(of_body.into_iter().map(|island| has_pieces[island]).collect())
}

/// The islands of a problem, by their first bodies.
pub fn islands(model: &SolvedModel) -> Result<Vec<Island>> {
    let (bodies, offsets) = (model.bodies.len(), &model.offsets);
    let body_of = |j: usize| offsets[1..].partition_point(|end| *end <= j);
    let all = [&model.contact, &model.equalities];
    let _room = headroom(3 * size_of::<usize>() * bodies, WHAT)?;
    let acting = acting(model);
    let (of_body, count) = groups(model, &acting)?;
    let mut islands = vec![Island::empty(); count];
    let (mut start, mut shapes) = (filled(bodies, 0, WHAT)?, Shared::default());
    for (island, bodies) in islands.iter_mut().zip(members(count, of_body.iter().copied().zip(0..))) {
        let ranges = ranges(bodies.iter().map(|&p| model.bodies[p].body.order));
        bodies.iter().zip(&ranges).for_each(|(&p, range)| start[p] = range.start);
        let key = hash(START, ranges.iter().map(|range| range.end as u64));
        island.ranges = shapes.share(key, ranges, Vec::eq);
        island.bodies = bodies.into();
    }
    let mut numbers: Vec<[Vec<usize>; 2]> = vec![Default::default(); count];
    for (kind, rows) in all.into_iter().enumerate() {
        let finite = (0..rows.len()).filter(|&i| rows.is_finite(i));
        let island_of = |i: usize| rows.matrix.row(i).next().map(|(j, _)| (of_body[body_of(j)], i));
        let own = members(count, finite.filter_map(island_of));
        numbers.iter_mut().zip(own).for_each(|(all, own)| all[kind] = own);
    }
    for (island, [contact, equalities]) in islands.iter_mut().zip(numbers) {
        island.contact.numbers = contact;
        if !equalities.is_empty() {
            Arc::make_mut(&mut island.equalities).numbers = equalities;
        }
    }
    nodes(model, &acting, &mut islands, |j| of_body[body_of(j)]);
    let place = |j: usize| start[body_of(j)] + j - offsets[body_of(j)];
    let (mut touched, mut known) = (Shared::default(), Default::default());
    for island in &mut islands {
        let of_kind = |kind: RowKind| {
            let matrix = &model.rows(kind).matrix;
            island.members(kind).numbers.iter().flat_map(|&i| matrix.row(i)).map(|(j, _)| place(j))
        };
        let own = Touched::of(&island.ranges, RowKind::ALL.into_iter().flat_map(of_kind));
        island.touched = touched.share(own.key(), own, Touched::eq);
        let column = |j: usize| {
            let body = body_of(j);
            let own = island.bodies.partition_point(|p| *p < body);
            island.touched.place(own, j - offsets[body]).unwrap_or_default()
        };
        let of_kind = |kind: RowKind| {
            let numbers = &island.members(kind).numbers;
            restricted(model.rows(kind), numbers, island.touched.len(), column, &mut known)
        };
        let [contact, equalities, tangential] = RowKind::ALL.map(of_kind);
        island.contact.rows = contact?;
        if !island.equalities.numbers.is_empty() {
            Arc::make_mut(&mut island.equalities).rows = equalities?;
        }
        if !island.friction.is_empty() {
            Arc::make_mut(&mut island.friction).tangential.rows = tangential?;
        }
    }
    for island in &mut islands {
        let largest = island.bodies.iter().map(|&p| model.bodies[p].body.largest_diagonal());
        island.unit = power_of_two_below(largest.fold(0.0, f64::max));
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

/// Gives the islands their acting nodes, and the numbers of their tangential rows.
fn nodes(model: &SolvedModel, acting: &[usize], islands: &mut [Island], island_of: impl Fn(usize) -> usize) {
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
}

/// These rows over the unknowns that rows of an island touch. The island shares their entries with the host's rows if it has all of
/// them, otherwise, as their compliances, with other islands that have equal ones.
fn restricted(
    rows: &RowSet,
    numbers: &[usize],
    columns: usize,
    column: impl Fn(usize) -> usize,
    (known, compliances): &mut (Shared<Csr>, Shared<Vec<f64>>),
) -> Result<RowSet> {
    if numbers.is_empty() {
        return Ok(RowSet::default());
    }
    let pick = |values: &[f64]| -> Vec<f64> { numbers.iter().map(|&i| values[i]).collect() };
    let matrix = if numbers.len() == rows.len() && rows.matrix.cols == columns {
        Arc::clone(&rows.matrix)
    } else {
        let entries = numbers.iter().map(|&i| rows.matrix.row(i).count()).sum();
        let mut own = Csr::with_room(columns, numbers.len(), entries);
        numbers.iter().for_each(|&i| own.push_row(rows.matrix.row(i).map(|(j, v)| (column(j), v))));
        known.share(own.key(), own, Csr::eq)
    };
    let (rhs, compliance) = (copied(&pick(&rows.rhs), WHAT)?, pick(&rows.compliance));
    let key = hash(START, compliance.iter().map(|c| c.to_bits()));
    let compliance = compliances.share(key, compliance, |a, b| same_bits(a, b));
    Ok(RowSet { matrix, rhs, compliance, ..RowSet::default() })
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
        assert!(first.contact.rows.matrix.row(0).eq([(0, 1.0), (1, -1.0)]));
        assert_eq!(
            (0..2).map(|j| (first.touched.body_of(j), first.touched.dof(j))).collect::<Vec<_>>(),
            [(0, 0), (1, 1)]
        );
        assert!(second.equalities.rows.matrix.row(0).eq([(0, -1.0), (1, 1.0)]));
        assert_eq!((third.contact.numbers.as_slice(), third.contact.rows.rhs[0]), (&[3][..], 0.25));
        assert_eq!(second.kind_and_row(0), (RowKind::Equality, 0));
    }
}
