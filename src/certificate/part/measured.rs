//! Equilibrium, balance, deformation and energy of one body, `res = K u - f + r`.

use super::{Felt, Part, WHAT};
use crate::body::{wire_struct, Local, Name, Question};
use crate::certificate::{positive, share, Load, NOISE};
use crate::error::Result;
use crate::linalg::twofold::Twofold;
use crate::linalg::vector::{ratio, weighted_norm};
use crate::linalg::Matrix;
use crate::platform::memory::{copied, filled};

wire_struct!(Measure { free, limit, idle });
wire_struct!(Measured {
    deformation,
    neighbours,
    strain,
    own_strain,
    leverage,
    equilibrium,
    grounded,
    balance,
    excused,
    cancelled,
    stored,
    work,
    terms,
    forces,
});

/// Asks for what the certificate measures, by what the island has decided.
pub struct Measure {
    /// Amplitudes of the motions that rows leave free, r, length.
    pub free: Vec<f64>,
    /// tol, no unit.
    pub limit: f64,
    /// Forces on this body below this count as zero, force.
    pub idle: f64,
}

/// What a body tells in the end.
pub struct Measured {
    /// Deformation where rows touch, t, length.
    pub deformation: Vec<f64>,
    /// `sum_k |K_jk| delta_k` there, t, force.
    pub neighbours: Vec<f64>,
    /// `U |delta|_D` without grounded unknowns, force, and the same without carried ones, whose deformation follows from the forces of
    /// rows, also of those that cancel.
    pub strain: f64,
    pub own_strain: f64,
    /// The largest `(|f_j| + |r_j|) / |D_j u_j|` of a grounded unknown, no unit.
    pub leverage: f64,
    /// Ratios to what is allowed, no unit: of the residual, of that of a grounded unknown, and of the balance.
    pub equilibrium: f64,
    pub grounded: f64,
    pub balance: f64,
    /// The residual that is excused by rounding, and by rounding of row forces that cancel, force.
    pub excused: f64,
    pub cancelled: f64,
    /// `u'K u`, `f'u`, `|u|'(|K||u| + |f| + |B'||lambda| + |H'||mu|)`, force x length.
    pub stored: f64,
    pub work: f64,
    pub terms: f64,
    /// `||f| + |B'||lambda| + |H'||mu||_{D^-1}` in D^, force.
    pub forces: f64,
}

/// `K u` and `|K||u|`, n_p, force.
struct Products {
    strain: Vec<f64>,
    terms: Vec<f64>,
}

impl Question for Measure {
    const NAME: Name = Name::Measure;
    type Answer = Measured;
    type Kept = ();
    type Given = (Felt, Vec<f64>, Load);

    fn answer(self, body: &Local, _: &mut (), given: (&Felt, &Vec<f64>, &Load)) -> Result<Measured> {
        let (felt, u, load) = given;
        Part { body, felt, u, load }.measured(&self)
    }
}

