//! The same problem with every spring as a body of one unknown: K~ = diag(K, k), B~ = [B, -I], all rows rigid. The
//! library then meets no compliance at all.

use decks::random::Random;
use decks::{battery, Cube, Deck, Glue, Moduli, Rows, Stack};
use feti_contact::solver::{Problem, Report};

use crate::compliance::{answer, assert_near, body, solved};
use crate::support::hand_over;

/// The deck with its springs as bodies behind all others.
fn with_explicit_springs(deck: &Deck) -> Deck {
    let springs: usize = [&deck.contact, &deck.equalities].iter().map(|rows| springs_in(rows)).sum();
    let dofs = deck.dofs() + springs;
    let mut explicit = Deck { contact: Rows::none(dofs), equalities: Rows::none(dofs), ..deck.clone() };
    let mut next = deck.dofs();
    let pairs = [(&deck.contact, &mut explicit.contact), (&deck.equalities, &mut explicit.equalities)];
    for (rows, rigid) in pairs {
        for i in 0..rows.len() {
            let mut entries: Vec<_> = rows.matrix.row(i).collect();
            if rows.compliance[i] > 0.0 {
                entries.push((next, -1.0));
                explicit.bodies.push(body(&[1.0 / rows.compliance[i]], &[0.0], false));
                next += 1;
            }
            rigid.push(&entries, rows.rhs[i]);
        }
    }
    explicit
}

fn springs_in(rows: &Rows) -> usize {
    rows.compliance.iter().filter(|inv_k| **inv_k > 0.0).count()
}

/// Every `each`-th row a spring, `factors` times as compliant as the bodies are at the row.
fn with_springs(mut deck: Deck, each: usize, [low, high]: [f64; 2]) -> Deck {
    let mut random = Random::new(each as u64);
    let diagonal: Vec<f64> = deck.bodies.iter().flat_map(|body| body.stiffness.diagonal()).collect();
    for rows in [&mut deck.contact, &mut deck.equalities] {
        for i in (0..rows.len()).step_by(each) {
            let local: f64 = rows.matrix.row(i).map(|(j, v)| v * v / diagonal[j]).sum();
            rows.compliance[i] = local * random.decades(low, high);
        }
    }
    deck.name += "_compliant";
    deck
}

fn solved_with(deck: &Deck, method: &str, preconditioner: &str) -> (Problem, Report) {
    let mut problem = hand_over::problem(deck).unwrap();
    problem.set_str("method", method).unwrap();
    problem.set_str("preconditioner", preconditioner).unwrap();
    let name = format!("{}, {method}, {preconditioner}", deck.name);
    let report = solved(&mut problem, &name);
    (problem, report)
}

/// Displacements, lambda, mu and energy of both, to 1e-10; the springs are as long as their forces say.
fn assert_same_answer(deck: &Deck, method: &str, preconditioner: &str) {
    let (implicit, report) = solved_with(deck, method, preconditioner);
    let (explicit, expected) = solved_with(&with_explicit_springs(deck), method, preconditioner);
    let ([u, lambda, mu], [all, forces, supports]) = (answer(&implicit), answer(&explicit));
    let (bodies, springs) = all.split_at(deck.dofs());
    assert!(!springs.is_empty() && lambda.iter().any(|l| *l > 0.0), "{}: nothing is tested", deck.name);
    assert_near(&u, bodies, 1e-10, &format!("{}: u", deck.name));
    assert_near(&lambda, &forces, 1e-10, &format!("{}: lambda", deck.name));
    assert_near(&mu, &supports, 1e-10, &format!("{}: mu", deck.name));
    assert!((report.energy - expected.energy).abs() <= 1e-10 * expected.energy.abs(), "{}", deck.name);
    let compliance = deck.contact.compliance.iter().chain(&deck.equalities.compliance);
    let forces = lambda.iter().chain(&mu).zip(compliance).filter(|(_, inv_k)| **inv_k > 0.0);
    let lengths: Vec<f64> = forces.map(|(l, inv_k)| l * inv_k).collect();
    assert_near(&lengths, springs, 1e-10, &format!("{}: springs", deck.name));
}

fn cube() -> Cube {
    Cube { elements: 2, glue: Glue::NonRedundant, ..Cube::default() }
}

/// Floating and held, springs of all kinds in contact, supports and glue.
fn decks() -> Vec<Deck> {
    let stack = Stack { in_plane: vec![4, 3], layers: vec![1], noise: 0.1, ..Stack::default() };
    let plane = Cube { dimension: 2, subdomains: [3, 2, 1], elements: 3, ..cube() };
    vec![
        with_springs(stack.build(), 1, [-1.0, 1.0]),
        with_springs(Stack { hold: true, ..stack.clone() }.build(), 2, [-3.0, 2.0]),
        with_springs(Stack { bodies: 3, moduli: vec![1.0, 1e-3, 10.0], ..stack }.build(), 3, [-2.0, 2.0]),
        with_springs(Cube { clamp: false, waves: 0.3, ..cube() }.build(), 2, [-2.0, 2.0]),
        with_springs(Cube { moduli: Moduli::Checkerboard(10.0), ..plane.clone() }.build(), 1, [-2.0, 0.0]),
        Cube { layer: 0.3, ..plane }.build(),
        Cube { layer: 0.3, ..cube() }.build(),
    ]
}

#[test]
fn springs_as_bodies_give_the_same_displacements_and_forces() {
    decks().iter().for_each(|deck| assert_same_answer(deck, "proportioning", "none"));
}

#[test]
fn so_they_do_with_preconditioners() {
    for deck in decks() {
        assert_same_answer(&deck, "proportioning", "lumped");
        assert_same_answer(&deck, "proportioning", "dirichlet");
    }
}

/// Springs between 1e-4 and 1e4 times the compliance of the bodies, in every other row of either kind.
#[test]
fn random_hard_problems_with_springs_have_the_energy_of_those_with_bodies_instead() {
    for (seed, case) in (0..400).zip(battery::cases(0..400)) {
        if case.outcome() != battery::Outcome::Solvable {
            continue;
        }
        let deck = battery::compliant(case, seed).deck;
        let (implicit, report) = solved_with(&deck, "proportioning", "none");
        let expected = solved_with(&with_explicit_springs(&deck), "proportioning", "none").1;
        let error = (report.energy - expected.energy).abs();
        let [u, ..] = answer(&implicit);
        let work: f64 = u.iter().zip(deck.load()).map(|(u, f)| (u * f).abs()).sum();
        assert!(error <= 1e-8 * work, "{}: {error:e} of {work:e}", deck.name);
    }
}

/// The preconditioner knows the springs: as many steps as with springs as bodies, up to two.
#[test]
fn the_preconditioner_contains_the_springs() {
    for deck in decks() {
        let steps = |deck: &Deck| solved_with(deck, "proportioning", "dirichlet").1.counts.products;
        let (implicit, explicit) = (steps(&deck), steps(&with_explicit_springs(&deck)));
        assert!(implicit <= explicit + 2, "{}: {implicit} products, {explicit} with bodies", deck.name);
    }
}
