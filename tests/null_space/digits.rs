//! Stiffnesses that arrive with fewer digits than double precision: printed, or kept in single precision.

use decks::varied::rounded_to;
use decks::{Block, Csr};
use feti_contact::error::Kind;
use feti_contact::solver::{Digits, Doubt};

use crate::null_space::bodies::{assembled, bar, chain, cube, held, membrane};
use crate::null_space::{assert_dimension, left_over, registered, warnings};

pub fn printed(k: &Csr, digits: usize) -> Csr {
    let round = |v: &f64| rounded_to(*v, digits);
    Csr { val: k.val.iter().map(round).collect(), ..k.clone() }
}

pub fn in_single_precision(k: &Csr) -> Csr {
    Csr { val: k.val.iter().map(|v| f64::from(*v as f32)).collect(), ..k.clone() }
}

pub fn quads(n: usize) -> Block {
    Block { dimension: 2, elements: [n, n, 1], young: 2.1e5, ..Block::default() }
}

/// The same with springs at some dofs, each of this part of what is there already.
fn on_springs(k: &Csr, part: f64, dofs: impl Fn(usize) -> bool) -> Csr {
    let mut k = k.clone();
    for i in (0..k.rows).filter(|i| dofs(*i)) {
        let at = k.ptr[i] + k.col[k.ptr[i]..k.ptr[i + 1]].partition_point(|&j| j < i);
        k.val[at] *= 1.0 + part;
    }
    k
}

/// Dimension of the null space, what is in doubt, and the warnings told.
fn set_up(k: &Csr) -> (usize, Vec<Doubt>, Vec<String>) {
    let mut problem = registered(k);
    let told = warnings(&mut problem);
    let factors = problem.body_facts(0).unwrap().factors.unwrap();
    (factors.null_space, factors.doubts, told)
}

#[test]
fn the_null_space_of_a_solid_printed_with_14_digits_is_found() {
    let block = bar([25, 15, 15], [25.0, 15.0, 15.0], 0.3);
    let k = block.stiffness();
    for digits in [13, 14, 15] {
        let found = assert_dimension("solid", &printed(&k, digits), 6);
        let left = left_over(&k, &found, &block.rigid_modes());
        assert!(left < 1e-7, "{digits} digits: {left:.1e} of a rigid motion is missing");
    }
}

#[test]
fn the_null_space_of_plane_quads_is_found_with_10_to_15_digits() {
    let block = quads(60);
    let k = block.stiffness();
    for digits in 10..=15 {
        let found = assert_dimension("quads", &printed(&k, digits), 3);
        let left = left_over(&k, &found, &block.rigid_modes());
        assert!(left < 1e-4, "{digits} digits: {left:.1e} of a rigid motion is missing");
    }
}

#[test]
fn motions_softer_than_the_rounding_of_few_digits_are_free_by_their_gap_or_told_as_supports() {
    for (name, block, dimension) in [("quads", quads(40), 3), ("cube", cube(8), 6), ("strip", strip(), 3)] {
        let k = block.stiffness();
        let few = (7..=9).map(|digits| printed(&k, digits)).chain([in_single_precision(&k)]);
        for (k, digits) in few.zip([7, 8, 9, 0]) {
            let (found, doubts, told) = match registered(&k).setup() {
                Err(error) => {
                    assert_eq!(error.kind, Kind::NullSpace, "{name}: {error}");
                    continue;
                }
                Ok(()) => set_up(&k),
            };
            assert!(found == dimension || found == 0, "{name}, {digits} digits: {found}");
            assert!(found == dimension || !doubts.is_empty(), "{name}, {digits} digits: in silence");
            assert_eq!(told.len(), doubts.len());
            let number = if digits == 0 { Digits::Single } else { Digits::Decimal(digits) };
            assert!(doubts.iter().all(|doubt| doubt.digits == number && doubt.free == (found > 0)));
        }
    }
}

