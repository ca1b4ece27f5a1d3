//! Dual operators for new rows from those of the rows before: entries F_p(i, j) of two rows that body p has known stay.

use std::iter::Sum;
use std::sync::Mutex;

use crate::body::GeneralizedInverse;
use crate::error::{Error, Kind, Result};
use crate::linalg::memory::zeros;
use crate::linalg::{Csr, Operator, Packed};

/// A column by K+ takes two passes over the factor, each as long as reading it from memory takes; the assembly by reach
/// takes its products from the cache. Measured on faces of cubes of 4k to 40k unknowns, one column by K+ costs as much as
/// this many columns of a whole assembly.
const COLUMNS_OF_A_SOLUTION: usize = 24;

/// `F_p` and the rows of B over body p it was made of.
pub struct Kept {
    rows: Csr,
    operator: Packed,
}

/// What became of the columns of dual operators, one for each row and body it touches.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub struct Columns {
    pub computed: usize,
    pub kept: usize,
}

/// What the new rows of a body have in common with the old ones.
pub(super) enum Reuse {
    /// All of it, in the same order.
    All(Mutex<Option<Packed>>, usize),
    /// Some rows: for every new row its number among the old ones.
    Some { operator: Packed, old: Vec<Option<usize>> },
    /// So little that the whole operator is assembled, of so many rows.
    Nothing(usize),
}

impl Kept {
    pub(super) fn new(rows: Csr, operator: Packed) -> Self {
        Self { rows, operator }
    }

    pub fn bytes(&self) -> usize {
        Packed::bytes(self.operator.order())
    }
}

impl Sum for Columns {
    fn sum<I: Iterator<Item = Self>>(all: I) -> Self {
        all.fold(Self::default(), |a, b| Self { computed: a.computed + b.computed, kept: a.kept + b.kept })
    }
}

impl Reuse {
    pub fn of(kept: Option<Kept>, rows: &Csr) -> Self {
        let m = rows.rows();
        let Some(kept) = kept else { return Self::Nothing(m) };
        let old = matched(&kept.rows, rows);
        if m == kept.rows.rows() && old.iter().enumerate().all(|(i, old)| *old == Some(i)) {
            return Self::All(Mutex::new(Some(kept.operator)), m);
        }
        let new = old.iter().filter(|old| old.is_none()).count();
        if new * COLUMNS_OF_A_SOLUTION < m {
            return Self::Some { operator: kept.operator, old };
        }
        Self::Nothing(m)
    }

    pub fn columns(&self) -> Columns {
        match self {
            Self::All(_, kept) => Columns { computed: 0, kept: *kept },
            Self::Some { old, .. } => {
                let kept = old.iter().flatten().count();
                Columns { computed: old.len() - kept, kept }
            }
            Self::Nothing(computed) => Columns { computed: *computed, kept: 0 },
        }
    }

    /// `F_p = B_p K_p+ B_p'` of the new rows; asked for once.
    pub fn operator(&self, kplus: &GeneralizedInverse, rows: &Csr) -> Result<Packed> {
        match self {
            Self::All(operator, _) => operator
                .lock()
                .ok()
                .and_then(|mut operator| operator.take())
                .ok_or_else(|| Error::new(Kind::Internal, "a dual operator was asked for twice")),
            Self::Some { operator, old } => extended(operator, old, kplus, rows),
            Self::Nothing(_) => kplus.inverse_form(rows),
        }
    }
}

/// The entries of two old rows, and `F_p(i, j) = b_i K+ b_j'` of all others.
fn extended(from: &Packed, old: &[Option<usize>], kplus: &GeneralizedInverse, rows: &Csr) -> Result<Packed> {
    let (m, n) = (old.len(), rows.cols);
    let mut operator = Packed::zeros(m)?;
    for (i, of_i) in old.iter().enumerate().filter_map(|(i, old)| Some((i, (*old)?))) {
        for (j, of_j) in old[..=i].iter().enumerate().filter_map(|(j, old)| Some((j, (*old)?))) {
            operator.add(i, j, from.get(of_i, of_j));
        }
    }
    let (mut force, mut moved) = (zeros(n, "a row")?, zeros(n, "a displacement")?);
    for j in (0..m).filter(|&j| old[j].is_none()) {
        force.fill(0.0);
        rows.row(j).for_each(|(dof, value)| force[dof] = value);
        kplus.apply(&force, &mut moved)?;
        for i in (0..m).filter(|&i| i <= j || old[i].is_some()) {
            operator.add(i, j, rows.row_dot(i, &moved));
        }
    }
    Ok(operator)
}

/// For every row of `new` its number in `old`, where it is there bit by bit; of several equal rows each finds another.
fn matched(old: &Csr, new: &Csr) -> Vec<Option<usize>> {
    let mut known: Vec<(u64, usize)> = (0..old.rows()).map(|i| (key(old, i), i)).collect();
    known.sort_unstable();
    let mut taken = vec![false; known.len()];
    let mut find = |i: usize| {
        let key = key(new, i);
        let first = known.partition_point(|entry| entry.0 < key);
        let mut alike = (first..known.len()).take_while(|&at| known[at].0 == key);
        let at = alike.find(|&at| !taken[at] && same_row((old, known[at].1), (new, i)))?;
        taken[at] = true;
        Some(known[at].1)
    };
    (0..new.rows()).map(&mut find).collect()
}

fn same_row((a, i): (&Csr, usize), (b, j): (&Csr, usize)) -> bool {
    let bits = |(dof, value): (usize, f64)| (dof, value.to_bits());
    a.row(i).map(bits).eq(b.row(j).map(bits))
}

/// Equal for equal rows (FNV-1a over dofs and values).
fn key(rows: &Csr, i: usize) -> u64 {
    let words = rows.row(i).flat_map(|(dof, value)| [dof as u64, value.to_bits()]);
    words.fold(0xcbf2_9ce4_8422_2325, |key, word| (key ^ word ^ (word >> 32)).wrapping_mul(0x0100_0000_01b3))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn rows(all: &[&[(usize, f64)]]) -> Csr {
        let mut rows = Csr::empty(9);
        all.iter().for_each(|row| rows.push_row(row.iter().copied()));
        rows
    }

    #[test]
    fn rows_are_known_again_bit_by_bit_in_any_order_and_each_only_once() {
        let old = rows(&[&[(0, 1.0)], &[(0, 1.0), (2, -3.0)], &[(0, 1.0)], &[(5, 0.1)]]);
        let new =
            rows(&[&[(5, 0.1)], &[(0, 1.0)], &[(5, 0.1 + 1e-17)], &[(0, 1.0)], &[(0, 1.0)], &[(0, -1.0)]]);
        assert_eq!(matched(&old, &new), [Some(3), Some(0), None, Some(2), None, None]);
    }
}
