//! Applications of the dual operator F that contact costs, against a linear solve on the contact set it ends
//! with. One line a deck,
//!
//! ```text
//! count <deck> F <applications> linear <applications> ratio <r> goal <g> ok|short
//! ```
//!
//! then how F grows with the size and with the accuracy, the coarse solves per product, and a closing line with the number short. Arguments:
//! parts of the names of the decks to run, none for all; `sequence` asks for sequences of problems of Tresca besides. Exit code 1 when a
//! deck is not solved; a short one alone leaves it 0.

#[path = "../../tests/support/hand_over.rs"]
mod hand_over;
mod linear;
mod load_steps;
mod measure;
mod rubbing;
mod sequence;
mod solved;
mod table;
mod verdict;

use std::io::Write;
use std::process::ExitCode;

use measure::{measure, Measurement, TOLERANCE};
use table::{Case, Comparison};

/// What the lines so far came to.
#[derive(Default)]
struct Tally {
    lines: usize,
    short: usize,
    failed: usize,
    /// Of the decks with a coarse problem.
    products: usize,
    coarse_solves: usize,
}

/// Coarse solves per product with F, on the average of the decks that have a coarse problem.
const COARSE_SOLVES: f64 = 3.0;

/// The argument that asks for sequences of problems of Tresca, on the decks with friction that other arguments name, or on all of them.
const SEQUENCE: &str = "sequence";

/// Products of nine steps with friction, warm, against linear problems that start cold.
const LOOP: f64 = 1.0;

fn main() -> ExitCode {
    let wanted: Vec<String> =
        std::env::args().skip(1).filter(|argument| !argument.starts_with('-')).collect();
    let wants = |name: &str| wanted.is_empty() || wanted.iter().any(|part| name.contains(part));
    let mut tally = Tally::default();
    let mut measured = Vec::new();
    for case in table::cases().into_iter().filter(|case| wants(&case.name)) {
        if let Some(measurement) = tally.case(&case) {
            measured.push((case.name, measurement));
        }
    }
    for comparison in table::growths() {
        tally.growth(&comparison, &measured);
    }
    if wants("load_step") {
        tally.load_steps();
    }
    if wants(table::TIGHTER) {
        tally.tighter();
    }
    if wanted.is_empty() {
        tally.coarse_solves();
    }
    rubbing::groups().into_iter().for_each(|group| tally.friction(&group, &wants));
    for (name, build) in rubbing::loops().into_iter().filter(|(name, _)| wants(name)) {
        tally.friction_loop(name, &*build);
    }
    if wanted.iter().any(|part| part == SEQUENCE) {
        let all = rubbing::groups().into_iter().flat_map(|group| group.cases);
        let of_all = wanted.iter().all(|part| part == SEQUENCE);
        tally.sequences(all.filter(|case| of_all || wants(&case.name)));
    }
    let Tally { lines, short, failed, .. } = tally;
    println!("counts: {lines} lines, {short} short, {failed} failed");
    if tally.failed > 0 {
        ExitCode::FAILURE
    } else {
        ExitCode::SUCCESS
    }
}

impl Tally {
    /// Line and details of one deck.
    fn case(&mut self, case: &Case) -> Option<Measurement> {
        self.lines += 1;
        match measure(case, TOLERANCE) {
            Ok(measurement) => {
                self.judge(case, &measurement);
                Some(measurement)
            }
            Err(fault) => {
                self.fail(&case.name, &fault);
                None
            }
        }
    }

    fn judge(&mut self, case: &Case, measurement: &Measurement) {
        let reasons = verdict::reasons(case, measurement);
        self.short += usize::from(!reasons.is_empty());
        if measurement.coarse_solves > 0 {
            self.products += measurement.products;
            self.coarse_solves += measurement.coarse_solves;
        }
        println!("{}", verdict::line(case, measurement, &reasons));
        flush();
    }

    /// Later load steps, started warm.
    fn load_steps(&mut self) {
        let first = table::FIRST_STEP;
        match load_steps::measure(&table::stepped(first), first, TOLERANCE) {
            Ok(steps) => {
                self.lines += steps.len();
                (first..).zip(&steps).for_each(|(step, m)| self.judge(&table::stepped(step), m));
            }
            Err(fault) => {
                self.lines += 1;
                self.fail("load_steps", &fault);
            }
        }
    }

    /// How F grows from one deck to a larger one; nothing where one of them has not been measured.
    fn growth(&mut self, comparison: &Comparison, measured: &[(String, Measurement)]) {
        let products = |name: &str| measured.iter().find(|(n, _)| n == name).map(|(_, m)| m.products);
        if let (Some(from), Some(to)) = (products(&comparison.from), products(&comparison.to)) {
            let what = format!("growth {} to {}", comparison.from, comparison.to);
            self.compare(&what, from, to, comparison.goal);
        }
    }

