//! Conjugate gradients on a face of the bounds.

use feti_contact::linalg::vector::{axpy, dot};

/// Conjugate gradients for min theta(y), y in W_I, I = A(x^k). While y is feasible, it is the point itself.
pub(super) struct PaperFace {
    pub y: Vec<f64>,
    pub g: Vec<f64>,
    /// I
    pub held: Vec<bool>,
    pub p: Vec<f64>,
    /// |r|^2 of the residual r = g on the face, and its first value.
    pub square: f64,
    first: f64,
    pub feasible: bool,
}

impl PaperFace {
    /// Starts at y with the gradient g; p is the part of g on the face.
    pub fn new(y: Vec<f64>, g: Vec<f64>, held: Vec<bool>, p: Vec<f64>) -> Self {
        let square = dot(&p, &p);
        Self { y, g, held, p, square, first: square, feasible: true }
    }

    /// Moves to `y - a p` with its gradient and computes the next conjugate direction; returns whether a residual is
    /// left.
    pub fn advance(&mut self, a: f64, y: Vec<f64>, image: &[f64]) -> bool {
        /// |r|^2 relative to its first value: the face is solved up to rounding.
        const SOLVED: f64 = 1e-28;
        self.y = y;
        axpy(-a, image, &mut self.g);
        let r: Vec<f64> =
            self.g.iter().zip(&self.held).map(|(g, held)| if *held { 0.0 } else { *g }).collect();
        let square = dot(&r, &r);
        let beta = square / self.square;
        self.p.iter_mut().zip(&r).for_each(|(p, r)| *p = r + beta * *p);
        self.square = square;
        square > SOLVED * self.first
    }
}
