//! The benchmark: two stacked elastic blocks on matching grids, about half of the interface in contact.

use crate::block::Part;
use crate::random::Random;
use crate::{Block, ByElements, Deck, Elements};

/// Unit cubes of elements^3 hexahedra, nu = 0.3. The lower one (modulus E) is clamped at its bottom, its
/// clamped dofs eliminated; the upper one (2 E) floats and is pressed down on a patch of its top. All
/// normals are vertical: the two slides and the spin of the upper block touch no row.
#[derive(Clone, Debug)]
pub struct Blocks {
    /// Elements along each edge: 12, 18 and 28 give 12 675, 40 071 and 143 811 unknowns. At least 2.
    pub elements: usize,
    /// E, Young's modulus of the lower block.
    pub young: f64,
}

impl Default for Blocks {
    fn default() -> Blocks {
        Blocks { elements: 6, young: 1.0 }
    }
}

impl Blocks {
    /// The deck: one row u_lower - u_upper <= 0.02 r^2 (vertical, r from the axis) for each of the
    /// (elements + 1)^2 pairs of facing nodes.
    pub fn build(&self) -> Deck {
        Deck { name: format!("blocks_{}", self.elements), ..self.layered(self.elements) }
    }

    /// The same of flat blocks, `layers` layers of cubic elements each: one row for 3 (2 layers + 1) unknowns. At
    /// least 1.
    pub fn layered(&self, layers: usize) -> Deck {
        self.deck(layers, &self.blocks(layers))
    }

    /// The cubes with the modulus of every element multiplied by 1 + `variation` (uniform - 1/2).
    pub fn varied(&self, variation: f64, seed: u64) -> Deck {
        self.deck(self.elements, &self.varied_blocks(variation, seed))
    }

    /// [`Blocks::varied`] by its elements: the same problem, and the same K to the last bit once they are added up.
    pub fn varied_by_elements(&self, variation: f64, seed: u64) -> ByElements {
        let blocks = self.varied_blocks(variation, seed);
        let parts = [blocks[0].outline(is_clamped), blocks[1].outline(|_| false)];
        let numbers = parts.each_ref().map(|part| part.number.clone());
        let deck = self.join(self.elements, &blocks, parts);
        let bodies = blocks.into_iter().zip(numbers).map(|(block, number)| Elements::new(block, number));
        ByElements { deck, bodies: bodies.collect() }
    }

    /// Lower and upper block of [`Blocks::varied`].
    pub fn varied_blocks(&self, variation: f64, seed: u64) -> [Block; 2] {
        let mut random = Random::new(seed);
        self.blocks(self.elements).map(|block| {
            let factors = (0..block.volume()).map(|_| 1.0 + variation * (random.uniform() - 0.5)).collect();
            Block { factors, ..block }
        })
    }

    fn blocks(&self, layers: usize) -> [Block; 2] {
        let n = self.elements;
        let height = layers as f64 / n as f64;
        [0, 1].map(|level: usize| Block {
            elements: [n, n, layers],
            size: [1.0, 1.0, height],
            origin: [0.0, 0.0, level as f64 * height],
            young: self.young * (level + 1) as f64,
            ..Block::default()
        })
    }

    fn deck(&self, layers: usize, blocks: &[Block; 2]) -> Deck {
        self.join(layers, blocks, [blocks[0].part(is_clamped), blocks[1].floating()])
    }

    /// The bodies with load and rows.
    fn join(&self, layers: usize, [lower, upper]: &[Block; 2], [bottom, mut top]: [Part; 2]) -> Deck {
        let n = self.elements;
        self.press(upper, &mut top.body.load);
        let mut deck = Deck::new(format!("blocks_{n}_{layers}"), vec![bottom.body, top.body]);
        let offset = deck.offset(1);
        for at in upper.grids().filter(|at| at[2] == 0) {
            let below = bottom.number[3 * lower.node([at[0], at[1], layers]) + 2];
            let above = offset + 3 * upper.node(at) + 2;
            let [x, y, _] = upper.position(at);
            let gap = 0.02 * ((x - 0.5).powi(2) + (y - 0.5).powi(2));
            // (5): (u_lower - u_upper)'n <= gap, n the outer normal of the lower block
            let below = below.expect("the top of the lower block is free");
            deck.contact.push(&[(below, 1.0), (above, -1.0)], gap);
        }
        deck
    }

