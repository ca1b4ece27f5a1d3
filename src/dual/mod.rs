//! From the primal problem (10)-(11) to the dual (12)-(13) and back:
//!
//! ```text
//! F = B K+ B' + C,  d = B K+ f - c,  G = R'B',  e = R'f,   u = K+ (f - B'lambda) + R alpha   (17)
//! ```
//!
//! C = diag(1/k) is the compliance of the rows, which the paper does not have: `B u - c <= C lambda`. B holds the
//! contact rows, then the equality rows, scaled so that `B D^-1 B' + C` has the diagonal 1; forces are in units
//! of 2^p, the size of the largest diagonal entry of K.

mod coupling;
mod entries;
mod multiples;
mod preconditioner;
mod reuse;

pub use coupling::dependent_rows;
pub use preconditioner::{constrained, Boundary, Preconditioner};
pub use reuse::{Columns, Kept};

use std::ops::Range;
use std::sync::Arc;

use crate::body::GeneralizedInverse;
use crate::dual::multiples::Multiples;
use crate::dual::reuse::Reuse;
use crate::error::Result;
use crate::linalg::memory::zeros;
use crate::linalg::vector::{dot, norm_max};
use crate::linalg::{Csr, Operator, Packed};

/// One body as the dual sees it.
struct Subdomain {
    /// Unknowns of the body among all unknowns.
    range: Range<usize>,
    /// Rigid modes of the body among all modes.
    modes: Range<usize>,
    kplus: Arc<GeneralizedInverse>,
    /// Rows of B that touch the body, ascending.
    rows: Vec<usize>,
    /// Those rows, over the unknowns of the body.
    matrix: Csr,
    /// `B_p = T B`
    multiples: Multiples,
    /// `B K_p+ B'`: F_p between T and T'.
    operator: Packed,
}

impl Subdomain {
    /// `B K_p+ B' T' x`; `local` gets T'x.
    fn image(&self, x: &[f64], local: &mut Vec<f64>, image: &mut Vec<f64>) {
        self.multiples.gather(&self.rows, x, local);
        image.resize(local.len(), 0.0);
        self.operator.apply(local, image);
    }
}

pub struct Dual {
    subdomains: Vec<Subdomain>,
    /// C, one entry per row of B, no unit.
    compliance: Vec<f64>,
    /// `G'` = B R, m x r.
    pub coarse: Csr,
    /// What became of the columns of all `F_p`.
    pub columns: Columns,
}

/// A body and its place among all unknowns.
pub struct Part {
    pub range: Range<usize>,
    pub kplus: Arc<GeneralizedInverse>,
    /// `F_p` of other rows.
    pub kept: Option<Kept>,
}

impl Dual {
    /// `matrix` is B, m x n, `compliance` the diagonal of C; `in_parallel` runs independent tasks, each with its
    /// number, in any order.
    pub fn new(
        mut parts: Vec<Part>,
        matrix: &Csr,
        compliance: Vec<f64>,
        in_parallel: &InParallel,
    ) -> Result<Self> {
        let local: Vec<_> = parts.iter().map(|part| cut(&part.range, matrix)).collect();
        let (multiples, distinct): (Vec<_>, Vec<_>) =
            local.iter().map(|(_, matrix)| Multiples::of(matrix)).unzip();
        let kept = parts.iter_mut().zip(&distinct).map(|(part, rows)| Reuse::of(part.kept.take(), rows));
        let kept: Vec<Reuse> = kept.collect();
        let columns = kept.iter().map(Reuse::columns).sum();
        let assemble = |p: usize| kept[p].operator(&parts[p].kplus, &distinct[p]);
        let operators = in_parallel(parts.len(), &assemble)?.into_iter().zip(multiples);
        let mut first = 0;
        let mut subdomains = Vec::with_capacity(parts.len());
        for ((part, (rows, matrix)), (operator, multiples)) in parts.into_iter().zip(local).zip(operators) {
            let modes = first..first + part.kplus.null_space.cols;
            first = modes.end;
            subdomains.push(Subdomain {
                range: part.range,
                modes,
                kplus: part.kplus,
                rows,
                matrix,
                multiples,
                operator,
            });
        }
        let coarse = coarse(&subdomains, matrix.rows(), first);
        Ok(Self { subdomains, compliance, coarse, columns })
    }

