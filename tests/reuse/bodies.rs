//! Bodies that are alike.

use decks::{Cube, Deck, Moduli};
use feti_contact::solver::Problem;

use crate::reuse::{answer, spent};
use crate::support::hand_over;

/// A cube of eight subdomains of one mesh, glued, on an obstacle.
fn cube(moduli: Moduli) -> Deck {
    Cube { moduli, waves: 0.3, ..Cube::default() }.build()
}

/// The ways to say what the null space is.
const SAID: [&str; 3] = ["nothing", "vectors", "coordinates"];

fn problem(deck: &Deck, said: &str) -> Problem {
    let mut problem = match said {
        "vectors" => hand_over::problem(deck).unwrap(),
        _ => hand_over::without_null_spaces(deck).unwrap(),
    };
    for (p, body) in deck.bodies.iter().enumerate().filter(|_| said == "coordinates") {
        let xyz = body.coordinates.concat();
        problem.set_coordinates(p, 3, &body.node, &body.direction, &xyz, 3).unwrap();
    }
    problem
}

/// Their coordinates, and so their vectors, differ by where they are.
#[test]
fn eight_equal_bodies_take_one_analysis_and_one_factorisation() {
    let deck = cube(Moduli::Uniform);
    for said in SAID {
        let mut before = [0; 4];
        let spent = spent(&mut problem(&deck, said), &mut before);
        assert_eq!(spent[..2], [1, 1], "{said}");
    }
}

#[test]
fn eight_bodies_of_one_mesh_and_different_materials_take_one_analysis() {
    let moduli = [1.0, 3.0, 0.7, 11.0, 5.0, 0.3, 1.7, 2.9];
    let deck = cube(Moduli::Given(moduli.to_vec()));
    for said in SAID {
        let mut before = [0; 4];
        let spent = spent(&mut problem(&deck, said), &mut before);
        assert_eq!(spent[..2], [1, 8], "{said}");
    }
}

/// K+ of every body against a problem that has no other.
#[test]
fn what_equal_bodies_share_is_what_each_would_have_alone_bit_by_bit() {
    let deck = cube(Moduli::Uniform);
    for said in SAID {
        let mut shared = problem(&deck, said);
        let mut before = [0; 4];
        assert_eq!(spent(&mut shared, &mut before)[1], 1);
        let n = deck.bodies[0].dofs();
        let force: Vec<f64> = (0..n).map(|i| (1.0 + i as f64).sin()).collect();
        for p in 0..8 {
            let alone = Deck::new("alone", vec![deck.bodies[p].clone()]);
            let mut alone = problem(&alone, said);
            let (mut u, mut v) = (vec![0.0; n], vec![0.0; n]);
            shared.kplus(p, &force, &mut u).unwrap();
            alone.kplus(0, &force, &mut v).unwrap();
            assert_eq!(shared.fixing_dofs(p).unwrap(), alone.fixing_dofs(0).unwrap(), "{said}, body {p}");
            assert_eq!(u, v, "{said}, body {p}");
            assert_eq!(shared.null_space(p).unwrap(), alone.null_space(0).unwrap(), "{said}, body {p}");
        }
    }
}

#[test]
fn a_body_that_becomes_equal_to_another_takes_its_factor_and_leaves_it_again() {
    let deck = cube(Moduli::Uniform);
    let mut problem = problem(&deck, "nothing");
    let mut before = [0; 4];
    spent(&mut problem, &mut before);
    let first = answer(&problem);
    let mut stiffer = deck.bodies[3].clone();
    stiffer.stiffness.val.iter_mut().for_each(|k| *k *= 0.8);
    hand_over::set_body(&mut problem, 3, &stiffer).unwrap();
    assert_eq!(spent(&mut problem, &mut before)[..2], [0, 1]);
    hand_over::set_body(&mut problem, 3, &deck.bodies[3]).unwrap();
    assert_eq!(spent(&mut problem, &mut before)[..2], [0, 0]);
    assert!(answer(&problem) == first, "bits differ");
}

/// The limit that one factor and all operators fit in holds for eight equal bodies.
#[test]
fn memory_is_counted_once_for_equal_bodies() {
    let least = |deck: &Deck| {
        let fits = |limit: i64| {
            let mut problem = problem(deck, "nothing");
            problem.set_i64("memory_limit", limit).unwrap();
            problem.setup().is_ok()
        };
        let (mut low, mut high) = (0, 1 << 30);
        while high - low > 1 {
            let middle = (low + high) / 2;
            *(if fits(middle) { &mut high } else { &mut low }) = middle;
        }
        high
    };
    let equal = least(&cube(Moduli::Uniform));
    let different = least(&cube(Moduli::Given((1..9).map(f64::from).collect())));
    let mut alone = cube(Moduli::Uniform);
    alone = Deck::new("alone", vec![alone.bodies.remove(0)]);
    assert_eq!(different - equal, 7 * least(&alone), "bytes of seven factors");
}
