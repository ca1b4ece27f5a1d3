//! The factor L of the free part of a stiffness matrix, and solves with it.

use std::sync::Arc;

use crate::error::Result;
use crate::linalg::cholesky::analysis::elimination::NONE;
use crate::linalg::cholesky::analysis::Analysis;
use crate::numbers::linalg::HELD_PIVOT;

use crate::linalg::cholesky::numeric::multifrontal::{self, LowerColumns};
use crate::linalg::cholesky::numeric::Entry;
use crate::linalg::sparse::csr::by_columns;
use crate::linalg::{Csr, Symmetric};
use crate::platform::memory::{headroom, reserved, zeros, Headroom, PRODUCTS};
use crate::platform::pages::Pages;
use crate::platform::slabs::Slabs;

/// The factor L with its analysis; its entries are doubles by default.
pub struct Cholesky<T: Entry = f64> {
    pub analysis: Arc<Analysis>,
    /// The panels of all supernodes.
    pub(super) values: Pages<T>,
    /// Positions in the order of elimination whose rows and columns of L are those of the identity, ascending.
    pub(super) held: Vec<usize>,
}

/// The factorisation met a pivot that is not positive.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Breakdown {
    pub dof: usize,
    /// The pivot divided by `D_ii` of the metric, that is by the diagonal entry of K it came from if K is semidefinite.
    pub relative_pivot: f64,
}

impl Analysis {
    /// Bytes of L and of the workspace for its computation.
    pub fn bytes(&self) -> usize {
        self.nodes.values() * size_of::<f64>() + self.nodes.bytes() + multifrontal::bytes::<f64>(&self.nodes)
    }

    /// L of `by` times a matrix with the analysed pattern; `Ok(Err(_))` if it is not positive definite.
    pub fn factorize(
        self: &Arc<Self>,
        matrix: &Symmetric,
        by: f64,
    ) -> Result<std::result::Result<Cholesky, Breakdown>> {
        match self.attempt(matrix, by)? {
            Ok(factor) => Ok(Ok(factor)),
            Err(at) => self.breakdown(matrix, by, at).map(Err),
        }
    }

    /// As `factorize`, for a matrix that may be singular; returns the position of a pivot that is not positive.
    pub fn attempt(
        self: &Arc<Self>,
        matrix: &Symmetric,
        by: f64,
    ) -> Result<std::result::Result<Cholesky, usize>> {
        self.pivoted(matrix, by, 0.0)
    }

    /// As `attempt`; if `hold` is positive, pivots up to `hold` are held.
    pub fn pivoted<T: Entry>(
        self: &Arc<Self>,
        matrix: &Symmetric,
        by: f64,
        hold: f64,
    ) -> Result<std::result::Result<Cholesky<T>, usize>> {
        let _room = self.factorisation_headroom()?;
        let columns = self.columns(matrix, by, |_| true)?;
        let values = multifrontal::factorize(&self.nodes, &columns, hold)?;
        Ok(values.map(|values| Cholesky { analysis: Arc::clone(self), values, held: Vec::new() }))
    }

    pub(super) fn factorisation_headroom(&self) -> Result<Headroom> {
        let lists = 3 * self.nodes.bytes() + 4 * self.order.len() * size_of::<usize>();
        headroom(lists + PRODUCTS, "a factorisation")
    }

    /// The lower triangle of `by` times the matrix in the order of elimination, for the columns at some positions.
    pub(super) fn columns(
        &self,
        matrix: &Symmetric,
        by: f64,
        wanted: impl Fn(usize) -> bool + Copy,
    ) -> Result<LowerColumns> {
        let position = &self.position;
        let entries = || {
            (0..matrix.order()).filter(|&i| position[i] != NONE).flat_map(move |i| {
                let row = matrix.lower_row(i).filter(|&(j, _)| position[j] != NONE);
                let places = row.map(move |(j, v)| (position[i], position[j], v));
                let places = places.map(move |(i, j, v)| (i.max(j) as u32, i.min(j), by * v));
                places.filter(move |(_, column, _)| wanted(*column))
            })
        };
        let (ptr, row, val) = by_columns(self.order.len(), entries, "a permuted stiffness matrix")?;
        Ok(LowerColumns { ptr, row, val })
    }

