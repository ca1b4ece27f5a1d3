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
//! | module | what it holds |
//! |---|---|
//! | [`error`] | the one error type |
//! | [`linalg`] | vectors, matrices, ordering, sparse Cholesky |
//! | [`body`] | one body: K_p, R_p, fixing dofs, K_p+ |
//! | [`constraints`] | B u <= c, H u = h: rows, their compliance and scaling |
//! | [`dual`] | F, d, G, e and the way back |
//! | [`qp`] | Sections 4 and 5: knows no bodies |
//! | [`solver`] | register, set up, solve, certify, report |
//! | [`ffi`] | the C interface |

pub mod body;
pub mod constraints;
pub mod dual;
pub mod error;
pub mod ffi;
pub mod linalg;
pub mod qp;
pub mod solver;
