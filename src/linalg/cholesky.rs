//! Sparse Cholesky factorisation `P K_ff P' = L L'` of the free part of a stiffness matrix.
//! Supernodal kernels of faer, sequential: the same bits on any number of threads.

use std::sync::Arc;

use faer::dyn_stack::{MemBuffer, MemStack, StackReq};
use faer::linalg::cholesky::llt::factor::{LltError, LltParams};
use faer::sparse::linalg::cholesky::simplicial::{
    prefactorize_symbolic_cholesky, prefactorize_symbolic_cholesky_scratch,
};
use faer::sparse::linalg::cholesky::supernodal::{
    factorize_supernodal_numeric_llt, factorize_supernodal_numeric_llt_scratch,
    factorize_supernodal_symbolic_cholesky, factorize_supernodal_symbolic_cholesky_scratch, SupernodalLltRef,
    SymbolicSupernodalCholesky,
};
use faer::sparse::{SparseColMatRef, SymbolicSparseColMatRef};
use faer::{Conj, MatMut, Par, Spec};

use crate::error::{Error, Kind, Result};
use crate::linalg::elimination::{elimination_tree, postorder, NONE};
use crate::linalg::memory::{refusal, reserved, room, zeros, PRODUCTS};
use crate::linalg::ordering::nested_dissection;
use crate::linalg::Symmetric;

/// Bytes that ordering and symbolic analysis take at most, per dof and per entry of the lower triangle: grids of all
/// dimensions, chains, stars and diagonal matrices take up to 4/5 of it.
const ANALYSIS_PER_DOF: usize = 256;
const ANALYSIS_PER_ENTRY: usize = 128;

/// Order of elimination and pattern of L: depends on the pattern of K and the held dofs only.
pub struct Analysis {
    /// Dof eliminated at each position.
    pub order: Vec<usize>,
    /// Position of each dof, `NONE` for held dofs.
    pub position: Vec<usize>,
    pub symbolic: SymbolicSupernodalCholesky<usize>,
}

/// The factor L with its analysis.
pub struct Cholesky {
    pub analysis: Arc<Analysis>,
    pub(super) values: Vec<f64>,
    /// Dofs in the order of elimination whose rows and columns of L are those of the identity, ascending.
    pub(super) held: Vec<usize>,
}

/// The factorisation met a pivot that is not positive.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Breakdown {
    pub dof: usize,
    /// The pivot divided by the diagonal entry of K it came from.
    pub relative_pivot: f64,
}

impl Analysis {
    pub fn new(matrix: &Symmetric, held: &[bool]) -> Result<Self> {
        let bytes = matrix.order() * ANALYSIS_PER_DOF + matrix.val.len() * ANALYSIS_PER_ENTRY;
        let _room = room(bytes, "the ordering of a body")?;
        Self::in_order(matrix, nested_dissection(matrix, held)?)
    }

    /// For `matrix` with the dofs `last` eliminated last, in this order; `graph`, which it may have more couplings
    /// than among those dofs, decides on the order of the others.
    pub fn ending(graph: &Symmetric, matrix: &Symmetric, last: &[usize]) -> Result<Self> {
        let bytes = matrix.order() * ANALYSIS_PER_DOF + matrix.val.len() * ANALYSIS_PER_ENTRY;
        let _room = room(bytes, "the ordering of a body")?;
        let mut is_last = vec![false; matrix.order()];
        last.iter().for_each(|&dof| is_last[dof] = true);
        let mut order = nested_dissection(graph, &is_last)?;
        order.extend(last);
        Self::in_order(matrix, order)
    }

    /// `order` lists the dofs to eliminate; it is rearranged into a postorder of its elimination tree
    /// (same fill, far fewer supernodes).
    fn in_order(matrix: &Symmetric, order: Vec<usize>) -> Result<Self> {
        let position = positions(matrix.order(), &order);
        let upper = permuted((matrix, 1.0), &position, order.len(), Triangle::Upper)?;
        let tree = elimination_tree(&upper.ptr, &upper.row);
        let order: Vec<usize> = postorder(&tree).into_iter().map(|k| order[k]).collect();
        let position = positions(matrix.order(), &order);
        let upper = permuted((matrix, 1.0), &position, order.len(), Triangle::Upper)?;
        let symbolic = symbolic(order.len(), &upper.ptr, &upper.row)?;
        Ok(Self { order, position, symbolic })
    }

    /// Bytes of L and of the workspace its computation needs.
    pub fn bytes(&self) -> usize {
        self.symbolic.len_val() * size_of::<f64>() + self.scratch().unaligned_bytes_required()
    }

