//! Structs of the header, without padding: the record functions copy them by bytes.
#![allow(non_camel_case_types)]

use std::ffi::{c_char, c_void};

pub use crate::header::certificate::feti_certificate;
pub use crate::header::communicator::*;
pub use crate::header::constants::*;
pub use crate::header::findings::feti_findings;
pub use crate::header::pairs::feti_pair_facts;

/// A problem: bodies, rows, settings, factors and the last answer. The handle is a counter, never an address.
#[repr(C)]
pub struct feti_problem {
    _private: [u8; 0],
}

/// What went wrong, where and by how much. Numbers count from 0.
#[repr(C)]
#[derive(Debug, Clone, Copy)]
pub struct feti_error_detail {
    /// Set by the caller: size of the struct in bytes.
    pub struct_size: i64,
    /// Status that the function returned; 0: no error has occurred yet.
    pub status: i32,
    /// Position of the refused argument, where the handle is argument 1; 0: none.
    pub argument: i32,
    /// Body; -1: does not apply.
    pub body: i64,
    /// Connected part of the body; -1: does not apply.
    pub component: i64,
    /// Unknown of the body; -1: does not apply.
    pub dof: i64,
    /// Row of the matrix or of the constraints; -1: does not apply.
    pub row: i64,
    /// Position in the array, or of the byte in a text or a file; -1: does not apply.
    pub entry: i64,
    /// The number that was found; an index is as the host gave it, in the base of the call; NaN: does not apply.
    pub value: f64,
    /// The limit for this number; NaN: does not apply.
    pub limit: f64,
    /// Name of the function that failed, NUL terminated.
    pub function: [c_char; 40],
    /// Element of the body; -1: does not apply.
    pub element: i64,
    /// Node with friction; with `pair` or `face`, or if a surface is refused, a node of the surface; -1: does not apply.
    pub node: i64,
    /// Rank whose numbers these are, if several have given bodies or rows; -1: does not apply.
    pub rank: i64,
    /// Pair of surfaces; -1: does not apply.
    pub pair: i64,
    /// Face of the surface; -1: does not apply.
    pub face: i64,
}

/// An option: name, text, default and range.
#[repr(C)]
#[derive(Debug, Clone, Copy)]
pub struct feti_option {
    /// Set by the caller: size of the struct in bytes.
    pub struct_size: i64,
    /// FETI_OPTION_F64, FETI_OPTION_I64 or FETI_OPTION_STR.
    pub r#type: i32,
    /// Zero.
    pub reserved: i32,
    /// Smallest value of a number or an integer.
    pub minimum: f64,
    /// Largest value of a number or an integer.
    pub maximum: f64,
    /// Default of a number or an integer; NaN for a text.
    pub default_f64: f64,
    /// Default of an integer.
    pub default_i64: i64,
    /// Name, static.
    pub name: *const c_char,
    /// One sentence, static.
    pub doc: *const c_char,
    /// Default of a text, static.
    pub default_str: *const c_char,
}

