//! Floating beams on more nodes than dense factors take: on springs that only push, and on rigid beds.

use std::f64::consts::PI;

use decks::random::Random;
use decks::{Body, Csr, Deck};
use feti_contact::solver::Outcome;

use crate::scales::{answer, Answer};
use crate::support::hand_over;

/// A beam of unit elements with bending stiffness `ei` under its weight and a point load on one third, over one row per node
/// with these gaps and compliances.
fn beam(nodes: usize, ei: f64, gap: impl Fn(usize) -> f64, compliance: f64) -> Deck {
    let element =
        [[12.0, 6.0, -12.0, 6.0], [6.0, 4.0, -6.0, 2.0], [-12.0, -6.0, 12.0, -6.0], [6.0, 2.0, -6.0, 4.0]];
    let n = 2 * nodes;
    let mut rows = vec![[0.0; 7]; n];
    for first in (0..n - 2).step_by(2) {
        for (i, row) in element.iter().enumerate() {
            row.iter().enumerate().for_each(|(j, k)| rows[first + i][3 + j - i] += ei * k);
        }
    }
    let mut stiffness = Csr::empty(n);
    for (i, row) in rows.iter().enumerate() {
        let entries = row.iter().enumerate().filter(|(_, k)| **k != 0.0);
        stiffness.push_row(&entries.map(|(j, k)| (i + j - 3, *k)).collect::<Vec<_>>());
    }
    let middle = (nodes - 1) as f64 / 2.0;
    let mode = |of: &dyn Fn(usize) -> [f64; 2]| (0..nodes).flat_map(of).collect::<Vec<f64>>();
    let mut load = vec![0.0; n];
    for i in 0..nodes {
        load[2 * i] = if i == 0 || i == nodes - 1 { -500.0 } else { -1000.0 };
    }
    load[2 * (nodes / 3)] -= 3e5;
    let body = Body {
        stiffness,
        null_space: Some(vec![mode(&|_| [1.0, 0.0]), mode(&|i| [i as f64 - middle, 1.0])]),
        load,
        coordinates: (0..n).map(|j| [(j / 2) as f64, 0.0, 0.0]).collect(),
        node: (0..n as i32).map(|j| j / 2 + 1).collect(),
        direction: (0..n).map(|j| [2, 6][j % 2]).collect(),
    };
    let mut deck = Deck::new("beam", vec![body]);
    (0..nodes).for_each(|i| deck.contact.push_compliant(&[(2 * i, -1.0)], gap(i), compliance));
    deck
}

fn found(deck: &Deck) -> Answer {
    let answer = answer(&mut hand_over::problem(deck).unwrap()).unwrap();
    assert_eq!(answer.report.outcome, Outcome::Solved, "{:?}", answer.report.certificate);
    answer
}

/// u of `K + k` on the closed nodes, by the Cholesky factor of its band.
fn pressed(deck: &Deck, k: f64, closed: &[bool]) -> Vec<f64> {
    let body = &deck.bodies[0];
    let (n, mut u) = (body.dofs(), body.load.clone());
    // row i of L: entry i - j in place j
    let mut band = vec![[0.0; 4]; n];
    for i in 0..n {
        body.stiffness.row(i).filter(|(j, _)| *j <= i).for_each(|(j, v)| band[i][i - j] += v);
        band[i][0] += if i % 2 == 0 && closed[i / 2] { k } else { 0.0 };
        for j in i.saturating_sub(3)..=i {
            let before: f64 = (i.saturating_sub(3)..j).map(|l| band[i][i - l] * band[j][j - l]).sum();
            let left = band[i][i - j] - before;
            band[i][i - j] = if i == j { left.sqrt() } else { left / band[j][0] };
        }
    }
    for i in 0..n {
        let before: f64 = (i.saturating_sub(3)..i).map(|j| band[i][i - j] * u[j]).sum();
        u[i] = (u[i] - before) / band[i][0];
    }
    for i in (0..n).rev() {
        let after: f64 = (i + 1..n.min(i + 4)).map(|j| band[j][j - i] * u[j]).sum();
        u[i] = (u[i] - after) / band[i][0];
    }
    u
}

