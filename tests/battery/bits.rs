//! One number for all bits of many answers: what changes no answer changes none of these lines. With feature `loopback` also one for what
//! bodies have answered to each kind of question.

use std::fmt::Write;
use std::hash::{DefaultHasher, Hash, Hasher};

use decks::hard;
use decks::varied;
use decks::{battery, Blocks, Cube, Deck, Membrane, Stack};
use feti_contact::error::Result;
use feti_contact::solver::{Modes, Problem, Report, RowKind, RowsInput, SparseInput, Storage};

use crate::coulomb;
use crate::soft;
use crate::support::hand_over;

/// Of a solve and of a second one, from there and with loads once and a quarter as large.
fn bits(problem: &mut Problem, loads: &[Vec<f64>]) -> u64 {
    let mut hasher = DefaultHasher::new();
    hash_answer(problem, loads, &mut hasher);
    problem.set_str("start", "previous").unwrap();
    for (p, load) in loads.iter().enumerate() {
        problem.set_load(p, &load.iter().map(|f| 1.25 * f).collect::<Vec<_>>()).unwrap();
    }
    hash_answer(problem, loads, &mut hasher);
    hasher.finish()
}

/// u, forces, K+ f and R bit by bit, and what the report says but for its times and bytes.
fn hash_answer(problem: &mut Problem, loads: &[Vec<f64>], hasher: &mut impl Hasher) {
    let ended = problem.solve();
    told(&ended).hash(hasher);
    if ended.is_ok() {
        let mut all = problem.displacements().unwrap().to_vec();
        RowKind::ALL.iter().for_each(|kind| all.extend(problem.multipliers(*kind).unwrap()));
        for (p, f) in loads.iter().enumerate() {
            let mut u = f.clone();
            problem.kplus(p, f, &mut u).ok();
            all.extend(u);
            all.extend(problem.null_space(p).iter().flat_map(|(_, basis)| basis.iter()));
        }
        all.iter().for_each(|v| v.to_bits().hash(hasher));
    }
}

/// Springs cut into pieces, from a held end to a stop, and two unknowns without stiffness, one pressed to another stop.
fn by_elements(seed: u64) -> u64 {
    let (n, given) = (8 + seed as usize % 20, |i: usize| 1.0 + ((seed + 7 * i as u64) % 13) as f64 / 3.0);
    let mut problem = Problem::new();
    problem.set_i64("pieces", 2 + seed as i64 % 4).unwrap();
    let (springs, loose) = (problem.add_body(n).unwrap(), problem.add_body(2).unwrap());
    let ends: Vec<i64> = (0..n as i64).flat_map(|i| [i - 1, i]).collect();
    problem.set_mesh(springs, &(0..=n).map(|e| 2 * e).collect::<Vec<_>>(), &ends).unwrap();
    for e in 0..n {
        let k = given(e);
        problem.add_element(springs, e, 2, &[k, -k, -k, k], 2).unwrap();
    }
    let none = SparseInput { ptr: &[0, 0, 0], col: &[], val: &[], storage: Storage::Lower };
    problem.set_stiffness(loose, none).unwrap();
    let loads = [(0..n).map(given).collect(), vec![given(n), 0.0]];
    loads.iter().enumerate().for_each(|(p, load): (_, &Vec<_>)| problem.set_load(p, load).unwrap());
    let (body, dof) = ([springs as i64, loose as i64], [n as i64 - 1, 0]);
    let (ptr, val, rhs) = ([0, 1, 2], [1.0, 1.0], [0.5, 0.25]);
    let rows = RowsInput { ptr: &ptr, body: Some(&body), dof: &dof, val: &val, rhs: Some(&rhs) };
    problem.add_rows(RowKind::Inequality, rows).unwrap();
    bits(&mut problem, &loads)
}

