//! Degenerate and hostile problems.

use feti_contact::error::{Error, Kind, Result};
use feti_contact::linalg::Matrix;
use feti_contact::platform::threads::with_team;
use feti_contact::qp::friction::{friction, Cones, FrictionSolution, FrictionStart, Node, State};
use feti_contact::qp::{Observer, StepReport, Verdict};

use crate::friction::deck::Deck;
use crate::friction::problem::{Content, Given, Random};

fn block() -> Deck {
    Deck::new(2, 12, 1, 0.6, 0.8)
}

fn right(given: &Given, found: &FrictionSolution, what: &str) {
    assert_eq!(found.verdict, Verdict::Solved, "{what}: {} {:?}", found.merit, found.counts);
    let (laws, balance) = given.missed(found);
    assert!(laws < 1e-6 && balance < 1e-9, "{what}: {laws:e} {balance:e}");
}

fn far(a: &[f64], b: &[f64]) -> f64 {
    let norm = |v: &mut dyn Iterator<Item = f64>| v.map(|v| v * v).sum::<f64>().sqrt();
    norm(&mut a.iter().zip(b).map(|(a, b)| a - b)) / norm(&mut b.iter().copied())
}

#[test]
fn without_friction_the_answer_is_that_of_half_lines() {
    let mut random = Random::new(7);
    for case in 0..30 {
        let k = 1 + case % 6;
        let (f, d) = (random.positive(2 * k, 0.2), random.vector(2 * k));
        let with = |tangents: bool| -> Vec<Node> {
            let tangent = |i: usize| if tangents { vec![k + i] } else { Vec::new() };
            (0..k).map(|i| Node::new(Some(i), &tangent(i), 0.0, 0.0).unwrap()).collect()
        };
        let given = Given::new(f.clone(), d.clone(), with(true));
        let found = given.solved();
        right(&given, &found, "mu = 0");
        assert!(found.x[k..].iter().all(|t| *t == 0.0), "{:?}", found.x);
        assert!(found.states.iter().all(|state| *state == State::Open));
        let part = Matrix::from_fn(k, k, |i, j| f.get(i, j)).unwrap();
        let alone = Given::new(part, d[..k].to_vec(), with(false));
        let other = alone.solved();
        right(&alone, &other, "half lines");
        assert!(
            far(&found.x[..k], &other.x) < 1e-9 || found.x[..k] == other.x[..],
            "{:?} {:?}",
            found.x,
            other.x
        );
    }
}

#[test]
fn near_to_sliding_a_load_is_held_just_below_and_no_force_balances_it_just_above() {
    for deck in [block(), Deck::new(3, 3, 1, 0.3, 0.8), Deck::new(2, 8, 3, 0.3, 0.8)] {
        for load in [0.999, 0.9999] {
            let given = Deck { load, ..deck }.given();
            let found = given.from(FrictionStart::default(), 1e-9, 400);
            right(&given, &found, "below");
        }
        for load in [1.001, 1.0001] {
            let found = Deck { load, ..deck }.given().solved();
            assert!(
                matches!(found.verdict, Verdict::Infeasible { margin, .. } if margin > 1e-6 && margin < 1.0),
                "{:?}",
                found.verdict
            );
            assert_eq!(found.counts.products, 0);
        }
    }
}

#[test]
fn units_change_nothing_but_units() {
    let given = block().given();
    let found = given.solved();
    right(&given, &found, "units of the test");
    for units in [(1e6, 1.0), (1.0, 1e6), (1e-6, 1e9), (1e3, 1e-12)] {
        let other = Deck { units, ..block() }.given();
        let answer = other.solved();
        right(&other, &answer, "other units");
        // scaled forces have the unit of root(force x length)
        let unit = (units.0 * units.1).sqrt();
        let same: Vec<f64> = answer.x.iter().map(|x| x / unit).collect();
        assert!(far(&same, &found.x) < 1e-8, "{units:?} {}", far(&same, &found.x));
        assert!(answer.counts.products.abs_diff(found.counts.products) <= 2);
    }
}

#[test]
fn stiff_blocks_upon_soft_ones_are_solved() {
    for contrast in [1e4, 1e-4] {
        for dim in [2, 3] {
            let given =
                Deck { contrast, ..Deck::new(dim, if dim == 2 { 12 } else { 4 }, 3, 0.6, 0.8) }.given();
            let found = given.from(FrictionStart::default(), 1e-9, 400);
            right(&given, &found, "contrast");
            println!("contrast {contrast} {dim}D: {} products {:?}", found.counts.products, found.counts);
        }
    }
}

