//! Stacked elastic bodies on non-matching grids, joined by node-to-segment rows.

use crate::block::Part;
use crate::random::Random;
use crate::{Block, Deck, Rows};

/// `bodies` unit squares of height `thickness` on top of each other. The lowest is clamped at its bottom;
/// the others float unless `hold`. Lists shorter than `bodies` repeat from their start.
///
/// Each node of the top of a body meets the bilinear segment of the body above: with the outward normal n of
/// the lower body and the weights w of the four corners, n.u_lower - sum w n.u_corner <= gap.
#[derive(Clone, Debug)]
pub struct Stack {
    pub bodies: usize,
    /// Elements along x and along y, per body from the bottom. The patch needs at least 2 on the top body.
    pub in_plane: Vec<usize>,
    /// Elements through the thickness, per body.
    pub layers: Vec<usize>,
    /// Young's modulus per body.
    pub moduli: Vec<f64>,
    /// Height of each body.
    pub thickness: f64,
    /// kappa: how much the normals turn along x and y, no unit. The waves vanish at x = 0, 1/2, 1: on a lower
    /// body of 1 or 2 elements only a bowl or noise resists a slide.
    pub curvature: [f64; 2],
    /// Normals of a bowl, (-kappa_x x, -kappa_y y, 1), instead of the waves sin(2 pi x). No row resists
    /// rolling in a bowl: one under an upper body that floats holds no `tilt` and no load off the axis.
    pub bowl: bool,
    /// Vertical normals and a centred patch pressed straight down.
    pub flat: bool,
    /// Gap at distance r from the axis: 4 gap r^2, length.
    pub gap: f64,
    /// Normal deviates of this size on the normals; a uniform part of 0.3 gap on the gaps when not zero.
    pub noise: f64,
    /// Pressure on the patch of the topmost face.
    pub pressure: f64,
    /// Edge length of the patch.
    pub patch: f64,
    /// Tangential load along x as a part of the pressure; none when `flat`.
    pub tilt: f64,
    /// When not zero, the patch is pulled up by `pull` times the pressure instead of pressed down.
    pub pull: f64,
    /// Every upper body is clamped on its face y = 0: coercive.
    pub hold: bool,
    /// Number of rows that are repeated, at random, with the same gap.
    pub repeated: usize,
    /// Seed of the noise and of the repeated rows.
    pub seed: u64,
}

impl Default for Stack {
    /// Two bodies of 4 x 4 x 2 and 3 x 3 x 2 elements, the upper one floating.
    fn default() -> Stack {
        Stack {
            bodies: 2,
            in_plane: vec![4, 3],
            layers: vec![2],
            moduli: vec![1.0],
            thickness: 0.5,
            curvature: [1.0, 0.5],
            bowl: false,
            flat: false,
            gap: 0.01,
            noise: 0.0,
            pressure: 0.01,
            patch: 0.5,
            tilt: 0.05,
            pull: 0.0,
            hold: false,
            repeated: 0,
            seed: 0,
        }
    }
}

/// A row's geometry: the node of the lower body, the corners above it with their weights, and the normal.
struct Contact {
    node: usize,
    corners: [(usize, f64); 4],
    normal: [f64; 3],
}

impl Stack {
    /// The deck; (in_plane + 1)^2 rows per interface, those of the lower body.
    pub fn build(&self) -> Deck {
        let mut random = Random::new(self.seed);
        let blocks: Vec<Block> = (0..self.bodies).map(|level| self.block(level)).collect();
        let mut parts: Vec<Part> = (0..self.bodies).map(|level| self.part(level, &blocks[level])).collect();
        if let (Some(block), Some(part)) = (blocks.last(), parts.last_mut()) {
            self.press(block, part);
        }
        let bodies = parts.iter().map(|part| part.body.clone()).collect();
        let mut deck = Deck::new(format!("stack_{}", self.bodies), bodies);
        for level in 1..self.bodies {
            let offsets = [deck.offset(level - 1), deck.offset(level)];
            let (lower, upper) = (&blocks[level - 1], &blocks[level]);
            for at in lower.grids().filter(|at| at[2] == lower.elements[2]) {
                let contact = self.contact(lower, upper, at, &mut random);
                let row = row(&contact, [&parts[level - 1], &parts[level]], offsets);
                deck.contact.push(&row, self.gap_at(lower.position(at), &mut random));
            }
        }
        repeat_rows(&mut deck.contact, self.repeated, &mut random);
        deck
    }

    /// The grid of the body at `level`, standing on the one below.
    fn block(&self, level: usize) -> Block {
        let n = self.in_plane[level % self.in_plane.len()];
        Block {
            elements: [n, n, self.layers[level % self.layers.len()]],
            size: [1.0, 1.0, self.thickness],
            origin: [0.0, 0.0, self.thickness * level as f64],
            young: self.moduli[level % self.moduli.len()],
            ..Block::default()
        }
    }

