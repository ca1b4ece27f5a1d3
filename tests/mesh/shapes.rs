//! Elements and bodies of other shapes than cubes.

use crate::mesh::bodies::{apart, solved, Model};
use decks::mesh::Mesh;
use feti_contact::solver::Problem;

/// The answer cut into so many pieces is that of the whole, certified, for at most twice the products with F of two cubes of `regular`^3
/// regular hexahedra, of about as many unknowns and in as many pieces.
fn same(name: &str, model: &Model, pieces: i64, regular: usize) {
    let (own, most) = products(name, model, pieces, regular);
    assert!(own <= 2 * most, "{name}: {own} products, {most} of regular cubes");
}

/// The same for any number of products: that number and the one of the cubes.
fn products(name: &str, model: &Model, pieces: i64, regular: usize) -> (usize, usize) {
    let mut whole = model.by_elements(1, true).unwrap();
    let (u, lambda, energy) = solved(&mut whole);
    let mut cut = model.by_elements(pieces, true).unwrap();
    let (own, forces, own_energy) = solved(&mut cut);
    assert!((own_energy - energy).abs() <= 1e-9 * energy.abs(), "{name}: {own_energy:e} {energy:e}");
    assert!(apart(&forces, &lambda) < 1e-6, "{name}: {:e}", apart(&forces, &lambda));
    assert!(apart(&own, &u) < 1e-6, "{name}: {:e}", apart(&own, &u));
    let cubes = Model::stacked(cube(regular, 0.0), cube(regular, 1.0), on_bottom);
    let mut cubes = cubes.by_elements(pieces, true).unwrap();
    solved(&mut cubes);
    let [pieces, others] =
        [&cut, &cubes].map(|problem| [0, 1].map(|body| problem.body_facts(body).unwrap().pieces));
    assert_eq!(pieces, others, "{name}");
    let [unknowns, others] = [&cut, &cubes].map(|problem| problem.sizes().dofs as f64);
    assert!((0.75..1.25).contains(&(unknowns / others)), "{name}: {unknowns} and {others}");
    let [own, most] = [cut, cubes].map(|problem| problem.report().unwrap().counts.products);
    (own, most)
}

fn cube(n: usize, low: f64) -> Mesh {
    Mesh::grid([n; 3], |[x, y, z]| [x, y, z + low])
}

fn on_bottom(at: [f64; 3]) -> bool {
    at[2] == 0.0
}

#[test]
fn cut_tetrahedra_of_both_kinds_give_the_answer_of_whole_bodies() {
    let tet4 = Model::stacked(cube(4, 0.0).tetrahedra(), cube(4, 1.0).tetrahedra(), on_bottom);
    same("tet4", &tet4, 7, 4);
    let tet10 = |low| cube(2, low).tetrahedra().quadratic();
    same("tet10", &Model::stacked(tet10(0.0), tet10(1.0), on_bottom), 5, 4);
}

#[test]
fn cut_distorted_hexahedra_give_the_answer_of_whole_bodies() {
    let bent = |low: f64| {
        Mesh::grid([4; 3], move |[x, y, z]| {
            let inside = x * (1.0 - x) * y * (1.0 - y) * z * (1.0 - z);
            [x + 2.0 * inside, y - 1.5 * inside, z + low + 2.5 * inside * (x - y)]
        })
    };
    same("distorted", &Model::stacked(bent(0.0), bent(1.0), on_bottom), 8, 4);
}

/// Layers of so many elements, by turns soft and stiff.
fn layered(n: usize, thick: usize, contrast: f64) -> Model {
    let block = |low: f64| {
        let mut mesh = cube(n, low);
        for (e, nodes) in mesh.elements.iter().enumerate() {
            let layer = (n as f64 * (mesh.nodes[nodes[0]][2] - low)).round() as usize / thick;
            mesh.young[e] = if layer % 2 == 0 { 1.0 } else { contrast };
        }
        mesh
    };
    Model::stacked(block(0.0), block(1.0), on_bottom)
}

/// With layers 1:1e6 the dual alone does not reach the certificate of the whole: the data of the host complete the answer.
#[test]
fn cut_layers_of_very_different_stiffness_give_the_answer_of_whole_bodies() {
    for contrast in [1e4, 1e6] {
        same("layers", &layered(4, 1, contrast), 8, 4);
    }
}

#[test]
fn factors_in_single_precision_take_hardly_more_products_where_layers_are_of_very_different_stiffness() {
    for contrast in [1e4, 1e6] {
        let model = layered(12, 3, contrast);
        let [single, double] = ["implicit", "explicit"].map(|operator| {
            let mut problem = model.by_elements(27, true).unwrap();
            problem.set_str("dual_operator", operator).unwrap();
            problem.set_f64("certificate_tolerance", 1e-8).unwrap();
            solved(&mut problem);
            problem.report().unwrap().counts.products
        });
        assert!(5 * single <= 6 * double, "{contrast:e}: {single} products, {double}");
    }
}

