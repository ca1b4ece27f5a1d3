//! New loads, gaps and values on the old pattern.

use decks::{Blocks, Deck};
use feti_contact::error::Kind;
use feti_contact::solver::{Modes, Problem, RowKind, SparseInput, Storage};

use crate::reuse::{answer, assert_near, spent};
use crate::support::hand_over;

fn deck() -> Deck {
    Blocks { elements: 4, young: 1.0 }.build()
}

/// Values times 1 + 0.2 sin of the distance of the dofs: as symmetric as they were, with no null space but zero for a
/// clamped body. For the floating one all values times 1.2.
fn new_values(deck: &Deck) -> Deck {
    let mut deck = deck.clone();
    let k = &mut deck.bodies[0].stiffness;
    for i in 0..k.rows {
        for at in k.ptr[i]..k.ptr[i + 1] {
            let (low, high) = (i.min(k.col[at]) as f64, i.max(k.col[at]) as f64);
            k.val[at] *= if low == high { 1.5 } else { 1.0 + 0.01 * (low + 3.0 * high).sin() };
        }
    }
    deck.bodies[1].stiffness.val.iter_mut().for_each(|v| *v *= 1.2);
    deck
}

fn with_modes(deck: &Deck, known: bool) -> Problem {
    if known {
        hand_over::problem(deck).unwrap()
    } else {
        hand_over::without_null_spaces(deck).unwrap()
    }
}

#[test]
fn new_loads_and_gaps_cost_no_analysis_no_factorisation_and_no_column() {
    let deck = deck();
    let mut problem = hand_over::problem(&deck).unwrap();
    let mut before = [0; 4];
    assert_eq!(spent(&mut problem, &mut before), [2, 2, crate::reuse::touches(&deck), 0]);
    let load: Vec<f64> = deck.bodies[1].load.iter().map(|f| 1.3 * f).collect();
    problem.set_load(1, &load).unwrap();
    assert_eq!(spent(&mut problem, &mut before), [0; 4]);
    let gaps: Vec<f64> = deck.contact.rhs.iter().map(|c| 0.5 * c + 1e-3).collect();
    problem.set_rhs(RowKind::Inequality, 0, &gaps).unwrap();
    assert_eq!(spent(&mut problem, &mut before), [0; 4]);
}

#[test]
fn new_values_on_the_old_pattern_take_no_analysis_and_give_the_answer_of_a_new_problem() {
    let (deck, changed) = (deck(), new_values(&deck()));
    for known in [true, false] {
        let mut problem = with_modes(&deck, known);
        let mut before = [0; 4];
        assert_eq!(spent(&mut problem, &mut before)[..2], [2, 2]);
        (0..2).for_each(|p| hand_over::set_body(&mut problem, p, &changed.bodies[p]).unwrap());
        assert_eq!(spent(&mut problem, &mut before)[..2], [0, 2], "null space known: {known}");
        let mut fresh = with_modes(&changed, known);
        spent(&mut fresh, &mut [0; 4]);
        // two slides and the spin of the upper block are free: not u is unique, but forces and gaps are
        assert_near(&answer(&problem)[1], &answer(&fresh)[1], 1e-8, "forces");
        assert_near(problem.gaps().unwrap(), fresh.gaps().unwrap(), 1e-8, "gaps");
    }
}

#[test]
fn the_same_matrix_and_the_same_null_space_again_cost_nothing() {
    let deck = deck();
    let mut problem = hand_over::problem(&deck).unwrap();
    let mut before = [0; 4];
    spent(&mut problem, &mut before);
    let first = answer(&problem);
    for (p, body) in deck.bodies.iter().enumerate() {
        hand_over::set_body(&mut problem, p, body).unwrap();
        let (n, modes) = (body.dofs(), body.modes());
        problem.set_null_space(p, n, modes.len(), &modes.concat(), n, Modes::Exact).unwrap();
    }
    assert_eq!(spent(&mut problem, &mut before), [0, 0, 0, crate::reuse::touches(&deck)]);
    assert!(answer(&problem) == first, "bits differ");
}

