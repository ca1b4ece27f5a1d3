//! Stiffness matrices by rows and dense, new values of every form, and those the host keeps.

use std::ffi::c_void;

use feti_contact_c::*;

use super::give::{narrow, spoil_indices};
use super::host::{Host, Lent};
use super::models::{Given, Model};

/// The entries of K that a storage keeps, by rows.
struct Sparse {
    pointer: Vec<i64>,
    column: Vec<i64>,
    value: Vec<f64>,
    /// Where the diagonal comes by itself.
    diagonal: Option<Vec<f64>>,
    base: i32,
    storage: i32,
    narrow: bool,
}

impl Sparse {
    /// `form`: storage, base, order within the rows, width of the indices, a diagonal by itself. Zeros are left out.
    fn new(model: &Model, form: u8) -> Self {
        let n = model.n;
        let (storage, base) = ([FETI_FULL, FETI_LOWER, FETI_UPPER][usize::from(form & 3) % 3], form >> 2 & 1);
        let split = form >> 7 == 1;
        let (mut pointer, mut column, mut value) = (vec![i64::from(base)], Vec::new(), Vec::new());
        for i in 0..n {
            let kept = |j: &usize| match storage {
                FETI_LOWER => *j <= i,
                FETI_UPPER => *j >= i,
                _ => true,
            };
            let there = |j: &usize| if *j == i { !split } else { model.k[i + j * n] != 0.0 };
            let mut row: Vec<usize> = (0..n).filter(kept).filter(there).collect();
            if form >> 3 & 1 == 1 {
                row.reverse();
            }
            column.extend(row.iter().map(|j| *j as i64 + i64::from(base)));
            value.extend(row.iter().map(|j| model.k[i + j * n]));
            pointer.push(column.len() as i64 + i64::from(base));
        }
        let diagonal = split.then(|| (0..n).map(|i| model.k[i + i * n]).collect());
        Self { pointer, column, value, diagonal, base: i32::from(base), storage, narrow: form >> 4 & 3 != 1 }
    }

    fn spoil(&mut self, host: &mut Host) {
        spoil_indices(host, &mut self.pointer, true);
        spoil_indices(host, &mut self.column, false);
        if !self.value.is_empty() && host.turn() {
            let at = host.bytes.below(self.value.len());
            self.value[at] = host.bytes.wild();
        }
    }

    /// Status, the number of the body that was named, and the flags.
    fn hand_over(self, host: &mut Host, body: usize, n: usize, flags: i32) -> i32 {
        let (p, at, n) = (host.handle(), host.known(body), host.known(n));
        let diagonal = self.diagonal.as_ref().map(|diagonal| host.array(diagonal));
        let (value, base, storage) = (host.array(&self.value), host.code(self.base), host.code(self.storage));
        let flags = host.code(flags);
        let wide = (host.array(&self.pointer), host.array(&self.column));
        let short = (narrow(&self.pointer), narrow(&self.column));
        let none = |wide: *const i64, short: &Vec<i32>| {
            if wide.is_null() {
                std::ptr::null()
            } else {
                short.as_ptr()
            }
        };
        let (ptr, col) = (none(wide.0, &short.0), none(wide.1, &short.1));
        // SAFETY: the last pointer is at most the number of entries; what is lent stays until it is replaced.
        let status = unsafe {
            match (diagonal, self.narrow) {
                (None, true) => feti_body_stiffness_i32(p, at, n, ptr, col, value, base, storage, flags),
                (None, false) => {
                    feti_body_stiffness_i64(p, at, n, wide.0, wide.1, value, base, storage, flags)
                }
                (Some(diagonal), true) => {
                    feti_body_stiffness_split_i32(p, at, n, diagonal, ptr, col, value, base, storage, flags)
                }
                (Some(diagonal), false) => feti_body_stiffness_split_i64(
                    p, at, n, diagonal, wide.0, wide.1, value, base, storage, flags,
                ),
            }
        };
        if host.done(status, &[]) {
            host.changed();
            let given = Given { dense: false, diagonal: self.diagonal, value: self.value.clone() };
            let kept = (flags == FETI_BORROW).then_some((self.pointer, self.column, short, self.value));
            took(host, at, given, kept);
        }
        status
    }
}

type Arrays = (Vec<i64>, Vec<i64>, (Vec<i32>, Vec<i32>), Vec<f64>);

/// A body has another matrix: what was lent for the one before is the host's again, and is freed.
pub fn took(host: &mut Host, body: i64, given: Given, lent: Option<Arrays>) {
    let (body, right) = (body as usize, !host.spoilt());
    host.bodies[body].given = right.then_some(given);
    host.lent[body] = lent.map_or_else(Lent::default, |(pointer, column, short, value)| Lent {
        pattern: Some(Box::new((pointer, column, short))),
        value: Some(value),
    });
}

