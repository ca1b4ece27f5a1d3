//! Why there is no solution, and what an answer leaves undetermined.

use crate::bodies::body_of_order;
use crate::boundary::{call, count, enter, known, OutStruct, Output};
use crate::header::status::{of_kind, of_outcome};
use crate::header::types::{feti_findings, feti_problem, FETI_EQUALITY, FETI_INEQUALITY};
use crate::rows::row_kind;
use feti_contact::solver::{Call, Findings, RowKind};

/// Reads what the last solve, or the last failed setup, found out about the problem.
///
/// After FETI_LOAD_NOT_HELD: the body that escapes, its motion and the margin. After FETI_SLIDES: the body that slides,
/// its motion and the capacity of friction. After FETI_GAPS_CONTRADICT: the rows that contradict each other. If several
/// groups of bodies have no answer, the findings describe the first of them. After FETI_INDEFINITE, FETI_NULL_SPACE and
/// similar statuses: the body and the unknown. With an answer: undetermined motions, redundant rows, and bodies that no
/// row touches. The findings are kept until the next solve or the next failed setup. FETI_STATE before the first solve
/// or failed setup.
///
/// | argument | in/out | shape | rule |
/// |---|---|---|---|
/// | `p` | in | scalar | the handle |
/// | `out` | in/out | scalar | `struct_size` set, at least 16 |
///
/// # Safety
/// `out` points to `struct_size` writable bytes.
#[no_mangle]
pub unsafe extern "C" fn feti_diagnosis(p: *mut feti_problem, out: *mut feti_findings) -> i32 {
    enter(p, call!(feti_diagnosis(p, out)), |problem| {
        // SAFETY: the caller gives `struct_size` bytes.
        let target = unsafe { OutStruct::new(out, "out") }?;
        target.write(&described(problem.findings()?));
        Ok(())
    })
}

/// Lists the rows of one kind that contradict each other, with their weights, or without a contradiction the redundant
/// rows.
///
/// The weights w, scaled to a largest weight of 1, prove a contradiction: over the rows b of both kinds the sum of w b
/// is 0 and the sum of w c is negative, with w > 0 for inequalities. If unknowns with the same number are glued (option
/// glue), the sum of w b is 0 for each number, and feti_last_error names some of these numbers. The weight of a
/// redundant row is its factor relative to the row that it repeats. FETI_STATE before the first solve.
///
/// | argument | in/out | shape | rule |
/// |---|---|---|---|
/// | `p` | in | scalar | the handle |
/// | `kind` | in | scalar | FETI_INEQUALITY or FETI_EQUALITY |
/// | `cap` | in | scalar | capacity of `row` and `weight` |
/// | `count` | out | scalar | number of rows found; as many as fit are written |
/// | `row` | out | cap | numbers from 0, ascending; may be NULL |
/// | `weight` | out | cap | no unit; may be NULL |
///
/// # Safety
/// `count` has room for one number, `row` and `weight` are NULL or have room for `cap` numbers.
#[no_mangle]
pub unsafe extern "C" fn feti_diagnosis_rows(
    p: *mut feti_problem,
    kind: i32,
    cap: i64,
    count: *mut i64,
    row: *mut i64,
    weight: *mut f64,
) -> i32 {
    enter(p, call!(feti_diagnosis_rows(p, kind, cap, count, row, weight)), |problem| {
        let kind = row_kind(kind, "which neither contradict nor repeat each other")?;
        let cap = self::count(cap, "cap")?;
        // SAFETY: the caller gives room for one number, and for `cap` numbers or NULL.
        let (number, rows, weights) = unsafe {
            (
                Output::new(count, 1, "count")?,
                Output::optional(row, cap, "row")?,
                Output::optional(weight, cap, "weight")?,
            )
        };
        let findings = problem.findings()?;
        number.set(findings.rows(kind).count() as i64);
        for (k, (row, weight)) in findings.rows(kind).take(cap).enumerate() {
            rows.write_at(k, &[row as i64]);
            weights.write_at(k, &[weight]);
        }
        Ok(())
    })
}

