//! The table of other ranks, with a host whose ranks are threads of one process.

use std::collections::VecDeque;
use std::ffi::c_void;
use std::ptr::{null_mut, without_provenance_mut};
use std::sync::atomic::{AtomicUsize, Ordering::Relaxed};
use std::sync::mpsc::{channel, Receiver, Sender};
use std::sync::Mutex;

use super::{last_detail, last_error, Owned};
use crate::*;

/// One rank of two: the ends of its pipes, and what is asked of its functions.
struct End {
    to: Mutex<Sender<Vec<u8>>>,
    from: Mutex<(Receiver<Vec<u8>>, VecDeque<u8>)>,
    calls: [AtomicUsize; 3],
    released: AtomicUsize,
    /// The function that fails: 0 send, 1 flush, 2 receive.
    fails: Option<usize>,
}

const SEND: usize = 0;
const FLUSH: usize = 1;
const RECEIVE: usize = 2;

impl End {
    fn new(to: Sender<Vec<u8>>, from: Receiver<Vec<u8>>, fails: Option<usize>) -> Self {
        let calls = [const { AtomicUsize::new(0) }; 3];
        End {
            to: Mutex::new(to),
            from: Mutex::new((from, VecDeque::new())),
            calls,
            released: AtomicUsize::new(0),
            fails,
        }
    }

    /// Ranks 0 and 1; the function of rank 0 that fails.
    fn pair(fails: Option<usize>) -> [Self; 2] {
        let ((down, from_leader), (up, from_other)) = (channel(), channel());
        [Self::new(down, from_other, fails), Self::new(up, from_leader, None)]
    }

    fn table(&self, rank: i32) -> feti_communicator {
        feti_communicator {
            struct_size: size_of::<feti_communicator>() as i64,
            rank,
            size: 2,
            local_size: 2,
            reserved0: 0,
            user: std::ptr::from_ref(self).cast_mut().cast(),
            send: Some(send),
            flush: Some(flush),
            receive: Some(receive),
            release: Some(release),
            reserved: [null_mut(); 4],
        }
    }

    fn outcome(&self, function: usize) -> i32 {
        self.calls[function].fetch_add(1, Relaxed);
        i32::from(self.fails == Some(function))
    }

    fn calls(&self) -> [usize; 3] {
        [SEND, FLUSH, RECEIVE].map(|function| self.calls[function].load(Relaxed))
    }
}

unsafe extern "C" fn send(user: *mut c_void, rank: i32, bytes: i64, data: *const c_void) -> i32 {
    assert!((0..2).contains(&rank) && bytes > 0);
    // SAFETY: `user` is an End, `data` has as many bytes as said.
    let (end, data) =
        unsafe { (&*user.cast::<End>(), std::slice::from_raw_parts(data.cast::<u8>(), bytes as usize)) };
    let gone = end.to.lock().unwrap().send(data.to_vec()).is_err();
    end.outcome(SEND).max(i32::from(gone))
}

unsafe extern "C" fn flush(user: *mut c_void) -> i32 {
    // SAFETY: as above.
    unsafe { &*user.cast::<End>() }.outcome(FLUSH)
}

unsafe extern "C" fn receive(user: *mut c_void, rank: i32, bytes: i64, data: *mut c_void) -> i32 {
    assert!((0..2).contains(&rank) && bytes > 0);
    // SAFETY: `user` is an End.
    let end = unsafe { &*user.cast::<End>() };
    let mut from = end.from.lock().unwrap();
    while from.1.len() < bytes as usize {
        let Ok(more) = from.0.recv() else { return 1 };
        from.1.extend(more);
    }
    let found: Vec<u8> = from.1.drain(..bytes as usize).collect();
    // SAFETY: room for as many bytes.
    unsafe { data.cast::<u8>().copy_from_nonoverlapping(found.as_ptr(), found.len()) };
    end.outcome(RECEIVE)
}

unsafe extern "C" fn release(user: *mut c_void) {
    // SAFETY: `user` is an End.
    unsafe { &*user.cast::<End>() }.released.fetch_add(1, Relaxed);
}

