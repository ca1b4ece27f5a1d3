//! The answer of the last solve, and the size of the problem.

use crate::bodies::{body_of_order, whole};
use crate::boundary::{call, enter, id, same, Output};
use crate::friction::{all_nodes, NODES};
use crate::header::types::{
    feti_problem, FETI_ALL, FETI_FRICTION_OPEN, FETI_FRICTION_SLIP, FETI_FRICTION_STICK,
    FETI_FRICTION_UNKNOWN, FETI_FRICTION_WEAK, FETI_ROW_CLOSED, FETI_ROW_OPEN, FETI_ROW_UNKNOWN,
    FETI_ROW_WEAK,
};
use crate::rows::multiplier_kind;
use feti_contact::error::Result;
use feti_contact::platform::memory::{reserved, zeros};
use feti_contact::solver::{FrictionState, RowState};

/// Reads the displacement of a body.
///
/// FETI_ALL reads the displacements of all bodies. If the bodies have numbers of the host, the array uses these
/// numbers, and entries that belong to no unknown are left unchanged; otherwise it gets one body after the other.
/// Bodies in a group without an answer (feti_solve) get NaN. FETI_STATE if no solve has given an answer yet, if the
/// group of the body has no answer, and with FETI_ALL if some bodies have numbers of the host and others have none.
///
/// | argument | in/out | shape | rule |
/// |---|---|---|---|
/// | `p` | in | scalar | the handle |
/// | `body` | in | scalar | number of the body, from 0, or FETI_ALL |
/// | `n` | in | scalar | unknowns of the body; with FETI_ALL at least those of the table (feti_dof_table_i32), or the largest number + 1, or without both the unknowns of all bodies |
/// | `u` | out | n | displacement, length |
///
/// # Safety
/// The array has the given shape.
#[no_mangle]
pub unsafe extern "C" fn feti_displacement(p: *mut feti_problem, body: i64, n: i64, u: *mut f64) -> i32 {
    enter(p, call!(feti_displacement(p, body, n, u)), |problem| {
        if body == FETI_ALL {
            // SAFETY: room for n numbers guaranteed by the caller.
            let output = unsafe { Output::new(u, whole(problem, n)?, "u") }?;
            return problem
                .spread_displacement(problem.displacements()?, |at, value| output.write_at(at, &[value]));
        }
        let (body, n) = body_of_order(problem, body, n)?;
        // SAFETY: room for n numbers guaranteed by the caller.
        unsafe { Output::new(u, n, "u") }?.write(problem.displacement(body)?);
        Ok(())
    })
}

/// Reads the force of the rows on a body: -B'lambda, -H'mu, -T'lambda_t, or the sum of all: `K u = f + r`.
///
/// For a single kind the force comes from the host's rows only. If unknowns of several bodies share a number (option
/// glue), the sum of all kinds also includes the glue force that these bodies exert on each other. With FETI_ALL the
/// result is the sum over the bodies, in which the glue forces cancel.
///
/// FETI_ALL reads the forces on all bodies. If the bodies have numbers of the host, the array uses these numbers, and
/// entries that belong to no unknown are left unchanged; otherwise it gets one body after the other. Entries on which
/// rows act get NaN if the group of the body has no answer (feti_solve). FETI_STATE if no solve has given an answer
/// yet, if the group of the body has no answer, and with FETI_ALL if some bodies have numbers of the host and others
/// have none.
///
/// | argument | in/out | shape | rule |
/// |---|---|---|---|
/// | `p` | in | scalar | the handle |
/// | `kind` | in | scalar | FETI_INEQUALITY, FETI_EQUALITY, FETI_TANGENTIAL, or 0 for all |
/// | `body` | in | scalar | number of the body, from 0, or FETI_ALL |
/// | `n` | in | scalar | unknowns of the body; with FETI_ALL at least those of the table (feti_dof_table_i32), or the largest number + 1, or without both the unknowns of all bodies |
/// | `r` | out | n | force |
///
/// # Safety
/// The array has the given shape.
#[no_mangle]
pub unsafe extern "C" fn feti_reaction(
    p: *mut feti_problem,
    kind: i32,
    body: i64,
    n: i64,
    r: *mut f64,
) -> i32 {
    enter(p, call!(feti_reaction(p, kind, body, n, r)), |problem| {
        let kind = if kind == 0 { None } else { Some(multiplier_kind(kind)?) };
        if body == FETI_ALL {
            // SAFETY: room for n numbers guaranteed by the caller.
            let output = unsafe { Output::new(r, whole(problem, n)?, "r") }?;
            return problem.spread_reaction(kind, |at, value| output.write_at(at, &[value]));
        }
        let (body, n) = body_of_order(problem, body, n)?;
        // SAFETY: room for n numbers guaranteed by the caller.
        let output = unsafe { Output::new(r, n, "r") }?;
        let mut reaction = zeros(n, "a result")?;
        problem.reaction(kind, body, &mut reaction)?;
        output.write(&reaction);
        Ok(())
    })
}

