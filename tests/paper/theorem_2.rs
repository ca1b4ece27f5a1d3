//! Theorem 2 on random strictly convex problems (19), whose solutions are found by enumeration of all faces:
//! (i) convergence for any Gamma > 0; (ii) where the problem is not degenerate, the active set is identified and the last
//! face solved to rounding in finitely many steps; (iii) also where it is degenerate, for Gamma >= sqrt(cond A).

use decks::random::Random;
use feti_contact::linalg::Csr;
use feti_contact::qp::Qp;
use paper::{PaperRule, Proportioning, Quadratic, Variant};

use crate::paper::eigenvalues::eigenvalues;
use crate::qp::dense::{dot, norm, solve, Dense};

const VARIANTS: [Variant; 3] = [Variant::Feasible, Variant::Monotone, Variant::Extrapolating];
/// |g^P| of a face solved to rounding, against |b|.
const ROUNDING: f64 = 1e-12;

struct Program {
    a: Dense,
    b: Vec<f64>,
    /// By enumeration.
    x: Vec<f64>,
    /// Smallest |g_i| of a row at its bound, against |b|.
    strictness: f64,
}

/// m <= 8 unknowns; with `degenerate` one row is at its bound without a force.
fn program(random: &mut Random, degenerate: bool) -> Program {
    loop {
        let m = 2 + random.below(7);
        let c: Vec<Vec<f64>> = (0..m + 1).map(|_| random.normals(m, 1.0)).collect();
        let mut a = Dense::gram(&Dense(c));
        (0..m).for_each(|i| a.0[i][i] += 0.1);
        let mut b = random.normals(m, 1.0);
        let mut x = by_enumeration(&a, &b);
        let Some(held) = (0..m).find(|&i| x[i] == 0.0) else { continue };
        if degenerate {
            b[held] = dot(&a.0[held], &x);
            x = by_enumeration(&a, &b);
        }
        let force = |i: usize| (dot(&a.0[i], &x) - b[i]).abs() / norm(&b);
        let strictness = (0..m).filter(|&i| x[i] == 0.0).map(force).fold(f64::INFINITY, f64::min);
        return Program { a, b, x, strictness };
    }
}

/// The one x >= 0 with A x - b >= 0 and (A x - b)'x = 0.
fn by_enumeration(a: &Dense, b: &[f64]) -> Vec<f64> {
    let m = b.len();
    let found = (0..1usize << m).find_map(|set| {
        let face: Vec<usize> = (0..m).filter(|i| set >> i & 1 == 1).collect();
        let block = face.iter().map(|&i| face.iter().map(|&j| a.0[i][j]).collect()).collect();
        let part = solve(block, face.iter().map(|&i| b[i]).collect())?;
        let mut x = vec![0.0; m];
        face.iter().zip(&part).for_each(|(&i, v)| x[i] = *v);
        let optimal = |i: usize| x[i] >= 0.0 && dot(&a.0[i], &x) - b[i] >= -1e-11 * norm(b);
        (0..m).all(optimal).then_some(x)
    });
    found.expect("a strictly convex problem has a solution")
}

/// x and the number of steps until `|g^P| <= tolerance |b|`; none when `limit` steps do not get there.
fn run(program: &Program, gamma: f64, variant: Variant, limit: usize) -> Option<(Vec<f64>, usize)> {
    let (m, mut none) = (program.b.len(), Csr::empty(0));
    (0..m).for_each(|_| none.push_row([]));
    let bounded = vec![true; m];
    let qp = Qp::plain(&program.a, &program.b, &none, &[], &bounded);
    let mut q = Quadratic::theta(qp);
    let rule = PaperRule { gamma, variant, extrapolation: 5.0 };
    let mut run = Proportioning::new(&mut q, vec![1.0; m], rule).unwrap();
    let small = ROUNDING * norm(&program.b);
    let mut values = vec![f64::INFINITY];
    run.run(&mut |run| {
        let value = run.q.value(&run.point.x, &run.point.g);
        assert!(value <= values[values.len() - 1] + 1e-13 * value.abs(), "theta rose");
        assert!(run.point.x.iter().all(|x| *x >= 0.0), "left the bounds");
        values.push(value);
        Ok(run.point.split.norm() <= small || run.counts.steps() >= limit)
    })
    .unwrap();
    (run.point.split.norm() <= small).then(|| (run.point.x.clone(), run.counts.steps()))
}

#[test]
fn i_every_variant_converges_for_any_gamma() {
    let mut random = Random::new(1);
    for _ in 0..60 {
        let program = program(&mut random, false);
        for (variant, gamma) in VARIANTS.into_iter().flat_map(|v| [0.1, 1.0, 10.0].map(|g| (v, g))) {
            let (x, _) = run(&program, gamma, variant, 20_000).unwrap_or_else(|| {
                panic!(
                    "{variant:?} {gamma} m {} strict {} cond {:?}",
                    program.b.len(),
                    program.strictness,
                    eigenvalues(&program.a)
                )
            });
            let error: Vec<f64> = x.iter().zip(&program.x).map(|(x, y)| x - y).collect();
            assert!(norm(&error) <= 1e-9 * (1.0 + norm(&program.x)), "{variant:?} {gamma}");
        }
    }
}

#[test]
fn ii_the_active_set_is_identified_and_the_last_face_solved_where_nothing_is_degenerate() {
    let mut random = Random::new(2);
    let mut tried = 0;
    while tried < 60 {
        let program = program(&mut random, false);
        if program.strictness < 1e-3 {
            continue;
        }
        tried += 1;
        for (variant, gamma) in VARIANTS.into_iter().flat_map(|v| [1.0, 10.0].map(|g| (v, g))) {
            let (x, steps) =
                run(&program, gamma, variant, 40 * x_len(&program)).expect("finitely many steps");
            let same = x.iter().zip(&program.x).all(|(x, y)| (*x == 0.0) == (*y == 0.0));
            assert!(same, "{variant:?} {gamma}: {steps} steps to {x:?}, not {:?}", program.x);
        }
    }
}

#[test]
fn iii_degenerate_problems_end_in_finitely_many_steps_for_gamma_from_the_root_of_the_condition_on() {
    let mut random = Random::new(3);
    for _ in 0..60 {
        let program = program(&mut random, true);
        let values = eigenvalues(&program.a);
        let gamma = (values[values.len() - 1] / values[0]).sqrt();
        for (variant, factor) in VARIANTS.into_iter().flat_map(|v| [1.0, 3.0].map(|f| (v, f))) {
            let (x, _) =
                run(&program, factor * gamma, variant, 40 * x_len(&program)).expect("finitely many steps");
            let error: Vec<f64> = x.iter().zip(&program.x).map(|(x, y)| x - y).collect();
            assert!(norm(&error) <= 1e-9 * (1.0 + norm(&program.x)), "{variant:?}");
        }
    }
}

fn x_len(program: &Program) -> usize {
    program.x.len()
}
