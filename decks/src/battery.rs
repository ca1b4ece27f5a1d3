//! Random small hard problems with a known outcome: rough gaps, parallel rows with different gaps, stacks of
//! up to eight small bodies, stiffness contrast 1e4, dependent rows, loads that nothing holds, gaps that
//! contradict each other. Each comes with the vectors that prove its outcome. Marginal ones are so close to another outcome
//! that rounding may decide.

use std::ops::Range;

use crate::random::Random;
use crate::vector::{axpy, dot, norm_max};
use crate::{Cube, Deck, Glue, Moduli, Stack};

/// What a solver must find.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Outcome {
    Solvable,
    LoadNotHeld,
    GapsContradict,
}

/// Multipliers or weights on the contact rows and on the equality rows.
#[derive(Clone, Debug)]
pub struct Multipliers {
    pub contact: Vec<f64>,
    pub equalities: Vec<f64>,
}

/// Why the outcome is certain. `displacement`: B u < c, H u = h. `forces`: lambda > 0 and mu with
/// R'(f - B'lambda - H'mu) = 0.
#[derive(Clone, Debug)]
pub enum Proof {
    Solvable {
        displacement: Vec<f64>,
        forces: Multipliers,
    },
    /// A rigid motion v that opens or slides (B v <= 0, H v = 0) along the load (f.v > 0).
    LoadNotHeld {
        displacement: Vec<f64>,
        motion: Vec<f64>,
    },
    /// Weights w >= 0 on contact rows with B'w_I + H'w_E = 0 but c.w_I + h.w_E < 0.
    GapsContradict {
        forces: Multipliers,
        weights: Multipliers,
    },
}

/// A deck with its outcome.
#[derive(Clone, Debug)]
pub struct Case {
    pub deck: Deck,
    pub proof: Proof,
    /// Distance from the other outcomes, no unit: at least 1e-4, of marginal cases 1e-12 to 1e-4.
    /// Solvable: the smallest slack of `displacement` over max |c|.
    /// LoadNotHeld: f.v / (|e| |v|), e = R'f, R'DR = I, |v|^2 = v'Dv, D = diag K: a lower bound for the
    /// distance of e from the loads that can be held over |e|.
    /// GapsContradict: -(c, h).w over max |(c, h)| times sum |w|.
    pub margin: f64,
}

impl Case {
    pub fn outcome(&self) -> Outcome {
        match self.proof {
            Proof::Solvable { .. } => Outcome::Solvable,
            Proof::LoadNotHeld { .. } => Outcome::LoadNotHeld,
            Proof::GapsContradict { .. } => Outcome::GapsContradict,
        }
    }
}

/// Decades of the numbers that the margins follow.
struct Margins {
    /// Smallest open gap of a solvable case, in units of `LENGTH`.
    slack: [f64; 2],
    /// Pull along the free motion.
    pull: [f64; 2],
    /// By how much gaps contradict each other.
    excess: [f64; 2],
    /// Whether every deck has displacements that the gaps must follow.
    rough: bool,
}

const CLEAR: Margins = Margins { slack: [-2.0, 0.0], pull: [-3.9, 0.0], excess: [-3.0, 0.0], rough: false };
const MARGINAL: Margins =
    Margins { slack: [-11.0, -4.5], pull: [-11.9, -4.1], excess: [-11.0, -4.0], rough: true };

/// The cases of the given seeds: of four in a row two are solvable, one of each other outcome.
pub fn cases(seeds: Range<u64>) -> impl Iterator<Item = Case> {
    seeds.map(case)
}

/// The case of one seed.
pub fn case(seed: u64) -> Case {
    drawn(seed, &CLEAR)
}

/// The marginal case of one seed: its outcome is that of its proof in exact arithmetic only.
pub fn marginal(seed: u64) -> Case {
    let mut case = drawn(seed, &MARGINAL);
    case.deck.name.insert_str(0, "marginal_");
    case
}

fn drawn(seed: u64, margins: &Margins) -> Case {
    let mut random = Random::new(seed);
    let outcome = match seed % 4 {
        0 | 1 => Outcome::Solvable,
        2 => Outcome::LoadNotHeld,
        _ => Outcome::GapsContradict,
    };
    let mut base = Base::new(outcome != Outcome::LoadNotHeld, margins, &mut random);
    base.deck.name = format!("battery_{seed}_{outcome:?}");
    match outcome {
        Outcome::Solvable => base.solvable(),
        Outcome::LoadNotHeld => base.release(margins, &mut random),
        Outcome::GapsContradict => base.contradict(margins, &mut random),
    }
}

