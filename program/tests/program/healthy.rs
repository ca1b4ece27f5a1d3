//! `show` is silent on problems that are as their authors meant them: the reference cases, and decks with coordinates.

use std::fs;
use std::io::Read;
use std::path::Path;

use decks::{masonry, rubbing, Blocks, Cube, Deck, Glue, Moduli, Stack};
use flate2::read::GzDecoder;

use crate::hand_over;
use crate::support::{folder, said};

fn cube(side: usize, dimension: usize) -> Cube {
    Cube { subdomains: [side; 3], elements: 4, dimension, ..Cube::default() }
}

/// Decks whose rows, gaps and materials are those of a model that a user would make.
fn decks() -> Vec<Deck> {
    let stack = Stack { in_plane: vec![8, 6], layers: vec![4, 3], ..Stack::default() };
    let three = Stack { bodies: 3, in_plane: vec![8, 6, 7], layers: vec![4, 3, 3], ..stack.clone() };
    vec![
        cube(2, 3).build(),
        cube(4, 2).build(),
        Cube { layer: 0.25, ..cube(2, 3) }.build(),
        Cube { clamp: false, waves: 0.3, ..cube(2, 3) }.build(),
        Cube { moduli: Moduli::Checkerboard(1e3), ..cube(3, 2) }.build(),
        Cube { glue: Glue::Redundant, ..cube(3, 2) }.build(),
        stack.build(),
        Stack { hold: true, ..stack.clone() }.build(),
        Stack { moduli: vec![210_000.0, 70_000.0], ..stack.clone() }.build(),
        Stack { flat: true, ..stack.clone() }.build(),
        Stack { noise: 0.1, ..stack }.build(),
        three.build(),
        masonry::tower(6),
        masonry::chain(6),
        masonry::wall(4, 0.0),
        masonry::wall(4, 1e-4),
        rubbing::cube(&cube(2, 3), 0.3, 1.0),
        rubbing::blocks(&Blocks::default(), 0.3, 0.3),
    ]
}

#[test]
fn decks_with_coordinates_are_not_suspicious() {
    let folder = folder("decks");
    let mut told = String::new();
    for (k, deck) in decks().iter().enumerate() {
        let (mut problem, file) = (hand_over::problem(deck).unwrap(), folder.join(k.to_string()));
        for (p, body) in deck.bodies.iter().enumerate() {
            let xyz = body.coordinates.concat();
            problem.set_coordinates(p, 3, &body.node, &body.direction, &xyz, 3).unwrap();
        }
        problem.write_file(&file).unwrap();
        let (out, err, status) = said(&["show", file.to_str().unwrap()]);
        if status != 0 {
            told += &format!(
                "{}: {status}{err}{}\n",
                deck.name,
                out.split_once("\nsuspicious").map_or("", |of| of.1)
            );
        }
    }
    assert!(told.is_empty(), "{told}");
    fs::remove_dir_all(folder).unwrap();
}

#[test]
fn the_ten_reference_cases_are_not_suspicious_and_their_answers_pass() {
    let (folder, data) = (folder("reference"), Path::new(env!("CARGO_MANIFEST_DIR")).join("../tests/data"));
    let mut cases = 0;
    for case in fs::read_dir(data).unwrap().map(|entry| entry.unwrap().path()).filter(|path| path.is_dir()) {
        let own = folder.join(case.file_name().unwrap());
        fs::create_dir(&own).unwrap();
        for file in fs::read_dir(&case).unwrap().map(|entry| entry.unwrap().path()) {
            if file.extension().is_some_and(|ending| ending == "gz") {
                let mut text = String::new();
                GzDecoder::new(fs::File::open(&file).unwrap()).read_to_string(&mut text).unwrap();
                fs::write(own.join(file.file_stem().unwrap()), text).unwrap();
            }
        }
        for (command, says) in [("show", "\nnothing suspicious\n"), ("check", "\nthe answer passes")] {
            let (out, err, status) = said(&[command, own.to_str().unwrap()]);
            assert!(status == 0 && out.contains(says), "{case:?}: {status} {err}{out}");
        }
        cases += 1;
    }
    assert_eq!(cases, 10);
    fs::remove_dir_all(folder).unwrap();
}
