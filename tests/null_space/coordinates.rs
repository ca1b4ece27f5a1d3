//! Coordinates are hints: where they are not those of K its null space is sought in K.

use decks::{Block, Csr};
use feti_contact::error::Kind;
use feti_contact::solver::{LogLevel, Modes, Origin, Problem};

use crate::null_space::bodies::{chain, cube};
use crate::null_space::digits::{in_single_precision, printed, quads};
use crate::null_space::{lines, registered, warnings};

/// The body with the coordinates of its nodes, moved from where they are.
fn placed(k: &Csr, block: &Block, moved: impl Fn(usize, usize) -> f64) -> Problem {
    let mut problem = registered(k);
    let (dimension, nodes) = (block.dimension, block.nodes());
    let step: Vec<f64> = (0..dimension).map(|k| block.size[k] / block.elements[k] as f64).collect();
    let place = |node: usize, k: usize| block.grid(node)[k] as f64 * step[k] + moved(node, k);
    let dofs = || (0..nodes).flat_map(|node| (0..dimension).map(move |k| (node, k)));
    let node: Vec<i32> = dofs().map(|(node, _)| node as i32).collect();
    let directions: Vec<i32> = dofs().map(|(_, k)| k as i32 + 1).collect();
    let xyz: Vec<f64> = dofs()
        .flat_map(|(node, _)| (0..dimension).map(move |k| (node, k)))
        .map(|(node, k)| place(node, k))
        .collect();
    problem.set_coordinates(0, dimension, &node, &directions, &xyz, dimension).unwrap();
    problem
}

#[test]
fn coordinates_that_are_not_quite_those_of_the_stiffness_are_hints() {
    for (block, translations, all) in [(quads(12), 2, 3), (cube(5), 3, 6)] {
        let k = block.stiffness();
        let shaken = |node: usize, k: usize| 0.005 * (7.0 * (3 * node + k) as f64).sin();
        let mut problem = placed(&k, &block, shaken);
        let told = warnings(&mut problem);
        let facts = problem.body_facts(0).unwrap();
        assert_eq!((facts.origin, facts.factors.unwrap().null_space), (Origin::Found, all));
        let expected = format!("body 0: {translations} of {all} rigid motions of these coordinates fit K");
        assert!(told.len() == 1 && told[0].contains(&expected), "{told:?}");
        let mut right = placed(&k, &block, |_, _| 0.0);
        assert_eq!(warnings(&mut right), Vec::<String>::new());
        assert_eq!(right.body_facts(0).unwrap().origin, Origin::Coordinates);
    }
}

#[test]
fn a_stiffness_of_few_digits_has_the_rigid_motions_of_its_coordinates() {
    for (block, all) in [(quads(40), 3), (cube(6), 6)] {
        let k = block.stiffness();
        let few = (7..=15).map(|digits| printed(&k, digits)).chain([in_single_precision(&k)]);
        for (k, digits) in few.zip((7..=15).chain([0])) {
            let mut problem = placed(&k, &block, |_, _| 0.0);
            problem.setup().unwrap_or_else(|e| panic!("{e}"));
            let facts = problem.body_facts(0).unwrap();
            let found = facts.factors.unwrap();
            assert_eq!(found.null_space, all, "{digits} digits");
        }
    }
}

#[test]
fn each_of_many_parts_has_the_rigid_motions_of_its_coordinates() {
    let (block, parts) = (quads(2), 200);
    let one = block.stiffness();
    let mut problem = registered(&chain(&vec![&one; parts], 0, &vec![1.0; parts]));
    let n = parts * one.rows;
    let place = |i: usize, k: usize| block.grid(i % one.rows / 2)[k] as f64 / 2.0;
    let xyz: Vec<f64> = (0..n).flat_map(|i| [place(i, 0), place(i, 1)]).collect();
    let node: Vec<i32> = (0..n).map(|i| i as i32 / 2).collect();
    let directions: Vec<i32> = (0..n).map(|i| i as i32 % 2 + 1).collect();
    problem.set_coordinates(0, 2, &node, &directions, &xyz, 2).unwrap();
    let (dimension, basis) = problem.null_space(0).unwrap();
    assert_eq!(dimension, 3 * parts);
    assert!(basis.chunks_exact(n).all(|r| r.iter().filter(|v| **v != 0.0).count() <= one.rows));
    assert_eq!(problem.body_facts(0).unwrap().origin, Origin::Coordinates);
}

/// A body on its supports resists its rigid motions: that is no fault of the coordinates.
#[test]
fn coordinates_of_a_body_on_supports_are_not_doubted() {
    let block = quads(8);
    let k = block.stiffness();
    for digits in [9, 12, 17] {
        let mut k = printed(&k, digits);
        for dof in 0..18 {
            let at = k.ptr[dof] + k.col[k.ptr[dof]..k.ptr[dof + 1]].partition_point(|&j| j < dof);
            k.val[at] *= 2.0;
        }
        let mut problem = placed(&k, &block, |_, _| 0.0);
        assert_eq!(warnings(&mut problem), Vec::<String>::new());
        let facts = problem.body_facts(0).unwrap();
        assert_eq!((facts.origin, facts.factors.unwrap().null_space), (Origin::Coordinates, 0));
    }
}

