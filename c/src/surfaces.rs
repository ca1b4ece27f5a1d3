//! Surfaces: nodes with positions and unknowns, faces over them, rigid shapes.

use crate::boundary::{
    base_of, call, column_major, count, enter, id, input, meaning, numbers, twins, Output,
};
use crate::header::types::{
    feti_problem, FETI_ALL, FETI_CYLINDER, FETI_LINE2, FETI_LINE3, FETI_PLANE, FETI_POINT, FETI_QUAD4,
    FETI_QUAD8, FETI_QUAD9, FETI_SPHERE, FETI_TRI3, FETI_TRI6,
};
use feti_contact::error::{Error, Result};
use feti_contact::solver::{RigidShape, Shape};

twins! {
    /// Adds a surface over nodes of a mesh, with 32-bit indices.
    ///
    /// Its faces come by feti_surface_faces_i32. You may give all nodes of a mesh: nodes in no face are left out. A surface without faces is a cloud of points, all its nodes or those of FETI_POINT: it may be the slave of
    /// a pair, but it has no areas, no pressures, and no normals by which the library could leave out faces that look the other way. Nodes
    /// may share unknowns. Without `dof` the surface is a tool that only the host moves; it can be the master of a pair, not the slave.
    /// The positions are those at which K was assembled; feti_surface_move gives new ones. On several
    /// ranks a surface names unknowns of its rank (FETI_UNSUPPORTED). FETI_STATE with FETI_ALL if some bodies have numbers of the host and others have none.
    ///
    /// | argument | in/out | shape | rule |
    /// |---|---|---|---|
    /// | `p` | in | scalar | the handle |
    /// | `body` | in | scalar | number of the body, from 0, or FETI_ALL |
    /// | `dim` | in | scalar | dimensions, 2 or 3 |
    /// | `nodes` | in | scalar | number of nodes |
    /// | `x` | in | ldx * nodes | coordinates, the first dim numbers of each column, finite, length |
    /// | `ldx` | in | scalar | >= dim |
    /// | `dof` | in | ldd * nodes | unknown of each direction, the first dim numbers of each column, counted from `base`; below `base`: held. With FETI_ALL an unknown of the table (feti_dof_table_i32, called before) or, without a table, the host's number (feti_body_numbering_i32) or, without such numbers, counted through all bodies; NULL: a tool, for which `body` and `ldd` are ignored |
    /// | `ldd` | in | scalar | >= dim |
    /// | `base` | in | scalar | 0 or 1: what `dof` counts from |
    /// | `surface` | out | scalar | number of the new surface, from 0 |
    ///
    /// # Safety
    /// The arrays have the given shapes.
    fn feti_surface_add_i32, feti_surface_add_i64(
        p: *mut feti_problem, body: i64, dim: i32, nodes: i64, x: *const f64, ldx: i64, dof: *const I, ldd: i64, base: i32,
        surface: *mut i64,
    ) |call| {
        enter(p, call, |problem| {
            let body = if body == FETI_ALL || dof.is_null() { None } else { Some(id(body, "body")?) };
            let (dim, nodes, base) = (dimensions(dim)?, count(nodes, "nodes")?, base_of(base)?);
            let (entries, ldx) = column_major(dim, nodes, ldx, "ldx")?;
            // SAFETY: room for one number guaranteed by the caller.
            let number = unsafe { Output::new(surface, 1, "surface") }?;
            let given = (!dof.is_null()).then(|| column_major(dim, nodes, ldd, "ldd")).transpose()?;
            // SAFETY: columns of ldx numbers guaranteed by the caller.
            let x = unsafe { input(x, entries, "x") }?;
            let dof = match given {
                // SAFETY: columns of ldd numbers guaranteed by the caller.
                Some((entries, ldd)) => Some((unsafe { numbers(dof, entries, base, "dof") }?, ldd)),
                None => None,
            };
            let dof = dof.as_ref().map(|(dof, ldd)| (&dof[..], *ldd));
            number.set(problem.surface_add(body, dim, x, ldx, dof).map_err(|error| error.index_from(base))? as i64);
            Ok(())
        })
    }
}

