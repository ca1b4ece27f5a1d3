//! Contacts: a point of one body against a point of another or the ground, with the law of friction there.

use decks::random::Random;
use decks::Deck;

use super::body::Drawing;
use super::coefficient;

#[derive(Clone)]
pub struct Contact {
    pub body: usize,
    /// First unknown of its node.
    pub own: usize,
    /// First unknown of each node it touches, with the weight of the displacement there.
    points: Vec<(usize, f64)>,
    pub normal: Vec<f64>,
    tangents: Vec<Vec<f64>>,
    /// Factor of the host on all rows.
    pub factor: f64,
    pub mu: f64,
    /// Bound of the tangential force, of the normal force there is or of what there could be.
    pub bound: f64,
    /// Of the softer body.
    pub stiffness: f64,
    pub compliance: f64,
    pub slack: f64,
    /// A node with friction; else a contact row alone.
    pub rubs: bool,
    /// A node of friction without a contact row.
    pub alone: bool,
    /// Of an open row.
    pub gap: Option<f64>,
}

impl Contact {
    pub fn new(random: &mut Random, class: &str, drawing: &Drawing, body: usize) -> Self {
        let (dim, count) = (drawing.dim, drawing.bodies.len());
        let place = |p: usize, node: usize| drawing.offset(p) + dim * node;
        let own = place(body, random.below(drawing.nodes(body)));
        let mut points = vec![(own, 1.0)];
        let mut stiffness = drawing.stiffness[body];
        if count > 1 && random.chance(0.7) {
            // of many bodies the one before
            let other = match class {
                "many bodies" => (body + count - 1) % count,
                _ => (body + 1 + random.below(count - 1)) % count,
            };
            stiffness = stiffness.min(drawing.stiffness[other]);
            let corners = if random.chance(0.5) { 1 } else { dim.min(drawing.nodes(other)) };
            let mut left = 1.0;
            let first = random.below(drawing.nodes(other));
            for k in 0..corners {
                let weight = if k + 1 == corners { left } else { left * random.uniform() };
                left -= weight;
                points.push((place(other, (first + k) % drawing.nodes(other)), -weight));
            }
        }
        let (normal, tangents) = frame(random, class, dim);
        let tresca = class == "bounds alone";
        let mu = if tresca { 0.0 } else { coefficient(random) };
        let both = tresca || (class == "bounds and mu" && random.chance(0.7));
        let (frictionless, alone) = match class {
            "mixed rows" => (random.chance(0.4), random.chance(0.2)),
            _ => (false, tresca && random.chance(0.2)),
        };
        let springs = class == "joints";
        let mut maybe =
            |size: f64| if springs && random.chance(0.3) { size * random.decades(-2.0, 1.0) } else { 0.0 };
        let (compliance, slack) = (maybe(1.0 / stiffness), maybe(1.0 / stiffness));
        Self {
            body,
            own,
            points,
            normal,
            tangents,
            factor: if random.chance(0.3) { random.decades(-3.0, 3.0) } else { 1.0 },
            mu: if alone { 0.0 } else { mu },
            bound: if both || alone { random.uniform() } else { 0.0 },
            stiffness,
            compliance,
            slack,
            rubs: !frictionless || alone,
            alone,
            gap: None,
        }
    }

    pub fn is_normal(&self) -> bool {
        !self.alone
    }

    /// The same once more: in other units, its tangents the other way round.
    pub fn repeated(&self, random: &mut Random) -> Self {
        let mut again = self.clone();
        again.factor = random.decades(-2.0, 2.0);
        if random.chance(0.5) {
            again.tangents.iter_mut().flatten().for_each(|t| *t = -*t);
        }
        again
    }

    /// `factor d'(u at the point - u at what it touches)`
    pub fn row(&self, direction: &[f64]) -> Vec<(usize, f64)> {
        let of = |&(first, weight): &(usize, f64)| {
            let entry = move |(axis, d): (usize, &f64)| (first + axis, self.factor * weight * d);
            direction.iter().enumerate().map(entry).collect::<Vec<_>>()
        };
        self.points.iter().flat_map(of).filter(|(_, b)| *b != 0.0).collect()
    }

    /// Its rows with the gaps and slips to begin with that `state` has at u.
    pub fn push(&self, deck: &mut Deck, u: &[f64], state: &State) {
        let at = |row: &[(usize, f64)]| row.iter().map(|&(j, b)| b * u[j]).sum::<f64>();
        let square = self.factor * self.factor;
        if self.is_normal() {
            let row = self.row(&self.normal);
            let moved = at(&row) - self.compliance * self.factor * state.normal;
            let gap = self.gap.map_or(moved + self.factor * state.gap, |gap| gap * self.factor);
            deck.contact.push_compliant(&row, gap, self.compliance * square);
        }
        if !self.rubs {
            return;
        }
        let rows: Vec<Vec<(usize, f64)>> = self.tangents.iter().map(|t| self.row(t)).collect();
        let normal = self.is_normal().then(|| deck.contact.len() - 1);
        let views: Vec<&[(usize, f64)]> = rows.iter().map(Vec::as_slice).collect();
        deck.friction.push(normal, &views, self.mu, state.bound / self.factor);
        let first = deck.friction.rows.len() - rows.len();
        for (k, row) in rows.iter().enumerate() {
            let slipped = self.factor * (state.slip[k] + self.slack * state.along[k]);
            deck.friction.rows.rhs[first + k] = at(row) - slipped;
            deck.friction.rows.compliance[first + k] = self.slack * square;
        }
    }
}

