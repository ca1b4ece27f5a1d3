//! All combinations of states of the contacts of a deck in the plane, one dense system each.

use decks::dense::solve;
use decks::{Deck, Rows};

/// More combinations than this are not tried.
const MOST: usize = 5000;
/// A pivot of this part of the largest is none; forces and gaps of this part of the largest are none.
const PIVOT: f64 = 1e-9;
const NONE: f64 = 1e-8;
/// What is left of this part of the loads along a motion is rounding.
const ROUNDING: f64 = 1e-14;

pub struct Enumerated {
    /// Forces of contact rows, tangential rows and equalities of each answer.
    pub answers: Vec<Vec<f64>>,
    /// There are states with many answers or none: what is not found may be there.
    pub doubtful: bool,
}

#[derive(Clone, Copy, PartialEq)]
enum State {
    /// The row has no gap, or no slip.
    Kept,
    /// The force is 0.
    Open,
    /// The force is bound + mu times the normal one, in this sense.
    Slips(f64),
}

/// A contact: its rows and the states that they may have.
struct Place {
    normal: Option<usize>,
    along: Option<usize>,
    mu: f64,
    bound: f64,
    choices: Vec<(State, State)>,
}

/// F, d and G of all rows, each in the unit of `(b D^-1 b' + C)^1/2`.
pub struct Dual {
    pub f: Vec<Vec<f64>>,
    pub d: Vec<f64>,
    pub g: Vec<Vec<f64>>,
    pub e: Vec<f64>,
    pub unit: Vec<f64>,
}

/// Of supports of all motions, where forces that move rows by 1 are 1, and the part of the load above which what they carry is a slide.
const WEAK: f64 = 1e-6;
const SLIDES: f64 = 1e-3;

/// Rests; `None` where there are too many states, or a node has two tangential rows.
pub fn answers(deck: &Deck) -> Option<Enumerated> {
    let (all, doubtful) = of_all_states(deck, 0.0)?;
    Some(Enumerated { answers: all.into_iter().map(|(forces, _)| forces).collect(), doubtful })
}

/// The parts of the load along the motion which friction holds in slides that weak supports show, and whether others may be there.
pub fn slides(deck: &Deck) -> Option<(Vec<f64>, bool)> {
    let (all, doubtful) = of_all_states(deck, WEAK)?;
    let e = Dual::new(deck).e;
    let dot = |a: &[f64], b: &[f64]| a.iter().zip(b).map(|(a, b)| a * b).sum::<f64>();
    let moving = all.iter().filter(|(_, a)| WEAK * size(a) > SLIDES * size(&e));
    Some((moving.map(|(_, a)| 1.0 - WEAK * dot(a, a) / dot(&e, a)).collect(), doubtful))
}

