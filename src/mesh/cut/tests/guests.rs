use std::collections::BTreeSet;
use std::sync::atomic::AtomicBool;
use std::sync::Arc;

use super::meshes::Mesh;
use crate::error::Kind;
use crate::mesh::{cut, pieces_for, Elements};
use crate::platform::interrupt::Interrupt;

#[test]
fn springs_go_with_an_element_that_has_their_unknowns() {
    let cube = Mesh::cube(12);
    let mut mesh = cube.clone();
    let nodes: Vec<u32> = (0..13_u32.pow(3)).step_by(7).collect();
    // springs to the ground
    for &n in &nodes {
        mesh = mesh.with(&[n]);
    }
    // springs to a further unknown each, then springs on an edge of one element
    let new = 13_u32.pow(3);
    for (k, &n) in nodes.iter().enumerate() {
        mesh = mesh.with(&[n, new + k as u32]);
    }
    mesh = mesh.with(&[0, 1]).with(&[0, 1]);
    for with_centres in [true, false] {
        let piece = mesh.cut(27, with_centres);
        assert_eq!(piece[..cube.nodes.len()], cube.cut(27, with_centres));
        for (e, nodes) in mesh.nodes.iter().enumerate().skip(cube.nodes.len()) {
            let has = |f: &usize| cube.nodes[*f].contains(&nodes[0]) && piece[*f] == piece[e];
            assert!((0..cube.nodes.len()).any(|f| has(&f)), "element {e}");
        }
    }
}

#[test]
fn a_spring_between_two_bodies_goes_with_one_of_its_ends_and_joins_no_pieces() {
    let mut mesh = Mesh::bricks([9, 4, 4], |c| c[0] != 4, |x| x);
    let count = mesh.nodes.len();
    for node in 0..25 {
        mesh = mesh.with(&[10 * node + 4, 10 * node + 5]);
    }
    for with_centres in [true, false] {
        let piece = mesh.cut(2, with_centres);
        for (e, nodes) in mesh.nodes.iter().enumerate() {
            let side = |node: u32| u32::from(node % 10 > 4);
            let sides = if e < count { [side(nodes[0]); 2] } else { [0, 1] };
            assert!(sides.map(|s| s ^ piece[0]).contains(&piece[e]), "element {e}");
        }
    }
}

#[test]
fn elements_that_lie_on_each_other_are_cut_as_one() {
    let cube = Mesh::cube(8);
    let mut twice = cube.clone();
    twice.nodes.extend(cube.nodes.clone());
    twice.centres.extend(cube.centres.clone());
    let piece = twice.cut(8, true);
    assert_eq!(piece[..512], piece[512..]);
    assert_eq!(piece[..512], cube.cut(8, true));
}

#[test]
fn a_node_of_very_many_elements_does_not_join_them() {
    let cube = Mesh::cube(12);
    let mut mesh = cube.clone();
    // an unknown of the whole mesh, as in generalised plane strain
    mesh.nodes.iter_mut().for_each(|nodes| nodes.push(13_u32.pow(3)));
    for with_centres in [true, false] {
        let quality = cube.quality(&mesh.cut(27, with_centres));
        assert!(quality.apart == 0 && quality.largest < 1.1, "{quality:?}");
    }
}

#[test]
fn held_unknowns_leave_pieces_whole() {
    let mut mesh = Mesh::cube(12);
    mesh.held = (0..13 * 13).collect();
    for with_centres in [true, false] {
        let quality = mesh.quality(&mesh.cut(27, with_centres));
        assert!(quality.pieces == 27 && quality.apart == 0, "{quality:?}");
    }
}

#[test]
fn elements_without_unknowns_may_lie_anywhere() {
    let mut mesh = Mesh::cube(6);
    mesh.held = (0..2 * 7 * 7).collect();
    let piece = mesh.cut(4, true);
    assert!(piece.iter().all(|&p| p < 4) && piece[36..].iter().collect::<BTreeSet<_>>().len() == 4);
    mesh.held = (0..7 * 7 * 7).collect();
    assert!(mesh.cut(4, true).iter().all(|&p| p == 0));
    assert!(Mesh::default().cut(4, true).is_empty());
}

#[test]
fn there_are_no_more_pieces_than_elements_and_one_leaves_the_body_whole() {
    let mesh = Mesh::bricks([3, 2, 1], |_| true, |x| x);
    for with_centres in [true, false] {
        let pieces: BTreeSet<u32> = mesh.cut(100, with_centres).into_iter().collect();
        assert_eq!(pieces, (0..6).collect());
        let bar = Mesh::bricks([5, 1, 1], |_| true, |x| x).cut(5, with_centres);
        assert_eq!(bar.into_iter().collect::<BTreeSet<_>>(), (0..5).collect());
        assert_eq!(mesh.cut(1, with_centres), [0; 6]);
        assert_eq!(mesh.cut(0, with_centres), [0; 6]);
    }
}

#[test]
fn centres_that_say_nothing_are_done_without() {
    let mut mesh = Mesh::cube(8);
    let without = mesh.cut(8, false);
    mesh.centres[17][1] = f64::NAN;
    assert_eq!(mesh.cut(8, true), without);
    mesh.centres.iter_mut().for_each(|x| *x = [1.0, -3.0, 0.5]);
    assert_eq!(mesh.cut(8, true), without);
}

#[test]
fn what_is_no_mesh_is_refused() {
    let refused = |ptr: &[usize], dof: &[u32], centres: usize| {
        let centres = vec![[0.0; 3]; centres];
        cut(&Elements { ptr, dof, unknowns: 3 }, Some(&centres), 2).unwrap_err().kind
    };
    for ptr in [&[0, 2, 1, 3][..], &[1, 3], &[0, 2], &[]] {
        assert_eq!(refused(ptr, &[0, 1, 2], 1), Kind::Argument("elements"));
    }
    assert_eq!(refused(&[0, 3], &[0, 1, 3], 1), Kind::Argument("elements"));
    assert_eq!(refused(&[0, 3], &[0, 1, 2], 2), Kind::Argument("centres"));
}

#[test]
fn a_cut_ends_when_the_call_has_to() {
    let interrupt = Interrupt::new(Arc::new(AtomicBool::new(true)));
    let (ptr, dof, unknowns) = Mesh::cube(4).arrays();
    let ended = interrupt.during(|| cut(&Elements { ptr: &ptr, dof: &dof, unknowns }, None, 8));
    assert_eq!(ended.unwrap_err().kind, Kind::Cancelled);
}

#[test]
fn small_bodies_stay_whole() {
    assert_eq!([(39_999, 0), (119_999, 3)].map(|(unknowns, solves)| pieces_for(unknowns, solves)), [1, 1]);
    assert_eq!([40_000, 300_000].map(|unknowns| pieces_for(unknowns, 1)), [27, 216]);
    assert_eq!(pieces_for(300_000, 7), 216);
}