    /// The pivot at position `at`: the Schur complement of the leading block, computed again.
    fn breakdown(&self, matrix: &Symmetric, by: f64, at: usize) -> Result<Breakdown> {
        let dof = self.order[at];
        let diagonal = by * matrix.diagonal(dof);
        Ok(match self.before(matrix, by, at)? {
            Ok((column, x)) => {
                let explained: f64 = (0..x.len()).map(|i| x[i] * column[i]).sum();
                let size = by * matrix.metric(dof, 0.0);
                let relative_pivot = if size > 0.0 { (diagonal - explained) / size } else { 0.0 };
                Breakdown { dof, relative_pivot }
            }
            Err(earlier) => earlier,
        })
    }

    /// The dof that moves most, in the metric of the diagonal, in the motion v that ends at `dof` and has v'K v = its
    /// pivot.
    pub fn fastest(&self, matrix: &Symmetric, by: f64, dof: usize) -> Result<usize> {
        let Ok((_, mut x)) = self.before(matrix, by, self.position[dof])? else { return Ok(dof) };
        x[dof] = 1.0;
        let far = |i: usize| matrix.metric(i, 1.0 / by) * x[i] * x[i];
        Ok((0..x.len()).fold(dof, |best, i| if far(i) > far(best) { i } else { best }))
    }

    /// `K_:a` and `K_ll^-1 K_la`, with a the dof at position `at` and l the dofs before it.
    fn before(&self, matrix: &Symmetric, by: f64, at: usize) -> Result<Before> {
        let leading = Arc::new(Self::of_leading(matrix, &self.order[..at])?);
        let mut column = vec![0.0; matrix.order()];
        let mut unit = column.clone();
        unit[self.order[at]] = 1.0;
        matrix.mul(&unit, &mut column);
        column.iter_mut().for_each(|v| *v *= by);
        let mut x = column.clone();
        (0..x.len()).filter(|&i| leading.position[i] == NONE).for_each(|i| x[i] = 0.0);
        match leading.factorize(matrix, by)? {
            Ok(factor) => factor.solve(&mut x)?,
            Err(earlier) => return Ok(Err(earlier)),
        }
        Ok(Ok((column, x)))
    }
}

/// A column and its product with the inverse of the leading block, or the breakdown of that block.
type Before = std::result::Result<(Vec<f64>, Vec<f64>), Breakdown>;

impl<T: Entry> Cholesky<T> {
    /// Position of a dof in the elimination, `NONE` for held dofs.
    pub(super) fn position(&self, dof: usize) -> usize {
        if self.held.binary_search(&dof).is_ok() {
            NONE
        } else {
            self.analysis.position[dof]
        }
    }

    /// Entries of row i of B at their positions in the elimination, without held dofs.
    pub(super) fn eliminated<'a>(
        &'a self,
        rows: &'a Csr,
        i: usize,
    ) -> impl Iterator<Item = (usize, f64)> + 'a {
        rows.row(i).map(|(dof, v)| (self.position(dof), v)).filter(|(at, _)| *at != NONE)
    }

    /// Pivots `L_ii^2` with their dofs, in the order of elimination.
    pub fn pivots(&self) -> impl Iterator<Item = (usize, f64)> + '_ {
        let pivots = self.analysis.nodes.nodes().flat_map(move |node| {
            let (height, start) = (node.height(), node.panel.start);
            (0..node.width).map(move |i| self.values[start + i * height + i].into().powi(2))
        });
        self.analysis.order.iter().copied().zip(pivots)
    }

    /// The unknowns whose pivots are held, ascending: they are 0 in every solution, as if they did not exist.
    pub fn at_rest(&self) -> Vec<usize> {
        let held = self.pivots().filter(|(_, pivot)| *pivot >= 0.5 * HELD_PIVOT);
        let mut held: Vec<usize> = held.map(|(dof, _)| dof).collect();
        held.sort_unstable();
        held
    }

    /// Smallest pivot `L_ii^2`.
    pub fn smallest_pivot(&self) -> f64 {
        self.pivots().fold(f64::INFINITY, |smallest, (_, pivot)| smallest.min(pivot))
    }
}

