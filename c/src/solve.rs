//! Setup, solve, and the verdict on an answer.

use crate::boundary::{call, caught, enter, enter_with_status, finite_input, known, same, OutStruct};
use crate::friction::all_nodes;
use crate::header::status::of_outcome;
use crate::header::types::{feti_certificate, feti_info, feti_problem};
use crate::ranks::count_of;
use feti_contact::error::Result;
use feti_contact::solver::{Call, Candidate, Certificate, Entry, Problem, Report, Sizes, Traffic};

/// Prepares the solve: null spaces, factors of the bodies, the dual operator.
///
/// Collective: all ranks that have a part of the problem make the call (feti_communicator_set).
///
/// feti_solve calls this function when necessary; called alone, it finds errors in the bodies early.
///
/// FETI_STATE if there is no body, or a body without a matrix; FETI_NULL_SPACE if the null space of a body is not the one
/// that was given, or cannot be found; FETI_INDEFINITE if a matrix is indefinite, with body, unknown and pivot or
/// diagonal entry in the error detail; FETI_GAPS_CONTRADICT if a row without entries has a right-hand side that 0 does not satisfy;
/// FETI_CALLBACK if a function of the host fails or violates its requirements (feti_body_operator); FETI_UNSUPPORTED if
/// fixing unknowns were given for a body with functions of the host instead of a matrix; FETI_OVERFLOW if the square of a
/// row, or a compliance times the largest K_ii, overflows or underflows; FETI_CANCELLED if the host has cancelled.
///
/// | argument | in/out | shape | rule |
/// |---|---|---|---|
/// | `p` | in | scalar | the handle |
#[no_mangle]
pub extern "C" fn feti_setup(p: *mut feti_problem) -> i32 {
    enter(p, call!(feti_setup(p)), |problem| {
        let _room = problem.checked_together(Call::Setup, Problem::working_headroom)?;
        problem.setup()
    })
}

/// Minimises 1/2 u'Ku - f'u subject to `B u <= c` and `H u = h`.
///
/// Collective: all ranks that have a part of the problem make the call (feti_communicator_set); status and `info` are those of all.
///
/// The answer is kept until the next solve; read it with feti_displacement, feti_multipliers and the other functions
/// for results. An answer exists if the status is not negative, unless the call was cancelled or ran out of time before
/// the first step. `info` is written in any case, with NaN for values that are unknown after a failure. If rows and
/// loads leave motions undetermined (`undetermined`), the answer is the admissible one nearest to rest: the one with
/// the least sum of `K_ii u_i^2`.
///
/// Groups of bodies that are not joined by a row with a finite gap are separate problems. Each group is solved to its own
/// accuracy, several at a time if threads are available. The function returns the worst status of all groups; counts and
/// energies are summed, and every entry of the certificate is the one of the worst group. If a group has no answer
/// because its load is not held or its rows contradict each other, the status, feti_last_error and feti_diagnosis
/// describe the first such group. The other groups keep their answers, and `info` describes them. Reading a result of one
/// body in a group without an answer returns FETI_STATE; reading results of all bodies or rows at once gives NaN for such
/// a group, and feti_active gives FETI_ROW_UNKNOWN.
///
/// A status above 0 comes with an answer, unless the call ended before the first step. FETI_ITERATIONS at the limit of
/// option max_steps; FETI_TIME at the limit of option time_limit, which counts from the call and includes a setup that is
/// due; FETI_CANCELLED if the host has cancelled; FETI_STALLED if steps no longer reduce the error; FETI_INACCURATE if
/// the certificate does not pass; FETI_MARGINAL if a part of the load, below 1e-7 of it, is not held, or a body moves far
/// beyond its deformation (the log names it). With a status below 0 the group of bodies concerned has no answer.
/// FETI_LOAD_NOT_HELD if no forces of the rows, friction included, balance the load; FETI_SLIDES if such forces exist, but bodies slide, and no
/// equilibrium was found; FETI_GAPS_CONTRADICT if rows contradict each other; FETI_INDEFINITE if K has negative stiffness along a motion that closed rows do not stop. feti_diagnosis has the proof of
/// each. The call runs feti_setup when it is due, and then fails for the same reasons.
///
/// | argument | in/out | shape | rule |
/// |---|---|---|---|
/// | `p` | in | scalar | the handle |
/// | `info` | in/out | scalar | `struct_size` set, at least 16; may be NULL |
///
/// # Safety
/// `info` is NULL or points to `struct_size` writable bytes.
#[no_mangle]
pub unsafe extern "C" fn feti_solve(p: *mut feti_problem, info: *mut feti_info) -> i32 {
    // SAFETY: NULL, or `struct_size` bytes guaranteed by the caller.
    let target = (!info.is_null()).then(|| unsafe { OutStruct::new(info, "info") }).transpose();
    let (mut sizes, mut found, mut ranks) = (Sizes::default(), None, None);
    let status = enter_with_status(p, call!(feti_solve(p, info)), |problem| {
        sizes = problem.sizes();
        ranks = Some((count_of(p), problem.traffic(), problem.seconds_leading()));
        let _room = problem.checked_together(Call::Solve, |problem| {
            target.as_ref().map_err(Clone::clone)?;
            caught(|| may_fail(problem))?;
            problem.working_headroom()
        })?;
        let solved = problem.solve();
        sizes = problem.sizes_of_all();
        // if one group of bodies has no answer, others may have one
        found = problem.report().cloned();
        ranks = Some((count_of(p), problem.traffic(), problem.seconds_leading()));
        solved.map(|report| of_outcome(&report.outcome))
    });
    if let Ok(Some(target)) = target {
        target.write(&info_of(status, sizes, found.as_ref(), ranks));
    }
    status
}