/// Lists the equality rows that are linear combinations of the other equality rows; this call computes them.
///
/// Collective: all ranks that have a part of the problem make the call (feti_communicator_set); each gets its own rows.
///
/// These rows add no constraint, and the distribution of forces among them is not unique. feti_diagnosis_rows lists the
/// rows that repeat another row. FETI_STATE before the first setup.
///
/// | argument | in/out | shape | rule |
/// |---|---|---|---|
/// | `p` | in | scalar | the handle |
/// | `cap` | in | scalar | capacity of `row` |
/// | `count` | out | scalar | number of rows found; as many as fit are written |
/// | `row` | out | cap | numbers from 0, ascending; may be NULL |
///
/// # Safety
/// `count` has room for one number, `row` is NULL or has room for `cap` numbers.
#[no_mangle]
pub unsafe extern "C" fn feti_diagnosis_dependent(
    p: *mut feti_problem,
    cap: i64,
    count: *mut i64,
    row: *mut i64,
) -> i32 {
    enter(p, call!(feti_diagnosis_dependent(p, cap, count, row)), |problem| {
        let list = problem.checked_together(Call::Dependent, |_| {
            let cap = self::count(cap, "cap")?;
            // SAFETY: the caller gives room for one number, and for `cap` numbers or NULL.
            Ok(unsafe { (Output::new(count, 1, "count")?, Output::optional(row, cap, "row")?) })
        })?;
        write_list(&problem.dependent_equalities()?, list);
        Ok(())
    })
}

/// Lists the bodies that no row touched in the last solve, or in the last failed setup.
///
/// Rows that never close, c = +infinity, do not count. FETI_STATE before the first solve.
///
/// | argument | in/out | shape | rule |
/// |---|---|---|---|
/// | `p` | in | scalar | the handle |
/// | `cap` | in | scalar | capacity of `body` |
/// | `count` | out | scalar | number of bodies found; as many as fit are written |
/// | `body` | out | cap | numbers from 0, ascending; may be NULL |
///
/// # Safety
/// `count` has room for one number, `body` is NULL or has room for `cap` numbers.
#[no_mangle]
pub unsafe extern "C" fn feti_diagnosis_untouched(
    p: *mut feti_problem,
    cap: i64,
    count: *mut i64,
    body: *mut i64,
) -> i32 {
    enter(p, call!(feti_diagnosis_untouched(p, cap, count, body)), |problem| {
        let cap = self::count(cap, "cap")?;
        // SAFETY: the caller gives room for one number, and for `cap` numbers or NULL.
        let list = unsafe { (Output::new(count, 1, "count")?, Output::optional(body, cap, "body")?) };
        write_list(&problem.findings()?.untouched, list);
        Ok(())
    })
}

/// Writes the number of entries, and as many entries as fit.
fn write_list(numbers: &[usize], (count, list): (Output<i64>, Output<i64>)) {
    count.set(numbers.len() as i64);
    numbers.iter().enumerate().for_each(|(k, &number)| list.write_at(k, &[number as i64]));
}

/// Reads a rigid body motion that the last answer leaves undetermined: the body and its motion.
///
/// Collective: all ranks that have a part of the problem make the call (feti_communicator_set), with the same `k`; where another rank has
/// the body, `body` is -1 and `motion` NaN.
///
/// `undetermined` of feti_findings is the number of these motions. Bodies that are not connected appear in separate
/// motions. FETI_STATE without an answer.
///
/// | argument | in/out | shape | rule |
/// |---|---|---|---|
/// | `p` | in | scalar | the handle |
/// | `k` | in | scalar | number of the motion, from 0 |
/// | `body` | out | scalar | number of the body that moves fastest, from 0; may be NULL |
/// | `motion` | out | 6 | motion of this body: velocity of the origin, rotation about the axes; NaN without coordinates; may be NULL |
///
/// # Safety
/// The arrays have the given shapes.
#[no_mangle]
pub unsafe extern "C" fn feti_diagnosis_undetermined(
    p: *mut feti_problem,
    k: i64,
    body: *mut i64,
    motion: *mut f64,
) -> i32 {
    enter(p, call!(feti_diagnosis_undetermined(p, k, body, motion)), |problem| {
        let (k, fastest, motion) = problem.checked_together(Call::OpenMotion, |_| {
            // SAFETY: room guaranteed by the caller.
            let (fastest, motion) =
                unsafe { (Output::optional(body, 1, "body")?, Output::optional(motion, 6, "motion")?) };
            Ok((count(k, "k")?, fastest, motion))
        })?;
        let open = problem.open_motion(k)?;
        fastest.write_at(0, &[known(open.body)]);
        motion.write_at(0, &open.motion.unwrap_or([f64::NAN; 6]));
        Ok(())
    })
}

