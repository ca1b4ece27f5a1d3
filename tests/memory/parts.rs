//! Memory of a model of very many small parts.

use feti_contact::solver::{Problem, RowKind, RowsInput, SparseInput, Storage};

use crate::counted::live_bytes;

/// One K of `count` chains of 1 to 6 springs and of 600 kinds, each pressed against a wall by its last unknown, and by the one
/// before if it has three: bytes of a chain after a solve and a check, in addition to the host's data.
fn bytes_of_a_part(count: usize) -> f64 {
    let (mut ptr, mut col, mut val, mut load) = (vec![0], Vec::new(), Vec::new(), Vec::new());
    let (mut row_ptr, mut dof) = (vec![0], Vec::new());
    for (part, links) in (0..count).map(|part| (part, 1 + part % 6)) {
        let (first, k) = (load.len() as i64, 1.0 + (part % 101) as f64 * 1e-2);
        for i in 0..links {
            let before = (i > 0).then_some((first + i as i64 - 1, -k));
            let own = (first + i as i64, if i > 0 && i + 1 == links { k } else { 2.0 * k });
            for (j, v) in before.into_iter().chain([own]) {
                col.push(j);
                val.push(v);
            }
            ptr.push(col.len());
            load.push(if i + 1 == links { 1.0 } else { 0.0 });
        }
        for back in if links > 2 { 1..3 } else { 1..2 } {
            dof.push(load.len() as i64 - back);
            row_ptr.push(dof.len());
        }
    }
    let (entries, gaps) = (vec![1.0; dof.len()], vec![0.1; dof.len()]);
    let mut problem = Problem::new();
    let body = problem.add_body(load.len()).unwrap();
    let k = SparseInput { ptr: &ptr, col: &col, val: &val, storage: Storage::Lower };
    problem.set_stiffness(body, k).unwrap();
    problem.set_load(body, &load).unwrap();
    let rows = RowsInput { ptr: &row_ptr, body: None, dof: &dof, val: &entries, rhs: Some(&gaps) };
    problem.add_rows(RowKind::Inequality, rows).unwrap();
    let before = live_bytes();
    problem.solve().unwrap();
    let u = problem.displacements().unwrap().to_vec();
    let lambda = problem.multipliers(RowKind::Inequality).unwrap().to_vec();
    assert!(problem.check(&u, &lambda, &[]).unwrap().passed());
    (live_bytes() - before) as f64 / count as f64
}

#[test]
fn a_part_that_equals_others_takes_less_than_1000_bytes_however_many_there_are() {
    for count in [12_000, 48_000] {
        let bytes = bytes_of_a_part(count);
        assert!(bytes < 1000.0, "{count} parts: {bytes:.0} bytes each");
    }
}
