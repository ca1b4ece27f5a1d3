//! Random problems with driven motions, of few contact rows: all stationary points by all sets of closed rows, each solved dense.

use decks::dense::solve;
use decks::random::Random;
use decks::{Block, Deck};
use feti_contact::error::{Error, Kind, Proof};
use feti_contact::solver::{Modes, Outcome, Report, RowKind};

use crate::soft::{add_diagonal, difference, given};
use crate::support::asked::seeds;
use crate::support::rungs::{self, Ended};

/// Problems of the ordinary run.
const PROBLEMS: u64 = 200;
/// Signs, rows and singular conditions are known to this.
const NOISE: f64 = 1e-9;
/// rho this near to 1 is nobody's to decide.
const CRITICAL: f64 = 1e-5;

/// A drive beyond this against E = 1 is no soft motion.
const STRONG: f64 = 0.3;

/// A stationary point: closed rows, forces of contact rows, displacements; whether K is definite along its closed rows.
struct Point {
    closed: Vec<usize>,
    lambda: Vec<f64>,
    u: Vec<f64>,
    is_minimum: bool,
}

/// Dense K and all rows.
pub struct Dense {
    n: usize,
    k: Vec<f64>,
    contact: Vec<Vec<f64>>,
    equalities: Vec<Vec<f64>>,
}

impl Dense {
    pub fn of(deck: &Deck) -> Self {
        let n = deck.dofs();
        let mut k = vec![0.0; n * n];
        for (p, body) in deck.bodies.iter().enumerate() {
            let first = deck.offset(p);
            for i in 0..body.dofs() {
                body.stiffness.row(i).for_each(|(j, v)| k[(first + i) * n + first + j] = v);
            }
        }
        let rows = |rows: &decks::Rows| {
            let dense = |i: usize| {
                let mut row = vec![0.0; n];
                rows.matrix.row(i).for_each(|(j, v)| row[j] = v);
                row
            };
            (0..rows.len()).map(dense).collect()
        };
        Self { n, k, contact: rows(&deck.contact), equalities: rows(&deck.equalities) }
    }

    /// These contact rows and all equality rows.
    fn rows(&self, closed: &[usize]) -> Vec<&Vec<f64>> {
        closed.iter().map(|&i| &self.contact[i]).chain(&self.equalities).collect()
    }

    /// `[K B_F'; B_F 0]`
    fn conditions(&self, closed: &[usize]) -> (Vec<f64>, usize) {
        let (n, rows) = (self.n, self.rows(closed));
        let size = n + rows.len();
        let mut a = vec![0.0; size * size];
        (0..n).for_each(|i| a[i * size..i * size + n].copy_from_slice(&self.k[i * n..(i + 1) * n]));
        for (k, row) in rows.iter().enumerate() {
            for j in 0..n {
                (a[(n + k) * size + j], a[j * size + n + k]) = (row[j], row[j]);
            }
        }
        (a, size)
    }

    /// The least eigenvalue of K along the closed rows is positive: Cholesky with stiff springs on them.
    pub fn is_definite(&self, closed: &[usize]) -> bool {
        let n = self.n;
        let stiff = 1e4 * (0..n).map(|i| self.k[i * n + i]).fold(0.0, f64::max);
        let mut a = self.k.clone();
        for row in self.rows(closed) {
            for i in (0..n).filter(|&i| row[i] != 0.0) {
                (0..n).for_each(|j| a[i * n + j] += stiff * row[i] * row[j]);
            }
        }
        for j in 0..n {
            for i in j..n {
                let rest = a[i * n + j] - (0..j).map(|k| a[i * n + k] * a[j * n + k]).sum::<f64>();
                if i == j && rest <= 0.0 {
                    return false;
                }
                a[i * n + j] = if i == j { rest.sqrt() } else { rest / a[j * n + j] };
            }
        }
        true
    }

    /// All stationary points.
    fn points(&self, deck: &Deck) -> Vec<Point> {
        let m = self.contact.len();
        (0u32..1 << m)
            .filter_map(|set| self.point(deck, (0..m).filter(|i| set >> i & 1 == 1).collect()))
            .collect()
    }

    fn point(&self, deck: &Deck, closed: Vec<usize>) -> Option<Point> {
        let (a, size) = self.conditions(&closed);
        let mut b = deck.load();
        b.extend(closed.iter().map(|&i| deck.contact.rhs[i]).chain(deck.equalities.rhs.iter().copied()));
        assert_eq!(b.len(), size);
        let x = solve(a, b)?;
        let (u, forces) = x.split_at(self.n);
        let far = u.iter().fold(0.0, |m: f64, u| m.max(u.abs()));
        let most = forces.iter().fold(0.0, |m: f64, l| m.max(l.abs()));
        let pulls = forces[..closed.len()].iter().any(|l| *l < -NOISE * most);
        let open =
            |i: usize| deck.contact.rhs[i] - self.contact[i].iter().zip(u).map(|(b, u)| b * u).sum::<f64>();
        if !far.is_finite() || pulls || (0..self.contact.len()).any(|i| open(i) < -NOISE * far) {
            return None;
        }
        let mut lambda = vec![0.0; self.contact.len()];
        closed.iter().zip(forces).for_each(|(&i, l)| lambda[i] = *l);
        Some(Point { is_minimum: self.is_definite(&closed), closed, lambda, u: u.to_vec() })
    }

