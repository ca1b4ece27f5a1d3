//! Element stiffness matrices: hex8 and quad4 (plane strain) elasticity, and the bilinear Laplacian.
//!
//! Nodes are numbered in tensor order: bit a of the node number says whether the node lies at the low (0)
//! or the high (1) end of axis a. Dofs are node by node. Matrices are dense, by rows.

/// a(u, v) of (1)-(2), corrected to a volume integral without the factor 1/2, by the strains (3) of the shape functions:
/// stiffness of the rectangle (quad4, plane strain) or box (hex8) with edges `size` (2 or 3 lengths):
/// K_(ai,bj) = int lambda N_a,i N_b,j + mu N_a,j N_b,i + mu delta_ij N_a,k N_b,k, two Gauss points per axis.
/// Order d 2^d, in units of `young` times length^(d-2).
pub fn elasticity(size: &[f64], young: f64, poisson: f64) -> Vec<f64> {
    let d = size.len();
    let order = d << d;
    let lambda = young * poisson / ((1.0 + poisson) * (1.0 - 2.0 * poisson));
    let mu = young / (2.0 * (1.0 + poisson));
    let weight = size.iter().product::<f64>() / f64::from(1 << d);
    let mut stiffness = vec![0.0; order * order];
    for point in 0..1 << d {
        let gradients = gauss_gradients(size, point);
        for row in 0..order {
            for column in row..order {
                let (a, i) = (&gradients[row / d], row % d);
                let (b, j) = (&gradients[column / d], column % d);
                let mut value = lambda * a[i] * b[j] + mu * a[j] * b[i];
                if i == j {
                    value += mu * (0..d).map(|k| a[k] * b[k]).sum::<f64>();
                }
                stiffness[row * order + column] += weight * value;
            }
        }
    }
    mirror_upper(order, &mut stiffness);
    stiffness
}

/// What the strains (3) are made of: gradients of the 2^d shape functions at the Gauss point whose sign along axis a is bit a of `point`.
fn gauss_gradients(size: &[f64], point: usize) -> Vec<Vec<f64>> {
    let d = size.len();
    let at = |bits: usize, axis: usize| if bits >> axis & 1 == 1 { 1.0 } else { -1.0 };
    let factor = |node: usize, axis: usize| (1.0 + at(node, axis) * at(point, axis) / 3f64.sqrt()) / 2.0;
    let component = |node: usize, axis: usize| {
        let others = (0..d).filter(|&other| other != axis);
        at(node, axis) / size[axis] * others.map(|other| factor(node, other)).product::<f64>()
    };
    let gradient = |node: usize| (0..d).map(|axis| component(node, axis)).collect();
    (0..1 << d).map(gradient).collect()
}

/// Copies the upper triangle onto the lower one: symmetric to the last bit.
fn mirror_upper(order: usize, matrix: &mut [f64]) {
    for row in 0..order {
        for column in 0..row {
            matrix[row * order + column] = matrix[column * order + row];
        }
    }
}

/// int grad N_a . grad N_b over a square, bilinear functions: 2/3 on the diagonal, -1/6 along an edge,
/// -1/3 across. 4 x 4, no unit, the same for every size.
pub fn bilinear_laplacian() -> [f64; 16] {
    let by_distance = [4.0 / 6.0, -1.0 / 6.0, -2.0 / 6.0];
    std::array::from_fn(|k| by_distance[((k / 4) ^ (k % 4)).count_ones() as usize])
}

#[cfg(test)]
mod tests {
    use super::{bilinear_laplacian, elasticity};
    use crate::vector::{dot, norm_max};

    const SIZE: [f64; 3] = [0.5, 0.25, 2.0];
    const YOUNG: f64 = 210.0;
    const POISSON: f64 = 0.3;

    /// Nodal values of a displacement field on the element of the first `d` entries of SIZE.
    fn nodal(d: usize, field: impl Fn(&[f64]) -> Vec<f64>) -> Vec<f64> {
        let position = |node: usize| -> Vec<f64> {
            let at = |axis: usize| SIZE[axis] * (node >> axis & 1) as f64;
            (0..d).map(at).collect()
        };
        (0..1 << d).flat_map(|node| field(&position(node))).collect()
    }

