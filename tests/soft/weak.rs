//! Springs and rounding of 1e-12 to 1e-4 of K.

use decks::random::Random;
use decks::{masonry, Deck, Rows};
use feti_contact::solver::{Modes, Outcome};

use crate::soft::{
    add_diagonal, assert_same_bits_for_any_threads, column, column_on, difference, given, oracle, rounded,
    solved, with_springs, Solved, ELEMENTS,
};
use crate::support::hand_over;

/// Shares of the largest K_ii, by decades.
fn decades() -> impl Iterator<Item = f64> {
    (-12..=-4).map(|decade| 10f64.powi(decade))
}

/// Right to 1e-8 against the dense answer, in at most 1.2 times as many products as without what resists the motions.
fn claim(failed: &mut Vec<String>, what: &str, deck: &Deck, found: &Solved, plain: usize) {
    let closed: Vec<usize> = (0..found.lambda.len()).filter(|&i| found.lambda[i] > 0.0).collect();
    match oracle::solve(deck, &closed) {
        Err(error) => failed.push(format!("{what}: {error}")),
        Ok(truth) => {
            let (forces, u) = (difference(&found.lambda, &truth.lambda), difference(&found.u, &truth.u));
            let most = truth.u.iter().fold(0.0, |m: f64, u| m.max(u.abs()));
            println!(
                "{what}: |u| {most:.1e} forces {forces:.1e} u {u:.1e} products {} of {plain}",
                found.products
            );
            if !(forces <= 1e-8 && u <= 1e-8) {
                failed.push(format!("{what}: forces {forces:.1e} u {u:.1e}"));
            }
        }
    }
    if found.products as f64 > (1.2 * plain as f64).ceil() {
        failed.push(format!("{what}: {} products, {plain} without", found.products));
    }
}

fn assert_all(what: &str, blocks: usize, change: impl Fn(Deck, f64) -> Deck) {
    let mut failed = Vec::new();
    let plain = solved(&mut given(&column(blocks), Modes::Exact)).unwrap().products;
    for share in decades() {
        let (deck, what) = (change(column(blocks), share), format!("{what} {share:e}, {blocks} blocks"));
        match solved(&mut given(&deck, Modes::Soft)) {
            Ok(found) => claim(&mut failed, &what, &deck, &found, plain),
            Err(error) => failed.push(format!("{what}: {error}")),
        }
    }
    assert!(failed.is_empty(), "{}", failed.join("\n"));
}

#[test]
fn weak_springs_of_any_stiffness_under_soft_motions_give_the_forces_of_the_dense_answer() {
    [1, 3].into_iter().for_each(|blocks| assert_all("springs", blocks, with_springs));
}

#[test]
fn rounded_entries_and_weak_springs_under_soft_motions_give_the_forces_of_the_dense_answer() {
    for blocks in [1, 3] {
        assert_all("rounded to 10", blocks, |deck, share| rounded(with_springs(deck, share), 10));
    }
}

#[test]
fn rounded_entries_under_soft_motions_give_the_forces_of_the_dense_answer() {
    let mut failed = Vec::new();
    for blocks in [1, 3] {
        let plain = solved(&mut given(&column(blocks), Modes::Exact)).unwrap().products;
        for digits in 8..=12 {
            let (deck, what) = (rounded(column(blocks), digits), format!("{digits} digits, {blocks} blocks"));
            let found = solved(&mut given(&deck, Modes::Soft)).unwrap();
            claim(&mut failed, &what, &deck, &found, plain);
        }
    }
    assert!(failed.is_empty(), "{}", failed.join("\n"));
}

/// Nothing but the springs holds the load from aside: the blocks travel up to 1e4 times as far as they deform.
#[test]
fn a_load_that_weak_springs_alone_hold_is_held_by_them() {
    let mut failed = Vec::new();
    for decade in -8..=-4 {
        let (share, mut deck) = (10f64.powi(decade), column(3));
        deck.equalities = Rows::none(deck.dofs());
        let deck = with_springs(deck, share);
        match solved(&mut given(&deck, Modes::Soft)) {
            Ok(found) => claim(&mut failed, &format!("held by springs {share:e}"), &deck, &found, 20),
            Err(error) => failed.push(format!("{share:e}: {error}")),
        }
    }
    assert!(failed.is_empty(), "{}", failed.join("\n"));
}

