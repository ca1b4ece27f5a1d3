//! Nodes with friction through the C interface: arguments, refused values and their places, results.
//!
//! A block of two unknowns on springs of stiffness 2, K = diag(2, 2), is pressed by 4 against a wall, row 0, and pushed along it
//! by 1. With a coefficient of 0.5 it sticks: u = 0, lambda = 4, lambda_t = 1.

use std::ptr::{null, null_mut};

use super::{last_detail, last_error, Owned};
use crate::*;

/// Rows u_1 <= 0 and u_0 <= infinity, which never closes; an equality row without entries.
fn block() -> Owned {
    let p = Owned::with_body();
    let (ptr, col, k) = ([0, 1, 2], [0, 1], [2.0, 2.0]);
    let (rows, dof, one, gap) = ([0, 1, 2], [1, 0], [1.0, 1.0], [0.0, f64::INFINITY]);
    // SAFETY: the arrays have the shapes that the calls want.
    unsafe {
        let status = feti_body_stiffness_i32(
            p.0,
            0,
            2,
            ptr.as_ptr(),
            col.as_ptr(),
            k.as_ptr(),
            0,
            FETI_LOWER,
            FETI_COPY,
        );
        assert_eq!(status, FETI_OK);
        let first = null_mut();
        let status = feti_rows_add_i32(
            p.0,
            FETI_INEQUALITY,
            2,
            rows.as_ptr(),
            null(),
            dof.as_ptr(),
            one.as_ptr(),
            0,
            gap.as_ptr(),
            first,
        );
        assert_eq!(status, FETI_OK);
    }
    assert_eq!(p.load(&[1.0, 4.0]), FETI_OK);
    p
}

/// One or two nodes of one tangential row each; arrays count from 1.
#[derive(Clone, Copy)]
struct Nodes<'a> {
    nodes: i64,
    dim: i32,
    normal: &'a [i32],
    ptr: &'a [i32],
    dof: &'a [i32],
    val: &'a [f64],
    base: i32,
    coefficient: &'a [f64],
    bound: &'a [f64],
}

const TWO: Nodes = Nodes {
    nodes: 2,
    dim: 1,
    normal: &[1, 2],
    ptr: &[1, 2, 3],
    dof: &[1, 2],
    val: &[1.0, 1.0],
    base: 1,
    coefficient: &[0.5, 0.25],
    bound: &[0.0, 0.0],
};

const ONE: Nodes = Nodes { nodes: 1, ..TWO };

impl Nodes<'_> {
    fn add(self, p: &Owned) -> (i32, i64) {
        let mut first = -1;
        let or_none = |values: &[f64]| if values.is_empty() { null() } else { values.as_ptr() };
        // SAFETY: the arrays have the shapes that the call wants, or what is wrong is refused before.
        let status = unsafe {
            feti_friction_add_i32(
                p.0,
                self.nodes,
                self.dim,
                self.normal.as_ptr(),
                self.ptr.as_ptr(),
                null(),
                self.dof.as_ptr(),
                self.val.as_ptr(),
                self.base,
                or_none(self.coefficient),
                or_none(self.bound),
                &mut first,
            )
        };
        (status, first)
    }
}

fn info_of(p: &Owned) -> (i32, feti_info) {
    // SAFETY: all zero is a valid value; the size is set.
    unsafe {
        let mut info: feti_info = std::mem::zeroed();
        info.struct_size = size_of::<feti_info>() as i64;
        (feti_solve(p.0, &mut info), info)
    }
}

fn read<T: Copy>(start: T, len: usize, call: impl Fn(*mut T) -> i32) -> (i32, Vec<T>) {
    let mut values = vec![start; len];
    (call(values.as_mut_ptr()), values)
}

fn multipliers(p: &Owned, kind: i32, rows: usize) -> (i32, Vec<f64>) {
    // SAFETY: room for this number of values.
    read(-1.0, rows, |to| unsafe { feti_multipliers(p.0, kind, rows as i64, to) })
}

