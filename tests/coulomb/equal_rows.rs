//! Contact rows that are equal but for rounding of their gaps share their force evenly, each with the friction of its own node.

use decks::random::Random;
use decks::{Deck, Friction};
use feti_contact::solver::{FrictionState, Outcome, Problem, RowKind};

use crate::coulomb::struck_out::springs;
use crate::coulomb::tied::slip;
use crate::support::hand_over;

/// A plate that only moves across a wall, pressed onto it at several corners; every corner slides on springs of its own.
struct Plate {
    /// Of the plate, and the gap of its corners.
    spring: f64,
    press: f64,
    gap: f64,
    corners: Vec<Corner>,
}

#[derive(Clone)]
struct Corner {
    /// Factor of its rows.
    factor: f64,
    mu: f64,
    k: [f64; 2],
    push: [f64; 2],
    /// Rounding of its gap.
    off: f64,
}

impl Plate {
    fn drawn(random: &mut Random, corners: usize, spring: f64) -> Self {
        let corner = |random: &mut Random| {
            let angle = random.between(0.0, 6.3);
            let push = random.between(0.05, 1.0);
            Corner {
                factor: random.decades(-1.0, 1.0),
                mu: random.between(0.1, 0.9),
                k: [random.decades(-0.5, 0.5), random.decades(-0.5, 0.5)],
                push: [push * angle.cos(), push * angle.sin()],
                off: 1e-16 * random.between(-4.0, 4.0),
            }
        };
        let gap = if spring > 0.0 { random.between(0.0, 0.5) } else { 0.0 };
        let press = random.between(1.0, 3.0) + spring * gap;
        Self { spring, press, gap, corners: (0..corners).map(|_| corner(random)).collect() }
    }

    fn deck(&self, with_friction: bool) -> Deck {
        let (mut k, mut load) = (vec![self.spring], vec![self.press]);
        for corner in &self.corners {
            k.extend(corner.k);
            load.extend(corner.push);
        }
        let free: Vec<_> = (0..k.len()).filter(|&i| k[i] == 0.0).collect();
        let unit = |i: usize| (0..k.len()).map(|j| f64::from(u8::from(i == j))).collect::<Vec<f64>>();
        let mut body = springs(&k, &load);
        body.null_space =
            Some(free.iter().map(|&i| unit(i)).collect::<Vec<_>>()).filter(|all| !all.is_empty());
        let mut deck = Deck::new("plate", vec![body]);
        deck.friction = Friction::none(2, k.len());
        for (i, corner) in self.corners.iter().enumerate() {
            let by = corner.factor;
            deck.contact.push(&[(0, by)], by * self.gap + corner.off);
            if with_friction {
                let x = 1 + 2 * i;
                deck.friction.push(Some(i), &[&[(x, by)], &[(x + 1, by)]], corner.mu, 0.0);
            }
        }
        deck
    }

    /// The normal force of every corner.
    fn share(&self) -> f64 {
        (self.press - self.spring * self.gap) / self.corners.len() as f64
    }
}

fn solved(deck: &Deck, what: &str) -> Problem {
    let mut problem = hand_over::problem(deck).unwrap();
    let report = problem.solve().unwrap_or_else(|error| panic!("{what}: {error}"));
    assert_eq!(report.outcome, Outcome::Solved, "{what}: {:?}", report.certificate);
    problem
}

#[test]
fn every_node_of_equal_rows_has_its_share_and_the_friction_of_its_share() {
    let mut random = Random::new(6);
    for case in 0..60 {
        let (corners, spring) = ([2, 3, 4, 7][case % 4], [1.0, 0.0, 4.0][case % 3]);
        let plate = Plate::drawn(&mut random, corners, spring);
        let problem = solved(&plate.deck(true), &format!("{case}"));
        let normal = problem.multipliers(RowKind::Inequality).unwrap();
        let along = problem.multipliers(RowKind::Tangential).unwrap();
        let states = problem.friction_states().unwrap();
        for (i, corner) in plate.corners.iter().enumerate() {
            let (found, share) = (corner.factor * normal[i], plate.share());
            assert!((found - share).abs() < 1e-9 * share, "{case} {i}: {found} for {share}");
            let bound = corner.mu * share;
            let (size, r) = (corner.push[0].hypot(corner.push[1]), slip(corner.k, corner.push, bound));
            for j in 0..2 {
                let slips = corner.push[j] * bound / (corner.k[j] * r + bound);
                let expected = if size > bound { slips } else { corner.push[j] };
                let found = corner.factor * along[2 * i + j];
                assert!((found - expected).abs() < 1e-7 * bound, "{case} {i}: {found} for {expected}");
            }
            let state = if size > bound { FrictionState::Slip } else { FrictionState::Stick };
            assert_eq!(states[i], state, "{case} {i}");
        }
    }
}

