//! Nodes with friction: given, changed, committed, read.

use feti_contact_c::*;

use super::buffers::Out;
use super::give::{narrow, pick, spoil_indices};
use super::host::Host;

/// One of the calls.
pub fn one(host: &mut Host) {
    match host.bytes.below(6) {
        0 | 1 => add(host),
        2 => law(host),
        3 => numbers(host),
        4 => commit(host),
        _ => {
            if host.bytes.chance(64) {
                let status = feti_friction_clear(host.handle());
                if host.done(status, &[]) {
                    (host.nodes, host.dim) = (0, 0);
                    host.changed();
                }
            } else {
                results(host);
            }
        }
    }
}

/// Tangential rows of some nodes over the bodies that are there.
fn add(host: &mut Host) {
    let dim = if host.nodes > 0 { host.dim } else { 1 + host.bytes.below(2) };
    let (count, form) = (host.bytes.below(3), host.bytes.byte());
    let base = i64::from(form & 1);
    let (mut pointer, mut body, mut dof, mut value) = (vec![base], Vec::new(), Vec::new(), Vec::new());
    for _ in 0..count * dim {
        for _ in 0..host.bytes.below(3) {
            let Some(b) = pick(host) else { continue };
            body.push(b as i64 + base);
            dof.push(host.bytes.below(host.bodies[b].n) as i64 + base);
            value.push(host.bytes.number());
        }
        pointer.push(dof.len() as i64 + base);
    }
    let rows = host.rows[0];
    let normal = |host: &mut Host| match host.bytes.below(rows + 1) {
        row if row < rows => row as i64 + base,
        _ => base - 1,
    };
    let mut normal: Vec<i64> = (0..count).map(|_| normal(host)).collect();
    let mut coefficient: Vec<f64> = (0..count).map(|_| host.bytes.number().abs() / 8.0).collect();
    let none = coefficient.iter_mut().zip(&normal).filter(|(_, row)| **row < base);
    none.for_each(|(c, _)| *c = 0.0);
    let bound: Vec<f64> = (0..count).map(|_| host.bytes.number().abs()).collect();
    spoil_indices(host, &mut pointer, true);
    spoil_indices(host, &mut body, false);
    spoil_indices(host, &mut dof, false);
    spoil_indices(host, &mut normal, false);
    if host.turn() && count > 0 {
        let at = host.bytes.below(count);
        coefficient[at] = host.bytes.wild();
    }
    let mut first = Out::<i64>::new(1);
    let (p, nodes, code) = (host.handle(), host.length(count), host.code(dim as i32));
    // a dim of two would need twice the rows
    let code = if code > dim as i32 { 3 } else { code };
    let (val, coefficient, bound) = (host.array(&value), host.array(&coefficient), host.array(&bound));
    let base = base as i32;
    // SAFETY: arrays as long as said; the last pointer is at most the number of entries.
    let status = unsafe {
        if form >> 1 & 1 == 0 {
            let [n, ptr, b, d] = [&normal, &pointer, &body, &dof].map(|array| host.array(array));
            let first = host.out(&mut first);
            feti_friction_add_i64(p, nodes, code, n, ptr, b, d, val, base, coefficient, bound, first)
        } else {
            let arrays = [&normal, &pointer, &body, &dof].map(|array| narrow(array));
            let [n, ptr, b, d] = [0, 1, 2, 3].map(|k: usize| host.array(&arrays[k]));
            let first = host.out(&mut first);
            feti_friction_add_i32(p, nodes, code, n, ptr, b, d, val, base, coefficient, bound, first)
        }
    };
    if host.done(status, &[&first]) {
        let added = usize::try_from(nodes).expect("a negative count was taken");
        if added > 0 {
            host.dim = usize::try_from(code).expect("a negative dim was taken");
        }
        host.nodes += added;
        host.changed();
    }
}

/// First node of some, and how many.
fn some(host: &mut Host) -> (usize, usize) {
    let first = host.bytes.below(host.nodes + 1);
    (first, host.nodes - first)
}

fn law(host: &mut Host) {
    let (first, count) = some(host);
    let positive = |values: Vec<f64>| values.into_iter().map(f64::abs).collect::<Vec<_>>();
    let (coefficient, bound) = (positive(host.numbers(count)), positive(host.numbers(count)));
    let both = host.bytes.below(4);
    let (p, first, nodes) = (host.handle(), host.length(first), host.length(count));
    let (c, b) = (host.array(&coefficient), host.array(&bound));
    let (c, b) = (if both == 1 { c } else { std::ptr::null() }, if both == 0 { std::ptr::null() } else { b });
    // SAFETY: count numbers each, or NULL.
    let status = unsafe { feti_friction_law(p, first, nodes, c, b) };
    if host.done(status, &[]) {
        host.changed();
    }
}

/// Slips to count from, or compliances.
fn numbers(host: &mut Host) {
    let (first, count) = some(host);
    let (compliance, dim) = (host.bytes.chance(128), host.dim);
    let values = host.numbers(if compliance { count } else { count * dim });
    let small: Vec<f64> = values.iter().map(|v| v.abs() / 16.0).collect();
    let (p, first, nodes) = (host.handle(), host.length(first), host.length(count));
    // SAFETY: one number or dim numbers for each node; a spoilt dim is refused.
    let status = unsafe {
        if compliance {
            feti_friction_compliance(p, first, nodes, host.array(&small))
        } else {
            let code = host.code(dim as i32);
            feti_friction_reference(p, first, nodes, code, host.array(&values))
        }
    };
    if host.done(status, &[]) {
        host.changed();
    }
}

fn commit(host: &mut Host) {
    let status = feti_friction_commit(host.handle());
    host.done(status, &[]);
}

/// Forces, slips and states of the nodes.
pub fn results(host: &mut Host) {
    let (nodes, dim) = (host.nodes, host.dim);
    let (mut force, mut slip) = (Out::<f64>::new(nodes * dim), Out::<f64>::new(nodes * dim));
    let mut state = Out::<i32>::new(nodes);
    // SAFETY: lengths that are not those of the nodes are refused.
    unsafe {
        let (p, rows) = (host.handle(), host.known(nodes * dim));
        let status = feti_multipliers(p, FETI_TANGENTIAL, rows, host.out(&mut force));
        host.done(status, &[&force]);
        let (p, n, code) = (host.handle(), host.known(nodes), host.code(dim as i32));
        let status = feti_friction_slips(p, n, code, host.out(&mut slip));
        host.done(status, &[&slip]);
        let (p, n) = (host.handle(), host.known(nodes));
        let status = feti_friction_states(p, n, host.out(&mut state));
        host.done(status, &[&state]);
    }
}