/// Panics if the host has asked for it.
fn may_fail(problem: &Problem) -> Result<()> {
    match problem.settings().fault_injection {
        1 => panic!("fault injected on request"),
        _ => Ok(()),
    }
}

/// Verifies an answer without tangential forces against the current problem; the answer may come from another program.
///
/// Collective: all ranks that have a part of the problem make the call (feti_communicator_set), each with the answer on its own.
///
/// Every entry belongs to the worst body or the worst row, measured against its own forces and deformation; the
/// certificate names this body or row. Glue (option glue) is judged like equality rows; its forces are not an argument,
/// and the library uses the glue forces that fit the answer best. Rows that never close, c = +infinity, are left out,
/// and their lambda counts as 0. At nodes with friction (feti_friction_add_i32 or _i64) the tangential force counts as
/// 0; feti_check_friction takes tangential forces into account. The call does not store the answer; the answer of the
/// last solve is kept. Runs feti_setup when it is due, because it needs the null spaces.
///
/// | argument | in/out | shape | rule |
/// |---|---|---|---|
/// | `p` | in | scalar | the handle |
/// | `n` | in | scalar | unknowns of all bodies |
/// | `u` | in | n | displacement, body after body, length |
/// | `rows` | in | scalar | number of inequality rows |
/// | `lambda` | in | rows | multipliers of `B u <= c`, force |
/// | `eqs` | in | scalar | number of equality rows |
/// | `mu` | in | eqs | multipliers of `H u = h`, force |
/// | `out` | in/out | scalar | `struct_size` set, at least 16 |
///
/// # Safety
/// The arrays have the given shapes, `out` points to `struct_size` writable bytes.
#[no_mangle]
pub unsafe extern "C" fn feti_check(
    p: *mut feti_problem,
    n: i64,
    u: *const f64,
    rows: i64,
    lambda: *const f64,
    eqs: i64,
    mu: *const f64,
    out: *mut feti_certificate,
) -> i32 {
    enter(p, call!(feti_check(p, n, u, rows, lambda, eqs, mu, out)), |problem| {
        let ((u, lambda, mu), target, _room) = problem.checked_together(Call::Check, |problem| {
            // SAFETY: shapes guaranteed by the caller.
            let answer = unsafe { answer_to_check(problem, (n, u), (rows, lambda), (eqs, mu)) }?;
            // SAFETY: `struct_size` bytes guaranteed by the caller.
            let target = unsafe { OutStruct::new(out, "out") }?;
            Ok((answer, target, problem.working_headroom()?))
        })?;
        let found = problem.check(u, lambda, mu)?;
        target.write(&certificate(problem, &found));
        Ok(())
    })
}

