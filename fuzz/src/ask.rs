//! The calls that set up, solve, and read what is there.

use feti_contact_c::*;

use super::buffers::{Cell, Out, Written};
use super::give::pick;
use super::host::{Host, KINDS};

/// A struct of the library, all zeros but for its size.
macro_rules! sized {
    ($host:ident, $type:ty) => {{
        // SAFETY: zeros are a value of numbers and pointers.
        let mut value: $type = unsafe { std::mem::zeroed() };
        let full = size_of::<$type>() as i64;
        value.struct_size =
            if $host.turn() { [-1, 0, 15, 16, 40, i64::MIN][$host.bytes.below(6)] } else { full };
        value
    }};
}
pub(super) use sized;

pub fn setup(host: &mut Host) {
    let status = feti_setup(host.handle());
    host.note(status);
    host.changed();
}

/// Solves; an answer with FETI_OK must pass its own certificate.
pub fn solve(host: &mut Host) {
    let mut info = sized!(host, feti_info);
    let with = host.bytes.byte() != 1;
    // SAFETY: the struct has the size it says, or a size that is refused.
    let status = unsafe { feti_solve(host.handle(), if with { &mut info } else { std::ptr::null_mut() }) };
    host.note(status);
    host.changed();
    if with {
        let full = info.struct_size == size_of::<feti_info>() as i64;
        assert!(!full || info.status == status, "info says {}, not {status}", info.status);
        let figures = [info.worst, info.energy, info.equilibrium];
        figures.iter().for_each(|figure| host.digest.feed(figure.to_bits()));
        let counts = [info.steps, info.active, info.undetermined];
        counts.iter().for_each(|count| host.digest.feed(*count as u64));
    }
    if status == FETI_OK {
        host.certified += 1;
        certify(host);
    }
}

/// u, lambda, mu, lambda_t of the last answer.
fn answer(host: &Host) -> [Vec<f64>; 4] {
    let [mut u, mut lambda, mut mu] = [Vec::new(), vec![0.0; host.rows[0]], vec![0.0; host.rows[1]]];
    let mut tangential = vec![0.0; host.nodes * host.dim];
    // SAFETY: every array has the length that is named.
    unsafe {
        for (k, body) in host.bodies.iter().enumerate() {
            let mut part = vec![0.0; body.n];
            assert_eq!(feti_displacement(host.p, k as i64, body.n as i64, part.as_mut_ptr()), FETI_OK);
            u.extend(part);
        }
        assert_eq!(feti_multipliers(host.p, KINDS[0], host.rows[0] as i64, lambda.as_mut_ptr()), FETI_OK);
        assert_eq!(feti_multipliers(host.p, KINDS[1], host.rows[1] as i64, mu.as_mut_ptr()), FETI_OK);
        let (rows, to) = (tangential.len() as i64, tangential.as_mut_ptr());
        assert_eq!(feti_multipliers(host.p, FETI_TANGENTIAL, rows, to), FETI_OK);
    }
    [u, lambda, mu, tangential]
}

/// The answer is finite, and feti_check_friction accepts what feti_solve has accepted.
fn certify(host: &mut Host) {
    let [u, lambda, mu, tangential] = answer(host);
    assert!(
        [&u, &lambda, &mu, &tangential].into_iter().flatten().all(|value| value.is_finite()),
        "an infinite answer"
    );
    host.plain();
    let mut out = sized!(host, feti_certificate);
    let [n, rows, eqs] = [u.len() as i64, lambda.len() as i64, mu.len() as i64];
    let (nodes, dim, t) = (host.nodes as i64, host.dim as i32, tangential.as_ptr());
    let (u, lambda, mu) = (u.as_ptr(), lambda.as_ptr(), mu.as_ptr());
    // SAFETY: every array has the length that is named.
    let status = unsafe { feti_check_friction(host.p, n, u, rows, lambda, eqs, mu, nodes, dim, t, &mut out) };
    host.note(status);
    // Functions of the host that have counted to their end are no answer.
    let ended = status == FETI_CALLBACK && host.may_refuse;
    assert!(ended || status == FETI_OK && out.passed == 1, "status {status}, worst {}", out.worst);
}

/// Certifies any numbers, with arguments that may be spoilt.
pub fn check(host: &mut Host) {
    let unknowns = host.bodies.iter().map(|body| body.n).fold(0, usize::saturating_add).min(256);
    let (u, lambda, mu) = (host.numbers(unknowns), host.numbers(host.rows[0]), host.numbers(host.rows[1]));
    let mut out = sized!(host, feti_certificate);
    let (p, n, u) = (host.handle(), host.known(u.len()), host.array(&u));
    let (rows, lambda) = (host.known(lambda.len()), host.array(&lambda));
    let eqs = host.known(mu.len());
    // SAFETY: lengths that are not the problem's are refused.
    let status = unsafe { feti_check(p, n, u, rows, lambda, eqs, host.array(&mu), &mut out) };
    host.done(status, &[]);
    host.digest.feed(out.worst.to_bits());
}

