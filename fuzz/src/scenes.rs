//! Whole problems that have a solution, of a few unknowns.

use super::bytes::Bytes;
use super::give::{self, Row};
use super::host::Host;
use super::models::{self, Model};
use super::{forms, stiffness};

/// Bodies with their loads, rows of both kinds.
struct Scene {
    bodies: Vec<(Model, Vec<f64>)>,
    contact: Vec<Row>,
    equalities: Vec<Row>,
}

/// Blocks in a line, pushed against a wall: all but the first may float.
fn line(bytes: &mut Bytes) -> Scene {
    let mut scene = Scene { bodies: Vec::new(), contact: Vec::new(), equalities: Vec::new() };
    let count = 1 + bytes.below(4);
    for b in 0..count {
        let n = 1 + bytes.below(4);
        let held = if b == 0 || bytes.chance(64) { bytes.positive() } else { 0.0 };
        let push = (0..n).map(|_| -bytes.positive()).collect();
        if b > 0 {
            let last = scene.bodies[b - 1].0.n - 1;
            let tied = bytes.chance(32);
            let row =
                (vec![(b - 1, last, 1.0), (b, 0, -1.0)], if tied { 0.0 } else { bytes.positive() - 0.125 });
            if tied {
                scene.equalities.push(row)
            } else {
                scene.contact.push(row)
            }
        }
        scene.bodies.push((models::chain(bytes, n, held), push));
    }
    scene
}

/// A floating grid of squares on one that is held, pushed down, held against sliding by one row.
fn stack(bytes: &mut Bytes) -> Scene {
    let (nx, low, high) = (1 + bytes.below(2), 1 + bytes.below(2), 1);
    let (below, above) = (models::grounded_grid(nx, low, bytes.positive()), models::grid(nx, high));
    let top = 2 * (nx + 1) * low;
    let weight = bytes.positive();
    let fall = (0..above.n).map(|i| if i % 2 == 1 { -weight } else { 0.0 }).collect();
    let gap = f64::from(bytes.byte() % 8) / 8.0;
    let contact = (0..=nx).map(|i| (vec![(0, top + 2 * i + 1, 1.0), (1, 2 * i + 1, -1.0)], gap)).collect();
    let slide = (vec![(0, top, 1.0), (1, 0, -1.0)], 0.0);
    let rest = vec![0.0; below.n];
    Scene { bodies: vec![(below, rest), (above, fall)], contact, equalities: vec![slide] }
}

/// Bodies without null space; no displacement is among what the rows allow.
fn held(bytes: &mut Bytes) -> Scene {
    let bodies: Vec<_> = (0..1 + bytes.below(2))
        .map(|_| {
            let n = 1 + bytes.below(5);
            let model = models::definite(bytes, n);
            let load = (0..model.n).map(|_| bytes.number()).collect();
            (model, load)
        })
        .collect();
    let mut row = |right: bool| {
        let entries = (0..1 + bytes.below(3)).map(|_| {
            let body = bytes.below(bodies.len());
            (body, bytes.below(bodies[body].0.n), bytes.number())
        });
        (entries.collect(), if right { bytes.positive() } else { 0.0 })
    };
    let contact = (0..3).map(|_| row(true)).collect();
    let equalities = if bodies.len() > 1 { vec![row(false)] } else { Vec::new() };
    Scene { bodies, contact, equalities }
}

/// Hands a whole problem over, in right calls.
pub fn hand_over(host: &mut Host, which: usize) {
    let scene = match which {
        0 => line(&mut host.bytes),
        1 => stack(&mut host.bytes),
        _ => held(&mut host.bytes),
    };
    host.plain();
    let known = host.bytes.byte();
    let first = host.bodies.len();
    for (model, load) in scene.bodies {
        let Some(body) = give::body(host, model) else { return };
        // One scene in eight is of bodies whose stiffness the host keeps.
        let kept = known >> 2 & 7 == 7;
        if kept {
            stiffness::operator(host, body);
        } else {
            forms::matrix(host, body);
        }
        match known & 3 {
            _ if kept => give::null_space(host, body),
            0 | 1 => give::null_space(host, body),
            2 if !host.bodies[body].xy.is_empty() => give::coordinates(host, body),
            _ => {}
        }
        give::load(host, body, Some(load));
    }
    let moved = |rows: Vec<Row>| {
        let shift =
            |(entries, right): Row| (entries.into_iter().map(|(b, d, v)| (b + first, d, v)).collect(), right);
        rows.into_iter().map(shift).collect::<Vec<Row>>()
    };
    give::rows(host, 0, &moved(scene.contact));
    give::rows(host, 1, &moved(scene.equalities));
}
