//! Surfaces: faces, the point of a face nearest to a node, rows between nodes and faces.

/// Area of a face relative to the square of its longest edge, or chord of a line relative to its longest distance of nodes, up to which it
/// has no normal.
pub const NO_AREA: f64 = 1e-12;
/// Part of an edge by which a face is continued where the surface ends. Without it rows of nodes just beside a rim come and go.
pub const RIM: f64 = 0.05;
/// Part of an edge by which a node may leave the face that it keeps. Without it Newton's method of two blocks runs in a circle at 3e-3 of
/// the gap; 1 % suffices, more costs overlap at kinks.
pub const KEEP: f64 = 0.02;
/// Distance from an edge, in parts of the face, up to which a foot lies on it; and distance from a foot on an edge, in parts of the face, up
/// to which the line to the node has no direction.
pub const ON_EDGE: f64 = 1e-9;
/// Distances of two faces that differ by less than this part are equal.
pub const EQUAL: f64 = 1e-10;
/// Step of Newton's method, in parts of the parent, from which its error squares in the next one.
pub const NEAR: f64 = 1e-6;
/// Sine of the angle between an edge of the slave and the normal of the contact, below which another edge gives the tangent.
pub const ALONG: f64 = 0.1;
/// Angle between the outward normals of two surfaces, in degrees, from which they may meet: surfaces side by side have 0, and at 90 neither
/// looks at the other.
pub const ANGLE: f64 = 100.0;
/// Overlap of a row that has lost all its unknowns, in parts of the surface's extent, that is rounding: a held node on a rigid face has 1e-17.
pub const OVERLAP: f64 = 1e-9;
/// Distance times curvature, relative to the square of the height, up to which a node has one nearest point on a face: 4 x 1/32 of the height
/// is the least eigenvalue of X_a.X_b.
pub const CONVEX: f64 = 0.03125;
