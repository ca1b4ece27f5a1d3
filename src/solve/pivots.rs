//! Which active set follows where signs refute one: block principal pivoting (Judice, Pires 1994).

/// Limit of active sets, and of their rows altogether.
const SETS: usize = 16;
const ROWS: usize = 10_000;
/// So many sets may have no fewer rows with a wrong sign than those before.
const PATIENCE: usize = 10;

/// The active sets so far.
pub struct Pivots {
    count: usize,
    /// The sets so far; while single rows change side, those since this began.
    visited: Vec<Vec<bool>>,
    /// Smallest number of rows with a wrong sign, and how many more sets may have no fewer.
    fewest: usize,
    patience: usize,
}

impl Default for Pivots {
    fn default() -> Self {
        Self { count: 0, visited: Vec::new(), fewest: usize::MAX, patience: PATIENCE }
    }
}

impl Pivots {
    /// Whether to try this set.
    pub fn go_on_with(&self, active: &[bool]) -> bool {
        self.count < SETS.max(ROWS / active.len().max(1)) && self.is_new(active)
    }

    fn is_new(&self, active: &[bool]) -> bool {
        self.visited.iter().all(|set| set != active)
    }

    /// The set after `active`, of whose rows signs show those in `next` to be active: all rows with a wrong sign change side while
    /// they become fewer now and then and sets do not occur again, otherwise only the last of them (Murty 1974), which
    /// leads to the answer, without any set twice, if all faces are regular.
    pub fn after(&mut self, active: &[bool], next: Vec<bool>) -> Vec<bool> {
        self.count += 1;
        self.visited.push(active.to_vec());
        let wrong: Vec<usize> = (0..active.len()).filter(|&i| next[i] != active[i]).collect();
        let before = self.patience;
        (self.fewest, self.patience) = match wrong.len() < self.fewest {
            true => (wrong.len(), PATIENCE),
            false => (self.fewest, before.saturating_sub(1)),
        };
        if self.patience > 0 && self.is_new(&next) {
            return next;
        }
        if before > 0 {
            self.visited.clear();
        }
        self.patience = 0;
        let turned = |&i: &usize| {
            let mut turned = active.to_vec();
            turned[i] = !turned[i];
            turned
        };
        wrong.iter().rev().map(turned).find(|set| self.is_new(set)).unwrap_or(next)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Rows that signs show to be active, from the forces `H_FF x = b_F` and slacks `H x - b` of the others.
    fn signs(active: &[bool]) -> Vec<bool> {
        let (h, b) = ([[4.0, 5.0, -5.0], [5.0, 9.0, -5.0], [-5.0, -5.0, 7.0]], [-2.0, -1.0, 3.0_f64]);
        // on the face, by Gauss-Jordan with the identity on the other rows
        let mut rows: Vec<Vec<f64>> = (0..3)
            .map(|i| {
                let entry =
                    |j: usize| if active[i] || active[j] { f64::from(u8::from(i == j)) } else { h[i][j] };
                (0..3).map(entry).chain([if active[i] { 0.0 } else { b[i] }]).collect()
            })
            .collect();
        for k in 0..3 {
            let pivot: Vec<f64> = rows[k].iter().map(|v| v / rows[k][k]).collect();
            for (i, row) in rows.iter_mut().enumerate() {
                let by = if i == k { 0.0 } else { row[k] };
                row.iter_mut().zip(&pivot).for_each(|(v, p)| *v -= by * p);
            }
            rows[k] = pivot;
        }
        let slack = |i: usize| (0..3).map(|j| h[i][j] * rows[j][3]).sum::<f64>() - b[i];
        (0..3).map(|i| if active[i] { slack(i) >= 0.0 } else { rows[i][3] <= 0.0 }).collect()
    }

    /// Curtis, Han, Robinson 2015: from six of the eight sets, changing all rows at once never leads to the answer.
    #[test]
    fn every_set_leads_to_the_answer_also_where_all_changes_at_once_go_round() {
        let mut cycles = 0;
        for start in 0..8 {
            let start = [0, 1, 2].map(|i| start >> i & 1 == 1);
            let mut all = start.to_vec();
            (0..8).for_each(|_| all = signs(&all));
            cycles += usize::from(signs(&all) != all);
            let (mut active, mut pivots) = (start.to_vec(), Pivots::default());
            while signs(&active) != active {
                assert!(pivots.go_on_with(&active), "{start:?}");
                active = pivots.after(&active, signs(&active));
            }
            assert_eq!(active, [true, false, false], "{start:?}");
        }
        assert_eq!(cycles, 6);
    }

    #[test]
    fn many_sets_are_tried_of_few_rows_and_few_of_many() {
        for (rows, most) in [(10, 1000), (100, 100), (5000, 16)] {
            let mut pivots = Pivots::default();
            let set = |k: usize| (0..rows).map(|i| k >> i.min(63) & 1 == 1).collect::<Vec<bool>>();
            let tried = (0..2000).take_while(|&k| {
                let goes_on = pivots.go_on_with(&set(k));
                pivots.after(&set(k), set(k + 1));
                goes_on
            });
            assert_eq!(tried.count(), most, "{rows}");
        }
    }
}
