//! A sequence of calls: a whole problem or none, then any calls, some with a spoilt argument, and a solve at the end.

use std::sync::atomic::{AtomicU64, Ordering};

use super::buffers::Digest;
use super::host::Host;
use super::{ask, forms, friction, give, scenes, stiffness, whole};

/// Sequences run, and those of them in which a solve was certified (status FETI_OK, accepted by feti_check).
pub static SEQUENCES: AtomicU64 = AtomicU64::new(0);
pub static CERTIFIED: AtomicU64 = AtomicU64::new(0);

/// Calls of one sequence, beside those of the first problem and of the end.
const MOST: usize = 24;

/// Runs the sequence; some twice, which must give the same bits.
pub fn run(data: &[u8]) {
    let (digest, certified) = sequence(data);
    SEQUENCES.fetch_add(1, Ordering::Relaxed);
    CERTIFIED.fetch_add(u64::from(certified > 0), Ordering::Relaxed);
    if data.first().is_some_and(|first| first >> 4 == 15) {
        assert_eq!(sequence(data).0, digest, "the same calls gave other bits");
    }
}

fn sequence(data: &[u8]) -> (Digest, u64) {
    let mut host = Host::new(data);
    let head = host.bytes.byte();
    if head & 3 != 3 {
        scenes::hand_over(&mut host, usize::from(head & 3));
    }
    let mut calls = 0;
    while !host.bytes.used_up() && calls < MOST {
        host.begin();
        one(&mut host);
        calls += 1;
    }
    if head & 4 == 0 {
        host.plain();
        ask::solve(&mut host);
        ask::results(&mut host);
    }
    host.destroy();
    (host.digest, host.certified)
}

fn one(host: &mut Host) {
    let call = host.bytes.below(43);
    match call {
        0 => {
            host.destroy();
            host.create();
        }
        1 | 2 => {
            let model = give::some_model(host);
            give::body(host, model);
        }
        3..=8 => of_body(host, call),
        9 | 10 => {
            let (kind, rows) = (host.bytes.below(2), give::some_rows(host));
            give::rows(host, kind, &rows);
        }
        11 => give::row_numbers(host, false),
        12 => give::row_numbers(host, true),
        13 => give::rows_clear(host),
        14..=16 => give::option(host),
        17 => give::start(host),
        18 | 19 => give::states(host),
        20 => give::progress(host),
        21 => ask::setup(host),
        22..=24 => ask::solve(host),
        25 => ask::check(host),
        26 => ask::results(host),
        27 => ask::diagnosis(host),
        28 => ask::null_space(host),
        29 => ask::operators(host),
        30 => ask::facts(host),
        31 | 32 => {
            if let Some(body) = give::pick(host) {
                stiffness::values(host, body);
            }
        }
        33 => whole::numbering(host),
        34 => whole::all_bodies(host),
        35 => whole::of_body(host),
        36 => {
            if let Some(body) = give::pick(host) {
                stiffness::operator(host, body);
            }
        }
        37 => whole::log(host),
        38 => whole::options(host),
        40..=42 => friction::one(host),
        _ => {
            let which = host.bytes.below(3);
            scenes::hand_over(host, which);
        }
    }
}

fn of_body(host: &mut Host, call: usize) {
    let Some(body) = give::pick(host) else { return };
    match call {
        3 | 4 => {
            // Now and then another matrix of the same size.
            if host.bytes.chance(96) {
                let n = host.bodies[body].n;
                host.bodies[body].k = super::models::any(&mut host.bytes, n).k;
            }
            forms::matrix(host, body);
        }
        5 => give::null_space(host, body),
        6 => give::coordinates(host, body),
        7 => give::load(host, body, None),
        _ => give::fixing(host, body),
    }
}
