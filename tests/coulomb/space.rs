//! Tiny problems in space against brute force: every combination of states of one or two nodes, the directions of slip by a scan of all
//! angles and Newton's method.

use std::f64::consts::TAU;

use decks::random::Random;
use decks::Deck;
use feti_contact::error::Kind;
use feti_contact::solver::Outcome;

use crate::coulomb::battery::answer;
use crate::coulomb::drawn::{case, Sizes};
use crate::coulomb::enumeration::{distance, eliminated, size, Dual, Ends};
use crate::support::hand_over;

const TINY: Sizes = Sizes { nodes: 2, bodies: 2, many: 4 };
/// Forces, gaps and slips below this part of the largest are none.
const NONE: f64 = 1e-8;
/// Forces of the library are those of an answer to this part of the largest.
const NEAR: f64 = 1e-8;
/// Angles that Newton's method begins with, of one slipping node and of each of two; the supports that forces and motions have there.
const ANGLES: usize = 72;
const ANGLES_OF_TWO: usize = 16;
const WEAK: [f64; 2] = [1e-2, 1e-5];

#[derive(Clone, Copy, Debug, PartialEq)]
enum Along {
    /// There is no tangential force.
    Nothing,
    Sticks,
    Slips,
}

/// A node, or a contact row by itself.
struct Place {
    normal: Option<usize>,
    /// The contact row has an infinite gap.
    never: bool,
    /// First of two tangential rows.
    along: Option<usize>,
    mu: f64,
    bound: f64,
}

/// Whether the contact is closed, and what is along it.
type State = (bool, Along);

struct Search {
    dual: Dual,
    places: Vec<Place>,
}

enum Newton {
    /// Forces and motions, and angles.
    Root(Vec<f64>, Vec<f64>),
    Singular,
    Nowhere,
}

fn starts(count: usize) -> Vec<Vec<f64>> {
    let of = |k: usize, all: usize| (k as f64 + 0.37) * TAU / all as f64;
    match count {
        1 => (0..ANGLES).map(|k| vec![of(k, ANGLES)]).collect(),
        _ => (0..ANGLES_OF_TWO * ANGLES_OF_TWO)
            .map(|k| vec![of(k % ANGLES_OF_TWO, ANGLES_OF_TWO), of(k / ANGLES_OF_TWO, ANGLES_OF_TWO)])
            .collect(),
    }
}

impl Search {
    fn new(deck: &Deck) -> Self {
        let (nodes, contact) = (&deck.friction, deck.contact.len());
        let never = |row: usize| deck.contact.rhs[row] == f64::INFINITY;
        let of_node = |i: usize| Place {
            normal: nodes.normal[i],
            never: nodes.normal[i].is_some_and(never),
            along: Some(contact + 2 * i),
            mu: nodes.coefficient[i],
            bound: nodes.bound[i],
        };
        let mut places: Vec<Place> = (0..nodes.normal.len()).map(of_node).collect();
        for row in (0..contact).filter(|row| !nodes.normal.contains(&Some(*row))) {
            places.push(Place { normal: Some(row), never: never(row), along: None, mu: 0.0, bound: 0.0 });
        }
        Self { dual: Dual::new(deck), places }
    }

    fn choices(place: &Place) -> Vec<State> {
        let mut choices = Vec::new();
        for closed in [false, true] {
            if closed && (place.normal.is_none() || place.never) {
                continue;
            }
            let carries = place.along.is_some() && (place.bound > 0.0 || closed && place.mu > 0.0);
            let along: &[Along] = if carries { &[Along::Sticks, Along::Slips] } else { &[Along::Nothing] };
            choices.extend(along.iter().map(|along| (closed, *along)));
        }
        choices
    }

    /// `F x - d - G'a = 0` and `G x = e`, with the rows that open contacts and nodes without tangential forces have instead; `weak`: of
    /// supports of all motions.
    fn base(&self, states: &[State], weak: f64) -> (Vec<Vec<f64>>, Vec<f64>) {
        let Dual { f, d, g, e, .. } = &self.dual;
        let (m, r) = (d.len(), e.len());
        let (mut a, mut b) = (vec![vec![0.0; m + r]; m + r], [&d[..], e].concat());
        for i in 0..m {
            a[i][..m].copy_from_slice(&f[i]);
            for k in 0..r {
                a[i][m + k] = -g[k][i];
                a[m + k][i] = g[k][i];
            }
        }
        (0..r).for_each(|k| a[m + k][m + k] = weak);
        let mut nothing = |i: usize| {
            a[i].fill(0.0);
            (a[i][i], b[i]) = (1.0, 0.0);
        };
        for (place, &(closed, along)) in self.places.iter().zip(states) {
            place.normal.into_iter().filter(|_| !closed).for_each(&mut nothing);
            if along == Along::Nothing {
                place.along.into_iter().flat_map(|first| [first, first + 1]).for_each(&mut nothing);
            }
        }
        (a, b)
    }

