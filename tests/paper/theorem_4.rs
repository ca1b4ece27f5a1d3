//! Theorem 4, on A and D of Problem 1: with n dual variables and m rows of D of full rank,
//!
//! ```text
//! (26)  delta_{n-m}(A + rho D'D) <= delta_n(A)
//! (27)  delta_{n-m+1}(A + rho D'D) >= rho delta_{n-m+1}(D'D) > 0
//! ```

use crate::case::Case;
use crate::dense::Dense;
use crate::eigenvalues::eigenvalues;

/// A = B K+ B' and D = R'B' in the units of the data, with dof `held` of the floating membrane held.
fn dual() -> (Dense, Dense) {
    let case = Case::read("p1_P3");
    let mut problem = case.problem(false);
    problem.set_fixing(1, Some(&[440])).unwrap();
    let m = case.lambda.len();
    let mut a = Dense::zeros(m, m);
    for i in 0..m {
        let mut unit = vec![0.0; m];
        unit[i] = 1.0;
        problem.dual_apply(&unit, &mut a.0[i]).unwrap();
    }
    // R is the constant on the floating membrane: D sums the entries of its dofs
    let first = case.bodies[0].0.ptr.len() as i64 - 1;
    let rows = &case.contact.0;
    let entry = |i: usize| {
        (rows.ptr[i]..rows.ptr[i + 1]).filter(|&at| rows.col[at] >= first).map(|at| rows.val[at]).sum()
    };
    (a, Dense(vec![(0..m).map(entry).collect()]))
}

/// `A + rho D'D`
fn augmented(a: &Dense, d: &Dense, rho: f64) -> Dense {
    let square = Dense::gram(d);
    let mut sum = a.clone();
    sum.0.iter_mut().zip(&square.0).for_each(|(s, q)| s.iter_mut().zip(q).for_each(|(s, q)| *s += rho * q));
    sum
}

const PENALTIES: [f64; 5] = [1e-2, 1.0, 1e2, 1e4, 1e6];

#[test]
fn the_bounds_26_and_27_hold_on_problem_1() {
    let (a, d) = dual();
    let (n, m) = (a.0.len(), d.0.len());
    let (of_a, of_square) = (eigenvalues(&a), eigenvalues(&Dense::gram(&d)));
    assert!(of_a[0] > 0.0 && of_square[n - m] > 0.0, "A is definite and D has full row rank");
    for rho in PENALTIES {
        let found = eigenvalues(&augmented(&a, &d, rho));
        assert!(found[n - m - 1] <= of_a[n - 1] * (1.0 + 1e-12), "(26), rho {rho}");
        assert!(found[n - m] >= rho * of_square[n - m] * (1.0 - 1e-12), "(27), rho {rho}");
    }
}

/// A row of D twice: (26) holds with the number of rows, (27) bounds by zero, and with the rank in the place of m
/// both hold with a gap.
#[test]
fn without_full_row_rank_the_rank_takes_the_place_of_m() {
    let (a, d) = dual();
    let n = a.0.len();
    let twice = Dense(vec![d.0[0].clone(), d.0[0].clone()]);
    let (of_a, of_square) = (eigenvalues(&a), eigenvalues(&Dense::gram(&twice)));
    assert!(of_square[n - 2].abs() < 1e-12 * of_square[n - 1], "rank 1");
    for rho in PENALTIES {
        let found = eigenvalues(&augmented(&a, &twice, rho));
        assert!(found[n - 3] <= of_a[n - 1] * (1.0 + 1e-12), "(26), rho {rho}");
        assert!(found[n - 2] >= rho * of_square[n - 2] - 1e-12 * found[n - 1], "(27), rho {rho}");
        assert!(found[n - 2] <= of_a[n - 1] * (1.0 + 1e-12), "(26) with the rank, rho {rho}");
        assert!(found[n - 1] >= rho * of_square[n - 1] * (1.0 - 1e-12), "(27) with the rank, rho {rho}");
    }
}
