//! Which local dual operators are assembled, by a model of time and memory: m distinct rows of B_p, n unknowns, l entries
//! of L_p, N products expected. Time is measured in bytes read from memory; a product reads
//!
//! ```text
//! explicit:  4 m^2      F_p packed, after an assembly of A operations, RATE of them in the time of a byte
//! implicit:  16 l       L_p twice; 10 l if the cache keeps it for the second time, half of both in single precision
//! A = s (2 m l + n m^2 / 2)        Y = L^-1 P B', then Y'Y; a supernode sees the share s = min(1, REACH p / n^2/3) of m
//! ```
//!
//! where p is the number of places that the rows touch: m without the tangential rows, which touch the nodes of their
//! normal rows. F_p is assembled if `A / RATE + 4 m^2 N` is at most N times the cost of L. REACH and RATE are fitted to the
//! assembly for one face and for all faces of cubes of 375 to 20000 unknowns and agree with it to a factor of 2. The
//! model uses only counts: the choice does not depend on the machine.

use crate::linalg::Packed;
use crate::numbers::dual::{AGAIN, CACHE, PRODUCTS, RATE, REACH, THIN};

/// Numbers of distinct rows of a body: all, and those that are not tangential.
#[derive(Debug, Clone, Copy, Default)]
pub struct DistinctRows {
    pub rows: usize,
    pub places: usize,
}

/// The sizes of a body and its F_p.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct Size {
    /// Distinct rows of B that touch the body: rows that are multiples of each other count once.
    pub rows: usize,
    /// Distinct rows without the tangential rows.
    pub places: usize,
    /// Unknowns of the body.
    pub unknowns: usize,
    /// Entries of the factor; 0 if the host has the factor.
    pub entries: usize,
    /// The factor will be rounded to single precision, unless the operator is assembled.
    pub single: bool,
    /// The factor has been rounded.
    pub rounded: bool,
}

impl Size {
    /// Multiplications of a product with F_p.
    pub fn work(&self, implicit: bool) -> usize {
        if implicit {
            2 * self.entries.max(self.unknowns)
        } else {
            self.rows * self.rows
        }
    }

    /// Multiplications of a factorisation of K_p, at least; infinite if the factor is the host's.
    pub fn factorisation(&self) -> f64 {
        let [n, l] = [self.unknowns, self.entries].map(|count| count as f64);
        if self.is_of_host() {
            f64::INFINITY
        } else {
            (l / n).max(THIN).powi(2) * n
        }
    }

    /// Operations of the assembly of F_p.
    pub fn assembly(&self) -> f64 {
        let [m, p, n, l] = [self.rows, self.places, self.unknowns, self.entries].map(|count| count as f64);
        let share = (REACH * p / n.max(1.0).powf(2.0 / 3.0)).min(1.0);
        share * (2.0 * m * l + 0.5 * n * m * m)
    }

    /// Bytes of F_p; if it is applied matrix-free, bytes of the two vectors over the body that a product takes.
    pub fn bytes(&self, implicit: bool) -> usize {
        if implicit {
            2 * self.unknowns * size_of::<f64>()
        } else {
            Packed::bytes(self.rows)
        }
    }

    /// The factor is the host's.
    pub fn is_of_host(&self) -> bool {
        self.entries == 0
    }

    /// The cost of the host's K+ is not known: use decides when F_p is assembled (`ledger`).
    fn prefers_implicit(&self) -> bool {
        if self.is_of_host() {
            return false;
        }
        if self.rounded {
            return true;
        }
        let read = |multiplications: usize| (size_of::<f64>() * multiplications) as f64;
        let factor = read(self.entries) * if self.single { 0.5 } else { 1.0 };
        let again = if factor <= CACHE { AGAIN } else { 1.0 };
        let (explicit, implicit) = (0.5 * read(self.work(false)), (1.0 + again) * factor);
        self.assembly() / RATE + PRODUCTS * explicit > PRODUCTS * implicit
    }
}

