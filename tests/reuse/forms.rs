//! K by its profile or by triplets is K by rows, bit by bit: in answers, in files, in what new values cost.

use std::sync::{Arc, Mutex};

use decks::random::Random;
use decks::{Blocks, Csr, Deck};
use feti_contact::error::{Error, Kind};
use feti_contact::solver::{
    Direction, LogLevel, Modes, Problem, SkylineInput, SparseInput, Storage, TripletInput,
};

use crate::reuse::{answer, assert_near, spent};
use crate::support::hand_over;

#[derive(Debug, Clone, Copy)]
enum Way {
    Rows,
    Profile(Direction, bool),
    Triplets(Storage),
}

const WAYS: [Way; 8] = [
    Way::Rows,
    Way::Profile(Direction::Down, false),
    Way::Profile(Direction::Down, true),
    Way::Profile(Direction::Up, false),
    Way::Profile(Direction::Up, true),
    Way::Triplets(Storage::Lower),
    Way::Triplets(Storage::Upper),
    Way::Triplets(Storage::Full),
];

/// What a host passes; `row` only with triplets.
#[derive(Default)]
struct Arrays {
    ptr: Vec<usize>,
    row: Vec<i64>,
    col: Vec<i64>,
    diag: Vec<f64>,
    val: Vec<f64>,
}

/// The entries (row, column, value) of the lower triangle that are not 0.
fn lower(k: &Csr) -> impl Iterator<Item = (usize, usize, f64)> + '_ {
    let row = |i: usize| k.row(i).filter(move |e| e.0 <= i && e.1 != 0.0).map(move |(j, v)| (i, j, v));
    (0..k.rows).flat_map(row)
}

fn by_rows(k: &Csr) -> Arrays {
    let mut arrays = Arrays { ptr: vec![0], ..Arrays::default() };
    for i in 0..k.rows {
        for (j, v) in k.row(i).filter(|e| e.0 <= i && e.1 != 0.0) {
            arrays.col.push(j as i64);
            arrays.val.push(v);
        }
        arrays.ptr.push(arrays.col.len());
    }
    arrays
}

fn by_profile(k: &Csr, direction: Direction, apart: bool) -> Arrays {
    let mut arrays = Arrays { ptr: vec![0], ..Arrays::default() };
    for i in 0..k.rows {
        let first = k.row(i).find(|e| e.1 != 0.0).map_or(i, |e| e.0.min(i));
        let end = i + usize::from(!apart);
        let mut column: Vec<f64> = (first..end).map(|j| k.get(i, j)).collect();
        if direction == Direction::Up {
            column.reverse();
        }
        arrays.val.extend(column);
        arrays.ptr.push(arrays.val.len());
        arrays.diag.push(k.get(i, i));
    }
    arrays
}

/// Every value in two parts, 2 v and -v, whose sum is exact; in an order that depends on the pattern alone.
fn by_triplets(k: &Csr, storage: Storage) -> Arrays {
    let mut all = Vec::new();
    for (i, j, v) in lower(k) {
        let both = storage == Storage::Full && i != j;
        let (row, col) = if storage == Storage::Upper { (j, i) } else { (i, j) };
        all.extend([(row, col, 2.0 * v), (row, col, -v)]);
        all.extend(both.then_some([(col, row, 2.0 * v), (col, row, -v)]).into_iter().flatten());
    }
    let mut random = Random::new(3);
    (1..all.len()).rev().for_each(|at| all.swap(at, random.below(at + 1)));
    Arrays {
        row: all.iter().map(|e| e.0 as i64).collect(),
        col: all.iter().map(|e| e.1 as i64).collect(),
        val: all.iter().map(|e| e.2).collect(),
        ..Arrays::default()
    }
}

fn arrays(k: &Csr, way: Way) -> Arrays {
    match way {
        Way::Rows => by_rows(k),
        Way::Profile(direction, apart) => by_profile(k, direction, apart),
        Way::Triplets(storage) => by_triplets(k, storage),
    }
}

fn give(problem: &mut Problem, p: usize, k: &Csr, way: Way) -> Result<(), Error> {
    let Arrays { ptr, row, col, diag, val } = &arrays(k, way);
    match way {
        Way::Rows => problem.set_stiffness(p, SparseInput { ptr, col, val, storage: Storage::Lower }),
        Way::Profile(direction, apart) => {
            problem.set_stiffness_skyline(p, apart.then_some(diag), SkylineInput { ptr, val, direction })
        }
        Way::Triplets(storage) => {
            problem.set_stiffness_triplets(p, k.rows, TripletInput { row, col, val, storage })
        }
    }
}

fn give_values(problem: &mut Problem, p: usize, k: &Csr, way: Way) {
    let Arrays { diag, val, .. } = &arrays(k, way);
    match way {
        Way::Profile(_, true) => problem.set_values_split(p, diag, val).unwrap(),
        _ => problem.set_values(p, val).unwrap(),
    }
}

