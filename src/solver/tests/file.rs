//! Round trips, truncated, changed and hostile files.

mod friction;
mod given;
mod pieces;

use crate::error::{Error, Kind};
use crate::model::file::format::{padding, Crc, FORMAT, HEADER, LOAD, MAGIC};
use crate::model::file::write::{length, lengths};
use crate::solver::{Modes, Outcome, Problem, RowKind, RowsInput, SparseInput, Storage};
use std::fs;
use std::path::PathBuf;

/// A spring and a block of two dofs with all kinds of input, including -0 and subnormal numbers.
fn small() -> Problem {
    let mut problem = Problem::new();
    problem.set_text("tolerance=1e-11 threads=2 preconditioner=lumped index_base=1").unwrap();
    problem.add_body(1).unwrap();
    problem.add_body(2).unwrap();
    let spring = SparseInput { ptr: &[0, 1], col: &[0], val: &[2.0], storage: Storage::Lower };
    problem.set_stiffness(0, spring).unwrap();
    problem.set_null_space(0, 1, 0, &[], 1, Modes::Exact).unwrap();
    let block =
        SparseInput { ptr: &[0, 1, 3], col: &[0, 0, 1], val: &[4.0, -4.0, 4.0], storage: Storage::Lower };
    problem.set_stiffness(1, block).unwrap();
    problem.set_null_space(1, 2, 1, &[1.0 / 3.0, 1.0 / 3.0], 2, Modes::Candidates).unwrap();
    problem.set_coordinates(1, 2, &[1, 2], &[1, 1], &[0.1, -0.0, 5e-324, 0.0], 2).unwrap();
    problem.set_fixing(1, Some(&[1])).unwrap();
    problem.set_load(1, &[-0.0, -6.0]).unwrap();
    let rows = |val, rhs| RowsInput { ptr: &[0, 2], body: None, dof: &[0, 1], val, rhs: Some(rhs) };
    problem.add_rows(RowKind::Inequality, rows(&[1.0, -1.0], &[1.0])).unwrap();
    problem.add_rows(RowKind::Equality, rows(&[0.0, 0.0], &[0.0])).unwrap();
    problem.set_compliance(RowKind::Inequality, 0, &[0.125]).unwrap();
    problem
}

fn read(bytes: &[u8]) -> Result<Problem, Error> {
    let mut problem = Problem::new();
    problem.read_bytes(bytes).map(|()| problem)
}

/// A failed reading leaves an empty problem.
fn refused(bytes: &[u8]) -> Error {
    let mut problem = Problem::new();
    let error = problem.read_bytes(bytes).unwrap_err();
    assert!(problem.model.bodies.is_empty() && problem.model.settings == Problem::new().model.settings);
    assert!(matches!(error.kind, Kind::Io | Kind::Unsupported), "{error:?}");
    assert!(error.place.byte.is_some_and(|byte| byte <= bytes.len()), "{error:?}");
    error
}

/// Bytes of the file of a problem.
fn expected_length(problem: &Problem) -> u64 {
    length(&problem.model, &lengths(&problem.model))
}

pub fn of_section(tag: &[u8; 4], flags: u32, payload: &[u8]) -> Vec<u8> {
    let length = (payload.len() as u64).to_le_bytes();
    let mut bytes = [&tag[..], &flags.to_le_bytes(), &length, payload].concat();
    bytes.resize(bytes.len() + padding(payload.len() as u64) as usize, 0);
    sealed(bytes)
}

fn sealed(mut bytes: Vec<u8>) -> Vec<u8> {
    let mut crc = Crc::new();
    crc.add(&bytes);
    bytes.extend(crc.value().to_le_bytes());
    bytes
}

/// A file of these sections, written by library 0.9.3.
pub fn of_sections(format: u32, sections: &[Vec<u8>]) -> Vec<u8> {
    let length = HEADER + sections.iter().map(|section| section.len() as u64).sum::<u64>();
    let parts = [&MAGIC[..], &format.to_le_bytes(), &903_u32.to_le_bytes(), &length.to_le_bytes(), &[0; 4]];
    [sealed(parts.concat()), sections.concat()].concat()
}

fn numbers(numbers: &[u64]) -> Vec<u8> {
    numbers.iter().flat_map(|number| number.to_le_bytes()).collect()
}

