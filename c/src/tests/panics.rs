//! Panics of the library, at every possible place of a call: each becomes FETI_INTERNAL, affects only this problem, and
//! prints nothing.

use std::ptr::{null, null_mut};

use super::{assert_all, last_detail, last_error, string, Owned};
use crate::boundary::{call, enter, enter_with_status, without_problem};
use crate::*;
use feti_contact::error::Result;
use feti_contact::platform::threads::{run as run_on_pool, run_heard, Tasks};
use feti_contact::solver::{Listener, Reply};

const INJECTED: &str = "injected by a test";
const NINE: Tasks = Tasks { threads: 2, order: &[0, 1, 2, 3, 4, 5, 6, 7, 8], on_caller: &|_| false };

/// Two unknowns, held: K = (2 -1; -1 2), f = (1, 0), row u_0 <= 0.1.
fn solvable() -> Owned {
    let p = Owned::with_body();
    let (k, row_ptr, dof) = ([2.0, -1.0, -1.0, 2.0], [0, 1], [0]);
    // SAFETY: shapes as said.
    unsafe {
        assert_eq!(feti_body_stiffness_dense(p.0, 0, 2, k.as_ptr(), 2, FETI_FULL, FETI_COPY), FETI_OK);
        assert_eq!(feti_body_null_space(p.0, 0, 0, 2, null(), 2, FETI_EXACT), FETI_OK);
        let (row_ptr, dof, one, gap) = (row_ptr.as_ptr(), dof.as_ptr(), [1.0], [0.1]);
        let (val, rhs) = (one.as_ptr(), gap.as_ptr());
        let kind = FETI_INEQUALITY;
        assert_eq!(feti_rows_add_i32(p.0, kind, 1, row_ptr, null(), dof, val, 0, rhs, null_mut()), FETI_OK);
    }
    assert_eq!(p.load(&[1.0, 0.0]), FETI_OK);
    assert_eq!(p.set(c"threads", 2), FETI_OK);
    p
}

/// By hand: u_0 = 0.1, u_1 = 0.05, lambda = 1 - 2 u_0 + u_1.
fn assert_solves(p: &Owned) {
    let (mut u, mut lambda) = ([0.0; 2], [0.0]);
    // SAFETY: room for as many numbers as said.
    unsafe {
        assert_eq!(feti_solve(p.0, null_mut()), FETI_OK);
        assert_eq!(feti_displacement(p.0, 0, 2, u.as_mut_ptr()), FETI_OK);
        assert_eq!(feti_multipliers(p.0, FETI_INEQUALITY, 1, lambda.as_mut_ptr()), FETI_OK);
    }
    assert!((u[0] - 0.1).abs() + (u[1] - 0.05).abs() + (lambda[0] - 0.85).abs() < 1e-12, "{u:?} {lambda:?}");
}

/// A call of the given name that runs `work`.
fn inside(p: *mut feti_problem, work: impl FnOnce() -> Result<()>) -> i32 {
    enter(p, call!(feti_setup(p)), |_| work())
}

/// A progress function that panics in the given phase.
fn listener(phase_of_setup: bool) -> Listener {
    Box::new(
        move |now| if now.step.is_none() == phase_of_setup { panic!("{INJECTED}") } else { Reply::Continue },
    )
}

fn solve_heard_by(p: *mut feti_problem, phase_of_setup: bool) -> i32 {
    let given = enter(p, call!(feti_setup(p)), |problem| {
        problem.on_progress(Some(listener(phase_of_setup)));
        Ok(())
    });
    assert_eq!(given, FETI_OK);
    // SAFETY: `info` may be NULL.
    unsafe { feti_solve(p, null_mut()) }
}

type Injection = fn(*mut feti_problem) -> i32;