impl Part<'_> {
    fn measured(&self, by: &Measure) -> Result<Measured> {
        let (delta, u) = (self.deformation(&by.free)?, self.u);
        let delta_products = self.products(&delta)?;
        let (strain, own_strain) = self.strains(&delta);
        let products = self.products(u)?;
        let given: Vec<f64> = self.dofs().map(|j| self.load(j).abs() + self.felt.push_terms[j]).collect();
        let loads: Vec<f64> = self.dofs().map(|j| self.load(j)).collect();
        let terms = u.iter().zip(&products.terms).zip(&given).map(|((u, t), g)| u.abs() * (t + g));
        let residual = |j: usize| self.residual(&products, j);
        let excused = self.free(|j| {
            let (residual, noise) = residual(j);
            residual.abs().min(noise)
        });
        let cancelled: Vec<f64> =
            self.dofs().map(|j| residual(j).0.abs().min(NOISE * self.felt.push_terms[j])).collect();
        Ok(Measured {
            neighbours: self.body.at_rows(&delta_products.terms),
            deformation: self.body.at_rows(&delta),
            strain,
            own_strain,
            leverage: self.leverage(),
            equilibrium: self.equilibrium(by, &products),
            grounded: self.equilibrium_of_grounded(by, &products),
            balance: self.balance(by)?,
            excused: self.size(&excused),
            cancelled: self.size(&cancelled),
            // rounding of a long sum would be many times that of its terms
            stored: Twofold::dot(u, &products.strain),
            work: Twofold::dot(&loads, u),
            terms: terms.sum(),
            forces: self.led_size(&given),
        })
    }

    fn products(&self, v: &[f64]) -> Result<Products> {
        let (strain, terms) = self.body.products(v, WHAT)?;
        Ok(Products { strain, terms })
    }

    /// `|r_j| / D~_j` of grounded and carried unknowns, r the forces of the rows; `|u - R a|` of the others. What a carried unknown
    /// passes into the ground by a row of its own deforms nothing.
    fn deformation(&self, free: &[f64]) -> Result<Vec<f64>> {
        let (Felt { told, metric, push, .. }, u) = (self.felt, self.u);
        let mut left = copied(u, WHAT)?;
        self.motions().0.mul_add(-1.0, free, &mut left);
        left.iter_mut().for_each(|v| *v = v.abs());
        let given = |push: f64, metric: f64, u: f64| (push.abs() / told.unit / metric).min(u.abs());
        let grounded = self.dofs().filter(|j| self.felt.grounded[*j]);
        grounded.for_each(|j| left[j] = given(push[j], metric[j], u[j]));
        for (k, &dof) in self.body.touched.iter().enumerate().filter(|(k, _)| told.carried[*k]) {
            let dof = dof as usize;
            left[dof] = given(told.passed_on[k], told.metric[k], u[dof]);
        }
        Ok(left)
    }

    fn strains(&self, delta: &[f64]) -> (f64, f64) {
        let (Felt { told, metric, .. }, u) = (self.felt, self.u);
        let mut strain = self.free(|j| positive(delta[j] - NOISE * u[j].abs()));
        let size = |strain: &[f64]| told.unit * weighted_norm(strain, |j| metric[j]);
        let all = size(&strain);
        if !told.carried.contains(&true) {
            return (all, all);
        }
        let carried = self.body.touched.iter().zip(&told.carried).filter(|(_, carried)| **carried);
        carried.for_each(|(dof, _)| strain[*dof as usize] = 0.0);
        (all, size(&strain))
    }

    fn leverage(&self) -> f64 {
        let of = |j: usize| {
            let acting = self.load(j).abs() + self.felt.push[j].abs();
            ratio(acting / self.felt.told.unit, self.felt.metric[j] * self.u[j].abs())
        };
        self.dofs().filter(|j| self.felt.grounded[*j]).map(of).fold(0.0, f64::max)
    }

    /// `res_j`, force, and 64 eps times its terms `t = |K||u| + |f| + |B'||lambda| + |H'||mu|`.
    fn residual(&self, products: &Products, j: usize) -> (f64, f64) {
        let f = self.load(j);
        let noise = NOISE * (products.terms[j] + f.abs() + self.felt.push_terms[j]);
        (products.strain[j] - f + self.felt.push[j], noise)
    }

    /// `|(|res_j| - 64 eps t_j)_+|_{D^-1}` relative to `tol (|f| + |r| + |K u|)_{D^-1}`, without grounded unknowns; no unit.
    fn equilibrium(&self, by: &Measure, products: &Products) -> f64 {
        let Some(size) = self.felt.sizes.all else { return 0.0 };
        let left = self.free(|j| {
            let (residual, noise) = self.residual(products, j);
            positive(residual.abs() - noise)
        });
        let strain = self.size(&self.free(|j| products.strain[j]));
        share(self.size(&left), by.limit * (size + strain) + by.idle)
    }

    /// `(|res_j| - 64 eps t_j)_+` relative to `tol (|r_j| + sum_k |K_jk||u_k|)`, the worst grounded unknown; no unit.
    fn equilibrium_of_grounded(&self, by: &Measure, products: &Products) -> f64 {
        let of = |j: usize| {
            let (residual, noise) = self.residual(products, j);
            let size = self.felt.push[j].abs() + products.terms[j];
            share(positive(residual.abs() - noise), by.limit * size)
        };
        let worse = |worst: f64, share: f64| if share <= worst || worst.is_nan() { worst } else { share };
        self.dofs().filter(|j| self.felt.grounded[*j]).map(of).fold(0.0, worse)
    }

    /// `|R'(f - r)|` relative to `tol (|f| + |r|)_{D^-1} + 64 eps ||f| + |B'||lambda| + |H'||mu||_{D^-1}`, without grounded
    /// unknowns; no unit. u has no influence: the forces of a body must balance however far it has moved. For soft motions
    /// `(K R)'u` is part of the balance.
    fn balance(&self, by: &Measure) -> Result<f64> {
        let (body, (motions, unit), sizes) = (self.body, self.motions(), self.felt.sizes);
        let Some(size) = sizes.all.filter(|_| motions.cols > 0) else { return Ok(0.0) };
        let allowed = by.limit * size + NOISE * sizes.terms + by.idle;
        // soft motions bend the body, and move grounded unknowns a little
        let felt = |value: &dyn Fn(usize) -> f64| -> Vec<f64> {
            if body.soft {
                self.dofs().map(value).collect()
            } else {
                self.free(value)
            }
        };
        let mut resultants = motions.mul_transposed(&felt(&|j| self.load(j) - self.felt.push[j]));
        let weight = self.felt.told.unit / unit;
        let of_grounded = if body.soft { self.terms_of_grounded() } else { 0.0 };
        let allowed = allowed + NOISE * of_grounded * weight.sqrt();
        let ratio = share(weighted_norm(&resultants, |_| weight), allowed);
        if ratio <= 1.0 && !body.soft {
            return Ok(ratio);
        }
        let u = felt(&|j| self.u[j]);
        let held =
            if body.soft { held_softly(body, motions, &u)? } else { self.resisted()?.mul_transposed(&u) };
        resultants.iter_mut().zip(held).for_each(|(left, held)| *left -= held);
        Ok(share(weighted_norm(&resultants, |_| weight), allowed))
    }

    /// `sum_j max_k |R_jk| (|f_j| + sum |b_j||lambda|)` over the grounded unknowns.
    fn terms_of_grounded(&self) -> f64 {
        let motions = self.motions().0;
        let of = |j: usize| {
            let fastest = |most: f64, k: usize| most.max(motions.get(j, k).abs());
            (0..motions.cols).fold(0.0, fastest) * (self.load(j).abs() + self.felt.push_terms[j])
        };
        self.dofs().filter(|j| self.felt.grounded[*j]).map(of).sum()
    }

    /// `K R`, n_p x r, force / length; 0 if it is rounding.
    fn resisted(&self) -> Result<Matrix> {
        let motions = self.motions().0;
        let (n, r) = (motions.rows, motions.cols);
        let (mut all, mut terms) = (Matrix::zeros(n, r)?, vec![0.0; n]);
        for k in 0..r {
            self.body.stiffness.mul_with_terms(motions.col(k), all.col_mut(k), &mut terms)?;
            let rounding = |(v, t): &(&mut f64, &f64)| v.abs() <= NOISE * **t;
            all.col_mut(k).iter_mut().zip(&terms).filter(rounding).for_each(|(v, _)| *v = 0.0);
        }
        Ok(all)
    }
}

/// `(K R)'u` of a body, r, in double-double arithmetic: for a weak spring the terms nearly cancel, and if K R is rounding
/// of R the sum is 0 for any u.
fn held_softly(body: &Local, motions: &Matrix, u: &[f64]) -> Result<Vec<f64>> {
    let by_motion = |k: usize| {
        let mut image = filled(u.len(), Twofold::default(), "the balance of a body")?;
        body.stiffness.add_twofold(1.0, motions.col(k), &mut image)?;
        let image: Vec<f64> = image.into_iter().map(Twofold::value).collect();
        Ok(Twofold::dot(&image, u))
    };
    (0..motions.cols).map(by_motion).collect()
}