fn slips(p: &Owned, nodes: usize) -> (i32, Vec<f64>) {
    // SAFETY: room for this number of values.
    read(-1.0, nodes, |to| unsafe { feti_friction_slips(p.0, nodes as i64, 1, to) })
}

#[test]
fn nodes_are_numbered_from_0_and_known_to_the_solve() {
    let p = block();
    assert_eq!(ONE.add(&p), (FETI_OK, 0));
    let alone = Nodes { normal: &[0], coefficient: &[], bound: &[3.0], ..ONE };
    assert_eq!(alone.add(&p), (FETI_OK, 1), "base - 1 is a node without a contact row");
    assert_eq!(Nodes { nodes: 0, ..ONE }.add(&p), (FETI_OK, 2));
    assert_eq!(info_of(&p).1.nodes, 2);
    assert_eq!(feti_friction_clear(p.0), FETI_OK);
    assert_eq!(TWO.add(&p), (FETI_OK, 0));
    assert_eq!(feti_rows_clear(p.0, FETI_EQUALITY), FETI_OK);
    assert_eq!(slips(&p, 2).0, FETI_STATE);
    assert_eq!(info_of(&p).1.nodes, 2);
    assert_eq!(feti_rows_clear(p.0, FETI_INEQUALITY), FETI_OK);
    assert_eq!(info_of(&p).1.nodes, 0);
}

#[test]
fn what_is_wrong_with_a_node_is_named_and_nothing_is_added() {
    let p = block();
    assert_eq!(p.set(c"index_base", 1), FETI_OK);
    let bad = f64::NAN;
    for (given, argument, node, entry) in [
        (Nodes { normal: &[1, 3], ..TWO }, 4, 1, 1),
        (Nodes { normal: &[1, -1], ..TWO }, 4, 1, 1),
        (Nodes { normal: &[2, 2], ..TWO }, 4, 1, 1),
        (Nodes { normal: &[1, 0], ..TWO }, 4, 1, 1),
        (Nodes { ptr: &[1, 2, 1], ..TWO }, 5, 1, -1),
        (Nodes { ptr: &[0, 2, 3], ..TWO }, 5, 0, -1),
        (Nodes { dof: &[1, 3], ..TWO }, 7, 1, 1),
        (Nodes { val: &[1.0, f64::INFINITY], ..TWO }, 8, 1, 1),
        (Nodes { coefficient: &[0.5, -0.1], ..TWO }, 10, 1, 1),
        (Nodes { coefficient: &[bad, 0.1], ..TWO }, 10, 0, 0),
        (Nodes { bound: &[0.0, -1.0], ..TWO }, 11, 1, 1),
        (Nodes { bound: &[0.0, f64::INFINITY], ..TWO }, 11, 1, 1),
        (Nodes { nodes: -1, ..TWO }, 2, -1, -1),
        (Nodes { nodes: i64::MAX, ..TWO }, 2, -1, -1),
        (Nodes { dim: 0, ..TWO }, 3, -1, -1),
        (Nodes { dim: 3, ..TWO }, 3, -1, -1),
        (Nodes { base: 2, ..TWO }, 9, -1, -1),
    ] {
        assert_eq!(given.add(&p), (FETI_ARGUMENT - argument, -1), "{}", last_error());
        let detail = last_detail();
        assert_eq!((detail.node, detail.entry), (node, entry), "{}", last_error());
        let named = format!("node {}", node + 1);
        assert!(node < 0 || last_error().contains(&named), "{}", last_error());
    }
    let unknown = Nodes { normal: &[1, 3], ..TWO };
    unknown.add(&p);
    assert!(last_error().contains("there are 2 contact rows"), "{}", last_error());
    assert_eq!(last_detail().value, 3.0, "counted as the texts do");
    assert_eq!(info_of(&p).1.nodes, 0);
    assert_eq!(TWO.add(&p), (FETI_OK, 0));
    assert_eq!(ONE.add(&p).0, FETI_ARGUMENT - 4);
    assert!(last_error().contains("already has a node of friction"), "{}", last_error());
    let other = Nodes { dim: 2, normal: &[0], coefficient: &[], ptr: &[1, 2, 3], ..ONE };
    assert_eq!(other.add(&p).0, FETI_ARGUMENT - 3);
}