/// Every result of the last solve.
pub fn results(host: &mut Host) {
    for kind in 0..2 {
        let rows = host.rows[kind];
        let mut out = Out::<f64>::new(rows);
        let (p, code, n) = (host.handle(), KINDS[kind], host.known(rows));
        // SAFETY: `rows` numbers, for a length the library knows.
        let status = unsafe { feti_multipliers(p, code, n, host.out(&mut out)) };
        host.done(status, &[&out]);
    }
    let (mut slack, mut state) = (Out::<f64>::new(host.rows[0]), Out::<i32>::new(host.rows[0]));
    // SAFETY: as above.
    unsafe {
        let status = feti_gaps(host.handle(), host.known(host.rows[0]), host.out(&mut slack));
        host.done(status, &[&slack]);
        let status = feti_active(host.handle(), host.known(host.rows[0]), host.out(&mut state));
        host.done(status, &[&state]);
    }
    super::friction::results(host);
    if let Some(body) = pick(host) {
        of_body(host, body);
    }
}

fn of_body(host: &mut Host, body: usize) {
    let (n, r) = (host.bodies[body].n, host.bodies[body].r());
    let (mut u, mut force, mut alpha) = (Out::<f64>::new(n), Out::<f64>::new(n), Out::<f64>::new(r));
    let kind = host.bytes.below(3) as i32;
    // SAFETY: lengths that are not the body's are refused.
    unsafe {
        let status = feti_displacement(host.handle(), host.known(body), host.known(n), host.out(&mut u));
        host.done(status, &[&u]);
        let (p, code) = (host.handle(), host.code(kind));
        let status = feti_reaction(p, code, host.known(body), host.known(n), host.out(&mut force));
        host.done(status, &[&force]);
        let status = feti_amplitudes(host.handle(), host.known(body), host.known(r), host.out(&mut alpha));
        host.done(status, &[&alpha]);
    }
}

/// What the library has found out about a problem without solution, or with many.
pub fn diagnosis(host: &mut Host) {
    let mut findings = sized!(host, feti_findings);
    // SAFETY: the struct has the size it says, or a size that is refused.
    let status = unsafe { feti_diagnosis(host.handle(), &mut findings) };
    host.done(status, &[]);
    host.digest.feed(findings.margin.to_bits());
    let (k, cap) = (host.bytes.below(3), host.bytes.below(4));
    let (mut count, mut rows, mut weight) = (Out::<i64>::new(1), Out::<i64>::new(cap), Out::<f64>::new(cap));
    let kind = KINDS[host.bytes.below(2)];
    // SAFETY: room for `cap` rows; a spoilt cap is smaller or refused.
    unsafe {
        let (p, code, cap) = (host.handle(), host.code(kind), host.length(cap));
        let (at, row) = (host.out(&mut count), host.out(&mut rows));
        let status = feti_diagnosis_rows(p, code, cap, at, row, host.out(&mut weight));
        host.done(status, &[&count, &rows, &weight]);
    }
    lists(host, cap);
    motions(host, k);
}

fn lists(host: &mut Host, cap: usize) {
    for call in [feti_diagnosis_dependent, feti_diagnosis_untouched] {
        let (mut count, mut list) = (Out::<i64>::new(1), Out::<i64>::new(cap));
        let (p, cap, at) = (host.handle(), host.length(cap), host.out(&mut count));
        // SAFETY: room for `cap` numbers.
        let status = unsafe { call(p, cap, at, host.out(&mut list)) };
        host.done(status, &[&count, &list]);
    }
}

fn motions(host: &mut Host, k: usize) {
    let (mut body_at, mut motion) = (Out::<i64>::new(1), Out::<f64>::new(6));
    // SAFETY: the arrays have the lengths of the header.
    unsafe {
        let (p, k, body) = (host.handle(), host.known(k), host.out(&mut body_at));
        let status = feti_diagnosis_undetermined(p, k, body, host.out(&mut motion));
        host.done(status, &[&body_at, &motion]);
    }
    let Some(body) = pick(host) else { return };
    let n = host.bodies[body].n;
    let (mut v, mut w) = (Out::<f64>::new(n), Out::<f64>::new(n));
    // SAFETY: lengths that are not the body's are refused.
    unsafe {
        let (p, k, body_at) = (host.handle(), host.known(k), host.known(body));
        let status = feti_diagnosis_undetermined_motion(p, k, body_at, host.known(n), host.out(&mut v));
        host.done(status, &[&v]);
        let status = feti_diagnosis_motion(host.handle(), host.known(body), host.known(n), host.out(&mut w));
        host.done(status, &[&w]);
    }
}

