//! Problem 1 of the paper: two membranes side by side, the left one held on its far edge, the right one
//! floating, contact along the common edge x = 1.

use crate::elements::bilinear_laplacian;
use crate::sparse::{Csr, Triplets};
use crate::{Body, Deck};

/// Discretisation of the Laplacian on squares of side h = 1/cells.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Laplacian {
    /// 5-point differences, weight 1 on every grid edge: the graph Laplacian.
    UnitEdges,
    /// 5-point differences, weight 1/2 on the edges of the boundary: linear finite elements.
    Linear,
    /// Bilinear finite elements, 9-point.
    Bilinear,
}

/// How the pressure becomes nodal force.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Loading {
    /// h^2 P at the nodes inside the loaded strip, none at its ends x = 0, 1, 2 and y = 0, 1.
    Nodes,
    /// A quarter of h^2 P from every loaded cell to each of its corners: the exact total force.
    Cells,
}

/// Membranes on [0,1] x [0,1] and [1,2] x [0,1]: deflection u, one dof a node, numbered along y first.
/// u1 = 0 at x = 0 (eliminated); u1 <= u2 at x = 1; the left strip y >= 3/4 and the right strip
/// y < 1/4 are loaded.
#[derive(Clone, Debug)]
pub struct Membrane {
    pub name: String,
    /// Cells along each edge, 1/h; a multiple of 4 for the strips to end on grid lines.
    pub cells: usize,
    pub laplacian: Laplacian,
    /// K = tension times the Laplacian.
    pub tension: f64,
    pub loading: Loading,
    /// Pressure P on the strip of the left and of the right membrane.
    pub pressure: [f64; 2],
}

impl Membrane {
    /// The configuration that gives the paper's counts: P = -3 on the left, graph Laplacian. 14 of 21 rows
    /// are closed and the multipliers sum to 0.19.
    pub fn p1_p3() -> Membrane {
        Membrane {
            name: "p1_P3".into(),
            cells: 20,
            laplacian: Laplacian::UnitEdges,
            tension: 1.0,
            loading: Loading::Nodes,
            pressure: [-3.0, -1.0],
        }
    }

    /// As printed, P = -1 on both: all 21 rows are closed.
    pub fn p1_p1() -> Membrane {
        Membrane { name: "p1_P1".into(), pressure: [-1.0, -1.0], ..Membrane::p1_p3() }
    }

    /// Finite elements with the energy int |grad u|^2 without the factor 1/2 (hence tension 2) and the exact
    /// total load: 15 of 21 rows are closed.
    pub fn p1_p3_galerkin() -> Membrane {
        Membrane {
            name: "p1_P3_galerkin".into(),
            laplacian: Laplacian::Linear,
            tension: 2.0,
            loading: Loading::Cells,
            ..Membrane::p1_p3()
        }
    }

    /// The deck: (cells + 1) cells + (cells + 1)^2 unknowns, cells + 1 rows u1 - u2 <= 0.
    pub fn build(&self) -> Deck {
        let edge = self.cells + 1;
        let mut deck = Deck::new(self.name.clone(), vec![self.left(), self.right()]);
        let left_edge = deck.offset(1) - edge;
        for j in 0..edge {
            let row = [(left_edge + j, 1.0), (left_edge + edge + j, -1.0)];
            deck.contact.push(&row, 0.0);
        }
        deck
    }

    /// The left membrane without its nodes x = 0.
    fn left(&self) -> Body {
        let edge = self.cells + 1;
        let keep: Vec<usize> = (edge..edge * edge).collect();
        let load = self.load(self.pressure[0], |y| y > 0.75);
        self.body(0.0, &keep, load, None)
    }

    /// The right membrane, all nodes: its null space is a constant.
    fn right(&self) -> Body {
        let nodes = (self.cells + 1) * (self.cells + 1);
        let keep: Vec<usize> = (0..nodes).collect();
        let load = self.load(self.pressure[1], |y| y < 0.25);
        self.body(1.0, &keep, load, Some(vec![vec![1.0; nodes]]))
    }

