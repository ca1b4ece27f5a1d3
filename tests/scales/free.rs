//! Two blocks, the upper one free to slide and to spin: no row touches these motions, and K of varied elements does no more
//! than nearly leave them without force. Of all answers that of least |u|_D is right, |u|_D^2 = sum K_ii u_i^2.

use decks::random::Random;
use decks::{Blocks, Deck};
use feti_contact::solver::{Modes, Problem};

use crate::scales::{add, difference, dot, energy, largest, problem, solved, Answer, Claims};

/// Slides along x and y, and the spin about z, among the six modes of a block.
const FREE: [usize; 3] = [0, 1, 3];
/// Edge of a block, length.
const EDGE: f64 = 1.0;

/// Seed of the moduli, where one is enough.
pub const SEED: u64 = 2;

pub fn blocks(elements: usize, variation: f64, seed: u64) -> Deck {
    Blocks { elements, young: 1.0 }.varied(variation, seed)
}

/// The deck with the slides and the spin of the upper block held by three rows at two corners of its bottom. No load acts
/// along them, so the rows carry no force, and the energy stays.
pub fn held(deck: &Deck) -> Deck {
    let (mut held, upper) = (deck.clone(), &deck.bodies[1]);
    let corner = |x: f64, direction: i32| {
        let at = |i: &usize| {
            let [a, b, z] = upper.coordinates[*i];
            upper.direction[*i] == direction
                && (a - x).abs() < 1e-9
                && b.abs() < 1e-9
                && (z - EDGE).abs() < 1e-9
        };
        deck.offset(1) + (0..upper.dofs()).find(at).unwrap()
    };
    for dof in [corner(0.0, 1), corner(0.0, 2), corner(EDGE, 2)] {
        held.equalities.push(&[(dof, 1.0)], 0.0);
    }
    held
}

/// Slides and spin of the upper block over all unknowns, orthonormal in D = diag K, and D.
pub fn free_motions(deck: &Deck) -> (Vec<Vec<f64>>, Vec<f64>) {
    let metric: Vec<f64> = deck.bodies.iter().flat_map(|body| body.stiffness.diagonal()).collect();
    let mut basis: Vec<Vec<f64>> = Vec::new();
    for mode in FREE {
        let mut v = vec![0.0; deck.offset(1)];
        v.extend_from_slice(&deck.bodies[1].modes()[mode]);
        for _ in 0..2 {
            basis.iter().for_each(|n| add(-inner(&metric, n, &v), n, &mut v));
        }
        let size = inner(&metric, &v, &v).sqrt();
        basis.push(v.iter().map(|v| v / size).collect());
    }
    (basis, metric)
}

/// x'D y
pub fn inner(metric: &[f64], x: &[f64], y: &[f64]) -> f64 {
    metric.iter().zip(x.iter().zip(y)).map(|(d, (x, y))| d * x * y).sum()
}

/// u without its part along the free motions: the answer of least |u|_D.
pub fn least(deck: &Deck, u: &[f64]) -> Vec<f64> {
    let ((motions, metric), mut least) = (free_motions(deck), u.to_vec());
    for _ in 0..2 {
        motions.iter().for_each(|n| add(-inner(&metric, n, &least), n, &mut least));
    }
    least
}

/// Largest |n'D u| / (|n|_D |u|_D) over the free motions n: a step along n shortens u by half its square.
pub fn slack(deck: &Deck, u: &[f64]) -> f64 {
    let (motions, metric) = free_motions(deck);
    let along: Vec<f64> = motions.iter().map(|n| inner(&metric, n, u)).collect();
    largest(&along) / inner(&metric, u, u).sqrt()
}

/// What is claimed of every answer of a free upper block against that of the block held.
pub fn claim_least(claims: &mut Claims, deck: &Deck, found: &Answer, reference: &Answer, what: &str) {
    claims.claim(found.report.undetermined == 3, || {
        format!("{what}: {} motions are undetermined, not 3", found.report.undetermined)
    });
    let scale = reference.report.energy;
    claims.at_most(((found.report.energy - scale) / scale).abs(), 1e-10, &format!("{what}, energy reported"));
    claims.at_most(((energy(deck, &found.u) - scale) / scale).abs(), 1e-10, &format!("{what}, energy"));
    claims.at_most(difference(&found.lambda, &reference.lambda), 1e-8, &format!("{what}, forces"));
    claims.at_most(largest(&found.u), EDGE, &format!("{what}, lengths of slide"));
    claims.at_most(slack(deck, &found.u), 1e-8, &format!("{what}, part of u along a free motion"));
    claims.at_most(difference(&found.u, &least(deck, &reference.u)), 1e-8, &format!("{what}, u"));
}

fn assert_least(elements: &[usize], variation: f64) {
    let mut claims = Claims::default();
    for (n, seed) in elements.iter().flat_map(|n| [SEED, 7].map(|seed| (*n, seed))) {
        let (deck, what) = (blocks(n, variation, seed), format!("n = {n}, seed {seed}"));
        let reference = solved(&mut problem(&held(&deck)));
        if let Some(found) = claims.solved(&mut problem(&deck), &what) {
            claim_least(&mut claims, &deck, &found, &reference, &what);
        }
    }
    claims.end();
}

#[test]
fn a_free_block_of_equal_elements_lies_where_u_is_least() {
    assert_least(&[8, 10], 0.0);
}

#[test]
fn a_free_block_of_elements_varied_by_1e_9_lies_where_u_is_least() {
    assert_least(&[8, 10], 1e-9);
}

#[test]
fn a_free_block_of_elements_varied_by_1e_6_lies_where_u_is_least() {
    assert_least(&[8, 10], 1e-6);
}

