//! Bodies by their elements, made one at a time: K is nowhere, nor are the matrices of all elements.

use crate::{Block, Deck};

/// A deck that a host hands over element by element.
#[derive(Clone, Debug)]
pub struct ByElements {
    /// Null spaces, loads, coordinates and rows; the stiffness of its bodies has no entry.
    pub deck: Deck,
    /// The elements of each body.
    pub bodies: Vec<Elements>,
}

/// The elements of a block, some of whose dofs may be clamped: scaled copies of one matrix.
#[derive(Clone, Debug)]
pub struct Elements {
    block: Block,
    /// Dof of the body for each dof of the block, `None` where clamped.
    number: Vec<Option<usize>>,
    /// Stiffness of an element whose factor is 1.
    matrix: Vec<f64>,
}

impl Elements {
    /// `number` as [`crate::block::Part`] has it.
    pub fn new(block: Block, number: Vec<Option<usize>>) -> Elements {
        let matrix = block.element();
        Elements { block, number, matrix }
    }

    /// Number of elements.
    pub fn count(&self) -> usize {
        self.block.volume()
    }

    /// Dofs that an element joins, clamped ones included.
    pub fn order(&self) -> usize {
        self.block.dimension << self.block.dimension
    }

    /// The dofs that every element joins, one element after the other, in the order of the rows of its matrix: those of
    /// the body from 0, the clamped dof k of the block as -1 - k.
    pub fn connectivity(&self) -> Vec<i64> {
        let d = self.block.dimension;
        let name = |dof: usize| self.number[dof].map_or(-1 - dof as i64, |own| own as i64);
        let mut joined = Vec::with_capacity(self.count() * self.order());
        for low in (0..self.count()).map(|e| self.block.low(e)) {
            for corner in 0..1usize << d {
                let node = self.block.node(std::array::from_fn(|axis| low[axis] + (corner >> axis & 1)));
                joined.extend((d * node..d * (node + 1)).map(name));
            }
        }
        joined
    }

    /// The matrix of element e, which is symmetric to the last bit, into `matrix`.
    pub fn stiffness(&self, e: usize, matrix: &mut [f64]) {
        let factor = self.block.factors.get(e).copied().unwrap_or(1.0);
        matrix.iter_mut().zip(&self.matrix).for_each(|(own, one)| *own = factor * one);
    }
}

#[cfg(test)]
mod tests {
    use crate::Blocks;

    /// Rows, loads and places are the same, and the elements add up to K bit by bit.
    #[test]
    fn elements_of_the_varied_blocks_add_up_to_their_stiffness() {
        let blocks = Blocks { elements: 3, young: 2.0 };
        let (assembled, parts) = (blocks.varied(1e-3, 5), blocks.varied_by_elements(1e-3, 5));
        assert_eq!(parts.deck.contact.matrix, assembled.contact.matrix);
        assert_eq!(parts.deck.contact.rhs, assembled.contact.rhs);
        assert_eq!(parts.deck.load(), assembled.load());
        for (p, (elements, body)) in parts.bodies.iter().zip(&assembled.bodies).enumerate() {
            assert_eq!(parts.deck.bodies[p].coordinates, body.coordinates);
            let (n, order, joined) = (body.dofs(), elements.order(), elements.connectivity());
            let (mut sum, mut ke) = (vec![0.0; n * n], vec![0.0; order * order]);
            for (e, dofs) in joined.chunks(order).enumerate() {
                elements.stiffness(e, &mut ke);
                let free = |k: usize| usize::try_from(dofs[k]).ok();
                for (i, j) in (0..order).flat_map(|i| (0..order).map(move |j| (i, j))) {
                    if let (Some(row), Some(column)) = (free(i), free(j)) {
                        sum[row * n + column] += ke[i * order + j];
                    }
                }
            }
            assert!((0..n).all(|i| (0..n).all(|j| sum[i * n + j] == body.stiffness.get(i, j))));
            let held = joined.iter().filter(|dof| **dof < 0).max();
            assert_eq!(held, if p == 0 { Some(&-1) } else { None });
        }
    }
}