/// The case with every second row a spring, 1e-4 to 1e4 times as compliant as the bodies are at the row. Rows whose
/// weight proves a contradiction stay rigid, so that the outcome and its proof remain.
pub fn compliant(mut case: Case, seed: u64) -> Case {
    let mut random = Random::new(!seed);
    let diagonal = scaling(&case.deck);
    let Case { deck, proof, .. } = &mut case;
    let (mut contact, mut equalities) = (vec![0.0; deck.contact.len()], vec![0.0; deck.equalities.len()]);
    if let Proof::GapsContradict { weights, .. } = proof {
        (contact, equalities) = (weights.contact.clone(), weights.equalities.clone());
    }
    for (rows, weights) in [(&mut deck.contact, contact), (&mut deck.equalities, equalities)] {
        for (i, weight) in weights.into_iter().enumerate() {
            let local: f64 = rows.matrix.row(i).map(|(j, v)| v * v / diagonal[j]).sum();
            if random.chance(0.5) && weight == 0.0 {
                rows.compliance[i] = local * random.decades(-4.0, 4.0);
            }
        }
    }
    case
}

/// Length of gaps and displacements.
const LENGTH: f64 = 0.01;

/// A solvable deck, with the vectors that prove it, from which the others are made.
struct Base {
    deck: Deck,
    /// A rigid motion that no row resists.
    motion: Vec<f64>,
    displacement: Vec<f64>,
    slack: f64,
    forces: Multipliers,
}

impl Base {
    fn new(may_hold: bool, margins: &Margins, random: &mut Random) -> Base {
        let (mut deck, motion) =
            if random.chance(0.75) { random_stack(may_hold, random) } else { random_cube(may_hold, random) };
        if random.chance(0.5) {
            add_parallel_rows(&mut deck, random);
        }
        let (displacement, slack) = open_gaps(&mut deck, margins, random);
        let forces = balance_load(&mut deck, random);
        Base { deck, motion, displacement, slack, forces }
    }

    fn solvable(self) -> Case {
        Case {
            margin: self.slack / norm_max(&self.deck.contact.rhs),
            proof: Proof::Solvable { displacement: self.displacement, forces: self.forces },
            deck: self.deck,
        }
    }

    /// Turns the load until its cosine with the free motion v is m / sqrt(1 + m^2):
    /// f := f - (f.v/|v|^2) D v + m |R'(f - ...)| D v / |v|, |v|^2 = v'Dv, R'DR = I.
    fn release(mut self, margins: &Margins, random: &mut Random) -> Case {
        self.unload_opening_rows();
        let diagonal = scaling(&self.deck);
        let pull: Vec<f64> = self.motion.iter().zip(&diagonal).map(|(v, d)| v * d).collect();
        let length2 = dot(&pull, &self.motion);
        let mut load = self.deck.load();
        axpy(-dot(&load, &self.motion) / length2, &pull, &mut load);
        set_load(&mut self.deck, &load);
        let wanted = random.decades(margins.pull[0], margins.pull[1]);
        axpy(wanted * rigid_norm(&self.deck) / length2.sqrt(), &pull, &mut load);
        set_load(&mut self.deck, &load);
        let margin = dot(&load, &self.motion) / (rigid_norm(&self.deck) * length2.sqrt());
        let proof = Proof::LoadNotHeld { displacement: self.displacement, motion: self.motion };
        Case { deck: self.deck, proof, margin }
    }

    /// Takes the forces of the rows that the free motion opens out of the load, where the other rows keep at
    /// least a tenth of |R'f|: the rest is held without them, so that even a small pull is only just too much.
    fn unload_opening_rows(&mut self) {
        let before = (self.deck.load(), rigid_norm(&self.deck));
        let closing = self.deck.contact.matrix.times(&self.motion);
        let forces = self.forces.contact.iter().zip(&closing);
        let opening: Vec<f64> = forces.map(|(&l, &v)| if v < -1e-12 { l } else { 0.0 }).collect();
        let mut load = before.0.clone();
        axpy(-1.0, &self.deck.contact.matrix.transpose_times(&opening), &mut load);
        set_load(&mut self.deck, &load);
        if rigid_norm(&self.deck) < 0.1 * before.1 {
            set_load(&mut self.deck, &before.0);
        }
    }

