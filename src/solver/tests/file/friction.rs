//! Nodes with friction in a problem file.

use super::*;
use crate::solver::FrictionInput;

/// The small problem with a node on its contact row and a node with a bound alone, dim = 2; one row has no entries.
fn with_nodes() -> Problem {
    let mut problem = small();
    let rows = RowsInput {
        ptr: &[0, 1, 1, 3, 4],
        body: None,
        dof: &[2, 0, 1, 2],
        val: &[0.5, 1.0, -1.0, -0.25],
        rhs: None,
    };
    let (coefficient, bound) = (Some(&[0.3, 0.0][..]), Some(&[0.0, 1.0 / 3.0][..]));
    problem.add_friction(FrictionInput { dim: 2, normal: &[0, -1], rows, coefficient, bound }).unwrap();
    problem.set_friction_compliance(1, &[0.125]).unwrap();
    problem.set_friction_reference(0, 2, 2, &[1e-3, 0.0, -0.0, 5e-324]).unwrap();
    problem
}

/// The payload of a node with one tangential row on unknown 0 and the given contact row.
fn node(dim: u64, normal: i64, coefficient: f64, s_old: f64) -> Vec<u8> {
    let law = [1.0, coefficient, 0.5, 0.0, s_old].map(f64::to_bits);
    let sizes = numbers(&[dim, 1, 1, normal as u64, 0, 1, 0]);
    [sizes, numbers(&law)].concat()
}

#[test]
fn nodes_with_friction_come_back_bit_by_bit() {
    let problem = with_nodes();
    let bytes = problem.write_bytes().unwrap();
    assert_eq!(bytes.len() as u64, expected_length(&problem));
    let back = read(&bytes).unwrap();
    let (new, old) = (&back.model.friction, &problem.model.friction);
    assert_eq!((new.dim, &new.nodes), (old.dim, &old.nodes));
    let bits = |values: &[f64]| values.iter().map(|v| v.to_bits()).collect::<Vec<_>>();
    assert_eq!((&new.rows.matrix, bits(&new.rows.rhs)), (&old.rows.matrix, bits(&old.rows.rhs)));
    assert_eq!(*new.rows.compliance, [0.0, 0.0, 0.125, 0.125]);
    assert_eq!(back.write_bytes().unwrap(), bytes, "written again it is the same file");
    for length in 0..bytes.len() {
        refused(&bytes[..length]);
    }
    let at = bytes.windows(4).position(|tag| tag == b"FRIC").unwrap();
    for bit in 8 * at..8 * bytes.len() {
        let mut changed = bytes.clone();
        changed[bit / 8] ^= 1 << (bit % 8);
        refused(&changed);
    }
}

#[test]
fn a_problem_without_friction_has_no_section_and_who_does_not_know_it_refuses_it() {
    let bytes = small().write_bytes().unwrap();
    let has = |bytes: &[u8]| bytes.windows(4).any(|tag| tag == b"FRIC");
    assert!(!has(&bytes));
    let mut problem = with_nodes();
    let with = problem.write_bytes().unwrap();
    assert!(has(&with));
    // a library that does not know the tag must refuse the section: the flag to skip it is not set
    let at = with.windows(4).position(|tag| tag == b"FRIC").unwrap();
    let mut section = with[at..with.len() - 4].to_vec();
    section[3] = b'X';
    let error = refused(&[&with[..at], &sealed(section)].concat());
    assert_eq!(error.kind, Kind::Unsupported);
    assert!(error.what.contains("section FRIX"), "{error}");
    problem.clear_friction();
    assert_eq!(problem.write_bytes().unwrap(), bytes);
}

#[test]
fn what_a_call_refuses_is_refused_in_a_file() {
    let body = of_section(b"BODY", 0, &numbers(&[1]));
    let wall = numbers(&[1, 1, 1, 0, 1, 0, 1.0_f64.to_bits(), 0, 0]);
    let wall = of_section(b"ROWS", 0, &wall);
    let nodes = |payload: Vec<u8>| of_section(b"FRIC", 0, &payload);
    let file = |payload| of_sections(FORMAT, &[body.clone(), wall.clone(), nodes(payload)]);
    assert_eq!(read(&file(node(1, 0, 0.5, 2.0))).unwrap().model.friction.rows.rhs, [2.0]);
    for (payload, text) in [
        (node(1, 1, 0.5, 0.0), "contact rows"),
        (node(1, -2, 0.5, 0.0), "contact rows"),
        (node(1, -1, 0.5, 0.0), "needs a contact row"),
        (node(1, 0, -0.5, 0.0), "coefficient"),
        (node(1, 0, f64::NAN, 0.0), "coefficient"),
        (node(1, 0, 0.5, f64::INFINITY), "slip"),
        (node(0, 0, 0.5, 0.0), "tangential rows"),
        (node(3, 0, 0.5, 0.0), "tangential rows"),
        (node(u64::MAX, 0, 0.5, 0.0), "no array"),
        ([node(1, 0, 0.5, 0.0), vec![0; 8]].concat(), "bytes too many"),
    ] {
        let error = refused(&file(payload));
        assert!(error.what.contains(text), "{error}, not {text}");
    }
    let good = nodes(node(1, -1, 0.0, 0.0));
    for sections in [
        vec![body.clone(), good.clone(), good.clone()],
        vec![body.clone(), good.clone(), wall],
        vec![body.clone(), good.clone(), body],
    ] {
        assert_eq!(refused(&of_sections(FORMAT, &sections)).kind, Kind::Io);
    }
    assert!(read(&of_sections(FORMAT, &[of_section(b"BODY", 0, &numbers(&[1])), good])).is_ok());
}