/// Rounding to so few digits resists the motions, or drives them: it is never passed over in silence.
#[test]
fn a_stiffness_of_three_to_six_digits_is_told() {
    for (name, block, dimension) in [("quads", quads(4), 3), ("quads", quads(6), 3), ("cube", cube(2), 6)] {
        for turn in 0..10 {
            let k = block.stiffness();
            let k = Csr { val: k.val.iter().map(|v| v * (1.0 + 0.0717 * f64::from(turn))).collect(), ..k };
            for digits in 3..=6 {
                let k = printed(&k, digits);
                match registered(&k).setup() {
                    Err(error) => {
                        assert!(error.what.contains(&format!("{digits} digits")), "{name}: {error}")
                    }
                    Ok(()) => {
                        let (found, doubts, told) = set_up(&k);
                        assert!(found == dimension || found == 0, "{name}, {digits} digits: {found}");
                        assert!(
                            found == dimension || !doubts.is_empty() && !told.is_empty(),
                            "{name}, {turn}, {digits} digits: {found} in silence"
                        );
                    }
                }
            }
        }
    }
}

/// 100 : 1
fn strip() -> Block {
    Block { dimension: 2, elements: [200, 2, 1], size: [200.0, 2.0, 1.0], ..Block::default() }
}

#[test]
fn soft_springs_in_a_stiffness_of_all_digits_hold_soft_motions_without_a_word() {
    for part in [1e-6, 1e-8] {
        for (motions, k) in [
            (3, on_springs(&quads(20).stiffness(), part, |i| i % 43 < 2)),
            (6, on_springs(&cube(5).stiffness(), part, |i| i % 37 < 3)),
        ] {
            assert_eq!(set_up(&k), (motions, vec![], vec![]));
        }
    }
}

/// Stiffnesses of few digits because they are exact: springs of 1, of eight digits, at one dof or at all.
#[test]
fn soft_springs_in_an_exact_stiffness_of_few_digits_hold_soft_motions() {
    let chain_of = |spring: &dyn Fn(usize) -> f64| {
        let element = Csr::from_dense(2, &[1.0, -1.0, -1.0, 1.0]);
        let factors: Vec<f64> = (0..99).map(spring).collect();
        chain(&[&element; 99], 1, &factors)
    };
    let tidy = Csr { val: membrane(20).val.iter().map(|v| (6.0 * v).round()).collect(), ..membrane(20) };
    let add = |k: &Csr, spring: f64, dofs: &dyn Fn(usize) -> bool| {
        let mut k = k.clone();
        for i in (0..k.rows).filter(|i| dofs(*i)) {
            let at = k.ptr[i] + k.col[k.ptr[i]..k.ptr[i + 1]].partition_point(|&j| j < i);
            k.val[at] += spring;
        }
        k
    };
    for (name, k) in [
        ("ones", add(&chain_of(&|_| 1.0), 1e-8, &|i| i == 0)),
        ("ones, all on springs", add(&chain_of(&|_| 1.0), 1e-8, &|_| true)),
        ("tidy", add(&tidy, 2e-7, &|i| i == 5)),
        ("tidy, all on springs", add(&tidy, 2e-7, &|_| true)),
        ("eight digits", add(&chain_of(&|i| 1e7 + (7_654_321 * i % 89_999_999) as f64), 1.0, &|i| i == 0)),
    ] {
        let (found, doubts, _) = set_up(&k);
        assert_eq!((found, doubts), (1, vec![]), "{name}");
    }
}

