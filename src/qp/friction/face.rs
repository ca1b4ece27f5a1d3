//! A face: the states of all nodes and the linear model of the laws on it, `L x = ...` for held values, `W'r + D s = ...`
//! elsewhere, with the coarse spaces G W and G Z.

use crate::error::Result;
use crate::linalg::dense::growing::Growing;
use crate::numbers::friction::FREE_MOTIONS;
use crate::numbers::rounding;
use crate::qp::friction::cones::{direction, length, Cones, Node};
use crate::qp::friction::coordinates::{Coordinate, Law, EQUATION};
use crate::qp::friction::motions::{Motions, Turned};

/// The state of a node with friction.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum State {
    /// The bound is 0: no tangential force.
    Open,
    Stick,
    Slip,
}

/// All m coordinates and their laws, which is what a preconditioner needs of a face.
pub struct Face {
    pub coordinates: Vec<Coordinate>,
    /// One state per node.
    pub states: Vec<State>,
    pub closed: Vec<bool>,
    pub rho: f64,
}

impl Face {
    /// The face of `xi = x - rho r`.
    pub fn at(cones: &Cones, x: &[f64], r: &[f64], rho: f64) -> Self {
        let xi: Vec<f64> = x.iter().zip(r).map(|(x, r)| x - rho * r).collect();
        // a smaller bound is zero
        let nothing = rounding::SUM * crate::linalg::vector::norm_max(x);
        let mut face = Self::empty(cones, rho);
        for node in cones.nodes() {
            let trial = node.of(&xi);
            let closed = node.normal.is_some() && trial.normal > 0.0;
            let limit = node.limit(trial.normal);
            let size = length(trial.tangential);
            let state = match () {
                () if limit <= nothing => State::Open,
                () if size > limit => State::Slip,
                () => State::Stick,
            };
            let damping = if state == State::Slip { (size - limit) / (limit * rho) } else { 0.0 };
            face.push_node(node, closed, state, (direction(trial.tangential), damping));
        }
        face.finish(cones);
        face
    }

    pub fn empty(cones: &Cones, rho: f64) -> Self {
        let nodes = cones.nodes().len();
        let (states, closed) = (Vec::with_capacity(nodes), Vec::with_capacity(nodes));
        Self { coordinates: Vec::with_capacity(cones.order()), states, closed, rho }
    }

    /// Adds the coordinates of a node in this state: direction of its slip, and damping across it.
    pub fn push_node(&mut self, node: &Node, closed: bool, state: State, (along, damping): ([f64; 2], f64)) {
        let normal = if closed { EQUATION } else { Law::Held { value: 0.0 } };
        self.coordinates.extend(node.own_normal().map(|row| Coordinate::row(row, normal)));
        let coupling = Some((node.behind, node.mu)).filter(|_| closed && state == State::Slip);
        let (along, laws) = match state {
            State::Open => ([1.0, 0.0], [Law::Held { value: 0.0 }; 2]),
            State::Stick => ([1.0, 0.0], [EQUATION; 2]),
            State::Slip => (along, [Law::Held { value: node.bound }, Law::Free { damping, shift: 0.0 }]),
        };
        self.push_tangents(node.tangents(), along, coupling, laws);
        self.states.push(state);
        self.closed.push(closed);
    }

    /// Adds the coordinates along `along`, with this coupling, and across.
    pub fn push_tangents(
        &mut self,
        tangents: &[usize],
        along: [f64; 2],
        coupling: Option<(usize, f64)>,
        [first, second]: [Law; 2],
    ) {
        match *tangents {
            [row] => {
                let along = [along[0], 0.0];
                self.coordinates.push(Coordinate { rows: [row; 2], along, coupling, law: first });
            }
            [one, two] => {
                let rows = [one, two];
                self.coordinates.push(Coordinate { rows, along, coupling, law: first });
                let across = [-along[1], along[0]];
                self.coordinates.push(Coordinate { rows, along: across, coupling: None, law: second });
            }
            _ => {}
        }
    }

    pub fn finish(&mut self, cones: &Cones) {
        self.coordinates.extend(cones.free().iter().map(|&row| Coordinate::row(row, EQUATION)));
    }

    pub fn weights(&self) -> Vec<f64> {
        self.coordinates.iter().map(|coordinate| coordinate.weight(self.rho)).collect()
    }

