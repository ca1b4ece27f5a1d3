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

    /// `max D_jj` of the metric, 0 without stiffness.
    pub fn stiffest(&self) -> f64 {
        (0..self.order()).map(|i| self.metric(i, 0.0)).fold(0.0, f64::max)
    }

    /// D at these unknowns, 0 without stiffness.
    pub fn diagonal_at(&self, dofs: &[u32]) -> Vec<f64> {
        dofs.iter().map(|dof| self.metric(*dof as usize, 0.0)).collect()
    }

    /// Visits row, column and value of every entry of the lower triangle; false if the host keeps them. Contributions of two
    /// pieces to one entry are two entries.
    pub fn each_entry(&self, mut visit: impl FnMut(usize, usize, f64)) -> bool {
        match self {
            Self::Matrix(k) => {
                (0..k.order()).for_each(|i| k.lower_row(i).for_each(|(j, v)| visit(i, j, v)));
            }
            Self::Assembled(k) => k.each_entry(visit),
            Self::Host(_) => return false,
        }
        true
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
