//! The stiffness of a body for its constrained dofs b, from which the preconditioners of the dual problem are built.

use std::sync::Arc;

use crate::body::host::HostOperator;
use crate::error::Result;
use crate::linalg::cholesky::inverse_form;
use crate::linalg::{Analysis, Csr, Operator, Packed, Symmetric};
use crate::ranks::wire_enum;

/// What the dofs inside of a body do while those of its boundary move.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Inside {
    /// They are held: the lumped preconditioner.
    Held,
    /// They are free: the Dirichlet preconditioner.
    Free,
}

wire_enum!(Inside { Held, Free });

/// `scale` times the stiffness of the dofs of the boundary.
pub fn boundary(
    k: &Symmetric,
    inside: Inside,
    scale: f64,
    boundary: &[usize],
) -> Result<Box<dyn Operator + Send>> {
    match inside {
        Inside::Held => lumped(k, scale, boundary),
        Inside::Free => dirichlet(k, scale, boundary),
    }
}

/// `scale K_bb`: the other dofs are held.
fn lumped(k: &Symmetric, scale: f64, boundary: &[usize]) -> Result<Box<dyn Operator + Send>> {
    let local = positions(k.order(), boundary);
    let mut part = Symmetric::empty();
    for &dof in boundary {
        part.push_row(k.lower_row(dof).filter_map(|(j, v)| Some((local[j]?, scale * v))));
    }
    Ok(Box::new(part))
}

/// `scale D_bb` of a body whose stiffness matrix stays with the host.
pub fn diagonal(k: &HostOperator, scale: f64, boundary: &[usize]) -> Result<Box<dyn Operator + Send>> {
    let mut part = Symmetric::empty();
    boundary.iter().enumerate().for_each(|(row, &dof)| part.push_row([(row, scale * k.diagonal(dof))]));
    Ok(Box::new(part))
}

/// `S = scale (K_bb - K_bi K_ii^-1 K_ib)`: the other dofs are free.
fn dirichlet(k: &Symmetric, scale: f64, boundary: &[usize]) -> Result<Box<dyn Operator + Send>> {
    let local = positions(k.order(), boundary);
    let held: Vec<bool> = local.iter().map(Option::is_some).collect();
    if !held.contains(&false) {
        return lumped(k, scale, boundary);
    }
    let Ok(interior) = Arc::new(Analysis::new(k, &held)?).attempt(k, scale)? else {
        return lumped(k, scale, boundary); // some component of the body has no constrained dof
    };
    let mut schur = inverse_form(&interior, &coupling(k, scale, boundary, &local))?;
    schur.negate();
    for (row, &dof) in boundary.iter().enumerate() {
        for (j, v) in k.lower_row(dof).filter_map(|(j, v)| Some((local[j]?, v))) {
            schur.add(row, j, scale * v);
        }
    }
    Ok(Box::new(schur))
}

fn positions(n: usize, boundary: &[usize]) -> Vec<Option<usize>> {
    let mut local = vec![None; n];
    boundary.iter().enumerate().for_each(|(at, &dof)| local[dof] = Some(at));
    local
}

/// `scale K_bi`, over all dofs of the body.
fn coupling(k: &Symmetric, scale: f64, boundary: &[usize], local: &[Option<usize>]) -> Csr {
    let mut rows = vec![Vec::new(); boundary.len()];
    for i in 0..k.order() {
        for (j, v) in k.lower_row(i) {
            match (local[i], local[j]) {
                (Some(row), None) => rows[row].push((j, scale * v)),
                (None, Some(row)) => rows[row].push((i, scale * v)),
                _ => {}
            }
        }
    }
    let mut coupling = Csr::empty(k.order());
    for mut row in rows {
        row.sort_unstable_by_key(|entry| entry.0);
        coupling.push_row(row);
    }
    coupling
}

/// Bytes of the Schur complement for `boundary` dofs.
pub fn dirichlet_bytes(boundary: usize) -> usize {
    Packed::bytes(boundary)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_chain_of_two_springs_is_felt_as_both_in_series() {
        // springs 2 and 3 between dofs 0 - 1 - 2, boundary 0 and 2: series stiffness 6/5
        let k = Symmetric::new(vec![0, 1, 3, 5], vec![0, 0, 1, 1, 2], vec![2.0, -2.0, 5.0, -3.0, 3.0]);
        let mut y = [0.0; 2];
        dirichlet(&k, 0.5, &[0, 2]).unwrap().apply(&[1.0, 0.0], &mut y);
        assert!((y[0] - 0.6).abs() < 1e-15 && (y[1] + 0.6).abs() < 1e-15);
        lumped(&k, 2.0, &[0, 2]).unwrap().apply(&[1.0, 1.0], &mut y);
        assert_eq!(y, [4.0, 6.0]);
    }
}
