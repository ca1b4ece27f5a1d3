//! Programs without a solution, and the directions that prove it.

use decks::random::Random;
use feti_contact::qp::Verdict;

use crate::qp::dense::{dot, norm, Dense};
use crate::qp::program::Program;

type Fault = Result<(), String>;

fn holds(condition: bool, otherwise: impl FnOnce() -> String) -> Fault {
    if condition {
        Ok(())
    } else {
        Err(otherwise())
    }
}

/// The direction a that a verdict must bring along: `G_i'a <= 0` on bounded rows, `= 0` on free ones,
/// `e'a > 0`: then no x satisfies `G x = e`. Returns the margin.
fn infeasible(program: &Program) -> Result<f64, String> {
    let solution = program.minimise();
    let Verdict::Infeasible { direction, margin } = &solution.verdict else {
        return Err(format!("{:?} {:?}", solution.verdict, solution.counts));
    };
    let columns = program.g.transpose_times(direction, program.b.len());
    for (i, along) in columns.iter().enumerate() {
        let column: Vec<f64> = program.g.0.iter().map(|row| row[i]).collect();
        let rounding = 1e-8 * norm(&column) * norm(direction);
        holds(*along <= rounding, || format!("row {i} holds against the direction by {along:e}"))?;
        holds(program.bounded[i] || *along >= -rounding, || {
            format!("the free row {i} resists by {along:e}")
        })?;
    }
    let work = dot(&program.e, direction);
    holds(work > 1e-9 * norm(&program.e) * norm(direction), || format!("the load works {work:e}"))?;
    holds((1e-7..1.0 + 1e-12).contains(margin), || format!("margin {margin:e}"))?;
    holds(solution.counts.products == 0, || "no product with A is needed".into())?;
    Ok(*margin)
}

/// The direction p that a verdict must bring along: `A p = 0, G p = 0`, p <= 0 on bounded rows, `b'p < 0`:
/// theta falls without end along -p.
fn unbounded(program: &Program) -> Fault {
    let solution = program.minimise();
    let Verdict::Unbounded { p } = &solution.verdict else {
        return Err(format!("{:?} {:?}", solution.verdict, solution.counts));
    };
    let size = norm(p);
    let longest = |matrix: &Dense| matrix.0.iter().map(|row| norm(row)).fold(0.0, f64::max);
    let (image, modes) = (norm(&program.a.times(p)), norm(&program.g.times(p)));
    holds(image <= 1e-8 * longest(&program.a) * size, || format!("A p is {image:e}"))?;
    holds(modes <= 1e-8 * longest(&program.g) * size, || format!("G p is {modes:e}"))?;
    for (i, p) in p.iter().enumerate().filter(|(i, _)| program.bounded[*i]) {
        holds(*p <= 1e-8 * size, || format!("row {i} meets its bound, p = {p:e}"))?;
    }
    holds(dot(&program.b, p) < -1e-8 * norm(&program.b) * size, || "theta does not fall".into())
}

fn assert_none(faults: &[String]) {
    assert!(faults.is_empty(), "{} programs end otherwise:\n{}", faults.len(), faults.join("\n"));
}

#[test]
fn a_load_that_no_row_can_balance_is_named_with_its_direction() {
    let identity = Dense::diagonal(&[1.0; 2]);
    // contact can only push: x1 + x2 = -1
    let pull = Program::new(identity.clone(), &[1.0, 1.0]).with_equalities(&[&[1.0, 1.0]], &[-1.0]);
    assert_eq!(infeasible(&pull).unwrap(), 1.0);
    // (3, -4) with rows along (1, 0) only
    let aside =
        Program::new(identity.clone(), &[0.0; 2]).with_equalities(&[&[1.0, 2.0], &[0.0, 0.0]], &[3.0, -4.0]);
    assert!(infeasible(&aside).unwrap() > 0.5);
    // a free row holds its own direction only
    let free = Program::new(identity, &[0.0; 2])
        .with_equalities(&[&[1.0, 0.0], &[0.0, 1.0]], &[-5.0, -1.0])
        .with_free_rows(&[0]);
    assert!(infeasible(&free).unwrap() > 0.19);
}

/// Rows with `G_i'a <= 0` (`= 0` where free) and a load with `e'a` = `pull` |e||a|.
fn not_held(random: &mut Random, pull: f64) -> Program {
    let (m, r) = (1 + random.below(10), 2 + random.below(2));
    let a = random.normals(r, 1.0);
    let length2 = dot(&a, &a);
    let bounded: Vec<bool> = (0..m).map(|_| random.chance(0.8)).collect();
    let mut g = Dense::zeros(r, m);
    for (i, bounded) in bounded.iter().enumerate() {
        let column = random.normals(r, 1.0);
        let along = dot(&column, &a) / length2;
        let kept = if *bounded { -along.abs() } else { 0.0 };
        (0..r).for_each(|k| g.0[k][i] = column[k] + (kept - along) * a[k]);
    }
    let mut e = random.normals(r, 1.0);
    let along = dot(&e, &a) / length2;
    e.iter_mut().zip(&a).for_each(|(e, a)| *e -= along * a);
    let (across, length) = (norm(&e), length2.sqrt());
    e.iter_mut().zip(&a).for_each(|(e, a)| *e += pull * across * a / length);
    Program { a: Dense::diagonal(&vec![1.0; m]), b: random.normals(m, 1.0), g, e, bounded }
}