    /// The operators of the bodies with their rows, for a dual problem of other rows.
    pub fn into_operators(self) -> Vec<Kept> {
        self.subdomains.into_iter().map(|s| Kept::new(Multiples::of(&s.matrix).1, s.operator)).collect()
    }

    /// Bytes that explicit operators take for these bodies and rows.
    pub fn bytes(ranges: impl Iterator<Item = Range<usize>>, matrix: &Csr) -> usize {
        ranges.map(|range| Packed::bytes(Multiples::of(&cut(&range, matrix).1).0.count)).sum()
    }

    /// Multiplications of a product with F.
    pub fn product_work(&self) -> usize {
        self.subdomains.iter().map(|s| s.multiples.count * s.multiples.count).sum()
    }

    /// Dimension r of the null space of all bodies.
    pub fn modes(&self) -> usize {
        self.coarse.cols
    }

    /// Modes of body p among all modes.
    pub fn modes_of(&self, p: usize) -> Range<usize> {
        self.subdomains[p].modes.clone()
    }

    pub fn bodies(&self) -> usize {
        self.subdomains.len()
    }

    /// `B_p K_p+ f_p` over the rows that touch body p: what its load alone moves.
    pub fn moved(&self, p: usize, f: &[f64]) -> Result<Vec<f64>> {
        let s = &self.subdomains[p];
        let mut x = zeros(s.range.len(), "a displacement")?;
        s.kplus.apply(&f[s.range.clone()], &mut x)?;
        Ok((0..s.rows.len()).map(|k| s.matrix.row_dot(k, &x)).collect())
    }

    /// `d = B K+ f - c` of (13), from what the loads move, body by body.
    pub fn rhs(&self, moved: &[Vec<f64>], c: &[f64]) -> Vec<f64> {
        let mut d: Vec<f64> = c.iter().map(|c| -c).collect();
        for (s, moved) in self.subdomains.iter().zip(moved) {
            s.rows.iter().zip(moved).for_each(|(&i, v)| d[i] += v);
        }
        d
    }

    /// `sum_p |B_p u_p|`, row by row: how far the bodies move along the rows at (x, alpha), by
    /// `B_p u_p = B_p K_p+ f_p - F_p x + G_p'alpha`. The same for every choice of K+.
    pub fn distances(&self, moved: &[Vec<f64>], x: &[f64], alpha: &[f64]) -> Vec<f64> {
        let mut distances = vec![0.0; x.len()];
        let (mut local, mut image) = (Vec::new(), Vec::new());
        for (s, moved) in self.subdomains.iter().zip(moved) {
            s.image(x, &mut local, &mut image);
            for ((&i, moved), image) in s.rows.iter().zip(moved).zip(s.multiples.spread(&image)) {
                let own = self.coarse.row(i).filter(|(mode, _)| s.modes.contains(mode));
                let turned: f64 = own.map(|(mode, g)| g * alpha[mode]).sum();
                distances[i] += (moved - image + turned).abs();
            }
        }
        distances
    }

    /// The right-hand side of `G lambda = e` in (12), `e = R'f`; what rounding alone would leave of a load in balance is zero.
    pub fn resultants(&self, f: &[f64]) -> Vec<f64> {
        let mut e = vec![0.0; self.modes()];
        for s in &self.subdomains {
            for (k, mode) in s.modes.clone().enumerate() {
                let (motion, f) = (s.kplus.null_space.col(k), &f[s.range.clone()]);
                let size = norm_max(motion) * f.iter().map(|f| f.abs()).sum::<f64>();
                e[mode] = Some(dot(motion, f)).filter(|e| e.abs() > ROUNDING * size).unwrap_or(0.0);
            }
        }
        e
    }