    fn part(&self, level: usize, block: &Block) -> Part {
        block.part(|at| if level == 0 { at[2] == 0 } else { self.hold && at[1] == 0 })
    }

    /// Load on the nodes of the top strictly inside the patch, an area of one element each.
    fn press(&self, block: &Block, part: &mut Part) {
        let centre = if self.flat { [0.5, 0.5] } else { [0.45, 0.55] };
        let area = 1.0 / (block.elements[0] * block.elements[1]) as f64;
        let force = self.pressure * area;
        let tangential = if self.flat { 0.0 } else { self.tilt * force };
        let vertical = if self.pull == 0.0 { -force } else { self.pull * force };
        for at in block.grids().filter(|at| at[2] == block.elements[2]) {
            let position = block.position(at);
            let inside = |axis: usize| (position[axis] - centre[axis]).abs() < self.patch / 2.0 - 1e-9;
            if inside(0) && inside(1) {
                for (direction, value) in [(0, tangential), (2, vertical)] {
                    if let Some(dof) = part.number[3 * block.node(at) + direction] {
                        part.body.load[dof] = value;
                    }
                }
            }
        }
    }

    /// The segment of `upper` above the node `at` of `lower`, by exact integer division.
    fn contact(&self, lower: &Block, upper: &Block, at: [usize; 3], random: &mut Random) -> Contact {
        let (steps, cells) = (lower.elements[0], upper.elements[0]);
        let cell = |axis: usize| (at[axis] * cells / steps).min(cells - 1);
        let local = |axis: usize| (at[axis] * cells - cell(axis) * steps) as f64 / steps as f64;
        let low = [cell(0), cell(1)];
        let corners = std::array::from_fn(|corner| {
            let bit = |axis: usize| corner >> axis & 1;
            let weight = |axis: usize| if bit(axis) == 1 { local(axis) } else { 1.0 - local(axis) };
            let node = upper.node([low[0] + bit(0), low[1] + bit(1), 0]);
            (node, weight(0) * weight(1))
        });
        Contact { node: lower.node(at), corners, normal: self.normal(lower.position(at), random) }
    }

    /// Unit outward normal of the lower body.
    fn normal(&self, position: [f64; 3], random: &mut Random) -> [f64; 3] {
        let (x, y) = (position[0] - 0.5, position[1] - 0.5);
        let [along_x, along_y] = self.curvature;
        let mut normal = if self.flat {
            [0.0, 0.0, 1.0]
        } else if self.bowl {
            [-along_x * x, -along_y * y, 1.0]
        } else {
            [-0.3 * along_x * sine_of_turns(x), -0.4 * along_y * sine_of_turns(y), 1.0]
        };
        if self.noise != 0.0 {
            normal[0] += self.noise * random.normal();
            normal[1] += self.noise * random.normal();
        }
        unit(normal)
    }

    fn gap_at(&self, position: [f64; 3], random: &mut Random) -> f64 {
        let (x, y) = (position[0] - 0.5, position[1] - 0.5);
        let smooth = 4.0 * self.gap * (x * x + y * y);
        if self.noise == 0.0 {
            smooth
        } else {
            smooth + 0.3 * self.gap * random.uniform()
        }
    }
}

/// Entries of one row over the concatenated dofs; clamped dofs drop out.
fn row(contact: &Contact, parts: [&Part; 2], offsets: [usize; 2]) -> Vec<(usize, f64)> {
    let mut entries = Vec::with_capacity(15);
    for (axis, component) in contact.normal.iter().enumerate() {
        let mut add = |side: usize, node: usize, weight: f64| {
            if let Some(dof) = parts[side].number[3 * node + axis] {
                entries.push((offsets[side] + dof, weight * component));
            }
        };
        add(0, contact.node, 1.0);
        contact.corners.iter().for_each(|&(node, weight)| add(1, node, -weight));
    }
    entries
}

/// Appends exact copies of `count` rows chosen at random among those present.
fn repeat_rows(rows: &mut Rows, count: usize, random: &mut Random) {
    let present = rows.len();
    for _ in 0..count {
        let chosen = random.below(present);
        let entries: Vec<_> = rows.matrix.row(chosen).collect();
        rows.push(&entries, rows.rhs[chosen]);
    }
}

/// n / |n|.
pub(crate) fn unit(normal: [f64; 3]) -> [f64; 3] {
    let length = normal.iter().map(|x| x * x).sum::<f64>().sqrt();
    normal.map(|x| x / length)
}

/// sin(2 pi t), exactly 0 at multiples of a half turn: no entries of size 1e-17 in a row.
pub(crate) fn sine_of_turns(t: f64) -> f64 {
    let part = t - t.round();
    let folded = if part.abs() > 0.25 { 0.5f64.copysign(part) - part } else { part };
    (std::f64::consts::TAU * folded).sin()
}

#[cfg(test)]
mod tests {
    use super::{sine_of_turns, Stack};
    use crate::vector::{dot, norm_max};
    use crate::Deck;