impl Cholesky {
    /// L rounded to single precision, stored in `slabs`.
    pub fn rounded(&self, slabs: &Slabs) -> Result<Cholesky<f32>> {
        let mut values = slabs.zeros(self.values.len(), "a rounded Cholesky factor")?;
        values.iter_mut().zip(&*self.values).for_each(|(rounded, value)| *rounded = *value as f32);
        Ok(Cholesky { analysis: Arc::clone(&self.analysis), values, held: self.held.clone() })
    }

    /// The dofs below `dof` in the elimination tree.
    pub fn below(&self, dof: usize) -> Vec<usize> {
        let at = self.analysis.position[dof];
        let nodes = self.analysis.nodes.subtree(self.analysis.nodes.of_column(at));
        self.analysis.order[self.analysis.nodes.node(nodes.start).begin..at].to_vec()
    }

    /// `x <- K_ss^-1 x_s` on the dofs s below `dof` in the elimination tree, 0 on all others: the part that the motion of
    /// a zero pivot moves.
    pub fn solve_below(&self, dof: usize, x: &mut [f64]) -> Result<()> {
        let (order, at) = (&self.analysis.order, self.analysis.position[dof]);
        let nodes = self.analysis.nodes.subtree(self.analysis.nodes.of_column(at));
        let mut y = zeros(order.len(), "a right-hand side")?;
        let below = self.analysis.nodes.node(nodes.start).begin..at;
        below.clone().for_each(|i| y[i] = x[order[i]]);
        let mut workspace = self.workspace()?;
        self.forward(nodes.clone(), &mut y, &mut workspace);
        y[at..].fill(0.0);
        self.backward(nodes, &mut y, &mut workspace);
        x.fill(0.0);
        below.for_each(|i| x[order[i]] = y[i]);
        Ok(())
    }
}

impl<T: Entry> Cholesky<T> {
    /// Bytes of the entries of L.
    pub fn value_bytes(&self) -> usize {
        self.values.len() * size_of::<T>()
    }

