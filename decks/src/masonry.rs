//! Many loose bodies: rectangular blocks on a common grid that touch without friction, under their own weight. All normals are
//! horizontal or vertical, so that most blocks may slide somewhere.

use std::collections::BTreeMap;

use crate::random::Random;
use crate::{Block, Deck};

/// Length and height of one element.
const EDGE: f64 = 0.5;
/// Weight per area against Young's modulus.
const WEIGHT: f64 = 1e-4;

/// A block of `size` elements with its lowest corner at the grid position `at`.
#[derive(Clone, Copy, Debug)]
struct Stone {
    at: [usize; 2],
    size: [usize; 2],
    /// Added to all gaps below it, length.
    lifted: f64,
}

/// How the stones meet.
#[derive(Clone, Copy, Debug)]
struct Joints {
    /// Gaps of contact rows: uniform in [0, scatter), length.
    scatter: f64,
    /// Stones that stand on each other are glued, both displacements of each pair of nodes.
    glued: bool,
    /// Part of the contact rows that are there twice.
    repeated: f64,
    seed: u64,
}

impl Default for Joints {
    fn default() -> Self {
        Self { scatter: 0.0, glued: false, repeated: 0.0, seed: 1 }
    }
}

/// `blocks` equal blocks of 3 x 3 elements (32 unknowns) on top of each other, 4 rows for each joint and 4 for the corners of
/// each block between two walls that are 1e-3 away.
pub fn tower(blocks: usize) -> Deck {
    let stones = column(blocks);
    let mut deck = deck(format!("tower_{blocks}"), &stones, Joints::default());
    for (p, stone) in stones.iter().enumerate() {
        let grid = stone.block();
        let corner = |x: usize, y: usize| 2 * (16 * p + grid.node([x, y, 0]));
        for y in [0, 3] {
            deck.contact.push(&[(corner(0, y), -1.0)], 1e-3);
            deck.contact.push(&[(corner(3, y), 1.0)], 1e-3);
        }
    }
    deck
}

/// The blocks of [`tower`] glued to each other, without walls: a column that may slide on the ground.
pub fn chain(blocks: usize) -> Deck {
    deck(format!("chain_{blocks}"), &column(blocks), Joints { glued: true, ..Joints::default() })
}

fn column(blocks: usize) -> Vec<Stone> {
    (0..blocks).map(|level| Stone { at: [0, 3 * level], size: [3, 3], lifted: 0.0 }).collect()
}

/// `n` courses of `n` bricks of 4 x 2 elements, every other course shifted by a quarter of a brick; gaps are uniform in
/// [0, scatter).
pub fn wall(n: usize, scatter: f64) -> Deck {
    let brick = |k: usize| Stone { at: [4 * (k % n) + k / n % 2, 2 * (k / n)], size: [4, 2], lifted: 0.0 };
    let stones: Vec<Stone> = (0..n * n).map(brick).collect();
    deck(format!("wall_{n}"), &stones, Joints { scatter, ..Joints::default() })
}

/// `blocks` blocks of 2 to 5 x 1 to 3 elements thrown on each other so that both ends of each have something below them; a
/// tenth of the rows twice, one in twenty blocks with gaps of its own length below.
pub fn heap(blocks: usize, seed: u64) -> Deck {
    let mut random = Random::new(seed);
    let width = 4 * (blocks as f64).sqrt() as usize + 6;
    let (mut top, mut stones) = (vec![0; width], Vec::new());
    while stones.len() < blocks {
        let mut place = || {
            let size = [2 + random.below(4), 1 + random.below(3)];
            let x = random.below(width - size[0] + 1);
            let y = top[x..x + size[0]].iter().copied().max().unwrap_or(0);
            (y, x, size)
        };
        // the lowest of some places
        let tried: Vec<_> = (0..width).map(|_| place()).collect();
        let supported = |&(y, x, size): &(usize, usize, [usize; 2])| top[x] == y && top[x + size[0] - 1] == y;
        let Some((y, x, size)) = tried.into_iter().filter(supported).min() else { continue };
        top[x..x + size[0]].fill(y + size[1]);
        let lifted = if random.chance(0.05) { EDGE * size[0] as f64 } else { 0.0 };
        stones.push(Stone { at: [x, y], size, lifted });
    }
    deck(
        format!("heap_{blocks}"),
        &stones,
        Joints { scatter: 1e-4, repeated: 0.1, seed, ..Joints::default() },
    )
}

