//! Bodies without a load beside bodies with one, given by their elements and cut into pieces.

use decks::random::Random;
use decks::{Block, Deck, Friction, Rows};
use feti_contact::error::Result;
use feti_contact::solver::{Outcome, Problem, RowKind};

use crate::coulomb::drawn::{elements, Element};
use crate::support::hand_over;

/// A block in the plane, each of whose unknowns has a spring: its unknowns and its elements.
fn block(random: &mut Random, along: usize) -> (usize, Vec<Element>) {
    let block = Block { dimension: 2, elements: [along, along, 1], ..Block::default() };
    let unknowns = 2 * block.nodes();
    let mut all = elements(&block);
    all.extend((0..unknowns).map(|j| (vec![j], vec![random.decades(-2.0, 0.0)])));
    (unknowns, all)
}

/// Adds a body by its elements.
pub fn give(problem: &mut Problem, unknowns: usize, elements: &[Element]) -> Result<usize> {
    let body = problem.add_body(unknowns)?;
    let mut ptr = vec![0];
    elements.iter().for_each(|(dof, _)| ptr.push(ptr[ptr.len() - 1] + dof.len()));
    let dof: Vec<i64> = elements.iter().flat_map(|(dof, _)| dof.iter().map(|j| *j as i64)).collect();
    problem.set_mesh(body, &ptr, &dof)?;
    for (e, (dof, k)) in elements.iter().enumerate() {
        problem.add_element(body, e, dof.len(), k, dof.len())?;
    }
    Ok(body)
}

#[test]
fn a_cut_body_without_load_rests_whatever_its_friction_may_hold() {
    let mut random = Random::new(13);
    for case in 0..200 {
        let bodies: Vec<_> = (0..4).map(|p| block(&mut random, 2 + (case + p) % 3)).collect();
        let offsets: Vec<usize> = (0..5).map(|p| bodies[..p].iter().map(|body| body.0).sum()).collect();
        let mut taken = vec![false; offsets[4]];
        let mut draw = random.clone();
        let mut at = |p: usize| loop {
            let j = offsets[p] + draw.below(bodies[p].0);
            if !std::mem::replace(&mut taken[j], true) {
                return j;
            }
        };
        let (mut contact, mut friction) = (Rows::none(offsets[4]), Friction::none(1, offsets[4]));
        let gaps: Vec<f64> = (0..4).map(|_| random.between(0.02, 0.1)).collect();
        // the last two bodies overlap; all gaps to those without load stay open
        contact.push(&[(at(2), 0.3), (at(3), -0.3)], -0.002);
        for p in 0..4 {
            contact.push(&[(at(p), 1.0), (at((p + 1) % 4), -1.0)], gaps[p]);
            friction.push(Some(p + 1), &[&[(at(p), 1.0)]], 0.3, 0.1);
            friction.push(None, &[&[(at(p), -1.0)]], 0.0, 0.02);
        }
        let loads = [2, 3].map(|p| random.normals(bodies[p].0, 0.005));
        for pieces in [1, 2, 3] {
            let mut problem = Problem::new();
            problem.set_i64("pieces", pieces).unwrap();
            for (unknowns, elements) in &bodies {
                give(&mut problem, *unknowns, elements).unwrap();
            }
            [2, 3].iter().zip(&loads).for_each(|(&p, load)| problem.set_load(p, load).unwrap());
            problem.set_text("dual_operator=explicit direct_limit=0").unwrap();
            hand_over::add_rows(&mut problem, RowKind::Inequality, &contact).unwrap();
            hand_over::add_friction(&mut problem, &friction).unwrap();
            let report = problem.solve().unwrap_or_else(|error| panic!("{case} {pieces}: {error}"));
            assert_eq!(report.outcome, Outcome::Solved, "{case} {pieces}: {:?}", report.certificate);
        }
    }
}

/// Loads in balance up to rounding, which pushes aside more than friction holds: the body lifts off from what it deforms into.
#[test]
fn a_loose_block_whose_loads_balance_rests_on_a_floor_with_friction() {
    for seed in 0..100 {
        let mut random = Random::new(seed);
        let elements = [1 + random.below(3), 1 + random.below(2), 1];
        let block = Block { dimension: 2, elements, ..Block::default() };
        let mut body = block.floating().body;
        let mut bend = random.normals(body.dofs(), 1e-2);
        let travel = random.decades(0.0, 2.0);
        bend.iter_mut().for_each(|u| *u += travel);
        body.load = body.stiffness.times(&bend);
        let mut deck = Deck::new("idle", vec![body]);
        let (angle, mu) = (random.between(-1.5, 1.5), random.between(0.05, 0.6));
        let (normal, along) = ([angle.sin(), -angle.cos()], [angle.cos(), angle.sin()]);
        deck.friction = Friction::none(1, deck.dofs());
        for i in 0..=elements[0] {
            let at = 2 * block.node([i, 0, 0]);
            deck.contact.push(&[(at, normal[0]), (at + 1, normal[1])], random.between(-0.01, 0.01));
            deck.friction.push(Some(i), &[&[(at, along[0]), (at + 1, along[1])]], mu, 0.0);
        }
        let mut problem = hand_over::problem(&deck).unwrap();
        let outcome = problem.solve().unwrap().outcome;
        assert_eq!(outcome, Outcome::Solved, "{seed}");
        let most =
            problem.multipliers(RowKind::Inequality).unwrap().iter().fold(0.0, |most: f64, l| most.max(*l));
        assert!(most < 1e-11, "{seed}: {most}");
    }
}
