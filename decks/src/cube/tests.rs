//! Claims about the decomposed body.

use crate::vector::{dot, norm_max};
use crate::{Cube, Deck, Glue, Moduli};

fn plane() -> Cube {
    Cube { dimension: 2, subdomains: [3, 2, 9], elements: 3, ..Cube::default() }
}

/// (subdomain nodes, nodes of the whole body) on a grid of the given subdomains along each axis.
fn node_counts(cube: &Cube, axes: std::ops::Range<usize>) -> (usize, usize) {
    let n = cube.elements;
    let each = |axis: usize| (cube.subdomains[axis] * (n + 1), cube.subdomains[axis] * n + 1);
    axes.map(each).fold((1, 1), |(a, b), (c, d)| (a * c, b * d))
}

/// Values at all dofs of a field that is continuous over the whole body.
fn continuous(deck: &Deck, field: impl Fn(&[f64; 3], usize) -> f64) -> Vec<f64> {
    let positions = deck.bodies.iter().flat_map(|body| &body.coordinates);
    let directions = deck.bodies.iter().flat_map(|body| &body.direction);
    positions.zip(directions).map(|(x, &d)| field(x, d as usize - 1)).collect()
}

/// Gluing rows: d per copy beyond the first, off the clamped face; clamp rows: d per copy on it.
#[test]
fn nonredundant_gluing_has_entries_of_one_and_rows_by_formula() {
    for cube in [Cube::default(), plane()] {
        let d = cube.dimension;
        let deck = cube.build();
        let (copies, nodes) = node_counts(&cube, 0..d);
        let (face_copies, face_nodes) = node_counts(&cube, 1..d);
        let glued = d * ((copies - nodes) - (face_copies - face_nodes));
        assert_eq!(deck.equalities.len(), glued + d * face_copies);
        assert!(deck.equalities.matrix.val.iter().all(|value| value.abs() == 1.0));
        for row in 0..glued {
            let sum: f64 = deck.equalities.matrix.row(row).map(|entry| entry.1).sum();
            assert_eq!((deck.equalities.matrix.row(row).count(), sum), (2, 0.0));
        }
        assert_eq!(deck.dofs(), d * copies);
    }
}

#[test]
fn contact_rows_are_the_free_nodes_on_the_obstacle() {
    assert_eq!(plane().build().contact.len(), 9);
    assert_eq!(Cube::default().build().contact.len(), 4 * 5);
    let floating = Cube { clamp: false, ..Cube::default() };
    assert_eq!(floating.build().contact.len(), 5 * 5);
}

#[test]
fn continuous_fields_satisfy_every_gluing_row() {
    for glue in [Glue::NonRedundant, Glue::Orthonormal, Glue::Redundant] {
        let deck = Cube { glue, clamp: false, ..Cube::default() }.build();
        let field = continuous(&deck, |x, axis| (axis as f64 + 1.0) * x[0] * x[1] - x[2]);
        assert!(norm_max(&deck.equalities.matrix.times(&field)) < 1e-13);
    }
}

/// Eight copies in the middle: 28 differences instead of 7; orthonormal rows have a unit Gram matrix.
#[test]
fn redundant_and_orthonormal_gluing_differ_as_told() {
    let build = |glue: Glue| Cube { glue, elements: 1, clamp: false, ..Cube::default() }.build().equalities;
    let pairs = |k: usize| k * (k - 1) / 2;
    assert_eq!(build(Glue::Redundant).len(), 3 * (pairs(8) + 6 * pairs(4) + 12 * pairs(2)));
    assert_eq!(build(Glue::Orthonormal).len(), 3 * (7 + 6 * 3 + 12));
    let matrix = build(Glue::Orthonormal).matrix;
    for i in 0..matrix.rows {
        let mut unit = vec![0.0; matrix.rows];
        unit[i] = 1.0;
        let mut gram = matrix.times(&matrix.transpose_times(&unit));
        gram[i] -= 1.0;
        assert!(norm_max(&gram) < 1e-15);
    }
}

#[test]
fn gluing_the_clamped_nodes_as_well_adds_dependent_rows() {
    let cube = plane();
    let extra = Cube { glue_clamped: true, ..plane() }.build().equalities.len();
    let (face_copies, face_nodes) = node_counts(&cube, 1..2);
    assert_eq!(extra - cube.build().equalities.len(), 2 * (face_copies - face_nodes));
}

/// On 15 edges of 1/5 the nodes 3 to 12 lie within 0.3 of the length from the middle: ten shares of 1/5.
#[test]
fn pressure_and_weight_add_up_over_the_subdomains() {
    let weight = Cube { weight: 0.5, pressure: 0.0, ..Cube::default() }.build();
    let down = continuous(&weight, |_, axis| f64::from(axis == 2));
    assert!((dot(&down, &weight.load()) + 0.5 * 8.0).abs() < 1e-13);
    let pressed = Cube { elements: 5, ..plane() };
    let deck = pressed.build();
    let down = continuous(&deck, |_, axis| f64::from(axis == 1));
    let middle = 10.0 / 5.0;
    assert!((dot(&down, &deck.load()) + pressed.pressure * middle).abs() < 1e-14);
}

#[test]
fn normals_are_unit_vectors_into_the_obstacle() {
    let deck = Cube { waves: 0.4, noise: 0.2, ..Cube::default() }.build();
    let down = continuous(&deck, |_, axis| f64::from(axis == 2));
    assert!(deck.contact.matrix.times(&down).iter().all(|&component| component < 0.0));
    for row in 0..deck.contact.len() {
        let square: f64 = deck.contact.matrix.row(row).map(|entry| entry.1 * entry.1).sum();
        assert!((square - 1.0).abs() < 1e-14);
    }
}

#[test]
fn all_closed_gives_every_row_the_same_small_penetration() {
    let deck = Cube { all_closed: true, ..Cube::default() }.build();
    assert!(deck.contact.rhs.iter().all(|&gap| gap == -2e-5));
}

#[test]
fn moduli_scale_the_stiffness_of_their_subdomains() {
    let contrast = |moduli: Moduli| -> Vec<f64> {
        let deck = Cube { moduli, elements: 1, ..plane() }.build();
        let first = deck.bodies[0].stiffness.get(0, 0);
        let ratio = deck.bodies.iter().map(|body| body.stiffness.get(0, 0) / first);
        ratio.map(|value| (value * 1e6).round() / 1e6).collect()
    };
    assert_eq!(contrast(Moduli::Checkerboard(1e3)), [1.0, 1e3, 1.0, 1e3, 1.0, 1e3]);
    assert_eq!(contrast(Moduli::Layers(1e3)), [1.0, 1.0, 1.0, 1e3, 1e3, 1e3]);
    let given = vec![1.0, 2.0, 3.0, 4.0, 5.0, 6.0];
    assert_eq!(contrast(Moduli::Given(given.clone())), given);
}
