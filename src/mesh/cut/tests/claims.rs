use rayon::prelude::*;

use super::meshes::{ideal, Mesh, Quality};

fn quality(mesh: &Mesh, pieces: usize, with_centres: bool) -> Quality {
    let quality = mesh.quality(&mesh.cut(pieces, with_centres));
    assert_eq!((quality.pieces, quality.apart), (pieces, 0), "{quality:?}");
    assert!(quality.largest < 1.1, "{quality:?}");
    quality
}

/// With and without centres the cut has the requested number of pieces, each connected by faces and at most 10 % too
/// large, with at most these numbers of copies.
fn is_well_cut(mesh: &Mesh, pieces: usize, most: [f64; 2]) {
    for (with_centres, most) in [(true, most[0]), (false, most[1])] {
        let quality = quality(mesh, pieces, with_centres);
        assert!(quality.copies as f64 <= most, "{quality:?}, not {most}");
    }
}

#[test]
fn a_cube_that_blocks_divide_is_cut_into_blocks_however_it_is_turned_moved_and_numbered() {
    let cubes =
        [Mesh::cube(28), Mesh::cube(28).turned(1e3, 0.37), Mesh::cube(28).shuffled().turned(0.0, 1e-9)];
    for cube in cubes {
        assert_eq!(quality(&cube, 64, true).copies, ideal(28, 4));
    }
    assert_eq!(quality(&Mesh::cube(21), 27, true).copies, ideal(21, 3));
}

#[test]
fn other_numbers_of_pieces_and_cuts_without_centres_need_little_more_than_blocks() {
    is_well_cut(&Mesh::cube(28), 64, [1.01, 1.2].map(|more| more * ideal(28, 4) as f64));
    is_well_cut(&Mesh::cube(28), 216, [1.1, 1.2].map(|more| more * ideal(28, 6) as f64));
    is_well_cut(&Mesh::cube(28).shuffled(), 216, [1.1, 1.2].map(|more| more * ideal(28, 6) as f64));
    // planes of blocks of equal volume, as if the cube could be cut into these numbers
    for pieces in [7, 11, 50] {
        let planes = 3.0 * 3.0 * 21.0 * 21.0 * ((pieces as f64).cbrt() - 1.0);
        is_well_cut(&Mesh::cube(20), pieces, [1.3 * planes, 1.35 * planes]);
    }
}

#[test]
fn tetrahedra_of_both_orders_are_cut_like_the_boxes_they_fill() {
    for mesh in [Mesh::tetrahedra(12, false), Mesh::tetrahedra(12, false).shuffled().turned(5.0, 2.0)] {
        is_well_cut(&mesh, 27, [1.15, 1.2].map(|more| more * ideal(12, 3) as f64));
    }
    // half the edge: twice as many nodes on every line
    is_well_cut(&Mesh::tetrahedra(8, true), 8, [1.05, 1.15].map(|more| more * ideal(16, 2) as f64));
}

#[test]
fn shells_and_plane_meshes_are_cut_into_patches() {
    let arch = |x: [f64; 3]| [x[0], x[1], 10.0 * (0.05 * x[0]).sin()];
    // 6 x 4 patches: 5 lines of 41 nodes and 3 of 61
    let lines = 6.0 * (5.0 * 41.0 + 3.0 * 61.0 + 15.0);
    is_well_cut(&Mesh::quadrangles([60, 40], 6, arch), 24, [1.15 * lines, 1.25 * lines]);
    let lines = 2.0 * (10.0 * 51.0 + 25.0);
    is_well_cut(&Mesh::quadrangles([50, 50], 2, |x| x).shuffled(), 36, [1.1 * lines, 1.25 * lines]);
}

#[test]
fn a_thin_ring_and_a_bar_are_cut_across() {
    let section = 3.0 * 3.0 * 4.0;
    for pieces in [2, 9, 15] {
        is_well_cut(&Mesh::ring([120, 2, 3]), pieces, [1.25 * section * pieces as f64; 2]);
    }
    let section = 3.0 * 16.0;
    is_well_cut(&Mesh::bricks([200, 3, 3], |_| true, |x| x).turned(1.0, 1.0), 20, [section * 19.0; 2]);
}

