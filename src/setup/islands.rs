//! Bodies that have nothing to do with each other are problems of their own. An island is a set of bodies joined by
//! rows, directly or through others, with all its rows; it has the bits that it would have alone.

use std::ops::Range;
use std::sync::Arc;

use crate::certificate::{Certificate, Entry};
use crate::constraints::{RowKind, RowSet};
use crate::error::Result;
use crate::linalg::graph::joined;
use crate::linalg::vector::power_of_two_below;
use crate::linalg::Csr;
use crate::model::Model;
use crate::platform::memory::{copied, headroom, reserved, zeros};

const WHAT: &str = "groups of bodies";

/// Bodies joined by rows, counted by themselves: unknowns body after body, rows in the order of the host.
pub struct Island {
    /// Numbers of the bodies, ascending.
    pub bodies: Vec<usize>,
    /// Unknowns of each body among those of the island.
    pub ranges: Vec<Range<usize>>,
    pub contact: Members,
    pub equalities: Members,
    /// 2^p, p = floor(log2 max K_ii), force / length: forces are divided by it.
    pub unit: f64,
}

/// Rows of one kind in an island.
#[derive(Default)]
pub struct Members {
    /// Their numbers among all rows of the kind, ascending.
    pub numbers: Vec<usize>,
    /// Over the unknowns of the island.
    pub rows: RowSet,
}

impl Island {
    pub fn unknowns(&self) -> usize {
        self.ranges.last().map_or(0, |range| range.end)
    }

    /// Place among its bodies of the one that has unknown j of the island.
    pub fn body_of(&self, j: usize) -> usize {
        self.ranges.partition_point(|range| range.end <= j)
    }

    pub fn members(&self, kind: RowKind) -> &Members {
        match kind {
            RowKind::Inequality => &self.contact,
            RowKind::Equality => &self.equalities,
        }
    }

    /// Kind and number among all rows of its kind of row i of the stack: contact rows, then equality rows.
    pub fn kind_and_row(&self, i: usize) -> (RowKind, usize) {
        match i.checked_sub(self.contact.numbers.len()) {
            None => (RowKind::Inequality, self.contact.numbers[i]),
            Some(k) => (RowKind::Equality, self.equalities.numbers[k]),
        }
    }

    /// Number of row i of the stack among all contact rows of the host, `contact` of them, and all equality rows.
    pub fn in_stack(&self, contact: usize, i: usize) -> usize {
        match self.kind_and_row(i) {
            (RowKind::Inequality, row) => row,
            (RowKind::Equality, row) => contact + row,
        }
    }

    /// The set of row i of the stack, and its place there.
    pub fn row(&self, i: usize) -> (&RowSet, usize) {
        match i.checked_sub(self.contact.numbers.len()) {
            None => (&self.contact.rows, i),
            Some(k) => (&self.equalities.rows, k),
        }
    }

    /// The loads of its bodies one after the other, force.
    pub fn loads(&self, model: &Model) -> Result<Vec<f64>> {
        let mut all = zeros(self.unknowns(), "the loads")?;
        for (&p, range) in self.bodies.iter().zip(&self.ranges) {
            if let Some(load) = &model.bodies[p].body.load {
                all[range.clone()].copy_from_slice(load);
            }
        }
        Ok(all)
    }

    /// Values over all unknowns for those of the island.
    pub fn gather(&self, model: &Model, all: &[f64]) -> Result<Vec<f64>> {
        let mut own = reserved(self.unknowns(), WHAT)?;
        self.bodies.iter().for_each(|&p| own.extend_from_slice(&all[model.range(p)]));
        Ok(own)
    }

    /// Puts values over the unknowns of the island where they belong among all.
    pub fn scatter(&self, model: &Model, own: &[f64], all: &mut [f64]) {
        for (&p, range) in self.bodies.iter().zip(&self.ranges) {
            all[model.range(p)].copy_from_slice(&own[range.clone()]);
        }
    }

    /// A certificate with the numbers that bodies and rows have among all.
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
            ..own
        }
    }

    /// Takes over the right-hand sides of the host.
    pub fn refresh(&mut self, contact: &[f64], equalities: &[f64]) {
        for (members, rhs) in [(&mut self.contact, contact), (&mut self.equalities, equalities)] {
            members.rows.rhs.iter_mut().zip(&members.numbers).for_each(|(c, &i)| *c = rhs[i]);
        }
    }
}

impl Members {
    /// Values over all rows of the kind for those of the island.
    pub fn gather(&self, all: &[f64]) -> Vec<f64> {
        self.numbers.iter().map(|&i| all[i]).collect()
    }

    pub fn scatter<T: Copy>(&self, own: &[T], all: &mut [T]) {
        self.numbers.iter().zip(own).for_each(|(&i, v)| all[i] = *v);
    }
}

