//! The null space of a body that is cut: motions of its pieces that move all copies of an unknown equally.

use crate::error::Result;
use crate::linalg::vector::power_of_two_below;
use crate::linalg::{Csr, Matrix};
use crate::model::{Parts, SolvedModel};
use crate::numbers::linalg::ROOT;
use crate::numbers::rounding;
use crate::platform::memory::{filled, reserved, zeros};
use crate::qp::AnswerFace;

const WHAT: &str = "the null space of a body that is cut";

/// R of a body from the null spaces of its pieces, n x r, `R'DR = unit`, unit the largest power of two that does not
/// exceed its largest `K_ii`.
pub fn null_space(model: &SolvedModel, parts: &Parts, body: usize, bases: &[Matrix]) -> Result<Matrix> {
    let order = parts.offsets[body + 1] - parts.offsets[body];
    let mut blocks = reserved(bases.len(), WHAT)?;
    let mut modes = 0;
    for basis in bases {
        blocks.push(modes);
        modes += basis.cols;
    }
    if modes == 0 {
        return Matrix::zeros(order, 0);
    }
    let units: Vec<f64> = parts.of(body).map(|part| model.bodies[part].body.unit()).collect();
    // motions are divided by these sizes, so that those of stiff and soft pieces have equal weight
    let sizes: Vec<f64> = units.iter().map(|unit| unit.sqrt()).collect();
    let glue = glued(model, parts, body, &Motions { bases, blocks: &blocks, units: &units, sizes: &sizes })?;
    let held = filled(glue.rows(), false, WHAT)?;
    let amplitudes = AnswerFace::new(&glue, &blocks, &held, rounding::METHOD)?.undetermined()?;
    let mut vectors = Matrix::zeros(order, 0)?;
    for k in 0..amplitudes.cols {
        let mut motion = zeros(order, WHAT)?;
        for (((part, basis), first), size) in parts.of(body).zip(bases).zip(&blocks).zip(&sizes) {
            let mut own = zeros(basis.rows, WHAT)?;
            basis.mul_add(1.0 / size, &amplitudes.col(k)[*first..first + basis.cols], &mut own);
            for (i, v) in own.iter().enumerate() {
                let (dof, share) = parts.place(part, i);
                motion[dof] += share * v;
            }
        }
        vectors.push_col(&motion);
    }
    Ok(orthonormal(parts, body, vectors))
}

/// `R'DR = unit`
fn orthonormal(parts: &Parts, body: usize, mut vectors: Matrix) -> Matrix {
    let Some(k) = &parts.assembled[body] else { return vectors };
    let unit = power_of_two_below(k.largest_diagonal());
    let root = |i: usize| (k.metric(i, unit) / unit).sqrt();
    for j in 0..vectors.cols {
        vectors.col_mut(j).iter_mut().enumerate().for_each(|(i, v)| *v *= root(i));
    }
    let mut basis = vectors.orthonormalised(ROOT);
    for j in 0..basis.cols {
        basis.col_mut(j).iter_mut().enumerate().for_each(|(i, v)| *v /= root(i));
    }
    basis
}

/// The null spaces of the pieces of a body.
struct Motions<'a> {
    bases: &'a [Matrix],
    /// First column of each basis among all modes.
    blocks: &'a [usize],
    /// Unit of K, and divisors of the motions.
    units: &'a [f64],
    sizes: &'a [f64],
}

/// `G'` of the glue of the body alone, rows x modes: `s (R_c - R_d)` for copies c and d of an unknown, `s^-2 = 1/K_cc +
/// 1/K_dd`.
fn glued(model: &SolvedModel, parts: &Parts, body: usize, own: &Motions) -> Result<Csr> {
    let Motions { bases, blocks, units, sizes } = own;
    let range = parts.of(body);
    let unknowns = parts.starts[range.start]..parts.starts[range.end];
    let modes = bases.iter().map(|basis| basis.cols).sum();
    let mut glue = Csr::empty(modes);
    let rows = &model.equalities.matrix;
    for row in parts.judged()..rows.rows() {
        let (mut entries, mut give) = (Vec::new(), 0.0);
        for (j, v) in rows.row(row).filter(|(j, _)| unknowns.contains(j)) {
            let k = parts.starts[range.start..range.end].partition_point(|start| *start <= j) - 1;
            let (i, own) = (j - parts.starts[range.start + k], &model.bodies[range.start + k].body);
            give += 1.0 / own.k().map_or(1.0, |stiffness| stiffness.metric(i, units[k]));
            entries.extend(
                (0..bases[k].cols).map(|mode| (blocks[k] + mode, v * bases[k].get(i, mode) / sizes[k])),
            );
        }
        if !entries.is_empty() {
            let scale = f64::sqrt(1.0 / give);
            glue.push_row(entries.into_iter().map(|(mode, v)| (mode, scale * v)));
        }
    }
    Ok(glue)
}
