//! The coupling matrix of the rows of a face, `W_F = B_F D^-1 B_F' + C_F` (1 on the diagonal), and its inverse block by
//! block. A block is a connected part of W_F: the rows on one node, or rows that are chained over a whole surface. Rows
//! without coupling, which are most rows after decoupling, need no block: their diagonal is 1.

use std::sync::Arc;

use crate::error::Result;
use crate::linalg::graph::components;
use crate::linalg::sparse::gram::Gram;
use crate::linalg::vector::NOISE;
use crate::linalg::{Analysis, Cholesky, Csr, Matrix, SpdSolver, Symmetric};
use crate::numbers::dual::PROBES;
use crate::numbers::linalg::{ROOT, SHIFT};
use crate::platform::memory::{copied, headroom};

/// Limit of rows in a block whose pseudo-inverse is formed.
const DENSE: usize = 200;

/// Rows that are combinations of the remaining rows, by the pivots of `B D^-1 B' + C`; `columns`: `D^-1/2 B'`,
/// `compliance`: the diagonal of C.
pub fn dependent_rows(columns: &Csr, compliance: &[f64]) -> Result<Vec<usize>> {
    let coupling = Coupling::uncut(columns, compliance)?;
    let mut rows: Vec<usize> = coupling.weak_rows()?.into_iter().map(|i| coupling.rows[i]).collect();
    rows.sort_unstable();
    Ok(rows)
}

/// W of the rows that are coupled to another row.
pub struct Coupling {
    /// These rows, ascending. All other data are numbered within them.
    rows: Arc<Vec<usize>>,
    whole: Symmetric,
    analysis: Arc<Analysis>,
    /// Rows in blocks of W that may be rank-deficient. On a face they may be linearly dependent; the other rows never
    /// are.
    suspect: Vec<bool>,
}

/// `W_F+` of one face.
pub struct FaceCoupling {
    /// Held rows among all rows.
    held: Vec<bool>,
    /// The rows that are coupled to another row, ascending.
    rows: Arc<Vec<usize>>,
    /// Factor of blocks of full rank and large blocks; 1 for all other rows.
    sparse: Cholesky,
    /// Small blocks of suspect rows, by their first rows.
    dense: Vec<DependentRows>,
}

#[derive(Clone)]
struct DependentRows {
    rows: Vec<usize>,
    inverse: Arc<SpdSolver>,
}

impl Coupling {
    /// `columns`: `D^-1/2 B'`, `compliance`: the diagonal of C; the diagonal of W is 1.
    pub fn new(columns: &Csr, compliance: &[f64]) -> Result<Self> {
        let mut coupling = Self::uncut(columns, compliance)?;
        let weak = coupling.weak_rows()?;
        let (block, count) = components(&coupling.whole);
        let mut suspect = vec![false; count];
        weak.into_iter().for_each(|i| suspect[block[i]] = true);
        (0..block.len()).for_each(|i| coupling.suspect[i] = suspect[block[i]]);
        Ok(coupling)
    }

    fn uncut(columns: &Csr, compliance: &[f64]) -> Result<Self> {
        let gram = Gram::of(columns)?;
        let mut whole = gram.sum(columns, &vec![false; columns.rows()])?;
        compliance.iter().enumerate().for_each(|(i, c)| shift(&mut whole, i, *c));
        let (rows, whole) = coupled(&whole)?;
        let none = vec![false; whole.order()];
        let analysis = Arc::new(Analysis::new(&whole, &none)?);
        Ok(Self { rows: Arc::new(rows), suspect: none, whole, analysis })
    }

    /// Rows with a pivot that may be zero; all rows if no factor exists.
    fn weak_rows(&self) -> Result<Vec<usize>> {
        for probe in PROBES {
            let mut w = self.on(&vec![false; self.whole.order()])?;
            (0..w.order()).for_each(|i| shift(&mut w, i, probe));
            if let Ok(factor) = self.analysis.attempt(&w, 1.0)? {
                let weak = factor.pivots().filter(|(_, pivot)| *pivot <= ROOT);
                return Ok(weak.map(|(row, _)| row).collect());
            }
        }
        Ok((0..self.whole.order()).collect())
    }

