//! An elastic body cut into subdomains, glued by equality rows, on a rigid obstacle.

use std::collections::BTreeMap;

use crate::random::Random;
use crate::stack::{sine_of_turns, unit};
use crate::{Block, Deck};

/// How the copies of a node that k subdomains share are glued, per direction.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Glue {
    /// k - 1 rows, each copy minus the next one.
    NonRedundant,
    /// k - 1 orthonormal rows.
    Orthonormal,
    /// All k (k - 1) / 2 differences: the rows depend on each other where k > 2.
    Redundant,
}

/// Young's modulus of the subdomain at grid position s.
#[derive(Clone, Debug, PartialEq)]
pub enum Moduli {
    /// 1 everywhere.
    Uniform,
    /// 1 where the sum of s is even, else the given value.
    Checkerboard(f64),
    /// Layers along the last axis: 1 where the last entry of s is even, else the given value.
    Layers(f64),
    /// One per subdomain, x first.
    Given(Vec<f64>),
}

/// A body of subdomains[0] x ... unit squares (plane strain) or cubes of elements^dimension elements each.
/// Its face with the last coordinate 0 stands on an obstacle; pressure acts on the middle (0.3 of the length
/// to each side) of the opposite face. Every subdomain floats: a clamp enters as equality rows u = 0.
#[derive(Clone, Debug)]
pub struct Cube {
    /// 2 or 3.
    pub dimension: usize,
    /// Subdomains along each axis; entries from `dimension` on are ignored.
    pub subdomains: [usize; 3],
    /// H/h, elements along the edge of a subdomain.
    pub elements: usize,
    pub moduli: Moduli,
    pub glue: Glue,
    /// u = 0 on the face x = 0, whose nodes are then not glued and have no contact row.
    pub clamp: bool,
    /// Clamped nodes are glued as well: dependent equality rows.
    pub glue_clamped: bool,
    /// Gap at the relative distance xi (last axis left out) from the middle: 4 gap |xi|^2 / (dimension - 1).
    pub gap: f64,
    /// Added to every gap, length.
    pub gap_offset: f64,
    /// Every gap is -gap/1000: all rows close.
    pub all_closed: bool,
    /// Thickness of an elastic layer of Young's modulus 1 on the obstacle, length: the contact row of a node whose
    /// share of the face is a is a spring k = a / layer. 0: none, the rows are rigid.
    pub layer: f64,
    /// Amplitude of the waves of the normals, no unit.
    pub waves: f64,
    /// Normal deviates of this size on the normals; a uniform part of 0.3 gap on the gaps when not zero.
    pub noise: f64,
    pub pressure: f64,
    /// Body force towards the obstacle, force per volume.
    pub weight: f64,
    pub seed: u64,
}

impl Default for Cube {
    /// 2 x 2 x 2 subdomains of 2 x 2 x 2 elements, clamped at x = 0.
    fn default() -> Cube {
        Cube {
            dimension: 3,
            subdomains: [2; 3],
            elements: 2,
            moduli: Moduli::Uniform,
            glue: Glue::NonRedundant,
            clamp: true,
            glue_clamped: false,
            gap: 0.02,
            gap_offset: 0.0,
            all_closed: false,
            layer: 0.0,
            waves: 0.0,
            noise: 0.0,
            pressure: 0.01,
            weight: 0.0,
            seed: 0,
        }
    }
}

/// The subdomain and node of each copy of a node of the whole body, keyed by (z, y, x): x varies fastest.
type Copies = BTreeMap<[usize; 3], Vec<(usize, usize)>>;

impl Cube {
    /// The deck. Equalities: gluing, node by node of the whole body, then the clamp.
    pub fn build(&self) -> Deck {
        let places = self.places();
        let blocks: Vec<Block> =
            (places.iter().enumerate()).map(|(index, place)| self.block(index, place)).collect();
        let mut bodies = Vec::with_capacity(blocks.len());
        for (block, place) in blocks.iter().zip(&places) {
            let mut body = block.floating().body;
            self.load(block, place, &mut body.load);
            bodies.push(body);
        }
        let name = format!("cube_{}d_{}_{}", self.dimension, places.len(), self.elements);
        let mut deck = Deck::new(name, bodies);
        let copies = self.copies(&blocks, &places);
        self.add_gluing(&mut deck, &copies);
        if self.clamp {
            self.add_clamp(&mut deck, &copies);
        }
        self.add_contact(&mut deck, &copies);
        deck
    }

