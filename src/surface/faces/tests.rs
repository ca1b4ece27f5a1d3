//! What is refused, one by one, and what is not.

use super::*;

/// A square of 3 x 3 nodes, numbered by rows.
fn nodes() -> Vec<Vector> {
    (0..9).map(|k| [(k % 3) as f64, (k / 3) as f64, 0.0]).collect()
}

fn faces(dim: usize) -> Faces {
    Faces::new(dim, 9).unwrap()
}

fn refused(faces: &mut Faces, shape: Shape, node: &[i64], x: &[Vector]) -> Error {
    let before = format!("{faces:?}");
    let error = faces.add(shape, node, x).unwrap_err();
    assert_eq!(format!("{faces:?}"), before, "a refused face leaves something behind");
    error
}

#[test]
fn a_refused_face_is_named() {
    let x = nodes();
    let place = |error: Error| (error.kind, error.place.face, error.place.index);
    let node = Kind::Argument("node");
    let quad = [0, 1, 4, 3];
    let mut all = faces(3);
    assert_eq!(all.add(Shape::Quad4, &quad, &x).unwrap(), 0);
    let error = refused(&mut all, Shape::Quad4, &[1, 2, 9, 4], &x);
    assert_eq!(place(error), (node, Some(1), Some(9)));
    let error = refused(&mut all, Shape::Quad4, &[1, 2, -1, 4], &x);
    assert_eq!(place(error), (node, Some(1), Some(-1)));
    let error = refused(&mut all, Shape::Tri3, &[1, 2, 1], &x);
    assert_eq!(
        (error.to_string().as_str(), place(error)),
        ("face 1, entry 2: node 1 is twice in the face", (node, Some(1), Some(1)))
    );
    // the corner before the last one, or another one, is no triangle
    assert_eq!(refused(&mut all, Shape::Quad4, &[1, 1, 5, 4], &x).place.face, Some(1));
    assert_eq!(refused(&mut all, Shape::Tri3, &[0, 1, 2], &x).kind, node, "no area");
    assert_eq!(refused(&mut all, Shape::Tri3, &[1, 2], &x).kind, node, "no whole face");
    assert_eq!(refused(&mut all, Shape::Line2, &[1, 2], &x).kind, Kind::Argument("shape"));
    let error = refused(&mut all, Shape::Quad4, &[4, 5, 2, 1], &x);
    assert_eq!(place(error), (node, Some(1), Some(0)), "the other side is outside");
    assert_eq!(all.add(Shape::Quad4, &[1, 2, 5, 4], &x).unwrap(), 1);
    let mut up = x.clone();
    (up[7][2], up[8][2]) = (1.0, 1.0);
    let error = refused(&mut all, Shape::Quad4, &[1, 4, 7, 8], &up);
    assert_eq!(place(error), (node, Some(2), Some(0)), "an edge of three faces");
    assert_eq!(Faces::new(1, 3).unwrap_err().kind, Kind::Argument("dim"));
    assert_eq!(Faces::new(4, 3).unwrap_err().kind, Kind::Argument("dim"));
}

#[test]
fn a_refused_line_is_named() {
    let x = nodes();
    let mut all = faces(2);
    all.add(Shape::Line2, &[0, 1, 1, 2], &x).unwrap();
    let error = refused(&mut all, Shape::Line2, &[1, 4], &x);
    assert_eq!((error.place.face, error.place.index), (Some(2), Some(0)), "a node of three lines");
    let error = refused(&mut all, Shape::Line2, &[5, 2], &x);
    assert_eq!((error.place.face, error.place.index), (Some(2), Some(1)), "the body on the other side");
    let mut flat = x.clone();
    flat[5] = flat[2];
    assert_eq!(refused(&mut all, Shape::Line2, &[2, 5], &flat).kind, Kind::Argument("node"));
    assert_eq!(refused(&mut all, Shape::Line3, &[2, 5, 8], &flat).kind, Kind::Argument("node"));
    assert_eq!(refused(&mut all, Shape::Tri3, &[2, 5, 8], &x).kind, Kind::Argument("shape"));
}