/// Forces and amplitudes of motions of all states that meet all laws, with supports of the stiffness kappa.
fn of_all_states(deck: &Deck, kappa: f64) -> Option<(Vec<(Vec<f64>, Vec<f64>)>, bool)> {
    let places = places(deck);
    let count = places.iter().try_fold(1usize, |count, place| count.checked_mul(place.choices.len()))?;
    if count > MOST || (deck.friction.dim != 1 && !deck.friction.normal.is_empty()) {
        return None;
    }
    let dual = Dual::new(deck);
    let (m, r) = (dual.d.len(), dual.e.len());
    let (mut found, mut doubtful): (Vec<(Vec<f64>, Vec<f64>)>, bool) = (Vec::new(), false);
    for mut number in 0..count {
        let (mut a, mut b) = (vec![vec![0.0; m + r]; m + r], vec![0.0; m + r]);
        for i in 0..m {
            a[i][..m].copy_from_slice(&dual.f[i]);
            for k in 0..r {
                a[i][m + k] = -dual.g[k][i];
                a[m + k][i] = dual.g[k][i];
            }
        }
        (0..r).for_each(|k| a[m + k][m + k] = kappa);
        b[..m].copy_from_slice(&dual.d);
        b[m..].copy_from_slice(&dual.e);
        let mut states = Vec::new();
        for place in &places {
            let (normal, along) = place.choices[number % place.choices.len()];
            number /= place.choices.len();
            states.push((normal, along));
            if let (Some(n), State::Open) = (place.normal, normal) {
                a[n].fill(0.0);
                (a[n][n], b[n]) = (1.0, 0.0);
            }
            if let (Some(t), State::Slips(sense)) = (place.along, along) {
                a[t].fill(0.0);
                (a[t][t], b[t]) = (1.0, sense * place.bound / dual.unit[t]);
                if let Some(n) = place.normal {
                    a[t][n] = -sense * place.mu * dual.unit[n] / dual.unit[t];
                }
            }
        }
        match eliminated(a, b) {
            Ends::One(x) => {
                let x: &[f64] = &x;
                if dual.meets(&places, &states, x) {
                    let forces: Vec<f64> = (0..m).map(|i| x[i] * dual.unit[i]).collect();
                    let size = size(&x[..m]);
                    let same = |other: &Vec<f64>| {
                        (0..m).all(|i| ((other[i] - forces[i]) / dual.unit[i]).abs() <= 1e-6 * size)
                    };
                    if !found.iter().any(|(other, _)| same(other)) {
                        found.push((forces, x[m..].to_vec()));
                    }
                }
            }
            Ends::Many => doubtful = true,
            Ends::None => {}
        }
    }
    Some((found, doubtful))
}

/// How far forces are from the nearest of some answers, as a part of the largest, which is not nothing beside the load; each force in
/// the unit of its row.
pub fn distance(deck: &Deck, answers: &[Vec<f64>], forces: &[f64]) -> f64 {
    let (unit, metric) = (units(deck), metric(deck));
    let load: Vec<f64> = deck.load().iter().zip(&metric).map(|(f, d)| f / d.sqrt()).collect();
    let least = NONE * size(&load);
    let scaled = |x: &[f64]| x.iter().zip(&unit).map(|(x, unit)| x / unit).collect::<Vec<f64>>();
    let own = scaled(forces);
    let from = |answer: &Vec<f64>| {
        let other = scaled(answer);
        let difference: Vec<f64> = own.iter().zip(&other).map(|(a, b)| a - b).collect();
        let (difference, size) = (size(&difference), size(&other).max(least));
        if difference == 0.0 {
            0.0
        } else {
            difference / size
        }
    };
    answers.iter().map(from).fold(f64::INFINITY, f64::min)
}

pub fn size(x: &[f64]) -> f64 {
    x.iter().fold(0.0, |most: f64, v| most.max(v.abs()))
}

fn kinds(deck: &Deck) -> [&Rows; 3] {
    [&deck.contact, &deck.friction.rows, &deck.equalities]
}

fn places(deck: &Deck) -> Vec<Place> {
    use State::{Kept, Open, Slips};
    let (nodes, contact) = (&deck.friction, deck.contact.len());
    let mut taken = vec![false; contact];
    let mut places = Vec::new();
    for (i, &normal) in nodes.normal.iter().enumerate() {
        normal.iter().for_each(|&row| taken[row] = true);
        let (mu, bound) = (nodes.coefficient[i], nodes.bound[i]);
        let mut choices = Vec::new();
        let never = normal.is_none_or(|row| deck.contact.rhs[row] == f64::INFINITY);
        for closed in if never { vec![Open] } else { vec![Open, Kept] } {
            let none = bound == 0.0 && (mu == 0.0 || closed == Open);
            let of = if none { vec![Slips(0.0)] } else { vec![Kept, Slips(1.0), Slips(-1.0)] };
            choices.extend(of.into_iter().map(|along| (closed, along)));
        }
        places.push(Place { normal, along: Some(contact + i), mu, bound, choices });
    }
    for row in (0..contact).filter(|&row| !taken[row]) {
        let mut choices = vec![(Open, Kept)];
        if deck.contact.rhs[row] < f64::INFINITY {
            choices.push((Kept, Kept));
        }
        places.push(Place { normal: Some(row), along: None, mu: 0.0, bound: 0.0, choices });
    }
    places
}

