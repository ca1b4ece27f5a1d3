//! Sparse Cholesky factorisation `P K_ff P' = L L'` of the free part of a stiffness matrix: supernodes in nested
//! dissection, dense kernels of faer; and operations with the factor.
//!
//! | module | does |
//! |---|---|
//! | `analysis` | order of elimination, pattern of L |
//! | `numeric` | the entries of L, multifrontal |
//! | `factor` | L with its analysis, `K_ff^-1 x` |
//! | `triangular` | solves with L and L' |
//! | `inverse_form` | `B K_ff^-1 B'` |
//! | `renewal` | L of matrices that differ in some columns |
//! | `schur` | the Schur complement of the dofs eliminated last |

mod analysis;
mod factor;
mod inverse_form;
mod numeric;
mod renewal;
mod schur;
mod triangular;

pub use analysis::ordering::order_of_elimination;
pub use analysis::Analysis;
pub use factor::{Breakdown, Cholesky};
pub use inverse_form::inverse_form;
pub use renewal::Renewal;
pub use schur::Trailing;