    /// Subdomains along `axis`, 1 along an axis the body does not have.
    fn along(&self, axis: usize) -> usize {
        if axis < self.dimension {
            self.subdomains[axis]
        } else {
            1
        }
    }

    /// Grid positions of the subdomains, x first.
    fn places(&self) -> Vec<[usize; 3]> {
        let [nx, ny, nz] = [0, 1, 2].map(|axis| self.along(axis));
        (0..nx * ny * nz).map(|s| [s % nx, s / nx % ny, s / (nx * ny)]).collect()
    }

    fn block(&self, index: usize, place: &[usize; 3]) -> Block {
        let odd = |number: usize| number % 2 == 1;
        let young = match &self.moduli {
            Moduli::Checkerboard(value) if odd(place.iter().sum()) => *value,
            Moduli::Layers(value) if odd(place[self.dimension - 1]) => *value,
            Moduli::Given(values) => values[index],
            _ => 1.0,
        };
        Block {
            dimension: self.dimension,
            elements: [self.elements; 3],
            origin: place.map(|step| step as f64),
            young,
            ..Block::default()
        }
    }

    /// Grid position in the whole body of the node `at` of the subdomain at `place`.
    fn global(&self, at: [usize; 3], place: &[usize; 3]) -> [usize; 3] {
        std::array::from_fn(|axis| place[axis] * self.elements + at[axis])
    }

    fn copies(&self, blocks: &[Block], places: &[[usize; 3]]) -> Copies {
        let mut copies = Copies::new();
        for (index, (block, place)) in blocks.iter().zip(places).enumerate() {
            for (node, at) in block.grids().enumerate() {
                let [x, y, z] = self.global(at, place);
                copies.entry([z, y, x]).or_default().push((index, node));
            }
        }
        copies
    }

    /// Pressure and weight of one subdomain; a node's share is h per axis, half of it at the subdomain's rim.
    fn load(&self, block: &Block, place: &[usize; 3], load: &mut [f64]) {
        let (n, last) = (self.elements, self.dimension - 1);
        for (node, at) in block.grids().enumerate() {
            let share = |axis: usize| if at[axis] == 0 || at[axis] == n { 0.5 } else { 1.0 } / n as f64;
            let area: f64 = (0..last).map(share).product();
            let global = self.global(at, place);
            let mut force = self.weight * area * share(last);
            if global[last] == self.along(last) * n && (0..last).all(|axis| self.is_middle(global, axis)) {
                force += self.pressure * area;
            }
            load[self.dimension * node + last] -= force;
        }
    }

    /// |x - L/2| <= 0.3 L along `axis`, in integers.
    fn is_middle(&self, global: [usize; 3], axis: usize) -> bool {
        let length = self.along(axis) * self.elements;
        5 * (2 * global[axis]).abs_diff(length) <= 3 * length
    }

    /// Concatenated dof of a direction of a copy; all subdomains have the same size.
    fn dof(&self, copy: (usize, usize), direction: usize) -> usize {
        let nodes = (self.elements + 1).pow(self.dimension as u32);
        self.dimension * (copy.0 * nodes + copy.1) + direction
    }

    fn add_gluing(&self, deck: &mut Deck, copies: &Copies) {
        for (&[_, _, x], shared) in copies {
            if self.clamp && !self.glue_clamped && x == 0 {
                continue;
            }
            for pattern in self.glue.patterns(shared.len()) {
                for direction in 0..self.dimension {
                    let entry = |&(copy, value): &(usize, f64)| (self.dof(shared[copy], direction), value);
                    let row: Vec<_> = pattern.iter().map(entry).collect();
                    deck.equalities.push(&row, 0.0);
                }
            }
        }
    }