    fn product(matrix: &[f64], x: &[f64]) -> Vec<f64> {
        matrix.chunks(x.len()).map(|row| dot(row, x)).collect()
    }

    fn assert_close(found: &[f64], expected: &[f64], tolerance: f64) {
        for (a, b) in found.iter().zip(expected) {
            assert!((a - b).abs() <= tolerance, "{found:?} against {expected:?}");
        }
    }

    #[test]
    fn translations_and_rotations_cost_no_force() {
        for d in [2, 3] {
            let stiffness = elasticity(&SIZE[..d], YOUNG, POISSON);
            let zeros = vec![0.0; d << d];
            for axis in 0..d {
                let shift = nodal(d, |_| (0..d).map(|k| f64::from(k == axis)).collect());
                assert_close(&product(&stiffness, &shift), &zeros, 1e-12 * norm_max(&stiffness));
                let (p, q) = (axis, (axis + 1) % d);
                let turn = nodal(d, |x| {
                    let mut u = vec![0.0; d];
                    (u[p], u[q]) = (-x[q], x[p]);
                    u
                });
                assert_close(&product(&stiffness, &turn), &zeros, 1e-12 * norm_max(&stiffness));
            }
        }
    }

    /// Uniaxial stress s along x: u = (s/E)(x, -nu y, -nu z); the end faces carry s hy hz, a quarter a node.
    #[test]
    fn hexahedron_answers_uniaxial_stress_exactly() {
        let stress = 3.0;
        let strain = stress / YOUNG;
        let field = |x: &[f64]| vec![strain * x[0], -POISSON * strain * x[1], -POISSON * strain * x[2]];
        let force = stress * SIZE[1] * SIZE[2] / 4.0;
        let ends = |x: &[f64]| vec![if x[0] > 0.0 { force } else { -force }, 0.0, 0.0];
        let found = product(&elasticity(&SIZE, YOUNG, POISSON), &nodal(3, field));
        assert_close(&found, &nodal(3, ends), 1e-13 * YOUNG * strain);
    }

    /// Plane strain, stress s along x: e_xx = s (1 - nu^2)/E, e_yy = -s nu (1 + nu)/E; s hy/2 a node.
    #[test]
    fn quadrilateral_answers_uniaxial_stress_exactly() {
        let stress = 3.0;
        let along = stress * (1.0 - POISSON * POISSON) / YOUNG;
        let across = -stress * POISSON * (1.0 + POISSON) / YOUNG;
        let force = stress * SIZE[1] / 2.0;
        let ends = |x: &[f64]| vec![if x[0] > 0.0 { force } else { -force }, 0.0];
        let stiffness = elasticity(&SIZE[..2], YOUNG, POISSON);
        let found = product(&stiffness, &nodal(2, |x| vec![along * x[0], across * x[1]]));
        assert_close(&found, &nodal(2, ends), 1e-13 * stress);
    }

    #[test]
    fn element_stiffness_is_symmetric_to_the_last_bit() {
        let stiffness = elasticity(&SIZE, YOUNG, POISSON);
        for row in 0..24 {
            for column in 0..24 {
                assert_eq!(stiffness[row * 24 + column], stiffness[column * 24 + row]);
            }
        }
    }

    /// Energy of u = x on the unit square is 1/2 int 1 = 1/2, of u = xy it is 1/2 int (x^2 + y^2) = 1/3.
    #[test]
    fn bilinear_laplacian_integrates_the_gradient_exactly() {
        let energy = |u: &[f64]| dot(u, &product(&bilinear_laplacian(), u)) / 2.0;
        assert!((energy(&[0.0, 1.0, 0.0, 1.0]) - 0.5).abs() < 1e-15);
        assert!((energy(&[0.0, 0.0, 0.0, 1.0]) - 1.0 / 3.0).abs() < 1e-15);
        assert!(energy(&[1.0; 4]).abs() < 1e-15);
    }
}