#[test]
fn another_pattern_is_analysed_anew() {
    let deck = deck();
    let mut problem = hand_over::problem(&deck).unwrap();
    let mut before = [0; 4];
    spent(&mut problem, &mut before);
    // one more coupling, of the first and the last dof
    let mut other = deck.bodies[0].clone();
    let (n, k) = (other.dofs(), &mut other.stiffness);
    for (row, col) in [(n - 1, 0), (0, n - 1)] {
        let at = if col == 0 { k.ptr[row] } else { k.ptr[row + 1] };
        k.col.insert(at, col);
        k.val.insert(at, 1e-3);
        k.ptr[row + 1..].iter_mut().for_each(|end| *end += 1);
    }
    hand_over::set_body(&mut problem, 0, &other).unwrap();
    assert_eq!(spent(&mut problem, &mut before)[..2], [1, 1]);
}

/// A bar whose first end becomes so soft that dofs held there no longer hold it: the dofs change, and the analysis.
#[test]
fn dofs_that_no_longer_hold_a_body_are_chosen_anew() {
    let chain = |stiffness: &[f64]| {
        let n = stiffness.len() + 1;
        let mut k = vec![0.0; n * n];
        for (i, s) in stiffness.iter().enumerate() {
            for (row, col, sign) in [(i, i, 1.0), (i + 1, i + 1, 1.0), (i, i + 1, -1.0), (i + 1, i, -1.0)] {
                k[row + n * col] += sign * s;
            }
        }
        (n, k)
    };
    let mut problem = Problem::new();
    let mut analyses = Vec::new();
    for stiffness in
        [[8.0, 1.0, 1.0, 1.0], [9.0, 1.1, 1.0, 1.5], [1e-4, 1e-4, 1.0, 2.0], [1e-4, 1e-4, 3.0, 1.0]]
    {
        let (n, k) = chain(&stiffness);
        if problem.sizes().bodies == 0 {
            problem.add_body(n).unwrap();
            problem.set_null_space(0, n, 1, &vec![1.0; n], n, Modes::Exact).unwrap();
        }
        problem.set_stiffness_dense(0, n, &k, n, Storage::Full).unwrap();
        let held = problem.fixing_dofs(0).unwrap().to_vec();
        analyses.push(held[0]);
    }
    assert!(analyses[0] == analyses[1] && analyses[0] <= 1, "{analyses:?}");
    assert!(analyses[2] == analyses[3] && analyses[2] >= 2, "{analyses:?}");
}

/// Either of two dofs holds the body well; without those of the host the library chooses as if there had been none.
#[test]
fn dofs_of_the_host_leave_nothing_behind() {
    let mut problem = Problem::new();
    problem.add_body(2).unwrap();
    let k = [4.0, -4.0, -4.0, 4.0];
    problem.set_stiffness_dense(0, 2, &k, 2, Storage::Full).unwrap();
    problem.set_null_space(0, 2, 1, &[1.0; 2], 2, Modes::Exact).unwrap();
    let own = problem.fixing_dofs(0).unwrap().to_vec();
    problem.set_fixing(0, Some(&[1 - own[0]])).unwrap();
    assert_eq!(problem.fixing_dofs(0).unwrap(), [1 - own[0]]);
    problem.set_fixing(0, None).unwrap();
    assert_eq!(problem.fixing_dofs(0).unwrap(), own);
}

/// The values alone, in the order in which the matrix was given; those of before cost nothing.
#[test]
fn values_on_their_own_cost_a_factorisation_and_the_same_values_nothing() {
    let (deck, changed) = (deck(), new_values(&deck()));
    let mut problem = hand_over::problem(&deck).unwrap();
    let mut before = [0; 4];
    spent(&mut problem, &mut before);
    problem.set_values(0, &changed.bodies[0].stiffness.val).unwrap();
    assert_eq!(spent(&mut problem, &mut before)[..2], [0, 1]);
    let found = answer(&problem);
    let mut fresh = hand_over::problem(&deck).unwrap();
    hand_over::set_body(&mut fresh, 0, &changed.bodies[0]).unwrap();
    spent(&mut fresh, &mut [0; 4]);
    assert_near(&found[1], &answer(&fresh)[1], 1e-8, "forces");
    problem.set_values(0, &changed.bodies[0].stiffness.val).unwrap();
    assert_eq!(spent(&mut problem, &mut before)[..3], [0; 3]);
    assert!(answer(&problem) == found, "bits differ");
}

