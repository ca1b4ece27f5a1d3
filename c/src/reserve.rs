//! The calls of a C host survive a malloc that fails: the block comes from a reserve, and the call ends at its next check with
//! `Kind::Memory` ([`shortage`]). Rust would end the process at the failure of a small allocation.
//!
//! In the shared library (`build.rs`) and the installed archive (`tools/install.sh`) the linker directs malloc, calloc,
//! realloc, posix_memalign and free to the functions below (`--wrap`).
#![allow(unsafe_op_in_unsafe_fn)]

use std::arch::global_asm;
use std::cell::UnsafeCell;
use std::ptr::{self, null_mut};
use std::sync::atomic::{AtomicU64, Ordering};

use feti_contact::platform::shortage;
use libc::{c_int, c_void, ENOMEM};

/// Bytes of the reserve: address space alone until it is needed.
const SIZE: usize = 8 << 20;
/// In front of every block: its end, and the end of the blocks before it, from the start of the reserve.
const HEAD: usize = 16;

#[repr(align(4096))]
struct Area(UnsafeCell<[u8; SIZE]>);

// SAFETY: `Reserve` gives every byte to one block at a time.
unsafe impl Sync for Area {}

static AREA: Area = Area(UnsafeCell::new([0; SIZE]));

/// Number of blocks in use, times 2^32, plus the end of the last one.
static USED: AtomicU64 = AtomicU64::new(0);

fn start() -> *mut u8 {
    AREA.0.get().cast()
}

/// A block from the reserve, NULL if it does not fit.
fn take(size: usize, align: usize) -> *mut c_void {
    shortage::begin();
    let mut used = USED.load(Ordering::Acquire);
    loop {
        let end_before = used & u64::from(u32::MAX);
        let first = (end_before as usize + HEAD).next_multiple_of(align.max(HEAD));
        let Some(end) = first.checked_add(size).filter(|end| *end <= SIZE) else { return null_mut() };
        let next = ((used >> 32) + 1) << 32 | end as u64;
        match USED.compare_exchange_weak(used, next, Ordering::AcqRel, Ordering::Acquire) {
            Ok(_) => {
                // SAFETY: within the area, and of this block alone.
                unsafe {
                    let block = start().add(first);
                    block.sub(HEAD).cast::<[u64; 2]>().write([end as u64, end_before]);
                    return block.cast();
                }
            }
            Err(changed) => used = changed,
        }
    }
}

/// Bytes of a block of the reserve, none for a block of the system.
fn size_of_ours(block: *mut c_void) -> Option<usize> {
    let first = (block as usize).checked_sub(start() as usize).filter(|first| *first < SIZE)?;
    // SAFETY: a block of the reserve, with its head.
    let [end, _] = unsafe { block.cast::<u8>().sub(HEAD).cast::<[u64; 2]>().read() };
    Some(end as usize - first)
}

/// Returns a block of the reserve.
fn give_back(block: *mut c_void) {
    // SAFETY: as above.
    let [end, end_before] = unsafe { block.cast::<u8>().sub(HEAD).cast::<[u64; 2]>().read() };
    let mut used = USED.load(Ordering::Acquire);
    loop {
        let (blocks, last) = ((used >> 32) - 1, used & u64::from(u32::MAX));
        let last = match (blocks, last == end) {
            (0, _) => 0,
            (_, true) => end_before,
            (_, false) => last,
        };
        match USED.compare_exchange_weak(used, blocks << 32 | last, Ordering::AcqRel, Ordering::Acquire) {
            Ok(_) => return,
            Err(changed) => used = changed,
        }
    }
}

extern "C" {
    fn system_for_feti_malloc(size: usize) -> *mut c_void;
    fn system_for_feti_calloc(count: usize, size: usize) -> *mut c_void;
    fn system_for_feti_realloc(block: *mut c_void, size: usize) -> *mut c_void;
    fn system_for_feti_posix_memalign(block: *mut *mut c_void, align: usize, size: usize) -> c_int;
    fn system_for_feti_free(block: *mut c_void);
    fn system_for_feti___cxa_thread_atexit_impl(
        run: Destructor,
        value: *mut c_void,
        of: *mut c_void,
    ) -> c_int;
}

