//! The two blocks of [`crate::Blocks`] cut into glued pieces, no two alike.

use std::collections::BTreeMap;

use crate::block::Part;
use crate::random::Random;
use crate::{Block, Deck};

/// Two unit cubes on top of each other, each cut into `pieces`^3 pieces of `elements`^3 elements. The lower one is clamped at its
/// bottom, the upper one is pressed down on its top; normals are vertical.
#[derive(Clone, Copy, Debug)]
pub struct Pieces {
    pub pieces: usize,
    pub elements: usize,
    /// The upper block is clamped on its face y = 0; else it may slide.
    pub held: bool,
}

/// The pieces that share a node of one block: first unknown, if it is not clamped.
type Copies = BTreeMap<[usize; 3], Vec<usize>>;

impl Pieces {
    /// The deck: glue of the lower, then of the upper block; one contact row for each pair of facing nodes.
    pub fn build(&self) -> Deck {
        let mut random = Random::new(7);
        let (mut bodies, mut first) = (Vec::new(), 0);
        let [lower, upper] = [0, 1].map(|level| {
            let mut copies = Copies::new();
            for k in 0..self.pieces.pow(3) {
                let place = [k % self.pieces, k / self.pieces % self.pieces, k / self.pieces.pow(2)];
                let (block, mut part) = self.part(level, place, &mut random);
                for (node, at) in block.grids().enumerate() {
                    let global = std::array::from_fn(|axis| place[axis] * self.elements + at[axis]);
                    if let Some(dof) = part.number[3 * node] {
                        copies.entry(global).or_default().push(first + dof);
                        let is_top = level == 1 && global[2] == self.along();
                        part.body.load[dof + 2] -= if is_top { self.pressure(at) } else { 0.0 };
                    }
                }
                first += part.body.dofs();
                bodies.push(part.body);
            }
            copies
        });
        let mut deck = Deck::new(format!("pieces_{}_{}", 2 * self.pieces.pow(3), self.elements), bodies);
        for pair in lower.values().chain(upper.values()).flat_map(|shared| shared.windows(2)) {
            for axis in 0..3 {
                deck.equalities.push(&[(pair[0] + axis, 1.0), (pair[1] + axis, -1.0)], 0.0);
            }
        }
        for (&[x, y, z], above) in upper.iter().filter(|(at, _)| at[2] == 0) {
            let below = lower[&[x, y, z + self.along()]][0] + 2;
            let middle = |x: usize| (x as f64 / self.along() as f64 - 0.5).powi(2);
            deck.contact.push(&[(below, 1.0), (above[0] + 2, -1.0)], 0.02 * (middle(x) + middle(y)));
        }
        deck
    }

    /// Elements along an edge of a block.
    fn along(&self) -> usize {
        self.pieces * self.elements
    }

    fn part(&self, level: usize, place: [usize; 3], random: &mut Random) -> (Block, Part) {
        let edge = 1.0 / self.pieces as f64;
        let mut origin = place.map(|step| step as f64 * edge);
        origin[2] += level as f64;
        let young = random.between(0.5, 1.5) * (level + 1) as f64;
        let block =
            Block { elements: [self.elements; 3], size: [edge; 3], origin, young, ..Block::default() };
        let part = match (level, self.held) {
            (0, _) if place[2] == 0 => block.part(|at| at[2] == 0),
            (1, true) if place[1] == 0 => block.part(|at| at[1] == 0),
            _ => block.floating(),
        };
        (block, part)
    }

    /// Force on the copy of a node of the top: pressure .01 over its share of the faces of its piece.
    fn pressure(&self, at: [usize; 3]) -> f64 {
        let share = |a: usize| if a == 0 || a == self.elements { 0.5 } else { 1.0 } / self.along() as f64;
        0.01 * share(at[0]) * share(at[1])
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn pieces_have_the_nodes_of_the_whole_and_its_load() {
        let deck = Pieces { pieces: 2, elements: 2, held: false }.build();
        assert_eq!((deck.bodies.len(), deck.contact.len()), (16, 25));
        let distinct = 3 * (deck.dofs() / 3 - deck.equalities.len() / 3);
        assert_eq!(distinct, 3 * (5 * 5 * 4 + 5 * 5 * 5));
        assert!((deck.load().iter().sum::<f64>() + 0.01).abs() < 1e-15);
        assert!(deck.bodies[15].null_space.is_some() && deck.bodies[0].null_space.is_none());
    }
}
