//! `feti-contact show` names what is spoilt in a file, and is silent on healthy ones.

use crate::support::{alone, folder, healthy, said, Row, Scene};

/// A name, the change, and what a line of the program says: the place, a part of the text.
pub type Spoilt = (&'static str, fn(&mut Scene), &'static str, &'static str);

pub const SPOILT: [Spoilt; 25] = [
    ("stiffness in Pa", |s| scaled(s, 1, 1e6), "bodies 0 and 1", "1e6 times stiffer"),
    (
        "coordinates in mm",
        |s| s.bodies[1].xyz.iter_mut().flatten().for_each(|x| *x *= 1e3),
        "bodies 0 and 1",
        "of body 0 apart",
    ),
    (
        "6 digits",
        |s| s.bodies[0].k.iter_mut().for_each(|e| e.2 = format!("{:.5e}", e.2).parse().unwrap()),
        "body 0",
        "digits",
    ),
    (
        "single precision",
        |s| s.bodies[1].k.iter_mut().for_each(|e| e.2 = f64::from(e.2 as f32)),
        "body 1",
        "single precision",
    ),
    (
        "a motion is missing",
        |s| drop(s.bodies[1].motions.as_mut().unwrap().pop()),
        "body 1",
        "FETI_NULL_SPACE",
    ),
    (
        "a motion is wrong",
        |s| s.bodies[0].motions.as_mut().unwrap()[2][5] += 0.5,
        "body 0",
        "FETI_NULL_SPACE",
    ),
    (
        "all normals reversed",
        |s| (0..7).for_each(|i| reversed(s, i)),
        "contact row 0, 1, 2 and 4 more",
        "other sign",
    ),
    ("one normal reversed", |s| reversed(s, 3), "contact row 3", "points elsewhere"),
    ("a row twice", |s| s.contact.push(s.contact[2].clone()), "contact row 7", "row 2 given twice"),
    ("a tiny row", |s| longer(s, 4, 1e-6), "contact row 4", "times those of the other rows"),
    ("a huge row", |s| longer(s, 4, 1e6), "contact row 4", "times those of the other rows"),
    ("a loose unknown", loose, "body 1", "no stiffness, no row and no load"),
    ("a load that nothing holds", unheld, "body 2", "FETI_LOAD_NOT_HELD"),
    (
        "negative gaps",
        |s| s.contact.iter_mut().for_each(|row| row.rhs *= -1.0),
        "bodies 0, 1",
        "gaps between them are negative",
    ),
    ("the face is missing", |s| s.contact[3].entries.truncate(1), "contact row 3", "touches body 1 alone"),
    ("nearly parallel", nearly, "contact row 7", "nearly parallel to row 5"),
    ("friction in per cent", |s| s.friction[2].1 = 30.0, "node 2", "coefficient of friction of 30"),
    ("a normal of length 1.5", |s| longer(s, 2, 1.5), "contact row 2", "no unit vector"),
    (
        "weights sum to 0.9",
        |s| s.contact[5].entries[1..].iter_mut().for_each(|e| e.2 *= 0.9),
        "contact row 5",
        "do not sum to 0",
    ),
    ("a negative element", negative, "body 1", "FETI_INDEFINITE"),
    (
        "gaps of infinity",
        |s| s.contact.iter_mut().for_each(|row| row.rhs = f64::INFINITY),
        "bodies 0, 1",
        "all gaps between them are +infinity",
    ),
    (
        "x for y",
        |s| s.contact[4].entries.iter_mut().for_each(|e| e.1 -= 1),
        "contact row 4",
        "points elsewhere",
    ),
    ("directions swapped", directions, "body 1", "coordinates"),
    ("a body without rows", |s| s.bodies.push(alone()), "body 2", "no row touches it"),
    ("rows that contradict", contradicting, "equality row 3, 22", "contradict"),
];

fn scaled(s: &mut Scene, p: usize, by: f64) {
    s.bodies[p].k.iter_mut().for_each(|e| e.2 *= by);
}

fn longer(s: &mut Scene, row: usize, by: f64) {
    s.contact[row].entries.iter_mut().for_each(|e| e.2 *= by);
    s.contact[row].rhs *= by;
}

fn reversed(s: &mut Scene, row: usize) {
    s.contact[row].entries.iter_mut().for_each(|e| e.2 *= -1.0);
}

fn loose(s: &mut Scene) {
    let body = &mut s.bodies[1];
    body.n += 1;
    body.motions.iter_mut().flatten().for_each(|motion| motion.push(0.0));
    body.load.push(0.0);
    body.xyz.push([2.0, 2.0, 0.0]);
    body.dir.push(3);
}

fn unheld(s: &mut Scene) {
    let mut body = alone();
    body.load[0] = 1.0;
    s.bodies.push(body);
    s.contact.push(Row { entries: vec![(2, 1, -1.0)], rhs: 1.0 });
}

fn nearly(s: &mut Scene) {
    let mut row = s.contact[5].clone();
    row.entries[0].2 *= 1.0 + 1e-8;
    s.contact.push(row);
}

/// The first element, with 36 entries in its lower triangle.
fn negative(s: &mut Scene) {
    s.bodies[1].k[..36].iter_mut().for_each(|e| e.2 *= -1.0);
}

fn directions(s: &mut Scene) {
    s.bodies[1].motions = None;
    s.bodies[1].dir[6..8].reverse();
}

fn contradicting(s: &mut Scene) {
    let mut row = s.equality[3].clone();
    row.rhs = 0.1;
    s.equality.push(row);
}

#[test]
fn what_is_spoilt_in_a_file_is_named_with_its_place_and_a_remedy() {
    let folder = folder("spoilt");
    let mut wrong = Vec::new();
    for (name, spoil, place, what) in SPOILT {
        let (mut scene, path) = (healthy(), folder.join(name));
        spoil(&mut scene);
        scene.write(&path);
        let (out, err, status) = said(&["show", path.to_str().unwrap()]);
        let is_named = |line: &str| line.trim_start().starts_with(place) && line.contains(what);
        let named = out
            .lines()
            .zip(out.lines().skip(1))
            .any(|(line, next)| is_named(line) && next.contains("remedy: "));
        if !named || status != 1 || !err.is_empty() {
            wrong.push(format!(
                "{name}: status {status} {err}\n{}",
                out.split_once("\nsuspicious").map_or("nothing", |of| of.1)
            ));
        }
    }
    assert!(wrong.is_empty(), "{}", wrong.join("\n"));
    std::fs::remove_dir_all(folder).unwrap();
}

#[test]
fn the_healthy_file_is_not_suspicious_with_motions_or_coordinates_alone() {
    let folder = folder("healthy");
    for (name, given) in [("motions", true), ("coordinates", false)] {
        let (mut scene, path) = (healthy(), folder.join(name));
        scene.bodies.iter_mut().filter(|_| !given).for_each(|body| body.motions = None);
        scene.write(&path);
        let (out, _, status) = said(&["show", path.to_str().unwrap()]);
        assert!(status == 0 && out.ends_with("nothing suspicious\n"), "{out}");
        assert!(out.contains("\noptions: defaults\n"), "the limit of show is no option of the file: {out}");
    }
    std::fs::remove_dir_all(folder).unwrap();
}
