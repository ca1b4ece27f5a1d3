//! From the primal problem (10)-(11) to the dual (12)-(13) and back:
//!
//! ```text
//! F = B K+ B' + C,  d = B K+ f - c,  G = R'B',  e = R'f,   u = K+ (f - B'lambda) + R alpha   (17)
//! ```
//!
//! C = diag(1/k) is the compliance of the rows, which the paper does not have: `B u - c <= C lambda`. B holds the
//! contact rows, then the equality rows, scaled so that `B D^-1 B' + C` has the diagonal 1; forces are in units
//! of 2^p, the size of the largest diagonal entry of K.

mod alike;
mod cost;
mod coupling;
mod elsewhere;
mod ledger;
mod multiples;
mod operator;
mod preconditioner;
mod reuse;
mod springs;
mod turned;

pub use cost::{all_bytes, implicit_bodies, DistinctRows, Size};
pub use coupling::dependent_rows;
pub use elsewhere::Form;
pub use ledger::Ledger;
pub use preconditioner::{constrained, Boundary, BoundaryStiffness, Preconditioner};
pub use reuse::{ColumnCounts, Kept};
pub use turned::{TurnedFace, TurnedRow};

use std::ops::Range;
use std::sync::{Arc, OnceLock};

use crate::body::{Coarse, GeneralizedInverse, InIsland, Joining, LocalDual, Token};
use crate::constraints::Touched;
use crate::dual::multiples::Multiples;
use crate::dual::reuse::Reuse;
use crate::dual::springs::{add_springs, negative_modes};
use crate::error::Result;
use crate::linalg::vector::NOISE;
use crate::linalg::Csr;
use crate::platform::tally;

/// One body in the dual problem.
struct Subdomain {
    /// Rigid modes of the body among all modes.
    modes: Range<usize>,
    kplus: Arc<GeneralizedInverse>,
    /// The power of two by which R_p is divided in G and e, and correspondingly alpha, so that `|G_p|` is in [1, 2).
    size: f64,
    /// Rows of B that touch the body, ascending.
    rows: Vec<usize>,
    /// Those rows, over the unknowns of the body.
    matrix: Arc<Csr>,
    /// `B_p = T B`
    multiples: Multiples,
    /// `B K_p+ B'`, the part of F_p between T and T'; none: F_p is applied through K_p+. On another rank it may be F_p, not assembled.
    operator: Option<Form>,
    /// F_p that may be assembled later.
    later: Option<Box<Later>>,
    /// Power of two by which `K_p+` and its products are multiplied, so that forces of all bodies have one unit.
    by: f64,
    /// Multiplications of a product with F_p, and of a factorisation of K_p.
    work: usize,
    factorisation: f64,
}

/// F_p of a body whose K+ is a function of the host.
struct Later {
    ledger: Arc<Ledger>,
    /// `B K_p+ B'`, once assembled during a solve.
    form: OnceLock<Form>,
}

pub struct Dual {
    subdomains: Vec<Subdomain>,
    /// C, one entry per row of B, no unit.
    pub compliance: Vec<f64>,
    /// `G'` = B R, m x r.
    pub coarse: Csr,
    /// First mode of each body.
    pub blocks: Vec<usize>,
    /// Number of springs of the bodies: the last rows, without entries on unknowns and not known to the host.
    pub springs: usize,
    /// Modes with negative stiffness, with this stiffness < 0 in the scaling of G and alpha.
    pub negative: Vec<(usize, f64)>,
}

/// A body of the dual problem.
pub struct BodyShare {
    pub kplus: Arc<GeneralizedInverse>,
    /// Ratio of the unit of forces to the unit of K in `K_p+`, a power of two.
    pub by: f64,
    /// `F_p` of previous rows.
    pub kept: Option<Box<Kept>>,
    /// Sizes of the body and its F_p.
    pub size: Size,
    /// F_p is applied matrix-free.
    pub implicit: bool,
    /// If it decides when F_p is assembled.
    pub ledger: Option<Arc<Ledger>>,
}