#[test]
fn laws_compliances_and_references_are_refused_by_node() {
    let p = block();
    assert_eq!(TWO.add(&p).0, FETI_OK);
    let (bad, good) = ([0.5, -1.0], [0.5, 0.5]);
    let at = |status: i32| (status, last_detail().node, last_detail().entry);
    // SAFETY: two numbers each.
    unsafe {
        assert_eq!(at(feti_friction_law(p.0, 0, 2, bad.as_ptr(), null())), (FETI_ARGUMENT - 4, 1, 1));
        assert_eq!(at(feti_friction_law(p.0, 1, 1, null(), bad[1..].as_ptr())), (FETI_ARGUMENT - 5, 1, 0));
        assert_eq!(at(feti_friction_compliance(p.0, 0, 2, bad.as_ptr())), (FETI_ARGUMENT - 4, 1, 1));
        let nan = [0.0, f64::NAN];
        assert_eq!(at(feti_friction_reference(p.0, 0, 2, 1, nan.as_ptr())), (FETI_ARGUMENT - 5, 1, 1));
        assert_eq!(feti_friction_reference(p.0, 0, 2, 2, good.as_ptr()), FETI_ARGUMENT - 4);
        assert_eq!(feti_friction_reference(p.0, 0, 2, 3, good.as_ptr()), FETI_ARGUMENT - 4);
        for (first, nodes, argument) in [(2, 1, 2), (-1, 1, 2), (1, 2, 3), (0, -1, 3)] {
            assert_eq!(feti_friction_law(p.0, first, nodes, good.as_ptr(), null()), FETI_ARGUMENT - argument);
            let status = feti_friction_compliance(p.0, first, nodes, good.as_ptr());
            assert_eq!(status, FETI_ARGUMENT - argument);
            let status = feti_friction_reference(p.0, first, nodes, 1, good.as_ptr());
            assert_eq!(status, FETI_ARGUMENT - argument);
        }
        assert_eq!(feti_friction_law(p.0, 0, 2, null(), null()), FETI_OK);
        assert_eq!(feti_friction_law(p.0, 0, 2, good.as_ptr(), good.as_ptr()), FETI_OK);
        assert_eq!(feti_friction_reference(p.0, 2, 0, 7, null()), FETI_OK, "no nodes, nothing is looked at");
    }
}

#[test]
fn functions_of_rows_say_which_one_is_for_tangential_ones() {
    let p = block();
    assert_eq!(ONE.add(&p).0, FETI_OK);
    let (zero, ptr) = ([0.0], [0, 0]);
    let kind = FETI_TANGENTIAL;
    // SAFETY: the arrays have the shapes that the calls want.
    unsafe {
        let add = feti_rows_add_i32(
            p.0,
            kind,
            1,
            ptr.as_ptr(),
            null(),
            null(),
            null(),
            0,
            zero.as_ptr(),
            null_mut(),
        );
        assert_eq!((add, last_error().contains("feti_friction_add_i32")), (FETI_ARGUMENT - 2, true));
        let rhs = feti_rows_rhs(p.0, kind, 0, 1, zero.as_ptr());
        assert_eq!((rhs, last_error().contains("feti_friction_reference")), (FETI_ARGUMENT - 2, true));
        let compliance = feti_rows_compliance(p.0, kind, 0, 1, zero.as_ptr());
        assert_eq!(
            (compliance, last_error().contains("feti_friction_compliance")),
            (FETI_ARGUMENT - 2, true)
        );
    }
    let clear = feti_rows_clear(p.0, kind);
    assert_eq!((clear, last_error().contains("feti_friction_clear")), (FETI_ARGUMENT - 2, true));
    assert_eq!(info_of(&p).1.nodes, 1);
}

