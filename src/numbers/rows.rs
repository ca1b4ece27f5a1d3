//! Rows: scaling, decoupling, copies (S3).

/// Remainder of a contact row, relative to it, up to which decoupling leaves it alone.
pub const REMAINDER: f64 = 1e-4;
/// Ratio of row lengths at one node from which the host has used different factors.
pub const FACTORS: f64 = 1e3;
/// Stiffness of a copy of an unknown, relative to the stiffest copy, from which rows act on it.
pub const SLACK: f64 = 1e-3;
