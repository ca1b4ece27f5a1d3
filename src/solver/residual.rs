//! What an answer of one island leaves of the host's loads and gaps, by the host's own data and in twice the digits: nothing of it
//! is rounding but that of the answer.

use crate::error::Result;
use crate::linalg::twofold::Twofold;
use crate::solver::certifier::Certifier;

impl Certifier<'_> {
    /// `f - K u - B'lambda - H'mu` in units of 2^p, for the forces of x.
    pub fn load_left(&self, u: &[f64], x: &[f64]) -> Result<Vec<f64>> {
        let unit = self.ready.island.unit;
        let mut left: Vec<Twofold> = self.scaled.load.iter().map(|&f| f.into()).collect();
        for body in &self.data.bodies {
            body.stiffness.add_twofold(-1.0 / unit, &u[body.range()], &mut left[body.range()])?;
        }
        let (lambda, mu) = self.forces_of_host(x);
        for (rows, forces) in [(self.data.contact, lambda), (self.data.equalities, mu)] {
            for (i, force) in forces.iter().enumerate().filter(|(_, force)| **force != 0.0) {
                rows.matrix.row(i).for_each(|(j, v)| left[j].add_product(-v, force / unit));
            }
        }
        Ok(left.into_iter().map(Twofold::value).collect())
    }

    /// `c + C x - B u` of the rows of the dual, u being the sum of `parts`.
    pub fn gaps_left(&self, parts: &[&[f64]], x: &[f64]) -> Vec<f64> {
        let rows = &self.ready.rows;
        let (lambda, mu) = self.forces_of_host(x);
        let left = self.scaled.gaps.holder.iter().map(|&holder| {
            let (set, i, force) = match holder.checked_sub(rows.contact) {
                None => (self.data.contact, holder, lambda[holder]),
                Some(i) => (self.data.equalities, i, mu[i]),
            };
            let mut left = Twofold::from(set.rhs[i]);
            left.add_product(set.compliance[i], force);
            for part in parts {
                set.matrix.row(i).for_each(|(j, v)| left.add_product(-v, part[j]));
            }
            left.value() * rows.scale[holder]
        });
        rows.decoupling.solve(left.collect())
    }
}

#[cfg(test)]
mod tests {
    use crate::solver::certifier::tests::two_springs;

    /// Springs 1 and 1 pushed by 3 and 1 against walls at 1 and 2.
    #[test]
    fn what_is_left_keeps_its_digits_where_large_numbers_cancel() {
        two_springs(0.0, |judge, _| {
            assert_eq!(judge.load_left(&[1e16, 0.0], &[-1e16, 0.0]).unwrap(), [3.0, 1.0]);
            assert_eq!(judge.gaps_left(&[&[1e16, 1.0], &[-1e16, 0.0]], &[0.0; 2]), [1.0, 1.0]);
        });
    }
}
