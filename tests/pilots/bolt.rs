//! A bolt cut at a section: at every node of the section its halves overlap by the displacement of a pilot, which the pretension
//! loads. Both heads bear on a rigid plate; the forces are those of a pilot without stiffness.

use decks::{Block, Csr, Rows};
use feti_contact::solver::Problem;

use crate::pilots::elastic::{add, add_rows, hung, Pilot};
use crate::pilots::{assert_near, forces, solved};

const PRETENSION: f64 = 100.0;

/// The forces below the heads, left to right, the lower one first, with `n` elements across the section.
fn clamped(n: usize, kp: f64, pilot: Pilot) -> Vec<f64> {
    let (size, rows) = (1.0 / n as f64, n / 8 + 1);
    let half = |y: f64| Block {
        dimension: 2,
        elements: [n, rows, 1],
        size: [1.0, rows as f64 * size, 1.0],
        origin: [0.0, y, 0.0],
        young: 1e6,
        ..Block::default()
    };
    let (lower, upper) = (half(0.0), half(rows as f64 * size));
    let (below, above) = (lower.floating().body, upper.floating().body);
    let (first, pulled) = (below.dofs(), below.dofs() + above.dofs());
    let parts = [&below.stiffness, &above.stiffness, &Csr::from_dense(1, &[kp])];
    let loads = [vec![0.0; below.dofs()], vec![0.0; above.dofs()], vec![PRETENSION]];
    let mut problem = Problem::new();
    let at = |block: &Block, first: usize, x: usize, y: usize| first + 2 * block.node([x, y, 0]);
    match pilot {
        Pilot::Alone => parts.iter().zip(&loads).for_each(|(k, load)| add(&mut problem, k, load)),
        Pilot::Hung => {
            let springs = (0..=n).map(|x| (at(&lower, 0, x, rows) + 1, pulled)).collect();
            add(&mut problem, &hung(parts, springs, kp), &loads.concat());
        }
    }
    let (mut contact, mut equalities) = (Rows::none(pulled + 1), Rows::none(pulled + 1));
    let gap = |x: usize| 1e-5 * (x as f64 * size - 0.4).powi(2);
    (0..=n).for_each(|x| contact.push(&[(at(&lower, 0, x, 0) + 1, 1.0)], gap(x)));
    (0..=n).for_each(|x| contact.push(&[(at(&upper, first, x, rows) + 1, -1.0)], gap(x)));
    for x in 0..=n {
        let (up, down) = (at(&lower, 0, x, rows), at(&upper, first, x, 0));
        equalities.push(&[(up, 1.0), (down, -1.0)], 0.0);
        equalities.push(&[(up + 1, 1.0), (down + 1, -1.0), (pulled, -1.0)], 0.0);
    }
    equalities.push(&[(at(&lower, 0, 0, 0), 1.0)], 0.0);
    add_rows(&mut problem, &contact, &equalities);
    let report = solved(&mut problem, &format!("{n} elements, kp {kp:e}, {pilot:?}"));
    assert!(
        report.counts.products < 10 * n.max(20),
        "{n} elements, kp {kp:e}, {pilot:?}: {:?}",
        report.counts
    );
    forces(&problem)[0].clone()
}

#[test]
fn the_forces_of_a_bolt_do_not_depend_on_the_stiffness_of_the_pilot_of_its_section() {
    for n in [10, 40, 160] {
        let right = clamped(n, 0.0, Pilot::Alone);
        for head in right.chunks(n + 1) {
            assert!((head.iter().sum::<f64>() - PRETENSION).abs() < 1e-9, "{n} elements: {head:?}");
        }
        for pilot in [Pilot::Alone, Pilot::Hung] {
            for kp in [1e-300, 1e-20, 1e-15, 1e-12, 1e-9, 1e-6] {
                let what = format!("{n} elements, kp {kp:e}, {pilot:?}");
                assert_near(&clamped(n, kp, pilot), &right, 1e-9, &what);
            }
        }
    }
}
