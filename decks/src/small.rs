//! Problems of one to three unknowns with their answers by hand.

use crate::sparse::Csr;
use crate::{Body, Deck};

/// A deck and the solution of K u = f - B'lambda - H'mu, lambda >= 0 normal to the gaps.
#[derive(Clone, Debug)]
pub struct Solved {
    pub deck: Deck,
    /// u over all bodies, length.
    pub displacement: Vec<f64>,
    /// lambda, one force per contact row.
    pub forces: Vec<f64>,
    /// mu, one force per equality row.
    pub equality_forces: Vec<f64>,
}

/// A body along the x axis from its dense stiffness (by rows): node i at x = `start` + i.
fn body(start: f64, stiffness: &[f64], load: &[f64], null_space: Option<Vec<Vec<f64>>>) -> Body {
    let n = load.len();
    Body {
        stiffness: Csr::from_dense(n, stiffness),
        null_space,
        load: load.to_vec(),
        coordinates: (0..n).map(|i| [start + i as f64, 0.0, 0.0]).collect(),
        node: (1..=n as i32).collect(),
        direction: vec![1; n],
    }
}

/// A bar of stiffness s between two nodes: s [1 -1; -1 1], floating.
fn bar(start: f64, s: f64, load: [f64; 2]) -> Body {
    body(start, &[s, -s, -s, s], &load, Some(vec![vec![1.0, 1.0]]))
}

/// One dof on a spring k, pushed by f towards an obstacle at distance c:
/// lambda = max(0, f - k c), u = (f - lambda)/k. f = k c touches without force.
#[derive(Clone, Copy, Debug)]
pub struct Obstacle {
    pub spring: f64,
    pub force: f64,
    pub gap: f64,
}

impl Obstacle {
    pub fn build(&self) -> Solved {
        let mut deck = Deck::new("obstacle", vec![body(0.0, &[self.spring], &[self.force], None)]);
        deck.contact.push(&[(0, 1.0)], self.gap);
        let lambda = (self.force - self.spring * self.gap).max(0.0);
        Solved {
            deck,
            displacement: vec![(self.force - lambda) / self.spring],
            forces: vec![lambda],
            equality_forces: vec![],
        }
    }
}

/// A spring k to a wall on the left and, to its right across a gap c, a block pushed against it by F:
/// u1 - u2 <= c gives lambda = F, u1 = -F/k, u2 = u1 - c.
#[derive(Clone, Copy, Debug)]
pub struct SpringAndBlock {
    pub spring: f64,
    /// F > 0, towards the wall.
    pub force: f64,
    pub gap: f64,
    /// `None`: a rigid block, one dof with K = 0. `Some(s)`: a bar of stiffness s, two dofs, pushed at its
    /// far end, which moves F/s more.
    pub block: Option<f64>,
}

impl SpringAndBlock {
    pub fn build(&self) -> Solved {
        let spring = body(0.0, &[self.spring], &[0.0], None);
        let block = match self.block {
            None => body(1.0, &[0.0], &[-self.force], Some(vec![vec![1.0]])),
            Some(s) => bar(1.0, s, [0.0, -self.force]),
        };
        let mut deck = Deck::new("spring_and_block", vec![spring, block]);
        deck.contact.push(&[(0, 1.0), (1, -1.0)], self.gap);
        let first = -self.force / self.spring;
        let near = first - self.gap;
        let far = self.block.map(|s| near - self.force / s);
        Solved {
            deck,
            displacement: [first, near].into_iter().chain(far).collect(),
            forces: vec![self.force],
            equality_forces: vec![],
        }
    }
}

/// Two springs with facing ends across a gap c, loads f1 and f2 along x, u1 - u2 <= c:
/// lambda = max(0, (f1/k1 - f2/k2 - c) / (1/k1 + 1/k2)).
#[derive(Clone, Copy, Debug)]
pub struct FacingSprings {
    pub springs: [f64; 2],
    pub forces: [f64; 2],
    pub gap: f64,
}

impl FacingSprings {
    pub fn build(&self) -> Solved {
        let ([k1, k2], [f1, f2]) = (self.springs, self.forces);
        let bodies = vec![body(0.0, &[k1], &[f1], None), body(1.0, &[k2], &[f2], None)];
        let mut deck = Deck::new("facing_springs", bodies);
        deck.contact.push(&[(0, 1.0), (1, -1.0)], self.gap);
        let lambda = ((f1 / k1 - f2 / k2 - self.gap) / (1.0 / k1 + 1.0 / k2)).max(0.0);
        Solved {
            deck,
            displacement: vec![(f1 - lambda) / k1, (f2 + lambda) / k2],
            forces: vec![lambda],
            equality_forces: vec![],
        }
    }
}

