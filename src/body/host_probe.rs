//! Checks the functions of the host: K symmetric, `K R = 0` for the whole null space, K+ symmetric, both positive
//! semidefinite, `K K+ K = K`. A few fixed vectors are tested: they find every error that affects most vectors. Forces
//! are measured in the metric `D^-1` and displacements in D, so that no number has a unit.

use crate::body::candidates::verified;
use crate::body::generalized_inverse::GeneralizedInverse;
use crate::body::host::HostMultiple;
use crate::body::null_space::{largest, NullSpaceInput, Products, Verified};
use crate::body::probe::Factor;
use crate::error::{Error, Kind, Result};
use crate::linalg::random::Random;
use crate::linalg::vector::NOISE;
use crate::linalg::vector::{axpy, dot, ratio, weighted_norm};
use crate::linalg::Matrix;
use crate::numbers::body::{NEGATIVE, PROBE, UNLIKELY};

/// Number of test displacements x and of test forces b.
const DISPLACEMENTS: usize = 3;
const FORCES: usize = 2;
/// A motion v outside R belongs to the null space if `|K v| < MISSING |v|`. K+ reproduces K x no better than this, so an
/// error of K+ along a softer motion could not be detected.
const MISSING: f64 = 10.0 * PROBE;

impl GeneralizedInverse {
    /// K+ of the host, after checks of K, K+ and the null space.
    pub fn of_host(k: HostMultiple, given: &NullSpaceInput, tolerance: f64) -> Result<Self> {
        let Verified { basis: null_space, error, misfit } = verified(&k, given, tolerance)?;
        Probe::new(&k, &null_space)?.judge()?;
        Ok(Self {
            null_space,
            stiffness: Vec::new(),
            rounding: NOISE,
            error,
            fixing: Vec::new(),
            gap: None,
            softness: 1.0,
            doubt: None,
            misfit,
            factor: Factor::Host(k),
            carried: None,
            near: None,
        })
    }
}

/// Random x and b with their images.
struct Probe<'a> {
    k: &'a HostMultiple,
    null_space: &'a Matrix,
    x: Matrix,
    b: Matrix,
    /// K X
    kx: Matrix,
    /// `K+ K X` and `K+ B`
    z: Matrix,
    kplus_b: Matrix,
}

impl<'a> Probe<'a> {
    fn new(k: &'a HostMultiple, null_space: &'a Matrix) -> Result<Self> {
        let (n, mut random) = (k.operator.order(), Random::default());
        let root = |i: usize| k.metric(i, 1.0).sqrt();
        let empty = |columns| Matrix::zeros(n, columns);
        let (mut x, mut b) = (empty(DISPLACEMENTS)?, empty(FORCES)?);
        for j in 0..DISPLACEMENTS {
            x.col_mut(j).copy_from_slice(&random.vector(n, |i| 1.0 / root(i))?);
        }
        for j in 0..FORCES {
            b.col_mut(j).copy_from_slice(&random.vector(n, root)?);
        }
        let (mut kx, mut z, mut kplus_b) = (empty(DISPLACEMENTS)?, empty(DISPLACEMENTS)?, empty(FORCES)?);
        k.mul(&x.data, &mut kx.data)?;
        k.solve(&kx.data, &mut z.data)?;
        k.solve(&b.data, &mut kplus_b.data)?;
        Ok(Self { k, null_space, x, b, kx, z, kplus_b })
    }

    fn length(&self, v: &[f64]) -> f64 {
        weighted_norm(v, |i| self.k.metric(i, 1.0))
    }

    fn force(&self, v: &[f64]) -> f64 {
        weighted_norm(v, |i| 1.0 / self.k.metric(i, 1.0))
    }

    fn judge(&self) -> Result<()> {
        self.symmetric()?;
        self.semidefinite()?;
        self.reproduces()?;
        (0..DISPLACEMENTS).try_for_each(|j| self.complete(j))
    }