fn told(ended: &Result<Report>) -> String {
    match ended {
        Ok(report) => {
            let Report { outcome, body, certificate, counts, work, sizes, .. } = report;
            let figures = [report.unheld, report.gap_scale, report.energy];
            let more = (report.floating_modes, report.active, report.undetermined, report.finished);
            let operators = [report.explicit_operators, report.implicit_operators];
            format!("{outcome:?} {body:?} {certificate:?} {counts:?} {work:?} {sizes:?} {figures:?} {more:?} {operators:?}")
        }
        Err(error) => format!("{error} {:?}", error.place),
    }
}

fn loads(deck: &Deck) -> Vec<Vec<f64>> {
    deck.bodies.iter().map(|body| body.load.clone()).collect()
}

fn lines(out: &mut String, name: &str, answers: impl Iterator<Item = u64>) {
    for (k, some) in answers.collect::<Vec<_>>().chunks(100).enumerate() {
        let mut hasher = DefaultHasher::new();
        some.hash(&mut hasher);
        writeln!(out, "{name} {}: {:016x}", 100 * k, hasher.finish()).unwrap();
    }
}

/// `make bits > before`, then after the change, and compare.
#[test]
#[ignore]
fn the_bits_of_many_answers() {
    let mut out = String::new();
    #[cfg(feature = "loopback")]
    feti_contact::body::answers::record();
    let of_deck = |deck: &Deck, options: &str| {
        let mut problem = hand_over::problem(deck).unwrap();
        problem.set_text(options).unwrap();
        bits(&mut problem, &loads(deck))
    };
    let decks = [
        Membrane::p1_p1().build(),
        Membrane::p1_p3_galerkin().build(),
        Blocks { elements: 6, young: 2e5 }.build(),
        Stack { noise: 0.1, repeated: 5, ..Stack::default() }.build(),
        Cube::default().build(),
        Cube {
            dimension: 2,
            subdomains: [4, 4, 1],
            elements: 8,
            waves: 0.3,
            pressure: 1.0,
            ..Cube::default()
        }
        .build(),
    ];
    let options = [
        "",
        "method=paper-monotone",
        "method=paper-extrapolating dual_operator=implicit",
        "preconditioner=dirichlet threads=2",
    ];
    for options in options {
        lines(&mut out, &format!("decks {options}"), decks.iter().map(|deck| of_deck(deck, options)));
    }
    for (name, mixture) in [("hard", &hard::MIXTURE), ("hard, other mixture", &hard::SECOND_MIXTURE)] {
        let case = |seed| hard::mixed(seed, mixture);
        let answers = crate::battery::seeds().map(case).map(|case| {
            match crate::battery::hard::problem(&case.deck, case.given) {
                Ok(mut problem) => bits(&mut problem, &loads(&case.deck)),
                Err(_) => 0,
            }
        });
        lines(&mut out, name, answers);
    }
    lines(&mut out, "varied", crate::battery::seeds().map(|seed| of_deck(&varied::case(seed).deck, "")));
    lines(
        &mut out,
        "known outcome",
        battery::cases(crate::battery::seeds()).map(|case| of_deck(&case.deck, "")),
    );
    lines(
        &mut out,
        "marginal",
        crate::battery::seeds().map(|seed| of_deck(&battery::marginal(seed).deck, "")),
    );
    lines(
        &mut out,
        "friction",
        crate::battery::some_seeds(4)
            .map(|seed| of_deck(&coulomb::drawn::case(seed, &coulomb::drawn::SIZES).deck, "")),
    );
    let driven = |seed| {
        let deck = soft::random::driven(seed);
        bits(&mut soft::given(&deck, Modes::Soft), &loads(&deck))
    };
    lines(&mut out, "driven", crate::battery::seeds().map(driven));
    lines(&mut out, "by elements", crate::battery::some_seeds(4).map(by_elements));
    assert!(!out.is_empty());
    #[cfg(feature = "loopback")]
    for (name, sum) in feti_contact::body::answers::recorded() {
        writeln!(out, "answers {name:?}: {sum:016x}").unwrap();
    }
    println!("{out}");
}