/// Verifies an answer with tangential forces against the current problem; the answer may come from another program.
///
/// Collective: all ranks that have a part of the problem make the call (feti_communicator_set), each with the answer on its own.
///
/// The call works like feti_check. In addition, the entries of friction judge at every node the force lambda_t against
/// the friction law and the slip `T u - s_old - C_t lambda_t` with the current s_old, which after feti_friction_commit
/// is that of the next step. Nodes that cannot carry a tangential force (bound 0 and no contact row that may close) are
/// left out.
///
/// | argument | in/out | shape | rule |
/// |---|---|---|---|
/// | `p` | in | scalar | the handle |
/// | `n` | in | scalar | unknowns of all bodies |
/// | `u` | in | n | displacement, body after body, length |
/// | `rows` | in | scalar | number of inequality rows |
/// | `lambda` | in | rows | multipliers of `B u <= c`, force |
/// | `eqs` | in | scalar | number of equality rows |
/// | `mu` | in | eqs | multipliers of `H u = h`, force |
/// | `nodes` | in | scalar | number of nodes with friction |
/// | `dim` | in | scalar | tangential rows of a node, 1 or 2; ignored if there are no nodes |
/// | `lambda_t` | in | dim * nodes | multipliers of the tangential rows, node after node, force |
/// | `out` | in/out | scalar | `struct_size` set, at least 16 |
///
/// # Safety
/// The arrays have the given shapes, `out` points to `struct_size` writable bytes.
#[no_mangle]
pub unsafe extern "C" fn feti_check_friction(
    p: *mut feti_problem,
    n: i64,
    u: *const f64,
    rows: i64,
    lambda: *const f64,
    eqs: i64,
    mu: *const f64,
    nodes: i64,
    dim: i32,
    lambda_t: *const f64,
    out: *mut feti_certificate,
) -> i32 {
    let call = call!(feti_check_friction(p, n, u, rows, lambda, eqs, mu, nodes, dim, lambda_t, out));
    enter(p, call, |problem| {
        let ((u, lambda, mu), tangential, target, _room) =
            problem.checked_together(Call::Check, |problem| {
                // SAFETY: shapes guaranteed by the caller.
                let answer = unsafe { answer_to_check(problem, (n, u), (rows, lambda), (eqs, mu)) }?;
                let len = all_nodes(problem, nodes, dim)?;
                // SAFETY: dim numbers for each node guaranteed by the caller.
                let tangential = unsafe { finite_input(lambda_t, len, "lambda_t") }?;
                // SAFETY: `struct_size` bytes guaranteed by the caller.
                let target = unsafe { OutStruct::new(out, "out") }?;
                Ok((answer, tangential, target, problem.working_headroom()?))
            })?;
        let found = problem.check_with_friction(Candidate { u, lambda, mu, tangential })?;
        target.write(&certificate(problem, &found));
        Ok(())
    })
}

/// Displacement and multipliers of contact and equality rows, with their sizes.
///
/// # Safety
/// The arrays have as many numbers as said.
unsafe fn answer_to_check<'a>(
    problem: &Problem,
    (n, u): (i64, *const f64),
    (rows, lambda): (i64, *const f64),
    (eqs, mu): (i64, *const f64),
) -> Result<(&'a [f64], &'a [f64], &'a [f64])> {
    let counts = problem.sizes();
    let n = same(n, counts.dofs, "n", "the number of unknowns of all bodies is")?;
    let rows = same(rows, counts.rows, "rows", "the number of inequality rows is")?;
    let eqs = same(eqs, counts.equalities, "eqs", "the number of equality rows is")?;
    // SAFETY: shapes guaranteed by the caller.
    unsafe {
        Ok((finite_input(u, n, "u")?, finite_input(lambda, rows, "lambda")?, finite_input(mu, eqs, "mu")?))
    }
}

