//! The entries of a certificate.

/// One condition: its worst place and its violation there.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Entry {
    /// `limit x ratio`, no unit: the violation relative to the measure of the condition, including rounding.
    pub figure: f64,
    /// Violation divided by the allowed violation, no unit: the condition holds if this is at most 1.
    pub ratio: f64,
    /// Body, row or node with friction; none if nothing is violated, and for the duality gap.
    pub place: Option<usize>,
    /// The rank whose number it is.
    pub rank: usize,
}

impl Entry {
    /// `limit`: no unit.
    pub(super) fn new(ratio: f64, limit: f64, place: Option<usize>) -> Self {
        // a ratio of 0 has no place; NaN has one
        Self { figure: limit * ratio, ratio, place: place.filter(|_| ratio != 0.0), rank: 0 }
    }

    /// Replaces this entry if `other` is worse; if both are equal, it stays.
    pub(super) fn replace_if_worse(&mut self, other: Entry) {
        let not_known = other.ratio.is_nan() && !self.ratio.is_nan();
        if other.ratio > self.ratio || not_known {
            *self = other;
        }
    }
}

#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Certificate {
    /// Largest figure allowed, no unit.
    pub limit: f64,
    /// `K u - f + B'lambda + H'mu`, worst body.
    pub equilibrium: Entry,
    /// `R'(f - B'lambda - H'mu)`, worst body.
    pub balance: Entry,
    /// `(b_i u - c_i - C_i lambda_i)_+`, worst row.
    pub penetration: Entry,
    /// `|h_i u - h_i - C_i mu_i|`, worst row.
    pub equality: Entry,
    /// `(lambda_i)_-`, worst row.
    pub negative_force: Entry,
    /// The smaller of open gap and force, each relative to its limit, worst row.
    pub complementarity: Entry,
    /// `(|lambda_t| - b)_+`, `b = bound + mu lambda_n`, worst node with friction.
    pub friction_cone: Entry,
    /// `|lambda_t - P_b(lambda_t + k s)|`: error of a force that is too small or not along the slip, or slip at a node
    /// that sticks, worst node with friction.
    pub friction_work: Entry,
    /// `|s| (b - |lambda_t|)_+ / b`: slip although the force is below its bound, worst node with friction.
    pub friction_stick: Entry,
    /// `|u'K u - f'u + c'lambda + h'mu + s_old'lambda_t + lambda'C lambda + mu'C mu + lambda_t'C_t lambda_t + sum b |s||`
    pub duality_gap: Entry,
    /// `1/2 u'K u - f'u + 1/2 lambda'C lambda + 1/2 mu'C mu + 1/2 lambda_t'C_t lambda_t`, force x length: including the
    /// springs of compliant rows, without the dissipation of friction. Without friction this is the minimum.
    pub energy: f64,
}

impl Certificate {
    pub fn entries(&self) -> [Entry; 10] {
        [
            self.equilibrium,
            self.balance,
            self.penetration,
            self.equality,
            self.negative_force,
            self.complementarity,
            self.friction_cone,
            self.friction_work,
            self.friction_stick,
            self.duality_gap,
        ]
    }

    /// Name of every entry and of its place, in the order of `entries`.
    pub const NAMES: [(&'static str, &'static str); 10] = [
        ("equilibrium", "body"),
        ("balance", "body"),
        ("penetration", "contact row"),
        ("equality", "equality row"),
        ("negative force", "contact row"),
        ("complementarity", "contact row"),
        ("friction cone", "node"),
        ("friction work", "node"),
        ("friction stick", "node"),
        ("duality gap", ""),
    ];

    /// Largest ratio of all entries.
    pub fn worst(&self) -> f64 {
        let mut worst = Entry::default();
        self.entries().into_iter().for_each(|entry| worst.replace_if_worse(entry));
        worst.ratio
    }

    /// All ratios are at most 1; NaN fails.
    pub fn passed(&self) -> bool {
        self.entries().iter().all(|entry| entry.ratio <= 1.0)
    }

    /// Merges the certificate of another island: the worst of each entry, and the sum of the energies.
    pub fn merge(&mut self, other: &Certificate) {
        self.limit = self.limit.max(other.limit);
        self.equilibrium.replace_if_worse(other.equilibrium);
        self.balance.replace_if_worse(other.balance);
        self.penetration.replace_if_worse(other.penetration);
        self.equality.replace_if_worse(other.equality);
        self.negative_force.replace_if_worse(other.negative_force);
        self.complementarity.replace_if_worse(other.complementarity);
        self.friction_cone.replace_if_worse(other.friction_cone);
        self.friction_work.replace_if_worse(other.friction_work);
        self.friction_stick.replace_if_worse(other.friction_stick);
        self.duality_gap.replace_if_worse(other.duality_gap);
        self.energy += other.energy;
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn entry(ratio: f64, place: usize) -> Entry {
        Entry::new(ratio, 1e-8, Some(place))
    }

    #[test]
    fn the_worst_of_two_islands_counts_and_their_energies_add_up() {
        let mut all =
            Certificate { limit: 1e-8, balance: entry(0.5, 3), energy: -1.0, ..Certificate::default() };
        let other = Certificate { balance: entry(2.0, 7), penetration: entry(0.1, 4), energy: -2.0, ..all };
        all.merge(&other);
        assert_eq!((all.balance.place, all.penetration.place, all.energy), (Some(7), Some(4), -3.0));
        assert_eq!((all.worst(), all.balance.figure, all.passed()), (2.0, 2e-8, false));
    }

    #[test]
    fn what_is_no_number_is_worse_than_any_and_stays() {
        let mut all = Certificate { equality: entry(f64::NAN, 2), ..Certificate::default() };
        all.merge(&Certificate { equality: entry(1e300, 5), ..Certificate::default() });
        assert!(all.equality.ratio.is_nan() && all.equality.place == Some(2) && all.worst().is_nan());
        let mut known = Certificate { equality: entry(1e300, 5), ..Certificate::default() };
        known.merge(&all);
        assert!(!known.passed() && known.equality.place == Some(2));
    }
}
