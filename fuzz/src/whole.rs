//! Calls over all bodies at once, numbers of the host, what is known of a body, lines of the log, options by one text.

use std::ffi::{c_char, c_void, CStr};

use feti_contact_c::*;

use super::ask::sized;
use super::buffers::Out;
use super::give::{narrow, pick};
use super::host::Host;
use super::listeners::Listener;

/// Arrays over more unknowns are not made.
const MOST: usize = 1024;

/// The host's numbers of the unknowns of a body: one body after the other, backwards, or with gaps.
pub fn numbering(host: &mut Host) {
    let Some(body) = pick(host) else { return };
    let (n, form) = (host.bodies[body].n, host.bytes.byte());
    let before = host.bodies[..body].iter().map(|b| b.n).fold(0, usize::saturating_add);
    if before > MOST {
        return;
    }
    let base = i64::from(form & 1);
    let number = |i: usize| match form >> 1 & 3 {
        0 | 1 => before + i,
        2 => before + n - 1 - i,
        _ => 3 * (before + i) + 1,
    };
    let mut numbers: Vec<i64> = (0..n).map(|i| number(i) as i64 + base).collect();
    if host.turn() {
        let at = host.bytes.below(n);
        numbers[at] = [-1, 0, 1, numbers[0], 1 << 30, i64::MAX][host.bytes.below(6)];
    }
    let short = narrow(&numbers);
    let (p, at, n) = (host.handle(), host.known(body), host.known(n));
    // SAFETY: n numbers.
    let status = unsafe {
        if form >> 3 & 1 == 1 {
            let numbers = host.array(&numbers);
            feti_body_numbering_i64(p, at, n, numbers, host.code(base as i32))
        } else {
            let numbers = host.array(&short);
            feti_body_numbering_i32(p, at, n, numbers, host.code(base as i32))
        }
    };
    if host.done(status, &[]) {
        host.numbered = true;
        host.changed();
    }
}

/// Length of an array over all unknowns, by the host's numbers where there are some.
fn length(host: &Host) -> Option<usize> {
    let all = host.bodies.iter().map(|b| b.n).fold(0, usize::saturating_add);
    (all <= MOST).then_some(if host.numbered { 3 * all + 8 } else { all })
}

/// Loads, displacements and reactions of all bodies.
pub fn all_bodies(host: &mut Host) {
    let Some(n) = length(host) else { return };
    if host.bytes.chance(128) {
        let f = host.numbers(n);
        let (p, n, f) = (host.handle(), host.length(n), host.array(&f));
        // SAFETY: n numbers.
        let status = unsafe { feti_body_load(p, FETI_ALL, n, f) };
        host.done(status, &[]);
        host.changed();
        return;
    }
    let (mut u, mut force) = (Out::<f64>::new(n), Out::<f64>::new(n));
    let kind = host.bytes.below(3) as i32;
    // SAFETY: room for n numbers.
    unsafe {
        let (p, room) = (host.handle(), host.length(n));
        let status = feti_displacement(p, FETI_ALL, room, host.out(&mut u));
        host.done(status, &[&u]);
        let (p, code, room) = (host.handle(), host.code(kind), host.length(n));
        let status = feti_reaction(p, code, FETI_ALL, room, host.out(&mut force));
        host.done(status, &[&force]);
    }
}

/// Connected parts and facts of a body.
pub fn of_body(host: &mut Host) {
    let Some(body) = pick(host) else { return };
    let n = host.bodies[body].n;
    let (mut part, mut facts) = (Out::<i64>::new(n), sized!(host, feti_body_facts));
    // SAFETY: room for n numbers; the struct has the size it says, or a size that is refused.
    unsafe {
        let (p, at, length) = (host.handle(), host.known(body), host.known(n));
        let status = feti_body_components(p, at, length, host.out(&mut part));
        if host.done(status, &[&part]) {
            assert!(part.cells[0] == 0 && part.cells.iter().all(|k| (0..n as i64).contains(k)));
        }
        let (p, at) = (host.handle(), host.known(body));
        let status = feti_body_info(p, at, &mut facts);
        if host.done(status, &[]) && !host.spoilt() {
            assert_eq!(facts.unknowns, n as i64);
        }
    }
}

/// Hears lines of the log: texts of one line, of no other level than it has asked for.
extern "C" fn hear(user: *mut c_void, level: i32, text: *const c_char) -> i32 {
    // SAFETY: user is the listener of the host; the text ends with NUL.
    unsafe {
        let listener = &mut *user.cast::<Listener>();
        let text = CStr::from_ptr(text).to_str().expect("UTF-8");
        assert!((FETI_LOG_RESULT..=listener.level).contains(&level), "level {level}");
        assert!(!text.is_empty() && !text.contains('\n'), "{text:?}");
        listener.left = listener.left.saturating_sub(1);
        if listener.left == 0 {
            5
        } else {
            0
        }
    }
}

pub fn log(host: &mut Host) {
    let level = host.bytes.below(4) as i32;
    let left = if host.bytes.chance(64) { 1 + u64::from(host.bytes.byte()) } else { u64::MAX };
    let function: feti_log_fn = if host.bytes.chance(32) { None } else { Some(hear) };
    let mut listener = Box::new(Listener { level: FETI_LOG_STEP, left });
    let user: *mut Listener = &mut *listener;
    let (p, level) = (host.handle(), host.code(level));
    // SAFETY: the listener stays until another one takes its place.
    let status = unsafe { feti_on_log(p, function, level, user.cast()) };
    if host.done(status, &[]) {
        listener.level = level;
        host.may_refuse |= left < u64::MAX;
        host.listener = Some(listener);
    }
}

/// Several options by one text.
pub fn options(host: &mut Host) {
    const TEXTS: [&CStr; 10] = [
        c"tolerance=1e-6 max_steps=20",
        c"threads=2, method=paper-monotone",
        c"method=proportioning preconditioner=dirichlet",
        c"finish=direct\n# comment\ndual_operator=implicit",
        c"start=previous",
        c"threads=1 tolerance=1e-10",
        c"tolerance=1e-6 threads=-1",
        c"=",
        c"max_steps=7 max_steps",
        c"preconditioner=lumped dual_operator=explicit",
    ];
    let text = TEXTS[host.bytes.below(TEXTS.len())];
    let text = if host.turn() { std::ptr::null() } else { text.as_ptr() };
    // SAFETY: a text or NULL.
    let status = unsafe { feti_set_text(host.handle(), text) };
    host.done(status, &[]);
}