    /// `bound / unit` of row t and what it gains by x_n.
    fn limit(&self, place: &Place, t: usize, closed: bool) -> (f64, f64) {
        let unit = &self.dual.unit;
        let by_normal = place.normal.filter(|_| closed).map_or(0.0, |n| place.mu * unit[n] / unit[t]);
        (place.bound / unit[t], by_normal)
    }

    fn slipping<'a>(&'a self, states: &'a [State]) -> impl Iterator<Item = (&'a Place, usize, bool)> {
        let slips = |(place, &(closed, along)): (&'a Place, &State)| {
            (along == Along::Slips).then(|| (place, place.along.unwrap(), closed))
        };
        self.places.iter().zip(states).filter_map(slips)
    }

    /// Forces and motions, on weak supports, where the angles of the forces of slipping nodes are given.
    fn given_angles(&self, states: &[State], angles: &[f64], weak: f64) -> Option<Vec<f64>> {
        let (mut a, mut b) = self.base(states, weak);
        for ((place, first, closed), angle) in self.slipping(states).zip(angles) {
            for (t, part) in [(first, angle.cos()), (first + 1, angle.sin())] {
                let (bound, by_normal) = self.limit(place, t, closed);
                a[t].fill(0.0);
                (a[t][t], b[t]) = (1.0, part * bound);
                place.normal.into_iter().for_each(|n| a[t][n] -= part * by_normal);
            }
        }
        match eliminated(a, b) {
            Ends::One(x) => Some(x),
            _ => None,
        }
    }

    /// Newton's method for forces, motions and angles at once: a slip across its force is none.
    fn newton(&self, states: &[State], angles: &[f64], start: &[f64]) -> Newton {
        let (linear, right) = self.base(states, 0.0);
        let n = right.len();
        let (mut x, mut angles) = (start.to_vec(), angles.to_vec());
        for _ in 0..50 {
            let order = n + angles.len();
            let mut a = vec![vec![0.0; order]; order];
            let mut b = vec![0.0; order];
            for i in 0..n {
                a[i][..n].copy_from_slice(&linear[i]);
                b[i] = right[i] - linear[i].iter().zip(&x).map(|(a, x)| a * x).sum::<f64>();
            }
            for (k, (place, first, closed)) in self.slipping(states).enumerate() {
                let (sine, cosine) = angles[k].sin_cos();
                let mean = self.mean(first);
                for (t, part, turned) in [(first, cosine, -sine), (first + 1, sine, cosine)] {
                    let (bound, by_normal) = self.limit(place, t, closed);
                    let limit = bound + place.normal.map_or(0.0, |n| by_normal * x[n]);
                    a[t].fill(0.0);
                    a[t][t] = 1.0;
                    place.normal.into_iter().for_each(|n| a[t][n] -= part * by_normal);
                    a[t][n + k] = -turned * limit;
                    b[t] = part * limit - x[t];
                    // slip of this row is minus its line of the linear system
                    let (across, along) = (if t == first { -sine } else { cosine }, part);
                    let by = mean / self.dual.unit[t];
                    let slip = self.dual.gap(&x, t) * -by;
                    (0..n).for_each(|j| a[n + k][j] -= across * by * linear[t][j]);
                    a[n + k][n + k] -= along * slip;
                    b[n + k] -= across * slip;
                }
            }
            let Ends::One(step) = eliminated(a, b) else { return Newton::Singular };
            let largest = size(&step[n..]);
            let by = if largest > 0.7 { 0.7 / largest } else { 1.0 };
            x.iter_mut().zip(&step).for_each(|(x, step)| *x += by * step);
            angles.iter_mut().zip(&step[n..]).for_each(|(angle, step)| *angle += by * step);
            if by == 1.0 && size(&step[..n]) <= 1e-12 * size(&x) && largest <= 1e-12 {
                return Newton::Root(x, angles);
            }
        }
        Newton::Nowhere
    }

    /// Unit of both tangential rows of a node.
    fn mean(&self, first: usize) -> f64 {
        (self.dual.unit[first] * self.dual.unit[first + 1]).sqrt()
    }

    /// Slips of each slipping node across and along its force, times the mean unit of force, so that lengths are those of the dual.
    fn slips(&self, states: &[State], angles: &[f64], x: &[f64]) -> Vec<[f64; 2]> {
        let of = |((_, first, _), angle): ((&Place, usize, bool), &f64)| {
            let [s1, s2] =
                [first, first + 1].map(|t| -self.dual.gap(x, t) * self.mean(first) / self.dual.unit[t]);
            [angle.cos() * s2 - angle.sin() * s1, angle.cos() * s1 + angle.sin() * s2]
        };
        self.slipping(states).zip(angles).map(of).collect()
    }

    /// Forces, motions and angles at which all slips are along their forces, in either sense; and whether some are not isolated.
    fn roots(&self, states: &[State]) -> (Vec<(Vec<f64>, Vec<f64>)>, bool) {
        let count = self.slipping(states).count();
        if count == 0 {
            let (a, b) = self.base(states, 0.0);
            return match eliminated(a, b) {
                Ends::One(x) => (vec![(x, Vec::new())], false),
                Ends::Many => (Vec::new(), true),
                Ends::None => (Vec::new(), false),
            };
        }
        let (mut roots, mut singular) = (Vec::<(Vec<f64>, Vec<f64>)>::new(), false);
        for weak in WEAK {
            for angles in starts(count) {
                let Some(x) = self.given_angles(states, &angles, weak) else {
                    singular = true;
                    continue;
                };
                match self.newton(states, &angles, &x) {
                    Newton::Root(x, angles) => {
                        let near = |a: f64, b: f64| ((a - b) / TAU - ((a - b) / TAU).round()).abs() <= 1e-7;
                        let known = |(_, other): &(Vec<f64>, Vec<f64>)| {
                            other.iter().zip(&angles).all(|(a, b)| near(*a, *b))
                        };
                        if !roots.iter().any(known) {
                            roots.push((x, angles));
                        }
                    }
                    Newton::Singular => singular = true,
                    Newton::Nowhere => {}
                }
            }
        }
        let many = singular && roots.is_empty();
        (roots, many)
    }

    fn meets(&self, states: &[State], angles: &[f64], x: &[f64]) -> bool {
        let Dual { d, unit, .. } = &self.dual;
        let none = NONE * size(&x[..d.len()]).max(size(d));
        let along = self
            .slips(states, angles, x)
            .iter()
            .all(|[across, along]| across.abs() <= none && *along >= -none);
        along
            && self.places.iter().zip(states).all(|(place, &(closed, along))| {
                let normal = match (place.normal, closed) {
                    (Some(n), true) => x[n] >= -none,
                    (Some(n), false) => place.never || self.dual.gap(x, n) >= -none,
                    (None, _) => true,
                };
                let sticks = |first: usize| {
                    let limit =
                        place.bound + place.normal.map_or(0.0, |n| place.mu * unit[n] * x[n].max(0.0));
                    let force = (unit[first] * x[first]).hypot(unit[first + 1] * x[first + 1]);
                    force <= limit + none * unit[first].max(unit[first + 1])
                };
                normal && (along != Along::Sticks || place.along.is_none_or(sticks))
            })
    }

    /// Forces of all answers, and whether there are states with many answers.
    fn answers(&self) -> (Vec<Vec<f64>>, bool) {
        let choices: Vec<Vec<State>> = self.places.iter().map(Self::choices).collect();
        let count: usize = choices.iter().map(Vec::len).product();
        let m = self.dual.d.len();
        let (mut found, mut doubtful): (Vec<Vec<f64>>, bool) = (Vec::new(), false);
        for mut number in 0..count {
            let states: Vec<State> = choices
                .iter()
                .map(|of| {
                    let state = of[number % of.len()];
                    number /= of.len();
                    state
                })
                .collect();
            let (roots, many) = self.roots(&states);
            doubtful |= many;
            for (x, angles) in roots {
                if self.meets(&states, &angles, &x) {
                    found.push((0..m).map(|i| x[i] * self.dual.unit[i]).collect());
                }
            }
        }
        (found, doubtful)
    }
}