/// The stiffness matrix of a body by rows or dense.
pub fn stiffness(host: &mut Host, body: usize, form: u8) {
    let n = host.bodies[body].n;
    if form >> 4 & 3 == 0 {
        dense(host, body, [FETI_FULL, FETI_LOWER, FETI_UPPER][usize::from(form & 3) % 3]);
        return;
    }
    let mut sparse = Sparse::new(&host.bodies[body], form);
    sparse.spoil(host);
    sparse.hand_over(host, body, n, if form >> 6 & 1 == 1 { FETI_BORROW } else { FETI_COPY });
}

/// K by columns, `ld` apart.
fn columns(host: &mut Host, n: usize, k: &[f64]) -> (Vec<f64>, usize) {
    let ld = n + host.bytes.below(3);
    let mut spread = vec![7.0; ld * n];
    (0..n * n).for_each(|at| spread[at % n + at / n * ld] = k[at]);
    if host.turn() {
        let at = host.bytes.below(spread.len());
        spread[at] = host.bytes.wild();
    }
    (spread, ld)
}

fn dense(host: &mut Host, body: usize, storage: i32) {
    let value = host.bodies[body].k.clone();
    let order = host.bodies[body].n;
    let (k, ld) = columns(host, order, &value);
    let (p, at, n, k) = (host.handle(), host.known(body), host.known(order), host.array(&k));
    // SAFETY: k holds ld * n numbers; a spoilt ld is smaller or refused.
    let status = unsafe {
        feti_body_stiffness_dense(p, at, n, k, host.length(ld), host.code(storage), host.code(FETI_COPY))
    };
    if host.done(status, &[]) {
        host.changed();
        took(host, at, Given { dense: true, diagonal: None, value }, None);
    }
}

/// New values on the pattern of the matrix: the old ones times a number, or with one of them wild; those that are lent
/// rewritten in place, or others lent instead of them.
pub fn values(host: &mut Host, body: usize) {
    let Some(mut given) = host.bodies[body].given.clone() else { return };
    let order = host.bodies[body].n;
    let by = [1.0, 2.0, 0.5, 1.25, -1.0][host.bytes.below(5)];
    given.value.iter_mut().chain(given.diagonal.iter_mut().flatten()).for_each(|value| *value *= by);
    if !given.value.is_empty() && host.bytes.chance(16) {
        let at = host.bytes.below(given.value.len());
        given.value[at] = host.bytes.wild();
    }
    if given.dense {
        let (k, ld) = columns(host, order, &given.value);
        let (p, at, n, k) = (host.handle(), host.known(body), host.known(order), host.array(&k));
        // SAFETY: k holds ld * n numbers; a spoilt ld is smaller or refused.
        let status = unsafe { feti_body_values_dense(p, at, n, k, host.length(ld)) };
        return renewed(host, status, at, given, None);
    }
    let mut value = given.value.clone();
    let old = host.lent[body].value.take();
    if let Some(mut old) = old {
        if host.bytes.below(2) == 1 {
            // A call that is refused for another argument would not hear of the new values.
            host.plain();
            host.changed();
            old.copy_from_slice(&value);
            value = old;
        } else {
            host.lent[body].value = Some(old);
        }
    }
    let (p, at, nnz) = (host.handle(), host.known(body), host.known(value.len()));
    let status = match &given.diagonal {
        None => {
            let value = host.array(&value);
            // SAFETY: as many numbers as the pattern has.
            unsafe { feti_body_values(p, at, nnz, value) }
        }
        Some(diagonal) => {
            let (n, diagonal, value) = (host.known(order), host.array(diagonal), host.array(&value));
            // SAFETY: as many numbers as the pattern has.
            unsafe { feti_body_values_split(p, at, n, diagonal, nnz, value) }
        }
    };
    renewed(host, status, at, given, Some(value));
}

/// After new values: the array stays as long as the matrix may be lent.
fn renewed(host: &mut Host, status: i32, body: i64, given: Given, value: Option<Vec<f64>>) {
    let taken = host.done(status, &[]);
    let Some(value) = value else {
        if taken {
            host.changed();
        }
        return;
    };
    if taken {
        host.changed();
        let (body, right) = (body as usize, !host.spoilt());
        host.bodies[body].given = right.then_some(given);
        let lent = &mut host.lent[body];
        lent.value = lent.pattern.is_some().then_some(value);
    } else if let Some(lent) = usize::try_from(body).ok().and_then(|body| host.lent.get_mut(body)) {
        // Rewritten in place and refused: still where it was.
        if lent.pattern.is_some() && lent.value.is_none() {
            lent.value = Some(value);
        }
    }
}

/// K and K+ of a body that the host keeps, by columns, and when its functions give up.
pub struct Keeper {
    n: usize,
    k: Vec<f64>,
    kplus: Vec<f64>,
    /// Products until a function reports a failure; never on threads of the library.
    left: std::sync::atomic::AtomicI64,
}

