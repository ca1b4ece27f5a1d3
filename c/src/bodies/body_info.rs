//! Information about a body.

use crate::bodies::body::body_of_order;
use crate::boundary::{call, enter, id, known, OutStruct, Output};
use crate::header::types::{
    feti_body_facts, feti_problem, FETI_ORIGIN_CANDIDATES, FETI_ORIGIN_COORDINATES, FETI_ORIGIN_EXACT,
    FETI_ORIGIN_FOUND,
};
use feti_contact::solver::{BodyFacts, Doubt, Origin};

/// Reads the connected part of every unknown of a body.
///
/// A body may have several parts that no nonzero entry of K couples. The parts are numbered from 0 in the order of
/// their first unknowns. FETI_STATE before the stiffness matrix is given.
///
/// | argument | in/out | shape | rule |
/// |---|---|---|---|
/// | `p` | in | scalar | the handle |
/// | `body` | in | scalar | number of the body, from 0 |
/// | `n` | in | scalar | unknowns of the body |
/// | `component` | out | n | part of each unknown, from 0 |
///
/// # Safety
/// The array has the given shape.
#[no_mangle]
pub unsafe extern "C" fn feti_body_components(
    p: *mut feti_problem,
    body: i64,
    n: i64,
    component: *mut i64,
) -> i32 {
    enter(p, call!(feti_body_components(p, body, n, component)), |problem| {
        let (body, n) = body_of_order(problem, body, n)?;
        // SAFETY: room for n numbers guaranteed by the caller.
        let output = unsafe { Output::new(component, n, "component") }?;
        let (parts, _) = problem.components(body)?;
        parts.iter().enumerate().for_each(|(dof, part)| output.write_at(dof, &[*part as i64]));
        Ok(())
    })
}

/// Reads what is known about a body: its matrix, its null space, its factor and its dual operator.
///
/// This call computes nothing except the connected parts.
///
/// | argument | in/out | shape | rule |
/// |---|---|---|---|
/// | `p` | in | scalar | the handle |
/// | `body` | in | scalar | number of the body, from 0 |
/// | `out` | in/out | scalar | `struct_size` set, at least 16 |
///
/// # Safety
/// `out` points to `struct_size` writable bytes.
#[no_mangle]
pub unsafe extern "C" fn feti_body_info(p: *mut feti_problem, body: i64, out: *mut feti_body_facts) -> i32 {
    enter(p, call!(feti_body_info(p, body, out)), |problem| {
        let facts = problem.body_facts(id(body, "body")?)?;
        // SAFETY: the caller gives `struct_size` bytes.
        unsafe { OutStruct::new(out, "out") }?.write(&record(&facts));
        Ok(())
    })
}

fn record(facts: &BodyFacts) -> feti_body_facts {
    let factors = facts.factors.as_ref();
    // NaN if there are no doubts
    let largest = |of: fn(&Doubt) -> f64| {
        factors.iter().flat_map(|factors| &factors.doubts).map(of).fold(f64::NAN, f64::max)
    };
    feti_body_facts {
        struct_size: size_of::<feti_body_facts>() as i64,
        unknowns: facts.unknowns as i64,
        entries: known(facts.entries),
        components: known(facts.components),
        matrix_bytes: facts.matrix_bytes as i64,
        borrowed: facts.borrowed.iter().filter(|borrowed| **borrowed).count() as i64,
        origin: i64::from(match facts.origin {
            Origin::Given => FETI_ORIGIN_EXACT,
            Origin::Candidates => FETI_ORIGIN_CANDIDATES,
            Origin::Coordinates => FETI_ORIGIN_COORDINATES,
            Origin::Found => FETI_ORIGIN_FOUND,
        }),
        null_space: known(factors.map(|factors| factors.null_space)),
        factor_entries: known(factors.map(|factors| factors.entries)),
        factor_bytes: known(factors.map(|factors| factors.bytes)),
        shared_with: known(factors.and_then(|factors| factors.shared_with)),
        explicit_operator: known(facts.operator.map(|bytes| usize::from(bytes.is_some()))),
        operator_bytes: known(facts.operator.map(|bytes| bytes.unwrap_or(0))),
        gap: factors.and_then(|factors| factors.gap).unwrap_or(f64::NAN),
        force_error: facts.force_error.unwrap_or(f64::NAN),
        soft_free: known(factors.map(|factors| factors.soft(true))),
        soft_held: known(factors.map(|factors| factors.soft(false))),
        softness: largest(|doubt| doubt.resisted),
        softness_of_rounding: largest(|doubt| doubt.rounding),
        pieces: facts.pieces as i64,
    }
}
