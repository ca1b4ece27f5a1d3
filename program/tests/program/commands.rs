//! `solve`, `check` and `convert`, and the exit status of each.

use std::fs;
use std::path::Path;

use crate::support::{folder, healthy, said};

fn text(path: &Path) -> &str {
    path.to_str().unwrap()
}

#[test]
fn an_answer_that_is_written_passes_the_check_and_a_changed_one_does_not() {
    let folder = folder("answer");
    let (file, answer) = (folder.join("case.feti"), folder.join("answer"));
    healthy().write(&file);
    let (out, err, status) = said(&["solve", text(&file), "--write", text(&answer), "--threads", "1"]);
    assert!(
        status == 0 && err.is_empty() && out.starts_with("FETI_OK: 2 bodies, 144 unknowns, 7 contact rows"),
        "{out}{err}"
    );
    assert!(out.contains("\n  friction work "), "{out}");
    let (out, _, status) = said(&["check", text(&file), "--answer", text(&answer)]);
    assert!(status == 0 && out.contains("the answer passes"), "{out}");
    let forces = answer.join("lambda.txt");
    let changed = fs::read_to_string(&forces).unwrap().replacen("e-1\n", "e0\n", 1);
    fs::write(forces, changed).unwrap();
    let (out, _, status) = said(&["check", text(&file), "--answer", text(&answer), "--json"]);
    assert!(status == 1 && out.contains("\"passes\":false"), "{out}");
    let (out, _, status) = said(&["check", text(&file)]);
    assert!(status == 0 && out.contains("there is no answer to check"), "{out}");
    fs::remove_dir_all(folder).unwrap();
}

#[test]
fn a_folder_becomes_the_file_that_it_was_made_from_bit_by_bit() {
    let folder = folder("convert");
    let (file, texts, back) = (folder.join("case.feti"), folder.join("texts"), folder.join("back.feti"));
    let mut scene = healthy();
    scene.bodies[1].motions = None;
    scene.contact[0].rhs = f64::INFINITY;
    let mut problem = scene.problem().unwrap();
    problem.set_compliance(feti_contact::solver::RowKind::Inequality, 0, &[0.0, 1e-3]).unwrap();
    problem.set_text("tolerance=1e-9 threads=2").unwrap();
    problem.write_file(&file).unwrap();
    for (from, to) in [(&file, &texts), (&texts, &back)] {
        let (out, err, status) = said(&["convert", text(from), text(to)]);
        assert_eq!((out.as_str(), err.as_str(), status), ("", "", 0));
    }
    assert!(fs::read(&file).unwrap() == fs::read(&back).unwrap());
    fs::remove_dir_all(folder).unwrap();
}

#[test]
fn the_exit_status_is_the_class_of_the_librarys_status() {
    let folder = folder("status");
    let [file, loose, half] = ["case.feti", "loose.feti", "half.feti"].map(|name| folder.join(name));
    let mut scene = healthy();
    scene.write(&file);
    scene.contact.clear();
    scene.friction.clear();
    scene.write(&loose);
    let bytes = fs::read(&file).unwrap();
    fs::write(&half, &bytes[..bytes.len() / 2]).unwrap();
    let file = text(&file);
    for (arguments, expected, says) in [
        (&["solve", file][..], 0, "FETI_OK"),
        (&["solve", file, "--set", "max_steps=1", "--set", "direct_limit=0", "--json"], 1, "\"exit\":1"),
        (&["solve", text(&loose)], 2, "FETI_LOAD_NOT_HELD"),
        (&["solve", text(&half)], 2, "half.feti: "),
        (&["show", text(&half)], 2, "half.feti: "),
        (&["check", text(&folder)], 2, "there is no K1.mtx"),
        (&["convert", "/no/such/file", text(&folder)], 2, "No such file or directory"),
        (
            &["solve", file, "--set", "tolerence=1"],
            2,
            "there is no option \"tolerence\"; there are tolerance",
        ),
        (&["solve", file, "--log-file", "/no/such/log"], 2, "/no/such/log: open: No such file"),
        (&["solve", file, "--lag"], 64, "--lag"),
        (&["solve"], 64, "FILE"),
        (&[], 64, "Usage"),
        (&["--version"], 0, env!("CARGO_PKG_VERSION")),
        (&["show", "--help"], 0, "suspicious"),
    ] {
        let (out, err, status) = said(arguments);
        assert!(status == expected && (out + &err).contains(says), "{arguments:?}: {status}\n{err}");
    }
    fs::remove_dir_all(folder).unwrap();
}

#[test]
fn the_log_goes_to_standard_error_and_to_a_file_with_a_blank_in_its_name() {
    let folder = folder("log");
    let (file, log) = (folder.join("case.feti"), folder.join("the log"));
    healthy().write(&file);
    let (_, err, _) = said(&["solve", text(&file), "--log=result", "--log-file", text(&log)]);
    assert!(err.starts_with("solved: ") && err.lines().count() == 1, "{err}");
    assert_eq!(fs::read_to_string(&log).unwrap(), err);
    fs::remove_dir_all(folder).unwrap();
}

/// Damaged files of every kind: the program says why, and ends by itself.
#[test]
fn no_damaged_file_makes_the_program_panic() {
    let folder = folder("damaged");
    let path = folder.join("case.feti");
    healthy().write(&path);
    let bytes = fs::read(&path).unwrap();
    for k in 0..40 {
        let mut damaged = bytes.clone();
        let at = k * bytes.len() / 40;
        damaged[at] ^= 1 << (k % 8);
        fs::write(&path, damaged).unwrap();
        let (_, err, status) = said(&["show", text(&path)]);
        assert!(
            status == 2 && err.starts_with("feti-contact: ") && !err.contains("panicked"),
            "byte {at}: {status} {err}"
        );
    }
    let texts = folder.join("texts");
    healthy().write(&path);
    said(&["convert", text(&path), text(&texts)]);
    for entry in fs::read_dir(&texts).unwrap() {
        let name = entry.unwrap().path();
        let whole = fs::read_to_string(&name).unwrap();
        for spoilt in [
            whole.replacen('1', "x", 1),
            whole[..whole.len() / 2].to_owned(),
            whole.replace("1 1 ", "0 0 "),
            String::new(),
        ] {
            fs::write(&name, spoilt).unwrap();
            let (_, err, status) = said(&["solve", text(&texts)]);
            assert!(!err.contains("panicked") && status <= 2, "{name:?}: {err}");
        }
        fs::write(&name, whole).unwrap();
    }
    let head = "%%MatrixMarket matrix coordinate real general\n";
    for (name, spoilt, says) in [
        ("K1.mtx", "1000000000000000 1000000000000000 0\n", ""),
        ("K1.mtx", "2 2 3\n1 1 2.0\n1 2 -1.0\n2 2 2.0\n", "symmetr"),
        ("B.mtx", "1000000000000000 144 0\n", "B.mtx: 1000000000000000 rows, but only 0 entries"),
        ("R1.mtx", "4000000000 4000000000 0\n", "R1.mtx: an array is expected"),
        ("options.txt", "log_file=log", "log_file belongs to the command line"),
    ] {
        let old = fs::read(texts.join(name)).ok();
        fs::write(texts.join(name), head.to_owned() + spoilt).unwrap();
        let (_, err, status) = said(&["solve", text(&texts)]);
        assert!(status == 2 && err.contains(says) && !err.contains("panicked"), "{name}: {status} {err}");
        match old {
            Some(old) => fs::write(texts.join(name), old).unwrap(),
            None => fs::remove_file(texts.join(name)).unwrap(),
        }
    }
    fs::remove_dir_all(folder).unwrap();
}