#[test]
fn random_loads_that_pull_away_are_named_however_little_they_pull() {
    let mut faults = Vec::new();
    for pull in [1.0, 1e-2, 1e-4] {
        for seed in 0..100 {
            let found = infeasible(&not_held(&mut Random::new(seed), pull));
            faults.extend(found.err().map(|fault| format!("pull {pull:e} seed {seed}: {fault}")));
        }
    }
    assert_none(&faults);
}

/// How much of a load matters is for others to say: of what no force balances only rounding is left out.
#[test]
fn what_forces_leave_of_a_load_is_told_but_for_rounding() {
    let with = |pull: f64| {
        Program::new(Dense::diagonal(&[1.0; 2]), &[1.0, 1.0])
            .with_equalities(&[&[1.0, 1.0], &[0.0, 0.0]], &[2.0, pull])
    };
    for pull in [1e-8, 1e-6] {
        let found = with(pull).minimise_from(&[0.0; 2], 1e-12, 1e-7);
        let Verdict::Infeasible { direction, margin } = found.verdict else { panic!("{:?}", found.verdict) };
        assert!(
            (margin / pull - 0.5).abs() < 1e-4 && (direction[1] / pull - 1.0).abs() < 1e-12,
            "{margin:e}"
        );
        assert!((found.x[0] + found.x[1] - 2.0).abs() < 1e-14, "{:?}", found.x);
    }
    let found = with(1e-13).minimise_from(&[0.0; 2], 1e-12, 1e-7);
    assert_eq!(found.verdict, Verdict::Solved);
    assert!(found.x.iter().all(|x| (x - 1.0).abs() < 1e-7), "{:?}", found.x);
}

#[test]
fn gaps_that_contradict_each_other_are_named_with_their_weights() {
    // u <= -1 and -u <= -1 on one spring: B = (1, -1), d = -c = (1, 1)
    let opposite = Program::new(Dense(vec![vec![1.0, -1.0], vec![-1.0, 1.0]]), &[1.0, 1.0]);
    unbounded(&opposite).expect("opposite rows");
    // u = 1 and u <= 0
    let glued = Program::new(Dense(vec![vec![1.0; 2]; 2]), &[0.0, -1.0]).with_free_rows(&[1]);
    unbounded(&glued).expect("an equality against a bound");
    // no stiffness at all
    unbounded(&Program::new(Dense::zeros(2, 2), &[-1.0, 1.0])).expect("no curvature");
    // floating: u1 <= -1, -u1 <= -1 with one mode
    let floating = Program::new(Dense::zeros(2, 2), &[1.0, 1.0]).with_equalities(&[&[1.0, -1.0]], &[0.5]);
    unbounded(&floating).expect("opposite rows on a floating body");
}

/// A feasible program with `C w = 0, G w = 0`, w >= 0 on bounded rows, and `b'w` = `demand`.
fn contradictory(random: &mut Random, demand: f64) -> Program {
    let m = 2 + random.below(9);
    let r = random.below(3).min(m - 2);
    let bounded: Vec<bool> = (0..m).map(|_| random.chance(0.8)).collect();
    let mut w: Vec<f64> =
        (0..m).map(|_| if random.chance(0.5) { random.between(0.5, 1.5) } else { 0.0 }).collect();
    w[0] = 1.0;
    let length2 = dot(&w, &w);
    let across = |row: Vec<f64>| -> Vec<f64> {
        let along = dot(&row, &w) / length2;
        row.iter().zip(&w).map(|(v, w)| v - along * w).collect()
    };
    let c = Dense((0..m).map(|_| across(random.normals(m, 1.0))).collect());
    let g = Dense((0..r).map(|_| across(random.normals(m, 1.0))).collect());
    let x: Vec<f64> = random.normals(m, 1.0).iter().map(|x| x.abs()).collect();
    let mut b = across(random.normals(m, 1.0));
    b.iter_mut().zip(&w).for_each(|(b, w)| *b += demand * w / length2);
    Program { a: Dense::gram(&c), b, e: g.times(&x), g, bounded }
}

/// A contradiction is for the rows to show before any product with A; a walk that meets one may take long.
#[test]
fn random_contradictions_are_never_solved_and_most_are_named() {
    let (mut faults, mut unnamed) = (Vec::new(), 0);
    for demand in [1.0, 1e-2] {
        for seed in 0..100 {
            let program = contradictory(&mut Random::new(seed), demand);
            match program.minimise().verdict {
                Verdict::Unbounded { .. } => {
                    let found = unbounded(&program);
                    faults.extend(found.err().map(|fault| format!("demand {demand:e} seed {seed}: {fault}")));
                }
                Verdict::StepLimit | Verdict::Stalled | Verdict::Inaccurate => unnamed += 1,
                verdict => faults.push(format!("demand {demand:e} seed {seed}: {verdict:?}")),
            }
        }
    }
    assert_none(&faults);
    assert!(unnamed <= 4, "{unnamed} of 200 are not named");
}

/// x_1 = 1 and x_2 = -t: the nearest x >= 0 leaves t of |e|. Up to 1e-10 the projection takes it for rounding.
#[test]
fn equalities_that_bounds_leave_open_by_more_than_rounding_are_named() {
    for (t, named) in [(1e-14, false), (5e-10, true), (1e-8, true), (1.0, true)] {
        let program = Program::new(Dense::diagonal(&[1.0; 2]), &[0.0; 2])
            .with_equalities(&[&[1.0, 0.0], &[0.0, 1.0]], &[1.0, -t]);
        let Verdict::Infeasible { margin, .. } = program.minimise().verdict else {
            assert!(!named, "{t:e}");
            continue;
        };
        assert!(named && (margin * 1f64.hypot(t) / t - 1.0).abs() < 1e-6, "{t:e} {margin:e}");
    }
}
