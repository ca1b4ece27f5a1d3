//! (14) to (18) against dense linear algebra.

use crate::qp::dense::{dot, norm, solve, Dense};
use crate::reference::case::Case;
use feti_contact::solver::{Modes, Problem, RowKind};

/// K_p, both triangles.
fn stiffness(case: &Case, body: usize) -> Dense {
    let k = &case.bodies[body].0;
    let n = k.ptr.len() - 1;
    let mut dense = Dense::zeros(n, n);
    for i in 0..n {
        for at in k.ptr[i]..k.ptr[i + 1] {
            let j = k.col[at] as usize;
            (dense.0[i][j], dense.0[j][i]) = (k.val[at], k.val[at]);
        }
    }
    dense
}

/// K_p+ as the library applies it.
fn inverse(problem: &mut Problem, body: usize, n: usize) -> Dense {
    let mut columns = Dense::zeros(n, n);
    for j in 0..n {
        let mut unit = vec![0.0; n];
        unit[j] = 1.0;
        problem.kplus(body, &unit, &mut columns.0[j]).unwrap();
    }
    columns
}

fn product(a: &Dense, b: &Dense) -> Dense {
    let columns = b.0[0].len();
    Dense(a.0.iter().map(|row| b.transpose_times(row, columns)).collect())
}

fn distance(a: &Dense, b: &Dense) -> f64 {
    let size = |m: &Dense| m.0.iter().flatten().fold(0.0, |s: f64, v| s.max(v.abs()));
    let pairs = a.0.iter().flatten().zip(b.0.iter().flatten());
    pairs.fold(0.0, |s: f64, (a, b)| s.max((a - b).abs())) / size(b)
}

/// (15): K+ is F^-1 on the free dofs, 0 on those held; symmetric, K K+ K = K, K+ K K+ = K+. (14), corrected: the lower
/// right block of K is S'F^-1 S.
#[test]
fn formulas_14_and_15_hold_for_a_disc_with_three_motions() {
    let case = Case::read("p2_B2");
    let mut problem = case.problem(false);
    for held in [None, Some([1, 73, 114])] {
        problem.set_fixing(0, held.as_ref().map(|dofs| &dofs[..])).unwrap();
        let k = stiffness(&case, 0);
        let n = k.0.len();
        let kplus = inverse(&mut problem, 0, n);
        let fixing = problem.fixing_dofs(0).unwrap().to_vec();
        assert!(fixing.iter().all(|&s| kplus.0[s].iter().all(|v| *v == 0.0)));
        assert!(distance(&product(&product(&k, &kplus), &k), &k) < 1e-11);
        assert!(distance(&product(&product(&kplus, &k), &kplus), &kplus) < 1e-11);
        let transposed = Dense((0..n).map(|i| kplus.0.iter().map(|row| row[i]).collect()).collect());
        assert!(distance(&transposed, &kplus) < 1e-12);
        for &s in &fixing {
            let image = kplus.times(&k.0[s]);
            for &t in &fixing {
                let schur = dot(&k.0[t], &image);
                assert!((k.0[s][t] - schur).abs() < 1e-10 * k.0[s][s], "(14): K_ss = S'F^-1 S");
            }
        }
    }
}

/// (16): u = K^-1 (f - B'lambda) where no body floats: Problem 1 with a spring under the right membrane.
#[test]
fn formula_16_gives_u_where_k_is_regular() {
    let mut case = Case::read("p1_P3");
    let (k, r) = &mut case.bodies[1];
    let last = k.val.len() - 1;
    k.val[last] += 1.0;
    r.clear();
    let mut problem = case.problem(false);
    problem.set_null_space(1, 441, 0, &[], 441, Modes::Exact).unwrap();
    problem.solve().unwrap();
    let rest = rest(&case, &problem);
    for (body, start) in [(0, 0), (1, 420)] {
        let k = stiffness(&case, body);
        let u = solve(k.0.clone(), rest[start..start + k.0.len()].to_vec()).unwrap();
        let found = problem.displacement(body).unwrap();
        let error: Vec<f64> = u.iter().zip(found).map(|(a, b)| a - b).collect();
        assert!(norm(&error) <= 1e-9 * norm(&u), "body {body}: {:.1e}", norm(&error) / norm(&u));
    }
}

