//! Answers judged from their deck alone: every body and every row by what the forces of its bodies do there.

use decks::{Body, Deck, Rows};

/// What the library has answered.
pub struct Answer {
    pub u: Vec<f64>,
    pub lambda: Vec<f64>,
    pub along: Vec<f64>,
    pub mu: Vec<f64>,
}

const ROUNDING: f64 = 1e-13;
/// Bodies without a load have at least this part of the forces of all: what rounding of these leaves on them is nothing.
const UNLOADED: f64 = 1e-7;

struct Judge<'a> {
    deck: &'a Deck,
    answer: &'a Answer,
    /// diag K, of unknowns without stiffness the largest.
    metric: Vec<f64>,
    body_of: Vec<usize>,
    /// `|f| + |r| + |K u|` of each body over diag K, (force x length)^1/2.
    forces: Vec<f64>,
    /// What is not rigid of u, (force x length)^1/2.
    strains: Vec<f64>,
    /// What rounding may do to each unknown's balance, force.
    rounding: Vec<f64>,
}

/// The worst of all that the laws ask for, as a part of what is there, with what it is. A right answer has some 1e-8 at most.
pub fn worst(deck: &Deck, answer: &Answer) -> (f64, String) {
    let judge = Judge::new(deck, answer);
    let all = [judge.balance(), judge.contact(), judge.ties(), judge.friction()];
    all.into_iter().fold((0.0, String::new()), |worst, one| if one.0 <= worst.0 { worst } else { one })
}

impl<'a> Judge<'a> {
    fn new(deck: &'a Deck, answer: &'a Answer) -> Self {
        let mut judge = Self {
            deck,
            answer,
            metric: Vec::new(),
            body_of: Vec::new(),
            forces: Vec::new(),
            strains: Vec::new(),
            rounding: Vec::new(),
        };
        let most = deck.bodies.iter().flat_map(|body| body.stiffness.diagonal()).fold(0.0, f64::max);
        for (p, body) in deck.bodies.iter().enumerate() {
            let diagonal = body.stiffness.diagonal();
            let own = diagonal.iter().fold(0.0, |most: f64, d| most.max(*d));
            let instead = if own > 0.0 {
                own
            } else if most > 0.0 {
                most
            } else {
                1.0
            };
            judge.metric.extend(diagonal.iter().map(|d| if *d > 0.0 { *d } else { instead }));
            judge.body_of.extend(vec![p; body.dofs()]);
        }
        judge.measure();
        judge
    }

    fn kinds(&self) -> [(&Rows, &[f64]); 3] {
        let Answer { lambda, along, mu, .. } = self.answer;
        [(&self.deck.contact, lambda), (&self.deck.friction.rows, along), (&self.deck.equalities, mu)]
    }

    fn measure(&mut self) {
        let u = &self.answer.u;
        let (mut taken, mut sizes) = (vec![0.0; u.len()], vec![0.0; u.len()]);
        for (rows, forces) in self.kinds() {
            for (i, force) in forces.iter().enumerate() {
                for (j, b) in rows.matrix.row(i) {
                    taken[j] += b * force;
                    sizes[j] += (b * force).abs();
                }
            }
        }
        let mut first = 0;
        for body in &self.deck.bodies {
            let range = first..first + body.dofs();
            first = range.end;
            let strained = body.stiffness.times(&u[range.clone()]);
            let of = |v: &[f64]| self.over(v, range.start);
            self.forces.push(of(&body.load) + of(&taken[range.clone()]) + of(&strained));
            self.strains.push(self.not_rigid(body, range.start));
            for (i, j) in range.enumerate() {
                let by_k: f64 = body.stiffness.row(i).map(|(k, v)| (v * u[j - i + k]).abs()).sum();
                self.rounding.push(ROUNDING * (by_k + body.load[i].abs() + sizes[j]));
            }
        }
        let all = norm(&self.forces);
        for (force, body) in self.forces.iter_mut().zip(&self.deck.bodies) {
            if body.load.iter().all(|f| *f == 0.0) {
                *force = force.max(UNLOADED * all);
            }
        }
    }

    /// `|v|` over diag K, of the unknowns from `first` on.
    fn over(&self, v: &[f64], first: usize) -> f64 {
        v.iter().enumerate().map(|(i, v)| v * v / self.metric[first + i]).sum::<f64>().sqrt()
    }

    /// `|v|` in the metric of diag K.
    fn moved(&self, v: &[f64]) -> f64 {
        v.iter().zip(&self.metric).map(|(v, d)| v * v * d).sum::<f64>().sqrt()
    }