    /// Adds one row that contradicts one to three contact rows by an amount far above rounding. New rows
    /// carry no force: the load stays held.
    fn contradict(mut self, margins: &Margins, random: &mut Random) -> Case {
        let deck = &mut self.deck;
        let mut weights = vec![0.0; deck.contact.len()];
        for _ in 0..=random.below(3) {
            weights[random.below(deck.contact.len())] = random.between(0.5, 1.5);
        }
        let row = sparse(&deck.contact.matrix.transpose_times(&weights));
        let reach = dot(&weights, &deck.contact.rhs);
        let size = norm_max(&deck.contact.rhs) * (1.0 + weights.iter().sum::<f64>());
        let excess = random.decades(margins.excess[0], margins.excess[1]) * size;
        let mut weights = Multipliers { contact: weights, equalities: vec![0.0; deck.equalities.len()] };
        if random.chance(0.5) {
            let opposite: Vec<_> = row.iter().map(|&(dof, value)| (dof, -value)).collect();
            deck.contact.push(&opposite, -reach - excess);
            weights.contact.push(1.0);
            self.forces.contact.push(0.0);
        } else {
            deck.equalities.push(&row, reach + excess);
            weights.equalities.push(-1.0);
            self.forces.equalities.push(0.0);
        }
        let gaps = [deck.contact.rhs.as_slice(), &deck.equalities.rhs].concat();
        let total = [weights.contact.as_slice(), &weights.equalities].concat();
        let sum: f64 = total.iter().map(|w| w.abs()).sum();
        let margin = -dot(&gaps, &total) / (norm_max(&gaps) * sum);
        let proof = Proof::GapsContradict { forces: self.forces, weights };
        Case { deck: self.deck, proof, margin }
    }
}

/// Two to eight small bodies, and a motion of all bodies above a random interface.
fn random_stack(may_hold: bool, random: &mut Random) -> (Deck, Vec<f64>) {
    let bodies = 2 + random.below(7);
    let flat = random.chance(0.3);
    let mut list =
        |largest: usize| -> Vec<usize> { (0..bodies).map(|_| 1 + random.below(largest)).collect() };
    let stack = Stack {
        bodies,
        in_plane: list(3),
        layers: list(2),
        moduli: (0..bodies).map(|_| random.decades(-4.0, 0.0)).collect(),
        curvature: [random.between(0.3, 1.0), random.between(0.3, 1.0)],
        flat,
        bowl: random.chance(0.5),
        noise: if flat || random.chance(0.5) { 0.0 } else { 0.1 },
        hold: may_hold && random.chance(0.2),
        repeated: random.below(4),
        seed: random.bits(),
        ..Stack::default()
    };
    let deck = stack.build();
    let first = 1 + random.below(bodies - 1);
    let foot = stack.thickness * first as f64;
    let kind = if flat { random.below(3) } else { 0 };
    let motion = motion_above(&deck, first, |[x, _, z]| match kind {
        0 => [0.0, 0.0, 1.0],
        1 => [1.0, 0.0, 0.0],
        _ => [z - foot, 0.0, 1.0 - x],
    });
    (deck, motion)
}

/// A small decomposed body, and its rise off the obstacle.
fn random_cube(may_hold: bool, random: &mut Random) -> (Deck, Vec<f64>) {
    let dimension = 2 + random.below(2);
    let glues = [Glue::NonRedundant, Glue::Orthonormal, Glue::Redundant];
    let cube = Cube {
        dimension,
        subdomains: [2, 1 + random.below(2), 1],
        elements: 1 + random.below(2),
        moduli: Moduli::Checkerboard(random.decades(-4.0, 4.0)),
        glue: glues[random.below(3)],
        clamp: may_hold && random.chance(0.5),
        glue_clamped: random.chance(0.5),
        waves: if random.chance(0.5) { 0.3 } else { 0.0 },
        noise: if random.chance(0.5) { 0.1 } else { 0.0 },
        seed: random.bits(),
        ..Cube::default()
    };
    let deck = cube.build();
    let rise = std::array::from_fn(|axis| f64::from(axis + 1 == dimension));
    let motion = motion_above(&deck, 0, |_| rise);
    (deck, motion)
}

/// The field `motion(x)` on bodies `first`, `first` + 1, ..., zero on those before.
fn motion_above(deck: &Deck, first: usize, motion: impl Fn([f64; 3]) -> [f64; 3]) -> Vec<f64> {
    let mut field = vec![0.0; deck.offset(first)];
    for body in &deck.bodies[first..] {
        let dofs = body.coordinates.iter().zip(&body.direction);
        field.extend(dofs.map(|(&x, &direction)| motion(x)[direction as usize - 1]));
    }
    field
}