    fn add_clamp(&self, deck: &mut Deck, copies: &Copies) {
        let held = copies.iter().filter(|(at, _)| at[2] == 0);
        for &copy in held.flat_map(|(_, shared)| shared) {
            for direction in 0..self.dimension {
                deck.equalities.push(&[(self.dof(copy, direction), 1.0)], 0.0);
            }
        }
    }

    /// One row n.u <= gap per node of the whole body on the obstacle, on its first copy.
    fn add_contact(&self, deck: &mut Deck, copies: &Copies) {
        let mut random = Random::new(self.seed);
        for (&[z, y, x], shared) in copies {
            let global = [x, y, z];
            if global[self.dimension - 1] != 0 || (self.clamp && x == 0) {
                continue;
            }
            let relative: Vec<f64> = (0..self.dimension - 1)
                .map(|axis| global[axis] as f64 / (self.along(axis) * self.elements) as f64 - 0.5)
                .collect();
            let normal = self.normal(&relative, &mut random);
            let entry = |axis: usize| (self.dof(shared[0], axis), normal[axis]);
            let row: Vec<_> = (0..self.dimension).map(entry).collect();
            let gap = self.gap_at(&relative, &mut random);
            deck.contact.push_compliant(&row, gap, self.layer / self.area(global));
        }
    }

    /// Share of the contact face of a node, half as long on its rim.
    fn area(&self, global: [usize; 3]) -> f64 {
        let rim = |axis: usize| [0, self.along(axis) * self.elements].contains(&global[axis]);
        let length = |axis: usize| if rim(axis) { 0.5 } else { 1.0 } / self.elements as f64;
        (0..self.dimension - 1).map(length).product()
    }

    /// Unit outward normal of the body, minus the last axis where there are neither waves nor noise.
    fn normal(&self, relative: &[f64], random: &mut Random) -> [f64; 3] {
        let mut normal = [0.0; 3];
        normal[self.dimension - 1] = -1.0;
        for (axis, xi) in relative.iter().enumerate() {
            normal[axis] += self.waves * sine_of_turns(xi * (1.0 + 0.3 * axis as f64));
            if self.noise != 0.0 {
                normal[axis] += self.noise * random.normal();
            }
        }
        if self.dimension == 3 {
            normal[0] += 0.7 * self.waves * relative[1];
        }
        unit(normal)
    }

    fn gap_at(&self, relative: &[f64], random: &mut Random) -> f64 {
        if self.all_closed {
            return -1e-3 * self.gap;
        }
        let distance2: f64 = relative.iter().map(|xi| xi * xi).sum();
        let smooth = 4.0 * self.gap * distance2 / relative.len() as f64 + self.gap_offset;
        if self.noise == 0.0 {
            smooth
        } else {
            smooth + 0.3 * self.gap * random.uniform()
        }
    }
}

impl Glue {
    /// Rows (copy, coefficient) that force k values to be equal.
    fn patterns(self, k: usize) -> Vec<Vec<(usize, f64)>> {
        match self {
            Glue::NonRedundant => (1..k).map(|q| vec![(q - 1, 1.0), (q, -1.0)]).collect(),
            Glue::Orthonormal => (1..k).map(mean_minus_value).collect(),
            Glue::Redundant => {
                (0..k).flat_map(|a| (a + 1..k).map(move |b| vec![(a, 1.0), (b, -1.0)])).collect()
            }
        }
    }
}

/// (u_0 + ... + u_(q-1) - q u_q) / sqrt(q (q + 1)): orthonormal for q = 1, 2, ...
fn mean_minus_value(q: usize) -> Vec<(usize, f64)> {
    let length = ((q * (q + 1)) as f64).sqrt();
    let mut row: Vec<_> = (0..q).map(|copy| (copy, 1.0 / length)).collect();
    row.push((q, -(q as f64) / length));
    row
}

#[cfg(test)]
mod tests;