/// Other loads, which need not be held, and more friction.
fn varied(deck: &mut Deck, seed: u64) {
    let mut random = Random::new(seed);
    for body in &mut deck.bodies {
        let by = 0.5 * size(&body.load);
        body.load.iter_mut().for_each(|f| *f += by * random.normal());
    }
    deck.friction.coefficient.iter_mut().for_each(|mu| *mu *= 3.0);
}

#[test]
fn answers_in_space_are_among_those_of_brute_force() {
    let (mut solved, mut several, mut none, mut unsolved) = (0, 0, 0, Vec::new());
    for number in 0..4000 {
        let (seed, is_varied) = (number / 2, number % 2 == 1);
        let mut drawn = case(seed, &TINY);
        if is_varied {
            varied(&mut drawn.deck, seed);
        }
        let (deck, nodes) = (&drawn.deck, drawn.deck.friction.normal.len());
        if deck.friction.dim != 2 || !(1..=2).contains(&nodes) {
            continue;
        }
        let (answers, doubtful) = Search::new(deck).answers();
        if doubtful {
            continue;
        }
        several += usize::from(answers.len() > 1);
        let mut problem = hand_over::problem(deck).unwrap();
        let name = format!("{seed} {}, varied {is_varied}", drawn.class);
        match problem.solve() {
            Ok(report) if report.outcome == Outcome::Solved => {
                let found = answer(&problem);
                let forces = [&found.lambda[..], &found.along, &found.mu].concat();
                let far = distance(deck, &answers, &forces);
                assert!(far <= NEAR, "{name}: {far:e} from the nearest of {} answers", answers.len());
                solved += 1;
            }
            _ if answers.is_empty() => none += 1,
            Ok(report) => unsolved.push(format!("{name}: {:?}", report.outcome)),
            Err(error) if error.kind == Kind::Slides => unsolved.push(format!("{name}: slides")),
            Err(error) => panic!("{name}: {error}"),
        }
    }
    println!("{solved} solved, {several} with several answers, {none} without, unsolved {unsolved:?}");
    assert!(solved >= 180 && several >= 2 && none >= 10 && unsolved.len() <= 2, "{unsolved:?}");
}