    fn not_rigid(&self, body: &Body, first: usize) -> f64 {
        let metric = &self.metric[first..first + body.dofs()];
        let dot =
            |a: &[f64], b: &[f64]| a.iter().zip(b).zip(metric).map(|((a, b), d)| a * b * d).sum::<f64>();
        let (mut u, mut basis) = (self.answer.u[first..first + body.dofs()].to_vec(), Vec::<Vec<f64>>::new());
        for mode in body.modes() {
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
        for mode in &basis {
            let by = dot(&u, mode);
            u.iter_mut().zip(mode).for_each(|(u, m)| *u -= by * m);
        }
        dot(&u, &u).sqrt()
    }

    fn balance(&self) -> (f64, String) {
        let mut left = self.deck.load();
        let mut first = 0;
        for body in &self.deck.bodies {
            let range = first..first + body.dofs();
            first = range.end;
            let strained = body.stiffness.times(&self.answer.u[range.clone()]);
            left[range].iter_mut().zip(strained).for_each(|(f, k)| *f -= k);
        }
        for (rows, forces) in self.kinds() {
            let taken = rows.matrix.transpose_times(forces);
            left.iter_mut().zip(taken).for_each(|(f, r)| *f -= r);
        }
        let mut worst = (0.0, String::new());
        let mut first = 0;
        for (p, body) in self.deck.bodies.iter().enumerate() {
            let own = first..first + body.dofs();
            first = own.end;
            let start = own.start;
            let beyond: Vec<f64> = own.map(|j| (left[j].abs() - self.rounding[j]).max(0.0)).collect();
            keep(&mut worst, self.over(&beyond, start), self.forces[p], || format!("balance of body {p}"));
        }
        worst
    }

    /// `(b D^-1 b' + C)^1/2`, the bodies of a row, and the length and the force that are little there.
    fn of_row(&self, rows: &Rows, i: usize) -> Measure {
        let mut square = rows.compliance[i];
        let (mut moved, mut least, mut most, mut size) = (rows.rhs[i].abs(), f64::INFINITY, 0.0f64, 0.0);
        let mut strains = 0.0f64;
        for (j, b) in rows.matrix.row(i) {
            let p = self.body_of[j];
            square += b * b / self.metric[j];
            moved += (b * self.answer.u[j]).abs();
            size += b * b / self.metric[j];
            least = least.min(self.forces[p]);
            most = most.max(self.forces[p]);
            strains = strains.max(self.strains[p]);
        }
        if moved == f64::INFINITY || square == 0.0 {
            return Measure {
                length: 0.0,
                force: 0.0,
                rounding: if moved.is_finite() { ROUNDING * moved } else { 0.0 },
            };
        }
        let by_strain = size.sqrt() * strains;
        Measure {
            length: square.sqrt() * most + by_strain,
            force: least / square.sqrt(),
            rounding: ROUNDING * moved,
        }
    }

    /// `c + C lambda - b u`
    fn gap(&self, rows: &Rows, i: usize, force: f64) -> f64 {
        let moved: f64 = rows.matrix.row(i).map(|(j, b)| b * self.answer.u[j]).sum();
        rows.rhs[i] + rows.compliance[i] * force - moved
    }

    fn contact(&self) -> (f64, String) {
        let mut worst = (0.0, String::new());
        let rows = &self.deck.contact;
        for (i, &force) in self.answer.lambda.iter().enumerate() {
            let measure = self.of_row(rows, i);
            let gap = self.gap(rows, i, force);
            let what =
                |what: &str| format!("{what} of contact row {i}: gap {gap:e}, force {force:e}, {measure:?}");
            keep(&mut worst, (-gap - measure.rounding).max(0.0), measure.length, || what("penetration"));
            keep(&mut worst, (-force).max(0.0), measure.force, || what("sign"));
            if force > 0.0 {
                let by_gap = part((gap.abs() - measure.rounding).max(0.0), measure.length);
                let by_force = part(force, measure.force);
                keep(&mut worst, by_gap.min(by_force), 1.0, || what("both"));
            }
        }
        worst
    }

    fn ties(&self) -> (f64, String) {
        let mut worst = (0.0, String::new());
        let rows = &self.deck.equalities;
        for (i, &force) in self.answer.mu.iter().enumerate() {
            let measure = self.of_row(rows, i);
            let gap = self.gap(rows, i, force).abs();
            keep(&mut worst, (gap - measure.rounding).max(0.0), measure.length, || format!("equality {i}"));
        }
        worst
    }

    fn friction(&self) -> (f64, String) {
        let mut worst = (0.0, String::new());
        let nodes = &self.deck.friction;
        for i in 0..nodes.normal.len() {
            let own = i * nodes.dim..(i + 1) * nodes.dim;
            let force = &self.answer.along[own.clone()];
            let slip: Vec<f64> =
                own.clone().map(|k| -self.gap(&nodes.rows, k, self.answer.along[k])).collect();
            let normal = nodes.normal[i].map_or(0.0, |row| self.answer.lambda[row].max(0.0));
            let limit = nodes.bound[i] + nodes.coefficient[i] * normal;
            let measure = own.map(|k| self.of_row(&nodes.rows, k)).fold(Measure::none(), Measure::wider);
            let (size, length) = (norm(force), norm(&slip));
            let what = |what: &str| {
                format!("{what} of node {i}: force {force:?}, limit {limit:e}, slip {slip:?}, {measure:?}")
            };
            let known = measure.force.min(if measure.length == 0.0 { 0.0 } else { f64::INFINITY });
            keep(&mut worst, (size - limit * (1.0 + ROUNDING)).max(0.0), known, || what("cone"));
            // sticks, or slips along a force of that size
            let sticks = part((length - measure.rounding).max(0.0), measure.length);
            let off =
                (0..nodes.dim).map(|k| force[k] - if length > 0.0 { limit * slip[k] / length } else { 0.0 });
            let slips = part(norm(&off.collect::<Vec<_>>()), measure.force);
            keep(&mut worst, sticks.min(slips), 1.0, || what("law"));
        }
        worst
    }
}

#[derive(Debug, Clone, Copy)]
struct Measure {
    length: f64,
    force: f64,
    rounding: f64,
}

impl Measure {
    fn none() -> Self {
        Self { length: 0.0, force: 0.0, rounding: 0.0 }
    }