twins! {
    /// Adds faces of one shape to a surface, with 32-bit indices.
    ///
    /// Seen from outside of the body the corners go round counterclockwise; in the plane the body is on the left of each line. The order of
    /// nodes is that of VTK: corners, then nodes on the edges, then the centre. Make one call for each shape: faces are numbered through
    /// all calls, from 0. A quadrilateral whose last corner is repeated is a triangle (of FETI_QUAD8 the node on the lost edge is that corner, too).
    /// Refused, with the number of the face: a node that does not exist or is twice in the face, a face without area (at most 1e-12 of
    /// the square of its longest edge), a quadrilateral whose corners cross, a mid node further than .4 of the length of its edge from the
    /// middle of the edge's chord (a quarter-point node has .25), a centre further than .4 of the longest edge from the middle of the face,
    /// an edge that three faces share, two neighbours that disagree about which side is outside. These are checked at the positions that the surface
    /// has now, not again after feti_surface_move. Give both sides of a shell as two surfaces. Nodes by FETI_POINT make the surface a cloud of these nodes
    /// alone; points and faces do not mix. FETI_STATE if a pair has the surface: faces come before pairs.
    ///
    /// | argument | in/out | shape | rule |
    /// |---|---|---|---|
    /// | `p` | in | scalar | the handle |
    /// | `surface` | in | scalar | number of the surface, from 0 |
    /// | `shape` | in | scalar | FETI_LINE2, FETI_LINE3, FETI_TRI3, FETI_TRI6, FETI_QUAD4, FETI_QUAD8, FETI_QUAD9 or FETI_POINT, with k = 2, 3, 3, 6, 4, 8, 9, 1 nodes |
    /// | `faces` | in | scalar | number of faces |
    /// | `node` | in | k * faces | nodes of the surface, face after face, counted from `base` |
    /// | `base` | in | scalar | 0 or 1: what `node` counts from |
    ///
    /// # Safety
    /// The array has the given shape.
    fn feti_surface_faces_i32, feti_surface_faces_i64(
        p: *mut feti_problem, surface: i64, shape: i32, faces: i64, node: *const I, base: i32,
    ) |call| {
        enter(p, call, |problem| {
            let (surface, shape) = (id(surface, "surface")?, face_shape(shape)?);
            let (faces, base) = (count(faces, "faces")?, base_of(base)?);
            let nodes = shape.map_or(1, Shape::nodes);
            let entries = faces.checked_mul(nodes).filter(|entries| *entries <= isize::MAX as usize / 8);
            let entries = entries.ok_or_else(|| Error::argument("faces", format!("no array has the nodes of {faces} faces")))?;
            problem.surface_sizes(surface)?;
            // SAFETY: as many numbers as the faces have nodes guaranteed by the caller.
            let node = unsafe { numbers(node, entries, base, "node") }?;
            match shape {
                Some(shape) => problem.surface_faces(surface, shape, &node).map(|_| ()),
                None => problem.surface_points(surface, &node),
            }
            .map_err(|error| error.index_from(base))
        })
    }
}

/// Adds a rigid surface of a simple shape, which has no unknowns: a tool or a foundation. It can be the master of a pair.
///
/// With a radius below 0 the shape is a hole: the slave is inside of it, and the normal points to the axis or centre. Directions need not
/// have length 1.
///
/// | argument | in/out | shape | rule |
/// |---|---|---|---|
/// | `p` | in | scalar | the handle |
/// | `dim` | in | scalar | dimensions, 2 or 3; 3 for a cylinder |
/// | `shape` | in | scalar | FETI_PLANE, FETI_SPHERE (in the plane a circle) or FETI_CYLINDER |
/// | `data` | in | k | plane: a point, the outward normal, k = 2 dim; sphere: the centre, the radius, k = dim + 1; cylinder: a point of the axis, its direction, the radius, k = 7; length |
/// | `surface` | out | scalar | number of the new surface, from 0 |
///
/// # Safety
/// The array has the given shape.
#[no_mangle]
pub unsafe extern "C" fn feti_surface_rigid(
    p: *mut feti_problem,
    dim: i32,
    shape: i32,
    data: *const f64,
    surface: *mut i64,
) -> i32 {
    enter(p, call!(feti_surface_rigid(p, dim, shape, data, surface)), |problem| {
        let (dim, shape) = (dimensions(dim)?, rigid_shape(shape)?);
        // SAFETY: room for one number guaranteed by the caller.
        let number = unsafe { Output::new(surface, 1, "surface") }?;
        // SAFETY: as many numbers as the shape has guaranteed by the caller.
        let data = unsafe { input(data, shape.numbers(dim)?, "data") }?;
        number.set(problem.surface_rigid(dim, shape, data)? as i64);
        Ok(())
    })
}

