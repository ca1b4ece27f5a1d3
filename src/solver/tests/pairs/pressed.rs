//! Blocks pressed on each other and on rigid planes.

use super::*;
use crate::error::Kind;
use crate::solver::{Outcome, PairField, RigidShape, RowKind};

/// In the plane and in space; the lower block is held at its foot and bulges, so that the pressure is constant on average.
#[test]
fn the_pressure_between_two_blocks_has_the_load_as_its_resultant() {
    const P: f64 = 1e-3;
    for (dim, method) in [2, 3].into_iter().flat_map(|dim| METHODS.map(|method| (dim, method))) {
        let (size, steps) = (&[2.0, 1.0, 0.5][3 - dim..], &[4, 3, 2][3 - dim..]);
        let mut low = vec![0.0; dim];
        let lower = block(&low, size, steps, |x| x[dim - 1] == 0.0);
        low[dim - 1] = size[dim - 1];
        let upper = block(&low, size, steps, |_| false);
        let mut problem = Problem::new();
        let bodies = [lower.give(&mut problem), upper.give(&mut problem)];
        let (master, slave) =
            (lower.surface(&mut problem, bodies[0], true), upper.surface(&mut problem, bodies[1], false));
        let made = pair_by(&mut problem, method, slave, master, 0.1);
        // some friction holds the upper block
        problem.pair_set(made, "friction", &[0.3]).unwrap();
        problem.pairs_find().unwrap();
        let areas = problem.pair_field(made, PairField::Area).unwrap();
        let whole: f64 = size[..dim - 1].iter().product();
        assert!((areas.iter().sum::<f64>() - whole).abs() < 1e-14);
        let mut load = vec![0.0; upper.dof.len()];
        let shift = upper.side(true)[0] - upper.side(false)[0];
        upper.side(false).iter().for_each(|node| load[dim * (node + shift) + dim - 1] = -P * areas[*node]);
        problem.set_load(bodies[1], &upper.gathered(&load)).unwrap();
        assert_eq!(problem.solve().unwrap().outcome, Outcome::Solved);
        let pressure = problem.pair_field(made, PairField::Pressure).unwrap();
        let facts = problem.pair_info(made).unwrap();
        assert!((facts.force[dim - 1] - P * whole).abs() < 1e-9 * P, "{facts:?}");
        assert!(
            (facts.closed_area - whole).abs() < 1e-12 && facts.closed == facts.rows && facts.without == 0
        );
        let mean: f64 = pressure.iter().zip(&areas).map(|(p, a)| p * a).sum::<f64>() / whole;
        assert!((mean - P).abs() < 1e-9 * P);
        let normal = problem.pair_field(made, PairField::Normal).unwrap();
        let used = upper.side(false);
        assert!(used.iter().all(|node| (normal[dim * node + dim - 1] + 1.0).abs() < 1e-14));
    }
}

/// A block of weight N on a plane, pushed at its foot by Q > mu N: no forces balance that, and friction holds mu N / Q of it.
#[test]
fn a_block_pushed_by_more_than_friction_holds_is_told_how_much_that_is() {
    const MU: f64 = 0.3;
    for (dim, method) in [2, 3].into_iter().flat_map(|dim| METHODS.map(|method| (dim, method))) {
        for over in [1.01, 2.0] {
            let upper = block(&vec![0.0; dim], &[2.0, 1.0, 0.5][3 - dim..], &[4, 3, 2][3 - dim..], |_| false);
            let mut problem = Problem::new();
            let body = upper.give(&mut problem);
            let slave = upper.surface(&mut problem, body, false);
            let mut data = vec![0.0; 2 * dim];
            data[2 * dim - 1] = 1.0;
            let master = problem.surface_rigid(dim, RigidShape::Plane, &data).unwrap();
            let made = pair_by(&mut problem, method, slave, master, 0.1);
            problem.pair_set(made, "friction", &[MU]).unwrap();
            problem.pairs_find().unwrap();
            let areas = problem.pair_field(made, PairField::Area).unwrap();
            let mut load = vec![0.0; upper.dof.len()];
            for node in upper.side(false) {
                load[dim * node + dim - 1] = -areas[node];
                load[dim * node] = over * MU * areas[node];
            }
            problem.set_load(body, &upper.gathered(&load)).unwrap();
            let error = problem.solve().unwrap_err();
            let (nodes, part) = (upper.side(false).len(), 100.0 / over);
            let says = format!("the friction of {nodes} nodes gives way: it can hold {part:.3} % of the load along the slide");
            assert!(error.kind == Kind::LoadNotHeld && error.what.contains(&says), "{says}: {error}");
        }
    }
}