#[test]
fn a_quadrilateral_with_its_last_corner_twice_is_a_triangle() {
    let x = nodes();
    let mut all = faces(3);
    all.add(Shape::Quad4, &[0, 1, 4, 4], &x).unwrap();
    assert_eq!((all.shape(0), all.nodes_of(0)), (Shape::Tri3, &[0, 1, 4][..]));
    let mut all = faces(3);
    all.add(Shape::Quad8, &[0, 2, 8, 8, 1, 5, 8, 4], &x).unwrap();
    assert_eq!((all.shape(0), all.nodes_of(0)), (Shape::Tri6, &[0, 2, 8, 1, 5, 4][..]));
    assert!(faces(3).add(Shape::Quad8, &[0, 2, 8, 8, 1, 5, 7, 4], &x).is_err());
}

#[test]
fn shapes_meet_along_edges_and_the_rest_is_rim() {
    let x = nodes();
    let mut all = faces(3);
    all.add(Shape::Quad4, &[0, 1, 4, 3, 1, 2, 5, 4], &x).unwrap();
    assert_eq!(all.add(Shape::Tri3, &[3, 4, 6, 4, 7, 6], &x).unwrap(), 2);
    assert_eq!(
        (all.beyond(0, 1), all.beyond(1, 3), all.beyond(0, 2)),
        (Some((1, 3)), Some((0, 1)), Some((2, 0)))
    );
    assert_eq!((all.beyond(0, 0), all.beyond(1, 2), all.beyond(2, 1)), (None, None, Some((3, 2))));
    assert!(all.is_on_rim(4), "the face between 4, 5, 7 and 8 is not there");
    assert_eq!(all.used().collect::<Vec<_>>(), [0, 1, 2, 3, 4, 5, 6, 7]);
    assert_eq!((all.first_face(4), all.first_face(5), all.first_face(8)), (Some((0, 2)), Some((1, 2)), None));
}

#[test]
fn normals_of_nodes_weigh_faces_by_their_angles() {
    // a cube corner in one quadrilateral and two pairs of triangles: the split does not matter
    let x = [
        [0.0; 3],
        [1.0, 0.0, 0.0],
        [1.0, 1.0, 0.0],
        [0.0, 1.0, 0.0],
        [0.0, 0.0, 1.0],
        [1.0, 0.0, 1.0],
        [0.0, 1.0, 1.0],
    ];
    let mut all = Faces::new(3, 7).unwrap();
    all.add(Shape::Quad4, &[0, 3, 2, 1], &x).unwrap();
    all.add(Shape::Tri3, &[0, 1, 5, 0, 5, 4, 0, 4, 3, 4, 6, 3], &x).unwrap();
    let normals = all.normals(&x).unwrap();
    let diagonal = -(1.0f64 / 3.0).sqrt();
    assert!(normals[0].iter().all(|v| (v - diagonal).abs() < 1e-15), "{normals:?}");
}

#[test]
fn points_and_faces_do_not_mix() {
    let mut all = faces(3);
    all.add(Shape::Quad4, &[0, 1, 4, 3], &nodes()).unwrap();
    assert_eq!(all.with_points(&[8]).unwrap_err().kind, Kind::Argument("shape"));
    let cloud = faces(3).with_points(&[8, 2]).unwrap().with_points(&[5]).unwrap();
    assert_eq!((cloud.used().collect::<Vec<_>>(), cloud.len()), (vec![2, 5, 8], 0));
    assert!(cloud.first_face(8).is_none());
    let error = cloud.with_points(&[3, 9]).unwrap_err();
    assert_eq!(
        (error.kind, error.place.index, error.place.entry),
        (Kind::Argument("node"), Some(9), Some(1))
    );
    let error = cloud.with(Shape::Quad4, &[0, 1, 4, 3], &nodes()).unwrap_err();
    assert_eq!(error.kind, Kind::Argument("shape"));
}