/// Repeats a few contact rows times positive factors; their gaps are drawn with all others.
fn add_parallel_rows(deck: &mut Deck, random: &mut Random) {
    for _ in 0..=random.below(5) {
        let factor = random.between(0.5, 2.0);
        let entries = deck.contact.matrix.row(random.below(deck.contact.len()));
        let row: Vec<_> = entries.map(|(dof, value)| (dof, factor * value)).collect();
        deck.contact.push(&row, 0.0);
    }
}

/// Draws a displacement u (zero half of the time) and gaps c = B u + slack, h = H u. Returns u and the
/// smallest slack.
fn open_gaps(deck: &mut Deck, margins: &Margins, random: &mut Random) -> (Vec<f64>, f64) {
    let roughness = if random.chance(0.5) || margins.rough { LENGTH } else { 0.0 };
    let displacement = random.normals(deck.dofs(), roughness);
    let mut smallest = f64::INFINITY;
    deck.contact.rhs = deck.contact.matrix.times(&displacement);
    for gap in &mut deck.contact.rhs {
        let slack = LENGTH * random.decades(margins.slack[0], margins.slack[1]);
        smallest = smallest.min(slack);
        *gap += slack;
    }
    deck.equalities.rhs = deck.equalities.matrix.times(&displacement);
    (displacement, smallest)
}

/// Replaces the load by B'lambda + H'mu + K w, lambda > 0 on every row, w rough: held with certainty.
fn balance_load(deck: &mut Deck, random: &mut Random) -> Multipliers {
    let mut draw =
        |n: usize, low: f64| -> Vec<f64> { (0..n).map(|_| LENGTH * random.between(low, 1.5)).collect() };
    let contact = draw(deck.contact.len(), 0.5);
    let equalities = draw(deck.equalities.len(), -1.5);
    let mut load = deck.contact.matrix.transpose_times(&contact);
    axpy(1.0, &deck.equalities.matrix.transpose_times(&equalities), &mut load);
    for body in 0..deck.bodies.len() {
        let stiffness = &deck.bodies[body].stiffness;
        let rough = random.normals(stiffness.rows, LENGTH);
        let range = deck.offset(body)..deck.offset(body + 1);
        axpy(1.0, &stiffness.times(&rough), &mut load[range]);
    }
    set_load(deck, &load);
    Multipliers { contact, equalities }
}

/// Distributes a load over the bodies.
fn set_load(deck: &mut Deck, load: &[f64]) {
    let mut rest = load;
    for body in &mut deck.bodies {
        let (own, others) = rest.split_at(body.dofs());
        body.load.copy_from_slice(own);
        rest = others;
    }
}

/// D = diag K over all bodies.
fn scaling(deck: &Deck) -> Vec<f64> {
    let diagonals = deck.bodies.iter().map(|body| body.stiffness.diagonal());
    diagonals.flatten().collect()
}

/// |R'f| with R'DR = I, body by body: the part of the load that the rigid modes feel.
fn rigid_norm(deck: &Deck) -> f64 {
    let mut square = 0.0;
    for body in &deck.bodies {
        for mode in orthonormal(body.modes(), &body.stiffness.diagonal()) {
            square += dot(&mode, &body.load).powi(2);
        }
    }
    square.sqrt()
}

/// The span of independent `modes` with R'DR = I: Gram-Schmidt.
fn orthonormal(modes: &[Vec<f64>], diagonal: &[f64]) -> Vec<Vec<f64>> {
    let weighted = |mode: &[f64]| -> Vec<f64> { mode.iter().zip(diagonal).map(|(r, d)| r * d).collect() };
    let mut basis: Vec<Vec<f64>> = Vec::with_capacity(modes.len());
    for mode in modes {
        let mut rest = mode.clone();
        for earlier in &basis {
            axpy(-dot(earlier, &weighted(&rest)), earlier, &mut rest);
        }
        let length = dot(&rest, &weighted(&rest)).sqrt();
        basis.push(rest.iter().map(|value| value / length).collect());
    }
    basis
}

/// The non-zero entries of a dense vector.
fn sparse(values: &[f64]) -> Vec<(usize, f64)> {
    let entries = values.iter().copied().enumerate();
    entries.filter(|entry| entry.1 != 0.0).collect()
}

#[cfg(test)]
mod tests;