#[test]
fn all_that_is_registered_comes_back_bit_by_bit() {
    let problem = small();
    let bytes = problem.write_bytes().unwrap();
    assert_eq!(bytes.len() as u64, expected_length(&problem));
    let mut back = Problem::new();
    back.set_text("threads=3 index_base=1 gamma=2").unwrap();
    back.read_bytes(&bytes).unwrap();
    assert_eq!(
        back.model.settings, problem.model.settings,
        "gamma has its default again, texts still count from 1"
    );
    for (new, old) in back.model.bodies.iter().zip(&problem.model.bodies) {
        let (new, old) = (&new.body, &old.body);
        assert_eq!((new.order, &new.stiffness, &new.fixing), (old.order, &old.stiffness, &old.fixing));
        let bits =
            |f: &Option<Box<[f64]>>| f.as_ref().map(|f| f.iter().map(|v| v.to_bits()).collect::<Vec<_>>());
        assert_eq!(bits(&new.load), bits(&old.load));
        let basis = |body: &crate::body::Body| {
            body.null_space.as_ref().map(|r| (r.modes, r.vectors.cols, r.vectors.data.clone()))
        };
        assert_eq!(basis(new), basis(old));
        assert_eq!(new.coordinates.is_some(), old.coordinates.is_some());
        assert!(new.coordinates.iter().zip(&old.coordinates).all(|(new, old)| new.same(old)));
    }
    for kind in [RowKind::Inequality, RowKind::Equality] {
        let (new, old) = (back.model.rows(kind), problem.model.rows(kind));
        assert_eq!((&new.matrix, &new.rhs, &new.compliance), (&old.matrix, &old.rhs, &old.compliance));
    }
    assert_eq!(back.sizes().rows, 1);
    assert_eq!(back.write_bytes().unwrap(), bytes, "written again it is the same file");
}

/// A gap of +infinity means a row that never closes; every other number that is not finite is refused.
#[test]
fn rows_that_never_close_come_back_and_other_gaps_without_end_are_refused() {
    let mut problem = small();
    problem.set_load(1, &[0.0, 0.0]).unwrap();
    problem.set_rhs(RowKind::Inequality, 0, &[f64::INFINITY]).unwrap();
    let bytes = problem.write_bytes().unwrap();
    let mut back = read(&bytes).unwrap();
    assert_eq!(back.model.rows(RowKind::Inequality).rhs, [f64::INFINITY]);
    assert_eq!(back.write_bytes().unwrap(), bytes, "written again it is the same file");
    assert_eq!(back.solve().unwrap().outcome, Outcome::Solved);
    assert_eq!(back.multipliers(RowKind::Inequality).unwrap(), [0.0]);
    back.set_rhs(RowKind::Inequality, 0, &[1.0]).unwrap();
    back.set_load(1, &[0.0, -6.0]).unwrap();
    assert_eq!(back.solve().unwrap().outcome, Outcome::Solved);
    assert!((back.multipliers(RowKind::Inequality).unwrap()[0] - 6.0).abs() < 1e-9);
    let body = of_section(b"BODY", 0, &numbers(&[1]));
    let row = |kind: u64, rhs: f64| {
        let payload = numbers(&[kind, 1, 1, 0, 1, 0, 1.0_f64.to_bits(), rhs.to_bits(), 0]);
        of_sections(FORMAT, &[body.clone(), of_section(b"ROWS", 0, &payload)])
    };
    assert_eq!(read(&row(1, f64::INFINITY)).unwrap().sizes().rows, 1);
    for rhs in [f64::NAN, f64::NEG_INFINITY] {
        assert!(refused(&row(1, rhs)).what.contains("neither a finite number nor +infinity"));
    }
    for rhs in [f64::NAN, f64::INFINITY, f64::NEG_INFINITY] {
        assert!(refused(&row(2, rhs)).what.contains("not a finite number"));
    }
}

#[test]
fn an_empty_and_an_incomplete_problem_come_back() {
    let mut problem = Problem::new();
    assert_eq!(read(&problem.write_bytes().unwrap()).unwrap().sizes(), problem.sizes());
    problem.add_body(7).unwrap();
    problem.set_load(0, &[1.0; 7]).unwrap();
    let mut back = read(&problem.write_bytes().unwrap()).unwrap();
    assert_eq!(back.solve().unwrap_err().kind, Kind::State);
}