    /// `s = w'x - coupling x_n` of coordinate k.
    pub fn slack(&self, k: usize, x: &[f64]) -> f64 {
        let coordinate = &self.coordinates[k];
        let of_normal =
            coordinate.coupling.map_or(0.0, |(before, by)| by * self.coordinates[k - before].of(x));
        coordinate.of(x) - of_normal
    }

    /// In free coordinates `W'(g - G'a) + D s - shift`, in held coordinates `(s - value) / rho`; `r = g - G'a`.
    pub fn residual(&self, x: &[f64], r: &[f64]) -> Vec<f64> {
        let of = |k: usize| match self.coordinates[k].law {
            Law::Held { value } => (self.slack(k, x) - value) / self.rho,
            Law::Free { damping: 0.0, shift } => self.coordinates[k].of(r) - shift,
            Law::Free { damping, shift } => self.coordinates[k].of(r) + damping * self.slack(k, x) - shift,
        };
        (0..self.coordinates.len()).map(of).collect()
    }

    /// The linear part of `residual`, of `(v, F v)`.
    pub fn image(&self, v: &[f64], fv: &[f64]) -> Vec<f64> {
        let of = |k: usize| match self.coordinates[k].law {
            Law::Held { .. } => self.slack(k, v) / self.rho,
            Law::Free { damping: 0.0, .. } => self.coordinates[k].of(fv),
            Law::Free { damping, .. } => self.coordinates[k].of(fv) + damping * self.slack(k, v),
        };
        (0..self.coordinates.len()).map(of).collect()
    }

    /// `x += Z y` over the free coordinates; held coordinates follow the normal forces.
    pub fn add(&self, y: &[f64], x: &mut [f64]) {
        for (k, coordinate) in self.coordinates.iter().enumerate() {
            let own = if coordinate.is_free() { y[k] } else { 0.0 };
            let drawn = coordinate.coupling.map_or(0.0, |(before, by)| by * y[k - before]);
            coordinate.add(own + drawn, x);
        }
    }
}

/// A face with its coarse spaces.
pub struct Model {
    pub face: Face,
    /// `(A w^2 A')^+` for A = G W and for A = G Z.
    plain: Turned,
    through: Turned,
    /// Images of pairs, reduced and made orthonormal, as far as they were asked for, and the number of the first pair.
    pub images: (usize, Growing),
}

impl Model {
    pub fn new(face: Face, motions: &mut Motions) -> Result<Self> {
        let weights = face.weights();
        let plain = motions.inverse(&face.coordinates, weights.clone(), (false, FREE_MOTIONS))?;
        let through = motions.inverse(&face.coordinates, weights, (true, FREE_MOTIONS))?;
        Ok(Self { face, plain, through, images: Default::default() })
    }

    /// `da = (A w^2 A')^+ A w^2 q` of a residual, r entries.
    pub fn turn(&self, residual: &[f64]) -> Result<Vec<f64>> {
        self.plain.solve(&self.plain.weighted_image(residual))
    }

    /// Subtracts `A'da` from the free coordinates of a residual.
    pub fn turned(&self, residual: &mut [f64]) -> Result<()> {
        let turn = self.turn(residual)?;
        for (k, q) in residual.iter_mut().enumerate().filter(|(k, _)| self.plain.weights[*k] != 0.0) {
            *q -= self.plain.row_dot(k, &turn);
        }
        Ok(())
    }

    /// `[first; P w q]`: the part of a residual that no a can remove, all entries as lengths.
    pub fn reduced(&self, mut residual: Vec<f64>) -> Result<Vec<f64>> {
        let weights = self.plain.weights.iter().map(|w| if *w == 0.0 { 1.0 } else { *w });
        residual.iter_mut().zip(weights).for_each(|(q, w)| *q *= w);
        self.plain.project(&mut residual)?;
        Ok(residual)
    }

    /// `y <- y - w^2 A_Z'(A_Z w^2 A_Z')^+ (A_Z y + more)`
    pub fn balance(&self, y: &mut [f64], more: Option<&[f64]>) -> Result<()> {
        let mut image = self.through.image(y);
        more.into_iter().flatten().zip(&mut image).for_each(|(more, image)| *image += more);
        let beta = self.through.solve(&image)?;
        self.through.add_weighted(-1.0, &beta, y);
        Ok(())
    }
}
