//! Contact mechanics for finite and boundary element codes by FETI duality, after
//! Dostal, Friedlander, Santos, "Solution of Coercive and Semicoercive Contact Problems by FETI Domain
//! Decomposition" (references.md: DFS).
//!
//! The primal problem (10)-(11): bodies with stiffness K = diag(K_1 ... K_s), loads f, contact rows and
//! equality rows
//!
//! ```text
//! 1/2 u'K u - f'u -> min   subject to   B u <= c   and   H u = h
//! ```
//!
//! is solved through its dual (12)-(13), small and with simple bounds,
//!
//! ```text
//! 1/2 l'F l - l'd -> min   subject to   l_I >= 0   and   G l = e
//! F = B K+ B',  d = B K+ f - c,  G = R'B',  e = R'f,   u = K+ (f - B'l) + R alpha
//! ```
//!
//! with B, c stacking both kinds of rows and I the contact rows. Notation: u displacement (length), f load
//! (force), lambda and mu multipliers of contact and equality rows (force), alpha amplitudes of the null
//! space R of K, D = diag K.
//!
//! A problem in Rust: a spring k at a wall, a gap c, a floating block of two unknowns, and a force that pushes
//! the block against the spring.
//!
//! ```
//! use feti_contact::error::Result;
//! use feti_contact::solver::{Modes, Outcome, Problem, RowKind, RowsInput, SparseInput, Storage};
//!
//! fn lower<'a>(ptr: &'a [usize], col: &'a [i64], val: &'a [f64]) -> SparseInput<'a> {
//!     SparseInput { ptr, col, val, storage: Storage::Lower }
//! }
//!
//! fn main() -> Result<()> {
//!     let (k, s, c, force) = (1000.0, 4000.0, 0.5, 100.0); // N/mm, N/mm, mm, N
//!     let mut problem = Problem::new();
//!     let (spring, block) = (problem.add_body(1)?, problem.add_body(2)?);
//!     problem.set_stiffness(spring, lower(&[0, 1], &[0], &[k]))?;
//!     problem.set_stiffness(block, lower(&[0, 1, 3], &[0, 0, 1], &[s, -s, s]))?;
//!     problem.set_null_space(spring, 1, 0, &[], 1, Modes::Exact)?; // K is not singular
//!     problem.set_null_space(block, 2, 1, &[1.0, 1.0], 2, Modes::Exact)?; // K (1, 1)' = 0
//!     problem.set_load(block, &[0.0, -force])?;
//!     let (body, dof, val, gap) = ([0, 1], [0, 0], [1.0, -1.0], [c]); // u1 - u2 <= c
//!     let rows = RowsInput { ptr: &[0, 2], body: Some(&body), dof: &dof, val: &val, rhs: Some(&gap) };
//!     problem.add_rows(RowKind::Inequality, rows)?;
//!     assert_eq!(problem.solve()?.outcome, Outcome::Solved);
//!     assert!((problem.multipliers(RowKind::Inequality)?[0] - force).abs() < 1e-9 * force);
//!     assert!((problem.displacement(block)?[1] + 0.625).abs() < 1e-9); // u2 = -F/k - c, u3 = u2 - F/s
//!     Ok(())
//! }
//! ```
//!
//! The C interface, the crate feti-contact-c, wraps [`solver::Problem`]. For C, Fortran and FORTRAN 77 see README.md.
//!
//! The public face is [`error`] and [`solver`]. Other modules that are `pub`, without documentation, are so for the crates, tests
//! and benches of this repository; nothing of them is promised.
//!
//! | module | contents |
//! |---|---|
//! | [`error`] | the one error type |
//! | `linalg` | vectors, matrices, ordering, sparse Cholesky |
//! | `body` | one body: K_p, R_p, fixing dofs, K_p+ |
//! | `constraints` | B u <= c, H u = h: rows, their compliance and scaling |
//! | `dual` | F, d, G, e, and the recovery of u |
//! | `surface` | faces of meshes: rows between nodes and faces |
//! | `qp` | Sections 4 and 5: knows no bodies |
//! | `certificate` | accuracy of an answer, computed from matrices and rows alone |
//! | `progress` | progress reports, log, cancelling, time limit |
//! | `model` | data given by the host; nothing is computed |
//! | `setup` | data computed once from the model, for any load and gap |
//! | `solve` | presolve, methods, recovery, diagnosis: the answer |
//! | [`solver`] | the problem of a host, which owns one of each |

#[doc(hidden)]
pub mod body;
#[doc(hidden)]
pub mod certificate;
#[doc(hidden)]
pub mod constraints;
mod decomposition;
#[doc(hidden)]
pub mod dual;
pub mod error;
mod gathering;
#[doc(hidden)]
pub mod linalg;
mod mesh;
mod model;
mod numbers;
#[doc(hidden)]
pub mod platform;
mod progress;
#[doc(hidden)]
pub mod qp;
#[doc(hidden)]
pub mod ranks;
mod serving;
mod setup;
mod solve;
pub mod solver;
#[doc(hidden)]
pub mod surface;

// The sources of crate paper, among the unit tests, know this library by its name.
#[cfg(test)]
extern crate self as feti_contact;

#[cfg(doctest)]
#[doc = include_str!("../docs/rust.md")]
struct FromRust;
