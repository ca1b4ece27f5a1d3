//! The final face: rows with a force and equality rows. Motions it leaves, rows that depend on others, its condition.

use crate::dense::{eigenvalues, orthonormal, singular};
use crate::vector::dot;
use crate::Deck;

/// A singular value below this part of the largest is zero.
const ZERO: f64 = 1e-12;

/// A row of the face, scaled: s_i b_i D^-1/2 over all unknowns, and s_i^2 C_i.
struct Row {
    entries: Vec<f64>,
    compliance: f64,
}

pub(super) struct Face<'a> {
    deck: &'a Deck,
    /// D^1/2
    root: Vec<f64>,
    rows: Vec<Row>,
    pub undetermined: usize,
}

impl<'a> Face<'a> {
    /// With the contact rows that are `closed`.
    pub fn of(deck: &'a Deck, closed: impl Fn(usize) -> bool) -> Face<'a> {
        let diagonals = deck.bodies.iter().flat_map(|body| body.stiffness.diagonal());
        let root: Vec<f64> = diagonals.map(f64::sqrt).collect();
        let mut rows = Vec::new();
        for (set, equality) in [(&deck.contact, false), (&deck.equalities, true)] {
            for i in (0..set.len()).filter(|&i| equality || closed(i)) {
                let mut entries = vec![0.0; root.len()];
                set.matrix.row(i).for_each(|(j, value)| entries[j] = value / root[j]);
                let square = dot(&entries, &entries) + set.compliance[i];
                entries.iter_mut().for_each(|value| *value /= square.sqrt());
                rows.push(Row { entries, compliance: set.compliance[i] / square });
            }
        }
        let mut face = Face { deck, root, rows, undetermined: 0 };
        face.undetermined = face.free_motions(ZERO);
        face
    }

    /// Dimension of the rigid motions R a with |S B_F R a| <= `limit` |a|, R'DR = I.
    pub fn free_motions(&self, limit: f64) -> usize {
        let mut columns = Vec::new();
        for (p, body) in self.deck.bodies.iter().enumerate() {
            let range = self.deck.offset(p)..self.deck.offset(p + 1);
            let root = &self.root[range.clone()];
            let diagonal: Vec<f64> = root.iter().map(|root| root * root).collect();
            for mode in orthonormal(body.modes(), &diagonal) {
                let scaled: Vec<f64> = mode.iter().zip(root).map(|(r, root)| r * root).collect();
                columns.push(self.rows.iter().map(|row| dot(&row.entries[range.clone()], &scaled)).collect());
            }
        }
        singular(columns).values.iter().filter(|&&value| value <= limit).count()
    }

    /// Dimension of the forces on rigid rows that no unknown feels.
    fn redundant(&self) -> usize {
        let rigid = self.rows.iter().filter(|row| row.compliance == 0.0);
        let values = singular(rigid.map(|row| row.entries.clone()).collect()).values;
        values.iter().filter(|&&value| value <= ZERO).count()
    }

    pub fn condition(&self) -> f64 {
        let (n, m) = (self.root.len(), self.rows.len());
        let order = n + m;
        let mut matrix = vec![0.0; order * order];
        for (p, body) in self.deck.bodies.iter().enumerate() {
            let first = self.deck.offset(p);
            for i in 0..body.dofs() {
                for (j, value) in body.stiffness.row(i) {
                    let (i, j) = (first + i, first + j);
                    matrix[i * order + j] = value / self.root[i] / self.root[j];
                }
            }
        }
        for (i, row) in self.rows.iter().enumerate() {
            for (j, &value) in row.entries.iter().enumerate() {
                matrix[(n + i) * order + j] = value;
                matrix[j * order + n + i] = value;
            }
            matrix[(n + i) * order + n + i] = -row.compliance;
        }
        let mut values: Vec<f64> = eigenvalues(matrix, order).iter().map(|value| value.abs()).collect();
        values.sort_by(f64::total_cmp);
        let zeros = self.undetermined + self.redundant();
        let zero = zeros.checked_sub(1).map_or(0.0, |last| values[last]);
        let (smallest, largest) = (values.get(zeros).copied().unwrap_or(0.0), values[order - 1]);
        let clear = zero <= ZERO * largest && smallest > 1e-13 * largest && smallest > 10.0 * zero;
        if clear {
            largest / smallest
        } else {
            f64::INFINITY
        }
    }
}