#[test]
fn a_free_block_of_elements_varied_by_1e_3_lies_where_u_is_least() {
    assert_least(&[8, 10], 1e-3);
}

#[test]
fn a_free_block_of_40_thousand_unknowns_varied_by_1e_6_lies_where_u_is_least() {
    assert_least(&[18], 1e-6);
}

#[test]
fn a_free_block_of_40_thousand_unknowns_varied_by_1e_3_lies_where_u_is_least() {
    assert_least(&[18], 1e-3);
}

/// A wall that the upper block overlaps by 0.1 pushes it out and then carries nothing: -u_x <= -0.1 at one corner. With N
/// orthonormal in D and u the answer of least |u|_D without the wall, N a, a = (0.1 - u_x) N'b / |N'b|^2, is the least move.
#[test]
fn a_wall_without_force_moves_a_free_block_no_further_than_it_must() {
    let mut claims = Claims::default();
    for v in [0.0, 1e-9, 1e-6, 1e-3] {
        let (plain, what) = (blocks(8, v, SEED), format!("V = {v:e}"));
        let reference = solved(&mut problem(&held(&plain)));
        let (mut deck, corner) = (plain.clone(), plain.offset(1));
        deck.contact.push(&[(corner, -1.0)], -0.1);
        let mut expected = least(&plain, &reference.u);
        let (motions, _) = free_motions(&plain);
        let arms: Vec<f64> = motions.iter().map(|n| n[corner]).collect();
        let push = (0.1 - expected[corner]) / dot(&arms, &arms);
        motions.iter().zip(&arms).for_each(|(n, arm)| add(push * arm, n, &mut expected));
        if let Some(found) = claims.solved(&mut problem(&deck), &what) {
            claims.at_most(difference(&found.u, &expected), 1e-8, &format!("{what}, u"));
            let forces = &found.lambda[..plain.contact.len()];
            claims.at_most(difference(forces, &reference.lambda), 1e-8, &format!("{what}, forces"));
            let wall = found.lambda[plain.contact.len()];
            claims.at_most(wall / largest(forces), 1e-8, &format!("{what}, force of the wall"));
        }
    }
    claims.end();
}

/// The deck with these modes for the upper block.
fn with_modes(deck: &Deck, modes: &[Vec<f64>]) -> Problem {
    let (mut problem, n) = (problem(deck), deck.bodies[1].dofs());
    problem.set_null_space(1, n, modes.len(), &modes.concat(), n, Modes::Exact).unwrap();
    problem
}

/// Modes of the upper block: column j becomes `own` column j + `share` times a random combination of all.
fn mixed(deck: &Deck, own: f64, share: f64, random: &mut Random) -> Vec<Vec<f64>> {
    let modes = deck.bodies[1].modes();
    let column = |j: usize| {
        let mut column: Vec<f64> = modes[j].iter().map(|r| own * r).collect();
        modes.iter().for_each(|mode| add(share * random.normal(), mode, &mut column));
        column
    };
    (0..modes.len()).map(column).collect()
}

/// Relative noise on the modes of the upper block.
fn noisy(deck: &Deck, size: f64, random: &mut Random) -> Vec<Vec<f64>> {
    let noise = |mode: &Vec<f64>| {
        let most = largest(mode);
        mode.iter().map(|r| r + size * most * random.normal()).collect()
    };
    deck.bodies[1].modes().iter().map(noise).collect()
}

fn assert_same_for(modes: impl Fn(&Deck, &mut Random) -> Vec<Vec<f64>>) {
    let mut claims = Claims::default();
    for v in [0.0, 1e-9, 1e-6, 1e-3] {
        let deck = blocks(8, v, SEED);
        let reference = solved(&mut problem(&held(&deck)));
        for seed in 0..2 {
            let what = format!("V = {v:e}, seed {seed}");
            let given = modes(&deck, &mut Random::new(seed));
            if let Some(found) = claims.solved(&mut with_modes(&deck, &given), &what) {
                claim_least(&mut claims, &deck, &found, &reference, &what);
            }
        }
    }
    claims.end();
}

/// Columns of condition about 3.
#[test]
fn a_null_space_of_mixed_columns_gives_the_same_u() {
    assert_same_for(|deck, random| mixed(deck, 4.0, 1.0, random));
}

#[test]
fn a_null_space_mixed_by_1e_9_gives_the_same_u() {
    assert_same_for(|deck, random| mixed(deck, 1.0, 1e-9, random));
}

#[test]
fn a_null_space_with_noise_of_1e_12_gives_the_same_u() {
    assert_same_for(|deck, random| noisy(deck, 1e-12, random));
}

#[test]
fn a_null_space_mixed_and_noisy_gives_the_same_u() {
    assert_same_for(|deck, random| {
        let mut other = deck.clone();
        other.bodies[1].null_space = Some(mixed(deck, 4.0, 1.0, random));
        noisy(&other, 1e-12, random)
    });
}

#[test]
fn a_free_block_lies_where_u_is_least_at_every_load_step_from_the_previous_one() {
    let mut claims = Claims::default();
    for v in [1e-9, 1e-6, 1e-3] {
        let deck = blocks(8, v, SEED);
        let mut walking = problem(&deck);
        walking.set_str("start", "previous").unwrap();
        for share in [0.9, 1.0, 1.1] {
            let what = format!("V = {v:e}, load {share}");
            let mut step = deck.clone();
            step.bodies[1].load.iter_mut().for_each(|f| *f *= share);
            let reference = solved(&mut problem(&held(&step)));
            walking.set_load(1, &step.bodies[1].load).unwrap();
            if let Some(found) = claims.solved(&mut walking, &what) {
                claim_least(&mut claims, &step, &found, &reference, &what);
            }
        }
    }
    claims.end();
}