/// A dual problem whose operators `F_p` are still to be assembled, body by body, in any order.
pub struct Draft {
    /// Without operators.
    subdomains: Vec<Subdomain>,
    /// The rows B of each body, and the operator of previous rows for reuse; none if the operator is matrix-free.
    distinct: Vec<(Arc<Csr>, Option<Reuse>)>,
}

impl Draft {
    /// `matrix` is B over the unknowns that rows touch.
    pub fn new(parts: Vec<BodyShare>, touched: &Touched, matrix: &Arc<Csr>) -> Self {
        let orders: Vec<_> = parts.iter().map(|part| part.kplus.order()).collect();
        let local = cut(&orders, touched, matrix);
        let (mut subdomains, mut distinct) =
            (Vec::with_capacity(parts.len()), Vec::with_capacity(parts.len()));
        let mut first = 0;
        for (part, (rows, matrix)) in parts.into_iter().zip(local) {
            let (multiples, own) = Multiples::of(&matrix);
            let is_kept =
                part.ledger.as_ref().is_some_and(|ledger| ledger.opened(part.kept.as_deref(), &own));
            let reuse = (!part.implicit).then(|| Reuse::of(part.kept, &part.kplus, &own));
            let is_due = |reuse: &Reuse| {
                let ledger = part.ledger.as_ref();
                is_kept || ledger.is_none_or(|ledger| ledger.expects(reuse.columns().computed))
            };
            distinct.push((own, reuse.filter(is_due)));
            let modes = first..first + part.kplus.motions();
            first = modes.end;
            subdomains.push(Subdomain {
                modes,
                kplus: part.kplus,
                size: 1.0,
                rows,
                matrix,
                multiples,
                operator: None,
                later: part.ledger.map(|ledger| Box::new(Later { ledger, form: OnceLock::new() })),
                by: part.by,
                work: part.size.work(part.implicit),
                factorisation: part.size.factorisation(),
            });
        }
        Self { subdomains, distinct }
    }

    /// The question for body p if its K+ is on another rank, which then makes `B K_p+ B'`, too, if it is due.
    pub fn joining(&self, p: usize, member: &Token, of: InIsland) -> Option<Joining> {
        let s = &self.subdomains[p];
        let elsewhere = s.kplus.elsewhere()?;
        let form = match &self.distinct[p].1 {
            None => Some((false, None)),
            Some(reuse) if reuse.is_all() => None,
            Some(_) => Some((true, s.multiples.firsts())),
        };
        Some(elsewhere.joining(member, &s.matrix, form, s.by, of))
    }

    /// `B K_p+ B'` of body p, none if it is matrix-free; must be called only once per body, and not if another rank makes it.
    pub fn assemble(&self, p: usize) -> Result<Option<Form>> {
        let (rows, reuse) = &self.distinct[p];
        reuse.as_ref().map(|reuse| reuse.operator(&self.subdomains[p].kplus, rows)).transpose()
    }

    /// Counts of computed and reused columns of all `F_p`.
    pub fn columns(&self) -> ColumnCounts {
        self.distinct.iter().filter_map(|(_, reuse)| reuse.as_ref()).map(Reuse::columns).sum()
    }

    /// The dual problem with these operators and parts of G of bodies on other ranks; `compliance`: the diagonal of C, m entries.
    /// `balanced`: scales R_p so that `|G_p|` is in [1, 2) for every body that rows touch; otherwise R_p is not scaled.
    pub fn finish(
        self,
        made: impl IntoIterator<Item = (Option<Form>, Option<Coarse>)>,
        mut compliance: Vec<f64>,
        balanced: bool,
    ) -> Dual {
        let mut subdomains = self.subdomains;
        let modes = subdomains.last().map_or(0, |s| s.modes.end);
        let mut rows: Vec<Vec<(usize, f64)>> = vec![Vec::new(); compliance.len()];
        for (s, (operator, coarse)) in subdomains.iter_mut().zip(made) {
            s.operator = operator;
            let coarse = coarse.unwrap_or_else(|| s.kplus.coarse(&s.matrix, s.by));
            s.size = if balanced { coarse.size } else { 1.0 };
            for (k, &i) in s.rows.iter().enumerate() {
                rows[i].extend(coarse.matrix.row(k).map(|(j, v)| (s.modes.start + j, v / s.size)));
            }
        }
        let mut coarse = Csr::with_room(modes, rows.len(), rows.iter().map(Vec::len).sum());
        rows.into_iter().for_each(|row| coarse.push_row(row));
        let springs = add_springs(&subdomains, &mut coarse);
        compliance.resize(compliance.len() + springs, 1.0);
        let negative = negative_modes(&subdomains);
        let blocks = subdomains.iter().map(|own| own.modes.start).collect();
        Dual { subdomains, compliance, coarse, blocks, springs, negative }
    }
}