/// The result of a solve from its report; without a report counts are zero and values NaN.
fn info_of(
    status: i32,
    sizes: Sizes,
    report: Option<&Report>,
    ranks: Option<(usize, Traffic, Option<f64>)>,
) -> feti_info {
    let count = |of: fn(&Report) -> usize| report.map_or(0, |report| of(report) as i64);
    let figure = |of: fn(&Report) -> f64| report.map_or(f64::NAN, of);
    feti_info {
        struct_size: size_of::<feti_info>() as i64,
        status,
        reserved: 0,
        bodies: sizes.bodies as i64,
        dofs: sizes.dofs as i64,
        rows: sizes.rows as i64,
        equalities: sizes.equalities as i64,
        floating_modes: count(|report| report.floating_modes),
        active: count(|report| report.active),
        undetermined: count(|report| report.undetermined),
        steps: count(|report| report.counts.steps()),
        cg_steps: count(|report| report.counts.conjugate_gradient),
        expansions: count(|report| report.counts.expansions),
        releases: count(|report| report.counts.releases),
        dual_applications: count(|report| report.counts.products),
        coarse_solves: count(|report| report.counts.coarse_solves),
        factorisations: count(|report| report.work.factorisations),
        analyses: count(|report| report.work.analyses),
        worst: figure(|report| report.certificate.worst()),
        equilibrium: figure(|report| report.certificate.equilibrium.figure),
        balance: figure(|report| report.certificate.balance.figure),
        penetration: figure(|report| report.certificate.penetration.figure),
        equality: figure(|report| report.certificate.equality.figure),
        negative_force: figure(|report| report.certificate.negative_force.figure),
        complementarity: figure(|report| report.certificate.complementarity.figure),
        duality_gap: figure(|report| report.certificate.duality_gap.figure),
        energy: figure(|report| report.energy),
        seconds_setup: figure(|report| report.seconds_setup),
        seconds_solve: figure(|report| report.seconds_solve),
        direct_solves: count(|report| report.counts.direct),
        finished: count(|report| usize::from(report.finished)),
        columns_computed: count(|report| report.work.columns_computed),
        columns_kept: count(|report| report.work.columns_kept),
        explicit_operators: count(|report| report.explicit_operators),
        implicit_operators: count(|report| report.implicit_operators),
        factor_bytes: count(|report| report.factor_bytes),
        operator_bytes: count(|report| report.operator_bytes),
        friction_cone: figure(|report| report.certificate.friction_cone.figure),
        friction_work: figure(|report| report.certificate.friction_work.figure),
        friction_stick: figure(|report| report.certificate.friction_stick.figure),
        nodes: sizes.nodes as i64,
        sticking: count(|report| report.sticking),
        slipping: count(|report| report.slipping),
        friction_steps: count(|report| report.newton),
        friction_starts: count(|report| report.starts),
        ranks: ranks.map_or(0, |(count, ..)| count as i64),
        messages: ranks.map_or(0, |(_, traffic, _)| traffic.messages as i64),
        message_bytes: ranks.map_or(0, |(_, traffic, _)| traffic.bytes as i64),
        seconds_waited: ranks.map_or(f64::NAN, |(_, traffic, _)| traffic.seconds_waited),
        seconds_leading: ranks.and_then(|(.., leading)| leading).unwrap_or(f64::NAN),
    }
}

fn certificate(problem: &Problem, from: &Certificate) -> feti_certificate {
    let pair = problem.worst_pair(from);
    let rank = |entry: &Entry| known(entry.place.map(|_| entry.rank));
    feti_certificate {
        struct_size: size_of::<feti_certificate>() as i64,
        passed: i32::from(from.passed()),
        reserved: 0,
        limit: from.limit,
        worst: from.worst(),
        equilibrium: from.equilibrium.figure,
        balance: from.balance.figure,
        penetration: from.penetration.figure,
        equality: from.equality.figure,
        negative_force: from.negative_force.figure,
        complementarity: from.complementarity.figure,
        duality_gap: from.duality_gap.figure,
        equilibrium_body: known(from.equilibrium.place),
        balance_body: known(from.balance.place),
        penetration_row: known(from.penetration.place),
        equality_row: known(from.equality.place),
        force_row: known(from.negative_force.place),
        complementarity_row: known(from.complementarity.place),
        friction_cone: from.friction_cone.figure,
        friction_work: from.friction_work.figure,
        friction_stick: from.friction_stick.figure,
        friction_cone_node: known(from.friction_cone.place),
        friction_work_node: known(from.friction_work.place),
        friction_stick_node: known(from.friction_stick.place),
        equilibrium_rank: rank(&from.equilibrium),
        balance_rank: rank(&from.balance),
        penetration_rank: rank(&from.penetration),
        equality_rank: rank(&from.equality),
        force_rank: rank(&from.negative_force),
        complementarity_rank: rank(&from.complementarity),
        friction_cone_rank: rank(&from.friction_cone),
        friction_work_rank: rank(&from.friction_work),
        friction_stick_rank: rank(&from.friction_stick),
        pair: known(pair.map(|(pair, _)| pair)),
        pair_node: known(pair.map(|(_, node)| node)),
    }
}
