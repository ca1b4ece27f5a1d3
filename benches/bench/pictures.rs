//! The pictures of the scaling: time and memory of a sweep, logarithms on both axes.

use std::path::Path;

use crate::plot::{marked, Mark, Plot, Series, BLUE, GREEN, GREY, RED};
use crate::programs::Program;
use crate::runs::Runs;
use crate::sweeps::{Sweep, MEGABYTE, OURS, THREADS, UNIT};

type Points = Vec<(f64, f64)>;

/// Writes the pictures of a sweep of at least two points; gives their paths.
pub fn write(sweep: &Sweep, runs: &Runs, folder: &Path) -> Result<Vec<String>, String> {
    let text = |path: &Path, error: std::io::Error| format!("{}: {error}", path.display());
    std::fs::create_dir_all(folder).map_err(|error| text(folder, error))?;
    let (time, memory) = if sweep.name == THREADS { of_threads(sweep, runs) } else { of_decks(sweep, runs) };
    let mut paths = Vec::new();
    for (kind, ordinate, series) in [("time", time.0, time.1), ("memory", memory.0, memory.1)] {
        if series.iter().flat_map(|series| &series.lines).all(|line| line.len() < 2) {
            continue;
        }
        let plot = Plot {
            title: format!("Scaling with {}: {kind}", sweep.name),
            x: sweep.label.into(),
            y: ordinate.into(),
            logarithmic: [true; 2],
            equal: false,
            series,
        };
        let path = folder.join(format!("scaling_{}_{kind}.svg", sweep.name));
        std::fs::write(&path, plot.svg()).map_err(|error| text(&path, error))?;
        paths.push(path.display().to_string());
    }
    Ok(paths)
}

/// What the ordinate is, and the curves.
type Drawn = (&'static str, Vec<Series>);

/// Time and memory of ours and of the unit, deck by deck.
fn of_decks(sweep: &Sweep, runs: &Runs) -> (Drawn, Drawn) {
    let points = |program: Program, quantity: &str, unit: f64| -> Points {
        let point = |name: &&str| {
            let abscissa = runs.median(name, OURS, sweep.name)?;
            Some((abscissa, runs.median(name, program, quantity)? / unit))
        };
        sweep.decks.iter().filter_map(point).collect()
    };
    let drawn = |ours: Points, unit: Points, slope: (&'static str, f64)| {
        let guide = guide(sweep, &ours, slope);
        let mut series = Vec::from(marked("whole solve", BLUE, ours));
        series.extend(marked("CHOLMOD: analysis and factorisation", RED, unit));
        series.extend(guide);
        series
    };
    // nested dissection of a block: N^2 operations, N^(4/3) entries of L
    let time = drawn(points(OURS, "first_cpu", 1.0), points(UNIT, "cpu", 1.0), ("N^2", 2.0));
    let of_peak = |program| points(program, "peak", MEGABYTE);
    let memory = drawn(of_peak(OURS), of_peak(UNIT), ("N^(4/3)", 4.0 / 3.0));
    (("processor time on 1 thread / s", time), ("peak memory / MB", memory))
}

/// A power of the number of unknowns N, through the last point.
fn guide(sweep: &Sweep, points: &Points, (name, power): (&'static str, f64)) -> Option<Series> {
    let (&first, &last) = points.first().zip(points.last()).filter(|_| sweep.name == "dofs")?;
    let line = vec![(first.0, last.1 * (first.0 / last.0).powf(power)), last];
    Some(Series { name, colour: GREY, mark: Mark::Line(0.8), lines: vec![line] })
}

/// Wall time, over that of one thread, and memory of every deck of the sweep.
fn of_threads(sweep: &Sweep, runs: &Runs) -> (Drawn, Drawn) {
    let drawn = |value: &dyn Fn(&str, Program) -> Option<f64>| {
        let mut series = Vec::new();
        for (&deck, colour) in sweep.decks.iter().zip([BLUE, RED, GREEN]) {
            let point = |program| match program {
                Program::Ours(threads) => Some((threads as f64, value(deck, program)?)),
                _ => None,
            };
            let points: Points = sweep.programs().into_iter().filter_map(point).collect();
            series.extend(marked(deck, colour, points));
        }
        series
    };
    let wall = |deck: &str, program| runs.median(deck, program, "first_wall");
    let mut time = drawn(&|deck, program| Some(wall(deck, program)? / wall(deck, OURS)?));
    let peak = drawn(&|deck, program| Some(runs.median(deck, program, "peak")? / MEGABYTE));
    let longest = time.iter().flat_map(|series| series.lines.iter().flatten()).map(|point| point.0);
    let most = longest.fold(1.0, f64::max);
    let ideal = vec![(1.0, 1.0), (most, 1.0 / most)];
    time.push(Series { name: "1 / threads", colour: GREY, mark: Mark::Line(0.8), lines: vec![ideal] });
    (("wall time / that of 1 thread", time), ("peak memory / MB", peak))
}