fn metric(deck: &Deck) -> Vec<f64> {
    let diagonals: Vec<Vec<f64>> = deck.bodies.iter().map(|body| body.stiffness.diagonal()).collect();
    let most = size(&diagonals.concat());
    let of = |own: &Vec<f64>| {
        let instead = if size(own) > 0.0 {
            size(own)
        } else if most > 0.0 {
            most
        } else {
            1.0
        };
        own.iter().map(|d| if *d > 0.0 { *d } else { instead }).collect::<Vec<f64>>()
    };
    diagonals.iter().flat_map(of).collect()
}

/// The force that is 1 in the equations, for each row.
fn units(deck: &Deck) -> Vec<f64> {
    let metric = metric(deck);
    let of = |rows: &Rows, i: usize| {
        let square: f64 =
            rows.matrix.row(i).map(|(j, b)| b * b / metric[j]).sum::<f64>() + rows.compliance[i];
        if square > 0.0 {
            1.0 / square.sqrt()
        } else {
            1.0
        }
    };
    kinds(deck).iter().flat_map(|rows| (0..rows.len()).map(|i| of(rows, i)).collect::<Vec<_>>()).collect()
}

impl Dual {
    pub fn new(deck: &Deck) -> Self {
        let (metric, unit) = (metric(deck), units(deck));
        let mut rows: Vec<Vec<f64>> = Vec::new();
        let (mut gaps, mut compliance) = (Vec::new(), Vec::new());
        for kind in kinds(deck) {
            for i in 0..kind.len() {
                let by = unit[rows.len()];
                let mut row = vec![0.0; deck.dofs()];
                kind.matrix.row(i).for_each(|(j, b)| row[j] = by * b);
                rows.push(row);
                gaps.push(if kind.rhs[i] < f64::INFINITY { by * kind.rhs[i] } else { 0.0 });
                compliance.push(by * by * kind.compliance[i]);
            }
        }
        let m = rows.len();
        let (mut f, mut d) = (vec![vec![0.0; m]; m], vec![0.0; m]);
        let (mut g, mut e) = (Vec::new(), Vec::new());
        let mut first = 0;
        for body in &deck.bodies {
            let n = body.dofs();
            let own = first..first + n;
            first += n;
            let metric = &metric[own.clone()];
            let modes = orthonormal(body.modes(), metric);
            let mut regular: Vec<f64> = (0..n * n).map(|k| body.stiffness.get(k / n, k % n)).collect();
            for mode in &modes {
                for i in 0..n {
                    (0..n).for_each(|j| regular[i * n + j] += metric[i] * mode[i] * mode[j] * metric[j]);
                }
            }
            let moved = |load: &[f64]| solve(regular.clone(), load.to_vec()).unwrap();
            let by_load = moved(&body.load);
            let dot = |a: &[f64], b: &[f64]| a.iter().zip(b).map(|(a, b)| a * b).sum::<f64>();
            for i in 0..m {
                d[i] += dot(&rows[i][own.clone()], &by_load);
                if rows[i][own.clone()].iter().all(|b| *b == 0.0) {
                    continue;
                }
                let by_row = moved(&rows[i][own.clone()]);
                (0..m).for_each(|k| f[k][i] += dot(&rows[k][own.clone()], &by_row));
            }
            for mode in &modes {
                g.push(rows.iter().map(|row| dot(&row[own.clone()], mode)).collect());
                let terms: Vec<f64> = body.load.iter().zip(mode).map(|(load, v)| load * v).collect();
                let (sum, sizes): (f64, f64) = (terms.iter().sum(), terms.iter().map(|v| v.abs()).sum());
                e.push(if sum.abs() > ROUNDING * sizes { sum } else { 0.0 });
            }
        }
        for i in 0..m {
            d[i] -= gaps[i];
            f[i][i] += compliance[i];
        }
        Self { f, d, g, e, unit }
    }