/// A spring k glued (u1 - u2 = 0) to a floating bar of stiffness s, whose far end is pushed by F towards an
/// obstacle at distance c. In series the far end has compliance C = 1/k + 1/s: lambda = max(0, F - c/C),
/// mu = lambda - F (the spring's force with its sign), u1 = u2 = -mu/k, u3 = u2 - mu/s.
#[derive(Clone, Copy, Debug)]
pub struct GluedBar {
    pub spring: f64,
    pub bar: f64,
    pub force: f64,
    pub gap: f64,
}

impl GluedBar {
    pub fn build(&self) -> Solved {
        let bodies = vec![body(0.0, &[self.spring], &[0.0], None), bar(0.0, self.bar, [0.0, self.force])];
        let mut deck = Deck::new("glued_bar", bodies);
        deck.contact.push(&[(2, 1.0)], self.gap);
        deck.equalities.push(&[(0, 1.0), (1, -1.0)], 0.0);
        let compliance = 1.0 / self.spring + 1.0 / self.bar;
        let lambda = (self.force - self.gap / compliance).max(0.0);
        let mu = lambda - self.force;
        let joint = -mu / self.spring;
        Solved {
            deck,
            displacement: vec![joint, joint, joint - mu / self.bar],
            forces: vec![lambda],
            equality_forces: vec![mu],
        }
    }
}

#[cfg(test)]
mod tests {
    use super::{FacingSprings, GluedBar, Obstacle, Solved, SpringAndBlock};
    use crate::vector::{axpy, norm_max};

    /// Equilibrium, gaps, signs and complementarity of the answer by hand.
    fn assert_solves(solved: &Solved) {
        let deck = &solved.deck;
        let mut residual = deck.contact.matrix.transpose_times(&solved.forces);
        axpy(1.0, &deck.equalities.matrix.transpose_times(&solved.equality_forces), &mut residual);
        axpy(-1.0, &deck.load(), &mut residual);
        for (index, body) in deck.bodies.iter().enumerate() {
            let range = deck.offset(index)..deck.offset(index + 1);
            let force = body.stiffness.times(&solved.displacement[range.clone()]);
            axpy(1.0, &force, &mut residual[range]);
        }
        assert!(norm_max(&residual) < 1e-14, "{residual:?}");
        let closing = deck.contact.matrix.times(&solved.displacement);
        for ((closing, gap), force) in closing.iter().zip(&deck.contact.rhs).zip(&solved.forces) {
            assert!(gap - closing > -1e-14 && *force >= 0.0);
            assert!((force * (gap - closing)).abs() < 1e-14);
        }
        let jump = deck.equalities.matrix.times(&solved.displacement);
        assert!(jump.iter().zip(&deck.equalities.rhs).all(|(u, h)| (u - h).abs() < 1e-14));
    }

    #[test]
    fn obstacle_answers_open_touching_and_closed() {
        for force in [1.0, 1.5, 4.0] {
            assert_solves(&Obstacle { spring: 3.0, force, gap: 0.5 }.build());
        }
        assert_eq!(Obstacle { spring: 3.0, force: 1.5, gap: 0.5 }.build().forces, [0.0]);
    }

    #[test]
    fn floating_block_rests_on_the_spring() {
        let rigid = SpringAndBlock { spring: 2.0, force: 3.0, gap: 0.25, block: None };
        assert_solves(&rigid.build());
        assert_eq!(rigid.build().displacement, [-1.5, -1.75]);
        assert_eq!(rigid.build().forces, [3.0]);
        assert_solves(&SpringAndBlock { block: Some(6.0), ..rigid }.build());
    }

    #[test]
    fn facing_springs_answer_open_and_closed() {
        for gap in [0.1, 10.0] {
            assert_solves(&FacingSprings { springs: [2.0, 5.0], forces: [3.0, -1.0], gap }.build());
        }
    }

    #[test]
    fn glued_bar_answers_open_and_closed() {
        for gap in [0.1, 10.0] {
            let solved = GluedBar { spring: 2.0, bar: 5.0, force: 3.0, gap }.build();
            assert_solves(&solved);
            assert_eq!(solved.forces[0] > 0.0, gap < 1.0);
        }
    }
}
