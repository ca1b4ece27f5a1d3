//! Equal bodies, and matrices with equal patterns: found by hash keys and confirmed entry by entry.

use std::ops::Range;

use crate::body::null_space::NullSpaceInput;
use crate::body::rigid_modes::Coordinates;
use crate::body::Body;
use crate::linalg::hash::{hash, same_bits, START};
use crate::linalg::Symmetric;

pub fn same_pattern(a: &Symmetric, b: &Symmetric) -> bool {
    a.ptr == b.ptr && a.col == b.col
}

/// Whether both bodies have the same K+ and the same null space.
pub fn same_body(a: &Body, b: &Body) -> bool {
    alike(a, b, 0..3, |k, l| same_input(a, b) && same_matrix(k, l))
}

/// Whether both bodies have the same matrix.
pub fn same_matrix_of(a: &Body, b: &Body) -> bool {
    alike(a, b, 0..2, same_matrix)
}

/// Whether the matrices of both bodies have the same pattern.
pub fn same_pattern_of(a: &Body, b: &Body) -> bool {
    alike(a, b, 0..1, same_pattern)
}

/// Whether matrices are the same; of a body on another rank by these of its keys.
fn alike(a: &Body, b: &Body, of: Range<usize>, same: impl Fn(&Symmetric, &Symmetric) -> bool) -> bool {
    if let (Some(k), Some(l)) = (&a.stiffness, &b.stiffness) {
        return same(k, l);
    }
    a.order == b.order && a.keys().zip(b.keys()).is_some_and(|(a, b)| a[of.clone()] == b[of])
}

pub fn same_matrix(a: &Symmetric, b: &Symmetric) -> bool {
    same_pattern(a, b) && same_bits(&a.val, &b.val)
}

/// Whether the input for both bodies is equal, apart from matrix and load.
fn same_input(a: &Body, b: &Body) -> bool {
    a.fixing == b.fixing
        && a.coordinate_modes == b.coordinate_modes
        && same_option(a.null_space.as_deref(), b.null_space.as_deref(), same_vectors)
        && same_option(a.coordinates.as_deref(), b.coordinates.as_deref(), Coordinates::same)
}

fn same_option<T>(a: Option<&T>, b: Option<&T>, same: fn(&T, &T) -> bool) -> bool {
    match (a, b) {
        (Some(a), Some(b)) => same(a, b),
        (None, None) => true,
        _ => false,
    }
}

pub fn same_vectors(a: &NullSpaceInput, b: &NullSpaceInput) -> bool {
    a.modes == b.modes && a.vectors.rows == b.vectors.rows && same_bits(&a.vectors.data, &b.vectors.data)
}

/// Hash key of the pattern: equal for equal patterns, rarely equal for different ones.
pub fn pattern_key(k: &Symmetric) -> u64 {
    let words = k.ptr.iter().map(|&at| at as u64).chain(k.col.iter().map(|&col| u64::from(col)));
    hash(START, words)
}

/// Hash key of the values, without the pattern.
pub fn value_key(k: &Symmetric) -> u64 {
    hash(START, k.val.iter().map(|v| v.to_bits()))
}

/// Hash key of the input that [`same_body`] compares besides the matrix, from a sample of its numbers: equal meshes at
/// different places have equal matrices but different rigid motions.
pub fn input_key(body: &Body) -> u64 {
    const SOME: usize = 64;
    let some = |key: u64, values: &[f64]| {
        hash(key, values.iter().step_by(values.len() / SOME + 1).map(|v| v.to_bits()))
    };
    let key = body.null_space.as_ref().map_or(START, |given| some(START, &given.vectors.data));
    body.coordinates.as_ref().map_or(key, |given| some(key, given.places().as_flattened()))
}

/// Hash keys of the pattern of K, of its values, and of all other input that [`same_body`] compares.
pub fn keys(k: &Symmetric, body: &Body) -> [u64; 3] {
    [pattern_key(k), value_key(k), whole_input_key(body)]
}

fn whole_input_key(body: &Body) -> u64 {
    let numbers = |key: u64, values: &[f64]| hash(key, values.iter().map(|v| v.to_bits()));
    let words = |key: u64, words: &[u64]| hash(key, words.iter().copied());
    let mut key = words(START, &[body.coordinate_modes as u64]);
    if let Some(given) = &body.null_space {
        key = numbers(words(key, &[1, given.modes as u64, given.vectors.rows as u64]), &given.vectors.data);
    }
    if let Some(given) = &body.coordinates {
        key = given.key(words(key, &[2]));
    }
    match &body.fixing {
        Some(dofs) => hash(words(key, &[3]), dofs.iter().map(|dof| *dof as u64)),
        None => key,
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::body::Modes;
    use crate::linalg::Matrix;

    fn chain(last: f64) -> Symmetric {
        Symmetric::new(vec![0, 1, 3], vec![0, 0, 1], vec![1.0, -1.0, last])
    }

    #[test]
    fn keys_tell_values_and_patterns_apart_and_powers_of_two_among_them() {
        let (one, two) = (chain(1.0), chain(2.0));
        assert_eq!((pattern_key(&one), value_key(&one)), (pattern_key(&chain(1.0)), value_key(&chain(1.0))));
        assert_eq!(pattern_key(&one), pattern_key(&two));
        assert_ne!(value_key(&one), value_key(&two));
        let diagonal = Symmetric::new(vec![0, 1, 2], vec![0, 1], vec![1.0, 1.0]);
        assert_ne!(pattern_key(&one), pattern_key(&diagonal));
    }

    #[test]
    fn what_is_said_about_equal_matrices_has_keys_that_tell_it_apart() {
        let said = |data: Vec<f64>| {
            let vectors = Matrix { rows: data.len(), cols: 1, data };
            let null_space = Some(Box::new(NullSpaceInput { vectors, modes: Modes::Exact }));
            Body { null_space, ..Body::default() }
        };
        let (ones, turned) = (vec![1.0; 500], (0..500).map(f64::from).collect::<Vec<_>>());
        assert_eq!(input_key(&said(ones.clone())), input_key(&said(ones.clone())));
        assert_ne!(input_key(&said(ones.clone())), input_key(&said(turned)));
        assert_ne!(input_key(&said(ones)), input_key(&Body::default()));
    }

    #[test]
    fn equal_coordinates_of_soft_motions_and_of_candidates_say_different_things() {
        let placed = |coordinate_modes: Modes| {
            let coordinates = Some(Box::new(Coordinates::new(1, &[1, 1], &[0.0, 1.0], 1).unwrap()));
            let stiffness = Some(std::sync::Arc::new(chain(1.0)));
            Body { order: 2, stiffness, coordinates, coordinate_modes, ..Body::default() }
        };
        let all = [Modes::Exact, Modes::Candidates, Modes::Soft];
        assert!(all.iter().all(|a| all.iter().all(|b| same_body(&placed(*a), &placed(*b)) == (a == b))));
    }

    #[test]
    fn the_sign_of_a_zero_makes_a_difference() {
        assert!(same_matrix(&chain(1.0), &chain(1.0)) && !same_matrix(&chain(0.0), &chain(-0.0)));
    }
}