#[test]
fn rounding_of_the_gaps_decides_nothing() {
    let mut random = Random::new(16);
    for case in 0..20 {
        let plate = Plate::drawn(&mut random, 4, [0.0, 1.0][case % 2]);
        let forces = |plate: &Plate| -> Vec<f64> {
            let problem = solved(&plate.deck(true), &format!("{case}"));
            problem.multipliers(RowKind::Tangential).unwrap().to_vec()
        };
        let mut other = Plate { corners: plate.corners.clone(), ..plate };
        other.corners.iter_mut().for_each(|corner| corner.off = -corner.off);
        let (one, other) = (forces(&plate), forces(&other));
        let size = one.iter().fold(0.0, |most: f64, v| most.max(v.abs()));
        assert!(
            one.iter().zip(&other).all(|(a, b)| (a - b).abs() < 1e-7 * size),
            "{case}: {one:?} {other:?}"
        );
    }
}

#[test]
fn equal_contact_rows_without_friction_share_evenly() {
    let mut random = Random::new(26);
    for case in 0..20 {
        let plate = Plate::drawn(&mut random, 2 + case % 5, 1.0);
        let problem = solved(&plate.deck(false), &format!("{case}"));
        for (corner, found) in plate.corners.iter().zip(problem.multipliers(RowKind::Inequality).unwrap()) {
            assert!((corner.factor * found - plate.share()).abs() < 1e-12 * plate.share(), "{case}");
        }
    }
}

/// A contact row without a node beside nodes with friction carries nothing, as if it were not there.
#[test]
fn equal_rows_of_nodes_with_friction_carry_the_force_of_those_without() {
    let plate = Plate::drawn(&mut Random::new(56), 3, 1.0);
    let mut deck = plate.deck(true);
    let corner = deck.contact.matrix.row(0).collect::<Vec<_>>();
    deck.contact.push(&corner, deck.contact.rhs[0]);
    let problem = solved(&deck, "beside");
    let normal = problem.multipliers(RowKind::Inequality).unwrap();
    let shares = plate.corners.iter().zip(normal).map(|(corner, found)| corner.factor * found);
    assert!(shares.into_iter().all(|found| (found - plate.share()).abs() < 1e-9 * found), "{normal:?}");
    assert_eq!(normal[3], 0.0);
}

/// Rows whose gaps differ by more than rounding are not equal: the tightest carries.
#[test]
fn the_tightest_of_parallel_rows_carries_alone() {
    let mut plate = Plate::drawn(&mut Random::new(36), 3, 1.0);
    plate.corners.iter_mut().zip([1e-9, 0.0, 1e-9]).for_each(|(corner, off)| {
        (corner.off, corner.factor) = (off, 1.0);
    });
    let problem = solved(&plate.deck(true), "tightest");
    let normal = problem.multipliers(RowKind::Inequality).unwrap();
    assert!(normal[0] == 0.0 && normal[1] > 0.1 && normal[2] == 0.0, "{normal:?}");
}

/// A corner without springs is held by the friction of its share alone.
#[test]
fn a_corner_is_held_up_to_the_friction_of_its_share() {
    let mut random = Random::new(46);
    for case in 0..12 {
        let mut plate = Plate::drawn(&mut random, [2, 4][case % 2], [0.0, 1.0][case / 2 % 2]);
        let (share, at) = (plate.share(), case % plate.corners.len());
        let held = |load: f64, plate: &mut Plate| {
            let corner = &mut plate.corners[at];
            corner.k = [0.0; 2];
            let (size, bound) = (corner.push[0].hypot(corner.push[1]), corner.mu * share);
            corner.push = corner.push.map(|f| f * load * bound / size);
            hand_over::problem(&plate.deck(true)).unwrap().solve().map(|report| report.outcome)
        };
        assert_eq!(held(0.999, &mut plate).unwrap(), Outcome::Solved, "{case}");
        let more = held(1.01, &mut plate).map_err(|error| error.kind);
        assert_ne!(more, Ok(Outcome::Solved), "{case}");
    }
}