#[test]
fn what_was_read_solves_to_the_same_bits() {
    let mut problem = small();
    let mut back = read(&problem.write_bytes().unwrap()).unwrap();
    assert_eq!(problem.solve().unwrap().outcome, Outcome::Solved);
    assert_eq!(back.solve().unwrap().outcome, Outcome::Solved);
    for body in 0..2 {
        assert_eq!(problem.displacement(body).unwrap(), back.displacement(body).unwrap());
    }
    let (old, new) = (problem.history.current.unwrap().answer, back.history.current.unwrap().answer);
    assert_eq!((&old.lambda, &old.mu), (&new.lambda, &new.mu));
    // the load on the block goes through the row
    assert!((new.lambda[0] - 6.0).abs() < 1e-9);
}

#[test]
fn a_file_is_read_into_an_empty_problem_only() {
    let bytes = small().write_bytes().unwrap();
    let mut problem = small();
    assert_eq!(problem.read_bytes(&bytes).unwrap_err().kind, Kind::State);
    assert_eq!(problem.write_bytes().unwrap(), bytes);
}

#[test]
fn a_file_cut_anywhere_or_with_bytes_behind_it_is_refused() {
    let bytes = small().write_bytes().unwrap();
    for length in 0..bytes.len() {
        refused(&bytes[..length]);
    }
    for more in 1..20 {
        refused(&[&bytes[..], &vec![0; more]].concat());
    }
}

#[test]
fn a_file_with_any_one_bit_changed_is_refused() {
    let bytes = small().write_bytes().unwrap();
    for bit in 0..8 * bytes.len() {
        let mut changed = bytes.clone();
        changed[bit / 8] ^= 1 << (bit % 8);
        refused(&changed);
    }
}

#[test]
fn an_unknown_section_is_passed_over_if_it_may_be_and_refused_by_the_version_that_wrote_it_if_not() {
    let body = of_section(b"BODY", 0, &numbers(&[3]));
    for payload in [&b""[..], b"later", &[7; 10_000]] {
        let skipped = of_sections(FORMAT, &[of_section(b"NEWS", 1, payload), body.clone()]);
        assert_eq!(read(&skipped).unwrap().sizes().dofs, 3);
        let mut damaged = skipped.clone();
        damaged[HEADER as usize + 17] ^= 1;
        assert!(refused(&damaged).what.contains("damaged"));
        let error = refused(&of_sections(FORMAT, &[body.clone(), of_section(b"NEWS", 0, payload)]));
        assert_eq!(error.kind, Kind::Unsupported);
        assert!(error.what.contains("section NEWS of a file written by feti-contact 0.9.3"), "{error}");
    }
    let error = refused(&of_sections(FORMAT + 1, &[body]));
    assert_eq!(error.kind, Kind::Unsupported);
    assert!(error.what.contains("format 2.0, written by feti-contact 0.9.3"), "{error}");
}

#[test]
fn lengths_that_the_file_does_not_hold_are_refused_before_anything_is_reserved() {
    let body = |n: u64| of_section(b"BODY", 0, &numbers(&[n]));
    for huge in [3, 1 << 31, 1 << 60, (1 << 60) - 1, 1 << 61, 1 << 63, u64::MAX, u64::MAX / 8, u64::MAX - 15]
    {
        for (tag, payload) in [
            (b"STIF", vec![huge, 0, 0]),
            (b"STIF", vec![2, huge, 0, 0, huge]),
            (b"NULL", vec![huge, 1, 0]),
            (b"NULL", vec![2, huge, 1]),
            (b"COOR", vec![huge, 0]),
            (b"FIXD", vec![huge, 0]),
            (b"LOAD", vec![huge, 0]),
            (b"NUMB", vec![huge, 0]),
            (b"ROWS", vec![1, huge, 0, 0]),
            (b"ROWS", vec![1, 1, huge, 0, huge]),
            (b"ROWS", vec![2, huge, huge, 0, 0]),
            (b"FRIC", vec![1, huge, 0, 0]),
            (b"FRIC", vec![2, huge, huge, 0, 0]),
            (b"FRIC", vec![1, 1, huge, 0, 0, huge]),
            (b"FRIC", vec![huge, 1, 1, 0, 0, 0]),
        ] {
            let error = refused(&of_sections(FORMAT, &[body(2), of_section(tag, 0, &numbers(&payload))]));
            assert_eq!(error.kind, Kind::Io, "{error}");
        }
        let mut section = of_section(&LOAD, 0, &numbers(&[2, 0, 0]));
        section[8..16].copy_from_slice(&(huge + u64::from(huge == 3)).to_le_bytes());
        refused(&of_sections(FORMAT, &[body(2), section]));
    }
    // the total number of unknowns is too large for any array
    let many = vec![body(1 << 59); 3];
    assert!(refused(&of_sections(FORMAT, &many)).what.contains("more unknowns"));
}