    /// `x <- K_ff^-1 x` on the free dofs; x has the length of the body, held entries become 0.
    pub fn solve(&self, x: &mut [f64]) -> Result<()> {
        let order = &self.analysis.order;
        let mut y = reserved(order.len(), "a right-hand side")?;
        y.extend(order.iter().map(|&dof| x[dof]));
        self.held.iter().for_each(|&dof| y[self.analysis.position[dof]] = 0.0);
        let (mut workspace, all) = (self.workspace()?, 0..self.analysis.nodes.count());
        self.forward(all.clone(), &mut y, &mut workspace);
        self.backward(all, &mut y, &mut workspace);
        x.fill(0.0);
        y.iter().zip(order).for_each(|(y, &dof)| x[dof] = *y);
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::platform::Interrupt;

    /// Grid Laplacian n x n plus `shift` on the diagonal.
    pub fn grid(n: usize, shift: f64) -> Symmetric {
        let (mut ptr, mut col, mut val) = (vec![0], Vec::new(), Vec::new());
        for i in 0..n * n {
            let edges = [(i >= n).then(|| i - n), (i % n > 0).then(|| i - 1)];
            for j in edges.into_iter().flatten() {
                col.push(j as u32);
                val.push(-1.0);
            }
            let degree = [i >= n, i % n > 0, i + n < n * n, i % n + 1 < n];
            col.push(i as u32);
            val.push(degree.into_iter().filter(|d| *d).count() as f64 + shift);
            ptr.push(col.len());
        }
        Symmetric::new(ptr, col, val)
    }

    #[test]
    fn the_solution_satisfies_the_equations_of_the_free_dofs() {
        let matrix = grid(17, 0.0);
        let mut held = vec![false; 289];
        held[40] = true;
        let factor =
            Arc::new(Analysis::new(&matrix, &held).unwrap()).factorize(&matrix, 1.0).unwrap().unwrap();
        let b: Vec<f64> = (0..289).map(|i| (i as f64).sin()).collect();
        let (mut x, mut r) = (b.clone(), vec![0.0; 289]);
        factor.solve(&mut x).unwrap();
        assert_eq!(x[40], 0.0);
        matrix.mul(&x, &mut r);
        assert!((0..289).filter(|&i| i != 40).all(|i| (r[i] - b[i]).abs() < 1e-11));
    }

    #[test]
    fn the_solution_below_a_dof_satisfies_the_equations_of_what_it_moves_and_moves_nothing_else() {
        let matrix = grid(17, 0.1);
        let factor = Arc::new(Analysis::new(&matrix, &[false; 289]).unwrap())
            .factorize(&matrix, 1.0)
            .unwrap()
            .unwrap();
        let b: Vec<f64> = (0..289).map(|i| 1.0 + (i as f64).sin()).collect();
        let moved = |dof: usize| {
            let (mut x, mut r) = (b.clone(), vec![0.0; 289]);
            factor.solve_below(dof, &mut x).unwrap();
            matrix.mul(&x, &mut r);
            assert!((0..289).filter(|&i| x[i] != 0.0).all(|i| (r[i] - b[i]).abs() < 1e-11), "{dof}");
            assert_eq!(x[dof], 0.0);
            x.iter().filter(|v| **v != 0.0).count()
        };
        let order = &factor.analysis.order;
        assert_eq!((moved(order[0]), moved(order[288])), (0, 288));
        assert!((0..289).all(|dof| moved(dof) <= factor.analysis.position[dof]));
    }

    #[test]
    fn an_indefinite_matrix_is_refused_with_the_dof_and_its_pivot() {
        let mut matrix = grid(9, 1.0);
        let last = matrix.ptr[31] - 1;
        matrix.val[last] = 0.1;
        let broken = Arc::new(Analysis::new(&matrix, &[false; 81]).unwrap()).factorize(&matrix, 1.0).unwrap();
        let breakdown = broken.err().expect("K_30 was made indefinite");
        assert!(breakdown.relative_pivot < -0.1, "{breakdown:?}");
    }

    /// Random sparse matrices with a dominant diagonal, some dofs held: K x = b on the free dofs.
    #[test]
    fn matrices_of_all_small_orders_and_densities_are_solved() {
        let mut state = 1_u64;
        let mut random = move || {
            state = state.wrapping_mul(0x5851_f42d_4c95_7f2d).wrapping_add(0x1405_7b7e_f767_814f);
            (state >> 33) as f64 / (1_u64 << 31) as f64
        };
        for n in 1..60_usize {
            for density in [0.0, 0.05, 0.2, 0.6, 1.0] {
                let (mut ptr, mut col, mut val) = (vec![0], Vec::new(), Vec::new());
                for i in 0..n {
                    for j in 0..i {
                        if random() < density {
                            col.push(j as u32);
                            val.push(random() - 0.5);
                        }
                    }
                    col.push(i as u32);
                    val.push(n as f64);
                    ptr.push(col.len());
                }
                let matrix = Symmetric::new(ptr, col, val);
                let held: Vec<bool> = (0..n).map(|_| random() < 0.1).collect();
                let analysis = Arc::new(Analysis::new(&matrix, &held).unwrap());
                let factor = analysis.factorize(&matrix, 0.5).unwrap().unwrap();
                let ended = Interrupt::new(Arc::new(true.into())).during(|| analysis.attempt(&matrix, 0.5));
                assert_eq!(ended.is_err(), !analysis.order.is_empty());
                let b: Vec<f64> = (0..n).map(|_| random()).collect();
                let (mut x, mut image) = (b.clone(), vec![0.0; n]);
                factor.solve(&mut x).unwrap();
                matrix.mul(&x, &mut image);
                let wrong =
                    (0..n).filter(
                        |&i| {
                            if held[i] {
                                x[i] != 0.0
                            } else {
                                (0.5 * image[i] - b[i]).abs() > 1e-13
                            }
                        },
                    );
                assert_eq!(wrong.count(), 0, "order {n}, density {density}");
            }
        }
    }
}