/// The islands of a problem, by their first bodies. Rows without entries and rows that never close, `c = +infinity`, are
/// in none of them.
pub fn islands(model: &Model) -> Result<Vec<Island>> {
    let (bodies, offsets) = (model.bodies.len(), &model.offsets);
    let body_of = |j: usize| offsets[1..].partition_point(|end| *end <= j);
    let all = [&model.contact, &model.equalities];
    let touched = all.into_iter().flat_map(|rows| {
        let finite = (0..rows.len()).filter(|&i| rows.is_finite(i));
        finite.map(move |i| rows.matrix.row(i).map(move |(j, _)| body_of(j)))
    });
    let _room = headroom(3 * size_of::<usize>() * bodies, WHAT)?;
    let (mut of_body, mut count) = joined(bodies, touched);
    if let Some(parts) = &model.parts {
        // the pieces of one body belong together, also where nothing glues them
        let pieces = parts.first.windows(2).map(|range| (range[0]..range[1]).map(|part| of_body[part]));
        let (joint, all) = joined(count, pieces);
        of_body.iter_mut().for_each(|island| *island = joint[*island]);
        count = all;
    }
    let mut islands: Vec<Island> = (0..count).map(|_| Island::empty()).collect();
    let mut start = reserved(bodies, WHAT)?;
    for (p, &island) in of_body.iter().enumerate() {
        let island = &mut islands[island];
        start.push(island.unknowns());
        let range = island.unknowns()..island.unknowns() + model.bodies[p].body.order;
        island.bodies.push(p);
        island.ranges.push(range);
    }
    for (kind, rows) in all.into_iter().enumerate() {
        let mut numbers: Vec<Vec<usize>> = vec![Vec::new(); count];
        for i in (0..rows.len()).filter(|&i| rows.is_finite(i)) {
            if let Some((j, _)) = rows.matrix.row(i).next() {
                numbers[of_body[body_of(j)]].push(i);
            }
        }
        let place = |j: usize| start[body_of(j)] + j - offsets[body_of(j)];
        for (island, numbers) in islands.iter_mut().zip(numbers) {
            let rows = restricted(rows, &numbers, island.unknowns(), place)?;
            *[&mut island.contact, &mut island.equalities][kind] = Members { numbers, rows };
        }
    }
    for island in &mut islands {
        let stiffness = island.bodies.iter().filter_map(|&p| model.bodies[p].body.k());
        island.unit = power_of_two_below(stiffness.map(|k| k.largest_diagonal()).fold(0.0, f64::max));
    }
    Ok(islands)
}

/// These rows over the unknowns of an island; all rows share their entries with those of the host.
fn restricted(
    rows: &RowSet,
    numbers: &[usize],
    unknowns: usize,
    place: impl Fn(usize) -> usize,
) -> Result<RowSet> {
    let pick = |values: &[f64]| -> Vec<f64> { numbers.iter().map(|&i| values[i]).collect() };
    let matrix = if numbers.len() == rows.len() && rows.matrix.cols == unknowns {
        Arc::clone(&rows.matrix)
    } else {
        let mut own = Csr::empty(unknowns);
        numbers.iter().for_each(|&i| own.push_row(rows.matrix.row(i).map(|(j, v)| (place(j), v))));
        Arc::new(own)
    };
    Ok(RowSet { matrix, rhs: copied(&pick(&rows.rhs), WHAT)?, compliance: pick(&rows.compliance) })
}

impl Island {
    fn empty() -> Self {
        let (contact, equalities) = (Members::default(), Members::default());
        Self { bodies: Vec::new(), ranges: Vec::new(), contact, equalities, unit: 1.0 }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::body::{SparseInput, Storage};
    use crate::constraints::RowsInput;

    /// Bodies of 1, 2, 1, 2, 1 unknowns; contact rows join 0 and 3, equality rows 4 and 1.
    #[test]
    fn islands_are_joined_by_finite_rows_of_either_kind_alone() {
        let mut model = Model::new();
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
        let bodies: Vec<_> = islands.iter().map(|island| island.bodies.clone()).collect();
        assert_eq!(bodies, [vec![0, 3], vec![1, 4], vec![2]]);
        let [first, second, third] = &islands[..] else { panic!("{bodies:?}") };
        assert_eq!((first.contact.numbers.as_slice(), first.unit), (&[0][..], 2.0));
        assert!(first.contact.rows.matrix.row(0).eq([(0, 1.0), (2, -1.0)]));
        assert!(second.equalities.rows.matrix.row(0).eq([(0, -1.0), (2, 1.0)]));
        assert_eq!((third.contact.numbers.as_slice(), third.contact.rows.rhs[0]), (&[3][..], 0.25));
        assert_eq!(second.kind_and_row(0), (RowKind::Equality, 0));
    }
}