    fn wider(self, other: Self) -> Self {
        Self {
            length: self.length.max(other.length),
            force: self.force.max(other.force),
            rounding: self.rounding.max(other.rounding),
        }
    }
}

fn norm(v: &[f64]) -> f64 {
    v.iter().map(|v| v * v).sum::<f64>().sqrt()
}

fn part(what: f64, of: f64) -> f64 {
    if what == 0.0 {
        0.0
    } else {
        what / of
    }
}

fn keep(worst: &mut (f64, String), what: f64, of: f64, name: impl Fn() -> String) {
    let ratio = part(what, of);
    // what is no number is wrong
    if !(ratio <= worst.0) {
        *worst = (ratio, name());
    }
}

/// How far a motion of all bodies is from a proof that nothing holds the load: what of it rows and K resist, in the metric of
/// diag K, and the work of the load that bounds of friction leave, over the size of the load in that metric.
pub fn proof(deck: &Deck, v: &[f64]) -> (f64, f64) {
    let nothing = |rows: &Rows| vec![0.0; rows.len()];
    let along = nothing(&deck.friction.rows);
    let (lambda, mu) = (nothing(&deck.contact), nothing(&deck.equalities));
    let answer = Answer { u: v.to_vec(), lambda, along, mu };
    let judge = Judge::new(deck, &answer);
    let load = deck.load();
    let work: f64 = load.iter().zip(v).map(|(f, v)| f * v).sum();
    let (mut strained, mut pushed) = (Vec::new(), Vec::new());
    let mut first = 0;
    for body in &deck.bodies {
        let own = first..first + body.dofs();
        first = own.end;
        let moves = v[own.clone()].iter().any(|v| *v != 0.0);
        pushed.extend(load[own.clone()].iter().map(|f| if moves { *f } else { 0.0 }));
        strained.extend(body.stiffness.times(&v[own]));
    }
    let moved = |rows: &Rows, i: usize| rows.matrix.row(i).map(|(j, b)| b * v[j]).sum::<f64>();
    let mut resists: Vec<f64> = (0..deck.contact.len()).map(|i| moved(&deck.contact, i)).collect();
    let nodes = &deck.friction;
    let mut bounded = 0.0;
    for i in 0..nodes.normal.len() {
        let own = i * nodes.dim..(i + 1) * nodes.dim;
        let slip = norm(&own.map(|k| moved(&nodes.rows, k)).collect::<Vec<_>>());
        bounded += nodes.bound[i] * slip;
        nodes.normal[i].iter().for_each(|&row| resists[row] += nodes.coefficient[i] * slip);
    }
    let scaled = |rows: &Rows, i: usize, by: f64| {
        let square: f64 = rows.matrix.row(i).map(|(j, b)| b * b / judge.metric[j]).sum();
        part(by, (square + rows.compliance[i]).sqrt())
    };
    let by_rows = resists.iter().enumerate().map(|(i, by)| scaled(&deck.contact, i, by.max(0.0)));
    let ties = (0..deck.equalities.len()).map(|i| scaled(&deck.equalities, i, moved(&deck.equalities, i)));
    let resisted = norm(&by_rows.chain(ties).collect::<Vec<_>>()) + judge.over(&strained, 0);
    (resisted, (work - bounded) / judge.over(&pushed, 0))
}

/// What K and equality rows resist of a motion, as a part of it in the metric of diag K, and the work of the load on it.
pub fn slide(deck: &Deck, v: &[f64]) -> (f64, f64) {
    let mut free = deck.clone();
    // contact rows and friction left out
    free.contact.rhs.clear();
    free.contact.matrix = decks::Csr::empty(deck.dofs());
    free.friction = decks::Friction::none(deck.friction.dim, deck.dofs());
    let (resisted, work) = proof(&free, v);
    let nothing = |rows: &Rows| vec![0.0; rows.len()];
    let answer = Answer {
        u: v.to_vec(),
        lambda: nothing(&free.contact),
        along: nothing(&free.friction.rows),
        mu: nothing(&free.equalities),
    };
    (resisted / Judge::new(&free, &answer).moved(v), work)
}
