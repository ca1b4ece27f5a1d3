//! A driven block on another, joined as by mortar by weighted averages of three gaps: more rows than gaps, dependent but for the
//! normals, which differ by the rounding of the host. As in the last steps of a Newton method loads and forces nearly cancel. The
//! problems are made from displacements and forces.

use decks::random::Random;
use decks::{Block, Deck};
use feti_contact::solver::{Modes, Outcome, Problem};

use crate::soft::random::Dense;
use crate::soft::{add_diagonal, given};
use crate::support::asked::seeds;

/// Problems of the ordinary run.
const PROBLEMS: u64 = 150;
/// Elements of a block.
const ELEMENTS: [usize; 3] = [2, 2, 1];
/// What errors of forces that the certificate allows may displace, with E = 1 and forces of 1.
const NEAR: f64 = 1e-3;

/// A problem, and the displacements and forces from which it is made.
struct Made {
    deck: Deck,
    u: Vec<f64>,
    lambda: Vec<f64>,
}

/// Weights of the gaps in the rows; some rows are copies.
fn weights(random: &mut Random, rows: usize) -> Vec<[f64; 3]> {
    let mut weights = Vec::<[f64; 3]>::new();
    for k in 0..rows {
        if k > 0 && random.chance(0.3) {
            weights.push(weights[random.below(k)]);
            continue;
        }
        let mut row = [0.0; 3].map(|_| random.between(-0.25, 0.15));
        row[random.below(3)] += 1.0;
        weights.push(row);
    }
    weights
}

fn made(seed: u64) -> Made {
    let mut random = Random::new(seed);
    let block = |y: f64| Block {
        dimension: 2,
        elements: ELEMENTS,
        size: [3.8, 4.0, 1.0],
        origin: [0.0, y, 0.0],
        ..Block::default()
    };
    let [nx, ny, _] = ELEMENTS;
    let node = |x: usize, y: usize| 2 * (y * (nx + 1) + x);
    let (below, mut above) = (block(0.0).part(|at| at[1] == 0), block(4.0).floating().body);
    let largest = above.stiffness.diagonal().into_iter().fold(0.0, f64::max);
    let drive = random.decades(-9.0, -5.0) * largest;
    (0..=nx).for_each(|x| add_diagonal(&mut above, node(x, 0), -drive * random.between(0.5, 1.0)));
    let (first, held) = (below.body.dofs(), below.body.dofs() + node(0, ny));
    let feet = [0, 1, 2].map(|x| (first + node(x, 0), below.number[node(x, ny)].unwrap()));
    let mut deck = Deck::new(format!("averaged {seed}"), vec![below.body, above]);
    deck.equalities.push(&[(held, 1.0)], 0.0);

    let size = random.decades(-8.0, -3.0);
    let mut u = random.normals(deck.dofs(), size);
    u[held] = 0.0;
    for p in 0..2 {
        let (start, body) = (deck.offset(p), &mut deck.bodies[p]);
        for i in 0..body.dofs() {
            body.load[i] = body.stiffness.row(i).map(|(j, v)| v * u[start + j]).sum();
        }
    }
    let (turned, rows) = (random.decades(-9.0, -6.0), 4 + random.below(5));
    let mut lambda = Vec::new();
    for row in weights(&mut random, rows) {
        let (aside, force) = (turned * random.between(-1.0, 1.0), random.between(0.1, 1.0));
        let of = |(&(own, other), w): (&(usize, usize), f64)| {
            [(own + 1, -w), (own, w * aside), (other + 1, w), (other, -w * aside)]
        };
        let entries: Vec<(usize, f64)> = feet.iter().zip(row).flat_map(of).collect();
        for &(j, v) in &entries {
            let (p, j) = if j < first { (0, j) } else { (1, j - first) };
            deck.bodies[p].load[j] += v * force;
        }
        deck.contact.push(&entries, entries.iter().map(|(j, v)| v * u[*j]).sum());
        lambda.push(force);
    }
    Made { deck, u, lambda }
}

/// How the problem ended if not with the answer; none if that is no minimum.
fn end(Made { deck, u, lambda }: &Made) -> Option<Result<(), String>> {
    let mut problem = given(deck, Modes::Soft);
    let all: Vec<usize> = (0..lambda.len()).collect();
    let passes = problem.check(u, lambda, &[0.0]).unwrap().worst() <= 1.0;
    if !passes || !Dense::of(deck).is_definite(&all) {
        return None;
    }
    Some(match problem.solve() {
        Err(error) => Err(error.to_string()),
        Ok(report) if report.outcome != Outcome::Solved => Err(format!("{:?}", report.outcome)),
        Ok(_) => {
            let found = problem.displacements().unwrap().iter().zip(u);
            let error = found.map(|(found, u)| (found - u).abs()).fold(0.0, f64::max);
            (error <= NEAR).then_some(()).ok_or(format!("error {error:.1e}"))
        }
    })
}

#[test]
fn rows_that_nearly_depend_on_each_other_hold_a_driven_block() {
    let (mut judged, mut lines) = (0, Vec::new());
    for seed in seeds(PROBLEMS) {
        let Some(end) = end(&made(seed)) else { continue };
        judged += 1;
        lines.extend(end.err().map(|what| format!("{seed}: {what}")));
    }
    assert!(lines.is_empty() && judged > 0, "{} of {judged}\n{}", lines.len(), lines.join("\n"));
}

/// Where A shows of rows only rounding: the plate between others of CalculiX's deck `plate`, five rows of three gaps in its twelfth
/// increment, and a block of the kind above.
#[test]
fn rows_that_depend_on_each_other_beyond_the_rounding_of_products_are_closed() {
    let mut problem = Problem::new();
    problem.read_file(concat!(env!("CARGO_MANIFEST_DIR"), "/tests/data/plate.feti").as_ref()).unwrap();
    assert_eq!(problem.solve().unwrap().outcome, Outcome::Solved);
    assert_eq!(end(&made(73_540)), Some(Ok(())));
}
