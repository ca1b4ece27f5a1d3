//! Areas of nodes: A_j = int psi_j dA, psi_j the linear or bilinear function of node j on the straight sub-faces between nodes.

use crate::error::{Error, Result};
use crate::platform::memory::filled;
use crate::surface::faces::Faces;
use crate::surface::vector::{cross, length, minus, plus, times, Vector};

/// How lines of the plane become areas.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Depth {
    /// Length; with `axisymmetric` the angle, 2 pi or 1.
    pub thickness: f64,
    /// The area is `thickness` times the first coordinate.
    pub axisymmetric: bool,
}

/// Area of each node, length^2; 0 in no face.
pub fn areas(faces: &Faces, x: &[Vector], depth: Depth) -> Result<Vec<f64>> {
    let mut all = filled(faces.nodes, 0.0, "areas of a surface")?;
    for face in 0..faces.len() {
        let (patch, nodes) = (faces.patch(face, x), faces.nodes_of(face));
        for of in patch.shape.sub_faces() {
            let corners = patch.sub_face(of);
            let parts = match patch.shape.dim() {
                2 => of_line(corners, depth).map_err(|error| error.face(face))?,
                _ => of_sub_face(corners, of[2] == of[3]),
            };
            (0..4).for_each(|k| all[nodes[of[k]] as usize] += parts[k]);
        }
    }
    Ok(all)
}

/// `int psi_j dl` times the thickness, or `int psi_j r dl` times the angle.
fn of_line(corners: [Vector; 4], depth: Depth) -> Result<[f64; 4]> {
    let [a, b, ..] = corners;
    let half = 0.5 * depth.thickness * length(minus(b, a));
    if !depth.axisymmetric {
        return Ok([half, half, 0.0, 0.0]);
    }
    if a[0] < 0.0 || b[0] < 0.0 {
        let what = "a radius of an axisymmetric surface, its first coordinate, is below 0";
        return Err(Error::argument("x", what).value(a[0].min(b[0])));
    }
    let part = |own: f64, other: f64| half * (2.0 * own + other) / 3.0;
    Ok([part(a[0], b[0]), part(b[0], a[0]), 0.0, 0.0])
}

/// A third of a triangle each; of a bilinear quadrilateral `int N_j |X_1 x X_2|` by 2 x 2 Gauss points, exact on flat ones.
fn of_sub_face(x: [Vector; 4], is_triangle: bool) -> [f64; 4] {
    if is_triangle {
        let third = length(cross(minus(x[1], x[0]), minus(x[2], x[0]))) / (2.0 * 3.0);
        return [third, third, third, 0.0];
    }
    let point = 1.0 / 3.0_f64.sqrt();
    let mut parts = [0.0; 4];
    for (r, s) in [(-point, -point), (point, -point), (point, point), (-point, point)] {
        let along = |near: f64, a: usize, b: usize, c: usize, d: usize| {
            let (low, high) = (0.5 * (1.0 - near), 0.5 * (1.0 + near));
            times(0.5, plus(times(low, minus(x[b], x[a])), high, minus(x[d], x[c])))
        };
        let area = length(cross(along(s, 0, 1, 3, 2), along(r, 0, 3, 1, 2)));
        let n = [(1.0 - r) * (1.0 - s), (1.0 + r) * (1.0 - s), (1.0 + r) * (1.0 + s), (1.0 - r) * (1.0 + s)];
        (0..4).for_each(|k| parts[k] += 0.5 * 0.5 * n[k] * area);
    }
    parts
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::surface::shape::Shape;

    const PLAIN: Depth = Depth { thickness: 2.0, axisymmetric: false };

    #[test]
    fn areas_of_nodes_are_positive_and_sum_to_that_of_flat_faces() {
        for shape in Shape::ALL.into_iter().filter(|shape| shape.dim() == 3) {
            let mut x: Vec<Vector> =
                (0..shape.nodes()).map(|k| [shape.place(k)[0], shape.place(k)[1], 1.0]).collect();
            x[2] = [1.5 * x[2][0], x[2][1], 1.0]; // a distorted quadrilateral; mid nodes stay
            let mut faces = Faces::new(3, x.len()).unwrap();
            faces.add(shape, &(0..x.len() as i64).collect::<Vec<_>>(), &x).unwrap();
            let all = areas(&faces, &x, PLAIN).unwrap();
            let shoelace: f64 = shape
                .sub_faces()
                .iter()
                .map(|of| {
                    let p = of.map(|k| x[k]);
                    (0..4).map(|k| p[k][0] * p[(k + 1) % 4][1] - p[(k + 1) % 4][0] * p[k][1]).sum::<f64>()
                        / 2.0
                })
                .sum();
            assert!((all.iter().sum::<f64>() - shoelace).abs() < 1e-15, "{shape:?}: {all:?}");
            assert!(all.iter().all(|area| *area > 0.0));
        }
    }

    #[test]
    fn lines_have_their_length_times_thickness_or_the_area_of_revolution() {
        let x = [[1.0, 0.0, 0.0], [3.0, 0.0, 0.0], [2.0, 0.0, 0.0]];
        let mut faces = Faces::new(2, 3).unwrap();
        faces.add(Shape::Line3, &[0, 1, 2], &x).unwrap();
        assert_eq!(areas(&faces, &x, PLAIN).unwrap(), [1.0, 1.0, 2.0]);
        let ring = areas(&faces, &x, Depth { thickness: 2.0, axisymmetric: true }).unwrap();
        assert!((ring.iter().sum::<f64>() - (9.0 - 1.0)).abs() < 1e-14);
        let error =
            areas(&faces, &x.map(|x| [x[0] - 2.0, 0.0, 0.0]), Depth { thickness: 1.0, axisymmetric: true });
        assert_eq!(error.unwrap_err().place.face, Some(0));
    }
}
