//! Theorem 4, on A and D of Problem 1: with n dual variables and m rows of D of full rank,
//!
//! ```text
//! (26)  delta_{n-m}(A + rho D'D) <= delta_n(A)
//! (27)  delta_{n-m+1}(A + rho D'D) >= rho delta_{n-m+1}(D'D) > 0
//! ```
//!
//! Without full row rank, as on Problem 2 with all six rigid modes, the rank takes the place of m.

use crate::paper::eigenvalues::eigenvalues;
use crate::qp::dense::Dense;
use crate::reference::case::Case;

/// A = B K+ B' of the library, and D = R'B' in the units of the data.
fn dual(name: &str) -> (Dense, Dense) {
    let case = Case::read(name);
    let mut problem = case.problem(false);
    let m = case.lambda.len();
    let mut a = Dense::zeros(m, m);
    for i in 0..m {
        let mut unit = vec![0.0; m];
        unit[i] = 1.0;
        problem.dual_apply(&unit, &mut a.0[i]).unwrap();
    }
    let rows = &case.contact.0;
    let (mut d, mut start) = (Vec::new(), 0);
    for (k, r) in &case.bodies {
        let n = k.ptr.len() - 1;
        let inside = |at: &usize| (start..start + n).contains(&(rows.col[*at] as usize));
        for mode in r.chunks_exact(n) {
            let entry = |i: usize| {
                let entries = (rows.ptr[i]..rows.ptr[i + 1]).filter(inside);
                entries.map(|at| rows.val[at] * mode[rows.col[at] as usize - start]).sum()
            };
            d.push((0..m).map(entry).collect());
        }
        start += n;
    }
    (a, Dense(d))
}

/// `A + rho D'D`
fn augmented(a: &Dense, d: &Dense, rho: f64) -> Dense {
    let square = Dense::gram(d);
    let mut sum = a.clone();
    sum.0.iter_mut().zip(&square.0).for_each(|(s, q)| s.iter_mut().zip(q).for_each(|(s, q)| *s += rho * q));
    sum
}

/// (26) and (27) with m = `rank` for penalties of every size against |A| / |D|^2, to rounding of the largest eigenvalue.
fn bounds_hold(a: &Dense, d: &Dense, rank: usize) {
    let n = a.0.len();
    let (of_a, of_square) = (eigenvalues(a), eigenvalues(&Dense::gram(d)));
    let unit = of_a[n - 1] / of_square[n - 1];
    for rho in [1e-2, 1.0, 1e2, 1e4, 1e6].map(|rho| rho * unit) {
        let found = eigenvalues(&augmented(a, d, rho));
        let rounding = 1e-14 * found[n - 1];
        assert!(found[n - rank - 1] <= of_a[n - 1] + rounding, "(26), rank {rank}, rho {rho}");
        let below = rho * of_square[n - rank];
        assert!(below > 0.0 && found[n - rank] >= below - rounding, "(27), rank {rank}, rho {rho}");
    }
    // neither bound is a triviality: one more or one less eigenvalue breaks it
    let found = eigenvalues(&augmented(a, d, 1e4 * unit));
    assert!(found[n - rank] > of_a[n - 1], "rank {rank}");
    assert!(found[n - rank - 1] < 1e4 * unit * of_square[n - rank], "rank {rank}");
}

#[test]
fn the_bounds_26_and_27_hold_on_problem_1() {
    let (a, d) = dual("p1_P3");
    assert!(eigenvalues(&a)[0] > 0.0 && d.0.len() == 1, "A is definite and D has full row rank");
    bounds_hold(&a, &d, 1);
}

/// A row of D twice: (27) bounds by zero with the number of rows, and with the rank both hold.
#[test]
fn without_full_row_rank_the_rank_takes_the_place_of_m() {
    let (a, d) = dual("p1_P3");
    let twice = Dense(vec![d.0[0].clone(), d.0[0].clone()]);
    let of_square = eigenvalues(&Dense::gram(&twice));
    assert!(of_square[of_square.len() - 2].abs() < 1e-12 * of_square[of_square.len() - 1], "rank 1");
    bounds_hold(&a, &twice, 1);
}

/// Two discs on the ground, all six rigid modes: turning each disc about its own middle moves no row.
#[test]
fn six_modes_of_which_two_move_no_row_have_the_bounds_of_rank_4() {
    let (a, d) = dual("p2_B2");
    assert_eq!(d.0.len(), 6);
    let values = eigenvalues(&Dense::gram(&d));
    let n = values.len();
    assert!(values[n - 5] < 1e-12 * values[n - 1] && values[n - 4] > 1e-6 * values[n - 1], "{values:?}");
    bounds_hold(&a, &d, 4);
}