    /// The inverse on the rows that are not held; blocks that also occur in `last` are reused. `None` if rounding
    /// prevents the factorisation.
    pub fn face(&self, held: &[bool], last: Option<&FaceCoupling>) -> Result<Option<FaceCoupling>> {
        let own: Vec<bool> = self.rows.iter().map(|&i| held[i]).collect();
        let mut w = self.on(&own)?;
        let mut dense = Vec::new();
        for rows in self.suspect_blocks(&w, &own)? {
            if rows.len() > DENSE {
                rows.iter().for_each(|&i| shift(&mut w, i, SHIFT));
                continue;
            }
            let known = last.and_then(|face| face.block(&rows));
            dense.push(match known {
                Some(block) => block.clone(),
                None => DependentRows { inverse: Arc::new(dense_inverse(&w, &rows)?), rows },
            });
        }
        let mut apart = own;
        dense.iter().flat_map(|block| &block.rows).for_each(|&i| apart[i] = true);
        uncouple(&mut w, |i| apart[i]);
        let factor = self.analysis.attempt(&w, 1.0)?;
        let (held, rows) = (copied(held, "a face")?, Arc::clone(&self.rows));
        Ok(factor.ok().map(|sparse| FaceCoupling { held, rows, sparse, dense }))
    }

    /// W with the unit matrix for the held rows.
    fn on(&self, held: &[bool]) -> Result<Symmetric> {
        let mut w = self.whole.copied("the coupling of rows")?;
        uncouple(&mut w, |i| held[i]);
        Ok(w)
    }

    /// Blocks of at least two suspect rows on a face, each ascending, by their first rows.
    fn suspect_blocks(&self, w: &Symmetric, held: &[bool]) -> Result<Vec<Vec<usize>>> {
        if !self.suspect.contains(&true) {
            return Ok(Vec::new());
        }
        let _room = headroom(48 * (w.order() + w.val.len()), "the blocks of a face")?;
        let (block, count) = components(w);
        let mut blocks = vec![Vec::new(); count];
        let suspects = (0..block.len()).filter(|&i| self.suspect[i] && !held[i]);
        suspects.for_each(|i| blocks[block[i]].push(i));
        blocks.retain(|rows| rows.len() > 1);
        Ok(blocks)
    }
}

impl FaceCoupling {
    pub fn is_of(&self, held: &[bool]) -> bool {
        self.held == held
    }

    /// `z <- W_F+ z` on the rows that are not held, 0 on the others.
    pub fn solve(&self, z: &mut [f64]) -> Result<()> {
        z.iter_mut().zip(&self.held).filter(|(_, held)| **held).for_each(|(z, _)| *z = 0.0);
        let mut own: Vec<f64> = self.rows.iter().map(|&i| z[i]).collect();
        let mut parts = Vec::with_capacity(self.dense.len());
        for block in &self.dense {
            let part: Vec<f64> = block.rows.iter().map(|&i| own[i]).collect();
            parts.push(block.inverse.solve(&part));
        }
        self.sparse.solve(&mut own)?;
        for (block, part) in self.dense.iter().zip(parts) {
            block.rows.iter().zip(part).for_each(|(&i, v)| own[i] = v);
        }
        self.rows.iter().zip(own).for_each(|(&i, v)| z[i] = v);
        Ok(())
    }

    fn block(&self, rows: &[usize]) -> Option<&DependentRows> {
        let at = self.dense.binary_search_by_key(&rows[0], |block| block.rows[0]).ok()?;
        self.dense.get(at).filter(|block| block.rows == rows)
    }
}

/// Replaces the rows and columns in `apart` by those of the unit matrix.
fn uncouple(w: &mut Symmetric, apart: impl Fn(usize) -> bool) {
    for i in 0..w.order() {
        for at in w.ptr[i]..w.ptr[i + 1] {
            let j = w.col[at] as usize;
            if apart(i) || apart(j) {
                w.val[at] = f64::from(u8::from(i == j));
            }
        }
    }
}

