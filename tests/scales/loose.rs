//! Many loose bodies, most of which may slide somewhere: towers, walls, heaps, a glued column on the ground.

use decks::{masonry, Deck};

use crate::scales::{difference, problem, Answer, Claims};

/// K, f and all lengths in other units.
fn in_units(deck: &Deck, force: f64, length: f64) -> Deck {
    let mut deck = deck.clone();
    for body in &mut deck.bodies {
        body.stiffness.val.iter_mut().for_each(|v| *v *= force / length);
        body.load.iter_mut().for_each(|f| *f *= force);
    }
    deck.contact.rhs.iter_mut().for_each(|c| *c *= length);
    deck
}

fn on_threads(deck: &Deck, threads: i64, claims: &mut Claims) -> Option<Answer> {
    let mut problem = problem(deck);
    problem.set_i64("threads", threads).unwrap();
    claims.solved(&mut problem, &deck.name)
}

/// The forces of the rows on the ground, which have one entry: they carry the weight.
fn on_the_ground(deck: &Deck, answer: &Answer) -> f64 {
    let matrix = &deck.contact.matrix;
    let upward = |i: &usize| matrix.row(*i).count() == 1 && matrix.row(*i).all(|(j, _)| j % 2 == 1);
    (0..deck.contact.len()).filter(upward).map(|i| answer.lambda[i]).sum()
}

#[test]
fn walls_towers_and_heaps_carry_their_weight_in_any_unit_with_any_threads_and_slide_as_counted() {
    let mut claims = Claims::default();
    for (deck, least_free) in [
        (masonry::tower(40), 1),
        (masonry::wall(9, 0.0), 81),
        (masonry::wall(9, 1e-4), 81),
        (masonry::heap(60, 2), 30),
        (masonry::chain(90), 1),
    ] {
        let what = deck.name.clone();
        let Some(one) = on_threads(&deck, 1, &mut claims) else { continue };
        let weight: f64 = -deck.load().iter().sum::<f64>();
        claims.at_most((on_the_ground(&deck, &one) - weight).abs() / weight, 1e-9, &what);
        let free = one.report.undetermined;
        claims.claim(free >= least_free, || format!("{what}: {free} motions are free"));
        let Some(two) = on_threads(&deck, 2, &mut claims) else { continue };
        claims.claim(two.u == one.u && two.lambda == one.lambda, || format!("{what}: threads change bits"));
        let Some(other) = on_threads(&in_units(&deck, 3e7, 2.5e-3), 1, &mut claims) else { continue };
        let u: Vec<f64> = one.u.iter().map(|u| 2.5e-3 * u).collect();
        claims.at_most(difference(&other.u, &u), 1e-6, &format!("{what}: u of other units"));
        let counted = other.report.undetermined;
        claims
            .claim(counted == free, || format!("{what}: {counted} motions are free in other units, {free}"));
    }
    claims.end();
}

/// Many bodies that slide or fly, rows that are there twice, faces that leave hundreds of motions free: the forces come in about as
/// many products as those of a wall, on the way of the first method.
#[test]
fn heaps_of_any_seed_take_no_more_products_than_a_few_walls() {
    let mut claims = Claims::default();
    let products = |deck: &Deck, claims: &mut Claims| {
        on_threads(deck, 1, claims).map_or(0, |answer| answer.report.counts.products)
    };
    let wall = products(&masonry::wall(14, 1e-4), &mut claims);
    for seed in [1, 3, 4, 11, 12] {
        let deck = masonry::heap(250, seed);
        let of_heap = products(&deck, &mut claims);
        claims.claim(of_heap <= 6 * wall, || format!("seed {seed}: {of_heap} products, a wall takes {wall}"));
    }
    let tower = products(&masonry::tower(600), &mut claims);
    claims.claim(tower <= 2 * wall, || format!("tower: {tower} products, a wall takes {wall}"));
    claims.end();
}
