//! Patch tests by mortar: a homogeneous state of two bodies with meshes that do not match.

use super::solids::{solid, Solid, LAME, SHEAR};
use crate::solver::{PairField, PairMethod, Problem, Shape};

/// What holds between the bodies.
#[derive(Debug, Clone, Copy, PartialEq)]
enum Between {
    Pressure,
    Friction,
    Tie,
}

const P: f64 = 1e-3;

/// Strain along the axes in a state with the stress -P along the last one alone, and the angle of shear.
fn state(dim: usize, between: Between) -> (Vec<f64>, f64) {
    let poisson = LAME / (2.0 * (LAME + SHEAR));
    let across = if dim == 2 { poisson * (1.0 + poisson) } else { poisson };
    let along = if dim == 2 { poisson * poisson - 1.0 } else { -1.0 };
    let mut strain = vec![P * across; dim];
    strain[dim - 1] = P * along;
    (strain, if between == Between::Pressure { 0.0 } else { 0.1 * P / SHEAR })
}

/// u along the last axis has the shear in it: supports along x = 0 and y = 0 hold what is 0.
fn exact(of: &Solid, between: Between) -> Vec<f64> {
    let (strain, shear) = state(of.dim, between);
    let u = |x: &[f64]| -> Vec<f64> {
        (0..of.dim).map(|i| strain[i] * x[i] + if i == of.dim - 1 { shear * x[0] } else { 0.0 }).collect()
    };
    of.x.chunks(of.dim).flat_map(u).collect()
}

/// Largest errors of pressure, shear (relative to the pressure) and displacement.
fn errors(
    shapes: [Shape; 2],
    steps: [&[usize]; 2],
    by: f64,
    upper_is_slave: bool,
    between: Between,
) -> [f64; 3] {
    let dim = steps[0].len();
    let mut low = vec![0.0; dim];
    let mut solids = [0, 1].map(|k| {
        low[dim - 1] = k as f64;
        solid(shapes[k], &low, &vec![1.0; dim], steps[k], by)
    });
    let floats = between != Between::Pressure;
    for (k, of) in solids.iter_mut().enumerate() {
        of.hold(|x, i| match i == dim - 1 {
            true => k == 0 && x[i] == 0.0 && (!floats || x[0] == 0.0),
            false => x[i] == 0.0 && !(k == 1 && floats),
        });
    }
    let u: Vec<Vec<f64>> = solids.iter().map(|of| exact(of, between)).collect();
    let mut problem = Problem::new();
    problem.set_text("tolerance=1e-13 finish=direct").unwrap();
    let tension = 0.1 * P * if floats { 1.0 } else { 0.0 };
    let mut bodies = [0; 2];
    let mut surfaces = [0; 2];
    for k in 0..2 {
        // forces of the homogeneous state, without those between the bodies
        let mut load = solids[k].forces(&u[k]);
        let side = if k == 0 { 1.0 } else { -1.0 };
        for (node, weight) in consistent(&solids[k], k == 0) {
            load[dim * node + dim - 1] -= side * -P * weight;
            load[dim * node] -= side * tension * weight;
        }
        bodies[k] = solids[k].give(&mut problem, &load);
        surfaces[k] = solids[k].surface(&mut problem, bodies[k], k == 0);
    }
    let (slave, master) = if upper_is_slave { (1, 0) } else { (0, 1) };
    let (pair, _) = problem
        .pair_add(surfaces[slave], surfaces[master], PairMethod::Mortar, between == Between::Tie, 0.1)
        .unwrap();
    if between == Between::Friction {
        problem.pair_set(pair, "friction", &[0.5]).unwrap();
    }
    problem.pairs_find().unwrap();
    problem.solve().unwrap();
    let pressure = problem.pair_field(pair, PairField::Pressure).unwrap();
    let shear = problem.pair_field(pair, PairField::Shear).unwrap();
    let mut worst = [0.0f64; 3];
    let of = &solids[slave];
    for node in of.faces[usize::from(slave == 0)].iter().map(|node| *node as usize) {
        worst[0] = worst[0].max((pressure[node] - P).abs() / P);
        let expected = if slave == 0 { tension } else { -tension };
        worst[1] = worst[1].max((shear[dim * node] - if floats { expected } else { 0.0 }).abs() / P);
    }
    for k in 0..2 {
        let found = problem.displacement(bodies[k]).unwrap();
        let largest = u[k].iter().fold(0.0f64, |most, u| most.max(u.abs()));
        for (i, dof) in solids[k].dof.iter().enumerate().filter(|(_, dof)| **dof >= 0) {
            worst[2] = worst[2].max((found[*dof as usize] - u[k][i]).abs() / largest);
        }
    }
    worst
}