/// Inverse of the block of some rows and columns, ascending; the diagonal of W is about 1.
fn dense_inverse(w: &Symmetric, rows: &[usize]) -> Result<SpdSolver> {
    let mut block = Matrix::zeros(rows.len(), rows.len())?;
    for (a, &i) in rows.iter().enumerate() {
        for (j, v) in w.lower_row(i) {
            if let Ok(b) = rows.binary_search(&j) {
                block.set(a, b, v);
                block.set(b, a, v);
            }
        }
    }
    SpdSolver::new(&block, &vec![1.0; rows.len()])
}

/// The rows with an off-diagonal entry of W above rounding, and W restricted to these rows, without smaller entries.
fn coupled(w: &Symmetric) -> Result<(Vec<usize>, Symmetric)> {
    let entries = |i: usize| w.lower_row(i).filter(move |(j, v)| *j == i || v.abs() > NOISE);
    let mut feels = vec![false; w.order()];
    for i in 0..w.order() {
        for (j, _) in entries(i).filter(|(j, _)| *j != i) {
            (feels[i], feels[j]) = (true, true);
        }
    }
    let rows: Vec<usize> = (0..feels.len()).filter(|&i| feels[i]).collect();
    let mut number = vec![0; feels.len()];
    rows.iter().enumerate().for_each(|(at, &i)| number[i] = at);
    let count = rows.iter().map(|&i| entries(i).count()).sum();
    let mut among = Symmetric::with_room(rows.len(), count, "coupled rows")?;
    rows.iter().for_each(|&i| among.push_row(entries(i).map(|(j, v)| (number[j], v))));
    Ok((rows, among))
}