    /// `u_p = K_p+ f_p + R_p alpha_p` of body p: (17) for the load f that the forces of the rows leave; (16) where it is
    /// held, K+ = K^-1. The load and alpha are those of all bodies.
    pub fn displacement(&self, p: usize, f: &[f64], alpha: &[f64]) -> Result<Vec<f64>> {
        let s = &self.subdomains[p];
        let mut u = zeros(s.range.len(), "a displacement")?;
        s.kplus.apply(&f[s.range.clone()], &mut u)?;
        s.kplus.null_space.mul_add(1.0, &alpha[s.modes.clone()], &mut u);
        Ok(u)
    }

    /// `v = R a`, over all unknowns.
    pub fn rigid_motion(&self, a: &[f64], unknowns: usize) -> Vec<f64> {
        let mut v = vec![0.0; unknowns];
        for s in &self.subdomains {
            s.kplus.null_space.mul_add(1.0, &a[s.modes.clone()], &mut v[s.range.clone()]);
        }
        v
    }
}

/// Runs tasks 0..count and collects their results in order, or the first error in order.
pub type InParallel<'a> =
    dyn Fn(usize, &(dyn Fn(usize) -> Result<Packed> + Sync)) -> Result<Vec<Packed>> + 'a;

impl Operator for Dual {
    fn order(&self) -> usize {
        self.compliance.len()
    }

    /// The operator of (12)-(13): `y = F x = C x + sum_p B_p K_p+ B_p' x`, body after body.
    fn apply(&self, x: &[f64], y: &mut [f64]) {
        y.iter_mut().zip(x).zip(&self.compliance).for_each(|((y, x), c)| *y = c * x);
        let (mut local, mut image) = (Vec::new(), Vec::new());
        for s in &self.subdomains {
            s.image(x, &mut local, &mut image);
            s.multiples.scatter(&s.rows, &image, y);
        }
    }
}

/// Rows of B with an entry in the range.
fn touching(range: &Range<usize>, matrix: &Csr) -> Vec<usize> {
    (0..matrix.rows()).filter(|&i| matrix.row(i).any(|(j, _)| range.contains(&j))).collect()
}

/// The rows of B that touch the body in this range and their entries over its own unknowns.
fn cut(range: &Range<usize>, matrix: &Csr) -> (Vec<usize>, Csr) {
    let rows = touching(range, matrix);
    let mut local = Csr::empty(range.len());
    for &i in &rows {
        let inside = matrix.row(i).filter(|(j, _)| range.contains(j));
        local.push_row(inside.map(|(j, v)| (j - range.start, v)));
    }
    (rows, local)
}

/// `G' = B R`, m x r; entries that are nothing but rounding are left out.
fn coarse(subdomains: &[Subdomain], m: usize, modes: usize) -> Csr {
    let mut rows: Vec<Vec<(usize, f64)>> = vec![Vec::new(); m];
    for s in subdomains {
        for (j, mode) in s.modes.clone().enumerate() {
            let motion = s.kplus.null_space.col(j);
            let fastest = norm_max(motion);
            for (k, &i) in s.rows.iter().enumerate() {
                let entry = s.matrix.row_dot(k, motion);
                let size = fastest * s.matrix.row(k).map(|(_, v)| v.abs()).sum::<f64>();
                if entry.abs() > ROUNDING * size {
                    rows[i].push((mode, entry));
                }
            }
        }
    }
    let mut coarse = Csr::empty(modes);
    rows.into_iter().for_each(|row| coarse.push_row(row));
    coarse
}

/// A product with a rigid motion is nothing but rounding when it is this small against the product of the
/// sizes: the motion itself is known to rounding of its fastest dof only.
const ROUNDING: f64 = 64.0 * f64::EPSILON;
