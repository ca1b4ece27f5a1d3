//! New values for a matrix whose pattern is there: where each of them goes, and the checks of the first time.

use crate::body::stiffness::{check_finite, may_differ, unsymmetric, SparseInput, Storage};
use crate::error::{Error, Result};
use crate::linalg::memory::{reserved, zeros};
use crate::linalg::vector::first_non_finite;
use crate::linalg::Symmetric;

const WHAT: &str = "new values of a stiffness matrix";
/// Position of an entry that the host does not give.
const NONE: usize = usize::MAX;

/// How the host gave a matrix: in which form its values come again.
#[derive(Debug, PartialEq)]
pub enum Form {
    Sparse(Places),
    Dense(Storage),
}

/// Where the values of the host belong in the lower triangle. For rows of ascending columns, those in full with entries
/// on both sides of the diagonal, the triangle itself tells.
#[derive(Debug, PartialEq)]
pub struct Places {
    storage: Storage,
    /// Number of values.
    entries: usize,
    /// The diagonal is an array of its own.
    apart: bool,
    /// Rows whose diagonal entry is not given, ascending.
    without: Vec<usize>,
    /// For rows in any order.
    listed: Option<Listed>,
}

/// For every entry of the lower triangle its position among the values.
#[derive(Debug, PartialEq)]
struct Listed {
    own: Vec<usize>,
    /// In storage in full: position of its mate on the other side of the diagonal; of the diagonal none.
    mate: Vec<usize>,
}

/// An entry of the lower triangle, and the positions of its values among those of the host.
struct Entry {
    row: usize,
    col: usize,
    at: usize,
    own: usize,
    mate: usize,
}

impl Places {
    /// For the matrix `k` that was made of `input`, with a diagonal `apart` or in its rows.
    pub fn of(input: SparseInput<'_>, apart: bool, k: &Symmetric) -> Result<Self> {
        let row = |i: usize| &input.col[input.ptr[i]..input.ptr[i + 1]];
        let (n, storage, entries) = (k.order(), input.storage, input.col.len());
        let ascending = (0..n).all(|i| row(i).windows(2).all(|pair| pair[0] < pair[1]));
        let given = |i: &usize| apart || row(*i).iter().any(|&j| j as usize == *i);
        let mut without = reserved(n - (0..n).filter(given).count(), WHAT)?;
        without.extend((0..n).filter(|i| !given(i)));
        let beside = if apart { entries } else { entries - (n - without.len()) };
        let paired = storage != Storage::Full || beside == 2 * (k.col.len() - n);
        let listed = if ascending && paired { None } else { Some(Listed::of(input, k)?) };
        Ok(Self { storage, entries, apart, without, listed })
    }

    /// Number of values, those of a diagonal of its own not counted.
    pub fn entries(&self) -> usize {
        self.entries
    }

    /// True where the diagonal is an array of its own.
    pub fn is_split(&self) -> bool {
        self.apart
    }

    /// The values of `k` anew from those of the host, in storage in full checked for symmetry and averaged. `diag`: the
    /// diagonal, where it is an array of its own.
    pub fn values(&self, k: &Symmetric, diag: &[f64], val: &[f64], tolerance: f64) -> Result<Vec<f64>> {
        check_finite(diag, "diag", |at| at)?;
        if let Some(at) = first_non_finite(val) {
            let error = Error::argument("val", "the entry is not a finite number").entry(at);
            return Err(match self.row_of(k, at)? {
                Some(row) => error.row(row),
                None => error,
            });
        }
        let mut new = zeros(k.col.len(), WHAT)?;
        self.visit(k, |entry| new[entry.at] = value(val, entry.own))?;
        diag.iter().enumerate().for_each(|(i, v)| new[k.ptr[i + 1] - 1] = *v);
        if self.storage == Storage::Full {
            self.average(k, val, tolerance, &mut new)?;
        }
        Ok(new)
    }

