//! Cutting bodies into pieces.

/// Tilt of a cut, in distances of two layers, so that it passes between the rows of a layer.
pub const SLOPE: f64 = 0.05;
/// Deviation of the weight of a side, relative to the smaller side.
pub const SLACK: f64 = 0.01;
/// The same deviation in parts of the heaviest element, if that is more.
pub const SLACK_BY_ELEMENT: f64 = 0.6;
/// Mean number of unknowns of a piece.
pub const PIECE: f64 = 1200.0;
/// Largest size of a piece that gets elements, relative to the mean.
pub const FULL: f64 = 1.06;
/// Size relative to the mean from which a piece gives elements away, even for more shared unknowns.
pub const OVERFULL: f64 = 1.07;
/// Shift of a plane, in slabs, to pass between two layers.
pub const SNAP: f64 = 0.015;
/// Part of the weight of a slab that may be disconnected; neighbours take it.
pub const DISCONNECTED: f64 = 0.02;
/// Largest weight of a piece that gets vertices, relative to the mean.
pub const FULL_BY_WEIGHT: f64 = 1.05;
/// Crossings and gaps that differ by less than this part are equal.
pub const TIE: f64 = 0.01;
/// Extent relative to the largest below which a body has no such direction.
pub const FLAT: f64 = 1e-9;
/// Factor by which slabs may be shorter than pieces.
pub const LONG: f64 = 1.2;