#[test]
fn oblique_tangential_rows_and_rows_of_other_directions_are_solved() {
    for turned in [(0.7, 0.5 * std::f64::consts::PI), (0.2, 1.1), (0.0, 0.4)] {
        let given = Deck { turned, ..Deck::new(3, 3, 1, 0.6, 0.5) }.given();
        let found = given.from(FrictionStart::default(), 1e-9, 400);
        right(&given, &found, "oblique");
    }
}

#[test]
fn bounds_act_with_coefficients_and_at_open_nodes() {
    for (bound, mu) in [(1e-5, 0.0), (1e-5, 0.3), (1.0, 0.3)] {
        let deck = Deck { bound, ..Deck::new(2, 12, 1, mu, if mu > 0.0 { 1.2 } else { 0.0 }) };
        let given = deck.given();
        let found = given.solved();
        right(&given, &found, "bound");
    }
    // two nodes far from the ground whose tangential rows are held by a bound alone
    let nodes =
        vec![Node::new(Some(0), &[1], 0.4, 0.5).unwrap(), Node::new(Some(2), &[3], 0.4, 2.0).unwrap()];
    let f = Matrix::from_fn(4, 4, |i, j| if i == j { 1.0 } else { 0.1 }).unwrap();
    let given = Given::new(f, vec![-1.0, 1.0, -1.0, 1.0], nodes);
    let found = given.solved();
    right(&given, &found, "open nodes with a bound");
    assert_eq!((found.x[0], found.x[2]), (0.0, 0.0));
    assert!((found.x[1] - 0.5).abs() < 1e-9 && (found.x[3] - 0.95).abs() < 1e-9, "{:?}", found.x);
    assert_eq!(found.states, [State::Slip, State::Stick]);
}

/// Every row twice, and nodes whose tangential rows have no entries.
#[test]
fn redundant_nodes_and_tangential_rows_without_entries_are_solved() {
    let once = block().given();
    let m = once.d.len();
    let twice = |i: usize| i % m;
    let f = Matrix::from_fn(2 * m, 2 * m, |i, j| once.f.0.get(twice(i), twice(j))).unwrap();
    let d = (0..2 * m).map(|i| once.d[twice(i)]).collect();
    let of = |node: &Node, by: usize| {
        Node::new(node.normal.map(|n| n + by), &[node.tangents()[0] + by], node.mu, node.bound).unwrap()
    };
    let nodes = once.cones.nodes().iter().flat_map(|node| [of(node, 0), of(node, m)]).collect();
    let g = |given: &Given, count: usize| -> Vec<Vec<f64>> {
        let mut g = vec![vec![0.0; count]; given.e.len()];
        (0..count).for_each(|i| given.g_transposed.row(i % m).for_each(|(k, v)| g[k][i] = v));
        g
    };
    let given = Given::new(f, d, nodes).floating(&g(&once, 2 * m), once.e.clone());
    let found = given.from(FrictionStart::default(), 1e-9, 400);
    right(&given, &found, "redundant");
    let answer = once.solved();
    let sum: Vec<f64> = (0..m).map(|i| found.x[i] + found.x[i + m]).collect();
    assert!(far(&sum, &answer.x) < 1e-5, "{}", far(&sum, &answer.x));

    let once = Deck { load: 0.3, ..block() }.given();
    let without = |i: usize| i % 6 == 5;
    let f = Matrix::from_fn(m, m, |i, j| if without(i) || without(j) { 0.0 } else { once.f.0.get(i, j) })
        .unwrap();
    let d = (0..m).map(|i| if without(i) { 0.0 } else { once.d[i] }).collect();
    let mut g = g(&once, m);
    g.iter_mut().for_each(|row| (0..m).filter(|i| without(*i)).for_each(|i| row[i] = 0.0));
    let mut given = Given::new(f, d, once.cones.nodes().to_vec()).floating(&g, once.e.clone());
    let found = given.solved();
    right(&given, &found, "no entries");
    given.preconditioner = once.preconditioner;
    let found = given.solved();
    right(&given, &found, "no entries, preconditioned");
}

#[test]
fn nothing_gives_nothing() {
    let mut given = block().given();
    given.e.fill(0.0);
    // gaps alone
    let gaps: Vec<f64> = (0..given.d.len()).map(|i| if i % 2 == 0 { -1e-3 } else { 0.0 }).collect();
    for d in [gaps, vec![0.0; given.d.len()]] {
        given.d = d;
        let found = given.solved();
        assert_eq!(found.verdict, Verdict::Solved);
        assert!(found.x.iter().all(|x| *x == 0.0), "{:?}", found.x);
    }
    let none = Given::new(Matrix::default(), Vec::new(), Vec::new());
    assert_eq!(none.solved().verdict, Verdict::Solved);
}