    /// gap of row i, minus its slip.
    pub fn gap(&self, x: &[f64], i: usize) -> f64 {
        let m = self.d.len();
        let by_forces: f64 = self.f[i].iter().zip(x).map(|(f, x)| f * x).sum();
        by_forces - self.d[i] - self.g.iter().zip(&x[m..]).map(|(g, a)| g[i] * a).sum::<f64>()
    }

    fn meets(&self, places: &[Place], states: &[(State, State)], x: &[f64]) -> bool {
        let none = NONE * size(&x[..self.d.len()]).max(size(&self.d));
        places.iter().zip(states).all(|(place, &(normal, along))| {
            let is_right = place.normal.is_none_or(|n| match normal {
                State::Open => self.gap(x, n) >= -none || place.choices.iter().all(|c| c.0 == State::Open),
                _ => x[n] >= -none,
            });
            is_right
                && place.along.is_none_or(|t| {
                    let by_normal = place.normal.map_or(0.0, |n| place.mu * self.unit[n] * x[n].max(0.0));
                    let limit = (place.bound + by_normal) / self.unit[t];
                    match along {
                        State::Slips(sense) => {
                            sense == 0.0 || limit <= none || -self.gap(x, t) * sense >= -none
                        }
                        _ => x[t].abs() <= limit + none,
                    }
                })
        })
    }
}

fn orthonormal(modes: &[Vec<f64>], metric: &[f64]) -> Vec<Vec<f64>> {
    let dot = |a: &[f64], b: &[f64]| a.iter().zip(b).zip(metric).map(|((a, b), d)| a * b * d).sum::<f64>();
    let mut basis: Vec<Vec<f64>> = Vec::new();
    for mode in modes {
        let mut v = mode.clone();
        for _ in 0..2 {
            for other in &basis {
                let by = dot(&v, other);
                v.iter_mut().zip(other).for_each(|(v, o)| *v -= by * o);
            }
        }
        let size = dot(&v, &v).sqrt();
        basis.push(v.iter().map(|v| v / size).collect());
    }
    basis
}

pub enum Ends {
    One(Vec<f64>),
    Many,
    None,
}

/// a x = b by elimination with the largest pivot of all.
pub fn eliminated(mut a: Vec<Vec<f64>>, mut b: Vec<f64>) -> Ends {
    let n = b.len();
    let mut order: Vec<usize> = (0..n).collect();
    let largest = a.iter().map(|row| size(row)).fold(0.0, f64::max);
    for k in 0..n {
        let (mut p, mut q) = (k, k);
        for i in k..n {
            for j in k..n {
                if a[i][j].abs() > a[p][q].abs() {
                    (p, q) = (i, j);
                }
            }
        }
        if a[p][q].abs() <= PIVOT * largest {
            let left = size(&b[k..]);
            return if left <= 1e-7 * size(&b) { Ends::Many } else { Ends::None };
        }
        a.swap(k, p);
        b.swap(k, p);
        order.swap(k, q);
        a.iter_mut().for_each(|row| row.swap(k, q));
        let pivot = a[k].clone();
        for i in k + 1..n {
            let by = a[i][k] / pivot[k];
            if by != 0.0 {
                (k..n).for_each(|j| a[i][j] -= by * pivot[j]);
                b[i] -= by * b[k];
            }
        }
    }
    let mut x = vec![0.0; n];
    for k in (0..n).rev() {
        b[k] = (b[k] - (k + 1..n).map(|j| a[k][j] * b[j]).sum::<f64>()) / a[k][k];
        x[order[k]] = b[k];
    }
    Ends::One(x)
}