    /// The energy falls along v: from a stationary point whose closed rows v keeps closed, or without end.
    fn proves(&self, v: &[f64], points: &[Point]) -> Result<(), String> {
        let n = self.n;
        let energy: f64 = (0..n).map(|i| v[i] * (0..n).map(|j| self.k[i * n + j] * v[j]).sum::<f64>()).sum();
        let moved = |row: &Vec<f64>| row.iter().zip(v).map(|(b, v)| b * v).sum::<f64>();
        let still = |row: &Vec<f64>| moved(row).abs() <= 1e-7;
        if energy >= 0.0 || !self.equalities.iter().all(still) {
            return Err(format!("v'K v = {energy:e}"));
        }
        let endless = self.contact.iter().all(|row| moved(row) <= 1e-7);
        let keeps = |point: &Point| point.closed.iter().all(|&i| still(&self.contact[i]));
        if endless || points.iter().any(|point| !point.is_minimum && keeps(point)) {
            return Ok(());
        }
        Err(format!("rows {:?}, energy {energy:e}", self.contact.iter().map(moved).collect::<Vec<_>>()))
    }
}

/// Blocks on each other, a few rows in every joint, pressed, pushed and driven; and the rows that are closed without drive.
fn drawn(seed: u64) -> Deck {
    let mut random = Random::new(seed);
    let blocks = 1 + random.below(3);
    let elements = [3 + random.below(2), 1 + random.below(2), 1];
    let [nx, ny, _] = elements;
    let block = |p: usize| Block {
        dimension: 2,
        elements,
        size: [1.0, 1.0, 1.0],
        origin: [0.0, p as f64, 0.0],
        ..Block::default()
    };
    let node = |x: usize, y: usize| 2 * (y * (nx + 1) + x);
    let mut deck =
        Deck::new(format!("driven {seed}"), (0..blocks).map(|p| block(p).floating().body).collect());
    let (slope, push) = (random.between(-0.5, 0.5), random.between(-0.1, 0.1));
    for body in &mut deck.bodies {
        for x in 0..=nx {
            let at = x as f64 / nx as f64 - 0.5;
            body.load[node(x, ny) + 1] = -1e-3 * (1.0 + slope * at);
            body.load[node(x, ny)] = 1e-3 * push * random.between(-1.0, 1.0);
        }
    }
    for p in 0..blocks {
        let own = deck.offset(p);
        let at = random.below(2)..=nx - random.below(2);
        for x in at {
            if deck.contact.len() >= 7 {
                break;
            }
            let gap = if random.chance(0.5) { 0.0 } else { random.between(0.0, 3e-3) };
            let aside = random.between(-0.2, 0.2);
            let foot = [(own + node(x, 0) + 1, -1.0), (own + node(x, 0), aside)];
            if p > 0 {
                let below = deck.offset(p - 1) + node(x, ny);
                deck.contact.push(&[(below, -aside), (below + 1, 1.0), foot[1], foot[0]], gap);
            } else {
                deck.contact.push(&[foot[1], foot[0]], gap);
            }
        }
        if random.chance(0.3) && deck.contact.len() < 8 {
            // a wall aside
            deck.contact.push(&[(own + node(nx, ny), 1.0)], random.between(0.0, 0.1));
        }
        deck.equalities.push(&[(own + node(0, 0), 1.0)], 0.0);
    }
    deck
}

fn with_drive(mut deck: Deck, seed: u64, drive: f64) -> Deck {
    let mut random = Random::new(seed ^ 0x5eed);
    for body in &mut deck.bodies {
        let n = body.dofs();
        for _ in 0..1 + random.below(3) {
            add_diagonal(body, n - 1 - random.below(n / 2), -drive * random.between(0.2, 1.0));
        }
    }
    deck
}

/// A deck driven by a part of its stiffness, which rows may hold or not.
pub fn driven(seed: u64) -> Deck {
    with_drive(drawn(seed), seed, Random::new(seed ^ 0x40).decades(-3.0, -0.5))
}