    /// What three more digits cost.
    fn tighter(&mut self) {
        let case = table::tighter();
        let at = |tolerance: f64| measure(&case, tolerance).map(|measurement| measurement.products);
        match at(TOLERANCE).and_then(|coarse| Ok((coarse, at(1e-3 * TOLERANCE)?))) {
            Ok((coarse, fine)) => self.compare(table::TIGHTER, coarse, fine, 1.4),
            Err(fault) => {
                self.lines += 1;
                self.fail(table::TIGHTER, &fault);
            }
        }
    }

    fn coarse_solves(&mut self) {
        self.lines += 1;
        let ratio = self.coarse_solves as f64 / self.products as f64;
        let word = if ratio > COARSE_SOLVES { "short" } else { "ok" };
        self.short += usize::from(ratio > COARSE_SOLVES);
        println!("coarse solves per product {ratio:.2} goal {COARSE_SOLVES:.2} {word}");
    }

    fn compare(&mut self, what: &str, from: usize, to: usize, goal: f64) {
        self.lines += 1;
        let ratio = to as f64 / from as f64;
        let short = ratio > goal;
        self.short += usize::from(short);
        let word = if short { "short" } else { "ok" };
        println!("{what} F {from} to {to} ratio {ratio:.2} goal {goal:.2} {word}");
        flush();
    }

    /// A line for each deck with friction, and one for all of the group that were asked for.
    fn friction(&mut self, group: &rubbing::Group, wants: &dyn Fn(&str) -> bool) {
        let mut measured = Vec::new();
        for case in group.cases.iter().filter(|case| wants(&case.name) || wants(group.name)) {
            self.lines += 1;
            match case.measure() {
                Ok(measurement) => {
                    self.short += usize::from(measurement.ratio() > group.worst);
                    println!("{}", measurement.lines(&case.name, group.worst));
                    flush();
                    measured.push(measurement);
                }
                Err(fault) => self.fail(&case.name, &fault),
            }
        }
        let mut ratios: Vec<f64> = measured.iter().map(rubbing::Measurement::ratio).collect();
        ratios.sort_by(f64::total_cmp);
        let Some(worst) = ratios.last() else { return };
        let median = ratios[ratios.len() / 2];
        self.lines += 1;
        self.short += usize::from(median > group.median);
        let word = if median > group.median { "short" } else { "ok" };
        println!(
            "friction {} decks {} F {} linear {} worst {worst:.2} median {median:.2} goal {:.2} {word}",
            group.name,
            measured.len(),
            measured.iter().map(|m| m.products).sum::<usize>(),
            measured.iter().map(|m| m.linear).sum::<usize>(),
            group.median,
        );
        flush();
    }

    /// Nine pushes, warm, against linear problems that start cold.
    fn friction_loop(&mut self, name: &str, build: &dyn Fn(f64) -> decks::Deck) {
        match rubbing::measure_loop(build) {
            Ok((products, linear)) => {
                self.lines += 1;
                let ratio = products as f64 / linear as f64;
                let word = if ratio > LOOP { "short" } else { "ok" };
                self.short += usize::from(ratio > LOOP);
                println!(
                    "loop {name} F {products} linear cold {linear} ratio {ratio:.2} goal {LOOP:.2} {word}"
                );
                flush();
            }
            Err(fault) => {
                self.lines += 1;
                self.fail(name, &fault);
            }
        }
    }

    /// Products of sequences of problems of Tresca against those of the method for Coulomb's law: told, without a goal.
    fn sequences(&mut self, cases: impl Iterator<Item = rubbing::Case>) {
        let mut ratios = [Vec::new(), Vec::new()];
        for case in cases {
            self.lines += 1;
            match case.against_sequences() {
                Ok((products, sequences)) => {
                    print!("sequence {} F {products}", case.name);
                    for (k, word) in ["exact", "inexact"].into_iter().enumerate() {
                        match &sequences[k] {
                            Ok(of) => {
                                let ratio = of.products as f64 / products as f64;
                                print!(
                                    " {word} {} of {} problems ratio {ratio:.2}",
                                    of.products, of.problems
                                );
                                ratios[k].push(ratio);
                            }
                            Err(fault) => print!(" {word} none ({fault})"),
                        }
                    }
                    println!();
                    flush();
                }
                Err(fault) => self.fail(&case.name, &fault),
            }
        }
        for (mut ratios, word) in ratios.into_iter().zip(["exact", "inexact"]) {
            ratios.sort_by(f64::total_cmp);
            if let (Some(least), Some(most)) = (ratios.first(), ratios.last()) {
                let (count, median) = (ratios.len(), ratios[ratios.len() / 2]);
                println!("sequences {word} {count} decks ratio {least:.2} to {most:.2} median {median:.2}");
            }
        }
    }

    fn fail(&mut self, name: &str, fault: &str) {
        self.failed += 1;
        println!("count {name} failed: {fault}");
        flush();
    }
}

/// Lines appear as they are found, also in a pipe.
fn flush() {
    let _ = std::io::stdout().flush();
}