    /// The nodes `keep` of the membrane that starts at x = `start`; deflection is the third direction.
    fn body(&self, start: f64, keep: &[usize], load: Vec<f64>, null_space: Option<Vec<Vec<f64>>>) -> Body {
        let edge = self.cells + 1;
        let h = 1.0 / self.cells as f64;
        let position = |node: &usize| [start + (node / edge) as f64 * h, (node % edge) as f64 * h, 0.0];
        Body {
            stiffness: self.stiffness().restricted(keep),
            null_space,
            load: keep.iter().map(|&node| load[node]).collect(),
            coordinates: keep.iter().map(position).collect(),
            node: keep.iter().map(|node| (node + 1) as i32).collect(),
            direction: vec![3; keep.len()],
        }
    }

    /// K of one membrane, all (cells + 1)^2 nodes.
    fn stiffness(&self) -> Csr {
        let edge = self.cells + 1;
        let mut triplets = Triplets::new(edge * edge, edge * edge);
        match self.laplacian {
            Laplacian::UnitEdges => add_edges(&mut triplets, self.cells, 1.0),
            Laplacian::Linear => add_edges(&mut triplets, self.cells, 0.5),
            Laplacian::Bilinear => add_squares(&mut triplets, self.cells),
        }
        triplets.to_csr().scaled(self.tension)
    }

    /// Nodal force of `pressure` on the strip of all y (of a node or of a cell's centre) with `loaded(y)`.
    /// A node on the inner end of the strip (y = 3/4) belongs to the left strip only.
    fn load(&self, pressure: f64, loaded: impl Fn(f64) -> bool) -> Vec<f64> {
        let (edge, h) = (self.cells + 1, 1.0 / self.cells as f64);
        let mut load = vec![0.0; edge * edge];
        let centre = |j: usize| (j as f64 + 0.5) * h;
        for i in 0..self.cells {
            for j in (0..self.cells).filter(|&j| loaded(centre(j))) {
                match self.loading {
                    Loading::Nodes if i > 0 && j > 0 => load[i * edge + j] += pressure * h * h,
                    Loading::Nodes => {}
                    Loading::Cells => {
                        for corner in [0, 1, edge, edge + 1] {
                            load[i * edge + j + corner] += pressure * h * h / 4.0;
                        }
                    }
                }
            }
        }
        load
    }
}

/// 5-point differences on a square grid, `boundary` the weight of the grid edges on its rim.
fn add_edges(triplets: &mut Triplets, cells: usize, boundary: f64) {
    let edge = cells + 1;
    let weight = |line: usize| if line == 0 || line == cells { boundary } else { 1.0 };
    for line in 0..edge {
        for step in 0..cells {
            for (a, b) in
                [(line * edge + step, line * edge + step + 1), (step * edge + line, (step + 1) * edge + line)]
            {
                for (i, j, sign) in [(a, a, 1.0), (b, b, 1.0), (a, b, -1.0), (b, a, -1.0)] {
                    triplets.add(i, j, sign * weight(line));
                }
            }
        }
    }
}

