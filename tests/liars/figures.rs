//! The figures of docs/certificate.md: what the certificate says of right answers and of lies, printed, nothing judged.
//! `LIARS=10000 cargo test --release --test batteries liars -- --ignored --nocapture`

use std::collections::BTreeMap;
use std::fmt::Write;

use decks::varied;
use decks::yardstick::{reaction, Answer, Yardstick};
use feti_contact::certificate::Certificate;
use feti_contact::solver::RowKind;

use crate::liars::{lies, problems, right, CONDITION};
use crate::support::hand_over;

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
        let high = at(0.99);
        let n = self.0.len();
        format!("{n:7} least {least:.1e}, 1% {low:.1e}, median {median:.1e}, 99% {high:.1e}, most {most:.1e}")
    }
}

const ENTRIES: [&str; 10] = [
    "equilibrium",
    "balance",
    "penetration",
    "equality",
    "negative force",
    "complementarity",
    "friction cone",
    "friction work",
    "friction stick",
    "duality gap",
];

#[test]
#[ignore = "prints figures, judges nothing"]
fn worst_of_right_answers_and_of_lies() {
    let (first, count) = problems();
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

/// Solved to 1e-3 only: what force_error says of the forces of a body against what their error is, and this error against
/// the tolerance.
#[test]
#[ignore = "prints figures, judges nothing"]
fn errors_of_forces_that_pass() {
    const LOOSE: f64 = 1e-4;
    let (first, count) = problems();
    let mut found: BTreeMap<String, Spread> = BTreeMap::new();
    for case in (first..first + count).map(varied::case).filter(|case| case.condition <= CONDITION) {
        let mut problem = hand_over::problem(&case.deck).unwrap();
        problem.set_text(&format!("tolerance=1e-3 certificate_tolerance={LOOSE:e} direct_limit=0")).unwrap();
        if problem.solve().map_or(true, |report| !report.certificate.passed()) {
            continue;
        }
        let (truth, multipliers) = (right(&case), |kind| problem.multipliers(kind).unwrap().to_vec());
        let (lambda, mu) = (multipliers(RowKind::Inequality), multipliers(RowKind::Equality));
        let answer = Answer { u: problem.displacements().unwrap().to_vec(), lambda, mu };
        let yardstick = Yardstick::new(&case.deck, &truth, case.undetermined > 0);
        let error: Vec<f64> = reaction(&case.deck, &answer)
            .iter()
            .zip(reaction(&case.deck, &truth))
            .map(|(a, b)| a - b)
            .collect();
        let decade = format!("condition to 1e{:.0}", 2.0 * (case.condition.log10() / 2.0).ceil());
        for p in 0..case.deck.bodies.len() {
            let size = yardstick.sizes[p].forces;
            let error = yardstick.norm(p, &error, -1) / size;
            let told = problem.body_facts(p).unwrap().force_error.unwrap();
            if size == 0.0 || error < 1e-9 || told < 1e-9 {
                continue;
            }
            found.entry(format!("{decade}: error over tolerance")).or_default().add(error / LOOSE);
            found.entry(format!("{decade}: error over force_error")).or_default().add(error / told);
        }
    }
    found.iter_mut().for_each(|(name, spread)| println!("{name:48} {}", spread.line()));
}