#[test]
fn values_that_are_refused_leave_the_matrix_and_its_factors() {
    let deck = deck();
    let mut problem = hand_over::problem(&deck).unwrap();
    let mut before = [0; 4];
    spent(&mut problem, &mut before);
    let found = answer(&problem);
    let mut val = deck.bodies[0].stiffness.val.clone();
    assert_eq!(problem.set_values(0, &val[1..]).unwrap_err().kind, Kind::Argument("nnz"));
    val[5] = f64::INFINITY;
    let error = problem.set_values(0, &val).unwrap_err();
    assert_eq!((error.kind, error.place.body, error.place.entry), (Kind::Argument("val"), Some(0), Some(5)));
    assert_eq!(problem.set_values(2, &val).unwrap_err().kind, Kind::Argument("body"));
    assert_eq!(spent(&mut problem, &mut before), [0; 4]);
    assert!(answer(&problem) == found, "bits differ");
    let negative: Vec<f64> = deck.bodies[0].stiffness.val.iter().map(|v| -v).collect();
    problem.set_values(0, &negative).unwrap();
    let error = problem.solve().unwrap_err();
    assert_eq!((error.kind, error.place.body, error.place.dof), (Kind::Indefinite, Some(0), Some(0)));
    problem.set_values(0, &deck.bodies[0].stiffness.val).unwrap();
    spent(&mut problem, &mut before);
    assert!(answer(&problem) == found, "bits differ after values that the setup refused");
}

#[test]
fn values_come_in_the_form_of_the_matrix_or_not_at_all() {
    let mut problem = Problem::new();
    problem.add_body(2).unwrap();
    let none = problem.set_values(0, &[1.0]).unwrap_err();
    assert!(none.kind == Kind::State && none.what.contains("feti_body_stiffness"), "{none}");
    assert_eq!(problem.set_values_dense(0, 2, &[1.0; 4], 2).unwrap_err().kind, Kind::State);
    let k = |s: f64| [2.0 * s, 9.0, s, 2.0 * s];
    problem.set_stiffness_dense(0, 2, &k(1.0), 2, Storage::Upper).unwrap();
    let dense = problem.set_values(0, &[1.0]).unwrap_err();
    assert!(dense.kind == Kind::State && dense.what.contains("feti_body_values_dense"), "{dense}");
    problem.set_null_space(0, 2, 0, &[], 2, Modes::Exact).unwrap();
    problem.set_load(0, &[3.0, 3.0]).unwrap();
    let mut before = [0; 4];
    assert_eq!(spent(&mut problem, &mut before)[..2], [1, 1]);
    problem.set_values_dense(0, 2, &k(2.0), 2).unwrap();
    assert_eq!(spent(&mut problem, &mut before)[..2], [0, 1]);
    // [4 2; 2 4] u = (3, 3)
    assert_near(problem.displacement(0).unwrap(), &[0.5, 0.5], 1e-12, "displacements");
    let sparse = decks::Csr::from_dense(2, &[2.0, 1.0, 1.0, 2.0]);
    let col: Vec<i64> = sparse.col.iter().map(|&j| j as i64).collect();
    let input = SparseInput { ptr: &sparse.ptr, col: &col, val: &sparse.val, storage: Storage::Full };
    problem.set_stiffness(0, input).unwrap();
    let rows = problem.set_values_dense(0, 2, &k(1.0), 2).unwrap_err();
    assert!(rows.kind == Kind::State && rows.what.ends_with("feti_body_values"), "{rows}");
}
