//! Groups of bodies that no row joins are problems of their own: each ends as if it were alone.

use decks::Deck;
use feti_contact::error::Kind;
use feti_contact::solver::{Problem, Report, RowKind};

use crate::scales::plane::{pressed, scaled, side_by_side, under_a_wall};
use crate::scales::{difference, problem, solved, Answer, Claims};

/// A floating block on a held one, and another pair of another size: 13 and 9 contact rows.
fn pair(stiffness: f64, load: f64) -> [Deck; 2] {
    [pressed(12, 6, 0.0), scaled(pressed(8, 5, 0.001), stiffness, load)]
}

/// The claims that u, lambda and mu have the bits of `alone`.
fn claim_bits(claims: &mut Claims, found: [&[f64]; 3], alone: &Answer, what: &str) {
    for (values, expected, name) in
        [(found[0], &alone.u, "u"), (found[1], &alone.lambda, "lambda"), (found[2], &alone.mu, "mu")]
    {
        let same = values.len() == expected.len()
            && values.iter().zip(expected).all(|(a, b)| a.to_bits() == b.to_bits());
        let off = if values.len() == expected.len() { difference(values, expected) } else { f64::NAN };
        claims.claim(same, || format!("{what}, {name}: not the same bits, off by {off:.1e}"));
    }
}

/// What must add up over the groups.
fn work_of(report: &Report) -> [usize; 5] {
    let r = report;
    [r.counts.steps(), r.counts.products, r.counts.conjugate_gradient, r.counts.expansions, r.counts.releases]
}

/// The decks side by side against each of them alone.
fn assert_alone(decks: &[Deck], options: impl Fn(&mut Problem), claims: &mut Claims, what: &str) {
    let alone: Vec<Answer> = decks
        .iter()
        .map(|deck| {
            let mut problem = problem(deck);
            options(&mut problem);
            solved(&mut problem)
        })
        .collect();
    let mut together = problem(&side_by_side(decks));
    options(&mut together);
    let Some(found) = claims.solved(&mut together, what) else { return };
    let mut at = [0; 3];
    for (k, (deck, alone)) in decks.iter().zip(&alone).enumerate() {
        let own = |from: usize, n: usize| from..from + n;
        let [u, l, m] =
            [own(at[0], deck.dofs()), own(at[1], deck.contact.len()), own(at[2], deck.equalities.len())];
        let parts = [&found.u[u.clone()], &found.lambda[l.clone()], &found.mu[m.clone()]];
        claim_bits(claims, parts, alone, &format!("{what}, group {k}"));
        at = [u.end, l.end, m.end];
    }
    let sum =
        alone.iter().map(|a| work_of(&a.report)).fold([0; 5], |s, w| std::array::from_fn(|i| s[i] + w[i]));
    claims.claim(work_of(&found.report) == sum, || {
        let counts = work_of(&found.report);
        format!("{what}: steps, products, cg, expansions, releases {counts:?}, alone {sum:?}")
    });
}

fn assert_pairs(scales: &[(f64, f64)], options: impl Fn(&mut Problem)) {
    let mut claims = Claims::default();
    for (stiffness, load) in scales {
        let [first, second] = pair(*stiffness, *load);
        let what = format!("stiffness {stiffness:e}, load {load:e}");
        assert_alone(&[first.clone(), second.clone()], &options, &mut claims, &what);
        assert_alone(&[second, first], &options, &mut claims, &format!("{what}, the other first"));
    }
    claims.end();
}

const LOADS: [(f64, f64); 4] = [(1.0, 1.0), (1.0, 1e5), (1.0, 1e8), (1.0, 1e12)];
const STIFFNESSES: [(f64, f64); 4] = [(1e-8, 1.0), (1e-4, 1.0), (1e4, 1.0), (1e8, 1.0)];

#[test]
fn groups_of_unequal_load_have_the_bits_that_they_have_alone() {
    assert_pairs(&LOADS, |_| {});
}

#[test]
fn groups_of_unequal_load_have_the_bits_that_they_have_alone_under_a_loose_tolerance() {
    assert_pairs(&LOADS, |p| p.set_f64("tolerance", 1e-8).unwrap());
}

#[test]
fn groups_of_unequal_stiffness_have_the_bits_that_they_have_alone() {
    assert_pairs(&STIFFNESSES, |_| {});
}

#[test]
fn groups_of_unequal_stiffness_have_the_bits_that_they_have_alone_under_a_loose_tolerance() {
    assert_pairs(&STIFFNESSES, |p| p.set_f64("tolerance", 1e-8).unwrap());
}

/// Forces of the light group right to 1e-8 of its own largest: the least that the same bits must give.
#[test]
fn forces_of_a_light_group_are_right_beside_a_heavy_one() {
    let mut claims = Claims::default();
    for (load, tolerance) in LOADS[1..].iter().flat_map(|(_, load)| [1e-12, 1e-8].map(|tol| (*load, tol))) {
        let [light, heavy] = pair(1.0, load);
        let expected = solved(&mut problem(&light)).lambda;
        let mut together = problem(&side_by_side(&[light, heavy]));
        together.set_f64("tolerance", tolerance).unwrap();
        let what = format!("load {load:e}, tolerance {tolerance:e}");
        if let Some(found) = claims.solved(&mut together, &what) {
            let limit = if tolerance < 1e-10 { 1e-8 } else { 1e-5 };
            claims.at_most(difference(&found.lambda[..expected.len()], &expected), limit, &what);
        }
    }
    claims.end();
}