/// Every place of a call in which the library may panic.
const INJECTIONS: [(&str, Injection); 7] = [
    ("a call", |p| inside(p, || panic!("{INJECTED}"))),
    ("a call with a status", |p| {
        enter_with_status(p, call!(feti_setup(p)), |_| -> Result<i32> { panic!("{INJECTED}") })
    }),
    ("a thread of the pool", |p| {
        inside(p, || run_on_pool(2, 9, |k| if k == 4 { panic!("{INJECTED}") } else { Ok(()) }).map(|_| ()))
    }),
    ("a thread of the pool, heard", |p| {
        inside(p, || run_heard(NINE, |k| if k == 4 { panic!("{INJECTED}") } else { Ok(()) }, &mut |_| ()))
    }),
    ("the thread that hears", |p| inside(p, || run_heard(NINE, Ok, &mut |_| panic!("{INJECTED}")))),
    ("the boundary of a progress function in the setup", |p| solve_heard_by(p, true)),
    ("the boundary of a progress function in the solve", |p| solve_heard_by(p, false)),
];

#[test]
fn a_panic_anywhere_in_a_call_is_a_status_on_this_problem_alone() {
    let other = solvable();
    for (place, inject) in INJECTIONS {
        let mut p = solvable();
        assert_eq!(inject(p.0), FETI_INTERNAL, "{place}");
        assert!(last_error().contains(INJECTED), "{place}: {}", last_error());
        assert!(["feti_setup", "feti_solve"].contains(&string(&last_detail().function).as_str()), "{place}");
        let text = p.error();
        assert_eq!(text, last_error(), "{place}");
        let answers = |name: &str| if name == "feti_problem_error" { FETI_OK } else { FETI_INTERNAL };
        assert_all(p.0, answers);
        assert_eq!(p.error(), text, "{place}: the problem keeps the error that broke it");
        assert_solves(&other);
        assert_solves(&solvable());
        // SAFETY: leads to a pointer.
        assert_eq!(unsafe { feti_problem_destroy(&mut p.0) }, FETI_OK, "{place}");
    }
}

#[test]
fn a_panic_in_a_call_without_a_problem_is_a_status() {
    let k = 0;
    assert_eq!(without_problem(call!(feti_option_at(k)), || panic!("{INJECTED}")), FETI_INTERNAL);
    assert!(
        last_error().starts_with("feti_option_at: ") && last_error().contains(INJECTED),
        "{}",
        last_error()
    );
    assert_solves(&solvable());
}

#[test]
fn problems_on_other_threads_solve_on_while_one_panics() {
    let solving = std::thread::spawn(|| (0..50).for_each(|_| assert_solves(&solvable())));
    for (place, inject) in INJECTIONS.iter().cycle().take(50) {
        assert_eq!(inject(solvable().0), FETI_INTERNAL, "{place}");
    }
    solving.join().unwrap();
}

/// Run by the test below, in a separate process.
#[test]
#[ignore = "run by the test below, in a process of its own"]
fn every_panic_once() {
    for (place, inject) in INJECTIONS {
        assert_eq!(inject(solvable().0), FETI_INTERNAL, "{place}");
    }
}

#[test]
fn no_panic_prints_anything() {
    let test = std::env::current_exe().unwrap();
    let name = format!("{}::every_panic_once", module_path!().split_once("::").unwrap().1);
    let mut child = std::process::Command::new(test);
    let output = child.args([&name, "--exact", "--ignored", "--nocapture"]).output().unwrap();
    let printed =
        format!("{}{}", String::from_utf8_lossy(&output.stdout), String::from_utf8_lossy(&output.stderr));
    assert!(output.status.success() && printed.contains("1 passed"), "{printed}");
    assert!(!printed.contains(INJECTED) && !printed.contains("panicked"), "{printed}");
}

#[test]
fn after_a_panic_only_destroy_and_the_error_functions_work_and_other_problems_do() {
    let (mut broken, other) = (Owned::with_body(), Owned::with_body());
    assert_eq!(broken.set(c"fault_injection", 1), FETI_OK);
    // SAFETY: `info` may be NULL.
    assert_eq!(unsafe { feti_solve(broken.0, null_mut()) }, FETI_INTERNAL);
    assert!(last_error().contains("fault injected on request"));
    assert_eq!(broken.error(), last_error());
    let first = broken.error();
    assert_all(broken.0, |function| if function == "feti_problem_error" { FETI_OK } else { FETI_INTERNAL });
    assert_eq!(broken.error(), first, "the problem keeps the error that broke it");
    assert_eq!(other.load(&[1.0, 2.0]), FETI_OK);
    // SAFETY: leads to a pointer.
    assert_eq!(unsafe { feti_problem_destroy(&mut broken.0) }, FETI_OK);
}
