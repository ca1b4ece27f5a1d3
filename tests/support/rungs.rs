//! What each second try saves: every problem is solved with all of them, then again without each that it made.

use std::ops::Range;

use feti_contact::qp::Rung;
use feti_contact::solver::Report;

/// How a problem ended; `report` if it has an answer.
pub struct Ended {
    pub solved: bool,
    pub wrong: bool,
    pub report: Option<Report>,
}

/// What is known of one second try, or of all.
#[derive(Clone, Copy, Default)]
struct Line {
    made: usize,
    unsolved: isize,
    wrong: isize,
    /// Sum of the logarithms of the ratios of products without and with it.
    products: f64,
}

/// Prints what `tools/mutants/rungs.py` adds up, a line for each second try that these problems made: kind, seeds, name, the number
/// of problems that made it, how many more are not solved and how many more are wrong without it, the sum of the logarithms of the
/// ratios of products. The last line counts all problems. `solve` solves the problem of a seed without the second tries of these bits;
/// none if it is not judged.
pub fn print(kind: &str, seeds: Range<u64>, solve: impl Fn(u64, i64) -> Option<Ended> + Sync) {
    let threads = std::thread::available_parallelism().map_or(1, std::num::NonZero::get) as u64;
    let parts: Vec<Vec<Line>> = std::thread::scope(|scope| {
        let part = |first: u64| {
            let (seeds, solve) = (seeds.clone(), &solve);
            scope.spawn(move || {
                let mut lines = vec![Line::default(); Rung::ALL.len() + 1];
                seeds
                    .skip(first as usize)
                    .step_by(threads as usize)
                    .for_each(|seed| add(seed, solve, &mut lines));
                lines
            })
        };
        (0..threads).map(part).collect::<Vec<_>>().into_iter().map(|part| part.join().unwrap()).collect()
    });
    let names = Rung::ALL.iter().map(|(_, name, what)| (*name, *what)).chain([("all", "problems")]);
    for (k, (name, what)) in names.enumerate() {
        let Line { made, unsolved, wrong, products } =
            parts.iter().fold(Line::default(), |sum, part| sum.and(&part[k]));
        if made > 0 || unsolved != 0 {
            let Range { start, end } = seeds;
            println!(
                "rung\t{kind}\t{start}..{end}\t{name}\t{what}\t{made}\t{unsolved}\t{wrong}\t{products:.3}"
            );
        }
    }
}

fn add(seed: u64, solve: impl Fn(u64, i64) -> Option<Ended>, lines: &mut [Line]) {
    let Some(all) = solve(seed, 0) else { return };
    let products = |ended: &Ended| {
        ended.report.as_ref().map_or(0.0, |report| (report.counts.products as f64 + 1.0).ln())
    };
    let whole = lines.last_mut().unwrap();
    *whole = whole.and(&Line {
        made: 1,
        unsolved: isize::from(!all.solved),
        wrong: isize::from(all.wrong),
        products: 0.0,
    });
    for (rung, name, _) in Rung::ALL {
        // an error does not tell what was tried before it
        let made = |report: &Report| report.tries.made().any(|(made, _)| made == *name);
        if !all.report.as_ref().is_none_or(made) {
            continue;
        }
        let Some(without) = solve(seed, 1 << *rung as u32) else { continue };
        let line = &mut lines[*rung as usize];
        *line = line.and(&Line {
            made: usize::from(all.report.is_some()),
            unsolved: isize::from(!without.solved) - isize::from(!all.solved),
            wrong: isize::from(without.wrong) - isize::from(all.wrong),
            products: if without.report.is_some() { products(&without) - products(&all) } else { 0.0 },
        });
    }
}

impl Line {
    fn and(&self, other: &Self) -> Self {
        Self {
            made: self.made + other.made,
            unsolved: self.unsolved + other.unsolved,
            wrong: self.wrong + other.wrong,
            products: self.products + other.products,
        }
    }
}

/// BATTERY_WITHOUT: the second tries that a whole battery leaves out.
pub fn without() -> i64 {
    std::env::var("BATTERY_WITHOUT").ok().and_then(|text| text.parse().ok()).unwrap_or(0)
}
