//! Constants of the header.

/// Kind of rows: `B u <= c`.
pub const FETI_INEQUALITY: i32 = 1;
/// Kind of rows: `H u = h`.
pub const FETI_EQUALITY: i32 = 2;
/// Kind of rows: tangential rows of nodes with friction (feti_friction_add_i32, feti_friction_add_i64).
pub const FETI_TANGENTIAL: i32 = 3;

/// In place of a body number: all bodies. If they have numbers of the host (feti_body_numbering_i32 or _i64), arrays use
/// these numbers; after feti_dof_table_i32 or _i64 arrays have an entry for each unknown of the table.
pub const FETI_ALL: i64 = -1;

/// Shape of a face in the plane: a line with 2 nodes. Corners come first, then the nodes on the edges, then the one in the centre, as in VTK.
pub const FETI_LINE2: i32 = 1;
/// Shape of a face in the plane: a line with 3 nodes, the last in the middle.
pub const FETI_LINE3: i32 = 2;
/// Shape of a face in space: a triangle with 3 nodes.
pub const FETI_TRI3: i32 = 3;
/// Shape of a face in space: a triangle with 6 nodes.
pub const FETI_TRI6: i32 = 4;
/// Shape of a face in space: a quadrilateral with 4 nodes.
pub const FETI_QUAD4: i32 = 5;
/// Shape of a face in space: a quadrilateral with 8 nodes.
pub const FETI_QUAD8: i32 = 6;
/// Shape of a face in space: a quadrilateral with 9 nodes.
pub const FETI_QUAD9: i32 = 7;
/// In place of the shape of a face: a point, one node of a cloud.
pub const FETI_POINT: i32 = 8;
/// Shape of a rigid surface: a plane; data: a point, the outward normal.
pub const FETI_PLANE: i32 = 11;
/// Shape of a rigid surface: a sphere, in the plane a circle; data: the centre, the radius.
pub const FETI_SPHERE: i32 = 12;
/// Shape of a rigid surface in space: a cylinder without ends; data: a point of the axis, its direction, the radius.
pub const FETI_CYLINDER: i32 = 13;

/// Method of a pair: a row between each slave node and the nearest point of the master.
pub const FETI_NODE_TO_FACE: i32 = 1;
/// Method of a pair: a row for each slave node with the gap that its faces have in the mean, weighted over the faces of both surfaces (mortar).
pub const FETI_MORTAR: i32 = 2;
/// Added to the method of a pair: the surfaces are tied, by equality rows in all directions.
pub const FETI_TIED: i32 = 4;

/// Field of a pair, 1 number: contact force; of a tie the part along the normal, above 0 under pressure.
pub const FETI_FORCE: i32 = 1;
/// Field of a pair, 1 number: contact force per area.
pub const FETI_PRESSURE: i32 = 2;
/// Field of a pair, dim numbers: tangential force on the slave per area.
pub const FETI_SHEAR: i32 = 3;
/// Field of a pair, 1 number: open gap, length.
pub const FETI_GAP: i32 = 4;
/// Field of a pair, dim numbers: slip of the load step, length.
pub const FETI_SLIP: i32 = 5;
/// Field of a pair, 1 number: area of the node, length^2.
pub const FETI_AREA: i32 = 6;
/// Field of a pair, dim numbers: unit normal from slave to master.
pub const FETI_NORMAL: i32 = 7;
/// Field of a pair, 1 number: 0 open, 1 closed without friction, 2 sticks, 3 slips.
pub const FETI_CLOSED: i32 = 8;

/// Storage: every entry of the symmetric matrix is given.
pub const FETI_FULL: i32 = 0;
/// Storage: entries with column <= row are given.
pub const FETI_LOWER: i32 = 1;
/// Storage: entries with column >= row are given.
pub const FETI_UPPER: i32 = 2;

/// Profile: every column goes from its first entry down to the diagonal.
pub const FETI_SKYLINE_DOWN: i32 = 0;
/// Profile: every column goes from the diagonal up to its first entry.
pub const FETI_SKYLINE_UP: i32 = 1;

