use super::*;
use crate::linalg::random::scattered;
use crate::linalg::SpdSolver;

fn rows(rows: &[Vec<f64>]) -> Csr {
    let mut csr = Csr::empty(rows[0].len());
    rows.iter().for_each(|row| csr.push_row(row.iter().copied().enumerate()));
    csr
}

fn solve(a: &[Vec<f64>], gap: &[f64], target: &[f64]) -> Vec<f64> {
    noisy(a, gap, target, 0.0).point
}

/// The solution for gaps with the error `noise`; checks that the forces lead to the point.
fn noisy(a: &[Vec<f64>], gap: &[f64], target: &[f64], noise: f64) -> Nearest {
    let (rows, noise) = (rows(a), vec![noise; gap.len()]);
    let found =
        nearest_point(Polyhedron { rows: &rows, gap, target, noise: &noise, rounding: NOISE }).unwrap();
    let mut reached = target.to_vec();
    rows.mul_transposed_add(-1.0, &found.forces, &mut reached);
    let far: Vec<f64> = reached.iter().zip(&found.point).map(|(a, b)| a - b).collect();
    assert!(norm(&far) <= 1e-9 * norm(target));
    assert!(found.forces.iter().all(|force| *force >= 0.0));
    found
}

fn assert_near(found: &[f64], expected: &[f64], accuracy: f64) {
    let worst = found.iter().zip(expected).fold(0.0f64, |worst, (a, b)| worst.max((a - b).abs()));
    assert!(worst <= accuracy * norm_max(expected).max(f64::MIN_POSITIVE), "{found:?} {expected:?}");
}

#[test]
fn one_and_two_motions_stop_where_they_must() {
    assert_eq!(solve(&[vec![2.0]], &[1.0], &[3.0]), [0.5]);
    assert_eq!(solve(&[vec![2.0], vec![-1.0]], &[1.0, 0.0], &[-3.0]), [0.0]);
    // the corner x <= 1, y <= 1; then the edge x + y <= 1 from (2, 0)
    assert_near(&solve(&[vec![1.0, 0.0], vec![0.0, 1.0]], &[1.0, 1.0], &[3.0, 2.0]), &[1.0, 1.0], 1e-15);
    assert_near(&solve(&[vec![1.0, 1.0]], &[1.0], &[2.0, 0.0]), &[1.5, -0.5], 1e-15);
    // a row that is active first leaves again: x + y <= 1, then x <= 0 from (4, 1)
    assert_near(&solve(&[vec![1.0, 1.0], vec![1.0, 0.0]], &[1.0, 0.0], &[4.0, 0.5]), &[0.0, 0.5], 1e-15);
}

#[test]
fn a_target_that_violates_nothing_is_the_answer_bit_for_bit() {
    let target = [0.1, -1.0 / 3.0, 7e-9];
    let a = vec![vec![1.0, 2.0, 3.0], vec![0.0; 3], vec![1e-17, -1e-17, 0.0], vec![0.0, -1.0, 0.0]];
    assert_eq!(solve(&a, &[0.0, 0.0, 1e-16, 1.0 / 3.0], &target), target);
    assert_eq!(solve(&a, &[f64::INFINITY, 0.0, 1e300, 1e20], &target), target);
    assert_eq!(solve(&a, &[0.0; 4], &[0.0; 3]), [0.0; 3]);
    let noisy = noisy(&a, &[0.0, 0.0, -1e-17, 0.0], &[0.1, -0.3, 0.0], 1.0);
    assert_eq!(noisy.point, [0.1, -0.3, 0.0], "nothing is violated by more than its noise");
}

/// x <= 0, -x - y <= -3, y <= 1 and z <= 5, which no point satisfies.
#[test]
fn rows_that_contradict_each_other_are_told_with_their_weights() {
    let a = [vec![1.0, 0.0, 0.0], vec![-2.0, -2.0, 0.0], vec![0.0, 1.0, 0.0], vec![0.0, 0.0, 1.0]];
    let found = noisy(&a, &[0.0, -6.0, 1.0, 5.0], &[0.3, 0.1, 7.0], 0.0);
    let [weights] = &found.contradictions[..] else { panic!("{}", found.contradictions.len()) };
    let mut w = [0.0; 4];
    weights.iter().for_each(|&(i, weight)| w[i] = weight / weights[0].1);
    let by = w[0];
    assert_near(&w.map(|w| w / by), &[1.0, 0.5, 1.0, 0.0], 1e-14);
    assert_eq!(found.point[2], 5.0);
}

/// The nearest of the feasible points given by all sets of active rows.
fn by_enumeration(a: &[Vec<f64>], gap: &[f64], target: &[f64]) -> Vec<f64> {
    let (mut best, mut nearest) = (f64::INFINITY, vec![0.0; target.len()]);
    for set in 0..1usize << a.len() {
        let met: Vec<usize> = (0..a.len()).filter(|i| set >> i & 1 == 1).collect();
        let n = met.len();
        let mut gram = Matrix::zeros(n, n).unwrap();
        (0..n * n).for_each(|k| gram.data[k] = dot(&a[met[k / n]], &a[met[k % n]]));
        let excess: Vec<f64> = met.iter().map(|&i| dot(&a[i], target) - gap[i]).collect();
        let scale: Vec<f64> = (0..n).map(|k| gram.get(k, k).max(1e-300)).collect();
        let mut point = target.to_vec();
        if n > 0 {
            let force = SpdSolver::new(&gram, &scale).unwrap().solve(&excess);
            met.iter().zip(force).for_each(|(&i, force)| axpy(-force, &a[i], &mut point));
        }
        let way: Vec<f64> = point.iter().zip(target).map(|(p, t)| p - t).collect();
        let feasible =
            (0..a.len()).all(|i| dot(&a[i], &point) <= gap[i] + 1e-12 * norm(target) * norm(&a[i]));
        if feasible && norm(&way) < best {
            (best, nearest) = (norm(&way), point);
        }
    }
    nearest
}