#[test]
fn a_thin_plate_is_cut_into_patches_and_no_layers() {
    let lines = 3.0 * 2.0 * (10.0 * 61.0 + 25.0);
    is_well_cut(&Mesh::bricks([60, 60, 1], |_| true, |x| x), 36, [1.01 * lines, 1.2 * lines]);
}

#[test]
fn layers_of_very_different_thickness_are_cut_by_the_number_of_their_elements() {
    for (ratio, thickness) in [(1e4, 1.0), (1e6, 1e-6)] {
        let place = |x: [f64; 3]| [x[0], x[1], thickness * f64::powf(ratio, x[2] / 12.0)];
        is_well_cut(
            &Mesh::bricks([12; 3], |_| true, place),
            27,
            [1.05, 1.2].map(|more| more * ideal(12, 3) as f64),
        );
    }
}

#[test]
fn an_angle_is_cut_into_connected_pieces() {
    let angle = Mesh::bricks([18, 18, 6], |c| c[0] < 6 || c[1] < 6, |x| x);
    // blocks of 6 x 6 x 6, halved along two of three directions
    is_well_cut(&angle, 20, [2500.0; 2]);
    is_well_cut(&angle.turned(2.0, 1.0), 20, [2500.0; 2]);
}

#[test]
fn pieces_do_not_hang_together_by_an_edge() {
    // two cubes with a common edge, and a third that shares a corner with the second
    let keep = |c: [usize; 3]| match c[2] / 6 {
        0 => c[0] / 6 == c[1] / 6 && c[0] < 12,
        _ => c[0] >= 12 && c[1] >= 12,
    };
    let mesh = Mesh::bricks([18, 18, 12], keep, |x| x);
    for with_centres in [true, false] {
        for pieces in [3, 6, 12] {
            quality(&mesh, pieces, with_centres);
        }
        // fewer than there are parts: one piece per part
        assert_eq!(mesh.quality(&mesh.cut(2, with_centres)).pieces, 3);
    }
}

#[test]
fn parts_get_pieces_by_their_size_and_at_least_one() {
    let mesh = Mesh::bricks([27, 4, 4], |c| c[0] != 24 && (c[0] < 24 || c[1] == 0 && c[2] == 0), |x| x);
    for with_centres in [true, false] {
        let piece = mesh.cut(7, with_centres);
        let small: Vec<u32> =
            (0..piece.len()).filter(|&e| mesh.centres[e][0] > 24.0).map(|e| piece[e]).collect();
        assert_eq!(small, [small[0]; 2]);
        assert_eq!(piece.iter().filter(|&&p| p == small[0]).count(), 2);
        assert_eq!(mesh.quality(&piece).pieces, 7);
    }
}

#[test]
fn the_cut_is_the_same_on_any_thread_in_any_unit_and_at_any_place() {
    let meshes = [Mesh::cube(14).shuffled(), Mesh::tetrahedra(8, false), Mesh::ring([60, 3, 3])];
    for mesh in meshes {
        for with_centres in [true, false] {
            let first = mesh.cut(13, with_centres);
            let again: Vec<Vec<u32>> = (0..8).into_par_iter().map(|_| mesh.cut(13, with_centres)).collect();
            assert!(again.iter().all(|piece| *piece == first));
            for unit in [2.0_f64.powi(-300), 1024.0, 2.0_f64.powi(900)] {
                let mut other = mesh.clone();
                other.centres.iter_mut().flatten().for_each(|x| *x *= unit);
                assert!(other.cut(13, with_centres) == first, "{unit}");
            }
            let mut moved = mesh.clone();
            moved.centres.iter_mut().for_each(|x| x[1] += 1e5);
            let (moved, first) = (moved.quality(&moved.cut(13, with_centres)), mesh.quality(&first));
            assert!(moved.apart == 0 && moved.largest < 1.1, "{moved:?}");
            assert!(moved.copies as f64 <= 1.05 * first.copies as f64, "{moved:?} {first:?}");
        }
    }
}
