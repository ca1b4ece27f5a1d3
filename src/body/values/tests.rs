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
    /// The diagonal, 0 if not given, and the off-diagonal entries.
    fn split(&self) -> (Vec<f64>, Given) {
        let (mut diag, mut beside) =
            (vec![0.0; N], Given { ptr: vec![0], col: Vec::new(), val: Vec::new(), storage: self.storage });
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

/// About 5 off-diagonal entries per row, some diagonal entries not given. `turned`: some rows have descending columns;
/// `lost`: some entries that are zero on both sides are given on one side only.
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
        assert_eq!(places.values(&k, &[], &first.val, 1e-10).unwrap(), *k.val);
        let anew = from_sparse(second.input(), 1e-10).unwrap();
        assert_eq!((&anew.ptr, &anew.col), (&k.ptr, &k.col));
        assert_eq!(places.values(&k, &[], &second.val, 1e-10).unwrap(), *anew.val);
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
        assert_eq!(places.values(&k, &diag, &beside.val, 1e-10).unwrap(), *anew.val);
        let refused = from_split(second.input(), &diag, 1e-10).unwrap_err();
        assert!(refused.what.contains("diagonal"), "{refused}");
        let (mut at, row) = ((0..second.col.len()), |at| second.ptr.partition_point(|&p| p <= at) - 1);
        let first_on = at.find(|&at| second.col[at] == row(at) as i64);
        assert_eq!((refused.kind, refused.place.entry), (Kind::Argument("col"), first_on));
    }
}

/// Every single value out of order: the error is that of a new matrix.
#[test]
fn new_values_are_refused_as_a_matrix_given_anew_is() {
    for (storage, turned, lost) in forms() {
        let mut given = given(storage, turned, lost, 0.3);
        let k = from_sparse(given.input(), 1e-10).unwrap();
        let places = Places::of(given.input(), false, &k).unwrap();
        for at in 0..given.val.len() {
            for bad in [f64::NAN, given.val[at] + 1.0] {
                let good = std::mem::replace(&mut given.val[at], bad);
                let anew = from_sparse(given.input(), 1e-10).map(|k| k.val.to_vec());
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
