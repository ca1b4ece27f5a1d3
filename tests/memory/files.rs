//! A file whose counts are wrong is refused before memory is reserved for them.

use crate::counted::largest_block;
use feti_contact::body::{Modes, SparseInput, Storage};
use feti_contact::constraints::{FrictionInput, RowKind, RowsInput};
use feti_contact::solver::{ElementStorage, Problem};

/// Memory for a file beyond its own bytes: buffers and texts.
const BUFFERS: usize = 1 << 16;

/// One problem whose file has a section of every kind: two springs and a bar that is cut.
fn every_section() -> Vec<u8> {
    let mut problem = Problem::new();
    problem.set_i64("pieces", 3).unwrap();
    for r in [Some(Modes::Exact), None] {
        let body = problem.add_body(2).unwrap();
        let k =
            SparseInput { ptr: &[0, 1, 3], col: &[0, 0, 1], val: &[4.0, -4.0, 4.0], storage: Storage::Lower };
        problem.set_stiffness(body, k).unwrap();
        problem.set_load(body, &[0.0, 1.0]).unwrap();
        problem.set_fixing(body, Some(&[1])).unwrap();
        match r {
            Some(modes) => problem.set_null_space(body, 2, 1, &[1.0, 1.0], 2, modes).unwrap(),
            None => {
                problem.set_coordinates(body, 1, &[0, 1], &[1, 1], &[0.0, 1.0], 1).unwrap();
                problem.set_coordinate_modes(body, Modes::Soft).unwrap();
            }
        }
    }
    let bar = problem.add_body(6).unwrap();
    let dof: Vec<i64> = (0..6).flat_map(|e| [e - 1, e]).collect();
    problem.set_mesh(bar, &[0, 2, 4, 6, 8, 10, 12], &dof).unwrap();
    problem.add_elements(bar, 0, 6, &[1.0, -1.0, 1.0].repeat(6), ElementStorage::Lower).unwrap();
    for body in 0..3 {
        let first = 10 * body as i64;
        let numbers: Vec<i64> = (first..first + if body < 2 { 2 } else { 6 }).collect();
        problem.set_numbering(body, &numbers).unwrap();
    }
    let row = |dof| RowsInput { ptr: &[0, 1], body: None, dof, val: &[1.0], rhs: Some(&[0.5]) };
    problem.add_rows(RowKind::Inequality, row(&[1])).unwrap();
    problem.add_rows(RowKind::Equality, row(&[10])).unwrap();
    let rows = RowsInput { ptr: &[0, 1], body: None, dof: &[0], val: &[1.0], rhs: None };
    let node = FrictionInput { dim: 1, normal: &[0], rows, coefficient: Some(&[0.3]), bound: None };
    problem.add_friction(node).unwrap();
    problem.write_bytes().unwrap()
}

fn crc(bytes: &[u8]) -> u32 {
    !bytes.iter().fold(!0, |crc, byte| {
        (0..8).fold(crc ^ u32::from(*byte), |crc, _| (crc >> 1) ^ if crc & 1 == 1 { 0xEDB8_8320 } else { 0 })
    })
}

fn number(bytes: &[u8], at: usize) -> u64 {
    u64::from_le_bytes(bytes[at..at + 8].try_into().unwrap())
}

/// Begin of every section, and of its end mark: the checksum.
fn sections(file: &[u8]) -> Vec<(usize, usize)> {
    let mut found = Vec::new();
    let mut at = 32;
    while at < file.len() {
        let end = at + (16 + number(file, at + 8) as usize + 4).next_multiple_of(8);
        found.push((at, end - 4));
        at = end;
    }
    found
}

/// Counts that no file of this size can fill, the one reported by a host among them.
const BLOWN_UP: [u64; 5] = [3_000_000_000, 1 << 20, 1 << 32, 1 << 59, u64::MAX];

#[test]
fn a_count_that_the_file_cannot_hold_reserves_no_memory() {
    let file = every_section();
    let tags: Vec<&[u8]> = sections(&file).iter().map(|(begin, _)| &file[*begin..begin + 4]).collect();
    let known =
        ["OPTS", "BODY", "STIF", "NULL", "COOR", "COOF", "FIXD", "LOAD", "NUMB", "PIEC", "ROWS", "FRIC"];
    assert!(known.iter().all(|tag| tags.contains(&tag.as_bytes())), "the file has every section");
    let limit = file.len() + BUFFERS;
    let read = |bytes: &[u8]| largest_block(|| Problem::new().read_bytes(bytes));
    let (bytes, read_back) = read(&file);
    assert!(read_back.is_ok() && bytes <= limit, "{bytes}");
    for (begin, end) in sections(&file) {
        // payload of 8-byte numbers; the numbers of a text are the options
        for at in (begin + 8..=end - 8).step_by(8) {
            for count in BLOWN_UP {
                let mut wrong = file.clone();
                wrong[at..at + 8].copy_from_slice(&count.to_le_bytes());
                let sum = crc(&wrong[begin..end]);
                wrong[end..end + 4].copy_from_slice(&sum.to_le_bytes());
                let (bytes, _) = read(&wrong);
                let tag = String::from_utf8_lossy(&file[begin..begin + 4]).into_owned();
                assert!(
                    bytes <= limit,
                    "{tag}: {count} at byte {at}: {bytes} bytes for a file of {}",
                    file.len()
                );
            }
        }
    }
}

#[test]
fn a_body_larger_than_its_pieces_is_refused_with_the_unknown_that_none_has() {
    let mut file = every_section();
    let body =
        sections(&file).into_iter().filter(|(begin, _)| &file[*begin..begin + 4] == b"BODY").nth(2).unwrap();
    file[body.0 + 16..body.0 + 24].copy_from_slice(&3_000_000_000_u64.to_le_bytes());
    let sum = crc(&file[body.0..body.1]);
    file[body.1..body.1 + 4].copy_from_slice(&sum.to_le_bytes());
    let (bytes, refused) = largest_block(|| Problem::new().read_bytes(&file));
    let error = refused.unwrap_err();
    assert!(error.what.contains("no piece has the unknown") && error.place.dof == Some(6), "{error}");
    assert!(bytes <= file.len() + BUFFERS, "{bytes}");
}