#[test]
fn what_is_no_number_ends_without_an_answer() {
    for bad in [f64::NAN, f64::INFINITY, 1e300] {
        let mut given = block().given();
        given.d[3] = bad;
        assert_ne!(given.solved().verdict, Verdict::Solved, "{bad}");
        let mut given = block().given();
        given.e[0] = bad;
        assert_ne!(given.solved().verdict, Verdict::Solved, "{bad}");
        let mut given = block().given();
        given.f.0.set(2, 2, f64::NAN);
        assert_ne!(given.solved().verdict, Verdict::Solved);
    }
}

#[test]
fn the_bits_do_not_depend_on_threads_and_pairs_kept_save_products() {
    let given = Deck::new(3, 4, 1, 0.6, 0.8).given();
    let bits = |found: &FrictionSolution| found.x.iter().map(|x| x.to_bits()).collect::<Vec<u64>>();
    let (one, two) = (with_team(1, || given.solved()), with_team(2, || given.solved()));
    assert_eq!((bits(&one), one.counts), (bits(&two), two.counts));
    let next = Deck::new(3, 4, 1, 0.6, 0.7).given();
    let cold = next.solved();
    let start = FrictionStart { x: Some(&one.x), alpha: Some(&one.alpha), pairs: one.pairs };
    let warm = next.from(start, 1e-10, 400);
    right(&next, &warm, "warm");
    assert!(warm.counts.products < cold.counts.products, "{} {}", warm.counts.products, cold.counts.products);
    assert!(far(&warm.x, &cold.x) < 1e-7);
}

struct Impatient(usize);

impl Observer for Impatient {
    fn step(&mut self, now: &StepReport) -> Result<()> {
        if now.counts.products >= self.0 {
            return Err(Error::new(Kind::Cancelled, "enough"));
        }
        Ok(())
    }
}

#[test]
fn a_run_that_is_ended_keeps_the_point_it_has_reached() {
    let given = block().given();
    for products in [1, 4] {
        let limits = given.limits(1e-10, 0);
        let found = friction(
            given.problem(),
            limits,
            FrictionStart::default(),
            &mut Content,
            &mut Impatient(products),
        )
        .unwrap();
        assert_eq!((found.verdict, found.x.len()), (Verdict::Cancelled, given.d.len()));
        assert!(found.merit > 1e-10 && found.x.iter().any(|x| *x != 0.0));
    }
    let limits = feti_contact::qp::friction::FrictionLimits { products: 5, ..given.limits(1e-10, 0) };
    let found =
        friction(given.problem(), limits, FrictionStart::default(), &mut Content, &mut Content).unwrap();
    assert_eq!(found.verdict, Verdict::StepLimit);
    assert!(found.counts.products <= 6);
}

/// Free rows beside nodes of all kinds, bodies that are held: the laws are met wherever an answer is claimed, and it mostly is.
#[test]
fn mixtures_of_all_sets_in_space_are_solved() {
    let mut random = Random::new(8);
    let mut solved = 0;
    for case in 0..80 {
        let m = 14;
        let mu = [0.0, 0.2, 0.7, 1.5][case % 4];
        let nodes = vec![
            Node::new(Some(0), &[1, 2], mu, 0.0).unwrap(),
            Node::new(Some(3), &[4], mu, 0.1).unwrap(),
            Node::new(Some(5), &[], 0.0, 0.0).unwrap(),
            Node::new(None, &[6, 7], 0.0, 0.3).unwrap(),
            Node::new(Some(8), &[10, 9], mu, f64::INFINITY).unwrap(),
        ];
        let mut given = Given::new(random.positive(m, 0.1), random.vector(m), nodes);
        if case % 2 == 0 {
            given = given.floating(&[random.vector(m)], vec![0.3]);
        }
        let found = given.solved();
        if found.verdict == Verdict::Solved {
            let law = given.missed(&found);
            assert!(law.0 < 1e-8 && law.1 < 1e-9, "{case}: {law:?}");
            solved += 1;
        }
    }
    assert!(solved >= 78, "{solved}");
}

#[test]
fn enormous_coefficients_are_stick_and_gaps_that_never_close_are_open() {
    let given = Deck::new(2, 8, 1, 1e6, 1e-7).given();
    right(&given, &given.solved(), "mu = 1e6");
    let cones = Cones::new(2, vec![Node::new(Some(0), &[1], 0.5, 0.0).unwrap()]).unwrap();
    assert_eq!((cones.order(), cones.free().len()), (2, 0));
}

/// Refuses so many answers.
struct Strict(usize);

impl feti_contact::qp::AcceptanceTest for Strict {
    fn scale(&mut self, _: &[f64], _: &[f64]) -> Result<f64> {
        Ok(1.0)
    }

    fn accepts(&mut self, _: &[f64], _: &[f64]) -> Result<bool> {
        self.0 = self.0.saturating_sub(1);
        Ok(self.0 == 0)
    }
}

