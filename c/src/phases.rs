//! The time and the memory of the phases of a call.

use crate::boundary::{call, enter, entry_at, OutStruct, Output};
use crate::header::types::{feti_phase, feti_problem};

/// Number of phases of a setup and a solve.
///
/// | argument | in/out | shape | rule |
/// |---|---|---|---|
/// | `p` | in | scalar | the handle |
/// | `count` | out | scalar | the number of phases |
///
/// # Safety
/// `count` has room for one number.
#[no_mangle]
pub unsafe extern "C" fn feti_phase_count(p: *mut feti_problem, count: *mut i64) -> i32 {
    enter(p, call!(feti_phase_count(p, count)), |problem| {
        // SAFETY: the caller gives room for one number.
        unsafe { Output::new(count, 1, "count") }?.set(problem.phases().len() as i64);
        Ok(())
    })
}

/// Reads time and memory of a phase. The phases are rows, null spaces, analysis, factorisation, dual operators,
/// preconditioner, dual solve, recovery, in this order.
///
/// The times refer to the last setup or solve, even if it failed; a phase without work has time zero. Later solves do
/// not repeat what a setup keeps.
///
/// | argument | in/out | shape | rule |
/// |---|---|---|---|
/// | `p` | in | scalar | the handle |
/// | `k` | in | scalar | from 0, less than feti_phase_count |
/// | `out` | in/out | scalar | `struct_size` set, at least 16 |
///
/// # Safety
/// `out` points to `struct_size` writable bytes.
#[no_mangle]
pub unsafe extern "C" fn feti_phase_at(p: *mut feti_problem, k: i64, out: *mut feti_phase) -> i32 {
    enter(p, call!(feti_phase_at(p, k, out)), |problem| {
        let phases = problem.phases();
        let phase = entry_at(&phases, k, "phases")?;
        // SAFETY: the caller gives `struct_size` bytes.
        unsafe { OutStruct::new(out, "out") }?.write(&feti_phase {
            struct_size: size_of::<feti_phase>() as i64,
            bytes: phase.bytes as i64,
            seconds: phase.seconds,
            name: phase.name.as_ptr(),
        });
        Ok(())
    })
}