/// After a call that runs the setup when it is due.
fn set_up(host: &mut Host, status: i32, written: &[&dyn Written]) {
    host.changed();
    host.done(status, written);
}

/// Null space and fixing unknowns that the library works with.
pub fn null_space(host: &mut Host) {
    let Some(body) = pick(host) else { return };
    let (n, fit) = (host.bodies[body].n, host.bytes.below(4));
    let ld = n + host.bytes.below(2);
    let (mut r, mut basis) = (Out { cells: vec![fit as i64] }, Out::<f64>::new(ld * fit));
    // SAFETY: room for `fit` columns.
    unsafe {
        let (p, body_at, n) = (host.handle(), host.known(body), host.known(n));
        let (at, to) = (host.out(&mut r), host.out(&mut basis));
        let status = feti_body_null_space_get(p, body_at, n, at, to, host.length(ld));
        set_up(host, status, &[&basis]);
        let found = r.cells[0].clamp(0, 8) as usize;
        // After a failure `found` is a guess, and `known` may turn it into what is right: one more.
        let mut dofs = Out::<i64>::new(found + 1);
        let (p, body_at) = (host.handle(), host.known(body));
        let status = feti_body_fixing(p, body_at, host.known(found), host.out(&mut dofs));
        set_up(host, status, &[&dofs]);
    }
}

/// K+ of a body, the dual operator and its right-hand side.
pub fn operators(host: &mut Host) {
    let m = host.rows[0] + host.rows[1];
    let x = host.numbers(m);
    let (mut y, mut d) = (Out::<f64>::new(m), Out::<f64>::new(m));
    // SAFETY: m numbers, for a length the library knows.
    unsafe {
        let (p, n, x) = (host.handle(), host.known(m), host.array(&x));
        let status = feti_dual_apply(p, n, x, host.out(&mut y));
        set_up(host, status, &[&y]);
        let status = feti_dual_rhs(host.handle(), host.known(m), host.out(&mut d));
        set_up(host, status, &[&d]);
    }
    let Some(body) = pick(host) else { return };
    let (n, columns) = (host.bodies[body].n, host.bytes.below(3));
    let ld = n + host.bytes.below(2);
    let (x, mut y) = (host.numbers(ld * columns), Out::<f64>::new(ld * columns));
    // SAFETY: ld * columns numbers; spoilt lengths are smaller or refused.
    unsafe {
        let (p, body, n, columns) = (host.handle(), host.known(body), host.known(n), host.length(columns));
        let (x, ldx, to) = (host.array(&x), host.length(ld), host.out(&mut y));
        let status = feti_body_kplus(p, body, n, columns, x, ldx, to, host.length(ld));
        set_up(host, status, &[&y]);
    }
}

/// Texts, counts and phases.
pub fn facts(host: &mut Host) {
    let mut counts: [Out<i64>; 4] = std::array::from_fn(|_| Out::new(1));
    let cap = host.bytes.below(64);
    let (mut text, mut length) = (Out::<u8>::new(cap), Out::<i64>::new(1));
    let mut detail = sized!(host, feti_error_detail);
    let mut phase = sized!(host, feti_phase);
    // SAFETY: every array has the length that is named, spoilt lengths are smaller or refused.
    unsafe {
        let p = host.handle();
        let [bodies, dofs, rows, eqs] = counts.each_mut().map(|count| host.out(count));
        let status = feti_counts(p, bodies, dofs, rows, eqs);
        let written: Vec<&dyn Written> = counts.iter().map(|count| count as &dyn Written).collect();
        if host.done(status, &written) {
            let found = [counts[0].cells[0], counts[2].cells[0], counts[3].cells[0]];
            let mine = [host.bodies.len(), host.rows[0], host.rows[1]].map(|n| n as i64);
            let same = |(a, b): (i64, i64)| a == b || a == i64::PATTERN;
            assert!(found.into_iter().zip(mine).all(same), "{found:?}, not {mine:?}");
        }
        let (p, to) = (host.handle(), host.out(&mut text));
        let status = feti_problem_error(p, to.cast(), host.room(cap), host.out(&mut length));
        host.done(status, &[&length]);
        feti_last_error(host.out(&mut text).cast(), cap as i64);
        feti_last_error_detail(&mut detail);
        let k = host.bytes.below(9);
        let status = feti_phase_at(host.handle(), host.known(k), &mut phase);
        host.done(status, &[]);
    }
}