/// Report of a solve. If the call failed early, counts are zero and measured values are NaN. If some groups of bodies
/// have an answer and others have none, the counts of work, the energy and the certificate cover only the groups with an
/// answer.
#[repr(C)]
#[derive(Debug, Clone, Copy)]
pub struct feti_info {
    /// Set by the caller: size of the struct in bytes.
    pub struct_size: i64,
    /// What feti_solve returned: the worst status of all groups of bodies.
    pub status: i32,
    /// Zero.
    pub reserved: i32,
    /// Bodies.
    pub bodies: i64,
    /// Unknowns of all bodies.
    pub dofs: i64,
    /// Inequality rows.
    pub rows: i64,
    /// Equality rows.
    pub equalities: i64,
    /// Dimension of the null spaces of all bodies.
    pub floating_modes: i64,
    /// Inequality rows that are closed in the answer.
    pub active: i64,
    /// Number of motions that neither loads nor rows determine; the answer is the one with the least sum of `K_ii u_i^2`.
    pub undetermined: i64,
    /// Steps of the active-set method.
    pub steps: i64,
    /// Steps of conjugate gradients on a face.
    pub cg_steps: i64,
    /// Steps that reached a bound.
    pub expansions: i64,
    /// Steps that left a face.
    pub releases: i64,
    /// Products with the dual operator F.
    pub dual_applications: i64,
    /// Solutions of the coarse problem.
    pub coarse_solves: i64,
    /// Numeric factorisations for K+ since the problem was created; equal bodies share a factorisation.
    pub factorisations: i64,
    /// Symbolic analyses since the problem was created; bodies with the same pattern share an analysis.
    pub analyses: i64,
    /// Largest ratio of an entry of the certificate to its limit, over all bodies and rows with an answer; <= 1 passes.
    pub worst: f64,
    /// Relative error of equilibrium of the worst body, as in feti_certificate.
    pub equilibrium: f64,
    /// Relative error of the balance of forces on the worst floating body.
    pub balance: f64,
    /// Relative penetration of the worst row.
    pub penetration: f64,
    /// Relative error of the worst equality row.
    pub equality: f64,
    /// Relative size of a force with the wrong sign, for the worst row.
    pub negative_force: f64,
    /// Relative error of complementarity of the worst row.
    pub complementarity: f64,
    /// Relative gap between primal and dual energy of the worst group of bodies.
    pub duality_gap: f64,
    /// Energy of the bodies, 1/2 u'Ku - f'u, plus energy of the springs of compliant rows, 1/2 lambda'C lambda + 1/2 mu'C
    /// mu; force times length.
    pub energy: f64,
    /// Seconds for null spaces and factors.
    pub seconds_setup: f64,
    /// Seconds for the rest.
    pub seconds_solve: f64,
    /// Number of faces on which the dual problem was solved directly.
    pub direct_solves: i64,
    /// 1: a direct solve finished the answer (option finish); 0: a direct solve was not requested, not needed, or brought
    /// no improvement.
    pub finished: i64,
    /// Columns of the dual operators of the bodies (one column for each body that a row touches) computed since the
    /// problem was created.
    pub columns_computed: i64,
    /// Columns that were reused after a change of rows or bodies since the problem was created: those of bodies whose rows
    /// are unchanged, and, on bodies given as functions, those of rows that are unchanged.
    pub columns_kept: i64,
    /// Bodies whose dual operator is assembled (option dual_operator).
    pub explicit_operators: i64,
    /// Bodies whose dual operator is applied matrix-free.
    pub implicit_operators: i64,
    /// Bytes of the factors of all bodies plus an upper bound for the work arrays of their computation.
    pub factor_bytes: i64,
    /// Bytes of the assembled dual operators.
    pub operator_bytes: i64,
    /// Relative excess of a tangential force over its bound, for the worst node with friction.
    pub friction_cone: f64,
    /// Relative deficit of frictional work: where a node slips, its force is too small or has another direction than the
    /// slip; for the worst node.
    pub friction_work: f64,
    /// Relative slip although the force is within its bound, for the worst node.
    pub friction_stick: f64,
    /// Nodes with friction.
    pub nodes: i64,
    /// Nodes that stick in the answer.
    pub sticking: i64,
    /// Nodes that slip in the answer.
    pub slipping: i64,
    /// Newton steps of friction.
    pub friction_steps: i64,
    /// Number of starts of the Newton method of friction, over all groups of bodies with friction.
    pub friction_starts: i64,
    /// Number of ranks, 1 without feti_communicator_set.
    pub ranks: i64,
    /// Messages that this rank has sent and received since its first problem with this stream of messages.
    pub messages: i64,
    /// Bytes of these messages.
    pub message_bytes: i64,
    /// Seconds in which this rank has waited for other ranks.
    pub seconds_waited: f64,
    /// Processor seconds of the calling thread in the last setup or solve, without work of its own bodies and without
    /// waiting: what other ranks cannot take from rank 0. NaN with one rank.
    pub seconds_leading: f64,
}

/// Facts on the input of a body and on the results of its last setup; facts that are not known yet are -1 or NaN.
#[repr(C)]
#[derive(Debug, Clone, Copy)]
pub struct feti_body_facts {
    /// Set by the caller: size of the struct in bytes.
    pub struct_size: i64,
    /// Unknowns.
    pub unknowns: i64,
    /// Entries of K as the host gave them, including a separate diagonal; for a dense matrix all entries of the storage.
    pub entries: i64,
    /// Connected parts of K.
    pub components: i64,
    /// Bytes that the library keeps for K.
    pub matrix_bytes: i64,
    /// Arrays of K that are borrowed from the host (FETI_BORROW): 0 none, 1 values, 2 values and columns.
    pub borrowed: i64,
    /// Source of the null space: FETI_ORIGIN_EXACT, _CANDIDATES, _COORDINATES or _FOUND.
    pub origin: i64,
    /// Dimension of the null space.
    pub null_space: i64,
    /// Entries of the factor.
    pub factor_entries: i64,
    /// Bytes of the factor plus an upper bound for the work arrays of its computation.
    pub factor_bytes: i64,
    /// The first other body that shares the factor, from 0; -1: none.
    pub shared_with: i64,
    /// 1: the dual operator is assembled; 0: it is applied matrix-free.
    pub explicit_operator: i64,
    /// Bytes of the assembled dual operator.
    pub operator_bytes: i64,
    /// If the library found the null space: ratio of the stiffness of the softest motion outside it to the stiffness of
    /// the stiffest motion in it; otherwise NaN.
    pub gap: f64,
    /// Estimated relative error of the forces on the body in the last answer; NaN if its group of bodies has no answer.
    pub force_error: f64,
    /// Number of motions treated as free although K resists them, by no more than rounding of its entries can cause; -1
    /// before a setup.
    pub soft_free: i64,
    /// Number of motions treated as supported although perhaps only rounding of the entries of K resists them. If it is
    /// above 0, give the null space, or K with more digits. -1 before a setup.
    pub soft_held: i64,
    /// Stiffness of these motions: the largest v'K v over v'diag(K) v; NaN without such motions.
    pub softness: f64,
    /// The stiffness that rounding of the entries can cause; NaN without such motions.
    pub softness_of_rounding: f64,
    /// Number of pieces that the body is cut into, known when all elements have been given; 1 if the body is not cut.
    pub pieces: i64,
}

