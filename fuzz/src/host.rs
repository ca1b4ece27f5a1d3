//! A host that hands over right arguments, or spoils one of a call; and what it checks after every call.

use feti_contact_c::*;

use super::buffers::{Cell, Digest, Out, Written};
use super::bytes::Bytes;
use super::listeners::{Listener, Watcher};
use super::models::Model;

/// Kinds of rows, by position in `Host::rows`.
pub const KINDS: [i32; 2] = [FETI_INEQUALITY, FETI_EQUALITY];
/// Bodies of more unknowns are only named, never filled.
pub const LARGEST: usize = 64;

/// Arrays and functions of the host behind the matrix of one body.
#[derive(Default)]
pub struct Lent {
    pub pattern: Option<Box<dyn std::any::Any>>,
    pub value: Option<Vec<f64>>,
}

pub struct Host<'a> {
    pub bytes: Bytes<'a>,
    pub p: *mut feti_problem,
    /// A handle that was destroyed.
    pub dead: *mut feti_problem,
    pub bodies: Vec<Model>,
    /// Rows of each kind.
    pub rows: [usize; 2],
    /// Nodes with friction, and the tangential rows of one.
    pub nodes: usize,
    pub dim: usize,
    /// What the library may look at until a body gets another matrix.
    pub lent: Vec<Lent>,
    /// A body has numbers of the host.
    pub numbered: bool,
    /// A function of the host may report a failure.
    pub may_refuse: bool,
    pub listener: Option<Box<Listener>>,
    /// Numbers of saved states, and the rows of each kind and nodes that come back with them.
    pub states: Vec<(i64, [usize; 2], (usize, usize))>,
    /// What the host of [`super::give::progress`] counts; an address that stays.
    pub watcher: Box<Watcher>,
    pub digest: Digest,
    /// Solves that ended with FETI_OK.
    pub certified: u64,
    /// Option fault_injection is set: FETI_INTERNAL is right.
    pub injected: bool,
    /// Arguments until the one that is spoilt.
    until_bad: Option<usize>,
    spoilt: bool,
    /// Statuses and bits of all results, as long as they must stay.
    kept: Option<Digest>,
}

impl<'a> Host<'a> {
    pub fn new(data: &'a [u8]) -> Self {
        let mut host = Self {
            bytes: Bytes::new(data),
            p: std::ptr::null_mut(),
            dead: std::ptr::null_mut(),
            bodies: Vec::new(),
            rows: [0; 2],
            nodes: 0,
            dim: 0,
            lent: Vec::new(),
            numbered: false,
            may_refuse: false,
            listener: None,
            states: Vec::new(),
            watcher: Box::default(),
            digest: Digest::new(),
            certified: 0,
            injected: false,
            until_bad: None,
            spoilt: false,
            kept: None,
        };
        host.create();
        host
    }

    pub fn create(&mut self) {
        // SAFETY: room for a handle.
        assert_eq!(unsafe { feti_problem_create(&mut self.p) }, FETI_OK);
        (self.bodies, self.rows, self.states) = (Vec::new(), [0; 2], Vec::new());
        (self.kept, self.injected) = (None, false);
        (self.nodes, self.dim) = (0, 0);
        (self.lent, self.numbered, self.may_refuse, self.listener) = (Vec::new(), false, false, None);
    }

    /// Destroys the problem; its handle is dead from then on.
    pub fn destroy(&mut self) {
        self.dead = self.p;
        let mut copy = self.p;
        // SAFETY: both lead to handles.
        unsafe {
            assert_eq!(feti_problem_destroy(&mut self.p), FETI_OK);
            assert!(self.p.is_null());
            assert_eq!(feti_problem_destroy(&mut copy), FETI_HANDLE);
            assert_eq!(feti_setup(self.dead), FETI_HANDLE);
        }
    }

    /// Before a call of the sequence: one argument of it may be spoilt.
    pub fn begin(&mut self) {
        self.until_bad = self.bytes.chance(28).then(|| self.bytes.below(10));
        self.spoilt = false;
        if self.kept.is_none() {
            self.kept = Some(self.results());
        }
    }

    /// All that follows is handed over as it should be.
    pub fn plain(&mut self) {
        (self.until_bad, self.spoilt) = (None, false);
    }

    /// An argument of this call has been spoilt.
    pub fn spoilt(&self) -> bool {
        self.spoilt
    }

    /// Is it this argument that is spoilt?
    pub fn turn(&mut self) -> bool {
        let now = self.until_bad == Some(0);
        self.until_bad = self.until_bad.and_then(|left| left.checked_sub(1));
        self.spoilt |= now;
        now
    }

    pub fn handle(&mut self) -> *mut feti_problem {
        if !self.turn() {
            return self.p;
        }
        let stranger = std::ptr::without_provenance_mut(self.p.addr().wrapping_add(1 << 20));
        [std::ptr::null_mut(), self.dead, stranger][self.bytes.below(3)]
    }

