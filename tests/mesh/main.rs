//! Bodies given by their elements, whole and cut: one problem, one answer.

mod bodies;

use bodies::{apart, solved, Model};
use decks::mesh::Mesh;

/// Two blocks of n^3 hexahedra each, the lower one clamped at its bottom, the upper one loose.
fn blocks(n: usize) -> Model {
    let mut random = decks::random::Random::new(3);
    let mut block = |low: f64| {
        let mut mesh = Mesh::grid([n; 3], |[x, y, z]| [x, y, z + low]);
        mesh.young.iter_mut().for_each(|young| *young = 1.0 + 1e-3 * random.between(0.0, 1.0));
        mesh
    };
    Model::stacked(block(0.0), block(1.0), |at| at[2] == 0.0)
}

#[test]
fn a_body_that_is_cut_has_the_answer_of_the_whole_one() {
    let model = blocks(6);
    let (u, lambda, energy) = solved(&mut model.by_elements(1, true).unwrap());
    for pieces in [2, 3, 8, 27] {
        for coordinates in [true, false] {
            let (own, forces, own_energy) = solved(&mut model.by_elements(pieces, coordinates).unwrap());
            assert!(
                (own_energy - energy).abs() <= 1e-9 * energy.abs(),
                "{pieces}: {own_energy:e} {energy:e}"
            );
            assert!(apart(&forces, &lambda) < 1e-7, "{pieces}: {:e}", apart(&forces, &lambda));
            assert!(apart(&own, &u) < 1e-7, "{pieces}: {:e}", apart(&own, &u));
        }
    }
}