/// `blocks` blocks side by side, two elements apart, each on the ground alone.
pub fn apart(blocks: usize) -> Deck {
    let stone = |k: usize| Stone { at: [5 * k, 0], size: [3, 3], lifted: 0.0 };
    let stones: Vec<Stone> = (0..blocks).map(stone).collect();
    deck(format!("apart_{blocks}"), &stones, Joints { scatter: 1e-4, ..Joints::default() })
}

impl Stone {
    fn block(&self) -> Block {
        Block {
            dimension: 2,
            elements: [self.size[0], self.size[1], 1],
            size: [EDGE * self.size[0] as f64, EDGE * self.size[1] as f64, 1.0],
            origin: [EDGE * self.at[0] as f64, EDGE * self.at[1] as f64, 0.0],
            ..Block::default()
        }
    }
}

/// Nodes on one side of all stones by their place and the element along that side: first unknown and stone.
type Side = BTreeMap<([usize; 2], usize), (usize, usize)>;

/// The sides of all stones at their low (`end` = 0) or high (1) end along `axis`.
fn side(stones: &[Stone], axis: usize, end: usize) -> Side {
    let (mut side, mut first) = (Side::new(), 0);
    for (k, stone) in stones.iter().enumerate() {
        let block = stone.block();
        for (node, at) in block.grids().enumerate().filter(|(_, at)| at[axis] == end * stone.size[axis]) {
            let place = [stone.at[0] + at[0], stone.at[1] + at[1]];
            let along = 1 - axis;
            let elements = [at[along].checked_sub(1), (at[along] < stone.size[along]).then_some(at[along])];
            for element in elements.into_iter().flatten() {
                side.insert((place, stone.at[along] + element), (first + 2 * node, k));
            }
        }
        first += 2 * block.nodes();
    }
    side
}

/// Stones with their weight, one row per pair of nodes that face each other or the ground.
fn deck(name: String, stones: &[Stone], joints: Joints) -> Deck {
    let blocks: Vec<Block> = stones.iter().map(Stone::block).collect();
    let bodies = blocks.iter().map(|block| {
        let mut body = block.floating().body;
        for (node, at) in block.grids().enumerate() {
            let share =
                |axis: usize| if at[axis] == 0 || at[axis] == block.elements[axis] { 0.5 } else { 1.0 };
            body.load[2 * node + 1] = -WEIGHT * EDGE * EDGE * share(0) * share(1);
        }
        body
    });
    let mut deck = Deck::new(name, bodies.collect());
    let mut random = Random::new(joints.seed);
    for (axis, is_bed) in [(1, true), (0, false)] {
        let behind = side(stones, axis, 1);
        let mut pairs = BTreeMap::new();
        for (place, &(above, k)) in &side(stones, axis, 0) {
            if behind.contains_key(place) || (is_bed && place.0[1] == 0) {
                pairs.insert((above, behind.get(place).map(|below| below.0)), k);
            }
        }
        for ((above, below), k) in pairs {
            let gap = joints.scatter * random.uniform() + if is_bed { stones[k].lifted } else { 0.0 };
            let times = 1 + usize::from(random.chance(joints.repeated));
            match below {
                Some(below) if joints.glued => (0..2).for_each(|direction| {
                    deck.equalities.push(&[(below + direction, 1.0), (above + direction, -1.0)], 0.0);
                }),
                Some(below) => (0..times)
                    .for_each(|_| deck.contact.push(&[(below + axis, 1.0), (above + axis, -1.0)], gap)),
                None => deck.contact.push(&[(above + axis, -1.0)], gap),
            }
        }
    }
    deck
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_tower_has_8_rows_a_block_and_a_wall_rows_for_every_joint() {
        let tower = tower(5);
        assert_eq!((tower.dofs(), tower.contact.len()), (160, 40));
        let chain = chain(5);
        assert_eq!((chain.equalities.len(), chain.contact.len()), (4 * 8, 4));
        let wall = wall(4, 0.0);
        assert_eq!(wall.bodies.len(), 16);
        assert!(wall.contact.len() > 16 * 5 && wall.contact.matrix.is_sorted());
    }

    #[test]
    fn a_heap_has_its_blocks_and_is_the_one_of_its_seed() {
        let (one, other) = (heap(60, 3), heap(60, 3));
        assert_eq!(one.bodies.len(), 60);
        assert_eq!(one.contact.rhs, other.contact.rhs);
        assert!(heap(60, 4).contact.rhs != one.contact.rhs);
    }
}