fn given(deck: &Deck, way: Way) -> Problem {
    let mut problem = hand_over::problem(deck).unwrap();
    for (p, body) in deck.bodies.iter().enumerate() {
        give(&mut problem, p, &body.stiffness, way).unwrap();
    }
    problem
}

/// Values between half and one and a half of those of before on the diagonal, rows still dominant.
fn stiffer(deck: &Deck) -> Deck {
    let mut deck = deck.clone();
    for body in &mut deck.bodies {
        body.stiffness.val.iter_mut().for_each(|v| *v *= 1.25);
    }
    deck
}

fn bits(problem: &mut Problem, before: &mut [usize; 4]) -> ([usize; 2], String) {
    let cost = spent(problem, before);
    let certificate = problem.report().unwrap().certificate.entries().map(|entry| entry.figure.to_bits());
    ([cost[0], cost[1]], format!("{:?} {certificate:?}", answer(problem)))
}

#[test]
fn every_form_gives_the_bits_of_rows_and_new_values_take_no_analysis() {
    let deck = Blocks { elements: 4, young: 1.0 }.build();
    let stiffer = stiffer(&deck);
    let mut first: Option<[String; 2]> = None;
    let mut file: Option<Vec<u8>> = None;
    for way in WAYS {
        let (mut problem, mut before) = (given(&deck, way), [0; 4]);
        let bytes = problem.write_bytes().unwrap();
        assert_eq!(file.get_or_insert_with(|| bytes.clone()), &bytes, "{way:?}: another file");
        let (cost, found) = bits(&mut problem, &mut before);
        assert_eq!(cost, [2, 2], "{way:?}");
        (0..2).for_each(|p| give_values(&mut problem, p, &stiffer.bodies[p].stiffness, way));
        let (cost, renewed) = bits(&mut problem, &mut before);
        assert_eq!(cost, [0, 2], "{way:?}: new values");
        let all = [found, renewed];
        assert!(first.get_or_insert_with(|| all.clone()) == &all, "{way:?}: other bits than by rows");
        (0..2).for_each(|p| give_values(&mut problem, p, &stiffer.bodies[p].stiffness, way));
        assert_eq!(bits(&mut problem, &mut before).0, [0, 0], "{way:?}: the same values");
    }
}

/// A chain of springs of 4 unknowns, held at unknown 0; `far` couples unknowns 0 and 3 by a spring.
fn chain(far: f64) -> Csr {
    let mut k = vec![0.0; 16];
    for (i, j, s) in [(0, 1, 1.0), (1, 2, 2.0), (2, 3, 3.0), (0, 3, far)] {
        for (row, col, sign) in [(i, i, 1.0), (j, j, 1.0), (i, j, -1.0), (j, i, -1.0)] {
            k[4 * row + col] += sign * s;
        }
    }
    k[0] += 1.0;
    Csr::from_dense(4, &k)
}

/// The profile of a chain reaches to unknown 0 in its last column.
fn profile(far: f64) -> (Vec<usize>, Vec<f64>) {
    let k = chain(far);
    let last = (0..4).map(|j| k.get(3, j));
    let val = [k.get(0, 0), k.get(0, 1), k.get(1, 1), k.get(1, 2), k.get(2, 2)].into_iter().chain(last);
    (vec![0, 1, 3, 5, 9], val.collect())
}

fn begun() -> Problem {
    let mut problem = Problem::new();
    problem.add_body(4).unwrap();
    problem.set_null_space(0, 4, 0, &[], 4, Modes::Exact).unwrap();
    problem.set_load(0, &[0.0, 0.0, 1.0, 1.0]).unwrap();
    problem
}

#[test]
fn a_zero_of_a_profile_is_no_entry_until_its_value_is_not_zero_which_the_log_tells() {
    let mut problem = begun();
    let lines = Arc::new(Mutex::new(Vec::new()));
    let kept = Arc::clone(&lines);
    let tell = move |_: LogLevel, line: &str| {
        kept.lock().unwrap().push(line.to_owned());
        0
    };
    problem.on_log(Some((LogLevel::Phase, Box::new(tell))));
    let told = || lines.lock().unwrap().drain(..).filter(|line| line.contains("profile of K")).count();
    let (ptr, val) = profile(0.0);
    let k = SkylineInput { ptr: &ptr, val: &val, direction: Direction::Down };
    problem.set_stiffness_skyline(0, None, k).unwrap();
    let mut before = [0; 4];
    assert_eq!(spent(&mut problem, &mut before)[..2], [1, 1]);
    for (far, cost, lines) in [(0.5, [1, 1], 1), (0.75, [0, 1], 0), (0.0, [0, 1], 0), (0.5, [0, 1], 0)] {
        problem.set_values(0, &profile(far).1).unwrap();
        assert_eq!(spent(&mut problem, &mut before)[..2], cost, "{far}");
        assert_eq!(told(), lines, "{far}");
    }
    let mut rows = begun();
    give(&mut rows, 0, &chain(0.5), Way::Rows).unwrap();
    spent(&mut rows, &mut [0; 4]);
    assert!(answer(&problem) == answer(&rows), "other bits than by rows");
}