/// Null-space flag: the columns span the null space.
pub const FETI_EXACT: i32 = 0;
/// Null-space flag: the null space lies in the span of the columns, and the library selects it from there.
pub const FETI_CANDIDATES: i32 = 1;
/// Null-space flag: motions that K resists weakly or not at all; the library computes the exact motions and their
/// stiffness from K.
pub const FETI_SOFT: i32 = 2;

/// Stiffness flag: the matrix is copied.
pub const FETI_COPY: i32 = 0;
/// Stiffness flag: keep using the caller's arrays (values, and 32-bit 0-based columns) if the layout permits.
pub const FETI_BORROW: i32 = 1;

/// Source of a null space: vectors of the host that span it (FETI_EXACT), or soft motions (FETI_SOFT).
pub const FETI_ORIGIN_EXACT: i32 = 1;
/// Source of a null space: selected from vectors of the host (FETI_CANDIDATES).
pub const FETI_ORIGIN_CANDIDATES: i32 = 2;
/// Source of a null space: selected from the rigid body motions that the coordinates give.
pub const FETI_ORIGIN_COORDINATES: i32 = 3;
/// Source of a null space: computed from K alone.
pub const FETI_ORIGIN_FOUND: i32 = 4;

/// State of a row: open; its force is zero.
pub const FETI_ROW_OPEN: i32 = 0;
/// State of a row: closed; it carries a force.
pub const FETI_ROW_CLOSED: i32 = 1;
/// State of a row: closed, with a force that is zero within rounding error or has no clear sign.
pub const FETI_ROW_WEAK: i32 = 2;
/// State of a row: unknown, because the bodies that it touches are in a group without an answer.
pub const FETI_ROW_UNKNOWN: i32 = 3;

/// State of a node with friction: open; the bound is zero and the node carries no tangential force.
pub const FETI_FRICTION_OPEN: i32 = 0;
/// State of a node with friction: it sticks; its force is within the bound.
pub const FETI_FRICTION_STICK: i32 = 1;
/// State of a node with friction: it slips in the direction of its force, which reaches the bound.
pub const FETI_FRICTION_SLIP: i32 = 2;
/// State of a node with friction: its force equals the bound within rounding error, and the node does not slip.
pub const FETI_FRICTION_WEAK: i32 = 3;
/// State of a node with friction: unknown, because the bodies that it touches are in a group without an answer.
pub const FETI_FRICTION_UNKNOWN: i32 = 4;

/// Phase that feti_on_progress reports: a part of the setup is done.
pub const FETI_PHASE_SETUP: i32 = 1;
/// Phase that feti_on_progress reports: a step of the dual method is done.
pub const FETI_PHASE_SOLVE: i32 = 2;

/// Kind of a step: conjugate gradients on the face.
pub const FETI_STEP_CONJUGATE_GRADIENT: i32 = 1;
/// Kind of a step: rows lost their force (expansion of the face).
pub const FETI_STEP_EXPANSION: i32 = 2;
/// Kind of a step: rows gained a force (release from the face).
pub const FETI_STEP_RELEASE: i32 = 3;
/// Kind of a step: a direction of the Newton method for friction.
pub const FETI_STEP_NEWTON: i32 = 4;

/// Level of a log: nothing.
pub const FETI_LOG_NONE: i32 = 0;
/// Level of a log: one line for each solve, and warnings.
pub const FETI_LOG_RESULT: i32 = 1;
/// Level of a log: also the problem and the method, and a line for each phase.
pub const FETI_LOG_PHASE: i32 = 2;
/// Level of a log: also a line for each step.
pub const FETI_LOG_STEP: i32 = 3;

/// Type of an option: number.
pub const FETI_OPTION_F64: i32 = 1;
/// Type of an option: integer.
pub const FETI_OPTION_I64: i32 = 2;
/// Type of an option: text.
pub const FETI_OPTION_STR: i32 = 3;