/// A column of up to 10 blocks, its loads, aside and down, and its gaps at random.
fn random_column(seed: u64) -> Deck {
    let mut random = Random::new(seed);
    let [nx, ny, _] = ELEMENTS;
    let mut deck = column_on(1 + seed as usize % 10, 0..=nx, random.between(0.0, 0.3));
    for body in &mut deck.bodies {
        for x in 0..=nx {
            let node = 2 * (ny * (nx + 1) + x);
            body.load[node] += random.between(-1.5e-4, 1.5e-4);
            body.load[node + 1] *= random.between(0.5, 1.5);
        }
    }
    let gap = |gap: &mut f64| *gap = if random.chance(0.3) { random.between(0.0, 3e-3) } else { 0.0 };
    deck.contact.rhs.iter_mut().for_each(gap);
    deck
}

/// The unknowns of springs have 1 in F and all but nothing beside it: one eigenvalue more for the conjugate gradients, which takes one
/// step, or two where stiffer springs spread it. Of the 8 products of a block alone 1.2 times as many leave room for one.
#[test]
fn springs_cost_a_product_or_two_of_random_columns() {
    let decks: Vec<Deck> = (0..50).map(random_column).collect();
    let products = |deck: &Deck, modes| solved(&mut given(deck, modes)).unwrap().products;
    let plain: Vec<usize> = decks.iter().map(|deck| products(deck, Modes::Exact)).collect();
    for decade in -12..=-5 {
        let with = |deck: &Deck| products(&with_springs(deck.clone(), 10f64.powi(decade)), Modes::Soft);
        let found: Vec<usize> = decks.iter().map(with).collect();
        let mut ratios: Vec<f64> = found.iter().zip(&plain).map(|(a, b)| *a as f64 / *b as f64).collect();
        ratios.sort_by(f64::total_cmp);
        println!("1e{decade}: median {:.3}, worst {:.3}", ratios[25], ratios[49]);
        assert!(ratios[25] <= 1.13, "1e{decade}: {}", ratios[25]);
        for (seed, (found, plain)) in found.into_iter().zip(plain.iter().copied()).enumerate() {
            let most = if plain < 10 { plain + 2 } else { 12 * plain / 10 };
            assert!(found <= most, "1e{decade}, {seed}: {found} of {plain}");
        }
    }
}

#[test]
fn motions_that_nothing_resists_are_solved_as_an_exact_null_space() {
    let (exact, soft) =
        [Modes::Exact, Modes::Soft].map(|modes| solved(&mut given(&column(3), modes)).unwrap()).into();
    assert!(difference(&soft.lambda, &exact.lambda) <= 1e-12 && difference(&soft.u, &exact.u) <= 1e-12);
    assert_eq!(soft.products, exact.products);
}

/// Motions that are wrong by 1e-3 choose the same unknowns.
#[test]
fn soft_motions_need_not_be_exact() {
    let deck = with_springs(column(2), 1e-9);
    let mut wrong = deck.clone();
    for body in &mut wrong.bodies {
        for motion in body.null_space.iter_mut().flatten() {
            motion.iter_mut().enumerate().for_each(|(i, v)| *v += 1e-3 * (i as f64).sin());
        }
    }
    let [right, found] = [deck, wrong].map(|deck| solved(&mut given(&deck, Modes::Soft)).unwrap());
    assert!(difference(&found.lambda, &right.lambda) <= 1e-10 && difference(&found.u, &right.u) <= 1e-10);
}

/// Forces times 1e7, lengths times 1e-3, K as both ask.
#[test]
fn units_change_nothing() {
    let deck = with_springs(rounded(column(2), 10), 1e-8);
    let (force, length) = (1e7, 1e-3);
    let mut other = deck.clone();
    for body in &mut other.bodies {
        body.stiffness.val.iter_mut().for_each(|v| *v *= force / length);
        body.load.iter_mut().for_each(|f| *f *= force);
    }
    other.contact.rhs.iter_mut().for_each(|c| *c *= length);
    let [one, other] = [deck, other].map(|deck| solved(&mut given(&deck, Modes::Soft)).unwrap());
    let scaled = |x: &[f64], by: f64| x.iter().map(|x| x * by).collect::<Vec<_>>();
    assert!(difference(&other.lambda, &scaled(&one.lambda, force)) <= 1e-10);
    assert!(difference(&other.u, &scaled(&one.u, length)) <= 1e-10);
    assert_eq!(other.products, one.products);
}