/// The deck driven rho times as much as it takes where the rows are closed that are so without drive; none where none holds it.
fn case(seed: u64) -> Option<(Deck, f64)> {
    let deck = drawn(seed);
    let mut problem = given(&deck, Modes::Exact);
    problem.solve().ok().filter(|report| report.outcome == Outcome::Solved)?;
    let lambda = problem.multipliers(RowKind::Inequality).ok()?;
    let closed: Vec<usize> = (0..lambda.len()).filter(|&i| lambda[i] > 0.0).collect();
    let (mut low, mut high) = (1e-9, 1.0);
    let stands = |drive: f64| Dense::of(&with_drive(deck.clone(), seed, drive)).is_definite(&closed);
    if !stands(low) || stands(high) {
        return None;
    }
    while high / low > 1.0 + 1e-3 {
        let middle = f64::sqrt(low * high);
        *(if stands(middle) { &mut low } else { &mut high }) = middle;
    }
    let rho = Random::new(seed ^ 0x40).decades(-2.5, 0.5);
    (rho * low < STRONG).then(|| (with_drive(deck, seed, rho * low), rho))
}

#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
enum End {
    /// No problem.
    None,
    Answered,
    /// No minimum, with or without one elsewhere.
    Refused,
    RefusedBeside,
    Unsolved,
    Wrong,
    Open,
}

fn refused(dense: &Dense, points: &[Point], error: &Error) -> (End, String) {
    let Some(Proof::Motion { v, .. }) = error.proof.as_deref() else {
        return (End::Wrong, error.to_string());
    };
    if !matches!(error.kind, Kind::Indefinite | Kind::LoadNotHeld) {
        return (End::Wrong, error.to_string());
    }
    match dense.proves(v, points) {
        Err(why) => (End::Wrong, format!("{error}: {why}")),
        Ok(()) if points.iter().any(|point| point.is_minimum) => (End::RefusedBeside, error.to_string()),
        Ok(()) => (End::Refused, error.to_string()),
    }
}

fn end(deck: &Deck) -> (End, String) {
    let (end, what, _) = end_without(deck, rungs::without());
    (end, what)
}

/// Without the second tries of these bits, and the report.
fn end_without(deck: &Deck, without: i64) -> (End, String, Option<Report>) {
    let dense = Dense::of(deck);
    let points = dense.points(deck);
    let mut problem = given(deck, Modes::Soft);
    problem.set_i64("without", without).unwrap();
    let solved = problem.solve();
    let report = solved.as_ref().ok().cloned();
    let (end, what) = match solved {
        Err(error) => refused(&dense, &points, &error),
        Ok(report) if report.outcome == Outcome::Solved => {
            let (lambda, u) =
                (problem.multipliers(RowKind::Inequality).unwrap(), problem.displacements().unwrap());
            let error = |point: &Point| {
                let most = point.lambda.iter().fold(0.0, |m: f64, l| m.max(l.abs()));
                let forces = if most > 0.0 { difference(lambda, &point.lambda) } else { 0.0 };
                forces.max(difference(u, &point.u))
            };
            let near = points.iter().min_by(|p, q| error(p).total_cmp(&error(q)));
            match near {
                Some(point) if error(point) <= 1e-5 && point.is_minimum => (End::Answered, String::new()),
                Some(point) => {
                    (End::Wrong, format!("error {:.1e}, minimum {}", error(point), point.is_minimum))
                }
                None => (End::Wrong, "no stationary point".to_string()),
            }
        }
        Ok(report) => {
            let is_held = points.iter().any(|point| point.is_minimum);
            (if is_held { End::Unsolved } else { End::Open }, format!("{:?}", report.outcome))
        }
    };
    (end, what, report)
}

#[test]
fn random_driven_problems_end_as_all_their_stationary_points_say() {
    let (mut counts, mut lines) = (std::collections::BTreeMap::<End, usize>::new(), Vec::new());
    for seed in seeds(PROBLEMS) {
        let Some((deck, rho)) = case(seed) else {
            *counts.entry(End::None).or_default() += 1;
            continue;
        };
        if (rho - 1.0).abs() < CRITICAL {
            continue;
        }
        let (end, what) = end(&deck);
        *counts.entry(end).or_default() += 1;
        if matches!(end, End::Wrong | End::Unsolved | End::Open) {
            lines.push(format!("{seed}: rho {rho:.4} {end:?} {what}"));
        }
    }
    if std::env::var("BATTERY").is_ok() {
        println!("{counts:?}\n{}", lines.join("\n"));
    }
    let of = |end: End| counts.get(&end).copied().unwrap_or(0);
    assert!(of(End::Wrong) + of(End::Unsolved) == 0, "{counts:?}\n{}", lines.join("\n"));
    assert!(of(End::Answered) > 0 && of(End::Refused) > 0, "{counts:?}");
}

/// `make rungs`.
#[test]
#[ignore]
fn what_each_second_try_saves() {
    rungs::print("driven", seeds(PROBLEMS), |seed, without| {
        let (deck, _) = case(seed).filter(|(_, rho)| (rho - 1.0).abs() >= CRITICAL)?;
        let (end, _, report) = end_without(&deck, without);
        Some(Ended { solved: !matches!(end, End::Unsolved | End::Open), wrong: end == End::Wrong, report })
    });
}