fn set(p: &Owned, table: &feti_communicator) -> i32 {
    // SAFETY: the size is set; the functions may be called as long as their End is there.
    unsafe { feti_communicator_set(p.0, table) }
}

fn serve(table: &feti_communicator) -> i32 {
    // SAFETY: as above.
    unsafe { feti_serve(table) }
}

fn info(p: &Owned) -> (i32, feti_info) {
    // SAFETY: all zero is a valid value.
    let mut info: feti_info = unsafe { std::mem::zeroed() };
    info.struct_size = size_of::<feti_info>() as i64;
    // SAFETY: the size is set.
    (unsafe { feti_solve(p.0, &mut info) }, info)
}

/// Runs `leads` on rank 0 while another thread serves as rank 1; the End of rank 0 is gone before the other thread is waited for,
/// so that no failure leaves it waiting.
fn served(fails: Option<usize>, leads: impl FnOnce(&End)) -> (i32, [usize; 3]) {
    let [leader, other] = End::pair(fails);
    std::thread::scope(move |scope| {
        let serves = scope.spawn(move || (serve(&other.table(1)), other.calls()));
        let leader = leader;
        leads(&leader);
        drop(leader);
        serves.join().unwrap()
    })
}

#[test]
fn the_other_rank_serves_all_problems_until_rank_0_ends_it_and_every_table_is_released_once() {
    let (status, calls) = served(None, |end| {
        let problems = [Owned::new(), Owned::new()];
        problems.iter().for_each(|p| assert_eq!(set(p, &end.table(0)), FETI_OK));
        let (status, info) = info(&problems[1]);
        // it asks the other rank whether it serves before it looks at what it has
        assert_eq!((status, info.ranks, info.messages), (FETI_STATE, 2, 2));
        assert_eq!(serve(&end.table(0)), FETI_OK);
        assert_eq!(end.released.load(Relaxed), 0);
        drop(problems);
        assert_eq!(end.released.load(Relaxed), 2);
        assert!(end.calls().iter().all(|calls| *calls >= 1));
    });
    assert_eq!(status, FETI_OK);
    assert!(calls.iter().all(|calls| *calls >= 1));
}

#[test]
fn service_may_begin_again_while_a_problem_of_the_first_time_is_alive() {
    let [leader, other] = End::pair(None);
    std::thread::scope(move |scope| {
        let serves = scope.spawn(move || [(); 2].map(|()| serve(&other.table(1))));
        let leader = leader;
        let problems = [(); 2].map(|()| {
            let p = Owned::new();
            assert_eq!(set(&p, &leader.table(0)), FETI_OK);
            assert_eq!(serve(&leader.table(0)), FETI_OK);
            p
        });
        drop(problems);
        drop(leader);
        assert_eq!(serves.join().unwrap(), [FETI_OK; 2]);
    });
}

#[test]
fn a_function_of_the_host_that_fails_is_a_failed_communication() {
    for function in [SEND, FLUSH, RECEIVE] {
        served(Some(function), |end| {
            assert_eq!(serve(&end.table(0)), FETI_COMMUNICATION, "{function}");
            assert!(last_error().starts_with("feti_serve: "), "{}", last_error());
            assert_eq!((last_detail().status, end.released.load(Relaxed)), (FETI_COMMUNICATION, 0));
        });
    }
}

#[test]
fn a_rank_that_serves_returns_when_its_messages_end() {
    let [leader, other] = End::pair(None);
    drop(leader);
    assert_eq!(serve(&other.table(1)), FETI_COMMUNICATION);
}

#[test]
fn with_one_rank_nothing_changes_but_the_call_is_checked() {
    let [end, _] = End::pair(None);
    let alone =
        feti_communicator { size: 1, local_size: 1, send: None, flush: None, receive: None, ..end.table(0) };
    assert_eq!(serve(&alone), FETI_OK);
    let mut p = Owned::new();
    assert_eq!(set(&p, &alone), FETI_OK);
    assert_eq!(set(&p, &alone), FETI_STATE);
    // SAFETY: leads to a pointer.
    assert_eq!(unsafe { feti_problem_destroy(&mut p.0) }, FETI_OK);
    assert_eq!(end.released.load(Relaxed), 1);
    assert_eq!(set(&Owned::with_body(), &alone), FETI_STATE);
    assert_eq!((end.released.load(Relaxed), end.calls()), (1, [0, 0, 0]));
}