/// Reads the amplitudes alpha of the null space in the displacement of a body, `u = K+ (f + r) + R alpha`.
///
/// FETI_STATE if no solve has given an answer yet, and if the group of the body has no answer (feti_solve).
///
/// | argument | in/out | shape | rule |
/// |---|---|---|---|
/// | `p` | in | scalar | the handle |
/// | `body` | in | scalar | number of the body, from 0 |
/// | `r` | in | scalar | dimension of the null space of the body |
/// | `alpha` | out | r | amplitudes, in the order of the columns of feti_body_null_space_get |
///
/// # Safety
/// The array has the given shape.
#[no_mangle]
pub unsafe extern "C" fn feti_amplitudes(p: *mut feti_problem, body: i64, r: i64, alpha: *mut f64) -> i32 {
    enter(p, call!(feti_amplitudes(p, body, r, alpha)), |problem| {
        let amplitudes = problem.amplitudes(id(body, "body")?)?;
        // SAFETY: room for r numbers guaranteed by the caller.
        unsafe { copy(amplitudes, r, ("r", "the dimension of the null space is"), alpha, "alpha") }
    })
}

/// Reads the multipliers: lambda of `B u <= c`, mu of `H u = h`, or lambda_t of the nodes with friction, node after node.
///
/// Rows on bodies in a group without an answer (feti_solve) get NaN; rows that never close get 0. FETI_STATE if no
/// solve has given an answer yet.
///
/// | argument | in/out | shape | rule |
/// |---|---|---|---|
/// | `p` | in | scalar | the handle |
/// | `kind` | in | scalar | FETI_INEQUALITY, FETI_EQUALITY or FETI_TANGENTIAL |
/// | `rows` | in | scalar | number of rows of the kind; for tangential rows dim times the number of nodes |
/// | `lambda` | out | rows | force, >= 0 for inequalities |
///
/// # Safety
/// The array has the given shape.
#[no_mangle]
pub unsafe extern "C" fn feti_multipliers(
    p: *mut feti_problem,
    kind: i32,
    rows: i64,
    lambda: *mut f64,
) -> i32 {
    enter(p, call!(feti_multipliers(p, kind, rows, lambda)), |problem| {
        let multipliers = problem.multipliers(multiplier_kind(kind)?)?;
        // SAFETY: room for one number per row guaranteed by the caller.
        unsafe { copy(multipliers, rows, ("rows", ROWS), lambda, "lambda") }
    })
}

/// Reads the remaining gaps, c - B u; for compliant rows c + lambda/k - B u, which is 0 if they carry a force.
///
/// Rows on bodies in a group without an answer (feti_solve) get NaN; rows that never close get +infinity. FETI_STATE if
/// no solve has given an answer yet.
///
/// | argument | in/out | shape | rule |
/// |---|---|---|---|
/// | `p` | in | scalar | the handle |
/// | `rows` | in | scalar | number of inequality rows |
/// | `slack` | out | rows | open gap, length; negative: penetration |
///
/// # Safety
/// The array has the given shape.
#[no_mangle]
pub unsafe extern "C" fn feti_gaps(p: *mut feti_problem, rows: i64, slack: *mut f64) -> i32 {
    enter(p, call!(feti_gaps(p, rows, slack)), |problem| {
        // SAFETY: room for one number per row guaranteed by the caller.
        unsafe { copy(problem.gaps()?, rows, ("rows", ROWS), slack, "slack") }
    })
}