#[test]
fn random_problems_also_degenerate_ones_are_solved_as_by_enumeration() {
    let mut numbers = scattered(200_000).into_iter();
    let mut next = move || numbers.next().unwrap();
    for case in 0..1500 {
        let (d, m) = (1 + case % 3, 1 + case / 3 % 8);
        let mut a: Vec<Vec<f64>> = (0..m).map(|_| (0..d).map(|_| next()).collect()).collect();
        let mut gap: Vec<f64> = (0..m).map(|_| (0.2 * next()).max(0.0)).collect();
        if case % 5 == 1 && m > 2 {
            (a[m - 1], gap[m - 1]) = (a[0].iter().map(|v| 3.0 * v).collect(), 3.0 * gap[0]);
            (a[1], gap[1]) = (a[0].clone(), gap[0] * 0.999);
        }
        if case % 5 == 2 {
            gap.iter_mut().for_each(|g| *g = 0.0);
        }
        if case % 5 == 3 && m > 3 {
            a[2] = (0..d).map(|k| 0.3 * a[0][k] + 0.6 * a[1][k]).collect();
            gap[2] = 0.3 * gap[0] + 0.6 * gap[1];
            a[3] = vec![0.0; d];
        }
        let target: Vec<f64> = (0..d).map(|_| next()).collect();
        let found = solve(&a, &gap, &target);
        let expected = by_enumeration(&a, &gap, &target);
        let worst = found.iter().zip(&expected).fold(0.0f64, |worst, (f, e)| worst.max((f - e).abs()));
        assert!(worst <= 1e-11, "case {case}: {worst:e} {found:?} {expected:?}");
    }
}

#[test]
fn units_change_nothing_but_the_unit() {
    let mut numbers = scattered(10_000).into_iter();
    let mut next = move || numbers.next().unwrap();
    let a: Vec<Vec<f64>> = (0..40).map(|_| (0..9).map(|_| next()).collect()).collect();
    let gap: Vec<f64> = (0..40).map(|_| 0.1 + 0.1 * next()).collect();
    let target: Vec<f64> = (0..9).map(|_| next()).collect();
    let times = |x: &[f64], by: f64| -> Vec<f64> { x.iter().map(|v| v * by).collect() };
    let expected = solve(&a, &gap, &target);
    for power in [-300, -40, 3, 200] {
        let by = 2f64.powi(power);
        assert_eq!(solve(&a, &times(&gap, by), &times(&target, by)), times(&expected, by));
    }
    let scaled: Vec<Vec<f64>> = a.iter().map(|row| times(row, 1e-6)).collect();
    assert_near(&solve(&scaled, &times(&gap, 1e-6), &target), &expected, 1e-13);
    assert_near(&solve(&a, &times(&gap, 1e10), &times(&target, 1e10)), &times(&expected, 1e10), 1e-13);
}

/// Karush-Kuhn-Tucker conditions at the nearest point: (a0 - a)'(b - a) <= 0 for feasible b.
#[test]
fn hundreds_of_motions_and_rows_with_copies_that_differ_by_rounding() {
    let mut numbers = scattered(4_000_000).into_iter();
    let mut next = move || numbers.next().unwrap();
    let (d, m) = (120, 3000);
    let mut a: Vec<Vec<f64>> = (0..m / 2).map(|_| (0..d).map(|_| next()).collect()).collect();
    let mut gap: Vec<f64> = (0..m / 2).map(|_| 0.5 + next()).collect();
    for i in 0..m / 2 {
        a.push(a[i].iter().map(|v| v * (1.0 + 1e-15 * next())).collect());
        gap.push(gap[i]);
    }
    let target: Vec<f64> = (0..d).map(|_| 3.0 * next()).collect();
    let found = solve(&a, &gap, &target);
    assert!((0..m).all(|i| dot(&a[i], &found) <= gap[i] + 1e-12));
    let way: Vec<f64> = target.iter().zip(&found).map(|(t, f)| t - f).collect();
    assert!(dot(&way, &found) >= -1e-11, "0 is feasible");
    // a - a0 is a combination of active rows
    let met: Vec<usize> = (0..m / 2).filter(|&i| dot(&a[i], &found) > gap[i] - 1e-10).collect();
    let normals: Vec<f64> = met.iter().flat_map(|&i| a[i].clone()).collect();
    let basis = Matrix { rows: d, cols: met.len(), data: normals }.orthonormalised(1e-9);
    let mut left = way.clone();
    basis.mul_add(-1.0, &basis.mul_transposed(&way), &mut left);
    assert!(met.len() > 5 && norm(&left) <= 1e-10, "{} {:e}", met.len(), norm(&left));
    // motions without connection to these change no bit
    let mut both: Vec<Vec<f64>> = a.iter().map(|row| [row.clone(), vec![0.0]].concat()).collect();
    both.push([vec![0.0; d], vec![1.0]].concat());
    let gaps = [gap.clone(), vec![0.25]].concat();
    let found_both = solve(&both, &gaps, &[target.clone(), vec![1.0]].concat());
    assert_eq!(found_both[..d], found[..]);
    assert_eq!(found_both[d], 0.25);
}