#[test]
fn a_stream_has_one_number_of_ranks_and_one_rank() {
    let [end, _] = End::pair(None);
    let p = Owned::new();
    assert_eq!(set(&p, &end.table(0)), FETI_OK);
    assert_eq!(set(&Owned::with_body(), &end.table(0)), FETI_STATE);
    let more = feti_communicator { size: 3, ..end.table(0) };
    for other in [more, end.table(1)] {
        assert_eq!(set(&Owned::new(), &other), FETI_ARGUMENT - 2);
        assert!(last_error().contains("for rank 0 of 2"), "{}", last_error());
    }
    drop(p);
    assert_eq!(end.released.load(Relaxed), 1);
    assert_eq!(set(&Owned::new(), &more), FETI_OK);
}

/// A spring of stiffness 2 from the ground, pushed by f; its unknown has the number of its rank.
fn add_spring(p: &Owned, rank: i64, f: f64) {
    let (mut body, k) = (0, 2.0);
    // SAFETY: all arrays have one number.
    let statuses = unsafe {
        [
            feti_body_add(p.0, 1, &mut body),
            feti_body_stiffness_dense(p.0, body, 1, &k, 1, FETI_FULL, FETI_COPY),
            feti_body_load(p.0, body, 1, &f),
            feti_body_numbering_i64(p.0, body, 1, &rank, 0),
        ]
    };
    assert_eq!(statuses, [FETI_OK; 4]);
}

/// A row between two numbers: u of the first stays below that of the second.
fn add_row(p: &Owned, numbers: &[i64; 2]) -> i32 {
    let (ptr, val, gap) = ([0, 2], [1.0, -1.0], 0.0);
    let (ptr, dof, val) = (ptr.as_ptr(), numbers.as_ptr(), val.as_ptr());
    // SAFETY: one row of two entries.
    unsafe {
        feti_rows_add_i64(p.0, FETI_INEQUALITY, 1, ptr, std::ptr::null(), dof, val, 0, &gap, null_mut())
    }
}

/// Runs the same on both ranks of a pair.
fn both(host: impl Fn(i32, &feti_communicator) + Sync) {
    let [leader, other] = End::pair(None);
    let host = &host;
    std::thread::scope(|scope| {
        let second = scope.spawn(move || host(1, &other.table(1)));
        host(0, &leader.table(0));
        second.join().unwrap();
    });
}

#[test]
fn two_ranks_give_a_spring_each_and_rank_1_the_row_between_them() {
    both(|rank, table| {
        let p = Owned::new();
        assert_eq!(set(&p, table), FETI_OK);
        // alone they would be at 2 and -1
        add_spring(&p, i64::from(rank), if rank == 0 { 4.0 } else { -2.0 });
        if rank == 1 {
            assert_eq!(add_row(&p, &[0, 1]), FETI_OK);
        }
        let (status, info) = info(&p);
        assert_eq!((status, info.ranks, info.bodies, info.rows), (FETI_OK, 2, 2, 1));
        let (mut u, mut lambda) = (0.0, [f64::NAN]);
        // SAFETY: room for one number, and for the rows of this rank.
        let read = unsafe { feti_displacement(p.0, 0, 1, &mut u) };
        assert!(read == FETI_OK && (u - 0.5).abs() < 1e-14);
        // SAFETY: as above.
        let read = unsafe { feti_multipliers(p.0, FETI_INEQUALITY, i64::from(rank), lambda.as_mut_ptr()) };
        assert_eq!(read, FETI_OK);
        assert!((lambda[0] - 3.0).abs() < 1e-14 || rank == 0);
    });
}