/// The light group without any force, beside a heavy one in the right state.
#[test]
fn a_light_group_without_contact_is_refused_beside_a_heavy_one() {
    let mut claims = Claims::default();
    for load in [1.0, 1e5, 1e8, 1e12] {
        let (light, heavy) = (under_a_wall(12, 4), scaled(under_a_wall(8, 4), 1.0, load));
        let free = solved(&mut problem(&Deck { contact: decks::Rows::none(light.dofs()), ..light.clone() }));
        let right = solved(&mut problem(&heavy));
        let mut together = problem(&side_by_side(&[light.clone(), heavy]));
        let lambda = [vec![0.0; light.contact.len()], right.lambda.clone()].concat();
        let certificate = together.check(&[free.u, right.u.clone()].concat(), &lambda, &[]).unwrap();
        claims.claim(!certificate.passed(), || format!("load {load:e}: worst {:.1e}", certificate.worst()));
        let own = solved(&mut problem(&light));
        let lambda = [own.lambda, right.lambda].concat();
        let certificate = together.check(&[own.u, right.u].concat(), &lambda, &[]).unwrap();
        claims.claim(certificate.passed(), || {
            format!("load {load:e}: the right answer is refused, worst {:.1e}", certificate.worst())
        });
    }
    claims.end();
}

/// Pulled up, the second pair has a floating block that nothing holds.
fn one_pulled_off() -> [Deck; 2] {
    let [first, second] = pair(1.0, 1.0);
    [first, scaled_load(second, -1.0)]
}

fn scaled_load(mut deck: Deck, factor: f64) -> Deck {
    deck.bodies.iter_mut().flat_map(|body| &mut body.load).for_each(|f| *f *= factor);
    deck
}

/// Groups [held, pulled off] and [pulled off, held]: the error names the floating body of the one pulled off, the other
/// stays readable.
#[test]
fn a_group_whose_load_nothing_holds_leaves_the_other_readable() {
    let mut claims = Claims::default();
    for held_first in [true, false] {
        let [held, pulled] = one_pulled_off();
        let alone = solved(&mut problem(&held));
        let (decks, bodies, failed) = if held_first {
            ([held.clone(), pulled.clone()], [0, 1], [2, 3])
        } else {
            ([pulled.clone(), held.clone()], [2, 3], [0, 1])
        };
        let mut together = problem(&side_by_side(&decks));
        let what = format!("held first: {held_first}");
        let error = together.solve().map(|report| report.outcome).unwrap_err();
        claims.claim(error.kind == Kind::LoadNotHeld, || format!("{what}: {error}"));
        let place = error.place.body;
        claims.claim(place.is_some_and(|body| failed.contains(&body)), || {
            format!("{what}: names body {place:?}")
        });
        claim_readable(&mut claims, &together, [bodies, failed], &alone, held_first, &what);
    }
    claims.end();
}

/// `bodies`: those of the held group, those of the one that failed.
fn claim_readable(
    claims: &mut Claims,
    together: &Problem,
    [bodies, failed]: [[usize; 2]; 2],
    alone: &Answer,
    held_first: bool,
    what: &str,
) {
    for body in failed {
        let kind = together.displacement(body).map(<[f64]>::len).map_err(|error| error.kind);
        claims.claim(kind == Err(Kind::State), || format!("{what}: u of failed body {body}: {kind:?}"));
    }
    let u: Result<Vec<_>, _> = bodies.iter().map(|body| together.displacement(*body)).collect();
    let forces = [RowKind::Inequality, RowKind::Equality].map(|kind| together.multipliers(kind));
    let (Ok(u), [Ok(lambda), Ok(mu)]) = (u, forces) else {
        claims.claim(false, || format!("{what}: the held group cannot be read"));
        return;
    };
    let split = |all: &[f64], own: usize| -> (Vec<f64>, Vec<f64>) {
        let at = if held_first { own } else { all.len() - own };
        let (first, second) = all.split_at(at);
        if held_first {
            (first.to_vec(), second.to_vec())
        } else {
            (second.to_vec(), first.to_vec())
        }
    };
    let ((l, other_l), (m, other_m)) = (split(lambda, alone.lambda.len()), split(mu, alone.mu.len()));
    claim_bits(claims, [&u.concat(), &l, &m], alone, what);
    let unknown = other_l.iter().chain(&other_m).all(|force| force.is_nan());
    claims.claim(unknown, || format!("{what}: rows of the failed group have forces"));
}

#[test]
fn a_heavy_and_a_light_group_of_40_thousand_unknowns_have_the_bits_that_they_have_alone() {
    let mut claims = Claims::default();
    let decks = [pressed(70, 70, 0.0), scaled(pressed(70, 70, 0.001), 1.0, 1e8)];
    assert_alone(&decks, |_| {}, &mut claims, "load 1e8");
    claims.end();
}

/// Twelve groups, of loads from 1 to 1e11.
#[test]
fn a_dozen_groups_have_the_bits_that_they_have_alone() {
    let mut claims = Claims::default();
    let decks: Vec<Deck> =
        (0..12).map(|k| scaled(pressed(4 + k % 3, 2, 0.001), 1.0, 10f64.powi(k as i32))).collect();
    assert_alone(&decks, |_| {}, &mut claims, "twelve groups");
    claims.end();
}