/// Reads the state of the inequality rows, decided by what the certificate regards as zero at each row.
///
/// FETI_ROW_CLOSED means a force; FETI_ROW_OPEN means a gap and no force, or a row that never closes; FETI_ROW_WEAK
/// means neither a gap nor a force; FETI_ROW_UNKNOWN means that the bodies of the row are in a group without an answer
/// (feti_solve). FETI_STATE if no solve has given an answer yet.
///
/// | argument | in/out | shape | rule |
/// |---|---|---|---|
/// | `p` | in | scalar | the handle |
/// | `rows` | in | scalar | number of inequality rows |
/// | `state` | out | rows | FETI_ROW_OPEN, FETI_ROW_CLOSED, FETI_ROW_WEAK or FETI_ROW_UNKNOWN |
///
/// # Safety
/// The array has the given shape.
#[no_mangle]
pub unsafe extern "C" fn feti_active(p: *mut feti_problem, rows: i64, state: *mut i32) -> i32 {
    enter(p, call!(feti_active(p, rows, state)), |problem| {
        let active = problem.active()?;
        let mut numbers = reserved(active.len(), "a result")?;
        numbers.extend(active.iter().map(|state| match state {
            RowState::Open => FETI_ROW_OPEN,
            RowState::Closed => FETI_ROW_CLOSED,
            RowState::Weak => FETI_ROW_WEAK,
            RowState::Unknown => FETI_ROW_UNKNOWN,
        }));
        // SAFETY: room for one number per row guaranteed by the caller.
        unsafe { copy(&numbers, rows, ("rows", ROWS), state, "state") }
    })
}

/// Reads the slips of the last answer, `s = T u - s_old - C_t lambda_t`, with the s_old of that solve.
///
/// A slip has the sign of its force lambda_t (feti_multipliers with FETI_TANGENTIAL). Nodes on bodies in a group
/// without an answer (feti_solve) get NaN. FETI_STATE if no solve has given an answer yet.
///
/// | argument | in/out | shape | rule |
/// |---|---|---|---|
/// | `p` | in | scalar | the handle |
/// | `nodes` | in | scalar | number of nodes with friction |
/// | `dim` | in | scalar | tangential rows of a node, 1 or 2; ignored if there are no nodes |
/// | `slip` | out | dim * nodes | node after node, length |
///
/// # Safety
/// The array has the given shape.
#[no_mangle]
pub unsafe extern "C" fn feti_friction_slips(
    p: *mut feti_problem,
    nodes: i64,
    dim: i32,
    slip: *mut f64,
) -> i32 {
    enter(p, call!(feti_friction_slips(p, nodes, dim, slip)), |problem| {
        let (slips, len) = (problem.slips()?, all_nodes(problem, nodes, dim)?);
        // SAFETY: room for dim numbers for each node guaranteed by the caller.
        unsafe { Output::new(slip, len, "slip") }?.write(slips);
        Ok(())
    })
}

/// Reads the states of the nodes in the last answer, decided by what the certificate regards as zero at each node.
///
/// FETI_FRICTION_OPEN means only that the bound is zero: a node with `bound` > 0 sticks or slips even if its contact is
/// open; FETI_FRICTION_STICK means a force within the bound; FETI_FRICTION_SLIP means a slip in the direction of a
/// force that reaches the bound; FETI_FRICTION_WEAK means a force that reaches the bound without a slip, within
/// rounding error; FETI_FRICTION_UNKNOWN means that the bodies of the node are in a group without an answer
/// (feti_solve). FETI_STATE if no solve has given an answer yet.
///
/// | argument | in/out | shape | rule |
/// |---|---|---|---|
/// | `p` | in | scalar | the handle |
/// | `nodes` | in | scalar | number of nodes with friction |
/// | `state` | out | nodes | FETI_FRICTION_OPEN, FETI_FRICTION_STICK, FETI_FRICTION_SLIP, FETI_FRICTION_WEAK or FETI_FRICTION_UNKNOWN |
///
/// # Safety
/// The array has the given shape.
#[no_mangle]
pub unsafe extern "C" fn feti_friction_states(p: *mut feti_problem, nodes: i64, state: *mut i32) -> i32 {
    enter(p, call!(feti_friction_states(p, nodes, state)), |problem| {
        let states = problem.friction_states()?;
        let mut numbers = reserved(states.len(), "a result")?;
        numbers.extend(states.iter().map(|state| match state {
            FrictionState::Open => FETI_FRICTION_OPEN,
            FrictionState::Stick => FETI_FRICTION_STICK,
            FrictionState::Slip => FETI_FRICTION_SLIP,
            FrictionState::Weak => FETI_FRICTION_WEAK,
            FrictionState::Unknown => FETI_FRICTION_UNKNOWN,
        }));
        // SAFETY: room for one number per node guaranteed by the caller.
        unsafe { copy(&numbers, nodes, ("nodes", NODES), state, "state") }
    })
}

