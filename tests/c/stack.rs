//! How deep a call goes: docs/packaging.md promises that it ends within 256 KiB of stack.
#![cfg(target_os = "linux")]

#[path = "../support/hand_over.rs"]
mod hand_over;

use std::ffi::{c_void, CString};
use std::ptr::{null_mut, NonNull};

use decks::rubbing::Rubbing;
use decks::{battery, varied, Deck};
use feti_contact::error::Result;
use feti_contact::solver::Problem;
use feti_contact_c::*;

/// What docs/packaging.md promises.
const PROMISED: usize = 256 << 10;
/// Stack of the thread that is painted; the part below what is promised is room for measuring a broken promise.
const STACK: usize = 1 << 20;
const PAINT: u8 = 0xA5;

/// Bytes of the thread's stack that `work` and the system have used.
fn depth_of(work: &mut (dyn FnMut() + Send)) -> usize {
    extern "C" fn run(work: *mut c_void) -> *mut c_void {
        // SAFETY: `depth_of` waits for the end of this thread with the exclusive borrow.
        let work = unsafe { &mut *work.cast::<&mut (dyn FnMut() + Send)>() };
        work();
        null_mut()
    }
    let mut work: &mut (dyn FnMut() + Send) = work;
    // SAFETY: the mapping is new and stays until the thread has ended; every call is checked.
    unsafe {
        let (access, kind) = (libc::PROT_READ | libc::PROT_WRITE, libc::MAP_PRIVATE | libc::MAP_ANONYMOUS);
        let stack = libc::mmap(null_mut(), STACK, access, kind, -1, 0);
        assert_ne!(stack, libc::MAP_FAILED);
        stack.cast::<u8>().write_bytes(PAINT, STACK);
        let mut attributes = std::mem::zeroed();
        assert_eq!(libc::pthread_attr_init(&mut attributes), 0);
        assert_eq!(libc::pthread_attr_setstack(&mut attributes, stack, STACK), 0);
        let mut thread = std::mem::zeroed();
        let argument = NonNull::from(&mut work).as_ptr().cast();
        assert_eq!(libc::pthread_create(&mut thread, &attributes, run, argument), 0);
        assert_eq!(libc::pthread_join(thread, null_mut()), 0);
        let painted = std::slice::from_raw_parts(stack.cast::<u8>(), STACK);
        let left = painted.iter().take_while(|byte| **byte == PAINT).count();
        libc::pthread_attr_destroy(&mut attributes);
        libc::munmap(stack, STACK);
        STACK - left
    }
}

/// The whole life of a problem on one thread, from its file.
fn lives(path: &CString) {
    let mut p = null_mut();
    // SAFETY: the arguments live during the calls.
    unsafe {
        assert_eq!(feti_problem_create(&mut p), 0);
        assert_eq!(feti_problem_read(p, path.as_ptr()), 0);
        feti_solve(p, null_mut());
        feti_problem_destroy(&mut p);
    }
}

type Make = fn(&Deck) -> Result<Problem>;

#[test]
fn no_call_goes_deeper_than_the_promised_stack() {
    let of_battery = (0..200).map(|seed| (format!("battery {seed}"), battery::case(seed).deck));
    let of_varied = (0..264).map(|seed| (format!("varied {seed}"), varied::case(seed).deck));
    let of_rubbing = Rubbing::floating_36().into_iter().map(|rubbing| (rubbing.name(), rubbing.build()));
    let folder = std::env::temp_dir().join(format!("feti-stack-{}", std::process::id()));
    std::fs::create_dir_all(&folder).unwrap();
    let file = folder.join("problem.feti");
    let path = CString::new(file.to_str().unwrap()).unwrap();
    let (mut deepest, mut problems) = ((0, String::new()), 0);
    for (k, (name, deck)) in of_battery.chain(of_varied).chain(of_rubbing).enumerate() {
        // the null spaces are found in every second problem
        let make: Make = if k % 2 == 0 { hand_over::problem } else { hand_over::without_null_spaces };
        let mut problem = make(&deck).unwrap();
        problem.set_i64("threads", 1).unwrap();
        problem.write_file(&file).unwrap();
        deepest = deepest.max((depth_of(&mut || lives(&path)), name));
        problems += 1;
    }
    std::fs::remove_dir_all(&folder).unwrap();
    println!("{} KiB of stack at most, {}", deepest.0 >> 10, deepest.1);
    assert!(problems >= 500 && deepest.0 <= PROMISED, "{} KiB of stack: {}", deepest.0 >> 10, deepest.1);
}