/// Faces that run the wrong way round, a distance that is too small, and a find that is missing.
#[test]
fn a_load_that_is_not_held_names_the_pair_of_which_no_node_has_a_partner() {
    let upper = block(&[0.0, 1e-3], &[2.0, 1.0], &[4, 2], |_| false);
    let foot = upper.faces(false);
    let reversed: Vec<i64> = foot.chunks(2).flat_map(|line| [line[1], line[0]]).collect();
    for (faces, distance, is_held) in [(&foot, 0.1, true), (&reversed, 0.1, false), (&foot, 1e-4, false)] {
        let mut problem = Problem::new();
        let body = upper.give(&mut problem);
        let slave = problem.surface_add(Some(body), 2, &upper.x, 2, Some((&upper.dof, 2))).unwrap();
        problem.surface_faces(slave, Shape::Line2, faces).unwrap();
        let tool = problem.surface_add(None, 2, &[3.0, 0.0, -1.0, 0.0], 2, None).unwrap();
        problem.surface_faces(tool, Shape::Line2, &[0, 1]).unwrap();
        pair(&mut problem, slave, tool, distance);
        let load: Vec<f64> = (0..upper.x.len()).map(|i| [0.0, -1.0][i % 2]).collect();
        problem.set_load(body, &upper.gathered(&load)).unwrap();
        let said = problem.solve().unwrap_err().to_string();
        assert!(said.contains("; pair 0: no find has made its rows yet"), "{said}");
        problem.pairs_find().unwrap();
        let solved = problem.solve();
        assert_eq!(solved.is_ok(), is_held, "{solved:?}");
        let says = "; pair 1: none of its 5 nodes has a partner: do the faces run the wrong way round, or is distance too small?";
        solved.err().iter().for_each(|error| {
            let said = error.clone().counted_from(1).to_string();
            assert!(error.kind == Kind::LoadNotHeld && said.contains(says), "{said}");
        });
    }
}

/// With Poisson's ratio in both blocks equal and nothing that holds their sides, the state is homogeneous.
#[test]
fn a_block_on_a_rigid_plane_has_the_pressure_of_its_load() {
    const P: f64 = 1e-3;
    for (dim, method) in [2, 3].into_iter().flat_map(|dim| METHODS.map(|method| (dim, method))) {
        let (size, steps) = (&[2.0, 1.0, 0.5][3 - dim..], &[4, 3, 2][3 - dim..]);
        let upper = block(&vec![0.0; dim], size, steps, |_| false);
        let mut problem = Problem::new();
        let body = upper.give(&mut problem);
        let slave = upper.surface(&mut problem, body, false);
        let mut data = vec![0.0; 2 * dim];
        data[2 * dim - 1] = 1.0;
        let master = problem.surface_rigid(dim, RigidShape::Plane, &data).unwrap();
        let made = pair_by(&mut problem, method, slave, master, 0.1);
        problem.pairs_find().unwrap();
        let areas = problem.pair_field(made, PairField::Area).unwrap();
        let mut load = vec![0.0; upper.dof.len()];
        let shift = upper.side(true)[0] - upper.side(false)[0];
        upper.side(false).iter().for_each(|node| load[dim * (node + shift) + dim - 1] = -P * areas[*node]);
        problem.set_load(body, &upper.gathered(&load)).unwrap();
        assert!(matches!(problem.solve().unwrap().outcome, Outcome::Solved));
        let pressure = problem.pair_field(made, PairField::Pressure).unwrap();
        assert!(upper.side(false).iter().all(|node| (pressure[*node] - P).abs() < 1e-8 * P), "{pressure:?}");
    }
}

