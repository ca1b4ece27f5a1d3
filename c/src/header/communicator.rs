//! The table by which a host gives the library its way to other ranks.
#![allow(non_camel_case_types)]

use std::ffi::c_void;

/// A function of the host that sends bytes to another rank.
///
/// It returns 0 on success and any other number to report a failure; it need not wait until the data have arrived. The
/// data stay unchanged until feti_communicator.flush has returned; after a failure of either function they may change.
/// What one rank sends to another arrives in the order in which it was sent.
///
/// | argument | in/out | shape | rule |
/// |---|---|---|---|
/// | `user` | in | scalar | the host's own data, `user` of the table; may be NULL |
/// | `rank` | in | scalar | the rank that receives |
/// | `bytes` | in | scalar | number of bytes, > 0 |
/// | `data` | in | bytes | what is sent |
pub type feti_send_fn =
    Option<unsafe extern "C" fn(user: *mut c_void, rank: i32, bytes: i64, data: *const c_void) -> i32>;

/// A function of the host that waits until all data that this rank has sent may be changed.
///
/// It returns 0 on success and any other number to report a failure.
///
/// | argument | in/out | shape | rule |
/// |---|---|---|---|
/// | `user` | in | scalar | the host's own data, `user` of the table; may be NULL |
pub type feti_flush_fn = Option<unsafe extern "C" fn(user: *mut c_void) -> i32>;

/// A function of the host that waits for bytes from another rank.
///
/// It returns 0 when exactly these bytes have arrived, and any other number to report a failure. The library asks
/// for bytes in the portions in which they were sent.
///
/// | argument | in/out | shape | rule |
/// |---|---|---|---|
/// | `user` | in | scalar | the host's own data, `user` of the table; may be NULL |
/// | `rank` | in | scalar | the rank that sends |
/// | `bytes` | in | scalar | number of bytes, > 0 |
/// | `data` | out | bytes | what has arrived |
pub type feti_receive_fn =
    Option<unsafe extern "C" fn(user: *mut c_void, rank: i32, bytes: i64, data: *mut c_void) -> i32>;

/// A function of the host that is called when a problem no longer uses the table that was given to it.
///
/// | argument | in/out | shape | rule |
/// |---|---|---|---|
/// | `user` | in | scalar | the host's own data, `user` of the table; may be NULL |
pub type feti_release_fn = Option<unsafe extern "C" fn(user: *mut c_void)>;

/// The ranks of a host, and the functions by which it moves bytes between them. For MPI the installed source feti_mpi.c
/// fills it.
#[repr(C)]
#[derive(Debug, Clone, Copy)]
pub struct feti_communicator {
    /// Set by the caller: size of the struct in bytes.
    pub struct_size: i64,
    /// Number of this rank, from 0.
    pub rank: i32,
    /// Number of ranks.
    pub size: i32,
    /// Number of ranks on this machine, at least 1. They share its CPUs, unless each is bound to its own.
    pub local_size: i32,
    /// Zero.
    pub reserved0: i32,
    /// Passed to the functions unchanged. It names the stream of messages: problems whose tables have the same `user` share one.
    pub user: *mut c_void,
    /// Sends bytes to another rank; like the next two it may be NULL if there is one rank only.
    pub send: feti_send_fn,
    /// Waits until all data that were sent may be changed.
    pub flush: feti_flush_fn,
    /// Waits for bytes from another rank.
    pub receive: feti_receive_fn,
    /// Called when the problem is destroyed, also after the end of MPI; may be NULL.
    pub release: feti_release_fn,
    /// NULL.
    pub reserved: [*mut c_void; 4],
}