/// Bilinear elements on a square grid.
fn add_squares(triplets: &mut Triplets, cells: usize) {
    let edge = cells + 1;
    let element = bilinear_laplacian();
    for first in (0..cells).flat_map(|i| (0..cells).map(move |j| i * edge + j)) {
        let corners = [first, first + 1, first + edge, first + edge + 1];
        for (k, value) in element.iter().enumerate() {
            triplets.add(corners[k / 4], corners[k % 4], *value);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::{Laplacian, Membrane};
    use crate::vector::{dot, norm_max};

    fn count(values: &[f64], wanted: f64) -> usize {
        values.iter().filter(|&&value| (value - wanted).abs() < 1e-15).count()
    }

    #[test]
    fn p1_has_420_and_441_unknowns_and_21_rows_without_gap() {
        for membrane in [Membrane::p1_p3(), Membrane::p1_p1(), Membrane::p1_p3_galerkin()] {
            let deck = membrane.build();
            assert_eq!((deck.bodies[0].dofs(), deck.bodies[1].dofs()), (420, 441));
            assert_eq!((deck.contact.len(), deck.equalities.len()), (21, 0));
            assert_eq!(deck.contact.rhs, [0.0; 21]);
            let first: Vec<_> = deck.contact.matrix.row(0).collect();
            assert_eq!(first, [(399, 1.0), (420, -1.0)]);
            let last: Vec<_> = deck.contact.matrix.row(20).collect();
            assert_eq!(last, [(419, 1.0), (440, -1.0)]);
        }
    }

    /// Entries as counted in the published matrices: 4 corners, 76 boundary, 361 inner nodes; 840 edges.
    #[test]
    fn stiffness_of_the_floating_membrane_has_the_reference_entries() {
        let plain = Membrane::p1_p3().build().bodies[1].stiffness.lower();
        assert_eq!(plain.val.len(), 1281);
        let counts = [2.0, 3.0, 4.0, -1.0].map(|value| count(&plain.val, value));
        assert_eq!(counts, [4, 76, 361, 840]);
        let galerkin = Membrane::p1_p3_galerkin().build().bodies[1].stiffness.lower();
        let counts = [2.0, 4.0, 8.0, -1.0, -2.0].map(|value| count(&galerkin.val, value));
        assert_eq!(counts, [4, 76, 361, 80, 760]);
    }

    #[test]
    fn stiffness_of_the_held_membrane_begins_as_the_reference() {
        let held = &Membrane::p1_p3().build().bodies[0];
        assert_eq!(held.stiffness.lower().val.len(), 1219);
        let row: Vec<_> = held.stiffness.row(1).collect();
        assert_eq!(row, [(0, -1.0), (1, 4.0), (2, -1.0), (22, -1.0)]);
        assert_eq!(held.stiffness.get(0, 0), 3.0);
        let ones = vec![1.0; held.dofs()];
        assert_eq!(dot(&ones, &held.stiffness.times(&ones)), 21.0);
    }

    #[test]
    fn loads_add_up_to_the_printed_totals() {
        let totals = |membrane: Membrane| {
            let deck = membrane.build();
            [0, 1].map(|body| deck.bodies[body].load.iter().sum::<f64>())
        };
        let close = |found: [f64; 2], wanted: [f64; 2]| {
            let error = (found[0] - wanted[0]).abs().max((found[1] - wanted[1]).abs());
            assert!(error < 1e-14, "{found:?}");
        };
        close(totals(Membrane::p1_p3()), [-0.7125, -0.19]);
        close(totals(Membrane::p1_p1()), [-0.2375, -0.19]);
        close(totals(Membrane::p1_p3_galerkin()), [-0.73125, -0.25]);
    }

    #[test]
    fn loaded_nodes_are_those_of_the_reference() {
        let deck = Membrane::p1_p3().build();
        let loaded = |body: usize| -> Vec<usize> {
            let load = &deck.bodies[body].load;
            (0..load.len()).filter(|&dof| load[dof] != 0.0).collect()
        };
        assert_eq!(loaded(0)[..6], [15, 16, 17, 18, 19, 36]);
        assert_eq!(loaded(1)[..5], [22, 23, 24, 25, 43]);
        assert_eq!((loaded(0).len(), loaded(1).len()), (95, 76));
    }

    #[test]
    fn constants_cost_no_energy_in_any_discretisation() {
        for laplacian in [Laplacian::UnitEdges, Laplacian::Linear, Laplacian::Bilinear] {
            let deck = Membrane { laplacian, cells: 8, ..Membrane::p1_p3() }.build();
            let right = &deck.bodies[1];
            assert!(norm_max(&right.stiffness.times(&right.modes()[0])) < 1e-14);
        }
    }
}