    fn scratch(&self) -> StackReq {
        let params = Spec::<LltParams, f64>::default();
        factorize_supernodal_numeric_llt_scratch::<usize, f64>(&self.symbolic, Par::Seq, params)
    }

    /// L of `by` times a matrix with the pattern that was analysed; `Ok(Err(_))` where it is not positive definite.
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

    /// As `factorize`, but for a matrix that may well be singular; gives the position where it broke down.
    pub fn attempt(
        self: &Arc<Self>,
        matrix: &Symmetric,
        by: f64,
    ) -> Result<std::result::Result<Cholesky, usize>> {
        let positions = 4 * self.order.len() * size_of::<usize>();
        let _room = room(positions + PRODUCTS, "a factorisation")?;
        let mut values = zeros(self.symbolic.len_val(), "a Cholesky factor")?;
        let mut workspace = workspace(self.scratch())?;
        let n = self.order.len();
        let lower = permuted((matrix, by), &self.position, n, Triangle::Lower)?;
        let pattern = SymbolicSparseColMatRef::new_unsorted_checked(n, n, &lower.ptr, None, &lower.row);
        let done = factorize_supernodal_numeric_llt(
            &mut values,
            SparseColMatRef::new(pattern, &lower.val),
            Default::default(),
            &self.symbolic,
            Par::Seq,
            MemStack::new(&mut workspace),
            Spec::default(),
        );
        Ok(match done {
            Ok(_) => Ok(Cholesky { analysis: Arc::clone(self), values, held: Vec::new() }),
            Err(LltError::NonPositivePivot { index }) => Err(index),
        })
    }

    /// The pivot at position `at`: the Schur complement of the leading block, computed afresh
    /// (faer reports the position only).
    fn breakdown(&self, matrix: &Symmetric, by: f64, at: usize) -> Result<Breakdown> {
        let dof = self.order[at];
        let analysis = matrix.order() * ANALYSIS_PER_DOF + matrix.val.len() * ANALYSIS_PER_ENTRY;
        let _room = room(analysis, "the pivot of a body")?;
        let leading = Arc::new(Self::in_order(matrix, self.order[..at].to_vec())?);
        let mut column = vec![0.0; matrix.order()];
        let mut unit = column.clone();
        unit[dof] = 1.0;
        matrix.mul(&unit, &mut column);
        column.iter_mut().for_each(|v| *v *= by);
        let mut x = column.clone();
        (0..x.len()).filter(|&i| leading.position[i] == NONE).for_each(|i| x[i] = 0.0);
        let diagonal = by * matrix.diagonal(dof);
        let relative_pivot = match leading.factorize(matrix, by)? {
            Ok(factor) => {
                factor.solve(&mut x)?;
                let explained: f64 = (0..x.len()).map(|i| x[i] * column[i]).sum();
                if diagonal > 0.0 {
                    (diagonal - explained) / diagonal
                } else {
                    0.0
                }
            }
            Err(earlier) => return Ok(earlier),
        };
        Ok(Breakdown { dof, relative_pivot })
    }
}

impl Cholesky {
    pub(super) fn factor(&self) -> SupernodalLltRef<'_, usize, f64> {
        SupernodalLltRef::new(&self.analysis.symbolic, &self.values)
    }

    /// Position of a dof in the elimination, `NONE` for held dofs.
    pub(super) fn position(&self, dof: usize) -> usize {
        if self.held.binary_search(&dof).is_ok() {
            NONE
        } else {
            self.analysis.position[dof]
        }
    }

    /// Pivots `L_ii^2` with their dofs, in the order of elimination.
    pub fn pivots(&self) -> impl Iterator<Item = (usize, f64)> + '_ {
        let factor = self.factor();
        let nodes = (0..self.analysis.symbolic.n_supernodes()).map(move |s| factor.supernode(s).val());
        let pivots = nodes.flat_map(|l| (0..l.ncols()).map(move |i| l[(i, i)] * l[(i, i)]));
        self.analysis.order.iter().copied().zip(pivots)
    }

    /// Smallest pivot `L_ii^2`.
    pub fn smallest_pivot(&self) -> f64 {
        self.pivots().fold(f64::INFINITY, |smallest, (_, pivot)| smallest.min(pivot))
    }

    /// `x <- K_ff^-1 x` on the free dofs; x has the length of the body, held entries become 0.
    pub fn solve(&self, x: &mut [f64]) -> Result<()> {
        let order = &self.analysis.order;
        let _room = room(PRODUCTS, "a solution")?;
        let mut y = zeros(order.len(), "a right-hand side")?;
        for (y, &dof) in y.iter_mut().zip(order) {
            *y = x[dof];
        }
        self.held.iter().for_each(|&dof| y[self.analysis.position[dof]] = 0.0);
        let scratch = self.analysis.symbolic.solve_in_place_scratch::<f64>(1, Par::Seq);
        let mut workspace = workspace(scratch)?;
        self.factor().solve_in_place_with_conj(
            Conj::No,
            MatMut::from_column_major_slice_mut(&mut y, order.len(), 1),
            Par::Seq,
            MemStack::new(&mut workspace),
        );
        x.fill(0.0);
        for (y, &dof) in y.iter().zip(order) {
            x[dof] = *y;
        }
        Ok(())
    }
}