#[test]
fn what_the_calls_refuse_is_refused_with_its_section_and_place() {
    let body = of_section(b"BODY", 0, &numbers(&[2]));
    let bits = f64::to_bits;
    let stiffness = |val: [f64; 3], col: [u32; 3]| {
        let mut payload = numbers(&[2, 3, 0, 1, 3]);
        val.iter().for_each(|v| payload.extend(v.to_le_bytes()));
        col.iter().for_each(|c| payload.extend(c.to_le_bytes()));
        of_section(b"STIF", 0, &payload)
    };
    let rows =
        |unknown: u64, inv_k: f64| numbers(&[1, 1, 1, 0, 1, unknown, bits(1.0), bits(0.0), bits(inv_k)]);
    let good = [body.clone(), stiffness([1.0, 0.0, 1.0], [0, 0, 1]), of_section(b"ROWS", 0, &rows(1, 0.0))];
    assert_eq!(read(&of_sections(FORMAT, &good)).unwrap().sizes().rows, 1);
    for (section, says) in [
        (of_section(b"BODY", 0, &numbers(&[0])), "at least one unknown"),
        (stiffness([1.0, f64::NAN, 1.0], [0, 0, 1]), "not a finite number"),
        (stiffness([1.0, 1.0, 1.0], [0, 7, 1]), "outside the 2 unknowns"),
        (stiffness([1.0, 1.0, 1.0], [0, 1, 1]), "twice"),
        (of_section(b"LOAD", 0, &numbers(&[1, 0])), "has 2 unknowns, not 1"),
        (of_section(b"NULL", 0, &numbers(&[2, 0, 3])), "no kind of null space"),
        (of_section(b"COOF", 0, &numbers(&[3])), "no kind of rigid motions"),
        (of_section(b"FIXD", 0, &numbers(&[1, 2])), "outside the 2 unknowns"),
        (of_section(b"NUMB", 0, &numbers(&[2, 4, 4])), "another unknown of the body has this number"),
        (of_section(b"NUMB", 0, &numbers(&[2, 4, u64::MAX])), "no array has an entry"),
        (of_section(b"NUMB", 0, &numbers(&[1, 4])), "has 2 unknowns, not 1"),
        (of_section(b"ROWS", 0, &rows(2, 0.0)), "there are 1 bodies"),
        (of_section(b"ROWS", 0, &rows(u64::MAX, 0.0)), "there are 1 bodies"),
        (of_section(b"ROWS", 0, &rows(1, -1.0)), "compliance"),
        (of_section(b"ROWS", 0, &numbers(&[3, 0, 0, 0])), "no kind of rows"),
        (of_section(b"ROWS", 0, &numbers(&[1, 2, 1, 0, 5, 1, 0, 0, 0, 0, 0, 0])), "ends before it begins"),
        (of_section(b"OPTS", 0, b"tolerance=1e-9 invented=1"), "no option \"invented\""),
        (of_section(b"OPTS", 0, b"tolerance=\xff"), "UTF-8"),
        (of_section(b"LOAD", 0, &numbers(&[2, 0, 0, 0])), "8 bytes too many"),
        (of_section(b"LOAD", 2, &numbers(&[2, 0, 0])), "bits that are not zero"),
    ] {
        let error = refused(&of_sections(FORMAT, &[body.clone(), section]));
        assert!(error.what.contains(says), "{error}, not {says}");
        assert!(error.what.contains("section "), "{error}");
    }
    let load = of_section(b"LOAD", 0, &numbers(&[2, 0, 0]));
    assert!(refused(&of_sections(FORMAT, std::slice::from_ref(&load))).what.contains("no body before it"));
    assert!(refused(&of_sections(FORMAT, &[body.clone(), load.clone(), load])).what.contains("twice"));
    let row = of_section(b"ROWS", 0, &rows(1, 0.0));
    assert!(refused(&of_sections(FORMAT, &[body.clone(), row.clone(), row.clone()])).what.contains("twice"));
    assert!(refused(&of_sections(FORMAT, &[body.clone(), row, body])).what.contains("after the rows"));
}