#[test]
fn any_number_of_threads_gives_the_same_bits() {
    assert_same_bits_for_any_threads(&with_springs(rounded(column(4), 10), 1e-7));
}

/// What the host sees has its own rows alone, and the certificate of the answer is that of another code.
#[test]
fn springs_of_bodies_are_no_rows_of_the_host() {
    let deck = with_springs(column(2), 1e-6);
    let mut problem = given(&deck, Modes::Soft);
    let found = solved(&mut problem).unwrap();
    assert_eq!((found.lambda.len(), found.mu.len()), (deck.contact.len(), deck.equalities.len()));
    assert_eq!(problem.gaps().unwrap().len(), deck.contact.len());
    let certificate = problem.check(&found.u, &found.lambda, &found.mu).unwrap();
    assert!(certificate.passed());
    let mut wrong = found.lambda.clone();
    wrong[0] *= 1.0 + 1e-6;
    assert!(!problem.check(&found.u, &wrong, &found.mu).unwrap().passed());
}

#[test]
fn every_method_and_option_knows_springs() {
    let deck = with_springs(column(2), 1e-6);
    let right = solved(&mut given(&deck, Modes::Soft)).unwrap();
    for (option, value) in [
        ("method", "paper-monotone"),
        ("preconditioner", "lumped"),
        ("preconditioner", "dirichlet"),
        ("finish", "direct"),
        ("dual_operator", "implicit"),
        ("start", "previous"),
    ] {
        let mut problem = given(&deck, Modes::Soft);
        problem.set_str(option, value).unwrap();
        problem.solve().unwrap();
        let found = solved(&mut problem).unwrap();
        let error = difference(&found.lambda, &right.lambda);
        assert!(error <= 1e-8, "{option} {value}: {error:.1e}");
    }
}

/// Without a word of the host.
#[test]
fn weak_springs_that_nobody_tells_of_are_found() {
    let mut failed = Vec::new();
    for blocks in [1, 3] {
        let plain = solved(&mut hand_over::without_null_spaces(&column(blocks)).unwrap()).unwrap().products;
        for share in decades().filter(|share| *share < 2e-6) {
            let (deck, what) =
                (with_springs(column(blocks), share), format!("found {share:e}, {blocks} blocks"));
            let mut problem = hand_over::without_null_spaces(&deck).unwrap();
            match solved(&mut problem) {
                Ok(found) => claim(&mut failed, &what, &deck, &found, plain),
                Err(error) => failed.push(format!("{what}: {error}")),
            }
            let soft: Vec<usize> = (0..blocks).collect();
            if share > 1e-11 && problem.findings().unwrap().soft != soft {
                failed.push(format!("{what}: told of {:?}", problem.findings().unwrap().soft));
            }
        }
    }
    assert!(failed.is_empty(), "{}", failed.join("\n"));
}

/// Towers, walls and heaps, most bodies free to slide but for the springs.
#[test]
fn many_loose_bodies_on_weak_springs_are_solved_in_few_products() {
    let mut failed = Vec::new();
    for (what, plain) in
        [("tower", masonry::tower(30)), ("wall", masonry::wall(6, 1e-4)), ("heap", masonry::heap(40, 3))]
    {
        for share in [1e-10, 1e-8, 1e-6] {
            let mut deck = plain.clone();
            for body in &mut deck.bodies {
                let largest = body.stiffness.diagonal().into_iter().fold(0.0, f64::max);
                (0..body.dofs()).for_each(|dof| add_diagonal(body, dof, share * largest));
            }
            for told in [true, false] {
                let mut problem = if told {
                    given(&deck, Modes::Soft)
                } else {
                    hand_over::without_null_spaces(&deck).unwrap()
                };
                match problem.solve() {
                    Ok(report) => {
                        let (outcome, products) = (report.outcome, report.counts.products);
                        if outcome != Outcome::Solved || products > 60 {
                            failed.push(format!("{what} {share:e} {told}: {outcome:?} {products}"));
                        }
                    }
                    Err(error) => failed.push(format!("{what} {share:e} {told}: {error}")),
                }
            }
        }
    }
    assert!(failed.is_empty(), "{}", failed.join("\n"));
}