/// A block held at its top, pressed by an offset on a plane that moves along it: by a little the foot follows, by more it slips.
#[test]
fn a_plane_that_moves_drags_the_block_until_it_slips() {
    let upper = block(&[0.0, 0.0, 0.0], &[2.0, 1.0, 0.5], &[3, 2, 2], |x| x[2] == 0.5);
    let cases = METHODS.into_iter().flat_map(|method| [(1e-5, true, method), (0.05, false, method)]);
    for (moved, sticks, method) in cases {
        let mut problem = Problem::new();
        let body = upper.give(&mut problem);
        let slave = upper.surface(&mut problem, body, false);
        let plane = |x: f64| [x, 0.0, 0.0, 0.0, 0.0, 1.0];
        let master = problem.surface_rigid(3, RigidShape::Plane, &plane(0.0)).unwrap();
        let made = pair_by(&mut problem, method, slave, master, 0.1);
        problem.pair_set(made, "offset", &[1e-3]).unwrap();
        problem.pair_set(made, "friction", &[0.3]).unwrap();
        problem.surface_move(master, &plane(moved), 1).unwrap();
        problem.pairs_find().unwrap();
        problem.solve().unwrap();
        let field = |field| problem.pair_field(made, field).unwrap();
        let (pressure, shear, slip, closed) = (
            field(PairField::Pressure),
            field(PairField::Shear),
            field(PairField::Slip),
            field(PairField::Closed),
        );
        let u = upper.spread(problem.displacement(body).unwrap());
        for node in upper.side(false) {
            assert!(pressure[node] > 0.0 && (u[3 * node + 2] - 1e-3).abs() < 1e-10);
            let size = (0..3).map(|i| shear[3 * node + i].powi(2)).sum::<f64>().sqrt();
            if sticks && closed[node] == 2.0 {
                assert!((u[3 * node] - moved).abs() < 1e-10 && slip[3 * node].abs() < 1e-10);
                assert!(size <= 0.3 * pressure[node] * (1.0 + 1e-8));
            }
            if !sticks {
                assert!((size - 0.3 * pressure[node]).abs() < 1e-8 * pressure[node] && closed[node] == 3.0);
                assert!(shear[3 * node] > 0.9 * size, "dragged along");
                assert!((slip[3 * node] - (u[3 * node] - moved)).abs() < 1e-10);
            }
        }
        let facts = problem.pair_info(made).unwrap();
        assert_eq!(facts.closed, facts.sticking + facts.slipping);
        assert!(
            if sticks { facts.sticking > facts.slipping } else { facts.slipping == facts.rows },
            "{facts:?}"
        );
        assert_eq!(problem.sizes().nodes, facts.rows);
    }
}