/// A normal and its tangents, orthonormal but for oblique and empty ones.
fn frame(random: &mut Random, class: &str, dim: usize) -> (Vec<f64>, Vec<Vec<f64>>) {
    let mut frame: Vec<Vec<f64>> = Vec::new();
    let along_axes = random.chance(0.3);
    while frame.len() < dim {
        let axis = frame.len();
        let mut v: Vec<f64> = match along_axes {
            true => (0..dim).map(|i| f64::from(i == axis)).collect(),
            false => random.normals(dim, 1.0),
        };
        for other in &frame {
            let part: f64 = v.iter().zip(other).map(|(a, b)| a * b).sum();
            v.iter_mut().zip(other).for_each(|(v, o)| *v -= part * o);
        }
        let size = v.iter().map(|v| v * v).sum::<f64>().sqrt();
        if size > 0.1 {
            frame.push(v.iter().map(|v| v / size).collect());
        }
    }
    let normal = frame.remove(0);
    if class == "oblique" {
        for t in &mut frame {
            if random.chance(0.25) {
                t.fill(0.0);
                continue;
            }
            let (by, longer) = (random.between(-0.7, 0.7), random.between(0.7, 1.5));
            t.iter_mut().zip(&normal).for_each(|(t, n)| *t = longer * (*t + by * n));
        }
    }
    (normal, frame)
}

/// Of one contact, as if its factor were 1.
pub struct State {
    pub normal: f64,
    pub gap: f64,
    pub along: Vec<f64>,
    pub slip: Vec<f64>,
    pub bound: f64,
}

impl State {
    pub fn open(tangents: usize) -> Self {
        Self { normal: 0.0, gap: 0.0, along: vec![0.0; tangents], slip: vec![0.0; tangents], bound: 0.0 }
    }

    /// Forces of the size `force`, gaps and slips of the size `moves`.
    pub fn drawn(random: &mut Random, class: &str, contact: &Contact, force: f64, moves: f64) -> Self {
        let mut state = Self::open(contact.tangents.len());
        state.bound = contact.bound * force;
        let degenerate = class == "degenerate" && random.chance(0.4);
        if contact.is_normal() {
            if random.chance(0.7) {
                state.normal = force;
            } else {
                state.gap = if degenerate { 0.0 } else { moves * random.decades(-2.0, 1.0) };
            }
        }
        let limit = state.bound + contact.mu * state.normal;
        let empty = contact.tangents.iter().all(|t| t.iter().all(|v| *v == 0.0));
        let direction = unit(random, contact);
        let is_slip = random.chance(0.5) && !empty;
        let share = match (is_slip, empty) {
            (_, true) => 0.0,
            (true, _) => 1.0,
            _ if degenerate => 1.0,
            _ => 0.95 * random.uniform(),
        };
        state.along = direction.iter().map(|d| share * limit * d).collect();
        let open = limit == 0.0 && !empty;
        if (is_slip && !degenerate) || open {
            let size = moves * random.decades(-2.0, 0.5);
            state.slip = direction.iter().map(|d| size * d).collect();
        }
        state
    }
}

/// A direction of the tangential rows that have entries.
fn unit(random: &mut Random, contact: &Contact) -> Vec<f64> {
    loop {
        let v: Vec<f64> = contact
            .tangents
            .iter()
            .map(|t| if t.iter().all(|v| *v == 0.0) { 0.0 } else { random.normal() })
            .collect();
        let size = v.iter().map(|v| v * v).sum::<f64>().sqrt();
        if size > 0.1 || contact.tangents.iter().flatten().all(|v| *v == 0.0) {
            return v.iter().map(|v| if size > 0.0 { v / size } else { 0.0 }).collect();
        }
    }
}

/// Stiff springs under the nodes of some contacts, across them or along every axis.
pub fn support(drawing: &mut Drawing, random: &mut Random, contacts: &[Contact]) {
    for contact in contacts {
        if random.chance(0.5) {
            continue;
        }
        let p = contact.body;
        let first = contact.own - drawing.offset(p);
        let axes = if random.chance(0.5) { drawing.dim } else { 1 };
        let stiff = drawing.stiffness[p] * random.decades(2.0, 6.0);
        drawing.stiffen(p, first..first + axes, stiff);
    }
}
