//! Matrices: what is dependent, singular, regularised; orders of elimination.

/// Root of eps, nearly: what squares or a solution of squared equations cannot tell from 0. Pivots of blocks of rows that may
/// depend, eigenvalues of W, compliances, weights of a proof, the regularisation rho of G G'.
pub const ROOT: f64 = 1e-8;
/// Part of its length, or curvature, that a vector must keep beside others to be independent of them.
pub const DEPENDENT: f64 = 1e-10;
/// Part of the diagonal that is added to a semidefinite matrix: rounding of 1e-16 / 1e-10 in its range.
pub const SHIFT: f64 = 1e-10;
/// Pivots, curvatures, distances of a matrix scaled to unit diagonal that may be 0, since its entries are products with K+.
/// For curvature (P5, P7, P11), on 38 decks and 3000 hard problems: 1e-9 takes 2.7 times the products, 1e-13 a third of them,
/// and 27 instead of 17 answers are wrong beyond a condition of 1e8.
pub const SINGULAR: f64 = 1e-11;
/// Pivots of W_F above this are certainly not 0: rounding is eps / p^2 after two small pivots p, so the cube root of eps. By
/// `SINGULAR` alone 1 to 4 in 100 random cut blocks with open motions are missed.
pub const DOUBTFUL: f64 = 1e-5;
/// Resistance, relative to a matrix scaled to 1 or to the terms of a row, below which a motion is held weakly, and K+ is soft.
/// A tower of 30 blocks on springs of 1e-10 of K: 21 products instead of 520.
pub const WEAK: f64 = 1e-4;
/// What rows outside some faces may add to T'W_pp T = I, if one T serves all faces.
pub const ADDED: f64 = 1e3;
/// The pivot of a held unknown: it is 0 in every solution.
pub const HELD_PIVOT: f64 = 1e200;
/// Weight of a coarse vertex relative to the mean: a graph with much heavier vertices has no good halves.
pub const HEAVIEST: f64 = 1.5;
/// Part of a graph that is left, or is on one side of a separator, at which coarsening, or dissection, ends.
pub const SHRINKS: f64 = 0.95;
/// Weight of a side of a separator relative to half of the total.
#[cfg_attr(feature = "metis", allow(dead_code))]
pub const IMBALANCE: f64 = 1.2;
/// Multiplications of a dissection per entry of the graph of nodes: 25 times those of minimum degree.
pub const DISSECTION: f64 = 500.0;
/// Multiplications from which work is shared among threads.
pub const SHARED_WORK: f64 = 2e7;
/// Multiplications in the time that a solve takes to read an entry of L: 14 GB/s against 25e9 multiplications a second.
pub const READ_OF_L: f64 = 20.0;
/// Solutions between two factorisations.
pub const SOLUTIONS: f64 = 8.0;
/// Part of a common panel that may be zero if a supernode of up to so many columns joins its parent: larger panels make faster
/// products, zeros cost memory and work.
pub const RELAXED: [(usize, f64); 3] = [(12, 0.9), (48, 0.25), (usize::MAX, 0.05)];