    /// `x_1'K x_2 = x_2'K x_1`, `b_1'K+ b_2 = b_2'K+ b_1`
    fn symmetric(&self) -> Result<()> {
        let skew =
            |a: &Matrix, image: &Matrix| (dot(a.col(0), image.col(1)) - dot(a.col(1), image.col(0))).abs();
        let refused = |name: &str, found: f64, limit: f64| {
            let what = format!(
                "the host's {name} is not symmetric: |a'{name} b - b'{name} a| = {found:.1e} of |a||{name} b| + |b||{name} a|"
            );
            Err(Error::new(Kind::Callback, what).value(found).limit(limit))
        };
        let (x, kx) =
            ([0, 1].map(|j| self.length(self.x.col(j))), [0, 1].map(|j| self.force(self.kx.col(j))));
        let found = ratio(skew(&self.x, &self.kx), x[0] * kx[1] + x[1] * kx[0]);
        if found > NEGATIVE {
            return refused("K", found, NEGATIVE);
        }
        let (b, moved) =
            ([0, 1].map(|j| self.force(self.b.col(j))), [0, 1].map(|j| self.length(self.kplus_b.col(j))));
        let whole = b[0] * moved[1] + b[1] * moved[0];
        let found = ratio(skew(&self.b, &self.kplus_b), whole);
        let limit = PROBE + ratio(NOISE * moved[0] * moved[1], whole);
        if found > limit {
            return refused("K+", found, limit);
        }
        Ok(())
    }

    /// `x'K x >= 0`, `b'K+ b >= 0`
    fn semidefinite(&self) -> Result<()> {
        let refused = |name: &str, found: f64, limit: f64| {
            let what = format!(
                "the host's {name} is not positive semidefinite: v'{name} v = {found:.1e} |v||{name} v|"
            );
            Err(Error::new(Kind::Indefinite, what).value(found).limit(-limit))
        };
        for j in 0..DISPLACEMENTS {
            let (x, kx) = (self.x.col(j), self.kx.col(j));
            let found = ratio(dot(x, kx), self.length(x) * self.force(kx));
            if found < -NEGATIVE {
                return refused("K", found, NEGATIVE);
            }
        }
        for j in 0..FORCES {
            let (b, moved) = (self.b.col(j), self.kplus_b.col(j));
            let whole = self.force(b) * self.length(moved);
            let limit = PROBE + ratio(NOISE * self.length(moved), self.force(b));
            let found = ratio(dot(b, moved), whole);
            if found < -limit {
                return refused("K+", found, limit);
            }
        }
        Ok(())
    }

    /// `K K+ K x = K x`
    fn reproduces(&self) -> Result<()> {
        let mut image = Matrix::zeros(self.x.rows, DISPLACEMENTS)?;
        self.k.mul(&self.z.data, &mut image.data)?;
        for j in 0..DISPLACEMENTS {
            let (kx, left) = (self.kx.col(j), image.col_mut(j));
            axpy(-1.0, kx, left);
            let (found, size) = (self.force(left), self.force(kx));
            let limit = PROBE + ratio(NOISE * self.length(self.z.col(j)), size);
            let found = ratio(found, size);
            if found.is_nan() || found > limit {
                let what =
                    format!("the host's K+ is no inverse of its K: |K K+ K v - K v| = {found:.1e} |K v|");
                let dof = largest(left, |i| 1.0 / self.k.metric(i, 1.0));
                return Err(Error::new(Kind::Callback, what).dof(dof).value(found).limit(limit));
            }
        }
        Ok(())
    }

    /// `(I - K+ K) x` is a null vector with parts of all null vectors: R must span it. If it is not a null vector, its
    /// resistance is rounding amplified by K+, which is no error.
    fn complete(&self, j: usize) -> Result<()> {
        let n = self.x.rows;
        let mut left = self.x.col(j).to_vec();
        axpy(-1.0, self.z.col(j), &mut left);
        let weighted: Vec<f64> = left.iter().enumerate().map(|(i, v)| v * self.k.metric(i, 1.0)).collect();
        let known = self.null_space.mul_transposed(&weighted);
        self.null_space.mul_add(-1.0, &known, &mut left);
        let size = self.length(&left);
        if size <= self.length(self.x.col(j)) / (UNLIKELY * (n as f64).sqrt()) {
            return Ok(());
        }
        let mut image = vec![0.0; n];
        self.k.mul(&left, &mut image)?;
        let found = self.force(&image) / size;
        if found > MISSING {
            return Ok(());
        }
        let what = format!(
            "a mode is missing: the host's K has more than the {} null vectors known; one is largest at this dof \
             (|K v| = {found:.1e} |v|)",
            self.null_space.cols
        );
        let dof = largest(&left, |i| self.k.metric(i, 1.0));
        Err(Error::new(Kind::NullSpace, what).dof(dof).value(found).limit(MISSING))
    }
}