/// `int N_k` of the nodes of a side: nodal forces of the stress 1 along the axis, from the strain along it alone, are those on the sides.
fn consistent(of: &Solid, top: bool) -> Vec<(usize, f64)> {
    let dim = of.dim;
    // K u of u = x_z e_z / (lambda + 2 mu) has on the sides z the traction 1, on the others traction along their normal only
    let u: Vec<f64> = (0..of.x.len())
        .map(|i| if i % dim == dim - 1 { of.x[i] / (LAME + 2.0 * SHEAR) } else { 0.0 })
        .collect();
    let f = of.forces(&u);
    let mut nodes: Vec<usize> = of.faces[usize::from(top)].iter().map(|node| *node as usize).collect();
    nodes.sort_unstable();
    nodes.dedup();
    nodes.into_iter().map(|node| (node, if top { 1.0 } else { -1.0 } * f[dim * node + dim - 1])).collect()
}

const PLANE: [Shape; 2] = [Shape::Line2, Shape::Line3];

fn check(shapes: [Shape; 2], steps: [&[usize]; 2], by: f64, between: Between, tolerance: f64) {
    for upper_is_slave in [true, false] {
        let worst = errors(shapes, steps, by, upper_is_slave, between);
        if std::env::var("SHOW").is_ok() {
            println!(
                "{shapes:?} {steps:?} {by} {upper_is_slave} {between:?}: {:.1e} {:.1e} {:.1e}",
                worst[0], worst[1], worst[2]
            );
        }
        assert!(
            worst.iter().all(|of| *of <= tolerance),
            "{shapes:?} {by} {upper_is_slave} {between:?}: {worst:?}"
        );
    }
}

#[test]
fn a_homogeneous_state_goes_through_lines_that_do_not_match() {
    for (lower, upper) in PLANE.into_iter().flat_map(|a| PLANE.map(|b| (a, b))) {
        for between in [Between::Pressure, Between::Friction, Between::Tie] {
            for by in [0.0, 0.2] {
                check([lower, upper], [&[5, 3], &[7, 3]], by, between, 1e-11);
            }
        }
    }
}

#[test]
fn a_homogeneous_state_goes_through_faces_that_do_not_match() {
    use Shape::{Quad4, Quad8, Quad9, Tri3, Tri6};
    for (lower, upper) in [
        (Quad4, Quad4),
        (Quad4, Tri3),
        (Tri3, Tri3),
        (Tri6, Tri6),
        (Quad8, Quad8),
        (Quad9, Quad9),
        (Quad8, Tri6),
        (Quad4, Quad9),
    ] {
        let is_linear = |shape: Shape| matches!(shape, Quad4 | Tri3);
        let steps = |shape: Shape, fine: bool| match (is_linear(shape), fine) {
            (true, false) => [2, 3, 2],
            (true, true) => [3, 4, 2],
            (false, false) => [2, 1, 1],
            (false, true) => [3, 2, 1],
        };
        for between in [Between::Pressure, Between::Friction, Between::Tie] {
            for by in [0.0, 0.2] {
                let affine = by == 0.0 || [lower, upper].iter().all(|of| matches!(of, Tri3 | Tri6));
                let tolerance = if affine { 1e-11 } else { 1e-6 };
                check([lower, upper], [&steps(lower, false), &steps(upper, true)], by, between, tolerance);
            }
        }
    }
}