impl Dual {
    /// The operators of the bodies with their rows, for a dual problem with other rows; of those that stay matrix-free none.
    pub fn operators(&self) -> Vec<Option<Box<Kept>>> {
        let kept = |s: &Subdomain| {
            let is_kept = s.explicit().is_some() || s.later.is_some();
            is_kept.then(|| Box::new(Kept::new(Multiples::of(&s.matrix).1, s.explicit().cloned())))
        };
        self.subdomains.iter().map(kept).collect()
    }

    /// Numbers of distinct rows of B over each body of these numbers of unknowns; rows that are multiples of each other
    /// count once. Row `tangential` is the first tangential row.
    pub fn distinct_rows(
        orders: &[usize],
        touched: &Touched,
        matrix: &Arc<Csr>,
        tangential: usize,
    ) -> Vec<DistinctRows> {
        let count = |(rows, local): &(Vec<usize>, Arc<Csr>)| {
            let multiples = Multiples::of(local).0;
            let others = rows.partition_point(|row| *row < tangential);
            DistinctRows { rows: multiples.count, places: multiples.count_of_first(others) }
        };
        cut(orders, touched, matrix).iter().map(count).collect()
    }

    /// Dimension r of the null space of all bodies.
    pub fn modes(&self) -> usize {
        self.coarse.cols
    }

    /// Converts amplitudes of the dual problem to amplitudes of the null spaces `R_p`.
    pub fn amplitudes(&self, alpha: &[f64]) -> Vec<f64> {
        let sizes = self.subdomains.iter().flat_map(|s| s.modes.clone().map(|_| s.size));
        alpha.iter().zip(sizes).map(|(a, size)| a / size).collect()
    }

    /// Body p, of an island with this 2^p and `D~ / 2^p` on its unknowns.
    pub fn local<'a>(&'a self, p: usize, island: f64, metric: &'a [f64]) -> LocalDual<'a> {
        let Subdomain { kplus, matrix, by, size, .. } = &self.subdomains[p];
        LocalDual { kplus, rows: matrix, metric, island, by: *by, size: *size }
    }

    /// The number by which R_p is divided in G and e.
    pub fn size_of(&self, p: usize) -> f64 {
        self.subdomains[p].size
    }

    /// Accuracy of G: parts of `|G_p|` below this are zero.
    pub fn rounding(&self) -> f64 {
        self.subdomains.iter().fold(NOISE, |most, s| most.max(s.kplus.error))
    }

    /// Range of the modes of body p among all modes.
    pub fn modes_of(&self, p: usize) -> Range<usize> {
        self.subdomains[p].modes.clone()
    }

    pub fn bodies(&self) -> usize {
        self.subdomains.len()
    }

    /// `d = B K+ f - c` of (13), from `moved` of each body.
    pub fn rhs(&self, moved: &[Vec<f64>], c: &[f64]) -> Vec<f64> {
        let mut d: Vec<f64> = c.iter().map(|c| -c).collect();
        for (s, moved) in self.subdomains.iter().zip(moved) {
            s.rows.iter().zip(moved).for_each(|(&i, v)| d[i] += v);
        }
        d
    }