/// Springs that are stiffer than all rounding of nine digits can be, at the corners alone, and a pad of 1e-6.
#[test]
fn supports_that_rounding_cannot_explain_are_supports() {
    let k = printed(&on_springs(&cube(6).stiffness(), 1e-3, |i| i < 12), 9);
    assert_eq!(set_up(&k).0, 0, "springs");
    let (block, pad) = (bar([6, 6, 6], [1.0; 3], 0.3), bar([6, 6, 1], [1.0, 1.0, 0.2], 0.3));
    let pad = held(&pad, |at, _| at[2] == 0);
    let k = printed(&chain(&[&pad, &block.stiffness()], 3 * 49, &[1e-6, 1.0]), 9);
    assert_eq!(set_up(&k).0, 0, "pad");
}

#[test]
fn an_indefinite_matrix_of_two_dofs_is_refused_with_dof_and_pivot() {
    for k in [[1.0, 2.0, 2.0, 1.0], [1.0, 1.5, 1.5, 1.0], [4.0, 8.0, 8.0, 4.0]] {
        let error = registered(&Csr::from_dense(2, &k)).setup().unwrap_err();
        assert_eq!(error.kind, Kind::Indefinite, "{error}");
        assert!(error.place.dof.is_some() && error.place.value.unwrap() < 0.0, "{error}");
    }
}

/// Vectors that are made orthogonal part by part are 0 on all other parts.
#[test]
fn each_of_many_floating_parts_has_its_motions() {
    let one = quads(2).stiffness();
    for parts in [10, 200] {
        let k = chain(&vec![&one; parts], 0, &vec![1.0; parts]);
        let found = assert_dimension("parts", &k, 3 * parts);
        assert!(found
            .basis
            .chunks_exact(k.rows)
            .all(|r| r.iter().filter(|v| **v != 0.0).count() <= one.rows));
    }
}

/// Rows of one element that sum to 0 with all their digits say nothing of its rotation, which rounding drives.
#[test]
fn rounding_that_drives_a_motion_is_no_indefinite_stiffness_though_rows_sum_to_zero() {
    let mut driven = 0;
    for (block, dimension) in [(quads(1), 3), (cube(1), 6)] {
        let k = block.stiffness();
        for turn in 0..400 {
            let scaled: Vec<f64> = k.val.iter().map(|v| v * (1.0 + 0.0217 * f64::from(turn))).collect();
            for digits in [8, 9] {
                let k = printed(&Csr { val: scaled.clone(), ..k.clone() }, digits);
                let (found, doubts, _) = set_up(&k);
                assert_eq!(found, dimension, "{turn}, {digits} digits");
                driven += usize::from(rows_sum_to_zero(&k) && !doubts.is_empty());
            }
        }
    }
    assert!(driven > 5, "{driven}");
}

fn rows_sum_to_zero(k: &Csr) -> bool {
    let still = |i: usize| {
        let (sum, size) =
            k.row(i).fold((0.0, 0.0), |(sum, size): (f64, f64), (_, v)| (sum + v, size + v.abs()));
        sum.abs() <= 1e-15 * size
    };
    (0..k.rows).all(still)
}

/// A node that one bar ties to a block of 162 unknowns, of which 24 are eliminated last: what rounding leaves of its swing is a
/// negative pivot at every other angle.
#[test]
fn a_swing_that_rounding_drives_is_a_motion_and_no_indefinite_stiffness() {
    let block = quads(8);
    let k = block.stiffness();
    for turn in 0..100 {
        let (sin, cos) = (0.1 + 0.0137 * f64::from(turn)).sin_cos();
        let t = [-cos, -sin, cos, sin];
        let bar = Csr::from_dense(4, &t.iter().flat_map(|a| t.map(|b| 1e5 * a * b)).collect::<Vec<_>>());
        let n = k.rows;
        let around = (0..n).map(|i| if i < 74 { i } else { i + 2 }).collect();
        let parts = [(&k, 1.0, around), (&bar, 1.0, vec![40, 41, 74, 75])];
        for digits in [8, 9, 17] {
            let k = printed(&assembled(n + 2, &parts), digits);
            let (found, ..) = set_up(&k);
            assert_eq!(found, 4, "{turn}, {digits} digits");
        }
    }
}
