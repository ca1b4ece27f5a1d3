//! The log in a file (options log_file and log_level).

use std::fs;
use std::path::PathBuf;

use crate::error::Kind;
use crate::solver::tests::file::{of_section, of_sections};
use crate::solver::tests::log::{listen, spring, told};
use crate::solver::{LogLevel, Problem};

/// A path of this test alone, and its text.
fn place(test: &str) -> PathBuf {
    let path = std::env::temp_dir().join(format!("feti log, {test} {}", std::process::id()));
    let _ = fs::remove_file(&path);
    path
}

fn lines(path: &PathBuf) -> Vec<String> {
    let text = fs::read_to_string(path).unwrap();
    assert!(text.is_empty() || text.ends_with('\n'));
    text.lines().map(str::to_owned).collect()
}

fn set(problem: &mut Problem, path: &str) {
    problem.set_str("log_file", path).unwrap();
}

#[test]
fn the_file_has_the_lines_that_the_function_gets_at_its_level_also_without_a_function() {
    let path = place("lines");
    let mut problem = spring(true);
    problem.set_load(1, &[1.0]).unwrap();
    let book = listen(&mut problem, LogLevel::Step, 0, 0);
    set(&mut problem, path.to_str().unwrap());
    for (word, most) in [("phase", LogLevel::Phase), ("result", LogLevel::Result), ("step", LogLevel::Step)] {
        fs::write(&path, "").unwrap();
        problem.set_text(&format!("log_level={word}")).unwrap();
        problem.solve().unwrap_err();
        problem.set_load(1, &[0.0]).unwrap();
        problem.solve().unwrap();
        problem.set_load(1, &[1.0]).unwrap();
        let heard = told(&book).into_iter().filter(|line| line.0 <= most).map(|line| line.1);
        assert_eq!(lines(&path), heard.collect::<Vec<_>>());
    }
    let before = lines(&path).len();
    problem.on_log(None);
    problem.solve().unwrap_err();
    assert!(lines(&path).len() > before && lines(&path).last().unwrap().starts_with("solve failed: body 1"));
    let all = lines(&path);
    set(&mut problem, "");
    problem.solve().unwrap_err();
    assert_eq!((lines(&path), problem.get_str("log_file").unwrap()), (all, String::new()));
    fs::remove_file(&path).unwrap();
}

#[test]
fn two_problems_write_whole_lines_to_one_file_at_the_same_time() {
    let path = place("two");
    let solve = || {
        let mut problem = spring(false);
        set(&mut problem, path.to_str().unwrap());
        problem.set_text("log_level=result").unwrap();
        (0..20).for_each(|_| drop(problem.solve().unwrap()));
    };
    std::thread::scope(|scope| (0..2).for_each(|_| drop(scope.spawn(solve))));
    let lines = lines(&path);
    assert_eq!(lines.len(), 40);
    assert!(lines.iter().all(|line| line.starts_with("solved: ") && line.ends_with(" seconds")), "{lines:?}");
    fs::remove_file(&path).unwrap();
}

#[test]
fn a_path_that_cannot_be_opened_is_refused_with_its_reason_and_changes_no_option() {
    let mut problem = spring(false);
    let path = place("kept");
    set(&mut problem, path.to_str().unwrap());
    for (path, why) in [
        ("/no folder/log", "option \"log_file\": /no folder/log: open: No such file or directory"),
        ("/tmp", "/tmp: open: this is not a regular file"),
        ("/dev/null", "/dev/null: open: this is not a regular file"),
    ] {
        let error = problem.set_str("log_file", path).unwrap_err();
        assert!(error.kind == Kind::Argument("value") && error.what.contains(why), "{error}");
    }
    let error = problem.set_text("threads=3 log_file=/tmp log_level=step").unwrap_err();
    assert_eq!(error.kind, Kind::Argument("text"));
    assert_eq!(problem.get_i64("threads").unwrap(), 0);
    assert_eq!(problem.get_str("log_level").unwrap(), "phase");
    assert_eq!(problem.get_str("log_file").unwrap(), path.to_str().unwrap());
    problem.solve().unwrap();
    assert!(!lines(&path).is_empty(), "the old file stays");
    fs::remove_file(&path).unwrap();
}

#[test]
fn a_problem_file_neither_has_the_log_file_nor_opens_one() {
    let (mine, other) = (place("mine"), place("other"));
    let mut problem = spring(false);
    let plain = problem.write_bytes().unwrap();
    set(&mut problem, mine.to_str().unwrap());
    problem.set_text("log_level=step").unwrap();
    assert!(problem.write_bytes().unwrap() == plain, "bytes differ");
    // a file that somebody else has written
    let name = other.to_str().unwrap().replace([' ', ','], "_");
    let options = format!("gamma=2 log_file={name}");
    let mut back = Problem::new();
    set(&mut back, mine.to_str().unwrap());
    back.read_bytes(&of_sections(1, &[of_section(b"OPTS", 0, options.as_bytes())])).unwrap();
    assert_eq!(back.get_f64("gamma").unwrap(), 2.0);
    assert_eq!(back.get_str("log_file").unwrap(), mine.to_str().unwrap());
    let mut back = Problem::new();
    set(&mut back, mine.to_str().unwrap());
    back.read_bytes(&plain).unwrap();
    back.solve().unwrap();
    assert!(!lines(&mine).is_empty() && !PathBuf::from(name).exists());
    fs::remove_file(&mine).unwrap();
}
