//! Bounds alone, Tresca's law, in the plane: a convex problem, whose answer a dense method of its own finds: forces within bounds that
//! minimise `x'F x/2 - d'x` with `G x = e`.

use decks::Deck;
use feti_contact::solver::Outcome;

use crate::coulomb::battery::answer;
use crate::coulomb::drawn::{case, OTHER_SIZES, SIZES};
use crate::coulomb::enumeration::{distance, eliminated, size, Dual, Ends};
use crate::support::hand_over;

/// Forces, gaps and slips below this part of the largest are none; an answer with such a force, gap or slip where it must have one
/// may be one of several and is not compared.
const NONE: f64 = 1e-9;
/// Forces of the library are those of the dense method to this part of the largest.
const NEAR: f64 = 1e-8;

/// Least and largest force of every row.
fn bounds(deck: &Deck, unit: &[f64]) -> Vec<[f64; 2]> {
    let mut all: Vec<[f64; 2]> =
        deck.contact.rhs.iter().map(|gap| [0.0, if gap.is_finite() { f64::INFINITY } else { 0.0 }]).collect();
    all.extend(deck.friction.bound.iter().map(|bound| [-bound, *bound]));
    all.extend(deck.equalities.rhs.iter().map(|_| [f64::NEG_INFINITY, f64::INFINITY]));
    all.iter().zip(unit).map(|(range, unit)| range.map(|force| force / unit)).collect()
}

/// Gauss and Seidel's method within the bounds, for the Lagrangian of `G x = e` augmented by `weight |G x - e|^2 / 2`.
fn approximate(dual: &Dual, bounds: &[[f64; 2]]) -> Vec<f64> {
    let (m, r) = (dual.d.len(), dual.e.len());
    let product = |i: usize, j: usize| dual.g.iter().map(|row| row[i] * row[j]).sum::<f64>();
    let of = |entry: &dyn Fn(usize) -> f64| (0..m).map(entry).sum::<f64>();
    let (trace, of_g) = (of(&|i| dual.f[i][i]), of(&|i| product(i, i)));
    let weight = if of_g > 0.0 && trace > 0.0 { trace / of_g } else { 1.0 };
    let (mut x, mut a) = (vec![0.0f64; m], vec![0.0; r]);
    let augmented: Vec<Vec<f64>> =
        (0..m).map(|i| (0..m).map(|j| dual.f[i][j] + weight * product(i, j)).collect()).collect();
    for _ in 0..60 {
        let given: Vec<f64> = (0..m)
            .map(|i| dual.d[i] + (0..r).map(|k| dual.g[k][i] * (a[k] + weight * dual.e[k])).sum::<f64>())
            .collect();
        for _ in 0..100 {
            for i in (0..m).filter(|&i| augmented[i][i] > 0.0) {
                let by: f64 = augmented[i].iter().zip(&x).map(|(f, x)| f * x).sum();
                x[i] = (x[i] + (given[i] - by) / augmented[i][i]).clamp(bounds[i][0], bounds[i][1]);
            }
        }
        for k in 0..r {
            let held: f64 = dual.g[k].iter().zip(&x).map(|(g, x)| g * x).sum();
            a[k] += weight * (dual.e[k] - held);
        }
    }
    x.extend(a);
    x
}

/// The only forces, in the host's unit: a linear system for the forces that are at no bound, from the approximate ones on, until all
/// laws hold. None where that system is singular, for then forces are shared at will or motions are left open.
fn answered(deck: &Deck) -> Option<Vec<f64>> {
    let dual = Dual::new(deck);
    let (m, r) = (dual.d.len(), dual.e.len());
    let bounds = bounds(deck, &dual.unit);
    let widths: Vec<f64> = bounds.iter().map(|range| range[1] - range[0]).collect();
    let mut x = approximate(&dual, &bounds);
    for _ in 0..30 {
        let none = NONE * size(&x[..m]).max(size(&dual.d));
        // the bound that each force is at
        let held: Vec<Option<f64>> = (0..m)
            .map(|i| {
                let trial = x[i] - dual.gap(&x, i);
                let [least, most] = bounds[i];
                let nearest = if trial < least { least } else { most };
                (widths[i] == 0.0 || trial < least || trial > most).then_some(nearest)
            })
            .collect();
        let (mut a, mut b) = (vec![vec![0.0; m + r]; m + r], [&dual.d[..], &dual.e].concat());
        for i in 0..m {
            a[i][..m].copy_from_slice(&dual.f[i]);
            for k in 0..r {
                a[i][m + k] = -dual.g[k][i];
                a[m + k][i] = dual.g[k][i];
            }
        }
        for (i, force) in held.iter().enumerate() {
            if let Some(force) = force {
                a[i].fill(0.0);
                (a[i][i], b[i]) = (1.0, *force);
            }
        }
        let Ends::One(solved) = eliminated(a, b) else { return None };
        x = solved;
        let beyond = |i: usize| match held[i] {
            // a gap where there is no force, a slip along the force at its bound
            Some(force) if widths[i] > 0.0 => {
                let sense = if force == bounds[i][0] { 1.0 } else { -1.0 };
                sense * dual.gap(&x, i)
            }
            Some(_) => f64::INFINITY,
            None => (x[i] - bounds[i][0]).min(bounds[i][1] - x[i]),
        };
        let least = (0..m).map(beyond).fold(f64::INFINITY, f64::min);
        if least > none {
            return Some((0..m).map(|i| x[i] * dual.unit[i]).collect());
        }
    }
    None
}

#[test]
fn answers_with_bounds_alone_are_those_of_a_dense_convex_method() {
    let (mut compared, mut largest) = (0, 0.0f64);
    for k in 0..700 {
        let sizes = if k % 3 == 2 { &OTHER_SIZES } else { &SIZES };
        let mut deck = case(17 * k + 2, sizes).deck;
        if deck.friction.dim != 1 {
            continue;
        }
        // other loads than those that the answer was drawn for
        let by = [1.0, 0.6, 1.5][k as usize / 3 % 3];
        deck.bodies.iter_mut().flat_map(|body| &mut body.load).for_each(|f| *f *= by);
        assert!(deck.friction.coefficient.iter().all(|mu| *mu == 0.0));
        let Some(expected) = answered(&deck) else { continue };
        let mut problem = hand_over::problem(&deck).unwrap();
        let report = problem.solve().unwrap_or_else(|error| panic!("{k}: {error}"));
        assert_eq!(report.outcome, Outcome::Solved, "{k}");
        let found = answer(&problem);
        let far = distance(&deck, &[expected], &[&found.lambda[..], &found.along, &found.mu].concat());
        assert!(far <= NEAR, "{k}: {far:e}");
        (compared, largest) = (compared + 1, largest.max(far));
    }
    println!("{compared} compared, largest distance {largest:e}");
    assert!(compared > 140, "{compared}");
}