    /// `(K + K')/2` for `new`, which holds the diagonal and what is left of it.
    fn average(&self, k: &Symmetric, val: &[f64], tolerance: f64, new: &mut [f64]) -> Result<()> {
        let mut worst = None;
        self.visit(k, |Entry { row, col, at, mate, .. }| {
            let (k_ij, k_ji) = (new[at], value(val, mate));
            if row == col || k_ij == k_ji {
                return;
            }
            let root = |i: usize| new[k.ptr[i + 1] - 1].abs().sqrt();
            let limit = may_differ(tolerance, root(row), root(col));
            if (k_ij - k_ji).abs() > limit && worst.is_none() {
                worst = Some((row, col, k_ij - k_ji, limit));
            }
            new[at] = 0.5 * k_ij + 0.5 * k_ji;
        })?;
        let Some((row, col, difference, limit)) = worst else { return Ok(()) };
        let lonely = self.lonely(k, val, row)? || self.lonely(k, val, col)?;
        Err(unsymmetric(lonely, (row, col), difference, limit))
    }

    /// Whether the host's row has nothing beside its diagonal.
    fn lonely(&self, k: &Symmetric, val: &[f64], row: usize) -> Result<bool> {
        let mut lonely = true;
        self.visit(k, |entry| {
            let beside = entry.row != entry.col;
            let own = beside && entry.row == row && value(val, entry.own) != 0.0;
            let mate = beside && entry.col == row && value(val, entry.mate) != 0.0;
            lonely &= !own && !mate;
        })?;
        Ok(lonely)
    }

    /// The host's row that holds value number `at`.
    fn row_of(&self, k: &Symmetric, at: usize) -> Result<Option<usize>> {
        let mut found = None;
        self.visit(k, |entry| {
            if entry.own == at {
                found = Some(if self.storage == Storage::Upper { entry.col } else { entry.row });
            } else if entry.mate == at {
                found = Some(entry.col);
            }
        })?;
        Ok(found)
    }

    /// Every entry of the lower triangle, row by row.
    fn visit(&self, k: &Symmetric, mut visit: impl FnMut(Entry)) -> Result<()> {
        if let Some(Listed { own, mate }) = &self.listed {
            for row in 0..k.order() {
                for at in k.ptr[row]..k.ptr[row + 1] {
                    let mate = mate.get(at).copied().unwrap_or(NONE);
                    visit(Entry { row, col: k.col[at] as usize, at, own: own[at], mate });
                }
            }
            return Ok(());
        }
        // Row i of the triangle is read before any later one: row j < i of the host has come to its entry i.
        let mut next = self.starts(k)?;
        let mut take = |row: usize| {
            next[row] += 1;
            next[row] - 1
        };
        let mut without = self.without.iter().copied().peekable();
        for row in 0..k.order() {
            let diagonal = k.ptr[row + 1] - 1;
            for at in k.ptr[row]..diagonal {
                let col = k.col[at] as usize;
                let (own, mate) = match self.storage {
                    Storage::Lower => (take(row), NONE),
                    Storage::Upper => (take(col), NONE),
                    Storage::Full => (take(row), take(col)),
                };
                visit(Entry { row, col, at, own, mate });
            }
            let given = without.next_if_eq(&row).is_none() && !self.apart;
            let own = if given { take(row) } else { NONE };
            visit(Entry { row, col: row, at: diagonal, own, mate: NONE });
        }
        Ok(())
    }

    /// First value of every row of the host, where columns ascend.
    fn starts(&self, k: &Symmetric) -> Result<Vec<usize>> {
        let mut starts = reserved(k.order() + 1, WHAT)?;
        starts.resize(k.order() + 1, 0);
        for i in 0..k.order() {
            starts[i + 1] += usize::from(!self.apart);
            for &j in &k.col[k.ptr[i]..k.ptr[i + 1] - 1] {
                starts[i + 1] += usize::from(self.storage != Storage::Upper);
                starts[j as usize + 1] += usize::from(self.storage != Storage::Lower);
            }
        }
        self.without.iter().for_each(|&i| starts[i + 1] -= 1);
        (0..k.order()).for_each(|i| starts[i + 1] += starts[i]);
        Ok(starts)
    }
}