type Destructor = unsafe extern "C" fn(*mut c_void);

unsafe extern "C" fn malloc(size: usize) -> *mut c_void {
    let block = system_for_feti_malloc(size);
    if block.is_null() {
        take(size, HEAD)
    } else {
        block
    }
}

unsafe extern "C" fn calloc(count: usize, size: usize) -> *mut c_void {
    let block = system_for_feti_calloc(count, size);
    let Some(bytes) = count.checked_mul(size).filter(|_| block.is_null()) else { return block };
    let block = take(bytes, HEAD);
    if !block.is_null() {
        block.cast::<u8>().write_bytes(0, bytes);
    }
    block
}

unsafe extern "C" fn realloc(old: *mut c_void, size: usize) -> *mut c_void {
    let ours = size_of_ours(old);
    let block =
        if ours.is_some() { system_for_feti_malloc(size) } else { system_for_feti_realloc(old, size) };
    if ours.is_none() && (!block.is_null() || size == 0) {
        return block;
    }
    let block = if block.is_null() { take(size, HEAD) } else { block };
    if block.is_null() || old.is_null() {
        return block;
    }
    let before = ours.unwrap_or_else(|| libc::malloc_usable_size(old));
    ptr::copy_nonoverlapping(old.cast::<u8>(), block.cast::<u8>(), before.min(size));
    free(old);
    block
}

unsafe extern "C" fn posix_memalign(block: *mut *mut c_void, align: usize, size: usize) -> c_int {
    let status = system_for_feti_posix_memalign(block, align, size);
    if status != ENOMEM {
        return status;
    }
    let found = take(size, align);
    if found.is_null() {
        return ENOMEM;
    }
    block.write(found);
    0
}

/// The GNU library ends the process if it has no memory to note the destructor of a thread's value. Without memory the
/// value is not destroyed when the thread ends.
unsafe extern "C" fn __cxa_thread_atexit_impl(run: Destructor, value: *mut c_void, of: *mut c_void) -> c_int {
    let probe = system_for_feti_malloc(4 * size_of::<usize>());
    if probe.is_null() {
        return 0;
    }
    system_for_feti_free(probe);
    system_for_feti___cxa_thread_atexit_impl(run, value, of)
}

unsafe extern "C" fn free(block: *mut c_void) {
    match size_of_ours(block) {
        Some(_) => give_back(block),
        None => system_for_feti_free(block),
    }
}

#[cfg(target_arch = "x86_64")]
macro_rules! jump {
    () => {
        "jmp"
    };
}
#[cfg(target_arch = "x86_64")]
macro_rules! plt {
    () => {
        "@PLT"
    };
}
#[cfg(target_arch = "aarch64")]
macro_rules! jump {
    () => {
        "b"
    };
}
#[cfg(target_arch = "aarch64")]
macro_rules! plt {
    () => {
        ""
    };
}
/// `__wrap_NAME` is what the linker puts in the place of NAME, `__real_NAME` is NAME itself. All are weak: without
/// `--wrap` nobody needs them.
macro_rules! in_place_of {
    ($($name:ident)*) => {$(
        global_asm!(
            concat!(".weak __real_", stringify!($name)),
            concat!(".weak __wrap_", stringify!($name)),
            concat!(".hidden __wrap_", stringify!($name)),
            concat!("__wrap_", stringify!($name), ":"),
            concat!(jump!(), " {ours}"),
            concat!(".weak system_for_feti_", stringify!($name)),
            concat!(".hidden system_for_feti_", stringify!($name)),
            concat!("system_for_feti_", stringify!($name), ":"),
            concat!(jump!(), " __real_", stringify!($name), plt!()),
            ours = sym $name,
        );
    )*};
}

in_place_of!(malloc calloc realloc posix_memalign free __cxa_thread_atexit_impl);