/// True for the bodies whose operator is applied matrix-free: those for which this is faster, and, while all operators
/// together take more than `room` bytes, those with the largest F_p.
pub fn implicit_bodies(sizes: &[Size], room: Option<usize>) -> Vec<bool> {
    let mut implicit: Vec<bool> = sizes.iter().map(Size::prefers_implicit).collect();
    let mut bytes = all_bytes(sizes, &implicit);
    let saving = |p: usize| sizes[p].bytes(false).saturating_sub(sizes[p].bytes(true));
    let mut largest: Vec<usize> = (0..sizes.len()).filter(|&p| !implicit[p] && saving(p) > 0).collect();
    largest.sort_by_key(|&p| std::cmp::Reverse(sizes[p].bytes(false)));
    for p in largest {
        if room.is_none_or(|room| bytes <= room) {
            break;
        }
        implicit[p] = true;
        bytes -= saving(p);
    }
    implicit
}

/// Bytes of all operators.
pub fn all_bytes(sizes: &[Size], implicit: &[bool]) -> usize {
    sizes.iter().zip(implicit).map(|(size, implicit)| size.bytes(*implicit)).sum()
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A cube of 20000 unknowns with this number of rows.
    fn body(rows: usize) -> Size {
        Size { rows, places: rows, unknowns: 20_000, entries: 7_000_000, ..Size::default() }
    }

    #[test]
    fn one_face_is_assembled_and_all_faces_of_a_small_cube_are_not() {
        let small = Size { rows: 1116, places: 1116, unknowns: 2187, entries: 507_000, ..Size::default() };
        assert_eq!(implicit_bodies(&[body(0), body(361), small], None), [false, false, true]);
    }

    /// Blocks of rows: `A = s (2 m l + n m^2 / 2)` with s = min(1, 0.4 m / n^(2/3)).
    #[test]
    fn the_work_of_the_assembly_is_the_one_of_the_model() {
        let size = Size { rows: 10, places: 10, unknowns: 1000, entries: 2000, ..Size::default() };
        assert!((size.assembly() - 0.04 * (40_000.0 + 50_000.0)).abs() < 1e-9);
    }

    /// A cube of 72000 unknowns whose face has 841 nodes, as measured.
    #[test]
    fn three_rows_of_a_node_with_friction_reach_what_its_normal_row_reaches() {
        let normal =
            Size { rows: 841, places: 841, unknowns: 72_000, entries: 45_000_000, ..Size::default() };
        let friction = Size { rows: 3 * 841, ..normal };
        assert_eq!(implicit_bodies(&[normal, friction], None), [false, false]);
        let apart = Size { places: 3 * 841, ..friction };
        assert_eq!(implicit_bodies(&[apart], None), [true]);
    }

    #[test]
    fn the_largest_operators_become_implicit_until_the_rest_has_room() {
        let sizes = [body(300), body(600), body(500), body(400)];
        let explicit = all_bytes(&sizes, &[false; 4]);
        assert_eq!(implicit_bodies(&sizes, Some(explicit)), [false; 4]);
        assert_eq!(implicit_bodies(&sizes, Some(explicit - 1)), [false, true, false, false]);
        let two = all_bytes(&sizes, &[false, true, true, false]);
        assert_eq!(implicit_bodies(&sizes, Some(two)), [false, true, true, false]);
        assert_eq!(implicit_bodies(&sizes, Some(0)), [true; 4]);
    }

    /// K+ of the host: the entries of its factor are not known.
    #[test]
    fn an_operator_of_the_host_is_assembled_as_long_as_there_is_room() {
        let host = Size { rows: 5000, places: 5000, unknowns: 20_000, ..Size::default() };
        let explicit = all_bytes(&[host], &[false]);
        assert_eq!(implicit_bodies(&[host], None), [false]);
        assert_eq!(implicit_bodies(&[host], Some(explicit)), [false]);
        assert_eq!(implicit_bodies(&[host], Some(explicit - 1)), [true]);
    }

    #[test]
    fn an_operator_smaller_than_the_vectors_of_a_product_is_never_given_up() {
        assert_eq!(implicit_bodies(&[body(100)], Some(0)), [false]);
    }
}