#[test]
fn what_one_rank_gives_wrong_is_told_on_both_with_its_rank() {
    both(|rank, table| {
        let p = Owned::new();
        assert_eq!(set(&p, table), FETI_OK);
        add_spring(&p, i64::from(rank), 1.0);
        if rank == 1 {
            assert_eq!(add_row(&p, &[0, 7]), FETI_OK, "another rank may have the number");
        }
        assert_eq!(info(&p).0, FETI_ARGUMENT);
        let detail = last_detail();
        assert_eq!((detail.rank, detail.row, detail.entry, detail.value), (1, 0, 1, 7.0));
        assert!(last_error().contains("rank 1, row 0"), "{}", last_error());
    });
}

#[test]
fn different_calls_end_with_the_same_status_on_both_ranks() {
    both(|rank, table| {
        let p = Owned::new();
        assert_eq!(set(&p, table), FETI_OK);
        add_spring(&p, i64::from(rank), 1.0);
        let status = if rank == 0 { feti_setup(p.0) } else { info(&p).0 };
        assert_eq!(status, FETI_STATE);
        assert!(last_error().contains("rank 1 is in feti_solve, rank 0 in feti_setup"), "{}", last_error());
        assert_eq!(info(&p).0, FETI_OK, "together they go on");
    });
}

#[test]
fn a_panic_on_one_rank_closes_the_problem_on_both() {
    for by in 0..2 {
        both(|rank, table| {
            let p = Owned::new();
            assert_eq!(set(&p, table), FETI_OK);
            add_spring(&p, i64::from(rank), 1.0);
            if rank == by {
                assert_eq!(p.set(c"fault_injection", 1), FETI_OK);
            }
            assert_eq!(info(&p).0, FETI_INTERNAL);
            assert_eq!(last_detail().rank, i64::from(by));
            assert!(last_error().contains("fault injected on request"), "{}", last_error());
            assert_eq!(info(&p).0, FETI_INTERNAL);
        });
    }
}

/// A surface without nodes, and a plane.
fn add_surfaces(p: &Owned) -> [i32; 2] {
    let (data, mut surface) = ([0.0, 0.0, 0.0, 1.0], -1);
    // SAFETY: without nodes nothing is read; a plane has four numbers.
    unsafe {
        let (none, dof) = (std::ptr::null(), std::ptr::null());
        [
            feti_surface_add_i32(p.0, FETI_ALL, 2, 0, none, 2, dof, 2, 0, &mut surface),
            feti_surface_rigid(p.0, 2, FETI_PLANE, data.as_ptr(), &mut surface),
        ]
    }
}

#[test]
fn surfaces_come_after_the_table_of_ranks() {
    both(|_, table| {
        let p = Owned::new();
        assert_eq!(set(&p, table), FETI_OK);
        assert_eq!(add_surfaces(&p), [FETI_OK; 2]);
        let before = Owned::new();
        assert_eq!((add_surfaces(&before), set(&before, table)), ([FETI_OK; 2], FETI_STATE));
    });
}

#[test]
fn a_table_that_cannot_be_is_refused() {
    let [end, _] = End::pair(None);
    let right = end.table(0);
    let some = without_provenance_mut(8);
    let wrong = [
        feti_communicator { struct_size: right.struct_size - 8, ..right },
        feti_communicator { struct_size: -1, ..right },
        feti_communicator { rank: -1, ..right },
        feti_communicator { rank: 2, ..right },
        feti_communicator { size: 0, ..right },
        feti_communicator { size: -1, ..right },
        feti_communicator { local_size: 0, ..right },
        feti_communicator { local_size: 3, ..right },
        feti_communicator { reserved0: 1, ..right },
        feti_communicator { reserved: [null_mut(), null_mut(), null_mut(), some], ..right },
        feti_communicator { send: None, ..right },
        feti_communicator { flush: None, ..right },
        feti_communicator { receive: None, ..right },
    ];
    let p = Owned::new();
    for table in wrong {
        assert_eq!((set(&p, &table), serve(&table)), (FETI_ARGUMENT - 2, FETI_ARGUMENT - 1), "{table:?}");
    }
    // SAFETY: NULL is refused.
    let of_null = unsafe { (feti_communicator_set(p.0, std::ptr::null()), feti_serve(std::ptr::null())) };
    assert_eq!(of_null, (-102, -101));
    assert_eq!((end.released.load(Relaxed), end.calls()), (0, [0, 0, 0]));
}
