//! Parallel rows: one multiplier is enough for all of them.

use std::collections::HashMap;

use crate::constraints::RowKind;
use crate::linalg::Csr;
use crate::numbers::rounding;

/// The stack of contact rows, equality rows and tangential rows, and which of them are parallel.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Grouping {
    /// First row of every group; the first equality row if the group has one.
    pub leaders: Vec<usize>,
    /// Group of every row and the sign of its direction relative to that of the leader; none for contact and equality rows
    /// without entries.
    pub member: Vec<Option<(usize, f64)>>,
}

impl Grouping {
    /// `matrix`: rigid rows of unit length in the metric `D^-1`, D = `metric`, and compliant rows; the first `contact`
    /// rows are contact rows, those from `tangential` on tangential rows. Opposite contact rows form two groups: they
    /// bound one gap from two sides. A row marked in `alone` forms its own group: parallel springs share a gap but not a
    /// force, and nodes with friction have separate laws.
    pub fn of(
        matrix: &Csr,
        (contact, tangential): (usize, usize),
        metric: &[f64],
        alone: impl Fn(usize) -> bool,
    ) -> Self {
        let mut grouping = Self { leaders: Vec::new(), member: vec![None; matrix.rows()] };
        let mut known: HashMap<&[usize], Vec<usize>> = HashMap::new();
        for i in (contact..tangential).chain(0..contact).chain(tangential..matrix.rows()) {
            let columns = &matrix.col[matrix.ptr[i]..matrix.ptr[i + 1]];
            if i >= tangential || (alone(i) && !columns.is_empty()) {
                grouping.member[i] = Some((grouping.leaders.len(), 1.0));
                grouping.leaders.push(i);
                continue;
            }
            if columns.is_empty() {
                continue;
            }
            let candidates = known.entry(columns).or_default();
            let found = candidates.iter().find_map(|&group| {
                let leader = grouping.leaders[group];
                let sign = parallel(matrix, i, leader, metric)?;
                (sign > 0.0 || leader >= contact).then_some((group, sign))
            });
            grouping.member[i] = Some(found.unwrap_or_else(|| {
                candidates.push(grouping.leaders.len());
                grouping.leaders.push(i);
                (grouping.leaders.len() - 1, 1.0)
            }));
        }
        grouping
    }

    /// Rows with entries: number, group and sign.
    pub fn members(&self) -> impl Iterator<Item = (usize, (usize, f64))> + '_ {
        self.member.iter().enumerate().filter_map(|(i, member)| member.map(|member| (i, member)))
    }

    /// Number of groups with leaders before a row.
    pub fn led_before(&self, row: usize) -> usize {
        self.leaders.iter().filter(|&&leader| leader < row).count()
    }

    /// Kind of the multiplier of a group, by its leader: a contact row, a tangential row, or an equality row.
    pub fn kind(&self, group: usize, contact: usize, tangential: usize) -> RowKind {
        match self.leaders[group] {
            leader if leader < contact => RowKind::Inequality,
            leader if leader < tangential => RowKind::Equality,
            _ => RowKind::Tangential,
        }
    }
}

/// +1 if unit rows i and j (same columns) are equal, -1 if they are opposite.
fn parallel(matrix: &Csr, i: usize, j: usize, metric: &[f64]) -> Option<f64> {
    let distance = |sign: f64| {
        let terms =
            matrix.row(i).zip(matrix.row(j)).map(|((k, a), (_, b))| (a - sign * b).powi(2) / metric[k]);
        terms.sum::<f64>().sqrt()
    };
    [1.0, -1.0].into_iter().find(|&sign| distance(sign) <= rounding::METHOD)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn parallel_rows_share_a_group_and_opposite_contact_rows_do_not() {
        let mut matrix = Csr::empty(2);
        matrix.push_row([(0, 0.6), (1, 0.8)]);
        matrix.push_row([(0, -0.6), (1, -0.8)]);
        matrix.push_row([(0, 0.6), (1, 0.8)]);
        matrix.push_row([]);
        matrix.push_row([(0, 1.0)]);
        let grouping = Grouping::of(&matrix, (4, 5), &[1.0; 2], |_| false);
        assert_eq!(grouping.leaders, [4, 0, 1]);
        assert_eq!(grouping.member, [Some((1, 1.0)), Some((2, 1.0)), Some((1, 1.0)), None, Some((0, 1.0))]);
        assert_eq!(grouping.kind(0, 4, 5), RowKind::Equality);
    }

    #[test]
    fn a_contact_row_along_an_equality_row_joins_it_with_either_sign() {
        let mut matrix = Csr::empty(1);
        matrix.push_row([(0, -1.0)]);
        matrix.push_row([(0, 1.0)]);
        let grouping = Grouping::of(&matrix, (1, 2), &[1.0], |_| false);
        assert_eq!(grouping.member, [Some((0, -1.0)), Some((0, 1.0))]);
    }

    #[test]
    fn a_compliant_row_stays_alone() {
        let mut matrix = Csr::empty(1);
        (0..4).for_each(|_| matrix.push_row([(0, 1.0)]));
        let grouping = Grouping::of(&matrix, (3, 4), &[1.0], |i| i == 0 || i == 3);
        assert_eq!(grouping.leaders, [3, 0, 1]);
        assert_eq!(grouping.member, [Some((1, 1.0)), Some((2, 1.0)), Some((2, 1.0)), Some((0, 1.0))]);
    }

    #[test]
    fn a_tangential_row_stays_alone_and_comes_last() {
        let mut matrix = Csr::empty(1);
        (0..4).for_each(|_| matrix.push_row([(0, 1.0)]));
        let grouping = Grouping::of(&matrix, (1, 2), &[1.0], |_| false);
        assert_eq!(grouping.leaders, [1, 2, 3]);
        assert_eq!(grouping.member, [Some((0, 1.0)), Some((0, 1.0)), Some((1, 1.0)), Some((2, 1.0))]);
        assert_eq!(grouping.kind(1, 1, 2), RowKind::Tangential);
    }

    /// Unit rows rotated against each other by these angles: 1e-13 is rounding, 1e-11 and 1e-10 are two directions.
    #[test]
    fn rows_are_parallel_to_rounding_alone() {
        for (turned, groups) in [(0.0, 1), (1e-13, 1), (1e-11, 2), (1e-10, 2)] {
            let mut matrix = Csr::empty(2);
            matrix.push_row([(0, 0.6), (1, 0.8)]);
            matrix.push_row([(0, 0.6 - 0.8 * turned), (1, 0.8 + 0.6 * turned)]);
            let grouping = Grouping::of(&matrix, (2, 2), &[1.0; 2], |_| false);
            assert_eq!(grouping.leaders.len(), groups, "{turned:e}");
        }
    }
}