/// A cloud has no areas: forces instead of pressures, and no law of an area.
#[test]
fn a_cloud_of_points_carries_forces() {
    let upper = block(&[0.0, 0.0], &[2.0, 1.0], &[3, 2], |x| x[1] == 1.0);
    let mut problem = Problem::new();
    let body = upper.give(&mut problem);
    let foot = upper.side(false);
    let x: Vec<f64> = foot.iter().flat_map(|node| upper.x[2 * node..2 * node + 2].to_vec()).collect();
    let dof: Vec<i64> = foot.iter().flat_map(|node| upper.dof[2 * node..2 * node + 2].to_vec()).collect();
    let cloud = problem.surface_add(Some(body), 2, &x, 2, Some((&dof, 2))).unwrap();
    let tool = problem.surface_add(None, 2, &[-1.0, 0.01, 3.0, 0.01], 2, None).unwrap();
    problem.surface_faces(tool, Shape::Line2, &[1, 0]).unwrap();
    let made = pair(&mut problem, cloud, tool, 0.1);
    assert!(problem.pair_set(made, "compliance", &[1.0]).is_err());
    problem.pairs_find().unwrap();
    problem.solve().unwrap();
    let u = upper.spread(problem.displacement(body).unwrap());
    assert!(foot.iter().all(|node| (u[2 * node + 1] - 0.01).abs() < 1e-10));
    let force = problem.pair_field(made, PairField::Force).unwrap();
    assert!(
        force.iter().all(|force| *force > 0.0) && force == problem.multipliers(RowKind::Inequality).unwrap()
    );
    assert_eq!(problem.pair_field(made, PairField::Pressure).unwrap(), [0.0; 4]);
}

/// The same answer if the cloud is named by nodes of the whole mesh, in any order, and a point twice.
#[test]
fn points_of_a_mesh_are_a_cloud() {
    let forces = |of_mesh: bool| {
        let upper = block(&[0.0, 0.0], &[2.0, 1.0], &[3, 2], |x| x[1] == 1.0);
        let mut problem = Problem::new();
        let body = upper.give(&mut problem);
        let foot = upper.side(false);
        let of = |node: &usize| 2 * node..2 * node + 2;
        let x: Vec<f64> = foot.iter().flat_map(|node| upper.x[of(node)].to_vec()).collect();
        let dof: Vec<i64> = foot.iter().flat_map(|node| upper.dof[of(node)].to_vec()).collect();
        let (x, dof) = if of_mesh { (&upper.x, &upper.dof) } else { (&x, &dof) };
        let cloud = problem.surface_add(Some(body), 2, x, 2, Some((dof, 2))).unwrap();
        if of_mesh {
            let named: Vec<i64> = foot.iter().rev().chain(&foot[..1]).map(|node| *node as i64).collect();
            problem.surface_points(cloud, &named).unwrap();
        }
        let tool = problem.surface_add(None, 2, &[-1.0, 0.01, 3.0, 0.01], 2, None).unwrap();
        problem.surface_faces(tool, Shape::Line2, &[1, 0]).unwrap();
        pair(&mut problem, cloud, tool, 0.1);
        problem.pairs_find().unwrap();
        problem.solve().unwrap();
        problem.multipliers(RowKind::Inequality).unwrap().to_vec()
    };
    assert_eq!(forces(true), forces(false));
}

/// 1/k = compliance / area: the foot yields by compliance x pressure.
#[test]
fn a_compliant_face_yields_by_its_pressure() {
    METHODS.into_iter().for_each(compliant);
}

fn compliant(method: PairMethod) {
    let upper = block(&[0.0, 0.0], &[2.0, 1.0], &[4, 2], |x| x[1] == 1.0);
    let mut problem = Problem::new();
    let body = upper.give(&mut problem);
    let slave = upper.surface(&mut problem, body, false);
    let master = problem.surface_rigid(2, RigidShape::Plane, &[0.0, 0.01, 0.0, 1.0]).unwrap();
    let made = pair_by(&mut problem, method, slave, master, 0.1);
    problem.pair_set(made, "compliance", &[2.0]).unwrap();
    problem.pair_set(made, "thickness", &[0.25]).unwrap();
    problem.pairs_find().unwrap();
    problem.solve().unwrap();
    let (u, pressure) = (
        upper.spread(problem.displacement(body).unwrap()),
        problem.pair_field(made, PairField::Pressure).unwrap(),
    );
    for node in upper.side(false) {
        assert!(pressure[node] > 0.0 && (u[2 * node + 1] - 0.01 + 2.0 * pressure[node]).abs() < 1e-10);
    }
    assert!((problem.pair_field(made, PairField::Area).unwrap().iter().sum::<f64>() - 0.5).abs() < 1e-15);
}