/// By hand: u = 0, lambda = 4, lambda_t = 1.
#[test]
fn a_block_that_sticks_has_its_forces_and_no_slip() {
    let p = block();
    assert_eq!(ONE.add(&p).0, FETI_OK);
    assert_eq!((slips(&p, 1).0, multipliers(&p, FETI_TANGENTIAL, 1).0), (FETI_STATE, FETI_STATE));
    assert_eq!(feti_friction_commit(p.0), FETI_STATE);
    let (status, info) = info_of(&p);
    assert_eq!((status, info.nodes), (FETI_OK, 1), "{}", last_error());
    let near = |found: &[f64], expected: &[f64]| {
        assert!(found.iter().zip(expected).all(|(a, b)| (a - b).abs() < 1e-9), "{found:?}, not {expected:?}");
    };
    let (lambda, tangential) = (multipliers(&p, FETI_INEQUALITY, 2).1, multipliers(&p, FETI_TANGENTIAL, 1).1);
    near(&lambda, &[4.0, 0.0]);
    near(&tangential, &[1.0]);
    near(&slips(&p, 1).1, &[0.0]);
    for (kind, expected) in
        [(FETI_TANGENTIAL, [-1.0, 0.0]), (FETI_INEQUALITY, [0.0, -4.0]), (0, [-1.0, -4.0])]
    {
        // SAFETY: room for two numbers.
        let (status, force) = read(9.0, 2, |to| unsafe { feti_reaction(p.0, kind, 0, 2, to) });
        assert_eq!(status, FETI_OK);
        near(&force, &expected);
    }
    // SAFETY: room for one number.
    let states = |nodes: i64| read(-1, 1, |to| unsafe { feti_friction_states(p.0, nodes, to) });
    assert_eq!((states(1).0, states(2)), (FETI_OK, (FETI_ARGUMENT - 2, vec![-1])));
    assert_eq!(slips(&p, 2), (FETI_ARGUMENT - 2, vec![-1.0; 2]));
    let u = [0.0; 2];
    // SAFETY: all zero is a valid value; the size is set, the arrays have the shapes that the call wants.
    let check = |nodes: i64, dim: i32, force: &[f64]| unsafe {
        let mut out: feti_certificate = std::mem::zeroed();
        out.struct_size = size_of::<feti_certificate>() as i64;
        let lambda = lambda.as_ptr();
        let (mu, force) = (null(), force.as_ptr());
        (feti_check_friction(p.0, 2, u.as_ptr(), 2, lambda, 0, mu, nodes, dim, force, &mut out), out)
    };
    let (status, certificate) = check(1, 1, &tangential);
    assert_eq!((status, certificate.passed), (FETI_OK, 1));
    assert_eq!(check(1, 1, &[1.5]).1.passed, 0);
    assert_eq!(check(2, 1, &[1.0; 2]).0, FETI_ARGUMENT - 8);
    assert_eq!(check(1, 2, &[1.0; 2]).0, FETI_ARGUMENT - 9);
    assert_eq!(check(1, 1, &[f64::NAN]).0, FETI_ARGUMENT - 10);
    assert_eq!(feti_friction_commit(p.0), FETI_OK);
    near(&slips(&p, 1).1, &[0.0]);
    // SAFETY: one number.
    unsafe {
        assert_eq!(feti_start_from(p.0, FETI_TANGENTIAL, 1, tangential.as_ptr()), FETI_OK);
        assert_eq!(feti_start_from(p.0, FETI_TANGENTIAL, 2, lambda.as_ptr()), FETI_ARGUMENT - 3);
    }
    assert_eq!(info_of(&p).0, FETI_OK);
    near(&multipliers(&p, FETI_TANGENTIAL, 1).1, &[1.0]);
}
