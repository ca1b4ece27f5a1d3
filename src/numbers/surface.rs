//! Surfaces: faces, the point of a face nearest to a node, rows between nodes and faces.

/// Area of a face relative to the square of its longest edge, or chord of a line relative to its longest distance of nodes, up to which it
/// has no normal.
pub const NO_AREA: f64 = 1e-12;
/// Distance of a mid node from the middle of the chord of its edge, in parts of the chord, or of a centre from the middle of its face, in
/// parts of the longest chord, up to which the nodes are in order. A quarter-point node has 0.25, an arc of 154 degrees 0.4, and 0.37 the
/// worst node of a mesh whose nodes are moved at random by up to 0.15 of an edge along each axis. If the mid nodes of a triangle or of a
/// convex quadrilateral are one place on, some edge has 0.5 at least.
pub const MIDDLE: f64 = 0.4;
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
/// Cosine between the normals of a slave's face and a master's face below which the latter is edge-on: seen along the slave's normal its
/// gap changes a hundred times faster than the position.
pub const EDGE_ON: f64 = 0.01;
/// Step of Newton's method, in parts of the parent, after which its error, the square, is rounding.
pub const SQUARED: f64 = 1e-8;
/// Area of a segment, in parts of the slave's face, or of the product of two functions, in parts of that of one of them, up to which it is
/// rounding.
pub const SPECK: f64 = 1e-15;
/// Condition of the mass matrix of hat functions on the covered part of a face up to which dual functions are taken: on specks of 1e-3 of
/// the face their rows lose three digits.
pub const SLIVER: f64 = 1e6;
/// Share of a corner in the covered part of a face, relative to the largest one, up to which it has none: dual functions would give it a
/// gap that is extrapolated over a hundred times the covered width, hat functions the row of the other corners again.
pub const FAR: f64 = 0.01;
/// Bulge or twist of a face, in parts of its longest edge, up to which it is an affine image of its parent.
pub const AFFINE: f64 = 1e-12;
/// Largest entry of a row up to which it moves nothing; the direction that the row measures has the length 1. Nodes at the end of an edge
/// have it where only the other end is held.
pub const IDLE: f64 = 1e-9;
