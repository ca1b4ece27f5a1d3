//! A body whose stiffness matrix stays with the host: K and K+ are applied matrix-free, Y = K X and Y = K+ X.

use std::fmt;
use std::sync::Arc;

use crate::body::null_space::Products;
use crate::error::{Error, Kind, Result};
use crate::linalg::vector::first_non_finite;
use crate::linalg::{Csr, Matrix, Packed};
use crate::platform::interrupt;
use crate::platform::memory::{copied, zeros};

/// Limit of right-hand sides per call.
pub const TOGETHER: usize = 32;

const WHAT: &str = "products of the host";

/// A function of the host: X and Y are n x nrhs, column-major without gaps, and nrhs is at most [`TOGETHER`]. It returns
/// 0, or a number of the host for a failure. Y contains zeros on entry.
pub type HostProduct = Box<dyn Fn(&[f64], usize, &mut [f64]) -> i32 + Send + Sync>;

/// The functions of the host for one body.
pub struct HostFunctions {
    /// `Y = K+ X`, X force, Y length; K+ symmetric, positive semidefinite and `K K+ K = K`.
    pub kplus: HostProduct,
    /// `Y = K X`, X length, Y force.
    pub k: HostProduct,
    /// The functions may be called on several threads at once; otherwise only on the thread that calls the library.
    pub concurrent: bool,
}

pub struct HostOperator {
    body: usize,
    /// D = diag K, n numbers >= 0, force / length.
    diagonal: Vec<f64>,
    functions: HostFunctions,
}

impl fmt::Debug for HostOperator {
    fn fmt(&self, out: &mut fmt::Formatter<'_>) -> fmt::Result {
        out.debug_struct("HostOperator").field("body", &self.body).finish_non_exhaustive()
    }
}

impl HostOperator {
    /// `body`: number of the body for errors.
    pub fn new(body: usize, diagonal: Vec<f64>, functions: HostFunctions) -> Self {
        Self { body, diagonal, functions }
    }

    pub fn order(&self) -> usize {
        self.diagonal.len()
    }

    /// The functions must run on the thread that calls the library.
    pub fn on_caller(&self) -> bool {
        !self.functions.concurrent
    }

    /// `K_ii`
    pub fn diagonal(&self, i: usize) -> f64 {
        self.diagonal[i]
    }

    /// `K_ii`, or `without` for a dof without stiffness.
    pub fn metric(&self, i: usize, without: f64) -> f64 {
        Some(self.diagonal[i]).filter(|d| *d > 0.0).unwrap_or(without)
    }

    /// `Y = K X`, any number of columns.
    pub fn mul(&self, x: &[f64], y: &mut [f64]) -> Result<()> {
        self.call("K", &self.functions.k, x, y)
    }

    /// `y = K x` and `terms = D |x| + |K x|`, to which rounding errors of `K x` are relative, since `|K| |x|` is not
    /// known.
    pub fn mul_with_terms(&self, x: &[f64], y: &mut [f64], terms: &mut [f64]) -> Result<()> {
        self.mul(x, y)?;
        for (i, terms) in terms.iter_mut().enumerate() {
            *terms = self.diagonal[i] * x[i].abs() + y[i].abs();
        }
        Ok(())
    }

    /// `Y = K+ X`, any number of columns.
    fn solve(&self, x: &[f64], y: &mut [f64]) -> Result<()> {
        self.call("K+", &self.functions.kplus, x, y)
    }

    /// Calls the function in blocks of columns. Columns that are not finite are not passed: their image is NaN.
    fn call(&self, name: &str, function: &HostProduct, x: &[f64], y: &mut [f64]) -> Result<()> {
        let n = self.order();
        if first_non_finite(x).is_some() {
            y.fill(f64::NAN);
            return Ok(());
        }
        y.fill(0.0);
        let failed = |what: String| Error::new(Kind::Callback, what).body(self.body);
        for (x, y) in x.chunks(n * TOGETHER).zip(y.chunks_mut(n * TOGETHER)) {
            interrupt::check()?;
            let number = interrupt::never(|| function(x, x.len() / n, y));
            if number != 0 {
                let what = format!("the host's function for the products with {name} returned {number}");
                return Err(failed(what).value(f64::from(number)));
            }
            if let Some(at) = first_non_finite(y) {
                let what = format!("the host's product with {name} is not a finite number here");
                return Err(failed(what).dof(at % n).value(y[at]));
            }
        }
        Ok(())
    }
}

