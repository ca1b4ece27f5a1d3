//! Unknowns that are held so stiffly that their neighbours do not matter, such as those of penalty supports.

use crate::body::given::Stiffness;
use crate::error::Result;
use crate::numbers::body::GROUNDED;
use crate::platform::memory::zeros;

/// The unknowns with `K_jj > 1000 T_j`, force / length, with the stiffness contribution of the neighbours `T_j = sum_{i
/// != j} K_ij^2 / K_ii`. An unknown without neighbours is grounded if it has stiffness. Ascending; empty for a body with
/// products only. They depend on the matrix alone and are found once for all answers.
pub fn grounded(k: Stiffness) -> Result<Vec<u32>> {
    let (order, mut neighbours) = (k.order(), zeros(k.order(), "the stiffness of neighbours")?);
    let diagonal = |i: usize| match k {
        Stiffness::Matrix(k) => k.diagonal(i),
        Stiffness::Assembled(k) => k.diagonal(i),
        Stiffness::Host(_) => 0.0,
    };
    let couple = |i: usize, j: usize, k_ij: f64| {
        if i != j {
            neighbours[j] += through(k_ij, k.metric(i, 0.0));
            neighbours[i] += through(k_ij, k.metric(j, 0.0));
        }
    };
    if !k.each_entry(couple) {
        return Ok(Vec::new());
    }
    let is_grounded = |j: &usize| diagonal(*j) > GROUNDED * neighbours[*j];
    Ok((0..order).filter(is_grounded).map(|j| j as u32).collect())
}

/// `k_ij^2 / k_ii`, force / length; `k_ij^2` alone might overflow.
fn through(k_ij: f64, k_ii: f64) -> f64 {
    if k_ii > 0.0 {
        (k_ij / k_ii) * k_ij
    } else {
        0.0
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::linalg::Symmetric;

    /// Springs between n unknowns, and springs to the ground at single unknowns.
    fn chain(springs: &[f64], held: &[(usize, f64)]) -> Symmetric {
        let n = springs.len() + 1;
        let (mut ptr, mut col, mut val) = (vec![0], Vec::new(), Vec::new());
        for i in 0..n {
            let (left, right) = (i.checked_sub(1).map(|i| springs[i]), springs.get(i));
            if let Some(left) = left {
                col.push(i as u32 - 1);
                val.push(-left);
            }
            let ground: f64 = held.iter().filter(|(at, _)| *at == i).map(|(_, k)| k).sum();
            col.push(i as u32);
            val.push(left.unwrap_or(0.0) + right.unwrap_or(&0.0) + ground);
            ptr.push(col.len());
        }
        Symmetric::new(ptr, col, val)
    }

    #[test]
    fn penalty_supports_and_single_springs_are_grounded_in_any_unit() {
        for unit in [1e-290, 1.0, 1e290] {
            let k = chain(&[unit, unit], &[(0, 1e6 * unit), (2, 1e2 * unit)]);
            assert_eq!(grounded((&k).into()).unwrap(), [0], "{unit:e}");
            assert_eq!(grounded((&chain(&[], &[(0, 4.0 * unit)])).into()).unwrap(), [0]);
        }
        assert!(grounded((&chain(&[], &[])).into()).unwrap().is_empty(), "no stiffness holds nothing");
    }

    #[test]
    fn stiff_parts_on_soft_ones_are_not() {
        let contrast = chain(&[1.0, 1.0, 1e6, 1e6, 1e6, 1.0, 1.0], &[(0, 1.0), (7, 1e-8)]);
        assert!(grounded((&contrast).into()).unwrap().is_empty());
    }
}
