//! The figures of docs/certificate.md: what the certificate says of right answers and of lies, printed, nothing judged.
//! `LIARS=10000 cargo test --release --test liars -- --ignored --nocapture`

use std::collections::BTreeMap;
use std::fmt::Write;

use decks::varied;
use decks::yardstick::{Answer, Yardstick};
use feti_contact::certificate::Certificate;

use crate::{hand_over, lies, number, right, CONDITION, PROBLEMS};

/// `worst` of many answers.
#[derive(Default)]
struct Spread(Vec<f64>);

impl Spread {
    fn add(&mut self, worst: f64) {
        self.0.push(if worst.is_nan() { f64::INFINITY } else { worst });
    }

    /// Their number, the smallest, the hundredth part, the median and the largest.
    fn line(&mut self) -> String {
        self.0.sort_by(f64::total_cmp);
        let at = |part: f64| self.0[((self.0.len() - 1) as f64 * part) as usize];
        let (least, low, median, most) = (at(0.0), at(0.01), at(0.5), at(1.0));
        format!("{:7} answers, least {least:.1e}, 1% {low:.1e}, median {median:.1e}, most {most:.1e}", self.0.len())
    }
}

const ENTRIES: [&str; 7] =
    ["equilibrium", "balance", "penetration", "equality", "negative force", "complementarity", "duality gap"];

#[test]
#[ignore = "prints figures, judges nothing"]
fn worst_of_right_answers_and_of_lies() {
    let (first, count) = (number("LIARS_SEED", 0), number("LIARS", PROBLEMS));
    let mut found: BTreeMap<String, Spread> = BTreeMap::new();
    let mut judged = 0;
    for (seed, case) in (first..first + count).map(|seed| (seed, varied::case(seed))) {
        if case.condition > CONDITION {
            continue;
        }
        judged += 1;
        let mut problem = hand_over::problem(&case.deck).unwrap();
        let mut check = |answer: &Answer| problem.check(&answer.u, &answer.lambda, &answer.mu).unwrap();
        let truth = right(&case);
        let round = |v: &[f64]| v.iter().map(|v| varied::rounded(*v)).collect();
        let rounded = Answer { u: round(&truth.u), lambda: round(&truth.lambda), mu: round(&truth.mu) };
        for (name, answer) in [("right", &truth), ("right to 15 digits", &rounded)] {
            let certificate: Certificate = check(answer);
            found.entry(format!("{name}, all entries")).or_default().add(certificate.worst());
            for (entry, of) in certificate.entries().iter().zip(ENTRIES) {
                found.entry(format!("{name}, {of}")).or_default().add(entry.ratio);
            }
        }
        let yardstick = Yardstick::new(&case.deck, &truth, case.undetermined > 0);
        for lies::Lie { name, answer, .. } in lies::all(seed, &case, &yardstick) {
            let counts = yardstick.worst(&answer).0 > 1.0;
            let verdict = check(&answer).worst();
            let of = if counts { "counts" } else { "within the yardstick" };
            found.entry(format!("{name}, {of}")).or_default().add(verdict);
            if counts {
                found.entry(format!("{name}, {:?}", case.classes[0])).or_default().add(verdict);
            }
        }
    }
    let mut text = format!("{judged} of {count} problems have a condition up to {CONDITION:.0e}\n");
    found.iter_mut().for_each(|(name, spread)| writeln!(text, "{name:48} {}", spread.line()).unwrap());
    println!("{text}");
}