/// `K / 2^p` and `2^p K+`: only the exponents change.
#[derive(Debug, Clone)]
pub struct HostMultiple {
    pub operator: Arc<HostOperator>,
    /// 2^p, force / length.
    pub unit: f64,
}

impl HostMultiple {
    /// `Y = 2^p K+ X`
    pub fn solve(&self, x: &[f64], y: &mut [f64]) -> Result<()> {
        self.operator.solve(x, y)?;
        y.iter_mut().for_each(|y| *y *= self.unit);
        Ok(())
    }

    /// `x <- 2^p K+ x`
    pub fn solve_in_place(&self, x: &mut [f64]) -> Result<()> {
        let given = copied(x, WHAT)?;
        self.solve(&given, x)
    }

    /// `Y = K X / 2^p`
    pub fn mul(&self, x: &[f64], y: &mut [f64]) -> Result<()> {
        self.operator.mul(x, y)?;
        y.iter_mut().for_each(|y| *y /= self.unit);
        Ok(())
    }

    /// `B K+ B'` for the rows B (m x n) of this body: the entries below the diagonal, column by column.
    pub fn inverse_form(&self, rows: &Csr) -> Result<Packed> {
        let m = rows.rows();
        let mut form = Packed::zeros(m)?;
        let all: Vec<usize> = (0..m).collect();
        self.columns(rows, &all, |j, moved| {
            (j..m).for_each(|i| form.add(i, j, rows.row_dot(i, moved)));
        })?;
        Ok(form)
    }

    /// The columns `which` of `B K+ B'`, m x `which.len()`.
    pub fn inverse_columns(&self, rows: &Csr, which: &[usize]) -> Result<Matrix> {
        let mut columns = Matrix::zeros(rows.rows(), which.len())?;
        self.columns(rows, which, |k, moved| {
            columns.col_mut(k).iter_mut().enumerate().for_each(|(i, v)| *v = rows.row_dot(i, moved));
        })?;
        Ok(columns)
    }

    /// Calls `keep` with the index of j in `which` and `2^p K+ b_j'`, for every j in `which`.
    fn columns(&self, rows: &Csr, which: &[usize], mut keep: impl FnMut(usize, &[f64])) -> Result<()> {
        let n = self.operator.order();
        let room = n * which.len().min(TOGETHER);
        let (mut forces, mut moved) = (zeros(room, WHAT)?, zeros(room, WHAT)?);
        for (block, which) in which.chunks(TOGETHER).enumerate() {
            let (forces, moved) = (&mut forces[..n * which.len()], &mut moved[..n * which.len()]);
            forces.fill(0.0);
            for (force, &j) in forces.chunks_mut(n).zip(which) {
                rows.row(j).for_each(|(dof, v)| force[dof] += v);
            }
            self.solve(forces, moved)?;
            moved.chunks(n).enumerate().for_each(|(k, moved)| keep(block * TOGETHER + k, moved));
        }
        Ok(())
    }
}

/// Relative to `D |X|`, since the entries of K are not known.
impl Products for HostMultiple {
    const TERMS: &'static str = "D |R|";

    fn metric(&self, i: usize, without: f64) -> f64 {
        Some(self.operator.diagonal(i) / self.unit).filter(|d| *d > 0.0).unwrap_or(without)
    }

    fn mul_columns(&self, x: &Matrix) -> Result<(Matrix, Matrix)> {
        let (mut y, mut terms) = (Matrix::zeros(x.rows, x.cols)?, Matrix::zeros(x.rows, x.cols)?);
        self.mul(&x.data, &mut y.data)?;
        for (at, terms) in terms.data.iter_mut().enumerate() {
            *terms = self.metric(at % x.rows, 1.0) * x.data[at].abs();
        }
        Ok((y, terms))
    }
}
