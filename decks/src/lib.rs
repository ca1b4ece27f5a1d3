//! Model problems for feti-contact: the decks its tests, benchmarks and examples share.
//!
//! A deck is the problem min 1/2 u'Ku - f'u over { B u <= c, H u = h }, with K = diag(K_1, ..., K_s) over
//! the bodies; rows may be springs, B u - c <= lambda/k, H u - h = mu/k. Nothing here solves anything and nothing depends on the solver.
//!
//! | module | problem |
//! |---|---|
//! | [`membrane`] | two membranes on an edge, one floating (Problem 1 of the paper) |
//! | [`blocks`] | two stacked elastic blocks, matching grids: the benchmark |
//! | [`by_elements`] | the benchmark by its elements, as a host without a sparse matrix has it |
//! | [`stack`] | stacked bodies on non-matching grids, node-to-segment rows |
//! | [`cube`] | an elastic body cut into subdomains, glued by equalities, on an obstacle |
//! | [`masonry`] | towers, walls and heaps of many loose blocks |
//! | [`rubbing`] | bodies with friction: pressed together and pushed along each other |
//! | [`pieces`] | the benchmark cut into glued pieces |
//! | [`small`] | one to three unknowns, solved by hand |
//! | [`battery`] | random small hard problems whose outcome is known by construction |
//! | [`varied`] | random small problems of bodies and rows of unequal size, with a known answer |
//! | [`hard`] | random small problems that have been refused or left unsolved, each with what may come of it |
//!
//! [`yardstick`] says when an answer is wrong, [`second`] solves small problems in double-double arithmetic ([`dd`]).

pub mod battery;
pub mod block;
pub mod blocks;
pub mod by_elements;
pub mod cube;
pub mod dd;
pub mod dense;
pub mod elements;
pub mod hard;
pub mod masonry;
pub mod membrane;
pub mod mesh;
pub mod pieces;
pub mod random;
pub mod rubbing;
pub mod second;
pub mod small;
pub mod sparse;
pub mod stack;
pub mod varied;
mod vector;
pub mod yardstick;

pub use block::Block;
pub use blocks::Blocks;
pub use by_elements::{ByElements, Elements};
pub use cube::{Cube, Glue, Moduli};
pub use membrane::Membrane;
pub use sparse::Csr;
pub use stack::Stack;

/// One body: K_p u_p = f_p - (contact and gluing forces).
#[derive(Clone, Debug)]
pub struct Body {
    /// K_p, n x n, force per length: both triangles, columns sorted.
    pub stiffness: Csr,
    /// Basis of ker K_p, one vector of length n per mode; `None` when K_p is non-singular.
    pub null_space: Option<Vec<Vec<f64>>>,
    /// f_p, n, force.
    pub load: Vec<f64>,
    /// Position of the node each dof belongs to, n x 3, length.
    pub coordinates: Vec<[f64; 3]>,
    /// Label of the node each dof belongs to, from 1; eliminated nodes leave holes.
    pub node: Vec<i32>,
    /// Direction of each dof: 1, 2, 3 = displacement along x, y, z.
    pub direction: Vec<i32>,
}

impl Body {
    /// n, the number of dofs.
    pub fn dofs(&self) -> usize {
        self.stiffness.rows
    }

    /// The modes of ker K_p, none when K_p is non-singular.
    pub fn modes(&self) -> &[Vec<f64>] {
        self.null_space.as_deref().unwrap_or(&[])
    }
}

/// Rows B u <= c (contact) or H u = h (equalities) over the concatenated dofs of all bodies.
#[derive(Clone, Debug)]
pub struct Rows {
    /// B or H: rows x dofs, columns sorted, no repeated entry.
    pub matrix: Csr,
    /// c or h, one per row, length times the unit of the row.
    pub rhs: Vec<f64>,
    /// 1/k, one per row, length / force times the square of the unit of the row; 0: rigid.
    pub compliance: Vec<f64>,
}

impl Rows {
    /// No rows over `dofs` unknowns.
    pub fn none(dofs: usize) -> Rows {
        Rows { matrix: Csr::empty(dofs), rhs: Vec::new(), compliance: Vec::new() }
    }

    /// Appends sum_k value_k u_(dof_k) <= (or =) `rhs`; repeated dofs are summed, exact zeros left out.
    pub fn push(&mut self, entries: &[(usize, f64)], rhs: f64) {
        self.push_compliant(entries, rhs, 0.0);
    }

    /// Appends sum_k value_k u_(dof_k) - `rhs` <= (or =) `compliance` times the force of the row.
    pub fn push_compliant(&mut self, entries: &[(usize, f64)], rhs: f64, compliance: f64) {
        self.matrix.push_row(entries);
        self.rhs.push(rhs);
        self.compliance.push(compliance);
    }

    /// Number of rows.
    pub fn len(&self) -> usize {
        self.rhs.len()
    }

    /// True without a row.
    pub fn is_empty(&self) -> bool {
        self.rhs.is_empty()
    }
}

/// Contact nodes with friction, `dim` tangential rows each.
#[derive(Clone, Debug)]
pub struct Friction {
    /// 1 in the plane, 2 in space.
    pub dim: usize,
    /// The contact row of each node; none: the bound acts alone.
    pub normal: Vec<Option<usize>>,
    /// T, `dim` rows for each node, with s_old as right-hand sides and C_t as compliances.
    pub rows: Rows,
    /// mu of each node, no unit.
    pub coefficient: Vec<f64>,
    /// Bound of each node, force.
    pub bound: Vec<f64>,
}

