//! Slips of a step with a large rotation.

use super::*;
use crate::surface::mortar::tests::motions::bumpy;
use crate::surface::tests::slips::rotated;
use crate::surface::vector::dot;

/// Both sides turn by .5 rad, and the slave slips by a known vector before it: over a gap, as shells have by their offset.
#[test]
fn a_known_slip_comes_out_of_a_step_with_half_a_radian() {
    for (shape, other) in pairs() {
        let flat = shape.dim() == 2;
        let mut case = bumpy(shape, other, 0.3, 0.1);
        let slip = if flat { [0.02, 0.05, 0.0] } else { [0.02, 0.05, -0.03] };
        // the points are those of the present positions
        let back = |x: &[Vector], by: Vector| -> Vec<Vector> {
            x.iter().map(|x| rotated(plus(*x, -1.0, by), flat)).collect()
        };
        case.begin = [back(&case.slave.x, slip), back(&case.master.x, ZERO)];
        for (_, rows) in case.rows() {
            for a in 0..shape.dim() - 1 {
                let (s_old, expected) = (rows.before[a] - rows.opening[a], -dot(rows.directions[a], slip));
                assert!((s_old - expected).abs() < 1e-12, "{shape:?} {other:?}: {s_old} {expected}");
            }
        }
    }
}