#[test]
fn a_long_beam_on_springs_that_only_push_has_the_forces_of_the_springs_that_are_pressed() {
    let k = 1e5;
    for nodes in [200, 1101, 2001] {
        let deck = beam(nodes, 1e8 / 3.0, |_| 0.0, 1.0 / k);
        let mut closed = vec![true; nodes];
        let u = loop {
            let u = pressed(&deck, k, &closed);
            let next: Vec<bool> = (0..nodes).map(|i| u[2 * i] < 0.0).collect();
            if next == closed {
                break u;
            }
            closed = next;
        };
        let found = found(&deck);
        for i in 0..nodes {
            let force = (-k * u[2 * i]).max(0.0);
            assert!(
                (found.lambda[i] - force).abs() <= 1e-9 * 1e4,
                "{nodes}, node {i}: {} for {force}",
                found.lambda[i]
            );
        }
        few_products(&found, nodes);
    }
}

/// Of a beam, where a factor costs as much as a few steps, faces by sparse factors end the solve; steps alone take hundreds.
fn few_products(found: &Answer, nodes: usize) {
    assert!(found.report.counts.products <= 100, "{nodes}: {} products", found.report.counts.products);
}

/// A free pipe whose load changes its direction seven times, in a wavy bore with clearance: two rows a node.
#[test]
fn a_pipe_in_a_bore_meets_every_law_after_a_few_products() {
    for (nodes, clearance) in [(300, 1e-3), (301, 0.1), (1201, 1e-3), (1201, 0.1)] {
        let wave = |i: usize, turns: f64| (i as f64 * 2.0 * PI * turns / (nodes - 1) as f64).sin();
        let mut deck = beam(nodes, 1e8 / 3.0, |i| clearance * (1.0 - 5.0 * wave(i, 11.0)), 0.0);
        for i in 0..nodes {
            deck.bodies[0].load[2 * i] = 1000.0 * wave(i, 7.0);
            deck.contact.push(&[(2 * i, 1.0)], clearance * (1.0 + 5.0 * wave(i, 11.0)));
        }
        let found = found(&deck);
        let (lower, upper) = found.lambda.split_at(nodes);
        let most = found.lambda.iter().fold(0.0, |most: f64, force| most.max(*force));
        let total: f64 = (0..nodes).map(|i| deck.bodies[0].load[2 * i] + lower[i] - upper[i]).sum();
        assert!(total.abs() <= 1e-9 * most, "{nodes} {clearance}: {total} of {most}");
        for i in 0..nodes {
            let (own, way) = (found.u[2 * i], 5.0 * clearance * wave(i, 11.0));
            for (force, gap) in [(lower[i], clearance - way + own), (upper[i], clearance + way - own)] {
                assert!(gap >= -1e-8 * clearance, "{nodes} {clearance}: gap {gap} of node {i}");
                assert!(force >= 0.0 && force * gap <= 1e-8 * most * clearance);
            }
        }
        few_products(&found, nodes);
    }
}

#[test]
fn a_long_beam_on_an_uneven_rigid_bed_meets_every_law() {
    for (nodes, uneven, seed) in
        [(500, 1e-3, 1), (1001, 0.0, 2), (1001, 1e-3, 3), (1001, 0.1, 4), (1500, 1e-2, 5), (2001, 0.0, 6)]
    {
        let mut random = Random::new(seed);
        let gaps: Vec<f64> = (0..nodes).map(|_| uneven * random.uniform()).collect();
        let deck = beam(nodes, 1e8 / 3.0, |i| gaps[i], 0.0);
        let found = found(&deck);
        few_products(&found, nodes);
        let most = found.lambda.iter().fold(0.0, |most: f64, force| most.max(*force));
        let total: f64 = found.lambda.iter().sum();
        let load: f64 = -deck.load().iter().sum::<f64>();
        assert!((total - load).abs() <= 1e-9 * load, "{nodes} {uneven}: {total} of {load}");
        for i in 0..nodes {
            let gap = gaps[i] + found.u[2 * i];
            assert!(gap >= -1e-9 * (1e-3 + uneven), "{nodes} {uneven}: gap {gap} of node {i}");
            assert!(found.lambda[i] >= 0.0 && found.lambda[i] * gap <= 1e-9 * most * (1e-3 + uneven));
        }
    }
}
