//! The stiffness matrix of a body in one of its forms; here by its profile and by triplets.

use feti_contact_c::*;

use super::give::{narrow, spoil_indices};
use super::host::Host;
use super::models::Given;
use super::stiffness::{stiffness, took};

/// Bits of the form: base, profile or triplets, width of the indices, direction or storage, a diagonal by itself.
pub fn matrix(host: &mut Host, body: usize) {
    let form = host.bytes.byte();
    if form & 3 != 3 || form >> 4 & 3 == 0 {
        stiffness(host, body, form);
    } else if form >> 3 & 1 == 0 {
        by_profile(host, body, form);
    } else {
        by_triplets(host, body, form);
    }
}

/// A value at most is spoilt.
fn spoil(host: &mut Host, value: &mut [f64]) {
    if !value.is_empty() && host.turn() {
        let at = host.bytes.below(value.len());
        value[at] = host.bytes.wild();
    }
}

fn by_profile(host: &mut Host, body: usize, form: u8) {
    let model = &host.bodies[body];
    let (order, base, split) = (model.n, i64::from(form >> 2 & 1), form >> 7 == 1);
    let direction = [FETI_SKYLINE_DOWN, FETI_SKYLINE_UP][usize::from(form >> 6 & 1)];
    let (mut pointer, mut value) = (vec![base], Vec::new());
    for j in 0..order {
        let first = (0..j).find(|i| model.k[i + j * order] != 0.0).unwrap_or(j);
        let mut column: Vec<f64> = (first..j + usize::from(!split)).map(|i| model.k[i + j * order]).collect();
        if direction == FETI_SKYLINE_UP {
            column.reverse();
        }
        value.extend(column);
        pointer.push(value.len() as i64 + base);
    }
    let diagonal: Option<Vec<f64>> = split.then(|| (0..order).map(|i| model.k[i + i * order]).collect());
    spoil_indices(host, &mut pointer, true);
    spoil(host, &mut value);
    let (p, at, n) = (host.handle(), host.known(body), host.known(order));
    let diag = diagonal.as_ref().map_or(std::ptr::null(), |diagonal| host.array(diagonal));
    let (ptr, val, short) = (host.array(&pointer), host.array(&value), narrow(&pointer));
    let (base, direction, flags) = (host.code(base as i32), host.code(direction), host.code(FETI_COPY));
    // SAFETY: the last pointer is at most the number of values.
    let status = unsafe {
        if form >> 4 & 3 == 1 || ptr.is_null() {
            feti_body_stiffness_skyline_i64(p, at, n, diag, ptr, val, base, direction, flags)
        } else {
            feti_body_stiffness_skyline_i32(p, at, n, diag, short.as_ptr(), val, base, direction, flags)
        }
    };
    if host.done(status, &[]) {
        host.changed();
        took(host, at, Given { dense: false, diagonal, value }, None);
    }
}

/// Every entry in two parts.
fn by_triplets(host: &mut Host, body: usize, form: u8) {
    let model = &host.bodies[body];
    let (order, base) = (model.n, i64::from(form >> 2 & 1));
    let storage = [FETI_FULL, FETI_LOWER, FETI_UPPER][usize::from(form >> 6 & 3) % 3];
    let (mut row, mut column, mut value) = (Vec::new(), Vec::new(), Vec::new());
    for part in [2.0, -1.0] {
        for at in (0..order * order).filter(|at| model.k[*at] != 0.0) {
            let (i, j) = (at % order, at / order);
            if storage == FETI_FULL || (storage == FETI_LOWER) == (i > j) || i == j {
                row.push(i as i64 + base);
                column.push(j as i64 + base);
                value.push(part * model.k[at]);
            }
        }
    }
    spoil_indices(host, &mut row, false);
    spoil_indices(host, &mut column, false);
    spoil(host, &mut value);
    let (p, at, n, nnz) = (host.handle(), host.known(body), host.known(order), host.length(value.len()));
    let (rows, columns, val) = (host.array(&row), host.array(&column), host.array(&value));
    let (base, storage, flags) = (host.code(base as i32), host.code(storage), host.code(FETI_COPY));
    let short = (narrow(&row), narrow(&column));
    // SAFETY: as many numbers as said, or fewer.
    let status = unsafe {
        if form >> 4 & 3 == 1 || rows.is_null() || columns.is_null() {
            feti_body_stiffness_triplets_i64(p, at, n, nnz, rows, columns, val, base, storage, flags)
        } else {
            let (rows, columns) = (short.0.as_ptr(), short.1.as_ptr());
            feti_body_stiffness_triplets_i32(p, at, n, nnz, rows, columns, val, base, storage, flags)
        }
    };
    if host.done(status, &[]) {
        host.changed();
        took(host, at, Given { dense: false, diagonal: None, value }, None);
    }
}
