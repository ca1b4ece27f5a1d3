//! coverage FOLDER GOAL OBJECT ... -- PROFILE ...: lines of the sources under FOLDER that were run, by instrumented
//! binaries and their raw profiles. Tests inside the sources do not count. Prints a line per file with the numbers of the
//! lines that were not run, then `coverage FOLDER <percent> goal GOAL ok|short`.

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};
use std::process::ExitCode;
use std::{env, error, fs};

use llvm_profparser::{merge_profiles, CoverageMapping};

/// Hits of the lines of a file that have code, by number.
type Lines = BTreeMap<usize, usize>;

fn main() -> Result<ExitCode, Box<dyn error::Error>> {
    let arguments: Vec<String> = env::args().skip(1).collect();
    let [folder, goal, rest @ ..] = arguments.as_slice() else {
        return Err("FOLDER GOAL OBJECT ... -- PROFILE ...".into());
    };
    let middle = rest.iter().position(|word| word == "--").ok_or("no -- before the profiles")?;
    let objects: Vec<PathBuf> = rest[..middle].iter().map(PathBuf::from).collect();
    let mut files: BTreeMap<PathBuf, Lines> = BTreeMap::new();
    let profile = merge_profiles(&rest[middle + 1..])?;
    let mapping = CoverageMapping::new(&objects, &profile, true)?;
    let report = mapping.generate_subreport(|paths| paths.iter().any(|path| is_below(path, folder)))?;
    for (path, result) in report.files.iter().filter(|(path, _)| is_below(path, folder)) {
        let source = fs::read_to_string(path)?;
        let regions =
            result.hits.iter().map(|(at, hits)| (at.line_start, at.line_end, *hits)).collect::<Vec<_>>();
        files.insert(path.clone(), lines(&regions, without_tests(&source)));
    }
    let (mut run, mut all) = (0, 0);
    for (path, lines) in files.iter().filter(|(_, lines)| !lines.is_empty()) {
        let missed: Vec<String> =
            lines.iter().filter(|(_, hits)| **hits == 0).map(|(line, _)| line.to_string()).collect();
        println!(
            "{:>5} of {:>5} lines  {}  not run: {}",
            lines.len() - missed.len(),
            lines.len(),
            path.display(),
            missed.join(" ")
        );
        run += lines.len() - missed.len();
        all += lines.len();
    }
    let percent = 100.0 * run as f64 / all.max(1) as f64;
    let enough = percent >= goal.parse()?;
    println!("coverage {folder} {percent:.1} goal {goal} {}", if enough { "ok" } else { "short" });
    Ok(if enough { ExitCode::SUCCESS } else { ExitCode::FAILURE })
}

/// A source of the folder that is no file of tests.
fn is_below(path: &Path, folder: &str) -> bool {
    let text = path.to_string_lossy();
    let tests = text.ends_with("tests.rs") || text.contains("/tests/");
    text.contains(&format!("{folder}/")) && !tests
}

/// Lines before the tests at the end of a source.
fn without_tests(source: &str) -> usize {
    source.lines().take_while(|line| *line != "#[cfg(test)]").count()
}

/// Hits of every line that a region covers: of the regions that start on it, the most; else those of the innermost one.
fn lines(regions: &[(usize, usize, usize)], last: usize) -> Lines {
    let hits = |line: usize| {
        let starting = regions.iter().filter(|(start, ..)| *start == line).map(|(.., hits)| *hits).max();
        let around = regions.iter().filter(|(start, end, _)| (*start..=*end).contains(&line));
        starting.or_else(|| {
            around.max_by_key(|(start, end, _)| (*start, usize::MAX - *end)).map(|(.., hits)| *hits)
        })
    };
    (1..=last).filter_map(|line| Some((line, hits(line)?))).collect()
}