/// 2e5 bodies with a matrix each: a search through all bodies for every section would take minutes.
#[test]
fn many_small_bodies_are_read_in_a_time_that_grows_with_the_file() {
    let payload = [numbers(&[1, 1, 0, 1, 1.0_f64.to_bits()]), vec![0; 4]].concat();
    let body = [of_section(b"BODY", 0, &numbers(&[1])), of_section(b"STIF", 0, &payload)].concat();
    let begun = std::time::Instant::now();
    assert_eq!(read(&of_sections(FORMAT, &vec![body; 200_000])).unwrap().sizes().bodies, 200_000);
    assert!(begun.elapsed().as_secs() < 20);
}

/// A folder of this test.
fn folder(name: &str) -> PathBuf {
    let folder = std::env::temp_dir().join(format!("feti-file-{name}-{}", std::process::id()));
    fs::create_dir_all(&folder).unwrap();
    folder
}

#[test]
fn a_failed_write_leaves_the_old_file_and_nothing_else() {
    let folder = folder("write");
    let path = folder.join("problem.feti");
    let mut problem = small();
    problem.write_file(&path).unwrap();
    assert_eq!(fs::read(&path).unwrap(), problem.write_bytes().unwrap());
    Problem::new().write_file(&path).unwrap();
    assert_eq!(fs::read(&path).unwrap(), Problem::new().write_bytes().unwrap(), "an old file is replaced");
    let mut back = Problem::new();
    back.read_file(&path).unwrap();
    let inside = folder.join("folder");
    fs::create_dir(&inside).unwrap();
    for (bad, operation) in [(inside.clone(), "open"), (folder.join("none/problem.feti"), "create")] {
        let error = problem.write_file(&bad).unwrap_err();
        assert_eq!(error.kind, Kind::Io);
        assert!(error.what.contains(&format!("{}: {operation}: ", bad.display())), "{error}");
    }
    let error = back.read_file(&folder.join("none")).unwrap_err();
    assert!(error.what.contains("none: open: ") && error.what.contains("os error"), "{error}");
    fs::write(&path, b"text").unwrap();
    let error = back.read_file(&path).unwrap_err();
    assert!(error.what.contains("problem.feti: the file ends after 4 bytes"), "{error}");
    fs::remove_dir(&inside).unwrap();
    let left: Vec<_> = fs::read_dir(&folder).unwrap().map(|entry| entry.unwrap().path()).collect();
    assert_eq!(left, [path]);
    fs::remove_dir_all(&folder).unwrap();
}

#[cfg(target_os = "linux")]
#[test]
fn a_full_device_or_a_link_leaves_what_there_was() {
    let mut problem = small();
    assert!(
        problem.write_file("/dev/null".as_ref()).is_err() && !fs::metadata("/dev/null").unwrap().is_file()
    );
    let folder = folder("link");
    let (path, link) = (folder.join("problem.feti"), folder.join("link"));
    fs::write(&path, b"old").unwrap();
    std::os::unix::fs::symlink(&path, &link).unwrap();
    problem.write_file(&link).unwrap();
    assert!(fs::symlink_metadata(&link).unwrap().is_symlink());
    assert_eq!(fs::read(&path).unwrap(), problem.write_bytes().unwrap());
    fs::remove_dir_all(&folder).unwrap();
}

/// tests/data/problem_v1.feti was written by version 0.1.0, and is what docs/file_format.md shows.
#[test]
fn a_file_of_format_1_still_reads() {
    let path = PathBuf::from(env!("CARGO_MANIFEST_DIR")).join("tests/data/problem_v1.feti");
    if std::env::var_os("FETI_WRITE_GOLDEN").is_some() {
        small().write_file(&path).unwrap();
    }
    let mut problem = Problem::new();
    problem.read_file(&path).unwrap();
    assert_eq!(problem.write_bytes().unwrap()[32..], small().write_bytes().unwrap()[32..]);
    assert_eq!(problem.solve().unwrap().outcome, Outcome::Solved);
}