/// Time and memory of a phase of a setup or a solve.
#[repr(C)]
#[derive(Debug, Clone, Copy)]
pub struct feti_phase {
    /// Set by the caller: size of the struct in bytes.
    pub struct_size: i64,
    /// Bytes of the data that the phase computed and keeps; 0: not counted.
    pub bytes: i64,
    /// Wall time in the last setup or solve, seconds.
    pub seconds: f64,
    /// Name, static.
    pub name: *const c_char,
}

/// Progress of a setup or a solve.
#[repr(C)]
#[derive(Debug, Clone, Copy)]
pub struct feti_progress {
    /// Size of the struct in bytes, set by the library.
    pub struct_size: i64,
    /// FETI_PHASE_SETUP (a body has been analysed or factorised, its dual operator or the preconditioner has been
    /// computed, or half a second has passed) or FETI_PHASE_SOLVE.
    pub phase: i32,
    /// FETI_STEP_CONJUGATE_GRADIENT, FETI_STEP_EXPANSION, FETI_STEP_RELEASE or, with friction, FETI_STEP_NEWTON; 0 in the setup.
    pub step: i32,
    /// Steps so far.
    pub steps: i64,
    /// Products with the dual operator F so far.
    pub products: i64,
    /// Inequality rows with a force.
    pub active: i64,
    /// Norm of the projected gradient divided by the norm at which the solve stops; NaN in the setup, like the next three
    /// entries.
    pub residual: f64,
    /// Norm of its part on rows with a force, divided by the same norm.
    pub residual_free: f64,
    /// Norm of its part on rows that have no force but need one, divided by the same norm.
    pub residual_chopped: f64,
    /// Dual functional 1/2 lambda'F lambda - lambda'd, force times length; every step lowers it.
    pub theta: f64,
    /// Seconds since the call began, also in the setup.
    pub seconds: f64,
    /// Estimated fraction of the setup that is done, from 0 to 1; it never decreases; NaN in the solve.
    pub fraction: f64,
}

/// A function of the host that is called for every body in every part of a setup and for every step of a solve.
///
/// It returns 0 to continue, a number > 0 to cancel, or a number < 0 to report a failure.
///
/// | argument | in/out | shape | rule |
/// |---|---|---|---|
/// | `user` | in | scalar | the host's own data, as given to feti_on_progress; may be NULL |
/// | `now` | in | scalar | valid during the call |
pub type feti_progress_fn = Option<unsafe extern "C" fn(user: *mut c_void, now: *const feti_progress) -> i32>;

/// A function of the host that receives a line of text.
///
/// It returns 0 to continue and any other number to report a failure.
///
/// | argument | in/out | shape | rule |
/// |---|---|---|---|
/// | `user` | in | scalar | the host's own data, as given to feti_on_log; may be NULL |
/// | `level` | in | scalar | FETI_LOG_RESULT, FETI_LOG_PHASE or FETI_LOG_STEP |
/// | `text` | in | text | one line in UTF-8 without a line end, valid during the call |
pub type feti_log_fn =
    Option<unsafe extern "C" fn(user: *mut c_void, level: i32, text: *const c_char) -> i32>;
/// A function of the host that multiplies by a matrix A that the host keeps: Y = A X.
///
/// It returns 0 on success and any other number to report a failure. X and Y never overlap.
///
/// | argument | in/out | shape | rule |
/// |---|---|---|---|
/// | `user` | in | scalar | the host's own data, as given to feti_body_operator; may be NULL |
/// | `body` | in | scalar | number of the body, from 0 |
/// | `n` | in | scalar | unknowns of the body |
/// | `nrhs` | in | scalar | columns of X and Y, 1 to 32 |
/// | `x` | in | ldx * nrhs | X, column-major, finite |
/// | `ldx` | in | scalar | >= n |
/// | `y` | out | ldy * nrhs | Y, column-major; contains zeros on entry |
/// | `ldy` | in | scalar | >= n |
pub type feti_operator_fn = Option<
    unsafe extern "C" fn(
        user: *mut c_void,
        body: i64,
        n: i64,
        nrhs: i64,
        x: *const f64,
        ldx: i64,
        y: *mut f64,
        ldy: i64,
    ) -> i32,
>;
