use super::*;
use crate::linalg::{Csr, Packed};
use crate::qp::acceptance::tests::Lenient;

const LIMITS: Limits = Limits { tolerance: 1e-10, gamma: 1.0, steps: 10_000 };

/// `sum x_i = 1`, A = I, b = (0, -3, ..., -3): only the first row is free at the answer (1, 0, ..., 0), and it has 1 / m
/// of the mode: an outer iteration divides the violation by 1 + 3 / m.
#[test]
fn far_more_than_a_hundred_outer_iterations_are_taken_where_they_are_needed() {
    let m = 60;
    let mut g_transposed = Csr::empty(1);
    let mut a = Packed::zeros(m).unwrap();
    for i in 0..m {
        g_transposed.push_row([(0, 1.0)]);
        a.add(i, i, 1.0);
    }
    let b: Vec<f64> = (0..m).map(|i| if i == 0 { 0.0 } else { -3.0 }).collect();
    let qp = Qp {
        a: &a,
        b: &b,
        g_transposed: &g_transposed,
        blocks: &[],
        rounding: 1e-14,
        e: &[1.0],
        bounded: &vec![true; m],
        preconditioner: None,
        kept: None,
    };
    let mut al = Lagrangian::new(qp, &vec![0.0; m]).unwrap();
    let (mut judge, mut observer) = (Lenient { allowed: 0 }, Lenient { allowed: LIMITS.steps });
    assert_eq!(al.run(&LIMITS, &mut judge, &mut observer).unwrap(), Verdict::Solved);
    assert!(al.outer > 300, "{} outer iterations", al.outer);
    assert!((al.point.x[0] - 1.0).abs() < 1e-8);
    assert!((al.alpha()[0] - 1.0).abs() < 1e-8, "{:?}", al.alpha());
    assert!(al.point.x[1..].iter().all(|x| *x == 0.0));
}
/// A tridiagonal, G = (1 ... 1; 1, 2 ... m), some rows at their bound.
#[test]
fn gradient_alpha_and_theta_follow_all_steps_without_a_product_of_their_own() {
    let m = 12;
    let (mut g_transposed, mut a) = (Csr::empty(2), Packed::zeros(m).unwrap());
    for i in 0..m {
        g_transposed.push_row([(0, 1.0), (1, 1.0 + i as f64)]);
        a.add(i, i, 2.5);
        (1..=i).take(1).for_each(|_| a.add(i, i - 1, -1.0));
    }
    let b: Vec<f64> = (0..m).map(|i| if i % 3 == 0 { -4.0 } else { 1.0 + i as f64 }).collect();
    let (e, bounded) = ([5.0, 40.0], vec![true; m]);
    let qp = Qp {
        a: &a,
        b: &b,
        g_transposed: &g_transposed,
        blocks: &[],
        rounding: 1e-14,
        e: &e,
        bounded: &bounded,
        preconditioner: None,
        kept: None,
    };
    for allowed in 1..30 {
        let mut al = Lagrangian::new(qp, &vec![0.0; m]).unwrap();
        let (mut judge, mut observer) = (Lenient { allowed: 0 }, Lenient { allowed });
        let refused = al.run(&LIMITS, &mut judge, &mut observer);
        assert!(refused.is_ok() || al.map.counts.steps() == allowed);
        let (followed, theta) = (al.point.g.clone(), al.theta());
        al.recompute().unwrap();
        let difference: Vec<f64> = followed.iter().zip(&al.point.g).map(|(f, g)| f - g).collect();
        assert!(norm(&difference) <= 1e-11 * norm(&followed), "{allowed} steps: {difference:?}");
        let mut v = al.point.x.clone();
        axpy(-1.0, &al.violation.way, &mut v);
        let image = al.map.image(&v).unwrap();
        assert!((0.5 * dot(&v, &image) - dot(&b, &v) - theta).abs() <= 1e-11 * dot(&v, &image));
    }
}
