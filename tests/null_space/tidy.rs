//! Stiffnesses of round numbers: they have few digits because they are exact.

use decks::Csr;

use crate::null_space::bodies::chain;
use crate::null_space::digits::printed;
use crate::null_space::{registered, warnings};

/// 4 x 4 stiffness of an Euler beam of length h: deflection and slope at either end.
fn element(bending: f64, h: f64) -> Csr {
    let k = [12.0, 6.0 * h, 4.0 * h * h, 2.0 * h * h].map(|v| bending / (h * h * h) * v);
    let [a, b, c, d] = k;
    Csr::from_dense(4, &[a, b, -a, b, b, c, -b, d, -a, -b, a, -b, b, d, -b, c])
}

pub fn beam(elements: usize, bending: f64, h: f64) -> Csr {
    chain(&vec![&element(bending, h); elements], 2, &vec![1.0; elements])
}

/// A portal of three members in the plane: three unknowns a node, members along the axes.
fn portal(elements: usize, [axial, bending]: [f64; 2], h: f64) -> Csr {
    let bent = element(bending, h);
    let nodes = 3 * elements + 1;
    let mut sum = decks::sparse::Triplets::new(3 * nodes, 3 * nodes);
    for e in 0..3 * elements {
        // along x in the middle, along y in the columns
        let (along, across, sign) = if e / elements == 1 { (0, 1, 1.0) } else { (1, 0, -1.0) };
        let sign = if e / elements == 2 { -sign } else { sign };
        let of = |end: usize, dof: usize| 3 * (e + end) + dof;
        for (i, j) in [(0, 0), (0, 1), (1, 0), (1, 1)] {
            sum.add(of(i, along), of(j, along), if i == j { axial / h } else { -axial / h });
        }
        let dofs = [(of(0, across), sign), (of(0, 2), 1.0), (of(1, across), sign), (of(1, 2), 1.0)];
        for (i, &(a, s)) in dofs.iter().enumerate() {
            bent.row(i).for_each(|(j, v)| sum.add(a, dofs[j].0, s * dofs[j].1 * v));
        }
    }
    sum.to_csr()
}

fn found(k: &Csr) -> (usize, Vec<String>) {
    let mut problem = registered(k);
    let told = warnings(&mut problem);
    (problem.body_facts(0).unwrap().factors.unwrap().null_space, told)
}

#[test]
fn a_floating_beam_of_round_numbers_has_two_motions_and_no_warning() {
    for bending in [1e8, 4.2e7, 2.1e8, 2.1e11 * 8.333e-6, 123_456_789.0, 1e8 / 3.0] {
        for h in [0.25, 0.5, 1.0, 1.25, 2.0] {
            for elements in [10, 20, 50, 100, 200, 500, 800, 1000] {
                let (motions, told) = found(&beam(elements, bending, h));
                assert_eq!((motions, told), (2, vec![]), "{elements} elements of {h}, EI = {bending:e}");
            }
        }
    }
}

#[test]
fn a_floating_portal_of_round_numbers_has_three_motions_and_no_warning() {
    for values in [[2.1e9, 1e8], [2.1e9, 2.1e11 * 8.333e-6], [4.2e8, 4.2e7]] {
        for h in [0.25, 1.0, 2.0] {
            for elements in [4, 10, 50, 200] {
                let (motions, told) = found(&portal(elements, values, h));
                assert_eq!((motions, told), (3, vec![]), "{elements} elements of {h}, {values:?}");
            }
        }
    }
}

/// Rounding that resists the motions of a beam is still seen: its motions are found, or it is refused or told.
#[test]
fn a_beam_that_was_printed_with_few_digits_is_not_taken_as_exact() {
    for elements in [4, 10, 30, 100] {
        for turn in 0..40 {
            let exact = beam(elements, 1e7 * (1.0 + 0.0217 * f64::from(turn)), 0.7310585);
            for digits in 7..=9 {
                let k = printed(&exact, digits);
                match registered(&k).setup() {
                    Err(error) => assert!(error.what.contains("digits"), "{error}"),
                    Ok(()) => {
                        let (motions, told) = found(&k);
                        assert!(
                            motions == 2 || !told.is_empty(),
                            "{elements} elements, {digits} digits: {motions}"
                        );
                    }
                }
            }
        }
    }
}
