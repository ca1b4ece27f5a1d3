//! K in the form given by the host: entries, elements, or functions for the products.

use crate::body::assembled::Assembled;
use crate::body::host::HostOperator;
use crate::error::Result;
use crate::linalg::twofold::Twofold;
use crate::linalg::Symmetric;
use crate::platform::memory::zeros;

#[derive(Clone, Copy)]
pub enum Stiffness<'a> {
    Matrix(&'a Symmetric),
    Host(&'a HostOperator),
    Assembled(&'a Assembled),
}

impl Stiffness<'_> {
    pub fn order(&self) -> usize {
        match self {
            Self::Matrix(k) => k.order(),
            Self::Host(k) => k.order(),
            Self::Assembled(k) => k.order(),
        }
    }

    /// `D_ii` of the metric for K, or `without` for a dof without stiffness.
    pub fn metric(&self, i: usize, without: f64) -> f64 {
        match self {
            Self::Matrix(k) => k.metric(i, without),
            Self::Host(k) => k.metric(i, without),
            Self::Assembled(k) => k.metric(i, without),
        }
    }

    /// `max D_ii`
    pub fn largest_diagonal(&self) -> f64 {
        match self {
            Self::Matrix(k) => k.largest_diagonal(),
            Self::Host(k) => (0..k.order()).map(|i| k.diagonal(i)).fold(0.0, f64::max),
            Self::Assembled(k) => k.largest_diagonal(),
        }
    }

    /// Number of its entries; of unknowns if the host keeps them.
    pub fn entries(&self) -> usize {
        match self {
            Self::Matrix(k) => k.col.len(),
            Self::Host(k) => k.order(),
            Self::Assembled(k) => k.entries(),
        }
    }

    /// `y = K x`
    pub fn mul(&self, x: &[f64], y: &mut [f64]) -> Result<()> {
        match self {
            Self::Matrix(k) => k.mul(x, y),
            Self::Host(k) => k.mul(x, y)?,
            Self::Assembled(k) => k.mul(x, y)?,
        }
        Ok(())
    }

    /// `y = K x`, and the terms to which its rounding errors are relative: `|K| |x|`, or `D |x| + |K x|` if the entries
    /// are not known.
    pub fn mul_with_terms(&self, x: &[f64], y: &mut [f64], terms: &mut [f64]) -> Result<()> {
        match self {
            Self::Matrix(k) => k.mul_with_terms(x, y, terms),
            Self::Host(k) => k.mul_with_terms(x, y, terms)?,
            Self::Assembled(k) => k.mul_with_terms(x, y, terms)?,
        }
        Ok(())
    }

    /// `y += by K x` in double-double arithmetic, `by` a power of two; in the host's precision if the host computes the
    /// products.
    pub fn add_twofold(&self, by: f64, x: &[f64], y: &mut [Twofold]) -> Result<()> {
        match self {
            Self::Matrix(k) => k.add_twofold(by, x, y),
            Self::Assembled(k) => k.add_twofold(by, x, y)?,
            Self::Host(k) => {
                let mut image = zeros(x.len(), "a product with K")?;
                k.mul(x, &mut image)?;
                y.iter_mut().zip(image).for_each(|(y, image)| y.add(by * image));
            }
        }
        Ok(())
    }

    /// Its products must be computed on the thread that calls the library.
    pub fn on_caller(&self) -> bool {
        matches!(self, Self::Host(k) if k.on_caller())
    }
}

impl<'a> From<&'a Symmetric> for Stiffness<'a> {
    fn from(k: &'a Symmetric) -> Self {
        Self::Matrix(k)
    }
}