/// The plate bends within each of its pieces, and takes 2.2 times the products of the cubes; twice is the goal.
#[test]
fn cut_plates_and_rings_give_the_answer_of_whole_bodies() {
    let plate = |low: f64| Mesh::grid([12, 12, 1], move |[x, y, z]| [x, y, 0.04 * z + low]);
    let plates = Model::stacked(plate(0.0), plate(0.04), |at| at[2] == 0.0);
    let (own, most) = products("plate", &plates, 9, 6);
    assert!(2 * own <= 5 * most, "{own} products, {most} of regular cubes");
    let ring = |low: f64| {
        Mesh::grid([24, 2, 2], move |[x, y, z]| {
            let (turn, radius) = (std::f64::consts::TAU * x, 1.0 + 0.2 * y);
            [radius * turn.cos(), -radius * turn.sin(), 0.2 * z + low]
        })
        .closed()
    };
    same("ring", &Model::stacked(ring(0.0), ring(0.2), |at| at[2] == 0.0), 6, 5);
}

#[test]
fn contact_across_the_cuts_of_a_body_that_slides_gives_the_answer_of_whole_bodies() {
    // free to slide along x but for a spring
    let mut model = Model::stacked(cube(5, 0.0), cube(5, 1.0), on_bottom);
    let first = model.bodies[1].numbers().0[0].unwrap();
    model.loads[1][first] += 1e-4;
    model.rows.push((vec![(1, first, 1.0)], 0.01));
    same("sliding", &model, 8, 5);
}

/// Springs to the ground and between far unknowns as elements of their own, unknowns of no element, two parts in one body.
#[test]
fn elements_of_any_size_isolated_unknowns_and_two_parts_may_be_in_one_cut_body() {
    let mesh = cube(3, 0.0);
    let (number, cubes) = mesh.numbers();
    assert!(number.iter().all(Option::is_some));
    let (mut ptr, mut dof) = mesh.connectivity();
    let unknowns = 2 * cubes + 1;
    let add = |ptr: &mut Vec<usize>, dof: &mut Vec<i64>, own: &[i64]| {
        dof.extend(own);
        ptr.push(dof.len());
    };
    let solids = mesh.elements.len();
    for e in 0..solids {
        let own: Vec<i64> = dof[ptr[e]..ptr[e + 1]].iter().map(|j| j + cubes as i64).collect();
        add(&mut ptr, &mut dof, &own);
    }
    // every unknown of both parts on the bottom to the ground, and a strut between the parts
    let bottom: Vec<i64> = (0..mesh.nodes.len())
        .filter(|&k| mesh.nodes[k][2] == 0.0)
        .flat_map(|k| 3 * k as i64..3 * k as i64 + 3)
        .collect();
    for &j in bottom.iter().chain(&bottom.iter().map(|j| j + cubes as i64).collect::<Vec<_>>()) {
        add(&mut ptr, &mut dof, &[j]);
    }
    let top = cubes as i64 - 1;
    add(&mut ptr, &mut dof, &[top, top + cubes as i64]);
    let build = |pieces: i64| {
        let mut problem = Problem::new();
        problem.set_i64("pieces", pieces).unwrap();
        let body = problem.add_body(unknowns).unwrap();
        problem.set_mesh(body, &ptr, &dof).unwrap();
        for e in 0..2 * solids {
            problem.add_element(body, e, 24, &mesh.stiffness(e % solids), 24).unwrap();
        }
        let springs = 2 * bottom.len();
        for e in 0..springs {
            problem.add_element(body, 2 * solids + e, 1, &[2.0], 1).unwrap();
        }
        problem.add_element(body, 2 * solids + springs, 2, &[0.5, -0.5, -0.5, 0.5], 2).unwrap();
        let mut load = vec![0.0; unknowns];
        (load[top as usize], load[7], load[cubes + 9]) = (-1.0, 0.3, 0.2);
        problem.set_load(body, &load).unwrap();
        let row = feti_contact::solver::RowsInput {
            ptr: &[0, 1],
            body: None,
            dof: &[top],
            val: &[-1.0],
            rhs: Some(&[0.1]),
        };
        problem.add_rows(feti_contact::solver::RowKind::Inequality, row).unwrap();
        problem
    };
    let (u, lambda, energy) = solved(&mut build(1));
    assert!(lambda[0] > 0.0);
    for pieces in [2, 5] {
        let mut problem = build(pieces);
        let (own, forces, own_energy) = solved(&mut problem);
        assert_eq!(problem.body_facts(0).unwrap().components, Some(2));
        assert!((own_energy - energy).abs() < 1e-9 * energy.abs(), "{own_energy:e} {energy:e}");
        assert!(apart(&own[..2 * cubes], &u[..2 * cubes]) < 1e-7 && apart(&forces, &lambda) < 1e-7);
        assert_eq!(problem.report().unwrap().undetermined, 0, "the unknown of no element is no motion");
    }
}