    /// A number the library compares with one it knows: any other will do.
    pub fn known(&mut self, value: usize) -> i64 {
        let right = value as i64;
        if !self.turn() {
            return right;
        }
        [-1, 0, right + 1, right - 1, i64::MAX, i64::MIN, 1 << 40, right + (1 << 32)][self.bytes.below(8)]
    }

    /// A length the library must believe: one too few, or one that no array has.
    pub fn length(&mut self, value: usize) -> i64 {
        let right = value as i64;
        if !self.turn() {
            return right;
        }
        [-1, right - 1, i64::MAX, i64::MIN, i64::MAX / 8 + 1][self.bytes.below(5)]
    }

    /// Room for a text, which may be as large as the host says.
    pub fn room(&mut self, value: usize) -> i64 {
        let right = value as i64;
        if !self.turn() {
            return right;
        }
        [-1, i64::MIN, right - 1][self.bytes.below(3)]
    }

    /// A code, such as a kind or a storage.
    pub fn code(&mut self, value: i32) -> i32 {
        if !self.turn() {
            return value;
        }
        [-1, 0, value + 1, 7, i32::MAX, i32::MIN][self.bytes.below(6)]
    }

    pub fn array<T>(&mut self, values: &[T]) -> *const T {
        if self.turn() {
            std::ptr::null()
        } else {
            values.as_ptr()
        }
    }

    pub fn out<T: Cell>(&mut self, cells: &mut Out<T>) -> *mut T {
        if self.turn() {
            std::ptr::null_mut()
        } else {
            cells.cells.as_mut_ptr()
        }
    }

    /// Some numbers, one of them perhaps wild.
    pub fn numbers(&mut self, n: usize) -> Vec<f64> {
        let mut values: Vec<f64> = (0..n).map(|_| self.bytes.number()).collect();
        if self.turn() && n > 0 {
            let at = self.bytes.below(n);
            values[at] = self.bytes.wild();
        }
        values
    }

    /// After a call that changes what was given, or reads: a refused one has written nothing and changed no result.
    pub fn done(&mut self, status: i32, written: &[&dyn Written]) -> bool {
        self.note(status);
        if status < 0 {
            assert!(written.iter().all(|buffer| buffer.untouched()), "written with status {status}");
            if let Some(kept) = self.kept {
                assert_eq!(self.results(), kept, "other results after status {status}");
            }
        } else {
            written.iter().for_each(|buffer| buffer.feed(&mut self.digest));
        }
        status >= 0
    }

    /// After a call that may set up or solve, or has changed the problem: results may be others.
    pub fn changed(&mut self) {
        self.kept = None;
    }

    /// Every status is one of the header, a right handle is found, and nothing fails inside.
    pub fn note(&mut self, status: i32) {
        self.digest.feed(status as u64);
        let known = (FETI_SLIDES..=FETI_MARGINAL).contains(&status)
            || (FETI_ARGUMENT - 12..=FETI_ARGUMENT).contains(&status);
        assert!(known, "status {status}");
        assert!(status != FETI_HANDLE || self.spoilt, "the handle was right");
        assert!(status != FETI_BUSY, "nothing else runs");
        if status == FETI_INTERNAL && !self.injected {
            panic!("FETI_INTERNAL: {}", last_error());
        }
    }

    /// Statuses and bits of all results.
    fn results(&self) -> Digest {
        let mut digest = Digest::new();
        let mut feed = |status: i32, written: &dyn Written| {
            digest.feed(status as u64);
            written.feed(&mut digest);
        };
        // SAFETY: every array has the length that is named.
        unsafe {
            for (kind, rows) in KINDS.into_iter().zip(self.rows) {
                let mut lambda = Out::<f64>::new(rows);
                feed(feti_multipliers(self.p, kind, rows as i64, lambda.cells.as_mut_ptr()), &lambda);
            }
            let rows = self.nodes * self.dim;
            let mut tangential = Out::<f64>::new(rows);
            let to = tangential.cells.as_mut_ptr();
            feed(feti_multipliers(self.p, FETI_TANGENTIAL, rows as i64, to), &tangential);
            let mut slack = Out::<f64>::new(self.rows[0]);
            feed(feti_gaps(self.p, self.rows[0] as i64, slack.cells.as_mut_ptr()), &slack);
            for (k, body) in self.bodies.iter().enumerate().filter(|(_, body)| body.n <= LARGEST) {
                let mut u = Out::<f64>::new(body.n);
                feed(feti_displacement(self.p, k as i64, body.n as i64, u.cells.as_mut_ptr()), &u);
            }
        }
        digest
    }
}

impl Drop for Host<'_> {
    fn drop(&mut self) {
        if !self.p.is_null() {
            // SAFETY: leads to a handle.
            unsafe { feti_problem_destroy(&mut self.p) };
        }
    }
}

/// Text of the last error, for reports.
pub fn last_error() -> String {
    let mut text = vec![0_u8; 4096];
    // SAFETY: room for so many characters.
    let length = unsafe { feti_last_error(text.as_mut_ptr().cast(), text.len() as i64) };
    text.truncate(usize::try_from(length).unwrap_or(0).min(4095));
    String::from_utf8_lossy(&text).into_owned()
}