fn shift(w: &mut Symmetric, i: usize, by: f64) {
    w.val[w.ptr[i + 1] - 1] += by;
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Rows over the unknowns, D = 1, divided by their lengths.
    fn coupling(unknowns: usize, rows: &[Vec<(usize, f64)>]) -> (Csr, Coupling) {
        let mut b = Csr::empty(unknowns);
        for row in rows {
            let length = row.iter().map(|(_, v)| v * v).sum::<f64>().sqrt();
            b.push_row(row.iter().map(|&(j, v)| (j, v / length)));
        }
        let columns = b.transposed().unwrap();
        (b, Coupling::new(&columns, &vec![0.0; rows.len()]).unwrap())
    }

    /// `B_F' W_F+ B_F v = v` for v in the range of `B_F'`.
    fn assert_projects(b: &Csr, coupling: &Coupling, held: &[bool], accuracy: f64) {
        let face = coupling.face(held, None).unwrap().unwrap();
        let mut v = vec![0.0; b.cols];
        let weights: Vec<f64> =
            (0..b.rows()).map(|i| if held[i] { 0.0 } else { (1.0 + i as f64).sin() }).collect();
        b.mul_transposed_add(1.0, &weights, &mut v);
        let mut z = vec![0.0; b.rows()];
        b.mul(&v, &mut z);
        face.solve(&mut z).unwrap();
        assert!(z.iter().zip(held).all(|(z, held)| !held || *z == 0.0));
        let mut again = vec![0.0; b.cols];
        b.mul_transposed_add(1.0, &z, &mut again);
        let worst = v.iter().zip(&again).fold(0.0f64, |worst, (v, w)| worst.max((v - w).abs()));
        assert!(worst < accuracy, "{worst:e}");
    }

    #[test]
    fn rows_that_feel_no_other_take_no_part() {
        let (b, coupling) =
            coupling(4, &[vec![(0, 1.0), (1, -1.0)], vec![(0, 1.0), (1, 1.0)], vec![(3, 2.0)]]);
        assert!(coupling.rows.is_empty());
        assert_projects(&b, &coupling, &[false; 3], 1e-15);
        assert_projects(&b, &coupling, &[true, false, false], 1e-15);
    }

    /// All pairs of four copies of one unknown: six rows of rank 3. A fifth and a sixth unknown are joined by one row.
    fn cross_point() -> Vec<Vec<(usize, f64)>> {
        let pairs = (0..4).flat_map(|a| (a + 1..4).map(move |b| vec![(a, 1.0), (b, -1.0)]));
        pairs.chain([vec![(4, 1.0), (5, -1.0)]]).collect()
    }

    #[test]
    fn redundant_rows_share_their_force_by_the_pseudo_inverse() {
        let (b, coupling) = coupling(6, &cross_point());
        assert_eq!((&coupling.rows[..], &coupling.suspect[..]), (&[0, 1, 2, 3, 4, 5][..], &[true; 6][..]));
        assert_projects(&b, &coupling, &[false; 7], 1e-14);
        // on the pairs W has the eigenvalue 2 three times: W+ = W / 4
        let face = coupling.face(&[false; 7], None).unwrap().unwrap();
        let mut z = [1.0, 0.0, 0.0, 0.0, 0.0, 0.0, 1.0];
        face.solve(&mut z).unwrap();
        let expected = [0.25, 0.125, 0.125, -0.125, -0.125, 0.0, 1.0];
        assert!(z.iter().zip(expected).all(|(z, e)| (z - e).abs() < 1e-14), "{z:?}");
    }

    #[test]
    fn a_block_falls_apart_where_the_rows_that_join_it_are_held() {
        let (b, coupling) = coupling(6, &cross_point());
        // rows 0 = (0, 1) and 5 = (2, 3) remain: regular, and no longer coupled
        let held = [false, true, true, true, true, false, false];
        let face = coupling.face(&held, None).unwrap().unwrap();
        assert!(face.dense.is_empty());
        assert_projects(&b, &coupling, &held, 1e-14);
        let held = [false, false, true, false, true, true, true];
        assert_projects(&b, &coupling, &held, 1e-14);
    }

    #[test]
    fn blocks_known_from_the_last_face_are_not_factorised_again() {
        let (_, coupling) = coupling(6, &cross_point());
        let first = coupling.face(&[false; 7], None).unwrap().unwrap();
        let held = [false, false, false, false, false, false, true];
        let second = coupling.face(&held, Some(&first)).unwrap().unwrap();
        assert!(Arc::ptr_eq(&first.dense[0].inverse, &second.dense[0].inverse));
        let held = [true, false, false, false, false, false, false];
        let third = coupling.face(&held, Some(&second)).unwrap().unwrap();
        assert_eq!(third.dense[0].rows, [1, 2, 3, 4, 5]);
    }

    #[test]
    fn as_many_rows_are_named_as_the_rank_is_short_of() {
        let (b, _) = coupling(6, &cross_point());
        let named = dependent_rows(&b.transposed().unwrap(), &vec![0.0; b.rows()]).unwrap();
        assert!(named.len() == 3 && !named.contains(&6), "{named:?}");
        let (b, _) = coupling(300, &ring(300));
        assert_eq!(dependent_rows(&b.transposed().unwrap(), &vec![0.0; b.rows()]).unwrap().len(), 1);
    }

    /// Differences of neighbours on a ring: n rows of rank n - 1, each with a coefficient of 1/sqrt(n) in the dependence.
    fn ring(n: usize) -> Vec<Vec<(usize, f64)>> {
        let neighbours = |i: usize| vec![(i, 1.0), ((i + 1) % n, -1.0)];
        (0..n).map(|i| if i + 1 < n { neighbours(i) } else { vec![(0, -1.0), (i, 1.0)] }).collect()
    }

    #[test]
    fn dependent_rows_that_chain_over_a_surface_are_found_and_solved() {
        for n in [100, 20_000] {
            let (b, coupling) = coupling(n, &ring(n));
            assert!(coupling.suspect.iter().all(|suspect| *suspect), "{n}");
            assert_projects(&b, &coupling, &vec![false; n], if n > DENSE { 1e-5 } else { 1e-13 });
            let mut held = vec![false; n];
            held[n / 2] = true;
            assert_projects(&b, &coupling, &held, 1e-5);
        }
    }
}