/// Reads the motion of every unknown of a body in a rigid body motion that the last answer leaves undetermined.
///
/// Collective: all ranks that have a part of the problem make the call (feti_communicator_set), with the same `k`.
///
/// The motion is scaled so that its largest entry over all bodies is 1; bodies that do not move have zeros. FETI_STATE
/// without an answer.
///
/// | argument | in/out | shape | rule |
/// |---|---|---|---|
/// | `p` | in | scalar | the handle |
/// | `k` | in | scalar | number of the motion, from 0 |
/// | `body` | in | scalar | number of the body, from 0 |
/// | `n` | in | scalar | unknowns of the body |
/// | `v` | out | n | length, up to a factor |
///
/// # Safety
/// The array has the given shape.
#[no_mangle]
pub unsafe extern "C" fn feti_diagnosis_undetermined_motion(
    p: *mut feti_problem,
    k: i64,
    body: i64,
    n: i64,
    v: *mut f64,
) -> i32 {
    enter(p, call!(feti_diagnosis_undetermined_motion(p, k, body, n, v)), |problem| {
        let (k, place) = problem.checked_together(Call::OpenMotion, |problem| {
            let k = count(k, "k")?;
            // a rank without bodies takes part, and gets nothing
            if n == 0 && problem.sizes().bodies == 0 {
                return Ok((k, None));
            }
            let (body, n) = body_of_order(problem, body, n)?;
            // SAFETY: room for n numbers guaranteed by the caller.
            Ok((k, Some((body, unsafe { Output::new(v, n, "v") }?))))
        })?;
        match place {
            Some((body, to)) => to.write(&problem.open_motion_of(k, body)?),
            None => drop(problem.open_motion(k)?),
        }
        Ok(())
    })
}

/// Reads the motion of every unknown of a body in the rigid body motion that escapes.
///
/// The load does work on this motion, and no row resists it. The motion is scaled so that its largest entry over all
/// bodies is 1; bodies that do not move have zeros. After FETI_SLIDES it is the motion that friction does not hold, and
/// after FETI_INDEFINITE the motion with negative stiffness that closed rows do not stop. FETI_STATE unless the last
/// solve ended with one of these statuses and found a motion.
///
/// | argument | in/out | shape | rule |
/// |---|---|---|---|
/// | `p` | in | scalar | the handle |
/// | `body` | in | scalar | number of the body, from 0 |
/// | `n` | in | scalar | unknowns of the body |
/// | `v` | out | n | length, up to a factor |
///
/// # Safety
/// The array has the given shape.
#[no_mangle]
pub unsafe extern "C" fn feti_diagnosis_motion(p: *mut feti_problem, body: i64, n: i64, v: *mut f64) -> i32 {
    enter(p, call!(feti_diagnosis_motion(p, body, n, v)), |problem| {
        let (body, n) = body_of_order(problem, body, n)?;
        // SAFETY: room for n numbers guaranteed by the caller.
        unsafe { Output::new(v, n, "v") }?.write(problem.escaping_motion(body)?);
        Ok(())
    })
}

fn described(from: &Findings) -> feti_findings {
    feti_findings {
        struct_size: size_of::<feti_findings>() as i64,
        status: match &from.end {
            Ok(outcome) => of_outcome(outcome),
            Err(kind) => of_kind(*kind, &["p", "info"]).0,
        },
        kind: match from.kind {
            None | Some(RowKind::Tangential) => 0,
            Some(RowKind::Inequality) => FETI_INEQUALITY,
            Some(RowKind::Equality) => FETI_EQUALITY,
        },
        body: known(from.place.body),
        component: known(from.place.component),
        dof: known(from.place.dof),
        row: known(from.place.row),
        rows_involved: from.contradicting() as i64,
        undetermined: from.undetermined as i64,
        redundant_rows: from.redundant.len() as i64,
        untouched_bodies: from.untouched.len() as i64,
        untouched_body: known(from.untouched.first().copied()),
        margin: from.margin().unwrap_or(f64::NAN),
        motion: from.motion.unwrap_or([f64::NAN; 6]),
        unheld: from.unheld,
        doubtful_bodies: from.doubtful.len() as i64,
        doubtful_body: known(from.doubtful.first().copied()),
        soft_bodies: from.soft.len() as i64,
        soft_body: known(from.soft.first().copied()),
        capacity: from.capacity.unwrap_or(f64::NAN),
        rank: known(from.place.rank),
        pair: known(from.place.pair),
        pair_node: known(from.place.pair.and(from.place.node)),
    }
}