    /// Pressure 0.01 E (1 + x) on the patch (0.1, 0.6)^2 of the top: h^2 times its value at each node inside.
    fn press(&self, block: &Block, load: &mut [f64]) {
        let area = 1.0 / (self.elements * self.elements) as f64;
        let inside = |t: f64| t > 0.1 + 1e-9 && t < 0.6 - 1e-9;
        for at in block.grids().filter(|at| at[2] == block.elements[2]) {
            let [x, y, _] = block.position(at);
            if inside(x) && inside(y) {
                load[3 * block.node(at) + 2] = -0.01 * self.young * (1.0 + x) * area;
            }
        }
    }
}

/// The bottom of the lower block.
fn is_clamped(at: [usize; 3]) -> bool {
    at[2] == 0
}

#[cfg(test)]
mod tests {
    use super::Blocks;
    use crate::Deck;

    #[test]
    fn benchmark_sizes_are_13k_40k_and_144k() {
        let unknowns = |n: usize| 3 * (n + 1) * (n + 1) * (2 * n + 1);
        assert_eq!([12, 18, 28].map(unknowns), [12_675, 40_071, 143_811]);
        let deck = Blocks { elements: 4, ..Blocks::default() }.build();
        assert_eq!(deck.dofs(), unknowns(4));
        assert_eq!(deck.contact.len(), 25);
        assert!(deck.bodies[0].modes().is_empty() && deck.bodies[1].modes().len() == 6);
    }

    /// The rows of 7^2 pairs, and the load of the cubes.
    #[test]
    fn flat_blocks_have_fewer_unknowns_for_the_same_rows_and_load() {
        let blocks = Blocks::default();
        let (cubes, flat) = (blocks.build(), blocks.layered(2));
        assert_eq!((flat.contact.len(), flat.dofs()), (49, 49 * 3 * 5));
        assert_eq!(flat.contact.rhs, cubes.contact.rhs);
        let total = |deck: &Deck| deck.bodies[1].load.iter().sum::<f64>();
        assert!((total(&flat) - total(&cubes)).abs() < 1e-15);
        let heights = flat.bodies[1].coordinates.iter().map(|x| x[2]);
        let (low, high) = heights.fold((f64::MAX, f64::MIN), |(low, high), z| (low.min(z), high.max(z)));
        assert!((low - 1.0 / 3.0).abs() < 1e-15 && (high - 2.0 / 3.0).abs() < 1e-15);
    }

    #[test]
    fn rows_join_facing_nodes() {
        for deck in [Blocks::default().build(), Blocks::default().layered(2)] {
            assert_facing(&deck);
        }
    }

    fn assert_facing(deck: &Deck) {
        let place = |dof: usize| {
            let body = usize::from(dof >= deck.offset(1));
            let local = dof - deck.offset(body);
            (deck.bodies[body].coordinates[local], deck.bodies[body].direction[local])
        };
        for row in 0..deck.contact.len() {
            let pair: Vec<_> = deck.contact.matrix.row(row).collect();
            assert_eq!((pair[0].1, pair[1].1), (1.0, -1.0));
            assert_eq!(place(pair[0].0), place(pair[1].0));
            assert_eq!(place(pair[0].0).1, 3);
        }
    }

    /// The resultant of the load acts inside the interface: facing nodes can hold it.
    #[test]
    fn load_presses_down_inside_the_interface() {
        let deck = Blocks::default().build();
        let upper = &deck.bodies[1];
        let total: f64 = upper.load.iter().sum();
        let moment = |axis: usize| -> f64 {
            let terms = upper.load.iter().zip(&upper.coordinates);
            terms.map(|(force, x)| force * x[axis]).sum()
        };
        assert!(total < 0.0);
        for centre in [moment(0) / total, moment(1) / total] {
            assert!((0.1..0.6).contains(&centre), "{centre}");
        }
    }

    #[test]
    fn upper_block_is_twice_as_stiff() {
        let deck = Blocks::default().build();
        let first = |body: usize, node: i32| {
            let body = &deck.bodies[body];
            let dof = body.node.iter().position(|&label| label == node);
            body.stiffness.diagonal()[dof.expect("a node that is not clamped")]
        };
        let inner = 7 * 7 * 2 + 10;
        assert!((first(1, inner) / first(0, inner) - 2.0).abs() < 1e-14);
    }
}