    /// A uniform displacement of all bodies.
    fn translation(deck: &Deck, shift: [f64; 3]) -> Vec<f64> {
        let directions = deck.bodies.iter().flat_map(|body| &body.direction);
        directions.map(|&direction| shift[direction as usize - 1]).collect()
    }

    fn uneven() -> Stack {
        Stack { bodies: 3, in_plane: vec![4, 3, 5], layers: vec![1, 2], noise: 0.1, ..Stack::default() }
    }

    #[test]
    fn segment_weights_sum_to_the_normal() {
        let deck = uneven().build();
        for axis in 0..3 {
            let mut shift = [0.0; 3];
            shift[axis] = 1.0;
            assert!(norm_max(&deck.contact.matrix.times(&translation(&deck, shift))) < 1e-15);
        }
        let lower = deck.offset(1);
        for row in 0..25 {
            let part = |upper: bool| -> Vec<f64> {
                let entries = deck.contact.matrix.row(row);
                entries.filter(|entry| (entry.0 >= lower) == upper).map(|entry| entry.1).collect()
            };
            let normal = part(false);
            assert!((dot(&normal, &normal) - 1.0).abs() < 1e-14);
            assert!((part(true).iter().sum::<f64>() + normal.iter().sum::<f64>()).abs() < 1e-14);
        }
    }

    /// u = A x for any matrix A leaves no jump: bilinear segments reproduce it at every node below.
    #[test]
    fn linear_displacement_opens_no_gap() {
        let deck = uneven().build();
        let positions = deck.bodies.iter().flat_map(|body| &body.coordinates);
        let directions = deck.bodies.iter().flat_map(|body| &body.direction);
        let field = |(x, &axis): (&[f64; 3], &i32)| {
            let coefficients = [[0.3, -1.0, 2.0], [0.7, 0.1, -0.4], [-0.2, 0.9, 0.5]];
            dot(&coefficients[axis as usize - 1], x)
        };
        let linear: Vec<f64> = positions.zip(directions).map(field).collect();
        assert!(norm_max(&deck.contact.matrix.times(&linear)) < 1e-14);
    }

    #[test]
    fn rows_are_those_of_the_lower_bodies_plus_the_repeated_ones() {
        let deck = Stack { repeated: 7, ..uneven() }.build();
        assert_eq!(deck.contact.len(), 5 * 5 + 4 * 4 + 7);
        for copy in deck.contact.len() - 7..deck.contact.len() {
            let wanted: Vec<_> = deck.contact.matrix.row(copy).collect();
            let twin = (0..deck.contact.len() - 7)
                .find(|&row| deck.contact.matrix.row(row).eq(wanted.iter().copied()));
            assert_eq!(deck.contact.rhs[copy], deck.contact.rhs[twin.expect("the row it repeats")]);
        }
    }

    #[test]
    fn hold_leaves_no_floating_body() {
        let floating =
            |stack: Stack| stack.build().bodies.iter().filter(|body| !body.modes().is_empty()).count();
        assert_eq!(floating(uneven()), 2);
        assert_eq!(floating(Stack { hold: true, ..uneven() }), 0);
    }

    #[test]
    fn pull_turns_the_load_of_the_patch_upwards() {
        let vertical = |stack: Stack| -> f64 {
            let deck = stack.build();
            dot(&translation(&deck, [0.0, 0.0, 1.0]), &deck.load())
        };
        let pressed = vertical(Stack { flat: true, ..Stack::default() });
        assert!(pressed < 0.0);
        let pulled = vertical(Stack { flat: true, pull: 0.5, ..Stack::default() });
        assert!((pulled + pressed / 2.0).abs() < 1e-16);
    }

    #[test]
    fn flat_rows_touch_vertical_dofs_only() {
        let deck = Stack { flat: true, ..Stack::default() }.build();
        let vertical = translation(&deck, [0.0, 0.0, 1.0]);
        assert!(deck.contact.matrix.col.iter().all(|&dof| vertical[dof] == 1.0));
    }

    #[test]
    fn same_seed_gives_the_same_bits_and_another_seed_others() {
        let build = |seed: u64| Stack { seed, ..uneven() }.build().contact;
        assert_eq!(build(3).matrix, build(3).matrix);
        assert_eq!(build(3).rhs, build(3).rhs);
        assert_ne!(build(3).matrix, build(4).matrix);
    }

    #[test]
    fn sine_of_turns_is_the_sine_and_vanishes_at_half_turns() {
        for t in [-1.3, -0.4, -0.1, 0.0, 0.2, 0.45, 0.8, 2.6] {
            assert!((sine_of_turns(t) - (std::f64::consts::TAU * t).sin()).abs() < 1e-14);
        }
        assert_eq!([-0.5, 0.0, 0.5, 1.0].map(sine_of_turns), [0.0; 4]);
    }
}
