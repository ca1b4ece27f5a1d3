//! What `show` says of hard problems that are sound: of each the answer is known, and it passes. A measurement, run by
//! `ALARMS=1000 ALARMS_SEED=1 cargo test --profile quick -p feti-contact-program alarms -- --ignored --nocapture`.

use std::collections::BTreeMap;

use decks::hard::{self, Given, Kind};
use decks::Deck;
use feti_contact::error::Result;
use feti_contact::solver::{Outcome, Problem};

use crate::hand_over;
use crate::support::{folder, said};

/// Kinds that put in what `show` looks for: rows that nearly say the same, few digits, small integers for K and rows.
const SPOILT: [Kind; 5] = [Kind::Near, Kind::Digits, Kind::Small, Kind::Drawn, Kind::NotHeld];

fn problem(deck: &Deck, given: Given) -> Result<Problem> {
    if given == Given::NullSpaces {
        return hand_over::problem(deck);
    }
    let mut problem = hand_over::without_null_spaces(deck)?;
    for (p, body) in deck.bodies.iter().enumerate().filter(|_| given == Given::Coordinates) {
        problem.set_coordinates(p, 3, &body.node, &body.direction, &body.coordinates.concat(), 3)?;
    }
    Ok(problem)
}

#[test]
#[ignore = "a measurement: prints the alarms of hard problems"]
fn alarms_of_sound_problems() {
    let folder = folder("alarms");
    let number = |name: &str| std::env::var(name).ok().and_then(|number| number.parse().ok());
    let (first, problems) = (number("ALARMS_SEED").unwrap_or(1), number("ALARMS").unwrap_or(100));
    let (mut asked, mut alarmed, mut of) = (0, 0, BTreeMap::<String, usize>::new());
    for seed in first.. {
        let case = hard::case(seed);
        let is_spoilt = case.digits < 16 || case.kinds.iter().any(|kind| SPOILT.contains(kind));
        if is_spoilt || case.answer.is_none() || case.resultant > 0.0 {
            continue;
        }
        let Ok(mut problem) = problem(&case.deck, case.given) else { continue };
        let path = folder.join("case.feti");
        problem.write_file(&path).unwrap();
        if !problem.solve().is_ok_and(|report| report.outcome == Outcome::Solved) {
            continue;
        }
        let (out, _, status) = said(&["show", path.to_str().unwrap(), "--threads", "1"]);
        asked += 1;
        if status != 0 {
            alarmed += 1;
            println!("{} {:?} {}", case.deck.name, case.given, case.detail);
            let told = out.split_once("\nsuspicious").map_or("", |of| of.1).lines().skip(1).step_by(2);
            told.for_each(|line| {
                println!("   {line}");
                let what = line.split_once(": ").map_or(line, |of| of.1);
                *of.entry(what.chars().filter(|c| !c.is_ascii_digit()).take(40).collect()).or_default() += 1;
            });
        }
        if asked == problems {
            break;
        }
    }
    println!("{alarmed} of {asked}: {of:#?}");
    std::fs::remove_dir_all(folder).unwrap();
}