impl Listed {
    fn of(input: SparseInput<'_>, k: &Symmetric) -> Result<Self> {
        let none = |len: usize| -> Result<Vec<usize>> {
            let mut places = reserved(len, WHAT)?;
            places.resize(len, NONE);
            Ok(places)
        };
        let full = input.storage == Storage::Full;
        let (mut own, mut mate) = (none(k.col.len())?, none(if full { k.col.len() } else { 0 })?);
        for i in 0..k.order() {
            for at in input.ptr[i]..input.ptr[i + 1] {
                let j = input.col[at] as usize;
                let (row, col) = (i.max(j), i.min(j));
                let place = k.ptr[row]
                    + k.col[k.ptr[row]..k.ptr[row + 1]].partition_point(|&other| (other as usize) < col);
                if full && j > i {
                    mate[place] = at;
                } else {
                    own[place] = at;
                }
            }
        }
        Ok(Self { own, mate })
    }
}

fn value(val: &[f64], at: usize) -> f64 {
    if at == NONE {
        0.0
    } else {
        val[at]
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::body::{from_sparse, from_split};
    use crate::error::Kind;

    const N: usize = 30;

    struct Given {
        ptr: Vec<usize>,
        col: Vec<i64>,
        val: Vec<f64>,
        storage: Storage,
    }

    impl Given {
        fn input(&self) -> SparseInput<'_> {
            SparseInput { ptr: &self.ptr, col: &self.col, val: &self.val, storage: self.storage }
        }
    }

    impl Given {
        /// The diagonal, 0 where it is not given, and what lies beside it.
        fn split(&self) -> (Vec<f64>, Given) {
            let (mut diag, mut beside) = (
                vec![0.0; N],
                Given { ptr: vec![0], col: Vec::new(), val: Vec::new(), storage: self.storage },
            );
            for i in 0..N {
                for at in self.ptr[i]..self.ptr[i + 1] {
                    if self.col[at] == i as i64 {
                        diag[i] = self.val[at];
                    } else {
                        beside.col.push(self.col[at]);
                        beside.val.push(self.val[at]);
                    }
                }
                beside.ptr.push(beside.col.len());
            }
            (diag, beside)
        }
    }

    /// About 5 entries beside the diagonal of every row, some diagonal entries not given. `turned`: some rows in
    /// descending order; `lost`: some entries that are zero on both sides are given on one side only.
    fn given(storage: Storage, turned: bool, lost: bool, seed: f64) -> Given {
        let (mut ptr, mut col, mut val) = (vec![0], Vec::new(), Vec::new());
        for i in 0..N {
            let mut row: Vec<(i64, f64)> = Vec::new();
            for j in 0..N {
                let (low, high) = (i.min(j), i.max(j));
                let coupled = (5 * low + 3 * high) % 7 == 1 && low % 9 != 4 && high % 9 != 4;
                let zero = coupled && (low + high) % 4 == 0;
                let wanted = match storage {
                    Storage::Full => !(lost && zero && i > j),
                    Storage::Lower => j <= i,
                    Storage::Upper => j >= i,
                };
                let value = if zero { 0.0 } else { (low as f64 + seed).sin() * (high as f64).cos() };
                if wanted && i == j && i % 9 != 4 {
                    row.push((j as i64, 50.0 + seed));
                } else if wanted && i != j && coupled {
                    row.push((j as i64, value * (1.0 + f64::from(j > i) * 1e-13)));
                }
            }
            if turned && i % 3 == 1 {
                row.reverse();
            }
            col.extend(row.iter().map(|entry| entry.0));
            val.extend(row.iter().map(|entry| entry.1));
            ptr.push(col.len());
        }
        Given { ptr, col, val, storage }
    }

    fn forms() -> impl Iterator<Item = (Storage, bool, bool)> {
        let storages = [Storage::Full, Storage::Lower, Storage::Upper].into_iter();
        storages.flat_map(|storage| {
            [(false, false), (true, false), (false, true), (true, true)].map(|(a, b)| (storage, a, b))
        })
    }

    #[test]
    fn new_values_give_the_bits_of_a_matrix_given_anew() {
        for (storage, turned, lost) in forms() {
            let (first, second) = (given(storage, turned, lost, 0.0), given(storage, turned, lost, 0.7));
            let k = from_sparse(first.input(), 1e-10).unwrap();
            let places = Places::of(first.input(), false, &k).unwrap();
            let symmetric = storage != Storage::Full || !lost;
            assert_eq!(places.listed.is_some(), turned || !symmetric, "{storage:?} {turned} {lost}");
            assert_eq!(places.values(&k, &[], &first.val, 1e-10).unwrap(), k.val);
            let anew = from_sparse(second.input(), 1e-10).unwrap();
            assert_eq!((&anew.ptr, &anew.col), (&k.ptr, &k.col));
            assert_eq!(places.values(&k, &[], &second.val, 1e-10).unwrap(), anew.val);
            assert_ne!(anew.val, k.val);
        }
    }

    #[test]
    fn a_diagonal_of_its_own_changes_nothing() {
        for (storage, turned, lost) in forms() {
            let (first, second) = (given(storage, turned, lost, 0.0), given(storage, turned, lost, 0.7));
            let (diag, beside) = first.split();
            let k = from_split(beside.input(), &diag, 1e-10).unwrap();
            assert_eq!(k, from_sparse(first.input(), 1e-10).unwrap(), "{storage:?} {turned} {lost}");
            let places = Places::of(beside.input(), true, &k).unwrap();
            let symmetric = storage != Storage::Full || !lost;
            assert_eq!(places.listed.is_some(), turned || !symmetric, "{storage:?} {turned} {lost}");
            let (diag, beside) = second.split();
            let anew = from_sparse(second.input(), 1e-10).unwrap();
            assert_eq!(places.values(&k, &diag, &beside.val, 1e-10).unwrap(), anew.val);
            let refused = from_split(second.input(), &diag, 1e-10).unwrap_err();
            assert!(refused.what.contains("diagonal"), "{refused}");
            let (at, row) = ((0..second.col.len()), |at| second.ptr.partition_point(|&p| p <= at) - 1);
            let first_on = at.filter(|&at| second.col[at] == row(at) as i64).next();
            assert_eq!((refused.kind, refused.place.entry), (Kind::Argument("col"), first_on));
        }
    }

    /// Every single value out of order: the same error as for a matrix given anew.
    #[test]
    fn new_values_are_refused_as_a_matrix_given_anew_is() {
        for (storage, turned, lost) in forms() {
            let mut given = given(storage, turned, lost, 0.3);
            let k = from_sparse(given.input(), 1e-10).unwrap();
            let places = Places::of(given.input(), false, &k).unwrap();
            for at in 0..given.val.len() {
                for bad in [f64::NAN, given.val[at] + 1.0] {
                    let good = std::mem::replace(&mut given.val[at], bad);
                    let anew = from_sparse(given.input(), 1e-10).map(|k| k.val);
                    let found = places.values(&k, &[], &given.val, 1e-10);
                    assert_eq!(format!("{found:?}"), format!("{anew:?}"), "{storage:?} {turned} {at}");
                    assert_eq!(found.is_err(), anew.is_err());
                    given.val[at] = good;
                }
            }
        }
    }

    #[test]
    fn an_identity_row_that_meets_a_full_column_gets_its_own_advice() {
        let first = given(Storage::Full, false, false, 0.3);
        let k = from_sparse(first.input(), 1e-10).unwrap();
        let places = Places::of(first.input(), false, &k).unwrap();
        let mut val = first.val.clone();
        let row = 3;
        (first.ptr[row]..first.ptr[row + 1]).for_each(|at| {
            if first.col[at] != row as i64 {
                val[at] = 0.0;
            }
        });
        let error = places.values(&k, &[], &val, 1e-10).unwrap_err();
        assert_eq!(error.kind, Kind::Argument("val"));
        assert!(error.what.contains("eliminate supports symmetrically"), "{error}");
    }
}
