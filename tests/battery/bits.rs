//! One number for all bits of many answers: what changes no answer changes none of these lines.

use std::fmt::Write;
use std::hash::{DefaultHasher, Hash, Hasher};

use decks::hard;
use decks::varied;
use decks::{battery, Blocks, Cube, Deck, Membrane, Stack};
use feti_contact::error::Result;
use feti_contact::solver::{Problem, Report, RowKind};

use crate::support::hand_over;

/// u, lambda, mu and gaps bit by bit, and what the report says but for its times and bytes.
fn bits(problem: &mut Problem, deck: &Deck) -> u64 {
    let ended = problem.solve();
    let mut hasher = DefaultHasher::new();
    told(&ended).hash(&mut hasher);
    if ended.is_ok() {
        let mut all: Vec<f64> = Vec::new();
        (0..deck.bodies.len()).for_each(|p| all.extend(problem.displacement(p).unwrap()));
        all.extend(problem.multipliers(RowKind::Inequality).unwrap());
        all.extend(problem.multipliers(RowKind::Equality).unwrap());
        all.iter().for_each(|v| v.to_bits().hash(&mut hasher));
    }
    hasher.finish()
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
    let of_deck = |deck: &Deck, options: &str| {
        let mut problem = hand_over::problem(deck).unwrap();
        problem.set_text(options).unwrap();
        bits(&mut problem, deck)
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
                Ok(mut problem) => bits(&mut problem, &case.deck),
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
    assert!(!out.is_empty());
    println!("{out}");
}
