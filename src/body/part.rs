//! The end of the elimination: which of the softest motions form the null space, and which are held by weak springs.

use crate::body::digits::Digits;
use crate::body::null_space::largest;
use crate::body::spectrum::{cut, unclear, Doubt, MotionVerdict, Ritz};
use crate::error::Result;
use crate::linalg::{Breakdown, Matrix};

/// The Schur complement S, and eigenvalues and eigenvectors of `D_tt^-1/2 S D_tt^-1/2`, m x m.
pub struct End {
    pub schur: Matrix,
    pub values: Vec<f64>,
    pub vectors: Matrix,
}

/// The softest motions.
pub struct Soft {
    pub schur: Matrix,
    /// m x r, the null vectors at t multiplied by D^1/2.
    pub vectors: Matrix,
    pub gap: f64,
    /// Weak springs hold this number of the last vectors.
    pub weak: usize,
    /// The value of `v'K v / v'D v` that rounding of the entries may cause, no unit.
    pub rounding: f64,
    pub doubt: Option<Doubt>,
}

impl End {
    /// `ritz`: the softest motions measured over the body, empty if the eigenvalues at t suffice. `last`: the dofs t. The
    /// number of `few` digits is only reported, if K holds the body.
    pub fn decided(
        self,
        digits: Option<Digits>,
        few: Option<Digits>,
        last: &[usize],
        mut ritz: Ritz,
    ) -> Result<Soft> {
        let doubt = ritz.doubt(few, ritz.explained(), false);
        if digits.is_none() {
            ritz.take_as_exact();
        }
        let ritz = &ritz;
        let measured = self.vectors.columns(0..ritz.values.len());
        let mut soft = self.null_vectors(digits, &measured, last, ritz)?;
        let free = soft.vectors.cols;
        let told = soft.doubt.is_none() && (digits.is_none() || free == 0);
        soft.weak = if told { ritz.weak(free) } else { 0 };
        if soft.weak > 0 {
            let q = free + soft.weak;
            (soft.vectors, soft.gap) = (ritz.turned(&measured, q)?, ritz.values[q] / ritz.values[q - 1]);
        }
        soft.doubt = soft.doubt.or(doubt.filter(|_| soft.vectors.cols == 0));
        Ok(soft)
    }

    fn null_vectors(
        self,
        digits: Option<Digits>,
        measured: &Matrix,
        last: &[usize],
        ritz: &Ritz,
    ) -> Result<Soft> {
        let Self { schur, values, vectors } = self;
        let dof = last[largest(vectors.col(0), |_| 1.0)];
        let soft = |vectors, gap, rounding, doubt| Ok(Soft { schur, vectors, weak: 0, gap, rounding, doubt });
        // nothing is soft, or the eigenvalues at t suffice
        let told = cut(&values).filter(|_| digits.is_none() || ritz.values.is_empty());
        if let Some((dimension, gap)) = told {
            return soft(vectors.columns(0..dimension), gap, 0.0, None);
        }
        let Some(softest) = ritz.values.first() else {
            return soft(vectors.columns(0..0), f64::INFINITY, 0.0, None);
        };
        let doubt = |motions, free| ritz.doubt(digits, motions, free);
        match ritz.judged(digits) {
            MotionVerdict::Free { dimension, gap } => {
                let turned = ritz.turned(measured, dimension)?;
                let rounding = ritz.noise[..dimension].iter().fold(0.0, |most: f64, v| most.max(*v));
                soft(turned, gap, rounding, doubt(dimension, true))
            }
            MotionVerdict::Held { doubtful, gap } => {
                soft(vectors.columns(0..0), gap, 0.0, doubt(doubtful, false))
            }
            MotionVerdict::Indefinite => Err(Breakdown { dof, relative_pivot: *softest }.indefinite()),
            MotionVerdict::Unclear(digits) => Err(unclear(digits).dof(dof).value(*softest)),
        }
    }
}
