//! Mortar: weighted gaps `int Phi_j n0.(x_m - x_s) dA` over the covered part of the slave, n0 the normal of its sub-faces.
//!
//! On every sub-face points of both sides lie on lines along n0, and Phi is fixed. The openings of a node are therefore linear in the
//! positions, but for the directions in which they are measured:
//!
//! ```text
//! w_j = int Phi_j (x_s - x_m) = sum_k D_jk x_k - sum_l M_jl x_l      D_jk = int Phi_j N_k      M_jl = int Phi_j N_l
//! ```

mod find;
mod hats;
mod integrals;
mod monomials;
mod piece;
mod plane;
mod polygon;
mod quadrature;
mod rows;
mod segments;

pub use find::Mortar;

#[cfg(test)]
mod tests;