impl Keeper {
    /// Y = A X, all columns n long.
    unsafe fn multiply(&self, a: &[f64], [nrhs, ldx, ldy]: [i64; 3], x: *const f64, y: *mut f64) -> i32 {
        if self.left.fetch_sub(1, std::sync::atomic::Ordering::Relaxed) <= 0 {
            return 7;
        }
        let (n, columns) = (self.n, nrhs as usize);
        for j in 0..columns {
            // SAFETY: column j of X and Y, by the word of the library.
            let (x, y) = unsafe {
                let x = std::slice::from_raw_parts(x.add(j * ldx as usize), n);
                (x, std::slice::from_raw_parts_mut(y.add(j * ldy as usize), n))
            };
            (0..n).for_each(|i| y[i] = (0..n).map(|l| a[i + l * n] * x[l]).sum());
        }
        0
    }
}

macro_rules! product {
    ($name:ident, $matrix:ident) => {
        unsafe extern "C" fn $name(
            user: *mut c_void,
            _body: i64,
            n: i64,
            nrhs: i64,
            x: *const f64,
            ldx: i64,
            y: *mut f64,
            ldy: i64,
        ) -> i32 {
            // SAFETY: user is the keeper that was named, which stays as long as the functions are known.
            let keeper = unsafe { &*user.cast::<Keeper>() };
            assert!(n as usize == keeper.n && nrhs > 0 && ldx >= n && ldy >= n);
            // SAFETY: X and Y are those of the library.
            unsafe { keeper.multiply(&keeper.$matrix, [nrhs, ldx, ldy], x, y) }
        }
    };
}
product!(times_k, k);
product!(times_kplus, kplus);

/// Functions for K and K+ = (K + s R R')^-1 in place of the matrix.
pub fn operator(host: &mut Host, body: usize) {
    let model = &host.bodies[body];
    let (order, choice) = (model.n, host.bytes.byte());
    let stiffest = (0..order).map(|i| model.k[i + i * order].abs()).fold(1.0, f64::max);
    let mut kplus = model.k.clone();
    for (at, entry) in kplus.iter_mut().enumerate() {
        let (i, j) = (at % order, at / order);
        *entry += stiffest
            * (0..model.r()).map(|l| model.modes[i + l * order] * model.modes[j + l * order]).sum::<f64>();
    }
    invert(order, &mut kplus);
    if choice > 240 {
        kplus[usize::from(choice) % (order * order)] += 0.5;
    }
    let diagonal: Vec<f64> = (0..order).map(|i| model.k[i + i * order]).collect();
    let concurrent = i32::from(choice & 1);
    let left = if concurrent == 0 && choice >> 1 & 7 == 7 { i64::from(host.bytes.byte()) } else { i64::MAX };
    let keeper = Box::new(Keeper { n: order, k: model.k.clone(), kplus, left: left.into() });
    let user = std::ptr::from_ref(&*keeper).cast_mut().cast();
    let (p, at, n, diagonal) = (host.handle(), host.known(body), host.known(order), host.array(&diagonal));
    let (first, second): (feti_operator_fn, feti_operator_fn) =
        (if host.turn() { None } else { Some(times_kplus) }, if host.turn() { None } else { Some(times_k) });
    // SAFETY: the keeper stays until other functions or a matrix take its place.
    let status =
        unsafe { feti_body_operator(p, at, n, diagonal, first, second, host.code(concurrent), user) };
    if host.done(status, &[]) {
        host.changed();
        host.may_refuse |= left < i64::MAX;
        host.bodies[at as usize].given = None;
        host.lent[at as usize] = Lent { pattern: Some(keeper), value: None };
    }
}

/// Gauss and Jordan with row pivots, in place; any numbers when the matrix is singular.
fn invert(n: usize, a: &mut [f64]) {
    let mut inverse: Vec<f64> = (0..n * n).map(|at| f64::from(u8::from(at % n == at / n))).collect();
    for j in 0..n {
        let pivot =
            (j..n).fold(j, |best, i| if a[i + j * n].abs() > a[best + j * n].abs() { i } else { best });
        for matrix in [&mut *a, &mut inverse[..]] {
            (0..n).for_each(|l| matrix.swap(j + l * n, pivot + l * n));
        }
        let by = 1.0 / a[j + j * n];
        for matrix in [&mut *a, &mut inverse[..]] {
            (0..n).for_each(|l| matrix[j + l * n] *= by);
        }
        for i in (0..n).filter(|i| *i != j) {
            let by = a[i + j * n];
            for matrix in [&mut *a, &mut inverse[..]] {
                (0..n).for_each(|l| matrix[i + l * n] -= by * matrix[j + l * n]);
            }
        }
    }
    for j in 0..n {
        (0..n).for_each(|i| a[i + j * n] = 0.5 * (inverse[i + j * n] + inverse[j + i * n]));
    }
}