impl Friction {
    /// No nodes over `dofs` unknowns.
    pub fn none(dim: usize, dofs: usize) -> Friction {
        let (normal, coefficient, bound) = (Vec::new(), Vec::new(), Vec::new());
        Friction { dim, normal, rows: Rows::none(dofs), coefficient, bound }
    }

    /// Appends a node; its tangential rows begin at s_old = 0.
    pub fn push(&mut self, normal: Option<usize>, rows: &[&[(usize, f64)]], coefficient: f64, bound: f64) {
        assert_eq!(rows.len(), self.dim);
        rows.iter().for_each(|row| self.rows.push(row, 0.0));
        self.normal.push(normal);
        self.coefficient.push(coefficient);
        self.bound.push(bound);
    }
}

/// A whole problem: nodal values stand for the functions of (6), struck out dofs for the prescribed displacements
/// (7), contact rows for the linearised non-interpenetration (8); its solution is the discrete (9).
#[derive(Clone, Debug)]
pub struct Deck {
    pub name: String,
    pub bodies: Vec<Body>,
    /// B u <= c.
    pub contact: Rows,
    /// H u = h.
    pub equalities: Rows,
    pub friction: Friction,
}

impl Deck {
    /// `bodies` with no rows yet.
    pub fn new(name: impl Into<String>, bodies: Vec<Body>) -> Deck {
        let dofs = bodies.iter().map(Body::dofs).sum();
        let (contact, equalities) = (Rows::none(dofs), Rows::none(dofs));
        Deck { name: name.into(), bodies, contact, equalities, friction: Friction::none(1, dofs) }
    }

    /// Unknowns of all bodies together.
    pub fn dofs(&self) -> usize {
        self.contact.matrix.cols
    }

    /// First concatenated dof of `body` (0-based); `offset(bodies.len())` is `dofs()`.
    pub fn offset(&self, body: usize) -> usize {
        self.bodies[..body].iter().map(Body::dofs).sum()
    }

    /// f, the loads of all bodies one after the other.
    pub fn load(&self) -> Vec<f64> {
        let loads = self.bodies.iter().flat_map(|body| &body.load);
        loads.copied().collect()
    }

    /// The deck with one body, whose K has the matrices of all bodies as blocks. Column j of its null space has the vectors j
    /// of all bodies.
    pub fn one_k(&self) -> Deck {
        let n = self.dofs();
        let mut stiffness = Csr { rows: n, ..Csr::empty(n) };
        let modes = self.bodies.iter().map(|body| body.modes().len()).max().unwrap_or(0);
        let mut all = Body {
            stiffness: Csr::empty(n),
            null_space: Some(vec![vec![0.0; n]; modes]),
            load: self.load(),
            coordinates: Vec::new(),
            node: Vec::new(),
            direction: Vec::new(),
        };
        for (p, body) in self.bodies.iter().enumerate() {
            let first = self.offset(p);
            for i in 0..body.dofs() {
                // with the entries that are 0, so that both have one pattern
                stiffness.col.extend(body.stiffness.row(i).map(|(j, _)| first + j));
                stiffness.val.extend(body.stiffness.row(i).map(|(_, v)| v));
                stiffness.ptr.push(stiffness.col.len());
            }
            for (own, of_all) in body.modes().iter().zip(all.null_space.iter_mut().flatten()) {
                of_all[first..first + body.dofs()].copy_from_slice(own);
            }
            all.coordinates.extend_from_slice(&body.coordinates);
            all.node.extend_from_slice(&body.node);
            all.direction.extend_from_slice(&body.direction);
        }
        all.stiffness = stiffness;
        Deck { bodies: vec![all], ..self.clone() }
    }
}

#[cfg(test)]
mod tests {
    use super::{Blocks, Cube, Deck, Membrane, Stack};

    /// Shapes, sorted columns and finite numbers: what every consumer may rely on.
    fn assert_well_formed(deck: &Deck) {
        assert_eq!(deck.offset(deck.bodies.len()), deck.dofs());
        for body in &deck.bodies {
            let n = body.dofs();
            assert_eq!(body.stiffness.cols, n);
            assert_eq!(body.load.len(), n);
            assert_eq!(body.coordinates.len(), n);
            assert_eq!(body.node.len(), n);
            assert_eq!(body.direction.len(), n);
            assert!(body.modes().iter().all(|mode| mode.len() == n));
            assert!(body.stiffness.is_sorted() && body.stiffness.asymmetry() == 0.0);
        }
        for rows in [&deck.contact, &deck.equalities] {
            assert_eq!(rows.matrix.rows, rows.len());
            assert_eq!((rows.matrix.cols, rows.compliance.len()), (deck.dofs(), rows.len()));
            assert!(rows.matrix.is_sorted());
            assert!(rows.rhs.iter().all(|value| value.is_finite()));
            assert!(rows.compliance.iter().all(|value| value.is_finite() && *value >= 0.0));
        }
    }

    #[test]
    fn every_default_deck_is_well_formed() {
        let decks = [
            Membrane::p1_p3().build(),
            Blocks::default().build(),
            Stack::default().build(),
            Cube::default().build(),
        ];
        for deck in &decks {
            assert_well_formed(deck);
            assert!(!deck.contact.is_empty());
        }
    }

    #[test]
    fn every_battery_deck_is_well_formed() {
        for (seed, case) in (0..40).zip(crate::battery::cases(0..40)) {
            assert_well_formed(&case.deck);
            assert_well_formed(&crate::battery::compliant(case, seed).deck);
        }
    }
}
