//! Other ranks of the host: the table of functions that move messages, the problems that have one, and the service of the other ranks.

use std::collections::BTreeMap;
use std::sync::{Arc, Mutex, MutexGuard, PoisonError, Weak};

use crate::boundary::{call, enter, fpu, read_struct, without_end};
use crate::header::types::{
    feti_communicator, feti_flush_fn, feti_problem, feti_receive_fn, feti_release_fn, feti_send_fn,
};
use crate::progress::User;
use feti_contact::error::{Error, Kind, Result};
use feti_contact::platform::instant;
use feti_contact::solver::{serve, Link, Rank, Ranks};

/// Makes the problem one of several ranks: each may give bodies and rows, and rank 0 may lend bodies to ranks that serve.
///
/// Each rank that has a part of the problem calls this function, before the first body, in the same order on all ranks if
/// there are several problems. It then gives its own bodies and rows, which count from 0 on this rank, and gets results of
/// its own. Rows may name unknowns of other ranks by the host's numbers (feti_body_numbering_i32, `body` = NULL). Setups,
/// solves and checks are collective: all these ranks make them, and get the same status. A rank without a part calls
/// feti_serve instead; if all others serve, rank 0 has the whole model, and calls the library as without other ranks.
/// The answer has the same bits whoever gives what, and on any number of ranks that serve.
///
/// The library copies the table, and calls its functions in collective calls, on the thread that called the library, in the
/// floating-point environment of that thread. It calls feti_communicator.release once when the problem is destroyed, if this
/// call has returned FETI_OK. The functions must not exit by longjmp or an exception, nor call the library for a problem
/// whose table has the same `user`. With one rank it calls none. If bodies have numbers, they and the rows are taken in
/// the order that they have on several ranks.
///
/// FETI_STATE if the problem has a body, a surface or a table already.
///
/// | argument | in/out | shape | rule |
/// |---|---|---|---|
/// | `p` | in | scalar | the handle |
/// | `by` | in | scalar | the table, as feti_communicator describes it |
///
/// # Safety
/// `by` points to `struct_size` readable bytes; its functions may be called with `user` until the problem is destroyed.
#[no_mangle]
pub unsafe extern "C" fn feti_communicator_set(p: *mut feti_problem, by: *const feti_communicator) -> i32 {
    enter(p, call!(feti_communicator_set(p, by)), |problem| {
        // SAFETY: `struct_size` bytes guaranteed by the caller.
        let table = unsafe { Table::read(by) }?;
        if problem.sizes().bodies > 0 {
            return Err(Error::new(Kind::State, "the ranks must be given before the first body"));
        }
        if instant(|| lock(&GIVEN).contains_key(&p.addr())) {
            return Err(Error::new(Kind::State, "the problem has its ranks already"));
        }
        problem.join(match table.functions {
            Some(functions) => stream(&table, functions)?,
            None => Rank::new(Ranks::alone()),
        })?;
        let given = Given { user: table.user, release: table.release, ranks: table.size };
        instant(|| lock(&GIVEN).insert(p.addr(), given));
        Ok(())
    })
}

/// Answers rank 0 for all of its problems (feti_communicator_set), until rank 0 calls this function, too.
///
/// Every rank calls this function once. On ranks other than 0 the call returns when rank 0 makes it. The library calls the
/// functions of the table on the thread that called it, in the floating-point environment of that thread, and does not call
/// feti_communicator.release. On rank 0 all other ranks end their service; problems that have lent bodies to them go on
/// alone. With one rank the call does nothing. A rank that serves uses the CPUs of its process; if these are
/// all CPUs of the machine, it uses its share, one of `local_size`.
///
/// FETI_COMMUNICATION if a function of the table fails, or if another rank runs another build of the library.
///
/// | argument | in/out | shape | rule |
/// |---|---|---|---|
/// | `by` | in | scalar | the table, as feti_communicator describes it |
///
/// # Safety
/// `by` points to `struct_size` readable bytes; its functions may be called with `user` during the call.
#[no_mangle]
pub unsafe extern "C" fn feti_serve(by: *const feti_communicator) -> i32 {
    without_end(call!(feti_serve(by)), || {
        // SAFETY: `struct_size` bytes guaranteed by the caller.
        let table = unsafe { Table::read(by) }?;
        let Some(functions) = table.functions else { return Ok(()) };
        serve(&*stream(&table, functions)?, threads(table.local_size))
    })
}

/// A table whose members have been checked.
struct Table {
    rank: usize,
    size: usize,
    local_size: usize,
    user: User,
    /// None if there is one rank.
    functions: Option<Functions>,
    release: feti_release_fn,
}

/// The functions of the host that move bytes.
#[derive(Clone, Copy)]
struct Functions {
    send: Inside<feti_send_fn>,
    flush: Inside<feti_flush_fn>,
    receive: Inside<feti_receive_fn>,
}

/// The function of a pointer that is not NULL.
type Inside<T> = <T as IntoIterator>::Item;

impl Table {
    /// # Safety
    /// `by` is NULL or leads to `struct_size` readable bytes.
    unsafe fn read(by: *const feti_communicator) -> Result<Self> {
        // SAFETY: guaranteed by the caller.
        let by = unsafe { read_struct(by, "by") }?;
        let refused = |what: &str, value: i32| Err(Error::argument("by", what).value(f64::from(value)));
        let [Ok(rank), Ok(size), Ok(local_size)] = [by.rank, by.size, by.local_size].map(usize::try_from)
        else {
            return refused("rank, size or local_size is negative", by.rank.min(by.size).min(by.local_size));
        };
        if rank >= size {
            return refused("rank must be smaller than size, ranks count from 0", by.rank);
        }
        if local_size < 1 || local_size > size {
            return refused("local_size must be from 1 to size", by.local_size);
        }
        if by.reserved0 != 0 || by.reserved.iter().any(|member| !member.is_null()) {
            return refused("the reserved members must be 0 and NULL", by.reserved0);
        }
        let functions = match (by.send, by.flush, by.receive) {
            _ if size == 1 => None,
            (Some(send), Some(flush), Some(receive)) => Some(Functions { send, flush, receive }),
            _ => {
                return refused(
                    "send, flush and receive must not be NULL if there are several ranks",
                    by.size,
                )
            }
        };
        Ok(Self { rank, size, local_size, user: User(by.user), functions, release: by.release })
    }
}