    /// `sum_p |B_p u_p|`, row by row: how far the bodies move along the rows at (x, alpha), by `B_p u_p = B_p K_p+ f_p -
    /// F_p x + G_p'alpha`. Independent of the choice of K+, and as accurate as the factors.
    pub fn distances(
        &self,
        moved: &[Vec<f64>],
        x: &[f64],
        alpha: &[f64],
        in_parallel: &InParallel<Vec<f64>>,
    ) -> Result<Vec<f64>> {
        tally::costly();
        let images = self.images(x, None, in_parallel)?;
        let mut distances = vec![0.0; x.len()];
        for ((s, moved), image) in self.subdomains.iter().zip(moved).zip(&images) {
            for ((&i, moved), image) in s.rows.iter().zip(moved).zip(image) {
                let own = self.coarse.row(i).filter(|(mode, _)| s.modes.contains(mode));
                let turned: f64 = own.map(|(mode, g)| g * alpha[mode]).sum();
                distances[i] += (moved - image + turned).abs();
            }
        }
        Ok(distances)
    }

    /// From a number for each body one for each of its modes.
    pub fn of_modes(&self, of_bodies: impl Iterator<Item = f64>) -> Vec<f64> {
        self.subdomains.iter().zip(of_bodies).flat_map(|(s, of)| vec![of; s.modes.len()]).collect()
    }

    /// For each mode the factor for its resultants e for which their norm is `|D R c|_{D^-1}` of the load given by
    /// these resultants.
    pub fn sizes_of_modes(&self) -> Vec<f64> {
        let of = |s: &Subdomain| vec![s.size * s.by.sqrt(); s.modes.len()];
        self.subdomains.iter().flat_map(of).collect()
    }
}

/// Runs tasks 0..count and collects their results in order, or the first error in order.
pub type InParallel<'a, T> = dyn Fn(usize, &(dyn Fn(usize) -> Result<T> + Sync)) -> Result<Vec<T>> + 'a;

/// For bodies of these numbers of unknowns the rows of B that touch each, and their entries over its unknowns; a body that all rows
/// touch alone, at every unknown, shares B.
fn cut(orders: &[usize], touched: &Touched, matrix: &Arc<Csr>) -> Vec<(Vec<usize>, Arc<Csr>)> {
    let is_whole = orders.len() == 1 && touched.len() == orders[0];
    if is_whole && matrix.ptr.windows(2).all(|ends| ends[0] < ends[1]) {
        return vec![((0..matrix.rows()).collect(), Arc::clone(matrix))];
    }
    let mut bodies: Vec<_> = orders.iter().map(|order| (Vec::new(), Csr::empty(*order))).collect();
    for i in 0..matrix.rows() {
        let mut entries = matrix.row(i).peekable();
        while let Some(&(first, _)) = entries.peek() {
            let p = touched.body_of(first);
            let (end, (rows, local)) = (touched.range(p).end, &mut bodies[p]);
            let inside = std::iter::from_fn(|| entries.next_if(|(j, _)| *j < end));
            local.push_row(inside.map(|(j, v)| (touched.dof(j), v)));
            rows.push(i);
        }
    }
    bodies.into_iter().map(|(rows, local)| (rows, Arc::new(local))).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_body_gets_the_rows_that_touch_it_over_its_own_unknowns() {
        let mut matrix = Csr::empty(7);
        matrix.push_row([(0, 1.0), (2, 2.0), (3, 3.0), (6, 4.0)]);
        matrix.push_row([]);
        matrix.push_row([(4, 5.0), (5, 0.0)]);
        matrix.push_row([(1, 6.0), (6, 7.0)]);
        let of = |rows: &[usize], cols: usize, entries: &[&[(usize, f64)]]| {
            let mut local = Csr::empty(cols);
            entries.iter().for_each(|row| local.push_row(row.iter().copied()));
            (rows.to_vec(), Arc::new(local))
        };
        let expected = [
            of(&[0, 3], 2, &[&[(0, 1.0)], &[(1, 6.0)]]),
            of(&[0, 2], 3, &[&[(0, 2.0), (1, 3.0)], &[(2, 5.0)]]),
            of(&[2], 1, &[&[(0, 0.0)]]),
            of(&[0, 3], 1, &[&[(0, 4.0)], &[(0, 7.0)]]),
        ];
        let touched = Touched::of(&[0..2, 2..5, 5..6, 6..7], 0..7);
        assert_eq!(cut(&[2, 3, 1, 1], &touched, &Arc::new(matrix)), expected);
    }
}