/// Reads the current size of the problem.
///
/// | argument | in/out | shape | rule |
/// |---|---|---|---|
/// | `p` | in | scalar | the handle |
/// | `bodies` | out | scalar | bodies; may be NULL |
/// | `dofs` | out | scalar | unknowns of all bodies; may be NULL |
/// | `rows` | out | scalar | inequality rows; may be NULL |
/// | `eqs` | out | scalar | equality rows; may be NULL |
///
/// # Safety
/// Every pointer is NULL or has room for one number.
#[no_mangle]
pub unsafe extern "C" fn feti_counts(
    p: *mut feti_problem,
    bodies: *mut i64,
    dofs: *mut i64,
    rows: *mut i64,
    eqs: *mut i64,
) -> i32 {
    enter(p, call!(feti_counts(p, bodies, dofs, rows, eqs)), |problem| {
        // SAFETY: NULL or room for one number guaranteed by the caller.
        let outputs = unsafe {
            [
                Output::optional(bodies, 1, "bodies")?,
                Output::optional(dofs, 1, "dofs")?,
                Output::optional(rows, 1, "rows")?,
                Output::optional(eqs, 1, "eqs")?,
            ]
        };
        let counts = problem.sizes();
        let numbers = [counts.bodies, counts.dofs, counts.rows, counts.equalities];
        for (output, number) in outputs.iter().zip(numbers) {
            output.set(number as i64);
        }
        Ok(())
    })
}

/// Reads how many nodes with friction the problem has now, and how many tangential rows each of them has.
///
/// Also right after feti_problem_read: these are the sizes of the arrays of nodes, such as those of feti_friction_slips
/// and feti_friction_states.
///
/// | argument | in/out | shape | rule |
/// |---|---|---|---|
/// | `p` | in | scalar | the handle |
/// | `nodes` | out | scalar | nodes with friction; may be NULL |
/// | `dim` | out | scalar | tangential rows of a node, 1 or 2, 0 without nodes; may be NULL |
///
/// # Safety
/// Every pointer is NULL or has room for one number.
#[no_mangle]
pub unsafe extern "C" fn feti_friction_counts(p: *mut feti_problem, nodes: *mut i64, dim: *mut i32) -> i32 {
    enter(p, call!(feti_friction_counts(p, nodes, dim)), |problem| {
        // SAFETY: NULL or room for one number guaranteed by the caller.
        let (nodes, dim) =
            unsafe { (Output::optional(nodes, 1, "nodes")?, Output::optional(dim, 1, "dim")?) };
        let counts = problem.sizes();
        nodes.set(counts.nodes as i64);
        dim.set(counts.dim as i32);
        Ok(())
    })
}

const ROWS: &str = "the number of rows is";

/// Copies `values` to the host; `size` = (name, text): the number given by the host, which must be their number.
///
/// # Safety
/// `to` has room for `given` numbers.
unsafe fn copy<T: Copy>(
    values: &[T],
    given: i64,
    size: (&'static str, &str),
    to: *mut T,
    name: &'static str,
) -> Result<()> {
    let len = same(given, values.len(), size.0, size.1)?;
    // SAFETY: guaranteed by the caller.
    unsafe { Output::new(to, len, name) }?.write(values);
    Ok(())
}