/// f - B'lambda
fn rest(case: &Case, problem: &Problem) -> Vec<f64> {
    let (rows, lambda) = (&case.contact.0, problem.multipliers(RowKind::Inequality).unwrap());
    let mut rest = case.load.clone();
    for i in 0..lambda.len() {
        (rows.ptr[i]..rows.ptr[i + 1]).for_each(|at| rest[rows.col[at] as usize] -= rows.val[at] * lambda[i]);
    }
    rest
}

/// (17) with (18), corrected: alpha = (R'B~'B~R)^-1 R'B~'(c~ - B~K+(f - B'lambda)) over the rows with a force is what
/// the multiplier -mu of Algorithm 3 is; u = R alpha + K+(f - B'lambda).
#[test]
fn formulas_17_and_18_give_the_displacement_and_the_amplitudes() {
    for (name, method, tolerance, bound) in [
        ("p1_P3", "proportioning", 1e-12, 1e-8),
        ("p2_B1", "proportioning", 1e-12, 1e-8),
        ("p1_P3", "paper-extrapolating", 1e-4, 1e-3),
        ("p1_P3", "paper-extrapolating", 1e-6, 1e-5),
        ("p2_B1", "paper-monotone", 1e-6, 1e-5),
    ] {
        let case = Case::read(name);
        let mut problem = case.problem(false);
        problem.set_str("method", method).unwrap();
        if method != "proportioning" {
            problem.set_str("paper_units", "printed").unwrap();
            problem.set_f64("tolerance", tolerance).unwrap();
            problem.set_f64("certificate_tolerance", 1e-2).unwrap();
        }
        problem.solve().unwrap();
        let (u0, motions, alpha) = parts(&case, &mut problem);
        let closed: Vec<usize> = {
            let lambda = problem.multipliers(RowKind::Inequality).unwrap();
            let largest = lambda.iter().fold(0.0, |s: f64, l| s.max(*l));
            (0..lambda.len()).filter(|&i| lambda[i] > 1e-3 * largest).collect()
        };
        let row = |i: usize, v: &[f64]| -> f64 {
            let rows = &case.contact.0;
            (rows.ptr[i]..rows.ptr[i + 1]).map(|at| rows.val[at] * v[rows.col[at] as usize]).sum()
        };
        let br: Vec<Vec<f64>> = closed.iter().map(|&i| motions.iter().map(|r| row(i, r)).collect()).collect();
        let gaps: Vec<f64> = closed.iter().map(|&i| case.contact.1[i] - row(i, &u0)).collect();
        let br = Dense(br);
        // (18), corrected
        let by_18 = solve(Dense::gram(&br).0, br.transpose_times(&gaps, motions.len())).unwrap();
        let error: Vec<f64> = by_18.iter().zip(&alpha).map(|(a, b)| a - b).collect();
        assert!(
            norm(&error) <= bound * norm(&alpha),
            "{name} {method} {tolerance} (18): {by_18:?} {alpha:?}"
        );
        let u = case.displacement(&problem);
        let by_17 = |j: usize| u0[j] + motions.iter().zip(&alpha).map(|(r, a)| r[j] * a).sum::<f64>();
        let error: Vec<f64> = (0..u.len()).map(|j| u[j] - by_17(j)).collect();
        assert!(norm(&error) <= 1e-12 * norm(&u), "{name} (17)");
    }
}

/// K+(f - B'lambda), the columns of R over all unknowns, alpha.
fn parts(case: &Case, problem: &mut Problem) -> (Vec<f64>, Vec<Vec<f64>>, Vec<f64>) {
    let (rest, n) = (rest(case, problem), case.load.len());
    let (mut u0, mut motions, mut alpha, mut start) = (vec![0.0; n], Vec::new(), Vec::new(), 0);
    for body in 0..case.bodies.len() {
        let order = case.bodies[body].0.ptr.len() - 1;
        let range = start..start + order;
        alpha.extend(problem.amplitudes(body).unwrap().to_vec());
        problem.kplus(body, &rest[range.clone()], &mut u0[range.clone()]).unwrap();
        let (_, basis) = problem.null_space(body).unwrap();
        for column in basis.chunks_exact(order) {
            let mut motion = vec![0.0; n];
            motion[range.clone()].copy_from_slice(column);
            motions.push(motion);
        }
        start += order;
    }
    (u0, motions, alpha)
}