/// Gives a surface new positions: of all its nodes, or new data of a rigid shape.
///
/// Rows, gaps and the last answer do not change before the next feti_pairs_find. The unknowns u are then displacements from these
/// positions. The call reads as many columns as the surface has nodes (feti_surface_counts).
///
/// | argument | in/out | shape | rule |
/// |---|---|---|---|
/// | `p` | in | scalar | the handle |
/// | `surface` | in | scalar | number of the surface, from 0 |
/// | `x` | in | ldx * nodes | coordinates, the first dim numbers of each column, finite, length; for a rigid surface its data, as in feti_surface_rigid |
/// | `ldx` | in | scalar | >= dim; ignored for a rigid surface |
///
/// # Safety
/// The array has the given shape.
#[no_mangle]
pub unsafe extern "C" fn feti_surface_move(
    p: *mut feti_problem,
    surface: i64,
    x: *const f64,
    ldx: i64,
) -> i32 {
    enter(p, call!(feti_surface_move(p, surface, x, ldx)), |problem| {
        let surface = id(surface, "surface")?;
        let sizes = problem.surface_sizes(surface)?;
        let (entries, ldx) = match sizes.data {
            0 => column_major(sizes.dim, sizes.nodes, ldx, "ldx")?,
            data => (data, data),
        };
        // SAFETY: columns of ldx numbers, or the numbers of the shape, guaranteed by the caller.
        problem.surface_move(surface, unsafe { input(x, entries, "x") }?, ldx)
    })
}

/// Reads the sizes of a surface.
///
/// | argument | in/out | shape | rule |
/// |---|---|---|---|
/// | `p` | in | scalar | the handle |
/// | `surface` | in | scalar | number of the surface, from 0 |
/// | `dim` | out | scalar | dimensions, 2 or 3; may be NULL |
/// | `nodes` | out | scalar | nodes, 0 for a rigid surface; may be NULL |
/// | `faces` | out | scalar | faces, 0 for a cloud of points and for a rigid surface; may be NULL |
/// | `data` | out | scalar | how many numbers describe a rigid surface, 0 for one with nodes; may be NULL |
///
/// # Safety
/// Every pointer is NULL or has room for one number.
#[no_mangle]
pub unsafe extern "C" fn feti_surface_counts(
    p: *mut feti_problem,
    surface: i64,
    dim: *mut i32,
    nodes: *mut i64,
    faces: *mut i64,
    data: *mut i64,
) -> i32 {
    enter(p, call!(feti_surface_counts(p, surface, dim, nodes, faces, data)), |problem| {
        let sizes = problem.surface_sizes(id(surface, "surface")?)?;
        // SAFETY: NULL or room for one number guaranteed by the caller.
        let (dim, [nodes, faces, data]) = unsafe {
            let wide = [
                Output::optional(nodes, 1, "nodes")?,
                Output::optional(faces, 1, "faces")?,
                Output::optional(data, 1, "data")?,
            ];
            (Output::optional(dim, 1, "dim")?, wide)
        };
        dim.set(sizes.dim as i32);
        nodes.set(sizes.nodes as i64);
        faces.set(sizes.faces as i64);
        data.set(sizes.data as i64);
        Ok(())
    })
}

fn dimensions(dim: i32) -> Result<usize> {
    meaning(dim, "dim", &[(2, 2), (3, 3)], "a surface has 2 or 3 dimensions")
}

/// None: a point.
fn face_shape(shape: i32) -> Result<Option<Shape>> {
    let known = [
        (FETI_LINE2, Some(Shape::Line2)),
        (FETI_LINE3, Some(Shape::Line3)),
        (FETI_TRI3, Some(Shape::Tri3)),
        (FETI_TRI6, Some(Shape::Tri6)),
        (FETI_QUAD4, Some(Shape::Quad4)),
        (FETI_QUAD8, Some(Shape::Quad8)),
        (FETI_QUAD9, Some(Shape::Quad9)),
        (FETI_POINT, None),
    ];
    meaning(shape, "shape", &known, "no shape of a face from FETI_LINE2 to FETI_QUAD9, and not FETI_POINT")
}

fn rigid_shape(shape: i32) -> Result<RigidShape> {
    let known = [
        (FETI_PLANE, RigidShape::Plane),
        (FETI_SPHERE, RigidShape::Sphere),
        (FETI_CYLINDER, RigidShape::Cylinder),
    ];
    meaning(shape, "shape", &known, "none of FETI_PLANE, FETI_SPHERE and FETI_CYLINDER")
}