#[test]
fn an_answer_that_is_refused_becomes_better_or_is_said_to_be_inaccurate() {
    let given = block().given();
    let run = |refusals: usize| {
        let limits = given.limits(1e-6, 0);
        friction(given.problem(), limits, FrictionStart::default(), &mut Strict(refusals), &mut Content)
            .unwrap()
    };
    let (first, third) = (run(1), run(3));
    assert_eq!((&first.verdict, &third.verdict), (&Verdict::Solved, &Verdict::Solved));
    assert!(third.merit < 0.2 * first.merit && third.counts.products > first.counts.products);
    assert_eq!(run(100).verdict, Verdict::Inaccurate);
}

/// A tower of blocks, three motions each, that touch in two nodes; a chain of modes that no small part of W holds apart.
#[test]
fn a_tower_of_many_blocks_stands() {
    let mut random = Random::new(11);
    for blocks in [5, 40, 200] {
        let (m, r) = (4 * blocks, 3 * blocks);
        let mut g = feti_contact::linalg::Csr::empty(r);
        // rows (normal, tangential) of the two nodes below block p, over the motions of p and p - 1
        for p in 0..blocks {
            for (x, along) in [(-0.5, false), (-0.5, true), (0.5, false), (0.5, true)] {
                let of =
                    |y: f64, sign: f64| if along { [sign, 0.0, -sign * y] } else { [0.0, sign, sign * x] };
                let below = if p > 0 { of(0.5, -1.0).to_vec() } else { Vec::new() };
                let above = of(-0.5, 1.0);
                let first = if p > 0 { 3 * (p - 1) } else { 0 };
                g.push_row(below.into_iter().chain(above).enumerate().map(|(k, v)| (first + k, -0.5 * v)));
            }
        }
        // weight, and a push that friction holds
        let e: Vec<f64> = (0..r).map(|k| [0.002, -0.5, 0.0][k % 3] / blocks as f64).collect();
        let f = Matrix::from_fn(m, m, |i, j| match i.abs_diff(j) {
            0 => 1.0,
            2 => 0.3,
            _ => 0.0,
        })
        .unwrap();
        let d: Vec<f64> =
            (0..m).map(|i| if i % 2 == 0 { -1e-4 * (1.0 + random.next()) } else { 0.0 }).collect();
        let nodes =
            (0..2 * blocks).map(|i| Node::new(Some(2 * i), &[2 * i + 1], 0.4, 0.0).unwrap()).collect();
        let mut given = Given::new(f, d, nodes);
        (given.g_transposed, given.e) = (g, e);
        let found = given.from(FrictionStart::default(), 1e-9, 0);
        println!("{blocks} blocks: {} products {:?}", found.counts.products, found.counts);
        right(&given, &found, "tower");
    }
}

/// Without a preconditioner there are more directions on a face.
#[test]
fn blocks_are_solved_without_a_preconditioner() {
    for deck in [block(), Deck::new(3, 3, 1, 0.6, 0.8), Deck::new(2, 8, 3, 0.6, 0.5)] {
        let mut given = deck.given();
        given.preconditioner = None;
        let found = given.from(FrictionStart::default(), 1e-8, 0);
        println!("{}D {}: {} products {:?}", deck.dim, deck.blocks, found.counts.products, found.counts);
        right(&given, &found, "no preconditioner");
    }
}

/// The second tangential row of each node times 10 and 100, both times the same root: an ellipse in place of a disc.
#[test]
fn tangential_rows_of_very_different_lengths_are_solved() {
    for factor in [10.0, 100.0] {
        // the longer row of each node has the smaller force per unit of x
        let mut given = Deck::new(3, 4, 1, 0.6, 0.5 / factor).given();
        let m = given.d.len();
        let mean = (0.5f64 * (1.0 + factor * factor)).sqrt();
        let by = |i: usize| [1.0, 1.0 / mean, factor / mean][i % 3];
        given.f.0 = Matrix::from_fn(m, m, |i, j| by(i) * given.f.0.get(i, j) * by(j)).unwrap();
        given.d.iter_mut().enumerate().for_each(|(i, d)| *d *= by(i));
        for i in 0..m {
            let own = given.g_transposed.ptr[i]..given.g_transposed.ptr[i + 1];
            given.g_transposed.val[own].iter_mut().for_each(|v| *v *= by(i));
        }
        let preconditioner = given.preconditioner.as_mut().unwrap();
        for matrix in [&mut preconditioner.coupling, &mut preconditioner.middle] {
            *matrix = Matrix::from_fn(m, m, |i, j| by(i) * matrix.get(i, j) * by(j)).unwrap();
        }
        let found = given.from(FrictionStart::default(), 1e-9, 400);
        println!("{factor}: {:?} {} products {:?}", found.verdict, found.counts.products, found.counts);
        right(&given, &found, "lengths");
    }
}