/// Moves bytes by the functions of the host.
struct HostLink {
    functions: Functions,
    user: User,
}

impl Link for HostLink {
    fn send(&self, rank: usize, data: &[u8]) -> bool {
        let (send, user) = (self.functions.send, self.user.get());
        // SAFETY: the caller guarantees that the function may be called with `user`; `data` has as many bytes as said.
        fpu::in_host_environment(|| unsafe {
            send(user, rank as i32, data.len() as i64, data.as_ptr().cast())
        }) == 0
    }

    fn flush(&self) -> bool {
        let (flush, user) = (self.functions.flush, self.user.get());
        // SAFETY: as above.
        fpu::in_host_environment(|| unsafe { flush(user) }) == 0
    }

    fn receive(&self, rank: usize, data: &mut [u8]) -> bool {
        let (receive, user) = (self.functions.receive, self.user.get());
        let (bytes, data) = (data.len() as i64, data.as_mut_ptr().cast());
        // SAFETY: as above, with room for as many bytes.
        fpu::in_host_environment(|| unsafe { receive(user, rank as i32, bytes, data) }) == 0
    }
}

/// The open streams of messages, by `user` of their tables. They belong to the problems that use them.
static STREAMS: Mutex<Vec<(usize, Weak<Rank>)>> = Mutex::new(Vec::new());

/// The tables of problems, by the numbers of their handles.
static GIVEN: Mutex<BTreeMap<usize, Given>> = Mutex::new(BTreeMap::new());

/// What remains of a table that a problem has: who is told when the problem is destroyed.
pub struct Given {
    user: User,
    release: feti_release_fn,
    ranks: usize,
}

impl Given {
    pub fn release(&self) {
        if let Some(release) = self.release {
            // SAFETY: the caller of feti_communicator_set guarantees that the function may be called with `user`.
            fpu::in_host_environment(|| unsafe { release(self.user.get()) });
        }
    }
}

/// The table of a problem that is being destroyed.
pub fn taken_from(p: *mut feti_problem) -> Option<Given> {
    instant(|| lock(&GIVEN).remove(&p.addr()))
}

/// Number of ranks of a problem.
pub fn count_of(p: *mut feti_problem) -> usize {
    instant(|| lock(&GIVEN).get(&p.addr()).map_or(1, |given| given.ranks))
}

/// The stream with this `user`: the one that other problems use, or a new one. A stream that has failed or been ended is
/// used no more.
fn stream(table: &Table, functions: Functions) -> Result<Arc<Rank>> {
    let (name, rank, size) = (table.user.get().addr(), table.rank, table.size);
    instant(|| {
        let mut streams = lock(&STREAMS);
        streams.retain(|(_, of)| of.upgrade().is_some_and(|of| !of.ranks.is_closed()));
        let known = streams.iter().find(|(user, _)| *user == name).and_then(|(_, of)| of.upgrade());
        match known.as_ref().map(|of| (of.ranks.rank, of.ranks.size)) {
            Some(same) if same != (rank, size) => {
                let (rank, size) = same;
                let what = format!("another problem has a table with this `user`, for rank {rank} of {size}");
                Err(Error::argument("by", what).value(table.size as f64))
            }
            _ => Ok(known.unwrap_or_else(|| {
                let link = HostLink { functions, user: table.user };
                let of = Rank::new(Ranks::new(rank, size, Box::new(link)));
                streams.push((name, Arc::downgrade(&of)));
                of
            })),
        }
    })
}

/// Threads of a rank that serves, as option `threads`: 0, the CPUs of this process, unless it shares all CPUs with other ranks.
fn threads(local_size: usize) -> i64 {
    if local_size < 2 || !may_run_anywhere() {
        return 0;
    }
    let cpus = std::thread::available_parallelism().map_or(1, std::num::NonZero::get);
    share(cpus, local_size)
}

fn share(cpus: usize, local_size: usize) -> i64 {
    (cpus / local_size).max(1) as i64
}

/// True if this process is bound to no part of the CPUs.
#[cfg(target_os = "linux")]
fn may_run_anywhere() -> bool {
    // SAFETY: a set of CPUs may be all zeros; the system writes no more than its size.
    let (bound, own) = unsafe {
        let mut set: libc::cpu_set_t = std::mem::zeroed();
        let bound = libc::sched_getaffinity(0, size_of::<libc::cpu_set_t>(), &mut set);
        (bound, libc::CPU_COUNT(&set))
    };
    // SAFETY: it only asks.
    let all = unsafe { libc::sysconf(libc::_SC_NPROCESSORS_ONLN) };
    bound != 0 || i64::from(own) >= all
}

#[cfg(not(target_os = "linux"))]
fn may_run_anywhere() -> bool {
    true
}

fn lock<T>(mutex: &Mutex<T>) -> MutexGuard<'_, T> {
    mutex.lock().unwrap_or_else(PoisonError::into_inner)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn ranks_of_one_machine_share_its_cpus_and_each_has_one() {
        assert_eq!([share(16, 4), share(16, 5), share(2, 4), share(1, 1)], [4, 3, 1, 1]);
        assert_eq!(threads(1), 0);
    }
}
