//! The upper block cut by hand into pieces that equality rows glue: u is that of the block in one piece. |u|_D does not
//! change, for the diagonals of the pieces add up to that of the block.

use decks::{Block, Blocks, Deck};

use crate::scales::free::{blocks, held, inner, least, SEED};
use crate::scales::{difference, energy, largest, problem, solved, Claims};

const ELEMENTS: usize = 8;

/// A deck cut, and the unknown of the whole deck that each of its unknowns is a copy of.
struct Cut {
    deck: Deck,
    whole: Vec<usize>,
}

/// Piece (i, j) of `pieces` along x and y, with the grid position of its first node.
fn piece(block: &Block, pieces: [usize; 2], place: [usize; 2]) -> (Block, [usize; 2]) {
    let [nx, ny, nz] = block.elements;
    let (own, first) =
        ([nx / pieces[0], ny / pieces[1]], [0, 1].map(|a| place[a] * block.elements[a] / pieces[a]));
    let mut factors = Vec::with_capacity(own[0] * own[1] * nz);
    for (k, j) in (0..nz).flat_map(|k| (0..own[1]).map(move |j| (k, j))) {
        let row = first[0] + nx * (first[1] + j + ny * k);
        factors.extend_from_slice(&block.factors[row..row + own[0]]);
    }
    let [x, y, z] = block.position([first[0], first[1], 0]);
    let size = [block.size[0] / pieces[0] as f64, block.size[1] / pieces[1] as f64, block.size[2]];
    let piece = Block { elements: [own[0], own[1], nz], size, origin: [x, y, z], factors, ..block.clone() };
    (piece, first)
}

/// The varied blocks with the upper one cut: load and contact rows stay with the first copy of a node, and every other copy
/// is glued to it.
fn cut(variation: f64, pieces: [usize; 2]) -> Cut {
    let uncut = blocks(ELEMENTS, variation, SEED);
    let [_, upper] = Blocks { elements: ELEMENTS, young: 1.0 }.varied_blocks(variation, SEED);
    let offset = uncut.offset(1);
    let (mut bodies, mut whole) = (vec![uncut.bodies[0].clone()], (0..offset).collect::<Vec<_>>());
    for (i, j) in (0..pieces[0]).flat_map(|i| (0..pieces[1]).map(move |j| (i, j))) {
        let (block, first) = piece(&upper, pieces, [i, j]);
        bodies.push(block.floating().body);
        let number = |at: [usize; 3]| upper.node([at[0] + first[0], at[1] + first[1], at[2]]);
        whole.extend(
            block.grids().flat_map(|at| (0..3).map(move |a| 3 * number(at) + a)).map(|dof| offset + dof),
        );
    }
    let mut copies = vec![None; uncut.dofs()];
    let mut deck = Deck::new("cut", bodies);
    for (dof, &of) in whole.iter().enumerate() {
        match copies[of] {
            None => copies[of] = Some(dof),
            Some(first) => deck.equalities.push(&[(first, 1.0), (dof, -1.0)], 0.0),
        }
    }
    for row in 0..uncut.contact.len() {
        let entries: Vec<_> =
            uncut.contact.matrix.row(row).map(|(dof, b)| (copies[dof].unwrap(), b)).collect();
        deck.contact.push(&entries, uncut.contact.rhs[row]);
    }
    let (load, bounds) = (uncut.load(), (0..=deck.bodies.len()).map(|p| deck.offset(p)).collect::<Vec<_>>());
    for (p, body) in deck.bodies.iter_mut().enumerate() {
        for (i, f) in body.load.iter_mut().enumerate() {
            let dof = bounds[p] + i;
            *f = if copies[whole[dof]] == Some(dof) { load[whole[dof]] } else { 0.0 };
        }
    }
    Cut { deck, whole }
}

fn assert_same_cut(pieces: [usize; 2]) {
    let mut claims = Claims::default();
    for v in [0.0, 1e-9, 1e-6, 1e-3] {
        let (uncut, Cut { deck, whole }, what) =
            (blocks(ELEMENTS, v, SEED), cut(v, pieces), format!("V = {v:e}"));
        let reference = solved(&mut problem(&held(&uncut)));
        let lies = least(&uncut, &reference.u);
        let expected: Vec<f64> = whole.iter().map(|&of| lies[of]).collect();
        if let Some(found) = claims.solved(&mut problem(&deck), &what) {
            claims.claim(found.report.undetermined == 3, || {
                format!("{what}: {} motions are undetermined, not 3", found.report.undetermined)
            });
            claims.at_most(difference(&found.u, &expected), 1e-8, &format!("{what}, u"));
            claims.at_most(largest(&found.u), 1.0, &format!("{what}, lengths of slide"));
            claims.at_most(difference(&found.lambda, &reference.lambda), 1e-8, &format!("{what}, forces"));
            let scale = reference.report.energy;
            let off = (energy(&deck, &found.u) - scale) / scale;
            claims.at_most(off.abs(), 1e-10, &format!("{what}, energy"));
        }
    }
    claims.end();
}

#[test]
fn a_free_block_cut_into_two_pieces_lies_where_it_lies_uncut() {
    assert_same_cut([2, 1]);
}

#[test]
fn a_free_block_cut_into_four_pieces_lies_where_it_lies_uncut() {
    assert_same_cut([2, 2]);
}

/// The cut itself: the same energy and |u|_D for displacements that its rows hold together, and the same load.
#[test]
fn pieces_add_up_to_the_block() {
    let (uncut, Cut { deck, whole }) = (blocks(ELEMENTS, 0.5, SEED), cut(0.5, [2, 2]));
    let u: Vec<f64> = (0..uncut.dofs()).map(|i| (i as f64).sin()).collect();
    let copied: Vec<f64> = whole.iter().map(|&of| u[of]).collect();
    assert!(deck.equalities.matrix.times(&copied).iter().all(|jump| *jump == 0.0));
    assert_eq!(deck.contact.matrix.times(&copied), uncut.contact.matrix.times(&u));
    assert!((energy(&deck, &copied) / energy(&uncut, &u) - 1.0).abs() < 1e-12);
    let size = |deck: &Deck, u: &[f64]| {
        let metric: Vec<f64> = deck.bodies.iter().flat_map(|body| body.stiffness.diagonal()).collect();
        inner(&metric, u, u)
    };
    assert!((size(&deck, &copied) / size(&uncut, &u) - 1.0).abs() < 1e-12);
}
