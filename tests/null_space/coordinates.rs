//! Coordinates are hints: where they are not those of K its null space is sought in K.

use decks::{Block, Csr};
use feti_contact::solver::{LogLevel, Origin, Problem};
use std::sync::{Arc, Mutex};

use crate::bodies::cube;
use crate::digits::{in_single_precision, printed, quads};
use crate::registered;

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

fn warnings(problem: &mut Problem) -> Vec<String> {
    let lines = Arc::new(Mutex::new(Vec::new()));
    let book = Arc::clone(&lines);
    let listener = move |_, text: &str| {
        book.lock().unwrap().push(text.to_owned());
        0
    };
    problem.on_log(Some((LogLevel::Result, Box::new(listener))));
    problem.setup().unwrap_or_else(|e| panic!("{e}"));
    let lines = lines.lock().unwrap();
    lines.iter().filter(|line| line.contains("warning")).cloned().collect()
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
            let told = warnings(&mut problem);
            let facts = problem.body_facts(0).unwrap();
            let found = facts.factors.unwrap();
            println!("{digits} digits: {:?} {} {:?} {told:?}", facts.origin, found.null_space, found.doubts);
            assert_eq!(found.null_space, all, "{digits} digits");
        }
    }
}