fn workspace(need: StackReq) -> Result<MemBuffer> {
    MemBuffer::try_new(need).map_err(|_| refusal(need.unaligned_bytes_required(), "a factorisation"))
}

fn positions(n: usize, order: &[usize]) -> Vec<usize> {
    let mut position = vec![NONE; n];
    for (at, &dof) in order.iter().enumerate() {
        position[dof] = at;
    }
    position
}

/// Which triangle a column holds.
#[derive(Clone, Copy, PartialEq)]
enum Triangle {
    Lower,
    Upper,
}

/// One triangle of the matrix in the order of elimination, by columns, rows of a column in any order.
struct Columns {
    ptr: Vec<usize>,
    row: Vec<usize>,
    val: Vec<f64>,
}

fn permuted(
    (matrix, by): (&Symmetric, f64),
    position: &[usize],
    n: usize,
    triangle: Triangle,
) -> Result<Columns> {
    let entries = || {
        (0..matrix.order()).filter(|&i| position[i] != NONE).flat_map(move |i| {
            matrix.lower_row(i).filter(|&(j, _)| position[j] != NONE).map(move |(j, v)| {
                let (low, high) = (position[i].min(position[j]), position[i].max(position[j]));
                let v = by * v;
                if triangle == Triangle::Lower {
                    (high, low, v)
                } else {
                    (low, high, v)
                }
            })
        })
    };
    let mut ptr = vec![0; n + 1];
    entries().for_each(|(_, column, _)| ptr[column + 1] += 1);
    (0..n).for_each(|j| ptr[j + 1] += ptr[j]);
    let mut row = reserved(ptr[n], "a permuted stiffness matrix")?;
    row.resize(ptr[n], 0);
    let mut val = zeros(ptr[n], "a permuted stiffness matrix")?;
    let mut next = ptr.clone();
    for (i, j, v) in entries() {
        row[next[j]] = i;
        val[next[j]] = v;
        next[j] += 1;
    }
    Ok(Columns { ptr, row, val })
}

/// Pattern of L from the upper triangle by columns.
fn symbolic(n: usize, col_ptr: &[usize], row: &[usize]) -> Result<SymbolicSupernodalCholesky<usize>> {
    let pattern = SymbolicSparseColMatRef::new_unsorted_checked(n, n, col_ptr, None, row);
    let mut tree = vec![0isize; n];
    let mut counts = vec![0usize; n];
    let need = prefactorize_symbolic_cholesky_scratch::<usize>(n, row.len())
        .or(factorize_supernodal_symbolic_cholesky_scratch::<usize>(n));
    let mut workspace = workspace(need)?;
    let stack = MemStack::new(&mut workspace);
    let tree = prefactorize_symbolic_cholesky(&mut tree, &mut counts, pattern, stack);
    factorize_supernodal_symbolic_cholesky(pattern, tree, &counts, stack, Default::default())
        .map_err(|e| Error::new(Kind::Memory, format!("the symbolic factorisation failed: {e:?}")))
}

#[cfg(test)]
mod tests {
    use super::*;

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
        Symmetric { ptr, col, val }
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
    fn an_indefinite_matrix_is_refused_with_the_dof_and_its_pivot() {
        let mut matrix = grid(9, 1.0);
        let last = matrix.ptr[31] - 1;
        matrix.val[last] = 0.1;
        let broken = Arc::new(Analysis::new(&matrix, &[false; 81]).unwrap()).factorize(&matrix, 1.0).unwrap();
        let breakdown = broken.err().expect("K_30 was made indefinite");
        assert!(breakdown.relative_pivot < -0.1, "{breakdown:?}");
    }
}