/// (1e16 + 1) - 1e16 is 0, 1e16 - 1e16 + 1 is 1.
#[test]
fn values_at_one_place_are_added_in_their_order() {
    for (val, sum) in [([1e16, 1.0, -1e16, 4.0], 4.0), ([1e16, -1e16, 1.0, 4.0], 5.0)] {
        let mut problem = Problem::new();
        problem.add_body(1).unwrap();
        problem.set_load(0, &[20.0]).unwrap();
        let k = TripletInput { row: &[0; 4], col: &[0; 4], val: &val, storage: Storage::Full };
        problem.set_stiffness_triplets(0, 1, k).unwrap();
        problem.solve().unwrap();
        assert_near(problem.displacement(0).unwrap(), &[20.0 / sum], 1e-14, "displacements");
    }
}

fn assert_refused(found: Result<(), Error>, argument: &'static str, says: &str) {
    let error = found.unwrap_err();
    assert!(error.kind == Kind::Argument(argument) && error.what.contains(says), "{argument}: {error:?}");
}

#[test]
fn wrong_profiles_are_refused_with_their_column() {
    let mut problem = begun();
    let mut give = |diag: Option<&[f64]>, ptr: &[usize], val: &[f64]| {
        problem.set_stiffness_skyline(0, diag, SkylineInput { ptr, val, direction: Direction::Up })
    };
    assert_refused(give(None, &[0, 1, 2], &[1.0; 2]), "n", "4 unknowns");
    assert_refused(give(None, &[0, 2, 3, 4, 5], &[1.0; 5]), "ptr", "has 2 entries, of which only 1");
    assert_refused(give(None, &[0, 1, 1, 2, 3], &[1.0; 3]), "ptr", "no entry");
    assert_refused(give(Some(&[1.0; 4]), &[0, 0, 2, 2, 2], &[1.0; 2]), "ptr", "only 1");
    assert_refused(give(Some(&[1.0; 3]), &[0; 5], &[]), "n", "4 unknowns");
    assert_refused(give(Some(&[1.0, f64::NAN, 1.0, 1.0]), &[0; 5], &[]), "diag", "finite");
    let error = give(None, &[0, 1, 3, 4, 5], &[1.0, 1.0, f64::INFINITY, 1.0, 1.0]).unwrap_err();
    assert_eq!((error.kind, error.place.dof, error.place.entry), (Kind::Argument("val"), Some(1), Some(2)));
    assert_refused(give(None, &[0, 1, 2, 3, 4], &[1.0; 5]), "val", "has 4 values, not 5");
    give(Some(&[1.0; 4]), &[0; 5], &[]).unwrap();
    problem.set_values_split(0, &[2.0; 4], &[]).unwrap();
    assert_refused(problem.set_values_split(0, &[2.0; 3], &[]), "n", "4 unknowns");
    assert_refused(problem.set_values_split(0, &[2.0; 4], &[1.0]), "nnz", "0 entries");
    let other = problem.set_values(0, &[]).unwrap_err();
    assert!(other.kind == Kind::State && other.what.ends_with("feti_body_values_split"), "{other}");
}

#[test]
fn wrong_triplets_are_refused_with_their_entry() {
    let mut problem = begun();
    let mut give = |row: [i64; 3], col: [i64; 3], val: [f64; 3], storage| {
        let k = TripletInput { row: &row, col: &col, val: &val, storage };
        problem.set_stiffness_triplets(0, 4, k)
    };
    let (at, one) = ([0, 1, 2], [1.0; 3]);
    assert_refused(give([0, -1, 2], at, one, Storage::Full), "row", "outside");
    assert_refused(give(at, [0, 1, 4], one, Storage::Full), "col", "outside");
    assert_refused(give([0, 0, 2], at, one, Storage::Lower), "col", "above the diagonal");
    assert_refused(give(at, [0, 0, 2], one, Storage::Upper), "col", "below the diagonal");
    assert_refused(give(at, at, [1.0, f64::NAN, 1.0], Storage::Full), "val", "finite");
    assert_refused(give([0, 1, 1], [0, 1, 0], one, Storage::Full), "val", "FETI_LOWER");
    let error = give([0; 3], [0; 3], [1.0, f64::MAX, f64::MAX], Storage::Full).unwrap_err();
    assert_eq!((error.kind, error.place.entry), (Kind::Argument("val"), Some(2)));
    give([3, 1, 3], [0, 1, 0], one, Storage::Lower).unwrap();
    assert_refused(problem.set_values(0, &[1.0; 2]), "nnz", "3 entries");
    assert_refused(problem.set_stiffness_triplets(0, 3, none()), "n", "4 unknowns");
    let short = TripletInput { row: &[0], ..none() };
    assert_refused(problem.set_stiffness_triplets(0, 4, short), "nnz", "1 rows, 0 columns");
}

fn none() -> TripletInput<'static> {
    TripletInput { row: &[], col: &[], val: &[], storage: Storage::Lower }
}