/// Nodes in one place rotate about nothing: of three motions two are left, and both fit.
#[test]
fn a_motion_that_coordinates_lack_is_found_and_reported() {
    let block = quads(12);
    let step: Vec<f64> = (0..2).map(|k| block.size[k] / block.elements[k] as f64).collect();
    let mut problem = placed(&block.stiffness(), &block, |node, k| -(block.grid(node)[k] as f64 * step[k]));
    let told = lines(&mut problem, LogLevel::Result);
    assert_eq!(origin_and_motions(&problem), (Origin::Found, 3));
    let expected = "body 0: the 2 rigid motions of these coordinates fit K, which has others, as of a hinge";
    assert!(told.len() == 1 && told[0].starts_with(expected), "{told:?}");
}

fn origin_and_motions(problem: &Problem) -> (Origin, usize) {
    let facts = problem.body_facts(0).unwrap();
    (facts.origin, facts.factors.unwrap().null_space)
}

/// Two blocks that share one node, at any size and place.
#[test]
fn the_motion_of_a_hinge_is_found_beside_those_of_the_coordinates() {
    for (elements, edge) in [(1, 1.0), (1, 1e-3), (1, 123.456), (4, 1.0), (7, 1e3)] {
        let block = Block { dimension: 2, elements: [elements; 3], size: [edge; 3], ..Block::default() };
        let k = block.stiffness();
        let (n, shared) = (k.rows, 2);
        let mut problem = registered(&chain(&[&k, &k], shared, &[1.0, 1.0]));
        let step = edge / elements as f64;
        let place = |i: usize, k: usize| {
            let (node, by) = if i < n { (i / 2, 0) } else { ((i + shared - n) / 2, elements) };
            (block.grid(node)[k] + by) as f64 * step
        };
        let all = 2 * n - shared;
        let xyz: Vec<f64> = (0..all).flat_map(|i| [place(i, 0), place(i, 1)]).collect();
        let node: Vec<i32> = (0..all).map(|i| i as i32 / 2).collect();
        let directions: Vec<i32> = (0..all).map(|i| i as i32 % 2 + 1).collect();
        problem.set_coordinates(0, 2, &node, &directions, &xyz, 2).unwrap();
        assert_eq!(warnings(&mut problem), Vec::<String>::new());
        assert_eq!(origin_and_motions(&problem), (Origin::Found, 4), "{elements} elements, edge {edge}");
    }
}

/// A coefficient that was dropped resists the rotation: the motions that float are counted, and the other is named.
#[test]
fn a_motion_that_a_wrong_coefficient_holds_is_reported() {
    let block = quads(6);
    let mut k = block.stiffness();
    let (i, j) = (40, 38);
    for (i, j) in [(i, j), (j, i)] {
        let at = k.ptr[i] + k.col[k.ptr[i]..k.ptr[i + 1]].partition_point(|&c| c < j);
        k.val[at] *= 1.0 - 1e-3;
    }
    let mut problem = placed(&k, &block, |_, _| 0.0);
    let told = lines(&mut problem, LogLevel::Phase);
    let (_, motions) = origin_and_motions(&problem);
    assert!(motions < 3);
    let expected = format!("body 0: {motions} of 3 rigid motions float, {} held by K", 3 - motions);
    assert!(told.iter().any(|line| line.starts_with(&expected)), "{told:?}");
    // a body that floats as a whole is refused at an unknown of this coefficient, and accepted without the fault
    problem.set_coordinate_modes(0, Modes::Exact).unwrap();
    let error = problem.setup().unwrap_err();
    assert_eq!((error.kind, error.place.body), (Kind::NullSpace, Some(0)));
    assert!(error.place.dof == Some(i) || error.place.dof == Some(j), "{error}");
    let mut right = placed(&block.stiffness(), &block, |_, _| 0.0);
    right.set_coordinate_modes(0, Modes::Exact).unwrap();
    assert_eq!((warnings(&mut right), origin_and_motions(&right)), (vec![], (Origin::Coordinates, 3)));
}

/// With so few digits the rounding must explain every entry of K R.
#[test]
fn a_stiffness_of_three_to_six_digits_has_the_rigid_motions_of_its_coordinates_and_a_warning() {
    for (block, all) in [(quads(4), 3), (cube(2), 6)] {
        for digits in 3..=6 {
            let k = printed(&block.stiffness(), digits);
            let mut problem = placed(&k, &block, |_, _| 0.0);
            let told = warnings(&mut problem);
            assert_eq!(origin_and_motions(&problem), (Origin::Coordinates, all), "{digits} digits");
            assert!(told.len() == 1 && told[0].contains(&format!("{digits} digits")), "{told:?}");
        }
    }
}
