//! The order of nodes in a face, as far as positions show it: corners go round, mid nodes lie near their edges, the centre near the middle.

use crate::error::{number, Error, Result};
use crate::numbers::surface::{MIDDLE, NO_AREA, ON_EDGE};
use crate::surface::patch::Patch;
use crate::surface::shape::{Kind, Shape};
use crate::surface::vector::{cross, dot, length, minus, plus, times, Vector, ZERO};

const ORDER: &str = "the order is corners, then mid nodes of edges, then the centre, as in VTK";

/// Refuses a face of these nodes whose order does not fit their positions.
pub fn check(patch: &Patch, nodes: &[u32]) -> Result<()> {
    let (shape, x) = (patch.shape, patch.nodes());
    let corners = shape.corners().len();
    let name = |k: usize| number(nodes[k].into());
    if shape.kind() == Kind::Square && do_corners_cross(&x[..corners]) {
        let [a, b, c, d] = [0, 1, 2, 3].map(name);
        let what =
            format!("the corners of the face cross: its edges go from node {a} to {b}, {c}, {d} and back");
        return Err(Error::argument("node", what));
    }
    if !shape.is_quadratic() {
        return Ok(());
    }
    let (edges, size) = (if shape == Shape::Line3 { 1 } else { corners }, patch.size());
    for edge in 0..edges {
        let (a, b, mid) = (edge, (edge + 1) % corners, corners + edge);
        let chord = length(minus(x[b], x[a]));
        let away = length(minus(x[mid], times(0.5, plus(x[a], 1.0, x[b]))));
        if !(away <= MIDDLE * chord + ON_EDGE * size) {
            let what = format!(
                "node {} is not near the middle of the edge of nodes {} and {}: {:.2} of its length away; {ORDER}",
                name(mid),
                name(a),
                name(b),
                away / chord
            );
            return Err(Error::argument("node", what)
                .index(nodes[mid].into())
                .value(away / chord)
                .limit(MIDDLE));
        }
    }
    if shape == Shape::Quad9 {
        let away = length(minus(x[8], middle(x)));
        if !(away <= MIDDLE * size) {
            let what = format!("node {} is not near the middle of the face; {ORDER}", name(8));
            return Err(Error::argument("node", what)
                .index(nodes[8].into())
                .value(away / size)
                .limit(MIDDLE));
        }
    }
    Ok(())
}

/// Whether two opposite edges of a quadrilateral cross: two of its corners then turn the other way than its diagonals, or, if both parts are
/// of one size, none turns with these. A re-entrant corner is one; a fold along a diagonal and a warped face have none.
fn do_corners_cross(x: &[Vector]) -> bool {
    let whole = cross(minus(x[2], x[0]), minus(x[3], x[1]));
    let turn = |k: usize| cross(minus(x[(k + 1) % 4], x[k]), minus(x[(k + 3) % 4], x[k]));
    let turns: [f64; 4] = std::array::from_fn(|k| dot(turn(k), whole));
    let small = NO_AREA * dot(whole, whole);
    let count = |is: &dyn Fn(f64) -> bool| turns.iter().filter(|turn| is(**turn)).count();
    count(&|turn| turn < -small) > 1 || count(&|turn| turn > small) == 0
}

/// The centre of the face that has corners and mid nodes alone.
fn middle(x: &[Vector]) -> Vector {
    let sum = |x: &[Vector]| x.iter().fold(ZERO, |sum, x| plus(sum, 1.0, *x));
    times(0.5, plus(sum(&x[4..8]), -0.5, sum(&x[..4])))
}

#[cfg(test)]
mod tests;
